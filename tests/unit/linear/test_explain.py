"""The whole chain, point to pixel and pixel to ray (FoCG 7): every step is its matrix, and the ends are those of the camera."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.errors import SceneError
from limner.linear import transform
from limner.linear.explain import pixel_to_ray, point_to_pixel
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera

WIDTH, HEIGHT = 320, 200
PLACE = {"eye": (1, 2, 5), "target": (0, 0.5, 0), "up": (0.1, 1, 0)}
CAMERAS: list[Camera] = [
    PerspectiveCamera.look_at(**PLACE, yfov_degrees=50),
    PerspectiveCamera.look_at(**PLACE, yfov_degrees=50, near=1.0, far=20.0, shift_x=0.3, shift_y=-0.5, pixel_aspect=1.5),
    OrthographicCamera.look_at(**PLACE, height=4.0),
    OrthographicCamera.look_at(**PLACE, height=4.0, near=2.0, far=9.0, shift_x=-0.7, pixel_aspect=0.5),
]
cameras = st.sampled_from(CAMERAS)
points = arrays(np.float64, 3, elements=st.floats(-1, 1))


@given(cameras, points)
def test_the_end_is_where_the_camera_sees_the_point(camera, point):
    """And each step but the divide is its matrix times the step before."""
    steps = point_to_pixel(camera, point, WIDTH, HEIGHT)
    assert [step.space for step in steps] == ["world", "camera", "clip", "ndc", "raster", "pixel"]
    xy, depth = camera.project(point, WIDTH, HEIGHT)
    np.testing.assert_allclose(steps.at("pixel"), xy, atol=1e-10)
    assert -steps.at("camera")[2] == pytest.approx(depth)
    for before, after in itertools.pairwise(steps):
        start = np.append(before.coordinates, 1.0)[:4]
        if after.matrix is None:
            np.testing.assert_allclose(after.coordinates, start[:3] / start[3], atol=1e-12)
        else:
            np.testing.assert_allclose(after.coordinates, (after.matrix @ start)[: len(after.coordinates)], atol=1e-10)


@given(cameras, points)
def test_the_way_back(camera, point):
    """The ray through the pixel in which a point is seen meets the point, at its depth."""
    x, y = point_to_pixel(camera, point, WIDTH, HEIGHT).at("pixel")
    steps = pixel_to_ray(camera, x, y, WIDTH, HEIGHT)
    assert [step.space for step in steps] == ["pixel", "raster", "ndc", "clip", "camera", "world", "ray"]
    origin, direction = np.array(steps.at("world")), np.array(steps.at("ray"))
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    np.testing.assert_allclose(np.cross(point - origin, direction), 0.0, atol=1e-9)
    np.testing.assert_allclose(origin, camera.unproject((x, y), -steps.at("camera")[2], WIDTH, HEIGHT), atol=1e-10)
    if isinstance(camera, PerspectiveCamera):
        eye = camera.world_from_camera[:3, 3]
        np.testing.assert_allclose(np.cross(origin - eye, direction), 0.0, atol=1e-9)
        np.testing.assert_allclose((point - eye) / np.linalg.norm(point - eye), direction, atol=1e-9)
    else:
        np.testing.assert_allclose(direction, -camera.world_from_camera[:3, 2], atol=1e-12)
    # Pixel, raster and the canonical square are the forward way's, on the near plane; so are clip and camera after it.
    forward = point_to_pixel(camera, origin, WIDTH, HEIGHT)
    for space in ("raster", "ndc", "clip", "camera"):
        np.testing.assert_allclose(steps.at(space)[:2], forward.at(space)[:2], atol=1e-8)


@pytest.mark.parametrize("camera", [CAMERAS[1], CAMERAS[3]])
def test_near_and_far_are_the_camera_s(camera):
    """A point on the near plane has depth +1, on the far plane -1; the caller's planes go first."""
    for depth, z in ((camera.near, 1.0), (camera.far, -1.0)):
        point = camera.unproject((10.0, 20.0), depth, WIDTH, HEIGHT)
        assert point_to_pixel(camera, point, WIDTH, HEIGHT).at("ndc")[2] == pytest.approx(z)
        nearer = point_to_pixel(camera, point, WIDTH, HEIGHT, near=0.5, far=depth)
        assert nearer.at("ndc")[2] == pytest.approx(-1.0)
    assert pixel_to_ray(camera, 10, 20, WIDTH, HEIGHT).at("camera")[2] == pytest.approx(-camera.near)


def test_an_object_s_own_space():
    """FoCG 6: with the object's place there is one step more."""
    place = transform.translate(0, 1, 0) @ transform.rotate_y(0.5)
    steps = point_to_pixel(CAMERAS[0], (0.5, 0, 0), WIDTH, HEIGHT, world_from_object=place)
    assert [step.space for step in steps[:2]] == ["object", "world"]
    world = steps.at("world")
    np.testing.assert_allclose(world, transform.transform_points(place, (0.5, 0, 0)))
    assert steps.at("pixel") == point_to_pixel(CAMERAS[0], world, WIDTH, HEIGHT).at("pixel")


def test_behind_the_eye_nothing_is_seen():
    """The divide would turn the point over; it is not done, and the text says why."""
    steps = point_to_pixel(CAMERAS[0], (2, 4, 10), WIDTH, HEIGHT)
    assert steps.at("clip")[3] < 0.0
    assert all(math.isnan(value) for value in steps.at("pixel"))
    assert "behind the eye" in str(steps)
    assert point_to_pixel(CAMERAS[2], (2, 4, 10), WIDTH, HEIGHT).at("clip")[3] == 1.0


def test_the_text_has_a_line_for_each_step():
    """The space, the numbers, the matrix as the book writes it, the section."""
    steps = point_to_pixel(CAMERAS[0], (0, 0.5, 0), WIDTH, HEIGHT)
    lines = str(steps).splitlines()
    assert len(lines) == len(steps)
    for line, step in zip(lines, steps, strict=True):
        assert line.startswith(step.space)
        assert step.matrix_name in line
    assert "(159.5, 99.5)" in lines[-1]  # the target is seen in the middle
    assert "7.1.3" in lines[1]


@pytest.mark.parametrize("point", [(1, 2), "abc", (1, 2, math.nan), [[1, 2, 3]]])
def test_what_is_no_point_is_refused(point):
    with pytest.raises(SceneError, match="three"):
        point_to_pixel(CAMERAS[0], point, WIDTH, HEIGHT)


def test_other_misuse_is_refused():
    with pytest.raises(SceneError, match=r"width.*got 0"):
        point_to_pixel(CAMERAS[0], (0, 0, 0), 0, 10)
    with pytest.raises(SceneError, match="world, camera"):
        point_to_pixel(CAMERAS[0], (0, 0, 0), 10, 10).at("somewhere")
