"""Transformation matrices (FoCG 6): each by its closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.errors import SceneError
from limner.linear import quaternion, transform

angles = st.floats(-10.0, 10.0)
numbers = st.integers(-192, 192).map(lambda n: n / 64.0)  # products of three are exact, and none is too small to be divided by
matrices = arrays(np.float64, (3, 3), elements=numbers)
X, Y, Z = np.eye(3)


def affine(linear, translation=(0.0, 0.0, 0.0)) -> np.ndarray:
    m = np.eye(4)
    m[:3, :3], m[:3, 3] = linear, translation
    return m


def test_scale_stretches_along_the_axes():
    """FoCG 6.1.1; one number scales alike; a negative one reflects (6.1.4)."""
    np.testing.assert_array_equal(transform.transform_points(transform.scale(2, 3, 4), [1, 1, 1]), [2, 3, 4])
    np.testing.assert_array_equal(transform.scale(2), transform.scale(2, 2, 2))
    np.testing.assert_array_equal(transform.transform_points(transform.scale(-1, 1, 1), [1, 2, 3]), [-1, 2, 3])


@pytest.mark.parametrize(
    ("rotate", "axis", "start", "end"),
    [(transform.rotate_x, X, Y, Z), (transform.rotate_y, Y, Z, X), (transform.rotate_z, Z, X, Y)],
    ids=["x", "y", "z"],
)
@given(angle=angles)
def test_rotations_turn_counter_clockwise(rotate, axis, start, end, angle):
    """FoCG 6.2: the axis stays, a quarter turn takes the next axis to the one after it; the inverse is the transpose (6.4)."""
    m = rotate(angle)
    np.testing.assert_allclose(transform.transform_vectors(m, axis), axis, atol=1e-15)
    turned = np.cos(angle) * start + np.sin(angle) * end
    np.testing.assert_allclose(transform.transform_vectors(m, start), turned, atol=1e-15)
    np.testing.assert_allclose(m @ m.T, np.eye(4), atol=1e-15)


@given(angles, angles)
def test_products_compose_from_right_to_left(first, second):
    """FoCG 6.1.5: one matrix for both steps, and the order matters."""
    point = np.array([1.0, 2.0, 3.0])
    move, turn = transform.translate(first, second, 1.0), transform.rotate_z(first)
    both = transform.transform_points(turn @ move, point)
    np.testing.assert_allclose(both, transform.transform_points(turn, transform.transform_points(move, point)), atol=1e-12)


def test_translation_moves_points_and_not_vectors():
    """FoCG 6.3: the homogeneous coordinate of a vector is 0."""
    m = transform.translate(1, 2, 3)
    np.testing.assert_array_equal(transform.transform_points(m, [[1, 1, 1]]), [[2, 3, 4]])
    np.testing.assert_array_equal(transform.transform_vectors(m, [[1, 1, 1]]), [[1, 1, 1]])


@given(matrices)
def test_normal_matrix_is_the_inverse_transpose_up_to_scale(linear):
    """FoCG 6.2.2: N^T A = |det A| I for every matrix, and so N = |det A| A^-T wherever there is an inverse; exact numbers.

    Bug: NumPy's determinant divided by the least numbers that floats can hold, and warned. Fix: no such numbers, no determinant.
    """
    a, b, c = linear.T
    determinant = abs(a @ np.cross(b, c))
    normals = transform.normal_matrix(affine(linear))
    np.testing.assert_array_equal(normals.T @ linear, determinant * np.eye(3))
    if determinant >= 1e-3:
        np.testing.assert_allclose(normals, determinant * np.linalg.inv(linear).T, atol=1e-6)


@given(matrices, arrays(np.float64, (2, 3), elements=numbers))
def test_normals_stay_at_right_angles(linear, tangents):
    """A shear bends tangents and normal differently, and they stay perpendicular; a mirror keeps the normal outside."""
    normal = np.cross(*tangents)
    m = affine(linear)
    moved = transform.transform_vectors(m, tangents)
    scale = np.abs(linear).max() ** 3 * np.abs(tangents).max() ** 3 + 1e-9
    assert np.abs(moved @ (transform.normal_matrix(m) @ normal)).max() < 1e-12 * scale + 1e-9


def test_normals_of_a_flattened_and_a_mirrored_plane():
    """Singular matrices have cofactors where they have no inverse; a mirror does not turn normals inside out."""
    np.testing.assert_array_equal(transform.transform_normals(transform.scale(2, 0, 3), Y), Y)
    np.testing.assert_array_equal(transform.transform_normals(transform.scale(-1, 1, 1), Y), Y)
    np.testing.assert_array_equal(transform.transform_normals(transform.scale(-1, 1, 1), X), -X)
    np.testing.assert_array_equal(transform.transform_normals(transform.scale(0), X), [0, 0, 0])


@given(angles)
def test_compose_trs_is_translation_times_rotation_times_scale(angle):
    """A quaternion (0, sin a/2, 0, cos a/2) turns by a about y; its length does not matter, and zero turns nothing."""
    quaternion = 3.0 * np.array([0.0, np.sin(angle / 2), 0.0, np.cos(angle / 2)])
    expected = transform.translate(1, 2, 3) @ transform.rotate_y(angle) @ transform.scale(4, 5, 6)
    np.testing.assert_allclose(transform.compose_trs((1, 2, 3), quaternion, (4, 5, 6)), expected, atol=1e-12)
    np.testing.assert_array_equal(transform.compose_trs((0, 0, 0), (0, 0, 0, 0), (1, 1, 1)), np.eye(4))


@given(arrays(np.float64, (3, 3), elements=numbers))
def test_frame_from_gaze_is_the_book_s_uvw(vectors):
    """FoCG 7.1.3: orthonormal and right-handed, -w along the gaze, v in the plane of gaze and up, on up's side."""
    eye, gaze, up = vectors
    if np.linalg.norm(np.cross(gaze, up)) < 1e-2:
        return
    m = transform.frame_from_gaze(eye, gaze, up)
    u, v, w = m[:3, :3].T
    np.testing.assert_allclose(m[:3, :3].T @ m[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.cross(u, v), w, atol=1e-12)
    np.testing.assert_allclose(-w * np.linalg.norm(gaze), gaze, atol=1e-12)
    assert abs(u @ up) < 1e-10
    assert v @ up > 0.0
    np.testing.assert_array_equal(m[:3, 3], eye)


def test_numbers_may_be_arrays():
    """One matrix for each number, the same as one at a time."""
    angle = np.linspace(-3.0, 3.0, 6).reshape(2, 3)
    for make in (transform.rotate_x, transform.rotate_y, transform.rotate_z):
        many = make(angle)
        assert many.shape == (2, 3, 4, 4)
        np.testing.assert_array_equal(many[1, 2], make(angle[1, 2]))
    np.testing.assert_array_equal(transform.translate(angle, 2.0, 3.0)[0, 1], transform.translate(angle[0, 1], 2.0, 3.0))
    np.testing.assert_array_equal(transform.scale(angle, 1.0, 3.0)[0, 1], transform.scale(angle[0, 1], 1.0, 3.0))
    np.testing.assert_array_equal(transform.shear_x(angle, 1.0)[0, 1], transform.shear_x(angle[0, 1], 1.0))
    axes = np.stack([np.cos(angle), np.sin(angle), angle], axis=-1)
    np.testing.assert_allclose(transform.rotate(axes, angle)[1, 1], transform.rotate(axes[1, 1], angle[1, 1]), atol=1e-15)
    np.testing.assert_allclose(transform.reflect(axes, axes)[1, 1], transform.reflect(axes[1, 1], axes[1, 1]), atol=1e-15)
    turned = quaternion.from_axis_angle(axes, angle)
    np.testing.assert_allclose(
        transform.compose_trs(axes, turned, 2.0 * axes)[0, 2], transform.compose_trs(axes[0, 2], turned[0, 2], 2.0 * axes[0, 2]), atol=1e-15
    )
    frames = transform.frame_from_gaze(axes, axes, (0.0, 1.0, 0.5))
    np.testing.assert_allclose(frames[0, 2], transform.frame_from_gaze(axes[0, 2], axes[0, 2], (0.0, 1.0, 0.5)), atol=1e-15)
    np.testing.assert_allclose(transform.normal_matrix(frames)[1, 0], transform.normal_matrix(frames[1, 0]), atol=1e-15)
    np.testing.assert_allclose(
        transform.transform_normals(frames, axes)[1, 0], transform.transform_normals(frames[1, 0], axes[1, 0]), atol=1e-15
    )


@pytest.mark.parametrize(
    ("m", "row"),
    [
        (transform.shear_x(2, 3), [[1, 2, 3], [0, 1, 0], [0, 0, 1]]),
        (transform.shear_y(2, 3), [[1, 0, 0], [2, 1, 3], [0, 0, 1]]),
        (transform.shear_z(2, 3), [[1, 0, 0], [0, 1, 0], [2, 3, 1]]),
        (transform.shear((0, 2, 0), X), [[1, 0, 0], [2, 1, 0], [0, 0, 1]]),
        (transform.shear((5, 2, 3), 7 * Z), [[1, 0, 5], [0, 1, 2], [0, 0, 1]]),
    ],
)
def test_shears_are_the_book_s(m, row):
    """FoCG 6.2: shear-x(d_y, d_z) and its fellows; what a push has along the normal is left out."""
    np.testing.assert_array_equal(m, affine(row))


def test_reflections_across_the_planes_of_the_axes():
    """FoCG 6.1.4: the component across the plane is negated."""
    for axis in (X, Y, Z):
        np.testing.assert_array_equal(transform.reflect(axis), transform.scale(*(1 - 2 * axis)))
        np.testing.assert_array_equal(transform.mirror(axis), transform.scale(*(2 * axis - 1)))
    np.testing.assert_array_equal(transform.transform_points(transform.reflect(Y, (0, 3, 0)), [1, 1, 1]), [1, 5, 1])


@given(matrices, angles)
def test_reflections_across_any_plane_and_line(vectors, angle):
    """Points of the mirror stay, a step across it is reversed, twice is nothing; a mirror in a line is half a turn."""
    normal, point, _ = vectors
    if np.linalg.norm(normal) < 0.1:
        return
    m = transform.reflect(normal, point)
    u, v, _ = transform.basis(normal).T
    within = point + np.cos(angle) * u + np.sin(angle) * v
    np.testing.assert_allclose(transform.transform_points(m, within), within, atol=1e-12)
    np.testing.assert_allclose(transform.transform_points(m, within + normal), within - normal, atol=1e-12)
    np.testing.assert_allclose(m @ m, np.eye(4), atol=1e-12)
    np.testing.assert_allclose(transform.mirror(normal, point), transform.rotate_about(point, normal, np.pi), atol=1e-12)


@given(matrices, angles)
def test_rotation_about_any_axis_by_the_book_and_by_quaternion(vectors, angle):
    """FoCG 6.2.1: the axis stays, a step across it turns by the angle, and quaternions say the same."""
    axis, point, _ = vectors
    if np.linalg.norm(axis) < 0.1:
        return
    m = transform.rotate(axis, angle)
    u, v, w = transform.basis(axis).T
    np.testing.assert_allclose(np.stack([u, v, w]) @ np.stack([u, v, w]).T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(np.cross(u, v), w, atol=1e-14)
    np.testing.assert_allclose(transform.transform_vectors(m, axis), axis, atol=1e-12)
    np.testing.assert_allclose(transform.transform_vectors(m, u), np.cos(angle) * u + np.sin(angle) * v, atol=1e-13)
    np.testing.assert_allclose(m[:3, :3], quaternion.to_matrix(quaternion.from_axis_angle(axis, angle)), atol=1e-13)
    turned = transform.rotate_about(point, axis, angle)
    np.testing.assert_allclose(transform.transform_points(turned, point + axis), point + axis, atol=1e-12)


@pytest.mark.parametrize(("axis", "rotate"), [(X, transform.rotate_x), (Y, transform.rotate_y), (Z, transform.rotate_z)])
def test_rotation_about_the_axes_is_the_book_s(axis, rotate):
    np.testing.assert_allclose(transform.rotate(3 * axis, 0.7), rotate(0.7), atol=1e-15)


@pytest.mark.parametrize("size", [1e-200, 1e-8, 1e8, 1e150])
def test_normals_of_the_very_small_and_the_very_great(size):
    """Cofactors are products of two numbers, which could vanish; normals do not."""
    m = transform.scale(size, 2 * size, size) @ transform.shear_x(1.0, 0.0)
    np.testing.assert_allclose(transform.transform_normals(m, X), np.array([2, -1, 0]) / np.sqrt(5.0), atol=1e-12)


@pytest.mark.parametrize(
    "call",
    [
        lambda: transform.rotate((0, 0, 0), 1.0),
        lambda: transform.reflect((0, 0, 0)),
        lambda: transform.mirror((0, 0, 0)),
        lambda: transform.shear(X, (0, 0, 0)),
        lambda: transform.rotate([X, 0 * X], 1.0),
        lambda: transform.rotate((np.nan, 0, 0), 1.0),
    ],
)
def test_directions_without_direction_are_refused(call):
    with pytest.raises(SceneError, match="direction"):
        call()
