"""Bézier curves: the sum of weighted points, the corner cutting, and the two halves are one curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.curves.bezier import de_casteljau, derivative, evaluate, split
from limner.errors import SceneError

controls = st.integers(1, 7).flatmap(lambda n: arrays(np.float64, (n, 3), elements=st.floats(-10, 10)))
parameters = st.floats(0.0, 1.0)


@given(controls, parameters)
def test_evaluate_agrees_with_de_casteljau(points, u):
    """Two roads to the same point: Bernstein's sum and repeated linear interpolation."""
    np.testing.assert_allclose(evaluate(points, u), de_casteljau(points, u), atol=1e-12)


@given(controls)
def test_curve_starts_and_ends_in_its_end_points(points):
    """To the bit, so that curves joined at a control point do not gape."""
    np.testing.assert_array_equal(evaluate(points, [0.0, 1.0]), points[[0, -1]])


@given(controls, parameters)
def test_curve_stays_in_the_bounds_of_its_control_points(points, u):
    """A consequence of the convex hull property."""
    at = evaluate(points, u)
    assert (at >= points.min(axis=0) - 1e-12).all()
    assert (at <= points.max(axis=0) + 1e-12).all()


@given(controls, parameters, arrays(np.float64, (3, 3), elements=st.floats(-2, 2)))
def test_curve_is_affinely_invariant(points, u, matrix):
    """The transformed curve is the curve of the transformed points."""
    shift = np.array([1.0, -2.0, 3.0])
    np.testing.assert_allclose(evaluate(points @ matrix.T + shift, u), evaluate(points, u) @ matrix.T + shift, atol=1e-11)


@given(controls, parameters, parameters)
def test_split_draws_the_same_curve(points, u, s):
    """left(s) = f(u s), right(s) = f(u + (1 - u) s), and they meet to the bit."""
    left, right = split(points, u)
    np.testing.assert_allclose(evaluate(left, s), evaluate(points, u * s), atol=1e-11)
    np.testing.assert_allclose(evaluate(right, s), evaluate(points, u + (1 - u) * s), atol=1e-11)
    np.testing.assert_array_equal(left[-1], right[0])


@given(controls, parameters)
def test_derivative_matches_differences(points, u):
    """A central difference of a polynomial of degree 6 errs by h^2."""
    step = 1e-5
    expected = (evaluate(points, u + step) - evaluate(points, u - step)) / (2 * step)
    np.testing.assert_allclose(derivative(points, u), expected, atol=1e-4)


def test_derivative_at_the_ends_is_along_the_legs():
    """f'(0) = n (p1 - p0), f'(1) = n (p_n - p_{n-1}): what C1 joints are built from."""
    points = np.array([[0.0, 0.0], [1.0, 2.0], [3.0, 3.0], [4.0, 0.0]])
    np.testing.assert_allclose(derivative(points, [0.0, 1.0]), [3 * (points[1] - points[0]), 3 * (points[3] - points[2])])


def test_parameters_are_vectorised():
    """Any shape of parameters goes through, the coordinates come last."""
    u = np.linspace(0, 1, 6).reshape(2, 3)
    points = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]
    assert evaluate(points, u).shape == de_casteljau(points, u).shape == derivative(points, u).shape == (2, 3, 2)


def test_no_control_points_are_refused():
    with pytest.raises(SceneError, match="control points"):
        evaluate(np.zeros((0, 2)), 0.5)
