"""Interpolating cubic splines: through all points and C2, by one system of equations for all tangents (FoCG 15.5.1).

Every point pulls on the whole curve, less and less with the distance. An open curve needs two more conditions: its ends do not bend
(natural), or leave in given directions (clamped); a closed one goes on where it began. Of all curves through the points the natural one
has the least integral of the squared second derivative.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import hermite
from .control import breaks, control_points
from .curve import Spline

__all__ = ["clamped", "closed", "natural"]

Floats = NDArray[np.float64]


def natural(points: ArrayLike, knots: ArrayLike | None = None) -> Spline:
    """Draw the natural cubic spline through points: f'' is 0 at both ends.

    Parameters
    ----------
    points : (n, d) float, n >= 2
    knots : (n,) float, optional
        Increasing: where the curve is at the points. None: 0, 1, ..., n - 1.

    Returns
    -------
    Spline
        Of degree 3, C2.

    Examples
    --------
    >>> natural([[0.0], [1.0], [0.0]]).derivative([0.0, 1.0], 2).tolist()
    [[0.0], [-3.0]]

    **Source**: de Boor, *A Practical Guide to Splines*, 2001, IV.
    """
    p, h, slope = _legs(points, knots)
    # Neighbours' tangents, then that of the ends: 2 m0 + m1 = 3 slope
    lower, diagonal, upper, right = _inner(h, slope)
    right[0], right[-1] = 3.0 * slope[0], 3.0 * slope[-1]
    upper[0], lower[-1] = 1.0, 1.0
    diagonal[[0, -1]] = 2.0
    return hermite.spline(p, _tridiagonal(lower, diagonal, upper, right), knots)


def clamped(points: ArrayLike, tangents: ArrayLike, knots: ArrayLike | None = None) -> Spline:
    """Draw the cubic spline through points that starts and ends with given derivatives.

    Parameters
    ----------
    points : (n, d) float, n >= 2
    tangents : (2, d) float
        Derivatives at the first and the last point.
    knots : (n,) float, optional

    Returns
    -------
    Spline
        Of degree 3, C2.
    """
    p, h, slope = _legs(points, knots)
    ends = control_points(tangents, 2, "tangents", p.shape[1])
    if len(ends) != 2:
        raise SceneError(f"a clamped spline has 2 tangents, got {len(ends)}")
    lower, diagonal, upper, right = _inner(h, slope)
    right[[0, -1]], diagonal[[0, -1]] = ends, 1.0
    upper[0] = lower[-1] = 0.0
    return hermite.spline(p, _tridiagonal(lower, diagonal, upper, right), knots)


def closed(points: ArrayLike, knots: ArrayLike | None = None) -> Spline:
    """Draw the closed cubic spline through points: C2 also where it comes back to the first.

    Parameters
    ----------
    points : (n, d) float, n >= 3
        The first is not repeated.
    knots : (n + 1,) float, optional
        The last is where the curve is at the first point again.

    Returns
    -------
    Spline
        Of degree 3.
    """
    p = control_points(points, 3)
    ring = np.concatenate([p, p[:1]])
    _, h, slope = _legs(ring, knots)
    before = np.roll(h, 1)
    right = 3.0 * (before[:, None] * slope + h[:, None] * np.roll(slope, 1, axis=0))
    lower, diagonal, upper = h.copy(), 2.0 * (h + before), before.copy()
    # A ring's matrix is a tridiagonal one and a product of two vectors (Sherman and Morrison)
    corner = -diagonal[0]
    column = np.zeros(len(p))
    column[0], column[-1] = corner, upper[-1]
    row_end = lower[0] / corner
    diagonal[0] -= corner
    diagonal[-1] -= upper[-1] * row_end
    both = _tridiagonal(lower, diagonal, upper, np.concatenate([right, column[:, None]], axis=1))
    y, q = both[:, :-1], both[:, -1:]
    share = (y[0] + row_end * y[-1]) / (1.0 + q[0] + row_end * q[-1])
    tangents = y - q * share
    return hermite.spline(ring, np.concatenate([tangents, tangents[:1]]), knots)


def _legs(points: ArrayLike, knots: ArrayLike | None) -> tuple[Floats, Floats, Floats]:
    """Points, the time of each leg, and its mean velocity."""
    p = control_points(points, 2)
    h = np.ones(len(p) - 1) if knots is None else np.diff(breaks(knots, len(p)))
    return p, h, np.diff(p, axis=0) / h[:, None]


def _inner(h: Floats, slope: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Equations that make the second derivative agree at the inner points; the first and the last row are left to fill."""
    n = len(h) + 1
    lower, diagonal, upper, right = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((n, slope.shape[1]))
    lower[1:-1], diagonal[1:-1], upper[1:-1] = h[1:], 2.0 * (h[:-1] + h[1:]), h[:-1]
    right[1:-1] = 3.0 * (h[1:, None] * slope[:-1] + h[:-1, None] * slope[1:])
    return lower, diagonal, upper, right


def _tridiagonal(lower: Floats, diagonal: Floats, upper: Floats, right: Floats) -> Floats:
    """Solve ``lower[k] x[k-1] + diagonal[k] x[k] + upper[k] x[k+1] = right[k]`` by elimination; the diagonal dominates."""
    above, made = np.empty(len(diagonal)), np.array(right)
    pivot = diagonal[0]
    made[0] /= pivot
    for k in range(1, len(diagonal)):
        above[k - 1] = upper[k - 1] / pivot
        pivot = diagonal[k] - lower[k] * above[k - 1]
        made[k] = (made[k] - lower[k] * made[k - 1]) / pivot
    for k in range(len(diagonal) - 2, -1, -1):
        made[k] -= above[k] * made[k + 1]
    return made
