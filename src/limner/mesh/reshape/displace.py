"""Displacement: vertices moved along the normal by a height, on as many triangles as the picture needs (FoCG 11.4.3).

A height map holds more detail than the mesh that it lies on has vertices. So edges are split until they are as short as the picture asks,
and shorter where the height changes between their ends:

    .-----------.          .--.--.--.--.             .''..  .-.
                    ->                      ->     .'    '-'   '-.
    the mesh               split                   moved

What decides whether an edge is split is the edge alone: where its ends and its middle are moved to, and how long it is seen. Positions
that are equal are one point, with one normal and one height, the mean over all texture coordinates that meet there. So no crack opens,
neither between triangles of different size, nor along seams of the texture, nor where vertices were split for their normals.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh import Mesh
from ..normals import vertex_normals
from ..weld import welded
from .refine import HALF, INSIDE, Cut, closed_marks, cut, half_edges, halves, longest_edges

__all__ = ["Displaced", "HeightFunction", "LengthFunction", "displaced"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

HeightFunction = Callable[[Floats, Floats, Floats], Floats]
"""Heights (n,) where texture coordinates are (n, 2), or (n, 4) with the second set, object-space points (n, 3), unit normals (n, 3)."""

LengthFunction = Callable[[Floats, Floats], Floats]
"""How long (n,) the edges from points (n, 3) to points (n, 3) are, in whatever unit the limit is in."""

_FINEST = 0.25  # of the longest edge: shorter ones are not split for their heights
_BEND = 0.1  # of the longest edge: how far the middle of an edge may be from the surface
_MOST_ROUNDS = 64


class Displaced(NamedTuple):
    """A displaced mesh, and the length of its longest undisplaced edge where that is more than was asked for; else 0."""

    mesh: Mesh
    longest: float


def displaced(
    mesh: Mesh,
    height: HeightFunction,
    *,
    scale: float,
    midlevel: float = 0.0,
    longest_edge: float,
    length: LengthFunction | None = None,
    max_triangles: int = 1_000_000,
    onto: Callable[[Floats, Floats], Floats] | None = None,
) -> Displaced:
    """Split a mesh's edges as needed, and move its points along their normals by ``scale * (height - midlevel)``.

    Parameters
    ----------
    mesh : Mesh
    height : callable
        Takes texture coordinates, (n, 2), or (n, 4) if the mesh has a second set, object-space points (n, 3), and their unit normals
        (n, 3); returns (n,).
    scale : float
        Object space, metres.
    midlevel : float
        The height that stays where it is.
    longest_edge : float > 0
        No edge stays longer, and where the height changes they become up to four times shorter.
    length : callable, optional
        Measures edges; None: in object space, metres. It must be symmetric in the two ends.
    max_triangles : int
        Not more than these, unless the mesh has more: the longest edges are split first.
    onto : callable, optional
        Takes points (n, 3) between those of the mesh and their unit normals (n, 3), and puts them onto the surface that the mesh stands
        for; None: they stay on the triangles.

    Returns
    -------
    Displaced
        The mesh has points where the given one had positions, equal ones joined; smooth normals of the displaced surface; texture
        coordinates, colours and materials as they were, interpolated. Tangents are left out.

    Notes
    -----
    The normal that a point moves along is the mean of those that the mesh has there, or the angle-weighted mean of the faces around it.

    Examples
    --------
    >>> square = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> hill = displaced(square, lambda uv, p, n: p[:, 0], scale=0.5, longest_edge=0.25).mesh
    >>> bool((hill.positions[:, 2] == 0.5 * hill.positions[:, 0]).all())
    True
    """
    surface = _Surface(mesh, _Rule(height, scale, midlevel, longest_edge, length or _straight, max_triangles, onto))
    for _ in range(_MOST_ROUNDS):
        if not surface.split_once():
            break
    return Displaced(surface.mesh(mesh), surface.left)


class _Rule(NamedTuple):
    """What `displaced` was asked for."""

    height: HeightFunction
    scale: float
    midlevel: float
    longest_edge: float
    length: LengthFunction
    max_triangles: int
    onto: Callable[[Floats, Floats], Floats] | None


class _Points(NamedTuple):
    """Where points were, (n, 3), their unit normals (n, 3), and where they were moved to (n, 3)."""

    base: Floats
    normal: Floats
    moved: Floats

    def and_those(self, more: _Points) -> _Points:
        return _Points(*(np.concatenate(both) for both in zip(self, more, strict=True)))


class _Layer:
    """A numbering of corners beside that of the points, and values by its numbers that are interpolated."""

    def __init__(self, values: Floats, triangles: Indices) -> None:
        self.values, self.triangles = values, triangles

    def middles(self, half: Indices, edge: Indices, n_edges: int) -> tuple[Floats, Indices]:
        """Values in the middle of half-edges, (k, c), and which of these each half-edge has."""
        corner, triangle = half % 3, 3 * (half // 3)
        start, end = (self.triangles.reshape(-1)[triangle + at] for at in (corner, (corner + 1) % 3))
        found = halves(np.minimum(start, end), np.maximum(start, end), edge, n_edges)
        return (self.values[found.ends[:, 0]] + self.values[found.ends[:, 1]]) / 2.0, found.row

    def split(self, half: Indices, edge: Indices, n_edges: int, kept: Flags, pieces: Cut) -> None:
        values, row = self.middles(half, edge, n_edges)
        self.triangles = _cut_corners(self.triangles, half, row + len(self.values), kept, pieces)
        self.values = np.concatenate([self.values, values])


class _Edges(NamedTuple):
    """Edges between points: the ends (e,), how long each is (e,), and the height in its middle (e,)."""

    low: Indices
    high: Indices
    length: Floats
    height: Floats

    def and_those(self, more: _Edges) -> _Edges:
        return _Edges(*(np.concatenate(both) for both in zip(self, more, strict=True)))


class _Surface:
    """The surface between two rounds of splitting: points, edges between them, and triangles of three of each."""

    def __init__(self, mesh: Mesh, rule: _Rule) -> None:
        self.rule = rule
        self.points, self.corners, self.uv = _start(mesh, rule)
        self.color = None if mesh.colors is None else _Layer(mesh.colors.astype(np.float64), mesh.triangles.astype(np.int64))
        self.layers = [layer for layer in (self.uv, self.color) if layer is not None]
        self.slots = np.zeros(len(self.corners), dtype=np.int32) if mesh.triangle_materials is None else mesh.triangle_materials
        low, high = half_edges(self.corners)
        _, first, edge = np.unique(low * max(len(self.points.base), 1) + high, return_index=True, return_inverse=True)
        self.sides = edge.reshape(-1, 3)
        none = np.zeros(0, dtype=np.int64)
        self.edges = _Edges(none, none, np.zeros(0), np.zeros(0))
        self._add_edges(low[first], high[first], 0)
        self.longest = longest_edges(self.sides, self.edges.length)
        self.left = 0.0

    def _add_edges(self, low: Indices, high: Indices, first_triangle: int) -> None:
        """Add edges that only the triangles from `first_triangle` on have; a height is the mean of those of an edge's sides."""
        known = len(self.edges.low)
        base, normal = self._middle_base(low, high)
        if self.uv is None:
            height = self.rule.height(np.zeros((len(base), 2)), base, normal)
        else:
            half = 3 * first_triangle + np.flatnonzero(self.sides[first_triangle:].reshape(-1) >= known)
            edge = self.sides.reshape(-1)[half] - known
            uvs, row = self.uv.middles(half, edge, len(low))
            edge_of_row = np.empty(len(uvs), dtype=np.int64)
            edge_of_row[row] = edge
            sides = self.rule.height(uvs, base[edge_of_row], normal[edge_of_row])
            height = np.bincount(edge_of_row, weights=sides, minlength=len(low)) / np.bincount(edge_of_row, minlength=len(low))
        length = _straight(self.points.base[low], self.points.base[high])
        self.edges = self.edges.and_those(_Edges(low, high, length, height))
        self.fresh = known

    def _middle_base(self, low: Indices, high: Indices) -> tuple[Floats, Floats]:
        """Where the middles of edges are before they are moved, and their unit normals."""
        base, normal = self.points.base, self.points.normal
        first = normal[low]
        between = _unit(first + normal[high], first)
        middle = (base[low] + base[high]) / 2.0
        return (middle if self.rule.onto is None else self.rule.onto(middle, between)), between

    def _middles(self, rows: Indices | slice) -> _Points:
        """The points that edges are split at."""
        base, normal = self._middle_base(self.edges.low[rows], self.edges.high[rows])
        return _moved(self.rule, base, normal, self.edges.height[rows])

    def split_once(self) -> bool:
        """Split the edges that should be; tell whether there may be more to do."""
        seen, wanted = self._wanted()
        if not wanted.any():
            self.left = 0.0
            return False
        marked = self._marked(self.fresh + np.flatnonzero(wanted), seen[wanted])
        self.left = float(seen[wanted & ~marked[self.fresh :]].max(initial=0.0))
        if not marked.any():
            return False
        self._split(marked)
        return self.left == 0.0

    def _wanted(self) -> tuple[Floats, Flags]:
        """Of the edges that were not asked before: how long they are seen before they are moved, and whether they should be split."""
        points, limit, see = self.points, self.rule.longest_edge, self.rule.length
        low, high = self.edges.low[self.fresh :], self.edges.high[self.fresh :]
        seen = see(points.base[low], points.base[high])
        wanted = seen > limit
        asked = np.flatnonzero(~wanted & (seen > _FINEST * limit))
        one, other = points.moved[low[asked]], points.moved[high[asked]]
        bend = see((one + other) / 2.0, self._middles(self.fresh + asked).moved)
        wanted[asked] = (see(one, other) > limit) | (bend > _BEND * limit)
        return seen, wanted

    def _marked(self, wanted: Indices, seen: Floats) -> Flags:
        """(e,): the edges to split: those that are wanted and what that entails; if they are too many, those that are seen longest."""
        order = wanted[np.argsort(-seen, kind="stable")]

        def mark(count: int) -> tuple[Flags, int]:
            chosen = np.zeros(len(self.edges.low), dtype=bool)
            chosen[order[:count]] = True
            closed = closed_marks(chosen, self.sides, self.sides[np.arange(len(self.sides)), self.longest])
            return closed, int(np.count_nonzero(closed[self.sides]))

        room = self.rule.max_triangles - len(self.corners)
        marked, added = mark(len(order))
        if added <= room:
            return marked
        # Each side of a split edge adds a triangle.
        enough, too_many = 0, len(order)
        while too_many - enough > 1:
            middle = (enough + too_many) // 2
            enough, too_many = (middle, too_many) if mark(middle)[1] <= room else (enough, middle)
        return mark(enough)[0]

    def _split(self, marked: Flags) -> None:
        number = np.cumsum(marked) - 1
        n_split, known, n_points = int(marked.sum()), len(self.edges.low), len(self.points.base)
        split = marked[self.sides]
        kept = ~split.any(axis=1)
        half = np.flatnonzero(split.reshape(-1))
        rank = number[self.sides.reshape(-1)[half]]
        pieces = cut(split[~kept], self.longest[~kept])
        before, sides_before = self.corners[~kept][pieces.parent], self.sides[~kept][pieces.parent]
        self.points = self.points.and_those(self._middles(np.flatnonzero(marked)))
        for layer in self.layers:
            layer.split(half, rank, n_split, kept, pieces)
        first_triangle = int(kept.sum())
        self.corners = _cut_corners(self.corners, half, n_points + rank, kept, pieces)
        sides, n_inside = self._sides_of_pieces(pieces, before, sides_before, number, known, n_split)
        self.sides = np.concatenate([self.sides[kept], sides])
        low, high = half_edges(self.corners[first_triangle:])
        is_new = sides.reshape(-1) >= known
        ends = np.empty((2, 2 * n_split + n_inside), dtype=np.int64)
        ends[:, sides.reshape(-1)[is_new] - known] = low[is_new], high[is_new]
        self._add_edges(ends[0], ends[1], first_triangle)
        self.longest = np.concatenate([self.longest[kept], longest_edges(sides, self.edges.length)])
        self.slots = np.concatenate([self.slots[kept], self.slots[~kept][pieces.parent]])

    def _sides_of_pieces(
        self, pieces: Cut, corners: Indices, sides: Indices, number: Indices, known: int, n_split: int
    ) -> tuple[Indices, int]:
        """(c, 3) numbers of the edges of pieces, whose parents had `corners` and `sides` (c, 3), and how many new ones lie inside."""
        kind = pieces.edge
        whole = np.take_along_axis(sides, np.minimum(kind, 2), axis=1)
        k, at_end = np.divmod(np.clip(kind - HALF, 0, 5), 2)
        edge = np.take_along_axis(sides, k, axis=1)
        end = np.take_along_axis(corners, (k + at_end) % 3, axis=1)
        half = known + 2 * number[edge] + (end != self.edges.low[edge])
        # Inside each parent edges are numbered 0, 1, 2; over all parents, one after the other.
        inside = np.maximum(kind - INSIDE, -1)
        n_parents = int(pieces.parent.max()) + 1
        count = np.zeros(n_parents, dtype=np.int64)
        np.maximum.at(count, pieces.parent, inside.max(axis=1) + 1)
        start = known + 2 * n_split + np.cumsum(count) - count
        found = np.where(kind < HALF, whole, np.where(kind < INSIDE, half, start[pieces.parent][:, None] + inside))
        return found, int(count.sum())

    def mesh(self, given: Mesh) -> Mesh:
        """The surface as a mesh."""
        triangles = self.corners.astype(np.int32)
        positions = self.points.moved.astype(np.float32)
        normals, at = vertex_normals(positions, triangles), triangles
        colors = None
        if self.color is not None:
            # Colours may differ where positions are equal: there is a position for each of them again.
            colors, at = self.color.values.astype(np.float32), self.color.triangles.astype(np.int32)
            point = np.zeros(len(colors), dtype=np.int64)
            point[at.reshape(-1)] = triangles.reshape(-1)
            positions = positions[point]
        uvs = None if self.uv is None else self.uv.values.astype(np.float32)
        return Mesh(
            positions,
            at,
            normals=normals,
            normal_triangles=triangles,
            uvs=None if uvs is None else uvs[:, :2],
            uv_triangles=None if self.uv is None else self.uv.triangles.astype(np.int32),
            uvs1=None if uvs is None or uvs.shape[1] == 2 else uvs[:, 2:],
            colors=colors,
            triangle_materials=None if given.triangle_materials is None else self.slots,
            name=given.name,
        )


def _start(mesh: Mesh, rule: _Rule) -> tuple[_Points, Indices, _Layer | None]:
    """Points where the mesh has positions, the corners' points, and its texture coordinates."""
    index, first = welded(mesh.positions)
    corners = index[mesh.triangles.astype(np.int64)]
    base = mesh.positions[first].astype(np.float64)
    normal = _point_normals(mesh, corners, base)
    if mesh.uvs is None:
        return _moved(rule, base, normal, rule.height(np.zeros((len(base), 2)), base, normal)), corners, None
    values = mesh.uvs if mesh.uvs1 is None else np.concatenate([mesh.uvs, mesh.uvs1], axis=1)
    at = (mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles).astype(np.int64)
    uv = _Layer(np.nan_to_num(values).astype(np.float64), at)
    point, row = np.divmod(np.unique(corners.reshape(-1) * len(values) + at.reshape(-1)), max(len(values), 1))
    count = np.bincount(point, minlength=len(base))
    total = np.bincount(point, weights=rule.height(uv.values[row], base[point], normal[point]), minlength=len(base))
    return _moved(rule, base, normal, np.where(count > 0, total / np.maximum(count, 1), rule.midlevel)), corners, uv


def _point_normals(mesh: Mesh, corners: Indices, base: Floats) -> Floats:
    """(n, 3): the mean of a point's normals, each counted once; the faces' where it has none."""
    smooth = vertex_normals(base, corners).astype(np.float64)
    if mesh.normals is None:
        return smooth
    at = mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles
    n_rows = max(len(mesh.normals), 1)
    point, row = np.divmod(np.unique(corners.reshape(-1) * n_rows + at.reshape(-1)), n_rows)
    given = np.nan_to_num(mesh.normals).astype(np.float64)[row]
    # Vertices that were split for their texture coordinates have one normal twice: it counts once.
    _, once = welded(point.astype(np.int32).view(np.float32)[:, None], given.astype(np.float32)) if len(point) else (point, point)
    sums = np.zeros((len(base), 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(point[once], weights=given[once, axis], minlength=len(base))
    return _unit(sums, smooth)


def _moved(rule: _Rule, base: Floats, normal: Floats, height: Floats) -> _Points:
    return _Points(base, normal, base + normal * (rule.scale * (height - rule.midlevel))[:, None])


def _cut_corners(corners: Indices, half: Indices, row: Indices, kept: Flags, pieces: Cut) -> Indices:
    """Corners in one numbering: of the triangles that are kept, and of the pieces of the others."""
    middles = np.full(corners.size, -1, dtype=np.int64)
    middles[half] = row
    six = np.concatenate([corners, middles.reshape(-1, 3)], axis=1)[~kept]
    return np.concatenate([corners[kept], np.take_along_axis(six[pieces.parent], pieces.corner, axis=1)])


def _straight(a: Floats, b: Floats) -> Floats:
    return np.sqrt(_squared(b - a))


def _squared(v: Floats) -> Floats:
    return np.asarray(np.einsum("ij,ij->i", v, v))


def _unit(vectors: Floats, otherwise: Floats) -> Floats:
    length = np.sqrt(_squared(vectors))
    known = length > 1e-9
    return np.where(known[:, None], vectors / np.where(known, length, 1.0)[:, None], otherwise)
