"""Polygons out of triangles: those of one polygon lose the sides between them, and what is left is its border.

    d--c        a b c, a c d         a b c d
    | /|   ->   sides a b, b c, c a, a c, c d, d a; c a and a c cancel
    a--b
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..mesh import Mesh

__all__ = ["merged", "pairs_of_triangles"]

Indices = NDArray[np.int64]


def pairs_of_triangles(mesh: Mesh) -> Indices:
    """Number the quadrilaterals that follow one another in the list as triangles a b c and a c d, and the triangles that are left."""
    t = mesh.triangles
    goes_on = np.zeros(len(t), dtype=bool)  # with the one before
    goes_on[1:] = (t[1:, 0] == t[:-1, 0]) & (t[1:, 1] == t[:-1, 2])
    uv = t if mesh.uv_triangles is None else mesh.uv_triangles
    goes_on[1:] &= (uv[1:, 0] == uv[:-1, 0]) & (uv[1:, 1] == uv[:-1, 2])
    if mesh.triangle_materials is not None:
        goes_on[1:] &= mesh.triangle_materials[1:] == mesh.triangle_materials[:-1]
    # Of a fan every second one goes on with the one before
    begin = np.maximum.accumulate(np.where(goes_on, 0, np.arange(len(t))))
    second = (np.arange(len(t)) - begin) % 2 == 1
    return np.cumsum(~second) - 1


def merged(triangles: NDArray[np.integer], numbers: Indices, named: NDArray[np.integer] | None = None) -> tuple[Indices, Indices, Indices]:
    """Join the triangles of each polygon.

    Parameters
    ----------
    triangles : (m, 3) int
    numbers : (m,) int64
        The polygon of each, 0 .. p - 1.
    named : (m, 3) int, optional
        What to return of the corners instead of their vertices.

    Returns
    -------
    corners : (h,) int64
        Of all polygons in a row, from the first corner of each polygon's first triangle on.
    counts : (p,) int64
    first : (p,) int64
        The first triangle of each polygon.

    Raises SceneError where what is left of a polygon's sides is not one closed line.
    """
    p = int(numbers.max()) + 1
    first = np.full(p, len(numbers), dtype=np.int64)
    np.minimum.at(first, numbers, np.arange(len(numbers)))
    values = (triangles if named is None else named).reshape(-1).astype(np.int64)
    if p == len(numbers):
        order = np.argsort(numbers, kind="stable")
        return values.reshape(-1, 3)[order].reshape(-1), np.full(p, 3, dtype=np.int64), first
    start, end = triangles.reshape(-1).astype(np.int64), triangles[:, [1, 2, 0]].reshape(-1).astype(np.int64)
    number = np.repeat(numbers, 3)
    kept = _outer_sides(start, end, number)
    counts = np.bincount(number[kept], minlength=p)
    chain = _chained(start[kept], end[kept], number[kept], counts, _first_kept(kept, number, first, p))
    return values[kept][chain], counts, first


def _outer_sides(start: Indices, end: Indices, number: Indices) -> Indices:
    """The sides whose opposite is not in the same polygon."""
    n = int(start.max()) + 1
    # Twice the side's number and which way it runs; polygons apart
    key = np.minimum(start, end) * n + np.maximum(start, end)
    order = np.lexsort((key, number))
    same = (key[order][1:] == key[order][:-1]) & (number[order][1:] == number[order][:-1])
    inner = np.zeros(len(start), dtype=bool)
    inner[order[1:][same]] = inner[order[:-1][same]] = True
    return np.flatnonzero(~inner)


def _first_kept(kept: Indices, number: Indices, first: Indices, p: int) -> Indices:
    """Where among the outer sides each polygon begins: its first triangle's first side that is left."""
    begin = np.full(p, len(kept), dtype=np.int64)
    own = kept // 3 == first[number[kept]]
    candidates = np.flatnonzero(own) if own.any() else np.zeros(0, dtype=np.int64)
    np.minimum.at(begin, number[kept][candidates], candidates)
    # A first triangle may lie in the middle of its polygon
    elsewhere = np.full(p, len(kept), dtype=np.int64)
    np.minimum.at(elsewhere, number[kept], np.arange(len(kept)))
    begin = np.where(begin < len(kept), begin, elsewhere)
    if (begin >= len(kept)).any():
        raise SceneError(f"catmull_clark.polygons: polygon {int(np.argmax(begin >= len(kept)))} has no border")
    return begin


def _chained(start: Indices, end: Indices, number: Indices, counts: Indices, begin: Indices) -> Indices:
    """The order of sides along the border of each polygon."""
    n = int(max(start.max(), end.max())) + 1
    order = np.argsort(number * n + start, kind="stable")
    keys = (number * n + start)[order]
    at = np.minimum(np.searchsorted(keys, number * n + end), len(keys) - 1)
    onwards = order[at]
    chain = np.full(len(start), -1, dtype=np.int64)
    offset, here, going = np.cumsum(counts) - counts, begin, np.arange(len(counts))
    for step in range(int(counts.max())):
        chain[offset[going] + step] = here[going]
        here = onwards[here]
        going = going[counts[going] > step + 1]
    once = np.bincount(chain, minlength=len(chain)) == 1
    broken = ~once | (keys[at] != number * n + end)
    if broken.any():
        raise SceneError(f"catmull_clark.polygons: the border of polygon {number[np.argmax(broken)]} is not one closed line")
    return chain
