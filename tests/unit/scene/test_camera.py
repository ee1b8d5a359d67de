"""Cameras as people hold them: poses, fields of view, shifts; what is seen where; what is refused."""

from __future__ import annotations

import json
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError, UnsupportedError
from limner.linear import pose, projection, transform
from limner.linear.viewport import viewport
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.framing import framing_camera

coordinates = st.tuples(*[st.floats(-20, 20)] * 3)
lenses = st.fixed_dictionaries({"shift_x": st.floats(-2, 2), "shift_y": st.floats(-2, 2), "pixel_aspect": st.floats(0.25, 4.0)})
sizes = st.tuples(st.integers(1, 2000), st.integers(1, 2000))


@st.composite
def poses(draw):
    """A rigid world_from_camera: any direction, any roll."""
    frame = transform.rotate_z(draw(st.floats(-3.1, 3.1)))
    frame = transform.rotate_y(draw(st.floats(-3.1, 3.1))) @ transform.rotate_x(draw(st.floats(-1.5, 1.5))) @ frame
    return transform.translate(*draw(coordinates)) @ frame


@st.composite
def cameras(draw):
    """Either kind, anywhere, off centre, with pixels of any shape."""
    fields = {"world_from_camera": draw(poses()), **draw(lenses)}
    if draw(st.booleans()):
        return PerspectiveCamera(yfov_degrees=draw(st.floats(1, 170)), **fields)
    return OrthographicCamera(height=draw(st.floats(0.01, 100)), **fields)


# --- where it stands --------------------------------------------------------------------------------------------------------


@given(coordinates, st.floats(0.01, 100), st.floats(-360, 360), st.floats(-89, 89))
def test_orbit_is_look_at_from_a_point_of_the_sphere(target, distance, azimuth, elevation):
    """The eye in spherical coordinates, then the book's frame with +y up."""
    a, e = math.radians(azimuth), math.radians(elevation)
    eye = np.add(target, distance * np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)]))
    orbit = PerspectiveCamera.orbit(target, distance, azimuth, elevation)
    np.testing.assert_allclose(orbit.world_from_camera, PerspectiveCamera.look_at(eye, target).world_from_camera, atol=1e-6)


@pytest.mark.parametrize("elevation", [-90.0, 90.0])
def test_orbit_passes_the_poles(elevation):
    """Straight from above and below, where no `up` along y would do: the limit of what is near, and a rotation."""
    at = PerspectiveCamera.orbit((1, 2, 3), 4.0, 25.0, elevation).world_from_camera
    near = PerspectiveCamera.orbit((1, 2, 3), 4.0, 25.0, elevation * (1 - 1e-9)).world_from_camera
    np.testing.assert_allclose(at, near, atol=1e-7)
    np.testing.assert_allclose(at[:3, :3].T @ at[:3, :3], np.eye(3), atol=1e-15)
    assert np.linalg.det(at[:3, :3]) == pytest.approx(1.0)


def test_orbit_and_framing_agree_on_angles():
    """The same azimuth and elevation mean the same axes."""
    framed = framing_camera([[-1, -1, -1], [1, 1, 1]], 1.5, azimuth_degrees=50.0, elevation_degrees=-35.0)
    orbit = PerspectiveCamera.orbit((0, 0, 0), 1.0, 50.0, -35.0)
    np.testing.assert_allclose(framed.world_from_camera[:3, :3], orbit.world_from_camera[:3, :3], atol=1e-15)


# --- what it shows ----------------------------------------------------------------------------------------------------------


def test_fields_of_view_in_other_words():
    """A lens, a horizontal angle, a vertical one: the same window."""
    assert PerspectiveCamera.from_focal_length(12.0).yfov_degrees == pytest.approx(90.0)
    assert PerspectiveCamera.from_focal_length(25.0, 50.0).yfov_degrees == pytest.approx(90.0)
    assert PerspectiveCamera.from_xfov(90.0, 2.0).half_height() == pytest.approx(0.5)
    assert PerspectiveCamera.look_at((0, 0, 1), (0, 0, 0), focal_length_mm=12.0).yfov_degrees == pytest.approx(90.0)
    assert PerspectiveCamera.orbit((0, 0, 0), 1.0, xfov_degrees=90.0, aspect=2.0).half_height() == pytest.approx(0.5)
    assert PerspectiveCamera.from_focal_length(35.0).focal_length_mm() == pytest.approx(35.0)


@given(cameras(), sizes)
def test_the_window_is_the_book_s(camera, size):
    """K is the book's viewport times its projection with l, r, b, t anywhere, seen from the top left: for points in view."""
    width, height = size
    half_height, pixel_aspect, shift_x, shift_y = camera.lens()
    half_width = half_height * pixel_aspect * width / height
    left, right = (shift_x - 1) * half_width, (shift_x + 1) * half_width
    bottom, top = (shift_y - 1) * half_height, (shift_y + 1) * half_height
    if isinstance(camera, PerspectiveCamera):
        book = -projection.perspective(left, right, bottom, top, -1.0, -9.0)  # on the near plane, at distance 1
    else:
        book = projection.orthographic(left, right, bottom, top, -1.0, -9.0)
    inside = np.array([[0.3, -0.2, -2.0], [-1.0, 2.0, -5.0]]) * (1, 1, 1)
    clip = viewport(width, height) @ book @ np.c_[inside, np.ones(2)].T
    expected = np.stack([clip[0] / clip[3], height - 1 - clip[1] / clip[3]], axis=1)
    xy, depth = camera.project(transform.transform_points(camera.world_from_camera, inside), width, height)
    np.testing.assert_allclose(xy, expected, rtol=1e-6, atol=1e-6 * max(size) * max(1.0, 1 / half_height, 1 / half_width))
    np.testing.assert_allclose(depth, [2.0, 5.0], atol=1e-9)
    np.testing.assert_allclose(projection.clip_from_camera(camera, width, height, 1.0, 9.0), book, rtol=1e-9, atol=1e-9 / half_height)


@given(cameras(), sizes, st.lists(st.tuples(st.floats(-50, 2050), st.floats(-50, 2050), st.floats(0.01, 1e4)), min_size=1))
def test_project_undoes_unproject(camera, size, seen):
    """Any pixel at any depth, through the world and back."""
    xy, depth = np.array(seen)[:, :2], np.array(seen)[:, 2]
    points = camera.unproject(xy, depth, *size)
    again, depth_again = camera.project(points, *size)
    reach = 1.0 + np.abs(points).max() + 40.0
    pixels_per_metre = camera.intrinsics(*size)[[0, 1], [0, 1]].max()
    loss = 1e-14 * reach * pixels_per_metre * (1.0 / depth.min() if isinstance(camera, PerspectiveCamera) else 1.0)
    np.testing.assert_allclose(again, xy, rtol=0, atol=1e-6 + loss * (1.0 + np.abs(xy).max() / pixels_per_metre))
    np.testing.assert_allclose(depth_again, depth, rtol=1e-9, atol=1e-13 * reach)


def test_what_is_not_in_front_of_the_eye_is_seen_nowhere():
    """NaN beside and behind the eye and for what is not finite, with the depth that it has; parallel projection sees behind."""
    points = [[0.0, 0.0, -1.0], [3.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 2.0], [math.nan, 0.0, -1.0], [math.inf, 0.0, -1.0]]
    xy, depth = PerspectiveCamera().project(points, 10, 10)
    assert np.isfinite(xy).all(axis=1).tolist() == [True, False, False, False, False, False]
    assert depth[:4].tolist() == [1.0, 0.0, 0.0, -2.0]
    xy, _ = OrthographicCamera().project(points, 10, 10)
    assert np.isfinite(xy).all(axis=1).tolist() == [True, True, True, True, False, False]
    assert xy[3].tolist() == [9.5, -0.5]


def test_shapes_go_through():
    """One point, a picture of points; a depth of infinity is no point."""
    camera = PerspectiveCamera(yfov_degrees=90.0)
    xy, depth = camera.project((0.0, 0.0, -2.0), 3, 3)
    assert (xy.tolist(), depth.shape, float(depth)) == ([1.0, 1.0], (), 2.0)
    y, x = np.indices((4, 5))
    points = camera.unproject(np.stack([x, y], axis=-1), np.full((4, 5), 2.0), 5, 4)
    assert points.shape == (4, 5, 3)
    np.testing.assert_allclose(camera.project(points, 5, 4)[0], np.stack([x, y], axis=-1), atol=1e-12)
    assert camera.project(np.zeros((0, 3)), 5, 4)[0].shape == (0, 2)
    assert np.isnan(camera.unproject((0.0, 0.0), math.inf, 5, 4)).all()
    assert np.isnan(OrthographicCamera().unproject((0.0, 0.0), math.inf, 5, 4)).all()


def test_a_camera_is_a_plain_value():
    """It pickles, and its fields are what JSON can hold."""
    camera = PerspectiveCamera.from_opencv([[9.0, 0, 4.0], [0, 8.0, 3.0], [0, 0, 1]], np.eye(4), 10, 8, name="left")
    again = pickle.loads(pickle.dumps(camera))
    assert all(np.array_equal(value, vars(again)[name]) for name, value in vars(camera).items())
    json.dumps({name: value for name, value in vars(camera).items() if not isinstance(value, np.ndarray)})
    assert camera.replace(shift_x=0.5).shift_x == 0.5


# --- in the words of others -------------------------------------------------------------------------------------------------


@given(
    poses(), sizes, st.floats(1, 5000), st.floats(1, 5000), st.floats(-3000, 3000), st.floats(-3000, 3000)
)  # fmt: skip
def test_opencv_and_back(world_from_camera, size, fx, fy, cx, cy):
    """K and pose come back, whatever the principal point and the shape of the pixels."""
    K = [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]
    world_to_camera = np.diag([1.0, -1.0, -1.0, 1.0]) @ np.linalg.inv(world_from_camera)
    camera = PerspectiveCamera.from_opencv(K, world_to_camera, *size)
    K_again, pose_again = camera.to_opencv(*size)
    np.testing.assert_allclose(K_again, K, rtol=1e-9, atol=1e-9 * max(*size, 3000))
    np.testing.assert_allclose(pose_again, world_to_camera, atol=1e-12)
    np.testing.assert_allclose(camera.world_from_camera, world_from_camera, atol=1e-12)
    half = PerspectiveCamera.from_opencv(K, world_to_camera[:3], *size, near=0.5, name="a")
    assert (half.near, half.name) == (0.5, "a")


def test_opencv_pixels_are_counted_from_the_centre_of_the_first():
    """A camera at the origin looking along +z, y down: K's principal point is where the gaze goes, in a picture of any size."""
    camera = PerspectiveCamera.from_opencv([[100.0, 0, 7.0], [0, 100.0, 3.0], [0, 0, 1]], np.eye(4), 20, 10)
    xy, depth = camera.project([[0.0, 0.0, 2.0], [0.02, 0.04, 2.0]], 20, 10)
    np.testing.assert_allclose(xy, [[7.0, 3.0], [8.0, 5.0]], atol=1e-12)
    assert depth.tolist() == [2.0, 2.0]
    # Twice the size: what was the left side of pixel 7 is that of pixel 14.
    np.testing.assert_allclose(camera.project([[0.0, 0.0, 2.0]], 40, 20)[0], [[14.5, 6.5]], atol=1e-12)


@given(cameras().filter(lambda c: isinstance(c, PerspectiveCamera)), sizes)
def test_opengl_and_colmap_and_back(camera, size):
    """The pose as it is; the quaternion, the translation and the parameters, and again the same camera."""
    seen = camera.unproject([[0.0, 0.0], [size[0], 3.0]], [1.0, 2.0], *size)
    opengl = PerspectiveCamera.from_opengl(camera.to_opengl(), K=camera.intrinsics(*size), width=size[0], height=size[1])
    colmap = PerspectiveCamera.from_colmap(*camera.to_colmap(*size), *size)
    qvec, tvec, params = camera.to_colmap(*size)
    assert np.linalg.norm(qvec) == pytest.approx(1.0)
    np.testing.assert_allclose(-pose.rotation_from_quaternion(qvec, "q").T @ tvec, camera.world_from_camera[:3, 3], atol=1e-9)
    assert params[2:] == pytest.approx(camera.intrinsics(*size)[:2, 2] + 0.5)
    for other in (opengl, colmap):
        scale = 1e-9 * (1.0 + np.abs(camera.intrinsics(*size)).max())
        np.testing.assert_allclose(other.intrinsics(*size), camera.intrinsics(*size), rtol=1e-9, atol=scale)
        np.testing.assert_allclose(other.world_from_camera, camera.world_from_camera, atol=1e-9)
        np.testing.assert_allclose(other.unproject([[0.0, 0.0], [size[0], 3.0]], [1.0, 2.0], *size), seen, rtol=1e-6, atol=1e-6)


def test_colmap_s_centres_stand_at_a_half():
    """A principal point in the middle of COLMAP's picture is (w - 1)/2, (h - 1)/2 here; SIMPLE_PINHOLE has one focal length."""
    camera = PerspectiveCamera.from_colmap((1, 0, 0, 0), (0, 0, 0), (50.0, 10.0, 5.0), 20, 10)
    assert (camera.shift_x, camera.shift_y, camera.pixel_aspect) == (0.0, 0.0, 1.0)
    assert camera.to_opencv(20, 10)[0].tolist() == pytest.approx(np.array([[50, 0, 9.5], [0, 50, 4.5], [0, 0, 1]]))
    turned = PerspectiveCamera.from_colmap((0.5, 0.5, 0.5, 0.5), (1, 2, 3), (50.0, 40.0, 10.0, 5.0), 20, 10)
    np.testing.assert_allclose(turned.world_from_camera[:3, 3], [-2, -3, -1], atol=1e-15)  # -R^T t, R cycles x y z


@given(poses())
def test_quaternions_survive(frame):
    """Rotation to quaternion to rotation, near half turns too; the sign is fixed."""
    rotation = frame[:3, :3]
    q = pose.quaternion_from_rotation(rotation)
    np.testing.assert_allclose(pose.rotation_from_quaternion(q, "q"), rotation, atol=1e-14)
    assert q[np.flatnonzero(q)[0]] > 0.0


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.8, 0), (0, -0.6, 0.8)])
def test_half_turns_have_quaternions(axis):
    """Where the scalar part is zero, division by it would fail."""
    rotation = 2.0 * np.outer(axis, axis) - np.eye(3)
    q = pose.quaternion_from_rotation(rotation)
    assert q[0] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(pose.rotation_from_quaternion(q, "q"), rotation, atol=1e-15)


def test_poses_of_six_digits_become_rigid():
    """What a text file has rounded is turned into the nearest rotation; the eye stays where it was."""
    exact = PerspectiveCamera.look_at((1, 2, 3), (0, 0.5, 0))
    rounded = exact.to_opencv(10, 10)[1].round(6)
    made = PerspectiveCamera.from_opencv(exact.intrinsics(10, 10), rounded.tolist(), 10, 10).world_from_camera
    np.testing.assert_allclose(made[:3, :3].T @ made[:3, :3], np.eye(3), atol=1e-15)
    np.testing.assert_allclose(made, exact.world_from_camera, atol=1e-5)


# --- what is refused --------------------------------------------------------------------------------------------------------

K = np.array([[100.0, 0, 50], [0, 100, 50], [0, 0, 1]])


def _changed(row: int, column: int, value: float) -> np.ndarray:
    changed = K.copy()
    changed[row, column] = value
    return changed


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (_changed(0, 0, 0.0), "positive focal lengths"),
        (_changed(1, 1, -5.0), "positive focal lengths"),
        (_changed(1, 0, 1.0), r"upper triangular, got K\[1, 0\] = 1"),
        (_changed(2, 2, 2.0), "0 0 1 as its last row"),
        (_changed(0, 2, math.nan), "K must be finite"),
        (np.eye(4), r"3x3 matrix, got shape \(4, 4\)"),
        ("focal", "3x3 matrix of numbers"),
    ],
)
def test_a_bad_K_is_refused(matrix, message):
    """With what was expected and what was found."""
    with pytest.raises(SceneError, match=message):
        PerspectiveCamera.from_opencv(matrix, np.eye(4), 100, 100)


def test_skew_is_unsupported():
    """And the message says what can be done; what rounding leaves of none is none."""
    with pytest.raises(UnsupportedError, match="resample the pictures without it"):
        PerspectiveCamera.from_opencv(_changed(0, 1, 2.0), np.eye(4), 100, 100)
    PerspectiveCamera.from_opencv(_changed(0, 1, 1e-12), np.eye(4), 100, 100)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.diag([2.0, 2.0, 2.0, 1.0]), "must be rigid, without scale or shear"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "not a reflection"),
        (np.eye(3), r"4x4 or 3x4 matrix, got shape \(3, 3\)"),
        (np.full((4, 4), math.nan), "must be finite"),
        (np.eye(4)[[0, 1, 2, 2]], "0 0 0 1 as its last row"),
        ([[1, 2], [3]], "matrix of numbers"),
    ],
)
def test_a_bad_pose_is_refused(matrix, message):
    """By every reader, by its own name."""
    with pytest.raises(SceneError, match=f"world_to_camera.*{message}"):
        PerspectiveCamera.from_opencv(K, matrix, 100, 100)
    with pytest.raises(SceneError, match=f"camera_to_world.*{message}"):
        PerspectiveCamera.from_opengl(matrix, yfov_degrees=30.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PerspectiveCamera(shift_x=math.nan), "camera.shift_x must be finite"),
        (lambda: PerspectiveCamera(pixel_aspect=0.0), "camera.pixel_aspect must be positive"),
        (lambda: OrthographicCamera(shift_y=math.inf), "camera.shift_y must be finite"),
        (lambda: OrthographicCamera(height=-1.0), "camera.height must be positive"),
        (lambda: PerspectiveCamera(yfov_degrees=180.0), "between 0 and 180"),
        (lambda: PerspectiveCamera(near=2.0, far=1.0), "camera.near must be less than camera.far"),
        (lambda: PerspectiveCamera.look_at((1, 1, 1), (1, 1, 1)), "must differ"),
        (lambda: PerspectiveCamera.look_at((0, 0, 1), (0, 0, 0), (0, 0, 2)), "camera.up"),
        (lambda: PerspectiveCamera.orbit((0, 0, 0), 0.0), "distance must be positive"),
        (lambda: PerspectiveCamera.orbit((0, 0, 0), 1.0, 0.0, 91.0), r"elevation_degrees must lie in \[-90, 90\]"),
        (lambda: PerspectiveCamera.orbit((0, 0), 1.0), "camera.target must be three numbers"),
        (lambda: PerspectiveCamera.orbit((0, 0, 0), 1.0, math.nan), "azimuth_degrees must be finite"),
        (lambda: PerspectiveCamera.from_focal_length(-5.0), "focal_length_mm must be positive"),
        (lambda: PerspectiveCamera.from_focal_length(5.0, 0.0), "sensor_height_mm must be positive"),
        (lambda: PerspectiveCamera.from_focal_length(5.0, yfov_degrees=3.0), "said once, got yfov_degrees and focal_length_mm"),
        (lambda: PerspectiveCamera.from_xfov(200.0, 1.0), "xfov_degrees must lie between 0 and 180"),
        (lambda: PerspectiveCamera.look_at((0, 0, 1), (0, 0, 0), xfov_degrees=60.0), "xfov_degrees needs aspect"),
        (lambda: PerspectiveCamera.look_at((0, 0, 1), (0, 0, 0), sensor_height_mm=24.0), "needs focal_length_mm"),
        (lambda: PerspectiveCamera.from_opengl(np.eye(4), K=K), "K needs the width and height"),
        (lambda: PerspectiveCamera.from_opencv(K, np.eye(4), 0, 10), "width must be an integer of at least 1, got 0"),
        (lambda: PerspectiveCamera.from_opencv(K, np.eye(4), 10, 2.5), "height must be an integer of at least 1, got 2.5"),
        (lambda: PerspectiveCamera.from_colmap((0, 0, 0, 0), (0, 0, 0), (1, 1, 1), 2, 2), "qvec must not be zero"),
        (lambda: PerspectiveCamera.from_colmap((1, 0, 0), (0, 0, 0), (1, 1, 1), 2, 2), "qvec must be 4 finite numbers"),
        (lambda: PerspectiveCamera.from_colmap((1, 0, 0, 0), (0, 0), (1, 1, 1), 2, 2), "tvec must be three numbers"),
        (lambda: PerspectiveCamera().project([[1.0, 2.0]], 5, 5), r"points must have shape \(\.\.\., 3\), got \(1, 2\)"),
        (lambda: PerspectiveCamera().project("all", 5, 5), "points must be numbers"),
        (lambda: PerspectiveCamera.from_colmap((1, 0, 0, 0), (0, 0, 0), (1, 1, 1), 2, 2, model="PINHOLE"), "4 params, got 3"),
        (lambda: PerspectiveCamera().unproject(np.zeros((2, 2)), np.zeros(3), 5, 5), "depth must have the shape of xy"),
        (lambda: PerspectiveCamera(world_from_camera=np.diag([1, 2, 1, 1.0])).to_opencv(5, 5), "must be rigid"),
    ],
)
def test_a_slip_is_told(make, message):
    """One line: what, what was expected, what was found."""
    with pytest.raises(SceneError, match=message):
        make()


@pytest.mark.parametrize(("params", "model"), [((1, 1, 1, 1, 0.1, 0.1), None), ((1, 1, 1, 0.1), "SIMPLE_RADIAL")])
def test_distorted_colmap_cameras_are_unsupported(params, model):
    """With how to undistort; SIMPLE_RADIAL has as many parameters as PINHOLE, only its name tells."""
    with pytest.raises(UnsupportedError, match="image_undistorter"):
        PerspectiveCamera.from_colmap((1, 0, 0, 0), (0, 0, 0), params, 2, 2, model=model)
