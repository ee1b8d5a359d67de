"""Ray tracing's own effects, where geometry says what must be seen: shadows, mirrors, silhouettes, horizons (FoCG 4)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, checkers, flat_picture, grid, lit_from, place, point_light_at, scene_of, two_triangles

from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import AmbientLight, DirectionalLight, PointLight
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Sphere

DARK = Node(lights=(AmbientLight(intensity=0.0),))
MIRROR = BlinnPhong(diffuse=0, mirror=(1, 1, 1))
LAMP = Lambert(color=0, emission=(1, 1, 1))


def _ray(scene: Scene, width: int = 96, height: int = 72, **options: object) -> NDArray[np.float32]:
    return render(scene, width=width, height=height, renderer="ray", **{"samples": 1, **options}).pixels


# --- what is seen ---------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_silhouette_of_a_sphere(renderer):
    """A sphere of radius r at distance D shows as a circle of radius r / sqrt(D^2 - r^2) at distance 1."""
    height, samples = 64, 64
    for r, distance in ((1.0, 4.0), (1.0, 1.2), (2.0, 30.0)):
        camera = PerspectiveCamera(yfov_degrees=2.4 * math.degrees(math.asin(r / distance)))
        scene = scene_of(place(Sphere(r), at=(0, 0, -distance)), camera=camera)
        alpha = render(scene, width=height, height=height, renderer=renderer, samples=samples).pixels[..., 3]
        radius = height / 2 * r / math.sqrt(distance**2 - r**2) / camera.half_height()
        # The rasteriser's triangles stay within a tenth of a pixel of the sphere.
        assert math.sqrt(alpha.sum() / math.pi) == pytest.approx(radius, abs=0.1 if renderer == "raster" else 0.02)
        np.testing.assert_allclose(alpha, alpha.T, atol=0.15)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_horizon(renderer):
    """An infinite plane ends where rays run level: tan(pitch) / half_height of the picture's half above its middle."""
    for pitch in (-10.0, 0.0, 12.5):
        camera = PerspectiveCamera.look_at((0, 1.7, 0), (0, 1.7 + math.tan(math.radians(pitch)), -1), yfov_degrees=60)
        alpha = render(scene_of(place(Plane()), camera=camera), width=31, height=200, renderer=renderer, samples=16).pixels[..., 3]
        rows = 100 * (1 - math.tan(math.radians(pitch)) / camera.half_height())
        np.testing.assert_allclose(alpha.sum(axis=0), rows, atol=0.07)
        assert ((alpha > 0) & (alpha < 1)).any(axis=1).sum() <= 1


# --- shadows --------------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@pytest.mark.parametrize("ball", [Sphere(0.5), primitives.sphere(0.5, 96)], ids=["exact", "mesh"])
def test_shadow_of_a_sphere_under_a_lamp(ball):
    """A cone round the sphere: on the floor a circle of radius H tan(asin(r / (H - c))) (FoCG 4.7)."""
    lamp, centre, r = 4.0, 1.2, 0.5
    camera = OrthographicCamera.look_at((0, 3, 0), (0, 0, 0), up=(0, 0, -1), height=4.0)
    scene = scene_of(place(Plane()), place(ball, at=(0, centre, 0)), point_light_at((0, lamp, 0), PointLight(intensity=9)), camera=camera)
    image = render(scene, width=256, height=256, renderer="ray", samples=1, aovs=("instance_id",))
    dark = (image.pixels[..., :3].max(axis=2) == 0) | (image.aov["instance_id"] == 1)
    radius = lamp * math.tan(math.asin(r / (lamp - centre)))
    assert dark.sum() * (4 / 256) ** 2 == pytest.approx(math.pi * radius**2, rel=6e-3)
    row, column = np.nonzero(dark)
    assert (row.mean(), column.mean()) == pytest.approx((127.5, 127.5), abs=0.3)


def test_shadow_edge_of_the_sun():
    """A wall of height h under a sun at 45 degrees throws a shadow of length h."""
    wall = two_triangles((-5, 0, 0), (5, 0, 0), (5, 1, 0), (-5, 1, 0))
    camera = OrthographicCamera.look_at((0, 3, 1), (0, 0, 1), up=(0, 0, -1), height=3.0)
    pixels = _ray(scene_of(place(Plane()), place(wall), lit_from((0, 1, -1)), camera=camera), 30, 300)
    z = 1 + ((np.arange(300) + 0.5) / 300 - 0.5) * 3.0
    lit = pixels[:, 15, 0] > 0
    np.testing.assert_array_equal(lit, (z < 0) | (z > 1))


def test_half_transparent_surfaces_let_half_of_the_light_through():
    """A pane of alpha a leaves 1 - a, two leave its square; what is masked out leaves all (FoCG 4.7, 13.1)."""

    def shadow(*panes: Lambert) -> float:
        nodes = [place(grid(2, 1.0), pane, at=(0, 1.0 + 0.1 * k, 0)) for k, pane in enumerate(panes)]
        camera = PerspectiveCamera.look_at((0, 0.5, 3), (0, 0, 0), yfov_degrees=2)
        sun = Node(parent_from_node=transform.rotate_x(-math.pi / 2), lights=(DirectionalLight(intensity=math.pi),))
        return float(_ray(scene_of(place(Plane(), Lambert(color=1)), *nodes, sun, camera=camera), 3, 3)[1, 1, 0])

    pane = Lambert(alpha=0.25, alpha_mode="blend")
    assert shadow() == pytest.approx(1.0, rel=1e-6)
    assert shadow(pane) == pytest.approx(0.75, rel=1e-6)
    assert shadow(pane, pane) == pytest.approx(0.75**2, rel=1e-6)
    assert shadow(pane, Lambert()) == 0.0
    assert shadow(Lambert(alpha=0.25, alpha_mode="mask")) == pytest.approx(1.0, rel=1e-6)
    assert shadow(Lambert(alpha=0.75, alpha_mode="mask")) == 0.0


def test_blended_spheres_and_planes_throw_thin_shadows_too():
    """Bug: an infinite plane counted as opaque for shadow rays, whatever its material."""
    pane = Lambert(alpha=0.25, alpha_mode="blend")
    camera = PerspectiveCamera.look_at((0, 0.5, 3), (0, 0, 0), yfov_degrees=2)
    sun = Node(parent_from_node=transform.rotate_x(-math.pi / 2), lights=(DirectionalLight(intensity=math.pi),))
    for geometry, crossings in ((Plane(), 1), (Sphere(0.3), 2), (Box((1, 0.2, 1)), 2)):
        scene = scene_of(place(Plane(), Lambert(color=1)), place(geometry, pane, at=(0, 2, 0)), sun, camera=camera)
        assert _ray(scene, 3, 3)[1, 1, 0] == pytest.approx(0.75**crossings, rel=1e-5)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3, 1e6])
def test_no_acne_at_any_scale(size):
    """The same scene in other units gives the same picture: nothing shades itself, no shadow leaves its foot."""

    def scene(size: float) -> Scene:
        camera = PerspectiveCamera.look_at(np.array((1.5, 1.2, 2.5)) * size, (0, 0.4 * size, 0), yfov_degrees=45)
        ball = place(primitives.sphere(0.5 * size, 24), at=(-0.6 * size, 0.5 * size, 0))
        return scene_of(
            place(Plane()), ball, place(Sphere(0.4 * size), MIRROR, at=(0.5 * size, 0.4 * size, 0)),
            place(Box((0.3 * size,) * 3), at=(0, 0.15 * size, 0.7 * size)), lit_from((0.5, 1, 0.3)), camera=camera,
        )  # fmt: skip

    expected, seen = _ray(scene(1.0)), _ray(scene(size))
    assert (np.abs(seen - expected).max(axis=2) > 1e-3).mean() < 0.004


@SLOW_AS_PYTHON
def test_no_acne_around_the_origin():
    """Bug: the push off the surface was measured by the point's own coordinates, which vanish at the origin, where the vertices'
    rounding errors do not; a tilted floor, and a mesh moved back from afar, shaded themselves. Fix: by what it was computed from."""
    tilt = transform.rotate_z(0.4) @ transform.rotate_x(0.3)
    sun = Node(parent_from_node=transform.rotate_x(-1.2), lights=(DirectionalLight(intensity=math.pi),))
    camera = PerspectiveCamera.look_at((0.01, 0.5, 0.3), (0, 0, 0))
    cases = [(grid(2, size, tilt), np.eye(4)) for size in (1.0, 30.0, 1000.0)]
    afar = transform.translate(900.0, 800.0, 700.0)
    cases += [(grid(30, size, afar), tilt @ np.linalg.inv(afar)) for size in (1.0, 100.0)]
    for mesh, matrix in cases:
        scene = scene_of(place(mesh, matrix=matrix), sun, camera=camera)
        np.testing.assert_array_equal(_ray(scene, 64, 48), _ray(scene, 64, 48, shadows=False))


# --- mirrors --------------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
def test_a_mirror_shows_the_point_behind_it():
    """What stands before a plane mirror is seen where its mirror image stands (FoCG 4.8)."""
    place_of_lamp = np.array((0.35, 0.2, 0.8))
    wall = two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    camera = PerspectiveCamera.look_at((-0.6, 0.0, 2.0), (0.0, 0.0, 0.0), yfov_degrees=50)
    scene = scene_of(place(wall, MIRROR), place(Sphere(0.02), LAMP, at=place_of_lamp), DARK, camera=camera)
    pixels = _ray(scene, 201, 201, samples=4)[..., 0]
    frame = np.linalg.inv(camera.world_from_camera)
    for point in (place_of_lamp, place_of_lamp * (1, 1, -1)):
        x, y, z, _ = frame @ (*point, 1)
        column = 100 + x / -z / camera.half_height() * 100.5
        row = 100 - y / -z / camera.half_height() * 100.5
        near = np.hypot(*(np.indices(pixels.shape) - np.array((row, column))[:, None, None])) < 6
        weight = pixels * near
        assert weight.sum() > 3
        found = (np.indices(pixels.shape) * weight).sum(axis=(1, 2)) / weight.sum()
        np.testing.assert_allclose(found, (row, column), atol=0.15)
        pixels = np.where(near, 0, pixels)
    assert pixels.max() == 0.0


@pytest.mark.parametrize("depth", range(7))
def test_facing_mirrors_are_a_geometric_series(depth):
    """Two walls that glow with e and reflect m: e (1 - m^(n+1)) / (1 - m) after n reflections."""
    glowing = BlinnPhong(diffuse=0, mirror=(0.5, 0.25, 0.0), emission=(1.0, 2.0, 3.0))
    walls = [place(Plane(), glowing, matrix=transform.translate(0, 0, z) @ transform.rotate_x(math.pi / 2)) for z in (0.0, 2.0)]
    camera = PerspectiveCamera.look_at((0, 0, 1), (0.3, 0.2, 0))
    pixels = _ray(scene_of(*walls, DARK, camera=camera), 8, 6, max_depth=depth)
    m, e = np.array((0.5, 0.25, 0.0)), np.array((1.0, 2.0, 3.0))
    np.testing.assert_allclose(pixels[..., :3], np.broadcast_to(e * (1 - m ** (depth + 1)) / (1 - m), (6, 8, 3)), rtol=1e-5)


def test_a_mirror_before_a_background_shows_the_background():
    wall = two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    tinted = BlinnPhong(diffuse=0, mirror=(0.9, 0.5, 0.1))
    pixels = _ray(scene_of(place(wall, tinted), DARK, camera=flat_picture(), background=(0.2, 0.4, 0.8)), 4, 3)
    np.testing.assert_allclose(pixels[..., :3], np.broadcast_to((0.18, 0.2, 0.08), (3, 4, 3)), rtol=1e-6)
    np.testing.assert_array_equal(pixels[..., 3], 1.0)


@pytest.mark.parametrize("turned", [np.eye(4), transform.translate(0, 0, 3) @ transform.rotate_x(math.pi)], ids=["back", "front"])
def test_only_the_camera_looks_through_the_back_of_one_sided_surfaces(turned):
    """Culling is about what the eye sees; mirrors show both sides, and light is kept off by both."""
    sheet = two_triangles((-9, -9, 1.5), (9, -9, 1.5), (9, 9, 1.5), (-9, 9, 1.5))
    glow = MetallicRoughness(base_color=(1, 0, 0), unlit=True)
    wall = two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    scene = scene_of(place(wall, MIRROR), place(sheet, glow, matrix=turned), DARK, camera=flat_picture())
    assert _ray(scene, 3, 3)[1, 1, 0] == 1.0
    for mode, left in (("opaque", 0.0), ("mask", 0.0), ("blend", 0.0)):
        card = MetallicRoughness(base_color=(1, 0, 0), alpha_mode=mode)
        sun = Node(parent_from_node=transform.translate(0, 0, 5), lights=(PointLight(intensity=5),))
        scene = scene_of(place(wall, Lambert()), place(sheet, card, matrix=turned), sun, camera=flat_picture())
        assert _ray(scene, 3, 3)[1, 1, 0] == left


@SLOW_AS_PYTHON
def test_behind_what_is_masked_textures_are_filtered_as_anywhere():
    """Bug: behind a cut-out or blended surface a camera ray forgot its pixel, and distant textures flickered unfiltered."""
    floor = place(Plane(), Lambert(color=1, texture=checkers(2)))
    pane = two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    camera = PerspectiveCamera.look_at((0, 1, 1), (0, 0.7, -5))
    for absent in (Lambert(alpha=0.0, alpha_mode="mask"), Lambert(alpha=0.0, alpha_mode="blend")):
        plain = _ray(scene_of(floor, camera=camera))
        np.testing.assert_array_equal(_ray(scene_of(floor, place(pane, absent), camera=camera)), plain)
