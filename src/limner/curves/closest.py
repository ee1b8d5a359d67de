"""The point of a curve that is nearest to a given one.

Where it is not an end of a piece, the curve runs at right angles to the line from the point: ``(f(u) - p) . f'(u) = 0``, which for a
Bézier curve is a polynomial whose Bernstein coefficients can be written down, and all of whose roots in [0, 1] are found. Pieces whose
control points have a box that is farther than what has been found need no look.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .bernstein import product, roots
from .control import control_points
from .curve import Spline

__all__ = ["Closest", "closest_point", "feet"]

Floats = NDArray[np.float64]


class Closest(NamedTuple):
    """The nearest point of a curve: its parameter, itself, (d,) float64, and how far it is."""

    u: float
    point: Floats
    distance: float


def feet(points: ArrayLike, target: ArrayLike) -> Floats:
    """Parameters in [0, 1] at which a Bézier curve runs at right angles to the line from a point, (k,) float64, in order.

    Parameters
    ----------
    points : (n + 1, d) float
    target : (d,) float
    """
    control = control_points(points)
    if len(control) < 2:
        return np.zeros(0)
    return roots(product(control - np.asarray(target, dtype=np.float64), np.diff(control, axis=0)).sum(axis=1))


def _rational_feet(lifted: Floats, target: Floats) -> Floats:
    """The same of a rational curve: a / w - p times its derivative is ``(a - w p) . (a' w - a w')`` over a power of w."""
    offset = lifted[:, :-1] - lifted[:, -1:] * target
    # Of a curve that is moved by p the same: its a is `offset`
    legs = np.diff(np.concatenate([offset, lifted[:, -1:]], axis=1), axis=0)
    turn = product(legs[:, :-1], lifted[:, -1:]) - product(offset, legs[:, -1:])
    return roots(product(offset, turn).sum(axis=1))


def closest_point(spline: Spline, target: ArrayLike) -> Closest:
    """Find the point of a spline that is nearest to a given one; of several the first.

    Parameters
    ----------
    spline : Spline
    target : (d,) float

    Returns
    -------
    Closest

    Examples
    --------
    >>> found = closest_point(Spline.bezier([[0, 0], [2, 0]]), (0.5, 3.0))
    >>> found.u, found.point.tolist(), found.distance
    (0.25, [0.5, 0.0], 3.0)
    """
    p = np.asarray(target, dtype=np.float64)
    if p.shape != (spline.dimension,) or not np.isfinite(p).all():
        raise SceneError(f"the target must be {spline.dimension} finite numbers, got {np.asarray(target).tolist()}")
    control = spline.pieces[..., :-1] / spline.pieces[..., -1:] if spline.rational else spline.pieces
    outside = np.maximum(0.0, np.maximum(control.min(axis=1) - p, p - control.max(axis=1)))
    away = np.linalg.norm(outside, axis=1)
    best: Closest | None = None
    for k in np.argsort(away, kind="stable").tolist():
        if best is not None and away[k] > best.distance:
            break
        piece = spline.pieces[k]
        inner = _rational_feet(piece, p) if spline.rational else feet(piece, p)
        low, high = spline.knots[k], spline.knots[k + 1]
        u = low + (high - low) * np.concatenate([[0.0], inner, [1.0]])
        places = spline.at(u)
        distances = np.linalg.norm(places - p, axis=1)
        at = int(np.argmin(distances))
        if best is None or (distances[at], u[at]) < (best.distance, best.u):
            best = Closest(float(u[at]), places[at], float(distances[at]))
    assert best is not None
    return best
