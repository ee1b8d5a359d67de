"""Transformations of the plane (FoCG 6.1): the book's matrices, number by number."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.errors import SceneError
from limner.linear import transform2d as t2

angles = st.floats(-10.0, 10.0)
numbers = st.integers(-192, 192).map(lambda n: n / 64.0)


def test_scale_shear_and_reflection_are_the_book_s():
    """FoCG 6.1.1, 6.1.2, 6.1.4."""
    np.testing.assert_array_equal(t2.scale(2, 3), [[2, 0], [0, 3]])
    np.testing.assert_array_equal(t2.scale(2), [[2, 0], [0, 2]])
    np.testing.assert_array_equal(t2.shear_x(0.5), [[1, 0.5], [0, 1]])
    np.testing.assert_array_equal(t2.shear_y(0.5), [[1, 0], [0.5, 1]])
    np.testing.assert_array_equal(t2.reflect_x() @ [1, 2], [1, -2])
    np.testing.assert_array_equal(t2.reflect_y() @ [1, 2], [-1, 2])


@given(angles)
def test_rotation_is_counter_clockwise(angle):
    """FoCG 6.1.3, and turning turns add."""
    np.testing.assert_array_equal(t2.rotate(angle), [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    np.testing.assert_allclose(t2.rotate(angle) @ t2.rotate(0.25), t2.rotate(angle + 0.25), atol=1e-14)


@given(angles)
def test_reflection_across_any_line(angle):
    """It is: turn the line to x, reflect, turn back; and two reflections make a rotation by twice the angle between the lines."""
    direction = 3.0 * np.array([np.cos(angle), np.sin(angle)])
    turned = t2.rotate(angle) @ t2.reflect_x() @ t2.rotate(-angle)
    np.testing.assert_allclose(t2.reflect(direction), turned, atol=1e-14)
    np.testing.assert_allclose(t2.reflect(direction) @ t2.reflect_x(), t2.rotate(2 * angle), atol=1e-14)
    with pytest.raises(SceneError, match="direction"):
        t2.reflect((0, 0))


@given(angles, arrays(np.float64, (2, 2), elements=numbers))
def test_homogeneous_coordinates(angle, points):
    """FoCG 6.3: points move, vectors do not; a rotation about a point keeps it."""
    point, other = points
    m = t2.translate(*point)
    np.testing.assert_array_equal(m, [[1, 0, point[0]], [0, 1, point[1]], [0, 0, 1]])
    np.testing.assert_array_equal(t2.transform_points(m, other), point + other)
    np.testing.assert_array_equal(t2.transform_vectors(m, other), other)
    turned, right, arm = t2.rotate_about(point, angle), np.array([1.0, 0.0]), np.array([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(t2.transform_points(turned, point), point, atol=1e-12)
    np.testing.assert_allclose(t2.transform_points(turned, point + right), point + arm, atol=1e-12)
    np.testing.assert_allclose(turned, m @ t2.affine(t2.rotate(angle)) @ t2.translate(*-point), atol=1e-12)


@given(arrays(np.float64, (2, 2), elements=numbers), arrays(np.float64, 2, elements=numbers))
def test_normals_of_curves_stay_at_right_angles(linear, tangent):
    """N^T A = |det A| I, exactly; so a normal stays normal under shear, where its own image does not."""
    normals = t2.normal_matrix(linear)
    determinant = abs(linear[0, 0] * linear[1, 1] - linear[0, 1] * linear[1, 0])
    np.testing.assert_array_equal(normals.T @ linear, determinant * np.eye(2))
    normal = np.array([-tangent[1], tangent[0]])
    assert (linear @ tangent) @ (normals @ normal) == 0.0
    assert np.linalg.norm(t2.transform_normals(linear, normal)) == pytest.approx(1.0 if (normals @ normal).any() else 0.0)


def test_numbers_may_be_arrays():
    angle = np.linspace(-1, 1, 6).reshape(2, 3)
    for make in (t2.rotate, t2.shear_x, t2.shear_y, t2.scale, lambda a: t2.translate(a, 1.0)):
        many = make(angle)
        assert many.shape[:2] == (2, 3)
        np.testing.assert_array_equal(many[1, 2], make(angle[1, 2]))
