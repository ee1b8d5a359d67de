"""Easing: how far along, as a function of time; what starts and stops gently (FoCG 15.1.1: reparameterisation; 16.2).

Each takes times from 0 to 1 to shares from 0 to 1, (...) float to (...) float64, and holds 0 and 1 beyond. With
`limner.curves.arc_length.ArcLength` they say where on its path a camera is:

    even = ArcLength(path)
    eyes = path.at(even.parameter(even.length * smoothstep(np.linspace(0.0, 1.0, 48))))
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import bezier

__all__ = ["cubic_bezier", "linear", "smootherstep", "smoothstep"]

Floats = NDArray[np.float64]

_HALVINGS = 60


def _held(time: ArrayLike) -> Floats:
    t = np.asarray(time, dtype=np.float64)
    if np.isnan(t).any():
        raise SceneError("a time to ease must be a number, got NaN")
    return np.clip(t, 0.0, 1.0)


def linear(time: ArrayLike) -> Floats:
    """As far as time has gone."""
    return _held(time)


def smoothstep(time: ArrayLike) -> Floats:
    """``3 t^2 - 2 t^3``: starts and stops at rest.

    >>> smoothstep([0.0, 0.25, 0.5]).tolist()
    [0.0, 0.15625, 0.5]
    """
    t = _held(time)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def smootherstep(time: ArrayLike) -> Floats:
    """``6 t^5 - 15 t^4 + 10 t^3``: starts and stops at rest, and without a jerk.

    **Source**: Perlin, "Improving noise", 2002.
    """
    t = _held(time)
    return np.asarray(t**3 * (10.0 + t * (6.0 * t - 15.0)))


def cubic_bezier(x1: float, y1: float, x2: float, y2: float, time: ArrayLike) -> Floats:
    """Ease along the Bézier curve of (0, 0), (x1, y1), (x2, y2), (1, 1): y where x is the time, as in style sheets.

    Parameters
    ----------
    x1, x2 : float in [0, 1]
        So that the curve has one point for each time.
    y1, y2 : float
    time : (...) float

    Returns
    -------
    (...) float64
        May go beyond 0 and 1 in between, where y1 or y2 do.

    Examples
    --------
    >>> cubic_bezier(0.25, 0.1, 0.25, 1.0, [0.0, 0.5, 1.0]).round(4).tolist()
    [0.0, 0.8024, 1.0]

    **Source**: W3C, *CSS Easing Functions Level 1*, 2.2.
    """
    if not (0.0 <= x1 <= 1.0 and 0.0 <= x2 <= 1.0 and np.isfinite([y1, y2]).all()):
        raise SceneError(f"an easing curve's x must lie in [0, 1] and its y be finite, got ({x1}, {y1}) and ({x2}, {y2})")
    t = _held(time)
    low, high = np.zeros_like(t), np.ones_like(t)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        below = bezier.evaluate([[0.0], [x1], [x2], [1.0]], middle)[..., 0] < t
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    eased = bezier.evaluate([[0.0], [y1], [y2], [1.0]], 0.5 * (low + high))[..., 0]
    return np.where(t <= 0.0, 0.0, np.where(t >= 1.0, 1.0, eased))
