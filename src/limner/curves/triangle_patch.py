"""Bézier triangles: a sheet over three corners, where a net of four would have one corner too many (FoCG 15.6, in barycentrics).

    p(b) = sum_{i + j + k = n} n! / (i! j! k!) b0^i b1^j b2^k P[i, j, k],    b0 + b1 + b2 = 1

The control points stand in rows, (i, j, k) falling in i, then in j: of degree 2

            200                 0
         110   101            1   2
      020   011   002       3   4   5

De Casteljau's corner cutting works as on curves, with three points at a time; from its edges come the control points of the three
triangles round the point. The surface touches the corners' planes, and each border is the Bézier curve of the points along it.

**Source**: Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 17.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["border", "degree_of_net", "evaluate", "indices", "normals", "partials", "quartered", "subdivided"]

Floats = NDArray[np.float64]


def indices(degree: int) -> NDArray[np.int64]:
    """(k, 3) int64: i, j and k of the control points, in the order they stand in.

    >>> indices(1).tolist()
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    """
    return np.array([(degree - row, row - k, k) for row in range(degree + 1) for k in range(row + 1)], dtype=np.int64)


def degree_of_net(net: ArrayLike) -> tuple[Floats, int]:
    """Return the control points as float64, and their degree; raise SceneError where they are no triangle's."""
    points = np.asarray(net, dtype=np.float64)
    if points.ndim != 2:
        raise SceneError(f"a Bézier triangle's control points must have shape ((n + 1) (n + 2) / 2, d), got {points.shape}")
    degree = (math.isqrt(8 * len(points) + 1) - 3) // 2
    if degree < 0 or (degree + 1) * (degree + 2) // 2 != len(points):
        raise SceneError(f"a Bézier triangle has 1, 3, 6, 10, 15 ... control points, got {len(points)}")
    if not np.isfinite(points).all():
        raise SceneError("a Bézier triangle's control points must be finite")
    return points, degree


def _weights(barycentrics: ArrayLike) -> Floats:
    b = np.asarray(barycentrics, dtype=np.float64)
    if b.ndim == 0 or b.shape[-1] != 3 or not (np.abs(b.sum(axis=-1) - 1.0) < 1e-9).all():
        raise SceneError(f"barycentrics are three numbers with the sum 1, got shape {b.shape}")
    return b


def _cut(level: Floats, degree: int, b: Floats) -> Floats:
    """One step of de Casteljau: from (..., points of degree n, d) to those of degree n - 1."""
    i, j = _neighbours(degree)
    first, second, third = level[..., i, :], level[..., j, :], level[..., j + 1, :]
    return np.asarray(b[..., 0, None, None] * first + b[..., 1, None, None] * second + b[..., 2, None, None] * third)


def _neighbours(degree: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Where in a net of degree n the first and the second corner of each small upright triangle stand; the third is next to it."""
    row = np.repeat(np.arange(degree), np.arange(1, degree + 1))
    first = np.arange(len(row))
    return first, first + row + 1


def evaluate(net: ArrayLike, barycentrics: ArrayLike) -> Floats:
    """Evaluate the surface by corner cutting.

    Parameters
    ----------
    net : ((n + 1) (n + 2) / 2, d) float
    barycentrics : (..., 3) float
        With the sum 1.

    Returns
    -------
    (..., d) float64

    Examples
    --------
    >>> evaluate([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [0.5, 0.25, 0.25]).tolist()
    [0.25, 0.25]
    """
    points, degree = degree_of_net(net)
    b = _weights(barycentrics)
    level = np.broadcast_to(points, (*b.shape[:-1], *points.shape))
    for n in range(degree, 0, -1):
        level = _cut(level, n, b)
    return level[..., 0, :]


def partials(net: ArrayLike, barycentrics: ArrayLike) -> tuple[Floats, Floats]:
    """Evaluate the derivatives from the first corner towards the second and towards the third, (..., d) float64 each."""
    points, degree = degree_of_net(net)
    b = _weights(barycentrics)
    if degree == 0:
        return np.zeros((*b.shape[:-1], points.shape[1])), np.zeros((*b.shape[:-1], points.shape[1]))
    i, j = _neighbours(degree)
    return degree * evaluate(points[j] - points[i], b), degree * evaluate(points[j + 1] - points[i], b)


def normals(net: ArrayLike, barycentrics: ArrayLike) -> Floats:
    """Evaluate unit normals, (..., 3) float64: towards whoever sees the corners counter-clockwise; zero where there is none."""
    to_second, to_third = partials(net, barycentrics)
    normal = np.cross(to_second, to_third)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.asarray(np.where(length > 0.0, normal / np.where(length > 0.0, length, 1.0), 0.0))


def subdivided(net: ArrayLike, barycentrics: ArrayLike = (1 / 3, 1 / 3, 1 / 3)) -> tuple[Floats, Floats, Floats]:
    """Cut the triangle at a point into three, which together are the same surface.

    Parameters
    ----------
    net : ((n + 1) (n + 2) / 2, d) float
    barycentrics : (3,) float

    Returns
    -------
    three nets of the same shape
        The point takes the place of the first, of the second, and of the third corner.
    """
    points, degree = degree_of_net(net)
    b = _weights(barycentrics)
    levels = [points]
    for n in range(degree, 0, -1):
        levels.append(_cut(levels[-1], n, b))
    ijk = indices(degree)
    made = []
    for corner in range(3):
        # Of each level the points that the old corner has no part in
        rows = []
        for index in ijk:
            steps = int(index[corner])
            place = np.array(index)
            place[corner] = 0
            rows.append(levels[steps][_place(place)])
        made.append(np.array(rows))
    return made[0], made[1], made[2]


def _place(index: NDArray[np.int64]) -> int:
    """Where the point (i, j, k) stands in its net."""
    row = int(index[1] + index[2])
    return row * (row + 1) // 2 + int(index[2])


def border(net: ArrayLike, side: int) -> Floats:
    """Control points (n + 1, d) of a border: side 0 from the second corner to the third, 1 from the third to the first, 2 back.

    >>> border([[0.0], [1.0], [2.0]], 0).tolist()
    [[1.0], [2.0]]
    """
    points, degree = degree_of_net(net)
    if side not in (0, 1, 2):
        raise SceneError(f"a triangle has the sides 0, 1 and 2, got {side}")
    from_corner, to_corner = (side + 1) % 3, (side + 2) % 3
    rows = []
    for k in range(degree + 1):
        index = np.zeros(3, dtype=np.int64)
        index[from_corner], index[to_corner] = degree - k, k
        rows.append(_place(index))
    return points[rows]


def quartered(net: ArrayLike) -> tuple[Floats, Floats, Floats, Floats]:
    """Cut the triangle at the middles of its sides into four: at the first, second and third corner, and between.

    The one between is turned by a half turn: its corners are the middles opposite to the first, the second and the third corner.
    """
    points, _ = degree_of_net(net)
    a, b, c = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    ab, bc, ca = (0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5)
    return (
        _restricted(points, (a, ab, ca)),
        _restricted(points, (ab, b, bc)),
        _restricted(points, (ca, bc, c)),
        _restricted(points, (bc, ca, ab)),
    )


def _restricted(net: Floats, corners: tuple[tuple[float, ...], ...]) -> Floats:
    """The net of the part between three points, by the blossom: each control point is a cut with as many of each corner as it says."""
    _, degree = degree_of_net(net)
    rows = []
    for index in indices(degree):
        level, n = net, degree
        for corner, times in zip(corners, index.tolist(), strict=True):
            for _ in range(times):
                level, n = _cut(level, n, np.array(corner)), n - 1
        rows.append(level[0])
    return np.array(rows)
