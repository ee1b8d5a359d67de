"""Surfaces over a net of points: Bézier patches of any degrees, and B-spline sheets (FoCG 15.6 in two parameters).

    p(u, v) = sum_i sum_j b_i(v) b_j(u) P[i, j]

Rows run along v, columns along u, as in `limner.curves.patch`, which is the bicubic kind. All that can be done to a curve can be done to
all rows, then to all columns.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import bezier, bspline
from .bernstein import basis
from .control import degree_of, parameters

__all__ = ["bicubic", "bspline_patches", "elevate", "evaluate", "net_of", "partial", "rational_evaluate", "split", "unit_normals"]

Floats = NDArray[np.float64]


def net_of(net: ArrayLike, name: str = "a net") -> Floats:
    """Return (m + 1, n + 1, d) float64; raise SceneError where it has another shape or is not finite."""
    made = np.asarray(net, dtype=np.float64)
    if made.ndim != 3 or 0 in made.shape:
        raise SceneError(f"{name} of control points must have shape (m + 1, n + 1, d), got {made.shape}")
    if not np.isfinite(made).all():
        raise SceneError(f"{name} of control points must be finite")
    return made


def evaluate(net: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
    """Evaluate a Bézier patch.

    Parameters
    ----------
    net : (m + 1, n + 1, d) float
        Of degree n in u and m in v.
    u, v : (...) float, of shapes that broadcast

    Returns
    -------
    (..., d) float64

    Examples
    --------
    >>> evaluate([[[0.0, 0.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 1.0]]], 0.25, 0.5).tolist()
    [0.25, 0.5]
    """
    points = net_of(net)
    across, along = basis(points.shape[1] - 1, parameters(u)), basis(points.shape[0] - 1, parameters(v))
    return np.asarray(np.einsum("...i,...j,ijd->...d", along, across, points))


def partial(net: ArrayLike, u: ArrayLike, v: ArrayLike, orders: tuple[int, int] = (1, 0)) -> Floats:
    """Evaluate a partial derivative, (..., d) float64: `orders` says how often by u and how often by v."""
    points = net_of(net)
    scale = 1.0
    for axis, order in ((1, degree_of(orders[0])), (0, degree_of(orders[1]))):
        degree = points.shape[axis] - 1
        if order > degree:
            return np.zeros((*np.broadcast_shapes(np.shape(u), np.shape(v)), points.shape[2]))
        points, scale = np.diff(points, n=order, axis=axis), scale * math.perm(degree, order)
    return scale * evaluate(points, u, v)


def unit_normals(net: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
    """Evaluate the direction of ``dp/du x dp/dv``, (..., 3) float64; zero where it vanishes."""
    normal = np.cross(partial(net, u, v, (1, 0)), partial(net, u, v, (0, 1)))
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.asarray(np.where(length > 0.0, normal / np.where(length > 0.0, length, 1.0), 0.0))


def rational_evaluate(net: ArrayLike, weights: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
    """Evaluate a rational Bézier patch, (..., d) float64; weights (m + 1, n + 1) float > 0."""
    points, w = net_of(net), np.asarray(weights, dtype=np.float64)
    if w.shape != points.shape[:2] or not (np.isfinite(w) & (w > 0.0)).all():
        raise SceneError(f"weights must be positive, finite, and of shape {points.shape[:2]}, got shape {w.shape}")
    lifted = evaluate(np.concatenate([points * w[..., None], w[..., None]], axis=2), u, v)
    return lifted[..., :-1] / lifted[..., -1:]


def elevate(net: ArrayLike, times_u: int = 0, times_v: int = 0) -> Floats:
    """Add control points, in u and in v, that leave the patch as it is."""
    points = np.array([bezier.elevate(row, times_u) for row in net_of(net)])
    return np.array([bezier.elevate(column, times_v) for column in points.swapaxes(0, 1)]).swapaxes(0, 1)


def bicubic(net: ArrayLike) -> Floats:
    """Raise a patch of lower degrees to the bicubic net, (4, 4, d) float64, that is the same surface."""
    points = net_of(net)
    if max(points.shape[:2]) > 4:
        raise SceneError(f"only degrees up to 3 can be raised to a bicubic patch, got {points.shape[1] - 1} and {points.shape[0] - 1}")
    return elevate(points, 4 - points.shape[1], 4 - points.shape[0])


def split(net: ArrayLike, u: float = 0.5, v: float = 0.5) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Cut a patch in four.

    Returns
    -------
    ((low u and low v, high u and low v), (low u and high v, high u and high v))
        Nets of the shape of the given one.
    """
    halves = [np.array(side) for side in zip(*(bezier.split(row, u) for row in net_of(net)), strict=True)]
    quarters = [
        [np.array(side).swapaxes(0, 1) for side in zip(*(bezier.split(column, v) for column in half.swapaxes(0, 1)), strict=True)]
        for half in halves
    ]
    (left_low, left_high), (right_low, right_high) = quarters
    return (left_low, right_low), (left_high, right_high)


def bspline_patches(
    net: ArrayLike, degrees: tuple[int, int] = (3, 3), knots_u: ArrayLike | None = None, knots_v: ArrayLike | None = None
) -> Floats:
    """Cut a B-spline sheet into its Bézier patches.

    Parameters
    ----------
    net : (m, n, d) float
        Control points, more of them each way than the degree; an extra coordinate of weights may be among the d, see
        `limner.curves.rational.homogeneous`.
    degrees : (int, int) >= 1
        In u and in v.
    knots_u, knots_v : float, optional
        None: `limner.curves.bspline.clamped_knots`.

    Returns
    -------
    (rows, columns, q + 1, p + 1, d) float64
        Nets of the patches, rows of patches along v.
    """
    points = net_of(net)
    across = np.array([bspline.spline(row, knots_u, degrees[0]).pieces for row in points])
    m, columns, p, d = across.shape
    along = np.array([bspline.spline(line, knots_v, degrees[1]).pieces for line in across.reshape(m, -1, d).swapaxes(0, 1)])
    return np.asarray(along.reshape(columns, p, *along.shape[1:]).transpose(2, 0, 3, 1, 4))
