"""Polygons over shared vertices, and which of them meet at an edge: what every rule of subdivision asks.

A corner is a polygon's begin of a side. The sides of two corners that run along the same edge in opposite directions are twins; an edge
without twins (on a border, between three polygons, between two that are turned differently) is sharp: the surface ends there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..adjacency import grouped_order

__all__ = ["Faces", "faces_of", "summed"]

Values = NDArray[np.float64]
Indices = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Faces:
    """Polygons, corner by corner.

    Attributes
    ----------
    n_vertices : int
    vertex : (h,) int32
        Of each corner; the corners of a polygon follow one another.
    start : (m + 1,) int32
        The first corner of each polygon, and h.
    edges : (e, 2) int32
        Vertices, the lesser first, in lexicographic order.
    edge_of : (h,) int32
        The edge of the side from a corner to the next.
    twin : (h,) int32
        The corner whose side runs the other way; -1: there is none.
    """

    n_vertices: int
    vertex: Indices
    start: Indices
    edges: Indices
    edge_of: Indices
    twin: Indices

    @cached_property
    def sides(self) -> int:
        """Corners of every polygon; 0 where they differ."""
        counts = np.diff(self.start)
        return int(counts[0]) if len(counts) and (counts == counts[0]).all() else 0

    @cached_property
    def following(self) -> Indices:
        """(h,) int32: the next corner of the same polygon."""
        corners = np.arange(1, len(self.vertex) + 1, dtype=np.int32)
        corners[self.start[1:] - 1] = self.start[:-1]
        return corners

    @cached_property
    def preceding(self) -> Indices:
        """(h,) int32: the corner before, of the same polygon."""
        corners = np.arange(-1, len(self.vertex) - 1, dtype=np.int32)
        corners[self.start[:-1]] = self.start[1:] - 1
        return corners

    @cached_property
    def face(self) -> Indices:
        """(h,) int32: the polygon of each corner."""
        return np.repeat(np.arange(len(self.start) - 1, dtype=np.int32), np.diff(self.start))

    @cached_property
    def is_sharp(self) -> NDArray[np.bool_]:
        """(e,): edges that have no twins."""
        sharp = np.ones(len(self.edges), dtype=bool)
        sharp[self.edge_of[self.twin >= 0]] = False
        return sharp

    def means(self, values: Values) -> Values:
        """The mean over the corners of each polygon: (m, c)."""
        if self.sides:
            return values[self.vertex].reshape(-1, self.sides, values.shape[1]).mean(axis=1)
        if not len(self.vertex):
            return np.zeros((0, values.shape[1]))
        return np.add.reduceat(values[self.vertex], self.start[:-1], axis=0) / np.diff(self.start)[:, None]

    def neighbours(self, values: Values, chosen: NDArray[np.bool_] | None = None) -> tuple[Values, Values]:
        """The sum of what is at the other ends of each vertex' (chosen) edges, (n, c), and their number, (n,) float64."""
        edges = self.edges if chosen is None else self.edges[chosen]
        ends, others = np.concatenate([edges[:, 0], edges[:, 1]]), np.concatenate([edges[:, 1], edges[:, 0]])
        return summed(ends, values, len(values), others), np.bincount(ends, minlength=len(values)).astype(np.float64)

    def find_edges(self, pairs: NDArray[np.int64]) -> NDArray[np.int64]:
        """The number of each edge given by two vertices (k, 2) in any order; -1: it is none."""
        keys = self.edges[:, 0].astype(np.int64) * self.n_vertices + self.edges[:, 1]
        wanted = pairs.min(axis=1) * self.n_vertices + pairs.max(axis=1)
        at = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
        return np.where(keys[at] == wanted, at, -1) if len(keys) else np.full(len(wanted), -1, dtype=np.int64)


def faces_of(vertex: NDArray[np.integer], n_vertices: int, counts: NDArray[np.integer] | None = None) -> Faces:
    """Make faces from the vertices of their corners: (m, k), or all in a row (h,) with the number of each polygon's corners (m,)."""
    corners = np.ascontiguousarray(vertex, dtype=np.int32).reshape(-1)
    if counts is None:
        start = np.arange(0, len(corners) + 1, vertex.shape[1], dtype=np.int32)
    else:
        start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    ends = np.empty_like(corners)
    ends[:-1] = corners[1:]
    ends[start[1:] - 1] = corners[start[:-1]]
    bits = max(int(n_vertices - 1).bit_length(), 1)
    key = np.minimum(corners, ends).astype(np.int64) << bits
    key |= np.maximum(corners, ends)
    key, order, first = grouped_order(key, 2 * bits)
    edges = np.empty((len(first), 2), dtype=np.int32)
    edges[:, 0], edges[:, 1] = key[first] >> bits, key[first] & ((1 << bits) - 1)
    count = np.diff(first, append=len(key))
    edge_of = np.empty(len(corners), dtype=np.int32)
    edge_of[order] = np.repeat(np.arange(len(edges), dtype=np.int32), count)
    twin = np.full(len(corners), -1, dtype=np.int32)
    one, other = order[first[count == 2]], order[first[count == 2] + 1]
    opposed = corners[one] != corners[other]
    twin[one[opposed]], twin[other[opposed]] = other[opposed], one[opposed]
    return Faces(n_vertices, corners, start, edges, edge_of, twin)


def summed(
    index: NDArray[np.integer],
    values: Values,
    count: int,
    rows: NDArray[np.integer] | None = None,
    *,
    weights: Values | None = None,
) -> Values:
    """Add up what goes to the same place: rows (k, c), or those that `rows` (k,) names, times weights (k,); (count, c)."""
    sums = np.empty((count, values.shape[1]))
    for column in range(values.shape[1]):
        terms = np.ascontiguousarray(values[:, column])
        terms = terms if rows is None else terms[rows]
        sums[:, column] = np.bincount(index, weights=terms if weights is None else terms * weights, minlength=count)
    return sums
