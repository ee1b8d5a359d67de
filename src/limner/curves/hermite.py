"""Hermite curves: through given points with given tangents (FoCG 15.5.2).

A cubic is determined by its ends and its derivatives there; over an interval of length h it is the Bézier curve whose inner control
points lie a third of h along the tangents.

    p0 --- p0 + h m0 / 3 ... p1 - h m1 / 3 --- p1
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .control import breaks, control_points
from .curve import Spline

__all__ = ["basis", "quintic", "spline", "to_hermite"]

Floats = NDArray[np.float64]


def basis(u: ArrayLike) -> Floats:
    """Evaluate the cubic Hermite basis over [0, 1].

    Parameters
    ----------
    u : (...) float

    Returns
    -------
    (..., 4) float64
        What the first point, the first tangent, the second point and the second tangent are weighed with.

    Examples
    --------
    >>> basis([0.0, 1.0]).tolist()
    [[1.0, 0.0, 0.0, -0.0], [0.0, 0.0, 1.0, 0.0]]
    """
    t = np.asarray(u, dtype=np.float64)
    rest = 1.0 - t
    return np.stack([rest * rest * (1.0 + 2.0 * t), rest * rest * t, t * t * (3.0 - 2.0 * t), t * t * (t - 1.0)], axis=-1)


def spline(points: ArrayLike, tangents: ArrayLike, knots: ArrayLike | None = None) -> Spline:
    """Join cubics through points: C1 by how they are made.

    Parameters
    ----------
    points, tangents : (m + 1, d) float, m >= 1
        Tangents are derivatives by the parameter.
    knots : (m + 1,) float, optional
        Increasing: where the curve is at the points. None: 0, 1, ..., m.

    Returns
    -------
    Spline
        Of degree 3.

    Examples
    --------
    >>> spline([[0.0], [1.0]], [[0.0], [0.0]]).at([0.25, 0.5]).tolist()
    [[0.15625], [0.5]]
    """
    p, m = control_points(points, 2), control_points(tangents, 2, "tangents")
    if p.shape != m.shape:
        raise SceneError(f"there must be one tangent for each point, got shapes {p.shape} and {m.shape}")
    t = np.arange(float(len(p))) if knots is None else breaks(knots, len(p))
    third = np.diff(t)[:, None] / 3.0
    return Spline(t, np.stack([p[:-1], p[:-1] + third * m[:-1], p[1:] - third * m[1:], p[1:]], axis=1))


def quintic(points: ArrayLike, tangents: ArrayLike, accelerations: ArrayLike, knots: ArrayLike | None = None) -> Spline:
    """Join quintics through points with given first and second derivatives: C2 by how they are made.

    Parameters
    ----------
    points, tangents, accelerations : (m + 1, d) float, m >= 1
    knots : (m + 1,) float, optional

    Returns
    -------
    Spline
        Of degree 5.
    """
    p = control_points(points, 2)
    m, a = control_points(tangents, 2, "tangents"), control_points(accelerations, 2, "accelerations")
    if not p.shape == m.shape == a.shape:
        raise SceneError(f"there must be a tangent and an acceleration for each point, got shapes {p.shape}, {m.shape} and {a.shape}")
    t = np.arange(float(len(p))) if knots is None else breaks(knots, len(p))
    h = np.diff(t)[:, None]
    fifth, twentieth = h / 5.0, h * h / 20.0
    left = [p[:-1], p[:-1] + fifth * m[:-1], p[:-1] + 2.0 * fifth * m[:-1] + twentieth * a[:-1]]
    right = [p[1:] - 2.0 * fifth * m[1:] + twentieth * a[1:], p[1:] - fifth * m[1:], p[1:]]
    return Spline(t, np.stack([*left, *right], axis=1))


def to_hermite(points: ArrayLike) -> tuple[Floats, Floats]:
    """Return both ends (2, d) and both derivatives (2, d) of a cubic Bézier curve over [0, 1]."""
    control = control_points(points)
    if len(control) != 4:
        raise SceneError(f"a cubic has 4 control points, got {len(control)}")
    return control[[0, 3]], 3.0 * (control[[1, 3]] - control[[0, 2]])
