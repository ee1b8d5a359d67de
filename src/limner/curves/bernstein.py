"""The Bernstein basis: how much each control point pulls on a Bézier curve (FoCG 15.6.1).

The basis functions of degree n are the terms of ``(u + (1 - u))^n = 1``: none is negative on [0, 1] and they sum to one, so a
curve is a weighted mean of its control points and stays in their convex hull. They mirror, ``b_k(u) = b_{n-k}(1 - u)``, and at
the ends they are exactly 0 or 1: two pieces that meet in a control point meet there to the bit.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["basis", "basis_columns", "basis_derivatives", "binomials", "product", "roots"]

_GREATEST_PRODUCT = 1000  # degree up to which binomials and powers are within the range of float64
_SMALL_DEGREE = 16
_ROOT_WIDTH = 2.0**-44
_SAME_ROOT = 1e-7  # what rounding makes of a double root


def basis(degree: int, u: ArrayLike) -> NDArray[np.float64]:
    """Evaluate the Bernstein polynomials ``b_{k,n}(u) = C(n,k) u^k (1-u)^(n-k)``, k = 0..n.

    Parameters
    ----------
    degree : int >= 0
        n.
    u : (...) float
        Any real number; the convex hull property holds in [0, 1].

    Returns
    -------
    (..., n + 1) float64

    Examples
    --------
    >>> basis(3, 0.5).tolist()
    [0.125, 0.375, 0.375, 0.125]

    **Source**: Marschner and Shirley, *Fundamentals of Computer Graphics*, 4th ed., 2015, 15.6.1.
    """
    if degree < 0:
        raise SceneError(f"the degree of a Bernstein basis must not be negative, got {degree}")
    t = np.asarray(u, dtype=np.float64)[..., None]
    k = np.arange(degree + 1)
    if degree > _GREATEST_PRODUCT:
        return _large_basis(degree, t, k)
    return binomials(degree) * t**k * (1.0 - t) ** (degree - k)


def binomials(degree: int) -> NDArray[np.float64]:
    """(degree + 1,) float64: C(degree, k), each the nearest number.

    >>> binomials(4).tolist()
    [1.0, 4.0, 6.0, 4.0, 1.0]
    """
    return np.array([math.comb(degree, k) for k in range(degree + 1)], dtype=np.float64)


def basis_columns(degree: int, u: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Evaluate the basis function by function, for many parameters (k,): by products where the degree is low, for powers are slow."""
    if degree > _SMALL_DEGREE:
        return list(basis(degree, u).T)
    v = 1.0 - u
    falling = [v]
    for _ in range(degree - 1):
        falling.append(falling[-1] * v)
    weights = [falling[degree - 1]] if degree else [np.ones_like(u)]
    rising = u
    for k, binomial in enumerate(binomials(degree)[1:-1].tolist(), start=1):
        weights.append(rising * falling[degree - k - 1])
        weights[-1] *= binomial
        rising = rising * u
    return [*weights, rising] if degree else weights


def _large_basis(degree: int, t: NDArray[np.float64], k: NDArray[np.int64]) -> NDArray[np.float64]:
    """The basis by logarithms: 1000 digits of a binomial fit in no float64. Outside [0, 1] it overflows, and is infinite."""
    logs = np.array([math.lgamma(degree + 1) - math.lgamma(j + 1) - math.lgamma(degree - j + 1) for j in k.tolist()])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        powers = np.where(k > 0, k * np.log(np.abs(t)), 0.0) + np.where(k < degree, (degree - k) * np.log(np.abs(1.0 - t)), 0.0)
        sign = np.sign(t) ** (k % 2) * np.sign(1.0 - t) ** ((degree - k) % 2)
        return np.asarray(sign * np.exp(logs + powers))


def basis_derivatives(degree: int, u: ArrayLike) -> NDArray[np.float64]:
    """Evaluate the derivatives ``b'_{k,n}(u) = n (b_{k-1,n-1}(u) - b_{k,n-1}(u))``.

    Parameters
    ----------
    degree : int >= 0
    u : (...) float

    Returns
    -------
    (..., n + 1) float64
        They sum to zero, as the basis sums to one.

    **Source**: Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 5.3.
    """
    if degree == 0:
        return np.zeros((*np.shape(u), 1))
    lower = basis(degree - 1, u)
    zero = np.zeros((*lower.shape[:-1], 1))
    made: NDArray[np.float64] = degree * (np.concatenate([zero, lower], axis=-1) - np.concatenate([lower, zero], axis=-1))
    return made


def product(first: ArrayLike, second: ArrayLike) -> NDArray[np.float64]:
    """Multiply two polynomials that are given by their Bernstein coefficients.

    Parameters
    ----------
    first : (m + 1, ...) float
    second : (n + 1, ...) float
        Of shapes that broadcast beyond the first axis.

    Returns
    -------
    (m + n + 1, ...) float64
        ``c_k = sum_{i + j = k} C(m, i) C(n, j) a_i b_j / C(m + n, k)``

    **Source**: Farouki and Rajan, "Algorithms for polynomials in Bernstein form", *CAGD* 5(1), 1988, 4.2.
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    m, n = len(a) - 1, len(b) - 1
    of_a, of_b, of_both = binomials(m), binomials(n), binomials(m + n)
    made = np.zeros((m + n + 1, *np.broadcast_shapes(a.shape[1:], b.shape[1:])))
    for i in range(m + 1):
        for j in range(n + 1):
            made[i + j] += of_a[i] * of_b[j] / of_both[i + j] * (a[i] * b[j])
    return made


def roots(coefficients: ArrayLike) -> NDArray[np.float64]:
    """Find where a polynomial that is given by its Bernstein coefficients is zero in [0, 1].

    A polynomial has no more roots than its coefficients have changes of sign: halves without a change are left out, in halves with
    one change the root is alone.

    Parameters
    ----------
    coefficients : (n + 1,) float

    Returns
    -------
    (k,) float64
        In order; multiple roots once, to half the digits, and so those that are nearer to each other than 1e-7. None for the polynomial
        that is zero everywhere.

    Examples
    --------
    >>> roots([-1.0, 1.0]).tolist()
    [0.5]

    **Source**: Lane and Riesenfeld, "Bounds on a polynomial", *BIT* 21, 1981.
    """
    first = np.asarray(coefficients, dtype=np.float64)
    size = float(np.abs(first).max(initial=0.0))
    if not size > 0.0:
        return np.zeros(0)
    found = [end for end, value in ((0.0, first[0]), (1.0, first[-1])) if abs(value) <= 1e-15 * size]
    waiting = [(0.0, 1.0, first)]
    negligible = 1e-15 * size
    while waiting:
        low, high, here = waiting.pop()
        signs = np.sign(here[np.abs(here) > negligible])
        middle = 0.5 * (low + high)
        changes = int((signs[1:] != signs[:-1]).sum())
        if len(signs) == 0 or (changes and high - low < _ROOT_WIDTH):
            found.append(middle)
        elif changes == 1 and min(abs(here[0]), abs(here[-1])) > negligible:
            found.append(low + (high - low) * _lone_root(here))
        elif changes:
            left, right = _halves(here)
            if abs(right[0]) <= negligible:
                found.append(middle)
            waiting += [(low, middle, left), (middle, high, right)]
    return _apart(np.sort(np.array(found)))


def _halves(coefficients: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    level, left, right = coefficients, [coefficients[0]], [coefficients[-1]]
    while len(level) > 1:
        level = 0.5 * (level[:-1] + level[1:])
        left.append(level[0])
        right.append(level[-1])
    return np.array(left), np.array(right[::-1])


def _lone_root(coefficients: NDArray[np.float64]) -> float:
    """The one root between coefficients whose ends differ in sign: regula falsi (Illinois), and halving where that does not get on."""
    degree = len(coefficients) - 1
    low, high, at_low, at_high = 0.0, 1.0, float(coefficients[0]), float(coefficients[-1])
    kept = 0
    for step in range(200):
        middle = high - at_high * (high - low) / (at_high - at_low) if step % 3 != 2 else 0.5 * (low + high)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        value = float(basis(degree, middle) @ coefficients)
        if value == 0.0 or high - low < 2e-16:
            return middle
        # An end that stays twice counts half
        if value * at_high > 0.0:
            high, at_high, at_low, kept = middle, value, at_low * (0.5 if kept > 0 else 1.0), 1
        else:
            low, at_low, at_high, kept = middle, value, at_high * (0.5 if kept < 0 else 1.0), -1
    return 0.5 * (low + high)


def _apart(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Each value once: neighbours that rounding has split are one, in their middle."""
    if len(values) == 0:
        return values
    groups = np.split(values, np.flatnonzero(np.diff(values) > _SAME_ROOT) + 1)
    # An end is an end, to the bit
    return np.array([0.0 if group[0] == 0.0 else 1.0 if group[-1] == 1.0 else group.mean() for group in groups])
