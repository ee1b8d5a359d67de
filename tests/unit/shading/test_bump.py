"""Bump maps (FoCG 11.4): the normals shown are those of the surface that is truly displaced, on every shape, however it is scaled."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, interior, place, scene_of

from limner.image.image import Image
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import BlinnPhong, Lambert, Material, MetallicRoughness
from limner.scene.procedural import Gradient, Marble, Noise
from limner.scene.shape import Box, Cone, Cylinder, Disk, Plane, Sphere, Torus
from limner.scene.texture import Texels, Texture

pytestmark = SLOW_AS_PYTHON

WAVES = Marble(amount=0.0, scale=0.5)  # 1/2 + 1/2 sin pi x
LOOKING_DOWN = OrthographicCamera.look_at((0, 4, 0), (0, 0, 0), up=(0, 0, -1), height=2.4, near=0.1, far=9.0)


def _normals(geometry: Any, material: Material, matrix: Any = None, camera: Camera = LOOKING_DOWN, renderer: str = "raster") -> Image:
    """Normals and positions of a shape, 20 x 20 pixels."""
    node = place(geometry, material, matrix=np.eye(4) if matrix is None else matrix)
    aovs = ("normal", "normal_geometric", "position", "uv", "instance_id")
    return render(scene_of(node, camera=camera), width=20, height=20, renderer=renderer, samples=1, aovs=aovs)


def _unit(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


@pytest.mark.parametrize("renderer", ["raster", "ray"])
@pytest.mark.parametrize(
    "matrix",
    [np.eye(4), np.diag([3.0, 3.0, 3.0, 1.0]), np.diag([1.0, 0.25, 2.0, 1.0]), transform.rotate_x(0.4) @ np.diag([-1.0, 2.0, 1.0, 1.0])],
    ids=["as it is", "scaled", "squeezed", "mirrored"],
)
def test_a_plane_has_the_normals_of_its_displaced_self(matrix, renderer):
    """y = s h(x) in object space has the normal (-s h', 1, 0), and the world that of the inverse transpose: exact, whatever the scale."""
    scale = 0.3
    image = _normals(Plane(), Lambert(bump_texture=WAVES, bump_scale=scale), matrix, renderer=renderer)
    p = transform.transform_points(np.linalg.inv(matrix), image.aov["position"].reshape(-1, 3).astype(np.float64))
    slope = scale * 0.5 * np.pi * np.cos(np.pi * p[:, 0])
    object_normal = np.stack([-slope, np.ones_like(slope), np.zeros_like(slope)], axis=-1)
    expected = _unit(object_normal @ np.linalg.inv(matrix[:3, :3]))
    expected *= np.where(expected[:, 1:2] < 0.0, -1.0, 1.0)
    np.testing.assert_allclose(image.aov["normal"].reshape(-1, 3), expected, atol=8e-3)


def test_a_ball_has_the_normals_of_its_displaced_self():
    """p + h n for a small h: normals by differences of displaced points, to first order in h."""
    height = 0.02
    bumps = Noise(scale=2.5)
    image = _normals(Sphere(1.0), Lambert(bump_texture=bumps, bump_scale=height))
    inside = interior(image.aov["instance_id"]) & (image.aov["instance_id"] == 0)
    smooth = image.aov["normal_geometric"][inside].astype(np.float64)
    shown = image.aov["normal"][inside].astype(np.float64)
    bent = np.linalg.norm(shown - smooth, axis=1)
    assert bent.max() < 2.5 * height * 2.5
    assert bent.mean() > 0.2 * height
    # Twice the height bends twice as far, a negative one the other way.
    for factor in (2.0, -1.0):
        other = _normals(Sphere(1.0), Lambert(bump_texture=bumps, bump_scale=factor * height)).aov["normal"][inside]
        np.testing.assert_allclose(other - smooth, factor * (shown - smooth), atol=6.0 * bent.max() ** 2)


@pytest.mark.parametrize("make", [Lambert, BlinnPhong, lambda **fields: MetallicRoughness(double_sided=True, **fields)])
def test_bumps_are_dents_from_behind(make):
    """The two sides of a plane show opposite normals."""
    material = make(bump_texture=WAVES, bump_scale=0.3)
    above = _normals(Plane(), material).aov["normal"]
    looking_up = OrthographicCamera.look_at((0, -4, 0), (0, 0, 0), up=(0, 0, -1), height=2.4, near=0.1, far=9.0)
    below = _normals(Plane(), material, camera=looking_up).aov["normal"]
    np.testing.assert_allclose(below[:, ::-1], -above, atol=2e-5)
    assert np.abs(above[..., 0]).max() > 0.2


SHAPES = {
    "sphere": Sphere(0.9), "box": Box((1.2, 0.8, 1.0)), "disk": Disk(1.0), "cylinder": Cylinder(0.6, 1.2), "cone": Cone(0.8, 1.2),
    "torus": Torus(0.7, 0.3), "plane": Plane(), "mesh": primitives.uv_sphere(32, 16, 0.9),
}  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_heights_on_texture_coordinates_bend_every_shape(name):
    """A ramp that rises along u alone, and one along v: the bent normal loses what is its slope, grad h, along the surface.

    The slope is measured on the picture: where u and the place change from a pixel to its neighbour, du = grad u . dp.
    """
    geometry, exactness = SHAPES[name], 0.2 if name == "mesh" else 0.06
    camera = PerspectiveCamera.look_at((1.0, 2.4, 1.8), (0, 0, 0), yfov_degrees=26)
    for channel, axis in ((0, (1, 0, 0)), (1, (0, 1, 0))):
        ramp = Gradient(axis=axis, mapping="uv", wrap="clamp", scale=0.125, offset=(0.5, 0, 0))
        image = _normals(geometry, Lambert(bump_texture=ramp, bump_scale=0.8), camera=camera, renderer="ray")
        smooth = _normals(geometry, Lambert(), camera=camera, renderer="ray")
        n, bent = smooth.aov["normal"].astype(np.float64), image.aov["normal"].astype(np.float64)
        gradient = n - bent / np.maximum((bent * n).sum(axis=-1, keepdims=True), 1e-3)
        p, h = smooth.aov["position"].astype(np.float64), 0.1 * smooth.aov["uv"][..., channel].astype(np.float64)
        same = interior(smooth.aov["instance_id"]) & (smooth.aov["instance_id"] == 0)
        same = same[1:-1, 1:-1]
        checked = 0
        for dy, dx in ((0, 1), (1, 0)):
            after, before = (slice(1 + dy, 19 + dy), slice(1 + dx, 19 + dx)), (slice(1 - dy, 19 - dy), slice(1 - dx, 19 - dx))
            dp, dh = p[after] - p[before], h[after] - h[before]
            even = same & (np.abs((n[after] * n[before]).sum(axis=-1)) > 0.97) & (np.abs(dh) < 0.02)
            predicted = (gradient[1:-1, 1:-1] * dp).sum(axis=-1)
            assert np.median(np.abs(predicted - dh)[even]) < exactness * np.median(np.abs(dh)[even]) + 2e-5
            checked += even.sum()
        assert checked > 40


def test_a_picture_of_heights_bends_as_its_slope():
    """A texture whose texels rise by a level each has this slope everywhere but at its seam, magnified or reduced."""
    n = 32
    rising = np.zeros((n, n, 4), np.float32)
    rising[..., 0] = np.arange(n) / n
    texture = Texture(Texels(rising, srgb=False), wrap_u="clamp", scale=(0.25, 1.0), offset=(0.5, 0.0))
    image = _normals(Plane(), Lambert(bump_texture=texture, bump_scale=2.0))
    slope = -image.aov["normal"][..., 0] / image.aov["normal"][..., 1]
    np.testing.assert_allclose(slope, 0.5, atol=0.02)


def test_normal_maps_bend_every_material_alike():
    """Lambert and BlinnPhong show the normals that MetallicRoughness shows."""
    pixels = np.full((4, 4, 4), 255, np.uint8)
    pixels[..., :3] = np.random.default_rng(2).integers(100, 200, (4, 4, 3))
    fields = {"normal_texture": Texture(Texels(pixels, srgb=False), filter="bilinear"), "normal_scale": 0.7}
    expected = _normals(Sphere(0.9), MetallicRoughness(double_sided=True, **fields)).aov["normal"]
    smooth = _normals(Sphere(0.9), Lambert()).aov["normal"]
    assert np.abs(expected - smooth)[8:12, 8:12].max() > 0.05
    for material in (Lambert(**fields), BlinnPhong(**fields)):
        np.testing.assert_array_equal(_normals(Sphere(0.9), material).aov["normal"], expected)
