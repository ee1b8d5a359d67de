"""What may be wrong with a mesh beside its topology: triangles and vertices that are too many, and neighbours that miss each other.

A *T-junction* is a vertex that lies on somebody else's edge. The surface looks closed there, but the edge's triangle and those at the
vertex are not neighbours: rounding opens a crack between them, and interpolated colours jump.

        a-----------c         the edge a-c above ends at a and c,
        |\\         /|         the two triangles below meet in b between them
        a----b------c
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..adjacency import Adjacency, grouped_order
from ..components import component_labels
from ..mesh import Mesh
from ..normals import are_degenerate
from .topology import adjacent

__all__ = [
    "as_rows_of_bits", "degenerate_triangles", "duplicate_triangles", "duplicate_vertices", "linked_within", "near_pairs", "t_junctions",
    "unused_vertices",
]  # fmt: skip

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]

# How far a vertex may lie off an edge that it is said to lie on, as a share of the mesh's diagonal: ten roundings of float32.
_TOUCHING = 1e-6
_PAIRS_AT_ONCE = 1 << 22
_MOST_PAIRS = 1 << 29
_MOST_CELLS = 1 << 20  # along an axis, so that three of them fit a word


def degenerate_triangles(mesh: Mesh) -> Indices:
    """The triangles, (k,) int32, without area: corners that coincide or lie on a line, up to the rounding of float32."""
    return np.flatnonzero(are_degenerate(mesh.positions.astype(np.float64), mesh.triangles)).astype(np.int32)


def duplicate_triangles(surface: Mesh | Adjacency) -> Indices:
    """The triangles, (k,) int32, whose vertices an earlier one has already, in whatever order."""
    found = adjacent(surface)
    whole = np.flatnonzero(found.triangle_edges[:, 0] >= 0)
    bits = max((found.n_vertices - 1).bit_length(), 1)
    # The least edge of a triangle joins its two lesser vertices; with the greatest it names the triangle.
    key = found.triangle_edges[whole].min(axis=1).astype(np.int64) << bits | found.triangles[whole].max(axis=1)
    _, order, first = grouped_order(key, bits + len(found.edges).bit_length())
    again = np.ones(len(order), dtype=bool)
    again[first] = False
    return np.sort(whole[order[again]]).astype(np.int32)


def unused_vertices(surface: Mesh | Adjacency) -> Indices:
    """The vertices, (k,) int32, that no triangle names, but for collapsed ones."""
    return np.flatnonzero(adjacent(surface).vertex_counts == 0).astype(np.int32)


def duplicate_vertices(mesh: Mesh) -> Indices:
    """The vertices, (k,) int32, that stand exactly where an earlier one stands."""
    row = as_rows_of_bits(mesh.positions + np.float32(0.0))  # -0 is 0
    order = np.argsort(row, kind="stable")
    return np.sort(order[1:][row[order[1:]] == row[order[:-1]]]).astype(np.int32)


def as_rows_of_bits(values: NDArray[Any]) -> NDArray[np.int64]:
    """Number the rows of an array so that rows with equal bits, and only those, have equal numbers: (n,) int64."""
    if not values.size:
        return np.zeros(len(values), dtype=np.int64)
    words = np.ascontiguousarray(values).reshape(len(values), -1).view(np.uint8)
    spare = -words.shape[1] % 4
    words = np.ascontiguousarray(np.pad(words, ((0, 0), (0, spare)))).view(np.uint32)
    number = np.zeros(len(values), dtype=np.int64)
    bits = len(values).bit_length()
    for column in words.T:
        rank = _ranked(column.astype(np.int64), 32)
        number = _ranked(number << bits | rank, 2 * bits)
    return number


def _ranked(key: NDArray[np.int64], key_bits: int) -> NDArray[np.int64]:
    """Number keys in their order, equal ones alike: small numbers, which can be packed with others."""
    key, order, first = grouped_order(key, key_bits)
    number = np.empty(len(key), dtype=np.int64)
    number[order] = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(key))))
    return number


def t_junctions(mesh: Mesh, tolerance: float | None = None, surface: Adjacency | None = None) -> Indices:
    """Find vertices of the boundary that lie on an edge of the boundary, between its ends.

    Parameters
    ----------
    mesh : Mesh
    tolerance : float >= 0, optional
        How far off the edge a vertex may lie, metres; None: a millionth of the mesh's diagonal.
    surface : Adjacency, optional
        Of the mesh, where it is known.

    Returns
    -------
    (k, 2) int32
        Vertex, and half-edge (see `adjacency`) on whose edge it lies; by half-edge, then along it. Of vertices in one place only the
        first counts, and none that stands at one of the edge's ends.
    """
    found = adjacent(mesh if surface is None else surface)
    halfedges = found.boundary_halfedges
    none = np.zeros((0, 2), dtype=np.int32)
    if not len(halfedges):
        return none
    start, end = found.ends(halfedges)
    vertices = np.unique(np.concatenate([start, end]))
    points = mesh.positions[vertices].astype(np.float64) + 0.0
    _, first = np.unique(as_rows_of_bits(points.astype(np.float32)), return_index=True)
    vertices, points = vertices[np.sort(first)], points[np.sort(first)]
    box = mesh.bounds
    near = float(np.linalg.norm(box[1] - box[0])) * _TOUCHING if tolerance is None else float(tolerance)
    a, b = mesh.positions[start].astype(np.float64), mesh.positions[end].astype(np.float64)
    point, edge, along = _points_on_segments(points, a, b, near)
    # A triangle so flat that its own corner lies on its edge is degenerate, no neighbour.
    others = (found.triangles[halfedges[edge] // 3] != vertices[point][:, None]).all(axis=1)
    point, edge, along = point[others], edge[others], along[others]
    order = np.lexsort((along, halfedges[edge]))
    return np.stack([vertices[point], halfedges[edge]], axis=1)[order].astype(np.int32) if len(point) else none


def _points_on_segments(points: Floats, a: Floats, b: Floats, near: float) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    """Which points lie on which segments, within a distance and not at their ends, and where along them.

    Segments are cut into pieces about as long as they are on average, and a piece looks into the cells of a grid around its middle.
    """
    length = np.linalg.norm(b - a, axis=1)
    usable = np.flatnonzero(length > 2.0 * near)
    if not len(usable):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0)
    piece = float(length[usable].mean())
    count = np.ceil(length[usable] / piece).astype(np.int64)
    owner = np.repeat(usable, count)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    t = ((number + 0.5) / np.repeat(count, count))[:, None]
    middles = (1.0 - t) * a[owner] + t * b[owner]
    close = near_pairs(points, middles, 0.5 * piece + near)
    found = [_on_segments(points[p], a[owner[q]], b[owner[q]], near, p, owner[q]) for p, q in close]
    if not found:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0)
    point, edge, along = (np.concatenate(column) for column in zip(*found, strict=True))
    _, first = np.unique(point * len(a) + edge, return_index=True)
    return point[first], edge[first], along[first]


def _on_segments(
    p: Floats, a: Floats, b: Floats, near: float, point: NDArray[np.int64], edge: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    direction = b - a
    squared = (direction * direction).sum(axis=1)
    t = ((p - a) * direction).sum(axis=1) / squared
    off = p - a - t[:, None] * direction
    margin = near / np.sqrt(squared)
    on = ((off * off).sum(axis=1) <= near * near) & (t > margin) & (t < 1.0 - margin) & (p != a).any(axis=1) & (p != b).any(axis=1)
    return point[on], edge[on], t[on]


def near_pairs(points: Floats, others: Floats, radius: float) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Yield pairs of a point and another that are at most `radius` apart along every axis, perhaps with some more.

    Parameters
    ----------
    points : (n, 3) float64, n > 0
    others : (k, 3) float64
    radius : float >= 0

    Yields
    ------
    point, other : (p,) int64
        Numbers, in parts of bounded size.

    Raises SceneError where the radius is so large that the pairs could not be gone through.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    # Wider than the box around a point, which so meets two cells along each axis.
    cell = max(2.0 * radius * (1.0 + 1e-9), float((high - low).max()) / _MOST_CELLS, np.finfo(np.float64).tiny)
    n_cells = np.floor((high - low) / cell).astype(np.int64) + 1
    inside = np.flatnonzero(((others >= low - radius) & (others <= high + radius)).all(axis=1))
    key, order, _ = grouped_order(_cell_keys(np.floor((points - low) / cell).astype(np.int64), n_cells), int(np.prod(n_cells)).bit_length())
    corner = np.floor((others[inside] - radius - low) / cell).astype(np.int64)
    n_pairs = 0
    for step in np.ndindex(2, 2, 2):
        wanted = corner + step
        meets = np.flatnonzero(((wanted >= 0) & (wanted < n_cells)).all(axis=1))
        keys = _cell_keys(wanted[meets], n_cells)
        begin = np.searchsorted(key, keys, side="left")
        count = np.searchsorted(key, keys, side="right") - begin
        n_pairs += int(count.sum())
        if n_pairs > _MOST_PAIRS:
            raise SceneError(f"a tolerance of {radius:g} is too large: hundreds of vertices lie within it of each other")
        yield from _expanded(begin, count, order, inside[meets])


def _cell_keys(cells: NDArray[np.int64], n_cells: NDArray[np.int64]) -> NDArray[np.int64]:
    return (cells[:, 0] * n_cells[1] + cells[:, 1]) * n_cells[2] + cells[:, 2]


def _expanded(
    begin: NDArray[np.int64], count: NDArray[np.int64], order: Indices, others: NDArray[np.int64]
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """All pairs of the points ``order[begin:begin + count]`` with each of the others, in parts."""
    some = count > 0
    begin, count, others = begin[some], count[some], others[some]
    ends, at = np.cumsum(count), 0
    while at < len(count):
        done = int(ends[at - 1]) if at else 0
        stop = max(int(np.searchsorted(ends, done + _PAIRS_AT_ONCE, side="right")), at + 1)
        n = count[at:stop]
        offset = np.arange(int(n.sum())) - np.repeat(np.cumsum(n) - n, n)
        yield order[np.repeat(begin[at:stop], n) + offset].astype(np.int64), np.repeat(others[at:stop], n)
        at = stop


def linked_within(positions: NDArray[np.float32], tolerance: float, kinds: NDArray[np.int64] | None = None) -> Indices:
    """Name clusters of points: two of one kind that are at most `tolerance` apart are in one.

    Parameters
    ----------
    positions : (n, 3) float32
    tolerance : float >= 0
    kinds : (n,) int64 >= 0, optional
        None: all are alike.

    Returns
    -------
    (n,) int32
        The least point of each cluster.
    """
    if not len(positions):
        return np.zeros(0, dtype=np.int32)
    kind = np.zeros(len(positions), dtype=np.int64) if kinds is None else kinds
    same = as_rows_of_bits(positions + np.float32(0.0)) * (int(kind.max()) + 1) + kind
    links = [_chained(same)]
    if tolerance > 0.0:
        # One stands for all in its place, or many points in one place would make pairs of them all.
        _, first = np.unique(same, return_index=True)
        standing = positions[first].astype(np.float64)
        for p, q in near_pairs(standing, standing, tolerance):
            near = (p < q) & (((standing[p] - standing[q]) ** 2).sum(axis=1) <= tolerance * tolerance)
            one, other = first[p[near]], first[q[near]]
            alike = kind[one] == kind[other]
            links.append((one[alike], other[alike]))
    ones, others = (np.concatenate(side) for side in zip(*links, strict=True))
    return component_labels(len(positions), ones, others)


def _chained(groups: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Links between neighbours in each group."""
    order = np.argsort(groups, kind="stable")
    same = groups[order[1:]] == groups[order[:-1]]
    return order[1:][same], order[:-1][same]
