"""Transformation matrices (FoCG 6): each by its closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.linear import transform

angles = st.floats(-10.0, 10.0)
matrices = arrays(np.float64, (3, 3), elements=st.floats(-3, 3))
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
    """FoCG 6.2.2: cofactors are |det| times the inverse transpose, wherever there is an inverse."""
    determinant = np.linalg.det(linear)
    if abs(determinant) < 1e-3:
        return
    np.testing.assert_allclose(transform.normal_matrix(affine(linear)), abs(determinant) * np.linalg.inv(linear).T, atol=1e-9)


@given(matrices, arrays(np.float64, (2, 3), elements=st.floats(-3, 3)))
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


@given(arrays(np.float64, (3, 3), elements=st.floats(-3, 3)))
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
