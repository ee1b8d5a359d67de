"""Cardinal and Catmull-Rom curves: through all points, each tangent along the line between the two neighbours.

The knots say how much time each leg takes: the power `alpha` of its length. With 0 (uniform) every leg takes the same, and the curve
overshoots short legs; with 1 (chordal) it bulges on long ones; with 1/2 (centripetal) it has no cusp and no loop within a leg.

**Source**: Catmull and Rom, "A class of local interpolating splines", 1974; Yuksel, Schaefer and Keyser, "Parameterization and
applications of Catmull-Rom curves", *Computer-Aided Design* 43(7), 2011.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import hermite
from .control import control_points
from .curve import Spline

__all__ = ["cardinal", "catmull_rom", "chord_knots"]

Floats = NDArray[np.float64]


def chord_knots(points: ArrayLike, alpha: float = 0.5) -> Floats:
    """Return parameters for points, (n,) float64: from 0 on, each leg the power `alpha` of its length.

    Raises
    ------
    SceneError
        Where two points in succession are equal (a leg of no length takes no time), or alpha is not in [0, 1].
    """
    p = control_points(points, 2)
    if not 0.0 <= alpha <= 1.0:
        raise SceneError(f"alpha must lie in [0, 1]: 0 uniform, 0.5 centripetal, 1 chordal; got {alpha}")
    legs = np.linalg.norm(np.diff(p, axis=0), axis=1)
    if alpha > 0.0 and not legs.all():
        where = int(np.argmin(legs))
        raise SceneError(f"points {where} and {where + 1} must differ, for alpha > 0 makes the time between them depend on their distance")
    return np.concatenate([[0.0], np.cumsum(legs**alpha)])


def catmull_rom(points: ArrayLike, alpha: float = 0.5, closed: bool = False) -> Spline:
    """Draw a curve through all points.

    Parameters
    ----------
    points : (n, d) float, n >= 2, closed n >= 3
    alpha : float in [0, 1]
        0 uniform, 1/2 centripetal, 1 chordal.
    closed : bool
        Back to the first point.

    Returns
    -------
    Spline
        Cubic and C1; the ends of an open one as if the legs went on mirrored.

    Examples
    --------
    >>> catmull_rom([[0, 0], [1, 1], [2, 0], [3, 1]], alpha=0.0).derivative(1.0).round(12).tolist()
    [1.0, 0.0]
    """
    round_trip = _with_neighbours(points, closed)
    t = chord_knots(round_trip, alpha)
    h = np.diff(t)[:, None]
    slope = np.diff(round_trip, axis=0) / h
    # The derivative of the parabola through three points, at the middle one
    tangents = (h[1:] * slope[:-1] + h[:-1] * slope[1:]) / (h[:-1] + h[1:])
    return hermite.spline(round_trip[1:-1], tangents, t[1:-1] - t[1])


def cardinal(points: ArrayLike, tension: float = 0.0, closed: bool = False) -> Spline:
    """Draw a curve through all points, as slack as wanted.

    Parameters
    ----------
    points : (n, d) float, n >= 2, closed n >= 3
    tension : float
        ``m_k = (1 - tension) (p_{k+1} - p_{k-1}) / 2``: 0 is the uniform Catmull-Rom curve, 1 the polygon.
    closed : bool

    Returns
    -------
    Spline
        Cubic and C1.

    **Source**: FoCG 15.5.3, there with (1 - t) / 2 as here.
    """
    if not math.isfinite(tension):
        raise SceneError(f"tension must be finite, got {tension}")
    round_trip = _with_neighbours(points, closed)
    tangents = 0.5 * (1.0 - tension) * (round_trip[2:] - round_trip[:-2])
    return hermite.spline(round_trip[1:-1], tangents)


def _with_neighbours(points: ArrayLike, closed: bool) -> Floats:
    """The points with one more at each end: those on the other side of a closed curve, or the mirrored legs of an open one."""
    p = control_points(points, 3 if closed else 2)
    if closed:
        return np.concatenate([p[-1:], p, p[:2]])
    return np.concatenate([2.0 * p[:1] - p[1:2], p, 2.0 * p[-1:] - p[-2:-1]])
