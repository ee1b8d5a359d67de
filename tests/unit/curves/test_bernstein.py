"""The Bernstein basis: its laws hold for every degree and parameter."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.curves.bernstein import basis, basis_derivatives
from limner.errors import SceneError

degrees = st.integers(0, 12)
parameters = st.floats(0.0, 1.0)


@given(degrees, parameters)
def test_basis_is_a_partition_of_unity(degree, u):
    """None is negative and they sum to one: the convex hull property."""
    b = basis(degree, u)
    assert b.min() >= 0.0
    assert b.sum() == pytest.approx(1.0, abs=1e-13)


@given(degrees, parameters)
def test_basis_is_the_binomial_distribution(degree, u):
    """C(n,k) u^k (1-u)^(n-k), with the exponent n - k that the errata puts right."""
    expected = [math.comb(degree, k) * u**k * (1 - u) ** (degree - k) for k in range(degree + 1)]
    np.testing.assert_allclose(basis(degree, u), expected, rtol=1e-13, atol=1e-300)


@given(st.integers(0, 12))
def test_basis_is_exact_at_the_ends(degree):
    """Exactly one of them is 1 at an end, the rest exactly 0: curves that share a control point share that point."""
    assert basis(degree, 0.0).tolist() == [1.0] + [0.0] * degree
    assert basis(degree, 1.0).tolist() == [0.0] * degree + [1.0]


@given(degrees, parameters)
def test_derivatives_sum_to_zero_and_match_differences(degree, u):
    """The derivative of a partition of unity sums to zero, and is what a central difference says."""
    slope = basis_derivatives(degree, u)
    assert slope.sum() == pytest.approx(0.0, abs=1e-11)
    step = 1e-6
    np.testing.assert_allclose(slope, (basis(degree, u + step) - basis(degree, u - step)) / (2 * step), atol=1e-6)


def test_basis_refuses_a_negative_degree():
    with pytest.raises(SceneError, match="degree"):
        basis(-1, 0.5)
