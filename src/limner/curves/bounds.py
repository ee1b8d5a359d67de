"""Where a Bézier curve lies: the hull of its control points holds it, and the box at its turning points touches it.

**Source**: Andrew, "Another efficient algorithm for convex hulls in two dimensions", *Information Processing Letters* 9(5), 1979.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import bezier
from .bernstein import product, roots
from .control import control_points
from .curve import Spline

__all__ = ["box", "hull", "inflections", "spline_box", "turning_points"]

Floats = NDArray[np.float64]


def hull(points: ArrayLike) -> Floats:
    """Find the convex hull of points in the plane.

    Parameters
    ----------
    points : (n, 2) float

    Returns
    -------
    (k, 2) float64
        Its corners counter-clockwise from the leftmost (of these the lowest); points on its sides are not among them.

    Examples
    --------
    >>> hull([[0, 0], [2, 0], [1, 1], [1, 3], [1, 0]]).tolist()
    [[0.0, 0.0], [2.0, 0.0], [1.0, 3.0]]
    """
    ordered = np.unique(control_points(points, 1, "points", 2), axis=0)
    if len(ordered) < 3:
        return ordered
    lower, upper = _chain(ordered), _chain(ordered[::-1])
    return np.array(lower[:-1] + upper[:-1])


def _chain(ordered: Floats) -> list[Floats]:
    kept: list[Floats] = []
    for p in ordered:
        while len(kept) > 1:
            a, b = kept[-2], kept[-1]
            if (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0.0:
                break
            kept.pop()
        kept.append(p)
    return kept


def turning_points(points: ArrayLike) -> Floats:
    """Parameters in [0, 1] at which a coordinate of the curve turns back, (k,) float64, in order."""
    control = control_points(points)
    if len(control) < 3:
        return np.zeros(0)
    legs = np.diff(control, axis=0)
    return np.unique(np.concatenate([roots(legs[:, axis]) for axis in range(control.shape[1])]))


def box(points: ArrayLike) -> tuple[Floats, Floats]:
    """Find the smallest box, along the axes, that holds the curve for u in [0, 1].

    Parameters
    ----------
    points : (n + 1, d) float
        Control points.

    Returns
    -------
    low, high : (d,) float64

    Examples
    --------
    >>> [corner.tolist() for corner in box([[0, 0], [1, 2], [2, 0]])]
    [[0.0, 0.0], [2.0, 1.0]]
    """
    places = bezier.evaluate(points, np.concatenate([[0.0, 1.0], turning_points(points)]))
    return places.min(axis=0), places.max(axis=0)


def spline_box(spline: Spline) -> tuple[Floats, Floats]:
    """Find the smallest box, along the axes, that holds a whole spline; rational ones too."""
    corners = []
    for k, piece in enumerate(spline.pieces):
        turns = _rational_turning_points(piece) if spline.rational else turning_points(piece)
        low, high = spline.knots[k], spline.knots[k + 1]
        corners.append(spline.at(low + (high - low) * np.concatenate([[0.0, 1.0], turns])))
    places = np.concatenate(corners)
    return places.min(axis=0), places.max(axis=0)


def _rational_turning_points(lifted: Floats) -> Floats:
    """Where ``a' w - a w'`` is zero, for each coordinate."""
    weight, legs = lifted[:, -1], np.diff(lifted, axis=0)
    turns = [
        roots(product(legs[:, axis], weight) - product(lifted[:, axis], legs[:, -1])) for axis in range(lifted.shape[1] - 1)
    ]
    return np.concatenate(turns)


def inflections(points: ArrayLike) -> Floats:
    """Parameters in [0, 1] at which a curve in the plane begins to bend to the other side, or has a cusp, (k,) float64.

    >>> inflections([[0, 0], [1, 2], [2, -2], [3, 0]]).tolist()
    [0.5]
    """
    control = control_points(points, 1, dimension=2)
    if len(control) < 3:
        return np.zeros(0)
    first, second = np.diff(control, axis=0), np.diff(control, n=2, axis=0)
    return roots(product(first[:, 0], second[:, 1]) - product(first[:, 1], second[:, 0]))
