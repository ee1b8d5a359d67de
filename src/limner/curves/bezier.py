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
from .bernstein import basis_columns, binomials
from .control import control_points, degree_of, parameters

__all__ = [
    "construction", "de_casteljau", "derivative", "elevate", "evaluate", "from_power", "reduce", "restrict", "second_differences",
    "split", "to_power",
]  # fmt: skip

Points = NDArray[np.float64]

_CHUNK = 1 << 13  # parameters at once: what is computed for them stays in a cache


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
    control, t = control_points(points), parameters(u)
    degree, dimension = len(control) - 1, control.shape[1]
    flat = t.reshape(-1)
    made = np.empty((len(flat), dimension))
    for begin in range(0, len(flat), _CHUNK):
        here = flat[begin : begin + _CHUNK]
        weights = basis_columns(degree, here)
        term = np.empty_like(here)
        for axis in range(dimension):
            total = weights[0] * control[0, axis]
            for k in range(1, degree + 1):
                total += np.multiply(weights[k], control[k, axis], out=term)
            made[begin : begin + _CHUNK, axis] = total
    return made.reshape(*t.shape, dimension)


def construction(points: ArrayLike, u: float) -> list[Points]:
    """Cut corners at one parameter, and keep all that is drawn meanwhile.

    Parameters
    ----------
    points : (n + 1, d) float
    u : float

    Returns
    -------
    list of n + 1 arrays, (n + 1, d), (n, d), ..., (1, d) float64
        The polygon, then the points on its legs, and so on to the point of the curve. The first points of the levels are the control
        points of the piece before `u`, the last ones, from the end, those of the piece after it.

    Examples
    --------
    >>> [level.tolist() for level in construction([[0.0], [2.0], [2.0]], 0.5)]
    [[[0.0], [2.0], [2.0]], [[1.0], [2.0]], [[1.5]]]

    **Source**: FoCG 15.6.1, "The de Casteljau Algorithm".
    """
    levels = [control_points(points)]
    at = float(parameters(u))
    while len(levels[-1]) > 1:
        level = levels[-1]
        levels.append((1.0 - at) * level[:-1] + at * level[1:])
    return levels


def de_casteljau(points: ArrayLike, u: ArrayLike) -> Points:
    """Evaluate the curve by repeated linear interpolation: the oracle of `evaluate`, in time of the degree squared.

    Parameters
    ----------
    points : (n + 1, d) float
    u : (...) float

    Returns
    -------
    (..., d) float64

    **Source**: FoCG 15.6.1, "The de Casteljau Algorithm".
    """
    control = control_points(points)
    t = parameters(u)[..., None, None]
    level = np.broadcast_to(control, (*t.shape[:-2], *control.shape))
    while level.shape[-2] > 1:
        level = (1.0 - t) * level[..., :-1, :] + t * level[..., 1:, :]
    return level[..., 0, :]


def derivative(points: ArrayLike, u: ArrayLike, order: int = 1) -> Points:
    """Evaluate ``f'(u) = n sum_k b_{k,n-1}(u) (p_{k+1} - p_k)``: the curve of the polygon's legs; or a higher derivative.

    Parameters
    ----------
    points : (n + 1, d) float
    u : (...) float
    order : int >= 0

    Returns
    -------
    (..., d) float64
        Zero where the order is beyond the degree.

    **Source**: FoCG 15.6.1; Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 5.3.
    """
    control = control_points(points)
    degree = len(control) - 1
    if order > degree:
        return np.zeros((*parameters(u).shape, control.shape[1]))
    scale = 1.0
    for k in range(degree_of(order)):
        control, scale = np.diff(control, axis=0), scale * (degree - k)
    return scale * evaluate(control, u)


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
    levels = construction(points, u)
    return np.array([level[0] for level in levels]), np.array([level[-1] for level in levels[::-1]])


def restrict(points: ArrayLike, start: float, end: float) -> Points:
    """Return the control points of the part from `start` to `end`; where `end` is the smaller one, run backwards.

    Parameters
    ----------
    points : (n + 1, d) float
    start, end : float

    Returns
    -------
    (n + 1, d) float64
        ``g(s) = f(start + (end - start) s)``
    """
    control = control_points(points)
    if start > end:
        return restrict(control, end, start)[::-1]
    if start == end:
        return np.repeat(construction(control, start)[-1], len(control), axis=0)
    if end == 0.0:
        return restrict(control[::-1], 1.0, 1.0 - start)[::-1]
    # In this order both cuts are between the ends, and nothing is extrapolated
    return split(split(control, end)[0], start / end)[1]


def elevate(points: ArrayLike, times: int = 1) -> Points:
    """Add control points that leave the curve as it is.

    Parameters
    ----------
    points : (n + 1, d) float
    times : int >= 0

    Returns
    -------
    (n + 1 + times, d) float64
        ``q_k = k / (n + 1) p_{k-1} + (1 - k / (n + 1)) p_k``; with every time the polygon comes nearer to the curve.

    **Source**: Farin 2002, 6.1.
    """
    control = control_points(points)
    for _ in range(degree_of(times)):
        share = (np.arange(1, len(control)) / len(control))[:, None]
        control = np.concatenate([control[:1], share * control[:-1] + (1.0 - share) * control[1:], control[-1:]])
    return control


def reduce(points: ArrayLike, times: int = 1) -> tuple[Points, float]:
    """Find the curve of a lower degree that is nearest, with the same ends.

    Parameters
    ----------
    points : (n + 1, d) float
    times : int from 0 to n - 1

    Returns
    -------
    control : (n + 1 - times, d) float64
        Elevated again, it is nearest to `points` in the least squares of all control points.
    error : float
        No point of the two curves is farther from that of the same parameter.

    Examples
    --------
    >>> reduce(elevate([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]))[0].round(9).tolist()
    [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]

    **Source**: Farin 2002, 6.4.
    """
    control = control_points(points)
    degree = len(control) - 1 - degree_of(times)
    if degree < 1:
        raise SceneError(f"a curve of degree {len(control) - 1} cannot be reduced {times} times and keep two ends")
    matrix = elevate(np.eye(degree + 1), times)
    ends = matrix[:, [0, -1]] @ control[[0, -1]]
    inner = np.linalg.lstsq(matrix[:, 1:-1], control - ends, rcond=None)[0]
    made = np.concatenate([control[:1], inner, control[-1:]])
    error = float(np.linalg.norm(elevate(made, times) - control, axis=1).max())
    return made, error


def to_power(points: ArrayLike) -> Points:
    """Return the coefficients of ``f(u) = sum_k c_k u^k``, (n + 1, d) float64: fast near 0, not to be trusted at high degree."""
    level = control_points(points)
    degree, rows = len(level) - 1, []
    for binomial in binomials(degree).tolist():
        rows.append(binomial * level[0])
        level = np.diff(level, axis=0)
    return np.array(rows)


def from_power(coefficients: ArrayLike) -> Points:
    """Return the control points (n + 1, d) float64 of a curve that is given by its powers, lowest first.

    >>> from_power([[0.0], [0.0], [1.0]]).tolist()
    [[0.0], [0.0], [1.0]]
    """
    scaled = control_points(coefficients, name="coefficients")
    scaled = scaled / binomials(len(scaled) - 1)[:, None]
    return np.array([binomials(k) @ scaled[: k + 1] for k in range(len(scaled))])


def second_differences(points: ArrayLike) -> Points:
    """(n - 1, d) float64: how the polygon bends, ``p_k - 2 p_{k+1} + p_{k+2}``."""
    return np.diff(control_points(points), n=2, axis=0)
