"""Projection and camera matrices (FoCG 7.1.2, 7.1.3, 7.3): corners of the view volume go to corners of the canonical one."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.linear import projection, transform, viewport
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


@given(st.floats(1.0, 170.0), st.floats(0.2, 5.0), st.floats(0.01, 100.0))
def test_frustum_from_the_field_of_view(yfov_degrees, aspect, near):
    """FoCG 7.5: tan(yfov / 2) = t / |n|, width / height = r / t, symmetric; the same projection as from half the height."""
    window = projection.frustum_from_fov(math.radians(yfov_degrees), aspect, -near)
    assert (window.left, window.bottom) == (-window.right, -window.top)
    assert math.degrees(2.0 * math.atan2(window.top, near)) == pytest.approx(yfov_degrees)
    assert window.right / window.top == pytest.approx(aspect)
    expected = -projection.clip_from_camera_perspective(window.top / near, aspect, near, 10 * near)
    np.testing.assert_allclose(projection.perspective(*window, -near, -10 * near), expected, rtol=1e-9, atol=1e-12)


@given(sides, sides, st.integers(1, 4000), st.integers(1, 4000))
def test_resizing_keeps_what_is_seen_from_bottom_to_top(x, y, width, height):
    """Pixels become square, the vertical field of view and the share off the gaze stay; the same size changes nothing."""
    window = projection.Window(*x, *y)
    new = projection.resized(window, width, height)
    assert (new.bottom, new.top) == (window.bottom, window.top)
    assert (new.right - new.left) / (new.top - new.bottom) == pytest.approx(width / height)
    share = (window.right + window.left) / (window.right - window.left)
    assert (new.right + new.left) / (new.right - new.left) == pytest.approx(share, abs=1e-12)
    np.testing.assert_allclose(projection.resized(new, width, height), new, rtol=1e-12, atol=1e-12)


@given(st.floats(0.05, 5), depths, st.floats(-3, 3), st.floats(-3, 3))
def test_a_part_of_the_window_is_an_off_axis_window(half_height, d, x, y):
    """The crop's clip matrix is the book's projection of the sub-rectangle: l, r, b, t read off the near plane."""
    near, far = d
    width, height, left, bottom, crop_x, crop_y = 640, 480, 100, 50, 320, 300
    whole = projection.clip_from_camera_perspective(half_height, width / height, near, far)
    part = viewport.crop(width, height, left, bottom, crop_x, crop_y) @ whole
    pixel = 2.0 * near * half_height / height
    l, b = (left - width / 2) * pixel, (bottom - height / 2) * pixel  # noqa: E741
    book = projection.perspective(l, l + crop_x * pixel, b, b + crop_y * pixel, -near, -far)
    np.testing.assert_allclose(part, -book, rtol=1e-9, atol=1e-9)
    point = np.array([x, y, -near - 1.0, 1.0])
    seen = divided(viewport.viewport(width, height) @ whole @ point)
    np.testing.assert_allclose(divided(viewport.viewport(crop_x, crop_y) @ part @ point), seen - [left, bottom, 0], rtol=1e-9, atol=1e-6)


@given(st.floats(-math.pi, math.pi), st.floats(0.0, 2.0), st.floats(-9, -1))
def test_oblique_projection(angle, foreshortening, z):
    """A line away from the viewer is drawn at the angle, its length times the factor; what faces the viewer keeps its shape."""
    m = projection.orthographic(-10, 10, -10, 10, 0, -20) @ projection.oblique(angle, foreshortening)
    start, end, beside = (divided(m @ [*p, 1.0])[:2] * 10 for p in ((1, 2, 0), (1, 2, z), (1.5, 2, z)))
    drawn = -z * foreshortening * np.array([math.cos(angle), math.sin(angle)])
    np.testing.assert_allclose(end - start, drawn, atol=1e-12)
    np.testing.assert_allclose(beside - end, [0.5, 0.0], atol=1e-12)


def test_cavalier_and_cabinet():
    """The unit cube's depth is drawn at 45 degrees, in its own length or half of it."""
    for project, length in ((projection.cavalier, 1.0), (projection.cabinet, 0.5)):
        np.testing.assert_allclose((project() @ [0, 0, -1, 1])[:2], length * math.sqrt(0.5) * np.ones(2), atol=1e-15)
        np.testing.assert_array_equal(project(0.3), projection.oblique(0.3, length))


@given(st.floats(0.05, 5), st.floats(0.2, 5), depths)
def test_depth_as_others_write_it(half_height, aspect, d):
    """OpenGL's own matrix; [0, 1] and reversed; with an infinite far plane, reversed depth is near / depth: the z-buffer's number."""
    near, far = d
    clip = projection.clip_from_camera_perspective(half_height, aspect, near, far)
    opengl = projection.depth_range(-1, 1) @ clip
    expected = [[1 / (aspect * half_height), 0, 0, 0], [0, 1 / half_height, 0, 0]]
    expected += [[0, 0, (far + near) / (near - far), 2 * far * near / (near - far)], [0, 0, -1, 0]]
    np.testing.assert_allclose(opengl, expected, rtol=1e-9)
    for at_near, at_far in ((0, 1), (1, 0), (1, -1), (0.25, 0.75)):
        m = projection.depth_range(at_near, at_far) @ clip
        for depth, z in ((near, at_near), (far, at_far)):
            assert divided(m @ [0, 0, -depth, 1])[2] == pytest.approx(z, abs=1e-6)
    endless = projection.depth_range(1, 0) @ projection.clip_from_camera_perspective(half_height, aspect, near)
    for depth in (near, 3.0 * near, 1e9 * near):
        assert divided(endless @ [0, 0, -depth, 1])[2] == pytest.approx(near / depth, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(
    "m",
    [
        projection.perspective(-1, 2, -3, 1, -0.5, -20),
        projection.orthographic(-1, 2, -3, 1, 5, -20),
        projection.orthographic(-1, 2, -3, 1, 5, -20) @ projection.cabinet(),
        projection.clip_from_camera_perspective(0.5, 1.5, 0.1),
        projection.off_centre(projection.clip_from_camera_perspective(0.5, 1.5, 0.1, 10.0), 0.3, -0.7),
        projection.depth_range(1, 0) @ projection.clip_from_camera_perspective(0.5, 1.5, 0.1),
        viewport.crop(640, 480, 10, 20, 64, 32) @ projection.clip_from_camera_perspective(0.5, 1.5, 0.1),
        viewport.viewport(640, 480) @ projection.perspective(-1, 2, -3, 1, -0.5, -20),
    ],
)
def test_projections_are_inverted_by_their_structure(m):
    np.testing.assert_allclose(projection.inverse_projection(m) @ m, np.eye(4), atol=1e-12)
    np.testing.assert_allclose(projection.inverse_projection(m), np.linalg.inv(m), rtol=1e-9, atol=1e-12)


def test_divide():
    """FoCG 7.2: (x, y, z, w) is (x/w, y/w, z/w); for w = 0 there is no point."""
    found = projection.divided([[2, 4, 6, 2], [-1, 2, 3, -1], [1, 2, 3, 0]])
    np.testing.assert_array_equal(found, [[1, 2, 3], [1, -2, -3], [math.nan] * 3])


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
        lambda: projection.frustum_from_fov(math.pi, 1.0, -1.0),
        lambda: projection.frustum_from_fov(1.0, 0.0, -1.0),
        lambda: projection.frustum_from_fov(1.0, 1.0, 1.0),
        lambda: projection.resized(projection.Window(-1, 1, -1, 1), 0, 10),
        lambda: projection.inverse_projection(transform.scale(1, 1, 0)),
        lambda: projection.inverse_projection(transform.rotate_z(1.0)),
    ],
)
def test_impossible_views_are_refused(call):
    """Near behind far, nothing wide, nothing high, infinite box: one line for people, no division by zero."""
    with pytest.raises(SceneError):
        call()
