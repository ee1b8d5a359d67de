"""Triangles made smaller where they should be, without cracks and without slivers: edges are split, and their triangles with them.

Whether an edge is split is asked of the edge, never of a triangle, so that all triangles at it agree; each is then cut by which of its
edges were split:

        none              one                two                three
         /\\               /\\                /\\                 /\\
        /  \\             / |\\              /__\\               /__\\
       /    \\           /  | \\            /  / \\             /\\  /\\
      /______\\         /___|__\\          /__/___\\           /__\\/__\\

Where one edge of a triangle is split its longest must be too, or what is left becomes ever thinner (Rivara 1984): `closed_marks` sees to
that. Corners have several numbers, of positions, of texture coordinates, of colours; each numbering is split alike, with rows of its own.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["HALF", "INSIDE", "WHOLE", "Cut", "Halves", "closed_marks", "cut", "first_places", "half_edges", "halves", "longest_edges"]

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

WHOLE, HALF, INSIDE = 0, 3, 9
"""Kinds of the edges of pieces, by number: the parent's edges 0 to 2; the halves of edge k at its start, 3 + 2 k, and at its end, 4 + 2 k;
and from 9 on, edges inside the parent."""

_NEXT = np.array([1, 2, 0])


class Halves(NamedTuple):
    """Middles of edges in one numbering.

    Attributes
    ----------
    ends : (k, 2) int64
        The two rows that each middle lies between.
    row : (h,) int64
        Which middle each half-edge has.
    """

    ends: Indices
    row: Indices


class Cut(NamedTuple):
    """How triangles were cut.

    Attributes
    ----------
    parent : (c,) int64
        The triangle that each piece comes from.
    corner : (c, 3) int64
        Which of its parent's points each corner is: 0, 1, 2 its corners; 3, 4, 5 the middles of the edges that leave them.
    edge : (c, 3) int64
        What the edge that leaves each corner is of: see `WHOLE`, `HALF`, `INSIDE`.
    """

    parent: Indices
    corner: Indices
    edge: Indices


def half_edges(triangles: Indices) -> tuple[Indices, Indices]:
    """(3 m,) int64 each: the lesser and the greater end of the edges that leave each corner."""
    start, end = triangles.reshape(-1), triangles[:, _NEXT].reshape(-1)
    return np.minimum(start, end), np.maximum(start, end)


def first_places(number: Indices, count: int) -> Indices:
    """(count,) int64: where each number, of which all occur, occurs first."""
    first = np.empty(count, dtype=np.int64)
    first[number[::-1]] = np.arange(len(number) - 1, -1, -1)
    return first


def halves(low: Indices, high: Indices, edge: Indices, n_edges: int) -> Halves:
    """Number the middles of edges in one numbering.

    Parameters
    ----------
    low, high : (h,) int64
        The ends of half-edges, in this numbering.
    edge : (h,) int64
        Which edge of the surface each belongs to, of `n_edges`.

    Notes
    -----
    Most edges have the same ends from all sides, and one middle, of their own number; along seams, other sides get middles of their own.
    """
    first = first_places(edge, n_edges)
    row = edge.copy()
    apart = np.flatnonzero((low != low[first][edge]) | (high != high[first][edge]))
    ends = np.stack([low[first], high[first]], axis=1)
    if not len(apart):
        return Halves(ends, row)
    own, number = np.unique(np.stack([edge[apart], low[apart], high[apart]], axis=1), axis=0, return_inverse=True)
    row[apart] = n_edges + number.reshape(-1)
    return Halves(np.concatenate([ends, own[:, 1:]]), row)


def longest_edges(edges: Indices, length: Floats) -> Indices:
    """(m,) int64: which of a triangle's three edges, (m, 3), is the longest; of equal ones that with the greatest number."""
    best = np.zeros(len(edges), dtype=np.int64)
    rows = np.arange(len(edges))
    for k in (1, 2):
        now, other = edges[rows, best], edges[:, k]
        longer = (length[other] > length[now]) | ((length[other] == length[now]) & (other > now))
        best = np.where(longer, k, best)
    return best


def closed_marks(marked: Flags, edges: Indices, longest: Indices) -> Flags:
    """Mark the longest edge of every triangle that has a marked one, until there is nothing more to mark.

    Parameters
    ----------
    marked : (e,) bool
    edges : (m, 3) int64
    longest : (m,) int64
        The number of the longest edge of each triangle.

    **Source**: M.-C. Rivara, "Algorithms for refining triangular grids suitable for adaptive and multigrid techniques", *International
    Journal for Numerical Methods in Engineering* 20, 1984. Each edge marked is longer than the one that it was marked for, so it ends.
    """
    marked = marked.copy()
    a, b, c = edges.T
    while True:
        more = longest[(marked[a] | marked[b] | marked[c]) & ~marked[longest]]
        if not len(more):
            return marked
        marked[more] = True


def cut(split: Flags, longest: Indices) -> Cut:
    """Cut triangles by which of their edges are split.

    Parameters
    ----------
    split : (m, 3) bool
        Whether the edge that leaves each corner is; with any, the longest.
    longest : (m,) int64
        Which is the longest. Where two are split, what is left beside the corner between them is cut from the longest's middle.
    """
    code = split @ np.array([1, 2, 4]) + 8 * longest
    parents, corners, edges = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 3), dtype=np.int64)]
    for pattern in np.unique(code):
        rows = np.flatnonzero(code == pattern)
        corner, edge = _pieces(int(pattern) % 8, int(pattern) // 8)
        parents.append(np.tile(rows, len(corner)))
        corners.append(np.repeat(corner, len(rows), axis=0))
        edges.append(np.repeat(edge, len(rows), axis=0))
    return Cut(np.concatenate(parents), np.concatenate(corners), np.concatenate(edges))


@cache
def _pieces(pattern: int, longest: int) -> tuple[Indices, Indices]:
    """(c, 3) each: corners and edges of the pieces of a triangle whose edges 0, 1, 2 are split by the bits of the pattern."""
    bits = [(pattern >> k) & 1 for k in range(3)]
    # Turned so that what is split comes first: edge 0 of one, edges 0 and 1 of two.
    turn = next((k for k in range(3) if bits[k] and (sum(bits) != 2 or bits[(k + 1) % 3])), 0)
    made = {
        0: [(0, 1, 2)],
        1: [(0, 3, 2), (3, 1, 2)],
        2: [(3, 1, 4), (0, 3, 2), (3, 4, 2)] if longest == turn else [(3, 1, 4), (0, 3, 4), (0, 4, 2)],
        3: [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
    }[sum(bits)]
    turned = [[(p + turn) % 3 + 3 * (p >= 3) for p in piece] for piece in made]
    inside: list[tuple[int, int]] = []
    edges = [[_kind(piece[k], piece[(k + 1) % 3], inside) for k in range(3)] for piece in turned]
    return np.array(turned, dtype=np.int64), np.array(edges, dtype=np.int64)


def _kind(p: int, q: int, inside: list[tuple[int, int]]) -> int:
    """What the edge from point p to point q of a triangle is of; `inside` lists the edges inside, in the order in which they are met."""
    low, high = min(p, q), max(p, q)
    if high < 3:
        return WHOLE + (low if high == low + 1 else 2)
    if low < 3:
        k = high - 3
        if low == k:
            return HALF + 2 * k
        if low == (k + 1) % 3:
            return HALF + 2 * k + 1
    if (low, high) not in inside:
        inside.append((low, high))
    return INSIDE + inside.index((low, high))
