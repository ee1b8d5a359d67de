"""Triangles of an implicit surface f(p) = 0 within a box: marching tetrahedra.

A grid of cubes, each cut into six tetrahedra along one of its diagonals; neighbours cut their common face alike, so nothing gapes.
A tetrahedron whose corners lie on both sides of the surface is cut by it in a triangle or in a quadrilateral:

    one corner inside: three of its edges are crossed          two inside: four are

`marching_cubes`, beside this file, makes a third as many triangles, better shaped and with normals, and takes tables too; this one is
all there is to it: tetrahedra leave nothing open, so that it needs no table of cases.

**Source**: Doi and Koide, *An efficient method of triangulating equi-valued surfaces by using tetrahedral cells*, 1991.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["crossings", "level_set"]

Floats = NDArray[np.float64]
_STEPS = 12

# The tetrahedra of the unit cube: from corner 0 to corner 7 along the axes in every order (Kuhn).
_TETRAHEDRA = np.array([[0, first, first | second, 7] for first, second, _ in itertools.permutations((1, 2, 4))])


def level_set(
    f: Callable[[Floats], Floats], low: ArrayLike, high: ArrayLike, n: int
) -> tuple[Floats, NDArray[np.int64]]:
    """Find triangles of the surface f = 0.

    Parameters
    ----------
    f : callable
        Takes points (k, 3) and returns (k,); negative inside.
    low, high : (3,) float
        Corners of the box.
    n : int >= 1
        Cubes along each edge of the box.

    Returns
    -------
    positions : (k, 3) float64
        On edges of the grid, where f changes its sign; shared by all triangles around them.
    triangles : (m, 3) int64
        Counter-clockwise seen from where f is positive.

    Examples
    --------
    >>> positions, triangles = level_set(lambda p: np.linalg.norm(p, axis=1) - 1.0, (-2, -2, -2), (2, 2, 2), 8)
    >>> len(positions) - 3 * len(triangles) // 2 + len(triangles)   # V - E + F of a sphere
    2
    """
    axes = [np.linspace(a, b, n + 1) for a, b in zip(np.asarray(low, float), np.asarray(high, float), strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = f(points) < 0.0
    steps = np.array([(n + 1) ** 2, n + 1, 1])
    cubes = (np.indices((n, n, n)).reshape(3, -1).T @ steps)[:, None]
    corners = cubes + np.array([(k & 1) * steps[0] + (k >> 1 & 1) * steps[1] + (k >> 2 & 1) * steps[2] for k in range(8)])
    mixed = inside[corners].any(axis=1) & ~inside[corners].all(axis=1)
    tetrahedra = corners[mixed][:, _TETRAHEDRA].reshape(-1, 4)
    count = inside[tetrahedra].sum(axis=1)
    found = [_cut_off(tetrahedra[(count == 1) | (count == 3)], inside), *_cut_through(tetrahedra[count == 2], inside)]
    crossed = np.concatenate(found).reshape(-1, 2)
    edges, edge_of = np.unique(np.sort(crossed, axis=1), axis=0, return_inverse=True)
    positions = crossings(f, points[edges[:, 0]], points[edges[:, 1]], inside[edges[:, 0]])
    triangles = edge_of.reshape(-1, 3).astype(np.int64)
    # Turn all to the side where f is positive: away from the ends of their edges that lie inside
    ends = np.where(inside[crossed[:, :1]], points[crossed[:, 0]], points[crossed[:, 1]]).reshape(-1, 3, 3).mean(axis=1)
    p = positions[triangles]
    towards = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p.mean(axis=1) - ends)
    triangles[towards < 0.0] = triangles[towards < 0.0][:, ::-1]
    return positions, triangles


def _cut_off(tetrahedra: NDArray[np.int64], inside: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(m, 3, 2): the crossed edges of tetrahedra of which one corner differs from the other three."""
    states = inside[tetrahedra]
    differs = np.argmax(states == (states.sum(axis=1) == 1)[:, None], axis=1)
    tip, *others = (np.take_along_axis(tetrahedra, ((differs + k) % 4)[:, None], axis=1)[:, 0] for k in range(4))
    return np.stack([np.stack([tip, other], axis=1) for other in others], axis=1)


def _cut_through(tetrahedra: NDArray[np.int64], inside: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """(m, 3, 2) twice: the crossed edges of both halves of the quadrilaterals in which two corners part from two."""
    a, b, c, d = np.take_along_axis(tetrahedra, np.argsort(inside[tetrahedra], axis=1, kind="stable"), axis=1).T
    ac, ad, bc, bd = (np.stack(pair, axis=1) for pair in ((a, c), (a, d), (b, c), (b, d)))
    return [np.stack([ac, ad, bd], axis=1), np.stack([ac, bd, bc], axis=1)]


def crossings(f: Callable[[Floats], Floats], a: Floats, b: Floats, a_inside: NDArray[np.bool_]) -> Floats:
    """Find where f changes its sign between points, by regula falsi that halves where it stalls.

    Parameters
    ----------
    f : callable
        Takes points (k, 3) and returns (k,).
    a, b : (k, 3) float64
    a_inside : (k,) bool
        Whether f is negative at a; at b it is the other way.

    Returns
    -------
    (k, 3) float64
    """
    low, high = np.where(a_inside[:, None], a, b), np.where(a_inside[:, None], b, a)
    at_low, at_high = f(low), f(high)
    middle = (low + high) / 2.0
    for k in range(_STEPS):
        share = np.full(len(low), 0.5)
        if k % 3 > 0:
            with np.errstate(divide="ignore", invalid="ignore"):
                share = np.nan_to_num(np.clip(at_low / (at_low - at_high), 0.0, 1.0), nan=0.5)
        middle = low + (high - low) * share[:, None]
        value = f(middle)
        below = value < 0.0
        low, at_low = np.where(below[:, None], middle, low), np.where(below, value, at_low)
        high, at_high = np.where(below[:, None], high, middle), np.where(below, at_high, value)
    return middle
