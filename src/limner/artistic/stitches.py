"""Where the surfaces of a solid that is combined of others meet, although their triangles do not.

The triangles that stand for a combination are those of its leaves, cut off where they leave it: of a drilled plate, those of the plate and
those of the hole. Along their common curve each ends by itself, at points of its own, so that for an adjacency both end in the open. Here
the one end is laid along the other: the finer of the two is the line, and which faces lie on both its sides says of what kind it is:

    one side towards the eye, the other away       a silhouette
    both, and the solid bends by an angle          a crease
    both, and it does not                          no line, as where two blocks are flush

What has no other beside it is a boundary, as of any mesh.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.adjacency import Adjacency
from ..mesh.components import component_labels
from .edges import Faces
from .outlines import towards_eye
from .segments import ROUNDING, Segments
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals

__all__ = ["StitchKinds", "stitched"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_BESIDE = 2e-3  # of a shape's extent: how far the ends of two surfaces that meet may lie apart
_ALONG = 0.9  # cosine between edges that run along each other
_ONE_FACE = 1e-2  # of that: how far, where both are of one face
_CELL = 4.0  # times the median length of the edges: the sides of a grid's cells
_MOST_PARTS = 100_000  # that edges are cut into for it


class StitchKinds(NamedTuple):
    """Rows of the kinds of lines among those of a drawing; -1: not asked for."""

    silhouette: int
    crease: int
    boundary: int


class _Ends(NamedTuple):
    """Edges at which exact shapes end in the open: which, their triangles, the face that these are of, their ends (k, 2, 3), the shape's
    normals there (k, 3), and how far from them others may lie."""

    edge: Indices
    triangle: Indices
    piece: Indices
    ends: Floats
    normal: Floats
    reach: Floats


def stitched(
    surfaces: Surfaces, faces: Faces, sharp: Flags, sight: SightLines, kinds: StitchKinds, crease_degrees: float
) -> tuple[Segments, Flags]:
    """The lines along such curves, and which edges, (k,), they replace; `sharp`, (k,), are the edges between faces."""
    replaced = np.zeros(len(faces.adjacency.edges), dtype=bool)
    ends = _open_ends(surfaces, faces.adjacency, sharp)
    i, j, span, apart = _beside(surfaces, ends)
    replaced[ends.edge[np.unique(i)]] = True
    fine = _fineness(ends)
    facing = towards_eye(sight, ends.ends.mean(axis=1), ends.normal)
    bends = (ends.normal[i] * ends.normal[j]).sum(axis=1) < math.cos(math.radians(crease_degrees))
    # Of two that run along each other the finer one is drawn; -1: nothing is, or not this one.
    kind = np.where(bends, kinds.crease, -1)
    if kinds.silhouette >= 0:
        kind = np.where(facing[i] != facing[j], kinds.silhouette, kind)
    finer = fine[ends.piece[i]] - fine[ends.piece[j]]
    kind = np.where((finer < 0) | ((finer == 0) & (i < j)), kind, -1)
    row, spans, kind = _cut(i, span, kind, kinds.boundary, 2.0 * ends.reach / _lengths(ends))
    a, b = ends.ends[row, 0], ends.ends[row, 1]
    made = np.stack([a + t[:, None] * (b - a) for t in spans.T], axis=1)
    for k in (0, 1):
        whole = spans[:, k] == k
        made[whole, k] = ends.ends[row[whole], k]
    slack = np.zeros(len(ends.edge))
    np.maximum.at(slack, i, apart)
    own = np.stack([ends.triangle[row], np.full(len(row), -1)], axis=1)
    return Segments(
        kind, made, own, 2.0 * slack[row] + ROUNDING * surfaces.extent, np.zeros(len(row), dtype=np.int64),
        surfaces.instance[ends.triangle[row]], np.zeros(len(row), dtype=bool), ends.triangle[row],
    ), replaced  # fmt: skip


def _open_ends(surfaces: Surfaces, adjacency: Adjacency, sharp: Flags) -> _Ends:
    first = adjacency.edge_start[:-1]
    half_edge = adjacency.edge_halfedges[first].astype(np.int64)
    edge = np.flatnonzero((adjacency.edge_counts == 1) & surfaces.exact[half_edge // 3] & surfaces.bounded[half_edge // 3])
    half_edge = half_edge[edge]
    triangle = half_edge // 3
    ends = surfaces.points[adjacency.edges[edge]]
    if not len(edge):
        return _Ends(edge, triangle, edge, ends, np.zeros((0, 3)), np.zeros(0))
    pairs = np.flatnonzero((adjacency.edge_counts == 2) & ~sharp)
    one, other = (adjacency.edge_halfedges[first[pairs] + k] // 3 for k in (0, 1))
    piece = component_labels(len(surfaces.triangles), one, other)[triangle].astype(np.int64)
    normals = corner_normals(surfaces, adjacency, adjacency.edge_counts != 2).reshape(-1, 3)
    normal = normals[half_edge] + normals[np.where(half_edge % 3 == 2, half_edge - 2, half_edge + 1)]
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    reach = np.zeros(len(edge))
    for number in np.unique(surfaces.instance[triangle]).tolist():
        rows = surfaces.instance[triangle] == number
        reach[rows] = _BESIDE * np.linalg.norm(np.ptp(ends[rows].reshape(-1, 3), axis=0))
    return _Ends(edge, triangle, piece, ends, normal / np.where(length > 0.0, length, 1.0), reach)


def _lengths(ends: _Ends) -> Floats:
    return np.asarray(np.maximum(np.linalg.norm(ends.ends[:, 1] - ends.ends[:, 0], axis=1), 1e-300))


def _fineness(ends: _Ends) -> Indices:
    """By faces: their places in the order of the mean length of their open ends, the finest first."""
    n = int(ends.piece.max(initial=-1)) + 1
    count = np.maximum(np.bincount(ends.piece, minlength=n), 1)
    made = np.empty(n, dtype=np.int64)
    made[np.argsort(np.bincount(ends.piece, _lengths(ends), n) / count, kind="stable")] = np.arange(n)
    return made


def _beside(surfaces: Surfaces, ends: _Ends) -> tuple[Indices, Indices, Floats, Floats]:
    """Edges i along which edges j of other surfaces of the shape run, from where to where of i, (n, 2), and how far away, (n,)."""
    i, j = _near_pairs(ends)
    near = (i != j) & (surfaces.instance[ends.triangle[i]] == surfaces.instance[ends.triangle[j]])
    for low, high in zip(ends.ends.min(axis=1).T.copy(), ends.ends.max(axis=1).T.copy(), strict=True):
        i, j = i[near], j[near]
        reach = np.where(ends.piece[i] == ends.piece[j], _ONE_FACE, 1.0) * ends.reach[i]
        near = (low[i] <= high[j] + reach) & (low[j] <= high[i] + reach)
    return _overlaps(ends, i[near], j[near])


def _near_pairs(ends: _Ends) -> tuple[Indices, Indices]:
    """Pairs of edges that have a cell of a grid in common, some more than once: each edge is in all that a part of it comes near to."""
    n, lengths = len(ends.edge), _lengths(ends)
    if not n:
        return ends.edge, ends.edge
    size = max(float(_CELL * np.median(lengths)), 2.0 * float(ends.reach.max()), float(lengths.sum()) / _MOST_PARTS)
    parts = np.ceil(lengths / size).astype(np.int64)
    row, k = np.repeat(np.arange(n), parts), _count_up(parts)
    way = (ends.ends[row, 1] - ends.ends[row, 0]) / parts[row, None]
    start = ends.ends[row, 0] + k[:, None] * way
    margin = 0.5 * ends.reach[row, None]
    low = np.floor((np.minimum(start, start + way) - margin) / size).astype(np.int64)
    wide = np.floor((np.maximum(start, start + way) + margin) / size).astype(np.int64) - low + 1
    low -= low.min(axis=0)
    cells = wide.prod(axis=1)
    row, low, wide, k = np.repeat(row, cells), np.repeat(low, cells, axis=0), np.repeat(wide, cells, axis=0), _count_up(cells)
    at = low + np.stack([k % wide[:, 0], k // wide[:, 0] % wide[:, 1], k // (wide[:, 0] * wide[:, 1])], axis=1)
    most = at.max(axis=0) + 1
    held = np.unique(((at[:, 0] * most[1] + at[:, 1]) * most[2] + at[:, 2]) * n + row)
    cell, row = held // n, held % n
    first = np.searchsorted(cell, cell)
    count = np.searchsorted(cell, cell, side="right") - first
    return np.repeat(row, count), row[np.repeat(first, count) + _count_up(count)]


def _count_up(count: Indices) -> Indices:
    """0 to count - 1 for each, one after the other."""
    return np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)


def _overlaps(ends: _Ends, i: Indices, j: Indices) -> tuple[Indices, Indices, Floats, Floats]:
    a, p = ends.ends[i, 0], ends.ends[j, 0]
    way, other = ends.ends[i, 1] - a, ends.ends[j, 1] - p
    squared, other_squared = (np.maximum((d * d).sum(axis=1), 1e-300) for d in (way, other))
    cosine = (way * other).sum(axis=1) / np.sqrt(squared * other_squared)
    t = np.stack([((p - a) * way).sum(axis=1), ((p + other - a) * way).sum(axis=1)], axis=1) / squared[:, None]
    span = np.clip(np.sort(t, axis=1), 0.0, 1.0)
    apart = np.zeros(len(i))
    for k in (0, 1):
        at = a + span[:, k, None] * way
        u = np.clip(((at - p) * other).sum(axis=1) / other_squared, 0.0, 1.0)
        apart = np.maximum(apart, np.linalg.norm(p + u[:, None] * other - at, axis=1))
    # Of one face only what lies in one place is a seam; what runs along itself farther away is a narrow part of it.
    reach = np.where(ends.piece[i] == ends.piece[j], _ONE_FACE, 1.0) * ends.reach[i]
    kept = (np.abs(cosine) > _ALONG) & (span[:, 0] < span[:, 1]) & (apart <= reach)
    return i[kept], j[kept], span[kept], apart[kept]


def _cut(i: Indices, span: Floats, kind: Indices, boundary: int, gap: Floats) -> tuple[Indices, Floats, Indices]:
    """Parts of edges with one kind: which edge, from where to where, of what kind; what no other runs along, if it is longer than `gap` of
    the edge, is a boundary. Parts that are no lines are left out."""
    order = np.lexsort((span[:, 1], span[:, 0], i))
    made: list[list[float]] = []
    at, edge = 1.0, -1
    for n in [*order.tolist(), -1]:
        row = int(i[n]) if n >= 0 else -1
        if row != edge:
            if edge >= 0 and at < 1.0:
                # A gap of rounding, or of the one polygon's corners, belongs to what is before it.
                if 1.0 - at > gap[edge]:
                    made.append([edge, at, 1.0, boundary])
                else:
                    made[-1][2] = 1.0
            at, edge = 0.0, row
        if n < 0:
            break
        start, end, what = float(span[n, 0]), float(span[n, 1]), int(kind[n])
        if end <= at:
            continue
        if start - at > gap[edge]:
            made.append([edge, at, start, boundary])
            at = start
        if at > 0.0 and made[-1][0] == edge and made[-1][3] == what:
            made[-1][2] = end
        else:
            made.append([edge, at, end, what])
        at = end
    table = np.array(made).reshape(-1, 4)
    table = table[table[:, 3] >= 0]
    return table[:, 0].astype(np.int64), table[:, 1:3], table[:, 3].astype(np.int64)
