"""Where a camera says that a point is seen, both renderers show it; whatever the window and the shape of the pixels."""

from __future__ import annotations

import numpy as np
import pytest

import limner
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.tables.camera import camera_record, raster_from_world

WIDTH, HEIGHT = 61, 47
EYE, TARGET = (3.0, 2.0, 4.0), (0.2, 0.1, -0.1)

CAMERAS = {
    "centred": PerspectiveCamera.look_at(EYE, TARGET, yfov_degrees=35.0),
    "shifted": PerspectiveCamera.look_at(EYE, TARGET, yfov_degrees=30.0, shift_x=-0.4, shift_y=0.3),
    "far off": PerspectiveCamera.look_at(EYE, (-2.0, 0.0, 0.0), yfov_degrees=40.0, shift_x=1.4, shift_y=-0.2),
    "wide pixels": PerspectiveCamera.look_at(EYE, TARGET, yfov_degrees=35.0, shift_y=-0.2, pixel_aspect=1.7),
    "calibrated": PerspectiveCamera.from_opencv(
        [[70.0, 0.0, 22.0], [0.0, 75.0, 30.5], [0.0, 0.0, 1.0]],
        PerspectiveCamera.look_at(EYE, TARGET).to_opencv(WIDTH, HEIGHT)[1],
        WIDTH,
        HEIGHT,
    ),
    "parallel": OrthographicCamera.look_at(EYE, TARGET, height=3.5),
    "parallel, shifted": OrthographicCamera.look_at(EYE, TARGET, height=3.5, shift_x=0.3, shift_y=0.2, pixel_aspect=0.8),
}


def _scene() -> limner.Scene:
    """A turned box and a ball, as triangles and as they are."""
    box = limner.Shape(primitives.box((1.2, 1.0, 0.9)), limner.Lambert(color=(0.8, 0.4, 0.2), name="clay"))
    ball = limner.Shape(limner.Sphere(0.5), limner.Lambert(name="chalk"))
    children = (
        limner.Node("box", transform.translate(-0.4, 0.1, 0.2) @ transform.rotate_y(0.4), shapes=(box,)),
        limner.Node("ball", transform.translate(0.8, 0.2, 0.0), shapes=(ball,)),
    )
    return limner.Scene(limner.Node("world", children=children))


@pytest.mark.filterwarnings("ignore::limner.LimnerWarning")
@pytest.mark.parametrize("renderer", ["raster", "ray"])
@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_positions_are_seen_in_their_own_pixels(camera: Camera, renderer: str) -> None:
    """The AOV `position` projects to the pixel it stands in, within 1e-3; and pixel and depth lead back to it."""
    image = limner.render(
        _scene(), width=WIDTH, height=HEIGHT, renderer=renderer, camera=camera, samples=1, aovs=("position", "depth", "instance_id")
    )
    hit = image.aov["instance_id"] >= 0
    assert 0.05 < hit.mean() < 0.95
    assert len(np.unique(image.aov["instance_id"])) == 3
    y, x = np.nonzero(hit)
    xy, depth = camera.project(image.aov["position"][hit], WIDTH, HEIGHT)
    np.testing.assert_allclose(xy, np.stack([x, y], axis=1), rtol=0, atol=1e-3)
    np.testing.assert_allclose(depth, image.aov["depth"][hit], rtol=1e-5)
    points = camera.unproject(np.stack([x, y], axis=1), image.aov["depth"][hit], WIDTH, HEIGHT)
    np.testing.assert_allclose(points, image.aov["position"][hit], atol=2e-5)


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_both_renderers_see_the_same(camera: Camera) -> None:
    """Ids differ at most on edges, depths of what both see agree."""
    raster, ray = (
        limner.render(_scene(), width=WIDTH, height=HEIGHT, renderer=renderer, camera=camera, samples=1, aovs=("depth", "instance_id"))
        for renderer in ("raster", "ray")
    )
    same = raster.aov["instance_id"] == ray.aov["instance_id"]
    assert same.mean() > 0.99
    both = same & (ray.aov["instance_id"] == 0)
    np.testing.assert_allclose(raster.aov["depth"][both], ray.aov["depth"][both], rtol=1e-4)


@pytest.mark.parametrize("renderer", ["raster", "ray"])
@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_the_brightest_pixel_is_where_project_says(camera: Camera, renderer: str) -> None:
    """A glowing speck, smaller than a pixel, at points all over the picture."""
    wanted = np.array([[7.0, 5.0], [30.0, 23.0], [54.0, 40.0], [1.0, 45.0]])
    for (column, row), depth in zip(wanted, (3.0, 4.0, 5.0, 6.0), strict=True):
        place = camera.unproject((column, row), depth, WIDTH, HEIGHT)
        pixels_per_metre = camera.intrinsics(WIDTH, HEIGHT)[[0, 1], [0, 1]].max()
        radius = 0.45 / pixels_per_metre * (depth if isinstance(camera, PerspectiveCamera) else 1.0)
        glow = limner.Shape(limner.Sphere(radius), limner.Lambert(color=(0, 0, 0), emission=(1.0, 1.0, 1.0)))
        light = limner.DirectionalLight()
        root = limner.Node("speck", transform.translate(*place), shapes=(glow,), lights=(light,))
        scene = limner.Scene(root, camera=camera, background=(0.0, 0.0, 0.0))
        image = limner.render(scene, width=WIDTH, height=HEIGHT, renderer=renderer, samples=16)
        brightest = np.unravel_index(np.argmax(image.pixels[..., 0]), (HEIGHT, WIDTH))
        assert image.pixels[..., 0].max() > 0.0
        assert brightest == (int(row), int(column))


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_rays_and_vertices_meet_in_the_tables(camera: Camera) -> None:
    """In the tables themselves: the ray through a raster point leads to points that the matrix brings back to it."""
    record = camera_record(camera, WIDTH, HEIGHT, 0.1, 100.0)[0]
    matrix = raster_from_world(camera, WIDTH, HEIGHT, 0.1, 100.0)
    for i, j, t in ((0.0, 0.0, 1.0), (12.25, 30.5, 7.0), (60.0, 46.0, 3.0)):
        towards = record["corner"].astype(float) + i * record["dx"].astype(float) + j * record["dy"].astype(float)
        if isinstance(camera, PerspectiveCamera):
            p = record["position"] + t * towards
        else:
            p = record["position"] + towards + t * record["gaze"].astype(float)
        x, y, depth, w = matrix @ (*p, 1.0)
        np.testing.assert_allclose((x / w, y / w, depth), (i, j, t), atol=2e-4)


def test_a_centred_camera_is_what_it_was() -> None:
    """To the bit: without shift and with square pixels the tables are those of the symmetric pyramid."""
    from limner.linear.projection import camera_from_world, clip_from_camera_perspective
    from limner.linear.viewport import viewport

    camera = CAMERAS["centred"]
    assert isinstance(camera, PerspectiveCamera)
    projection = clip_from_camera_perspective(camera.half_height(), WIDTH / HEIGHT, 0.1, 100.0)
    symmetric = viewport(WIDTH, HEIGHT) @ projection @ camera_from_world(camera)
    symmetric[2] = -camera_from_world(camera)[2]
    assert raster_from_world(camera, WIDTH, HEIGHT, 0.1, 100.0).tobytes() == symmetric.tobytes()
    u, v, w = camera.world_from_camera[:3, :3].T
    step = 2.0 * camera.half_height()
    dx, dy = u * (step * WIDTH / HEIGHT / WIDTH), v * (step / HEIGHT)
    record = camera_record(camera, WIDTH, HEIGHT, 0.1, 100.0)[0]
    corner = -w - dx * ((WIDTH - 1) / 2.0) - dy * ((HEIGHT - 1) / 2.0)
    np.testing.assert_allclose(record["corner"], corner.astype(np.float32), rtol=1e-6)
