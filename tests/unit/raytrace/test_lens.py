"""Depth of field (FoCG 13.4.3): a point out of focus is a disk of the size that similar triangles tell."""

from __future__ import annotations

import math

import numpy as np
import pytest
from compiled import over
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, checkers, lit_from, place, scene_of

from limner.errors import SceneError
from limner.linear import transform
from limner.raytrace.lens import warp_opening
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Dielectric, Lambert
from limner.scene.node import Node
from limner.scene.shape import Plane, Sphere

DARK = Node(lights=(AmbientLight(intensity=0.0),))
GLOW = Lambert(color=0, emission=(1.0, 1.0, 1.0))
BOTH = pytest.mark.parametrize("renderer", ["ray", "path"])


def _camera(**fields: object) -> PerspectiveCamera:
    return PerspectiveCamera.look_at((0, 0, 0), (0, 0, -1), yfov_degrees=20, **fields)


def _spot(depth: float, size: int, samples: int, **fields: object) -> NDArray[np.float64]:
    scene = scene_of(place(Sphere(0.004 * depth), GLOW, at=(0, 0, -depth)), DARK, camera=_camera(**fields))
    return render(scene, width=size, height=size, renderer="ray", samples=samples).pixels[..., 0].astype(np.float64)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("depth", [2.0, 3.0, 8.0])
def test_circle_of_confusion(depth):
    """A point at depth z, the focus at f, the opening of radius R: a disk of radius R |z - f| / (z f) at distance 1."""
    radius, focus, size = 0.05, 4.0, 161
    pixels = _spot(depth, size, 256, aperture_radius=radius, focus_distance=focus)
    seen = np.argwhere(pixels > 0.02 * pixels.max())
    half_height = _camera().half_height()
    extent = np.ptp(seen, axis=0) / 2 / (size / 2) * half_height
    expected = radius * abs(depth - focus) / (depth * focus)
    np.testing.assert_allclose(extent, expected + 0.004, atol=1.2 / (size / 2) * half_height)
    np.testing.assert_allclose(seen.mean(axis=0), (size - 1) / 2, atol=0.5)
    # an even disk
    inside = np.hypot(*(np.indices(pixels.shape) - (size - 1) / 2)) < 0.7 * expected / half_height * size / 2
    assert pixels[inside].std() < 0.5 * pixels[inside].mean()


@SLOW_AS_PYTHON
def test_what_is_in_focus_is_as_sharp_as_through_a_pinhole():
    """In the plane of the focus, whose depth is measured along the gaze, also at the side of the picture."""
    wall = place(Plane(), Lambert(color=1, texture=checkers(2)), matrix=transform.translate(0.1, 0.1, -4.0) @ transform.rotate_x(np.pi / 2))
    pictures = [
        render(scene_of(wall, lit_from((0, 0, 1)), camera=_camera(**fields)), width=64, height=64, renderer="ray", samples=16).pixels
        for fields in ({}, {"aperture_radius": 0.2, "focus_distance": 4.0}, {"aperture_radius": 0.2, "focus_distance": 3.0})
    ]
    assert np.abs(pictures[1] - pictures[0]).max() < 2e-3
    assert np.abs(pictures[2] - pictures[0]).max() > 0.05


@BOTH
def test_no_opening_is_a_pinhole(renderer):
    """To the bit, wherever the focus is said to be."""
    nodes = (
        place(Sphere(1.0), at=(0, 0, -4)), place(Plane(), Lambert(texture=checkers()), at=(0, -1, 0)),
        place(Sphere(0.3), Dielectric(), at=(0.5, 0, -2)),
    )  # fmt: skip
    pictures = [
        render(scene_of(*nodes, camera=_camera(**fields)), width=32, height=24, renderer=renderer, samples=4).pixels
        for fields in ({}, {"aperture_radius": 0.0}, {"aperture_radius": 0.0, "focus_distance": 2.0, "blades": 5})
    ]
    np.testing.assert_array_equal(pictures[1], pictures[0])
    np.testing.assert_array_equal(pictures[2], pictures[0])


@SLOW_AS_PYTHON
def test_both_renderers_see_through_the_same_lens():
    """An unlit pattern, out of focus: the same means of blocks of pixels."""
    wall = place(Plane(), Lambert(color=0, emission=(1, 1, 1)), at=(0, -1, 0))
    ball = place(Sphere(0.8), Lambert(color=0, emission=(0.1, 0.5, 0.9)), at=(0.4, 0, -6))
    camera = _camera(aperture_radius=0.3, focus_distance=3.0, blades=6)
    pictures = [
        render(scene_of(wall, ball, DARK, camera=camera), width=32, height=32, renderer=renderer, samples=256).pixels
        for renderer in ("ray", "path")
    ]
    # Weighed by what is covered: the colour of a pixel that one sample of all has met is as strong as any.
    blocks = [(picture[..., :3] * picture[..., 3:]).reshape(4, 8, 4, 8, 3).mean(axis=(1, 3)) for picture in pictures]
    np.testing.assert_allclose(blocks[0], blocks[1], atol=0.025)


@SLOW_AS_PYTHON
def test_textures_are_filtered_behind_a_lens():
    """Far checkers blur into grey, as they do through a pinhole, not into noise: neighbours differ no more than there."""
    floor = place(Plane(), Lambert(color=1, texture=checkers(2)), at=(0, -1, 0))
    pictures = [
        render(scene_of(floor, lit_from((0, 1, 0)), camera=_camera(**fields)), width=64, height=64, renderer="ray", samples=1).pixels
        for fields in ({}, {"aperture_radius": 1e-6, "focus_distance": 500.0})
    ]
    far = np.s_[33:36, :, 1]
    np.testing.assert_allclose(pictures[1][far], pictures[0][far], atol=0.02)


@pytest.mark.parametrize("blades", [0, 3, 5, 6, 8])
def test_points_of_the_opening(blades):
    """Uniform over the polygon, or the disk: within it, with its area's moments, and alike on all blades."""
    u, v = (np.stack(np.meshgrid(np.arange(120), np.arange(120))).reshape(2, -1) + 0.5) / 120
    x, y = over(warp_opening, blades, u, v)
    assert (x * x + y * y <= 1 + 1e-6).all()
    np.testing.assert_allclose((x.mean(), y.mean()), 0.0, atol=5e-3)
    # mean of x^2 + y^2: 1/2 of a disk; of a polygon (2 + cos(2 pi/n)) / 6
    moment = 0.5 if blades == 0 else (2 + math.cos(2 * math.pi / blades)) / 6
    assert (x * x + y * y).mean() == pytest.approx(moment, rel=5e-3)
    if blades:
        angle = (np.degrees(np.arctan2(-x, y)) % 360) // (360 / blades)
        counts = np.bincount(angle.astype(int), minlength=blades)[:blades]
        np.testing.assert_allclose(counts, len(x) / blades, rtol=0.06)
        inradius = math.cos(math.pi / blades)
        for k in range(blades):
            normal = 2 * math.pi * (k + 0.5) / blades
            assert (-x * math.sin(normal) + y * math.cos(normal) <= inradius + 1e-5).all()


def test_words_of_photographers():
    """f/1.8 at 90 mm is an opening of 50 mm; in focus is what the camera looks at, unless it is said."""
    camera = PerspectiveCamera.look_at((0, 0, 5), (0, 0, 1), focal_length_mm=90, f_number=1.8)
    assert camera.aperture_radius == pytest.approx(0.025)
    assert camera.focus_distance == pytest.approx(4.0)
    assert PerspectiveCamera.look_at((0, 0, 5), (0, 0, 1), aperture_radius=0.1, focus_distance=2.5).focus_distance == 2.5
    assert PerspectiveCamera.orbit((0, 0, 0), 3.0, aperture_radius=0.1).focus_distance == 3.0
    assert PerspectiveCamera.look_at((0, 0, 5), (0, 0, 1)).focus_distance is None


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"aperture_radius": -0.1, "focus_distance": 1.0}, "camera.aperture_radius must not be negative"),
        ({"aperture_radius": 0.1}, "needs a focus_distance"),
        ({"aperture_radius": 0.1, "focus_distance": -2.0}, "the focus lies behind the camera"),
        ({"aperture_radius": 0.1, "focus_distance": 0.0}, "camera.focus_distance must be positive"),
        ({"aperture_radius": math.inf, "focus_distance": 1.0}, "camera.aperture_radius must be finite"),
        ({"blades": 2}, "camera.blades must be an integer from 3"), ({"blades": 5.0}, "camera.blades must be an integer"),
    ],
)  # fmt: skip
def test_what_is_no_lens(fields, said):
    with pytest.raises(SceneError, match=said):
        PerspectiveCamera(**fields)


def test_what_is_no_f_number():
    with pytest.raises(SceneError, match="f_number needs focal_length_mm"):
        PerspectiveCamera.look_at((0, 0, 5), (0, 0, 0), f_number=2.0)
    with pytest.raises(SceneError, match="the opening must be said once"):
        PerspectiveCamera.look_at((0, 0, 5), (0, 0, 0), f_number=2.0, focal_length_mm=50, aperture_radius=0.1)


def test_raster_says_that_it_has_no_lens():
    scene = scene_of(place(Sphere(1.0), at=(0, 0, -4)), camera=_camera(aperture_radius=0.1, focus_distance=2.0))
    assert [text for text in render(scene, width=8, height=8).warnings if "pinhole" in text]
