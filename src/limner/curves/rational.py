"""Rational Bézier curves: with a weight at each control point, so that circles and all conics are among them.

    f(u) = sum_k b_k(u) w_k p_k / sum_k b_k(u) w_k

One dimension higher the curve of ``(w_k p_k, w_k)`` is a plain Bézier curve, and all that is done to it there (cutting, elevating)
holds for its shadow.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import bezier
from .control import control_points

__all__ = ["arc", "derivative", "elevate", "evaluate", "homogeneous", "plain", "quotient", "split"]

Floats = NDArray[np.float64]


def homogeneous(points: ArrayLike, weights: ArrayLike) -> Floats:
    """Lift control points: (n + 1, d + 1) float64, ``(w p, w)``.

    Raises
    ------
    SceneError
        Where weights are not one per point, positive and finite.
    """
    control, w = control_points(points), np.asarray(weights, dtype=np.float64)
    if w.shape != (len(control),):
        raise SceneError(f"there must be one weight for each of {len(control)} control points, got shape {w.shape}")
    if not (np.isfinite(w) & (w > 0.0)).all():
        raise SceneError(f"weights must be positive and finite, got {w.tolist()}")
    return np.concatenate([control * w[:, None], w[:, None]], axis=1)


def plain(lifted: Floats) -> tuple[Floats, Floats]:
    """Undo `homogeneous`: control points (n + 1, d) and weights (n + 1,)."""
    return lifted[:, :-1] / lifted[:, -1:], lifted[:, -1]


def evaluate(points: ArrayLike, weights: ArrayLike, u: ArrayLike) -> Floats:
    """Evaluate the curve.

    Parameters
    ----------
    points : (n + 1, d) float
    weights : (n + 1,) float > 0
        Equal weights make it a plain Bézier curve; a greater one pulls more.
    u : (...) float in [0, 1]

    Returns
    -------
    (..., d) float64

    Examples
    --------
    >>> evaluate([[1, 0], [1, 1], [0, 1]], [1, 0.5**0.5, 1], 0.5).round(6).tolist()
    [0.707107, 0.707107]

    **Source**: Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 13.1.
    """
    lifted = bezier.evaluate(homogeneous(points, weights), u)
    return lifted[..., :-1] / lifted[..., -1:]


def derivative(points: ArrayLike, weights: ArrayLike, u: ArrayLike, order: int = 1) -> Floats:
    """Evaluate a derivative, (..., d) float64; see `quotient`."""
    lifted = homogeneous(points, weights)
    return quotient([bezier.derivative(lifted, u, k) for k in range(order + 1)])


def quotient(lifted: list[Floats]) -> Floats:
    """The derivative of a shadow from the derivatives 0, 1, ..., k of its lifted curve, each (..., d + 1).

    ``f^(k) = (a^(k) - sum_{i=1..k} C(k, i) w^(i) f^(k-i)) / w``

    **Source**: Piegl and Tiller, *The NURBS Book*, 2nd ed., 1997, 4.3, equation 4.8.
    """
    made: list[Floats] = []
    for k, top in enumerate(lifted):
        value = top[..., :-1].copy()
        for i in range(1, k + 1):
            value -= math.comb(k, i) * lifted[i][..., -1:] * made[k - i]
        made.append(value / lifted[0][..., -1:])
    return made[-1]


def split(points: ArrayLike, weights: ArrayLike, u: float = 0.5) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Cut a curve in two at `u`: control points and weights of both pieces."""
    left, right = bezier.split(homogeneous(points, weights), u)
    return plain(left), plain(right)


def elevate(points: ArrayLike, weights: ArrayLike, times: int = 1) -> tuple[Floats, Floats]:
    """Add control points, with weights, that leave the curve as it is."""
    return plain(bezier.elevate(homogeneous(points, weights), times))


def arc(start: float, sweep: float, radius: float = 1.0, center: ArrayLike = (0.0, 0.0)) -> tuple[Floats, Floats]:
    """Make a part of a circle, exactly.

    Parameters
    ----------
    start, sweep : float
        Radians, counter-clockwise; the sweep of one arc is less than a half turn either way, and not 0.
    radius : float > 0
    center : (2,) float

    Returns
    -------
    points : (3, 2) float64
        The ends, and between them where their tangents meet.
    weights : (3,) float64
        1, cos(sweep / 2), 1

    **Source**: Piegl and Tiller 1997, 7.3.
    """
    if not 0.0 < abs(sweep) < math.pi:
        raise SceneError(f"one arc must sweep less than a half turn, and not 0, got {sweep} radians")
    if not (math.isfinite(radius) and radius > 0.0):
        raise SceneError(f"the radius of an arc must be positive and finite, got {radius}")
    weight = math.cos(0.5 * sweep)
    angle = start + sweep * np.array([0.0, 0.5, 1.0])
    reach = radius * np.array([1.0, 1.0 / weight, 1.0])[:, None]
    points = np.asarray(center, dtype=np.float64) + reach * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return points, np.array([1.0, weight, 1.0])
