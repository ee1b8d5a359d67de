"""Projection and camera matrices (FoCG 7.1.2, 7.1.3, 7.3): corners of the view volume go to corners of the canonical one."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.linear import projection, transform
from limner.scene.camera import OrthographicCamera, PerspectiveCamera

SIGNS = list(itertools.product((-1.0, 1.0), repeat=3))

sides = st.tuples(st.floats(-5, -0.1), st.floats(0.2, 5)).map(lambda s: (s[0], s[0] + s[1]))
depths = st.tuples(st.floats(0.01, 10), st.floats(0.1, 100)).map(lambda d: (d[0], d[0] + d[1]))


def divided(point: np.ndarray) -> np.ndarray:
    return point[:3] / point[3]


@given(sides, sides, depths)
def test_orthographic_maps_the_box_to_the_canonical_volume(x, y, d):
    """M_orth with the book's letters: n, f are z, n > f; near goes to +1."""
    (l, r), (b, t), (n, f) = x, y, (-d[0], -d[1])  # noqa: E741
    m = projection.orthographic(l, r, b, t, n, f)
    for i, j, k in SIGNS:
        corner = [r if i > 0 else l, t if j > 0 else b, n if k > 0 else f, 1.0]
        np.testing.assert_allclose(m @ corner, [i, j, k, 1.0], atol=1e-9)


@given(sides, sides, depths)
def test_perspective_maps_the_pyramid_to_the_canonical_volume(x, y, d):
    """M_per: sides given on the near plane; n and f negative, w = z < 0, near goes to +1 and far to -1."""
    (l, r), (b, t), (n, f) = x, y, (-d[0], -d[1])  # noqa: E741
    m = projection.perspective(l, r, b, t, n, f)
    for i, j, k in SIGNS:
        z = n if k > 0 else f
        corner = m @ [(r if i > 0 else l) * z / n, (t if j > 0 else b) * z / n, z, 1.0]
        assert corner[3] == z
        np.testing.assert_allclose(divided(corner), [i, j, k], rtol=1e-6, atol=1e-6)


@given(st.floats(0.05, 5), st.floats(0.2, 5), depths)
def test_clip_from_camera_is_minus_the_book_s_matrix(half_height, aspect, d):
    """Positive near and far, the same picture, w > 0."""
    near, far = d
    t = near * half_height
    book = projection.perspective(-aspect * t, aspect * t, -t, t, -near, -far)
    np.testing.assert_allclose(projection.clip_from_camera_perspective(half_height, aspect, near, far), -book, rtol=1e-9)


@given(st.floats(0.05, 5), st.floats(0.2, 5), st.floats(0.01, 10))
def test_far_may_be_infinite(half_height, aspect, near):
    """The limit: +1 at the near plane, -1 at infinity, and close to it the matrix of a far far plane."""
    m = projection.clip_from_camera_perspective(half_height, aspect, near, math.inf)
    assert divided(m @ [0, 0, -near, 1])[2] == pytest.approx(1.0)
    assert m[2, 2] == 1.0
    assert divided(m @ [0, 0, -1e12 * near, 1])[2] == pytest.approx(-1.0)
    np.testing.assert_allclose(m, projection.clip_from_camera_perspective(half_height, aspect, near, 1e12 * near), rtol=1e-9)


@given(st.floats(0.05, 5), st.floats(0.2, 5), depths, st.floats(0.0, 1.0))
def test_nearer_is_greater_and_w_is_the_depth(half_height, aspect, d, share):
    """w = -z for every point; normalised depth falls with the distance."""
    near, far = d
    m = projection.clip_from_camera_perspective(half_height, aspect, near, far)
    depth = near + share * (far - near)
    point, behind = m @ [1.0, 2.0, -depth, 1.0], m @ [1.0, 2.0, -depth * 1.01, 1.0]
    assert point[3] == depth
    assert divided(point)[2] > divided(behind)[2]


@pytest.mark.parametrize(("width", "height"), [(640, 480), (100, 300)])
def test_clip_from_camera_reads_both_kinds_of_camera(width, height):
    """The top right corner of what the camera shows, at the near and the far plane, is (1, 1)."""
    aspect = width / height
    pinhole = PerspectiveCamera(yfov_degrees=60.0)
    m = projection.clip_from_camera(pinhole, width, height, 0.5, 20.0)
    for depth, z in ((0.5, 1.0), (20.0, -1.0)):
        top = depth * math.tan(math.radians(30.0))
        np.testing.assert_allclose(divided(m @ [aspect * top, top, -depth, 1.0]), [1, 1, z], atol=1e-12)
    parallel = OrthographicCamera(height=3.0)
    m = projection.clip_from_camera(parallel, width, height, 0.5, 20.0)
    for depth, z in ((0.5, 1.0), (20.0, -1.0)):
        np.testing.assert_allclose(m @ [aspect * 1.5, 1.5, -depth, 1.0], [1, 1, z, 1], atol=1e-12)


def test_the_camera_s_own_aspect_goes_first():
    """A camera that insists on 2:1 shows twice as much across as up, whatever the picture's shape."""
    m = projection.clip_from_camera(PerspectiveCamera(yfov_degrees=90.0, aspect=2.0), 100, 100, 0.1, 10.0)
    np.testing.assert_allclose(divided(m @ [2.0, 1.0, -1.0, 1.0])[:2], [1.0, 1.0], atol=1e-12)


def test_camera_from_world_is_the_inverse_of_the_frame():
    """FoCG 7.1.3: the eye goes to the origin, the target onto -z; frames with scale are inverted too."""
    camera = PerspectiveCamera.look_at((1, 2, 3), (4, 3, -2))
    m = projection.camera_from_world(camera)
    np.testing.assert_allclose(m @ camera.world_from_camera, np.eye(4), atol=1e-14)
    np.testing.assert_allclose(m @ [1, 2, 3, 1], [0, 0, 0, 1], atol=1e-14)
    np.testing.assert_allclose(m @ [4, 3, -2, 1], [0, 0, -math.sqrt(35.0), 1], atol=1e-14)
    scaled = camera.world_from_camera @ transform.scale(2, 3, 4)
    np.testing.assert_allclose(projection.camera_from_world(scaled) @ scaled, np.eye(4), atol=1e-14)


@pytest.mark.parametrize(
    "call",
    [
        lambda: projection.perspective(-1, 1, -1, 1, 1.0, 10.0),
        lambda: projection.perspective(-1, 1, -1, 1, -10.0, -1.0),
        lambda: projection.perspective(1, 1, -1, 1, -1.0, -10.0),
        lambda: projection.orthographic(-1, 1, -1, 1, -10.0, -1.0),
        lambda: projection.clip_from_camera_perspective(1.0, 1.0, 10.0, 1.0),
        lambda: projection.clip_from_camera_perspective(1.0, 1.0, 0.0, 1.0),
        lambda: projection.clip_from_camera_perspective(0.0, 1.0, 1.0, 2.0),
        lambda: projection.clip_from_camera_perspective(math.nan, 1.0, 1.0, 2.0),
        lambda: projection.clip_from_camera_orthographic(1.0, 1.0, 0.0, math.inf),
        lambda: projection.clip_from_camera(PerspectiveCamera(), 0, 10, 1.0, 2.0),
    ],
)
def test_impossible_views_are_refused(call):
    """Near behind far, nothing wide, nothing high, infinite box: one line for people, no division by zero."""
    with pytest.raises(SceneError):
        call()
