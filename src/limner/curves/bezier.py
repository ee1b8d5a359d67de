"""Bézier curves: a smooth curve drawn by a handful of points that it approximates (FoCG 15.6.1).

The curve of n + 1 control points is a polynomial of degree n. It starts in the first point and ends in the last, leaves and
arrives along the first and the last leg of their polygon, and lies in their convex hull. It can be had in two ways: as the sum
of the points weighted by the Bernstein basis (`evaluate`), and by cutting corners, de Casteljau's repeated linear interpolation
(`de_casteljau`), whose left and right edges are the control points of the two halves (`split`).

    p0 --- q0 --- p1        q_i = (1-u) p_i + u p_{i+1}
             \\ r0            r_i = (1-u) q_i + u q_{i+1}
    p2 --- q1 --'           ... until one point is left: the curve at u
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .bernstein import basis

__all__ = ["de_casteljau", "derivative", "evaluate", "split"]

Points = NDArray[np.float64]


def _control_points(points: ArrayLike) -> Points:
    made = np.asarray(points, dtype=np.float64)
    if made.ndim != 2 or len(made) == 0:
        raise SceneError(f"control points must have shape (n + 1, d) with n >= 0, got {made.shape}")
    return made


def evaluate(points: ArrayLike, u: ArrayLike) -> Points:
    """Evaluate the curve ``f(u) = sum_k b_{k,n}(u) p_k``.

    Parameters
    ----------
    points : (n + 1, d) float
        Control points.
    u : (...) float
        0 is the start, 1 the end; beyond them the polynomial goes on.

    Returns
    -------
    (..., d) float64

    Examples
    --------
    >>> evaluate([[0, 0], [1, 2], [2, 0]], 0.5).tolist()
    [1.0, 1.0]

    **Source**: FoCG 15.6.1.
    """
    control = _control_points(points)
    return basis(len(control) - 1, u) @ control


def de_casteljau(points: ArrayLike, u: ArrayLike) -> Points:
    """Evaluate the curve by repeated linear interpolation: the oracle of `evaluate`, and stabler at high degree.

    Parameters
    ----------
    points : (n + 1, d) float
    u : (...) float

    Returns
    -------
    (..., d) float64

    **Source**: FoCG 15.6.1, "The de Casteljau Algorithm".
    """
    control = _control_points(points)
    t = np.asarray(u, dtype=np.float64)[..., None, None]
    level = np.broadcast_to(control, (*t.shape[:-2], *control.shape))
    while level.shape[-2] > 1:
        level = (1.0 - t) * level[..., :-1, :] + t * level[..., 1:, :]
    return level[..., 0, :]


def derivative(points: ArrayLike, u: ArrayLike) -> Points:
    """Evaluate ``f'(u) = n sum_k b_{k,n-1}(u) (p_{k+1} - p_k)``: the curve of the polygon's legs.

    Parameters
    ----------
    points : (n + 1, d) float
    u : (...) float

    Returns
    -------
    (..., d) float64
        Zero for a curve of one point.

    **Source**: FoCG 15.6.1; Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 5.3.
    """
    control = _control_points(points)
    degree = len(control) - 1
    if degree == 0:
        return np.zeros((*np.shape(u), control.shape[1]))
    return degree * evaluate(np.diff(control, axis=0), u)


def split(points: ArrayLike, u: float = 0.5) -> tuple[Points, Points]:
    """Cut a curve in two at `u`: the control points of both pieces, which together draw the same curve.

    Parameters
    ----------
    points : (n + 1, d) float
    u : float

    Returns
    -------
    left, right : (n + 1, d) float64
        ``left(s) = f(u s)`` and ``right(s) = f(u + (1 - u) s)``; they share the point f(u).

    **Source**: FoCG 15.6.1, "The de Casteljau Algorithm".
    """
    level = _control_points(points)
    left, right = [level[0]], [level[-1]]
    while len(level) > 1:
        level = (1.0 - u) * level[:-1] + u * level[1:]
        left.append(level[0])
        right.append(level[-1])
    return np.array(left), np.array(right[::-1])
