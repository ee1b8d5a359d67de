"""Which triangles, edges and vertices of a mesh touch (FoCG 12.1.1): half-edges as plain arrays.

Every triangle has three half-edges: number ``3 t + k`` runs from corner k of triangle t to the next corner. One sort of the half-edges
by their two ends brings those of an edge side by side, and everything else is read off.

                 c                     half-edge 3 t + 0 runs a -> b, 3 t + 1 b -> c, 3 t + 2 c -> a
                / \\                    corner 3 t + k is where half-edge 3 t + k begins
               /   \\
        t:    a-----b                  opposite[3 t] runs b -> a in the triangle below, if both are oriented alike
               \\   /
                \\ /

The key of a half-edge, its ends and its number are packed into one 64-bit word each, so that a plain sort, which processors do by the
vector, takes the place of an indirect one.

**Source**: the arrays are the directed edges of S. Campagna, L. Kobbelt and H.-P. Seidel, "Directed Edges: A Scalable Representation for
Triangle Meshes", *Journal of Graphics Tools* 3(4), 1998; edges with one triangle, or with more than two, are kept too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

if TYPE_CHECKING:
    from .mesh import Mesh

__all__ = ["Adjacency", "adjacency", "adjacency_of_triangles", "following", "grouped_order", "preceding"]

Indices = NDArray[np.int32]

_KEY_BITS = 63  # of a signed word


def following(halfedges: NDArray[Any]) -> NDArray[Any]:
    """The next half-edges in the same triangles."""
    return np.where(halfedges % 3 == 2, halfedges - 2, halfedges + 1)


def preceding(halfedges: NDArray[Any]) -> NDArray[Any]:
    """The half-edges before, in the same triangles."""
    return np.where(halfedges % 3 == 0, halfedges + 2, halfedges - 1)


@dataclass(frozen=True, eq=False)
class Adjacency:
    """What touches what. All arrays are read-only.

    A triangle that names a vertex twice has collapsed: it has no edges and stands beside no vertex.

    Attributes
    ----------
    n_vertices : int
    triangles : (m, 3) int32
        The mesh's own.
    edges : (e, 2) int32
        Vertices of each edge, the lesser first, in lexicographic order: this numbers the edges, for `Mesh.edge_attributes` too.
    triangle_edges : (m, 3) int32
        Edge of each half-edge: column k is the side from corner k to the next; -1: the triangle has collapsed.
    edge_start : (e + 1,) int32
    edge_halfedges : (h,) int32
        Half-edges of edge i are ``edge_halfedges[edge_start[i]:edge_start[i + 1]]``, ascending; their triangles are those // 3.
    opposite : (3 m,) int32
        The other half-edge of an edge that has two, whichever way it runs; -1: there is none, or there are several.
    vertex_start : (n + 1,) int32
    vertex_corners : (h,) int32
        Corners at vertex i are ``vertex_corners[vertex_start[i]:vertex_start[i + 1]]``, ascending; their triangles are those // 3.
    """

    n_vertices: int
    triangles: Indices
    edges: Indices
    triangle_edges: Indices
    edge_start: Indices
    edge_halfedges: Indices
    opposite: Indices
    vertex_start: Indices
    vertex_corners: Indices

    @property
    def edge_counts(self) -> Indices:
        """(e,) int32: how many triangles meet at each edge."""
        return np.diff(self.edge_start)

    @property
    def vertex_counts(self) -> Indices:
        """(n,) int32: how many triangles meet at each vertex."""
        return np.diff(self.vertex_start)

    @property
    def edge_triangles(self) -> Indices:
        """(e, 2) int32: the first two triangles of each edge; -1: there is no second."""
        beside = np.full((len(self.edges), 2), -1, dtype=np.int32)
        first, count = self.edge_start[:-1], self.edge_counts
        beside[:, 0] = self.edge_halfedges[first] // 3
        beside[count > 1, 1] = self.edge_halfedges[first[count > 1] + 1] // 3
        return beside

    @property
    def next_around(self) -> Indices:
        """(3 m,) int32: the half-edge that leaves the same vertex next, counter-clockwise; -1: there the surface ends or is not
        oriented."""
        around = self.opposite[preceding(np.arange(self.triangles.size))]
        start = self.triangles.reshape(-1)
        return np.where((around >= 0) & (start[around] == start), around, np.int32(-1))

    @property
    def boundary_halfedges(self) -> Indices:
        """(b,) int32: the half-edges of edges with one triangle, in the edges' order."""
        return self.edge_halfedges[self.edge_start[:-1][self.edge_counts == 1]]

    def ends(self, halfedges: NDArray[Any]) -> tuple[Indices, Indices]:
        """Where half-edges begin and where they end: (k,) int32 each."""
        vertex = self.triangles.reshape(-1)
        return vertex[halfedges], vertex[following(halfedges)]

    def triangles_of_edge(self, edge: int) -> Indices:
        """The triangles at an edge, ascending."""
        return self.edge_halfedges[self.edge_start[edge] : self.edge_start[edge + 1]] // 3

    def triangles_of_vertex(self, vertex: int) -> Indices:
        """The triangles at a vertex, ascending."""
        return self.vertex_corners[self.vertex_start[vertex] : self.vertex_start[vertex + 1]] // 3


def adjacency(mesh: Mesh) -> Adjacency:
    """Find which triangles, edges and vertices of a mesh touch.

    Positions are not looked at: two vertices in one place are two (`limner.repair` welds them).

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    Adjacency

    Notes
    -----
    Time is that of two sorts of all half-edges; a million triangles take a fifth of a second.

    >>> from limner.mesh.shapes.primitives import box
    >>> found = adjacency(box())
    >>> len(found.edges), found.triangles_of_edge(0).tolist()
    (18, [2, 7])
    """
    return adjacency_of_triangles(mesh.triangles, len(mesh.positions))


def adjacency_of_triangles(triangles: ArrayLike, n_vertices: int) -> Adjacency:
    """Find which of bare triangles touch; see `adjacency`.

    Parameters
    ----------
    triangles : (m, 3) int
    n_vertices : int
    """
    corners = np.ascontiguousarray(np.asarray(triangles, dtype=np.int32).reshape(-1, 3))
    if corners.size and not 0 <= corners.min() <= corners.max() < n_vertices:
        raise SceneError(f"triangles must index into {n_vertices} vertices, got {corners.min()}..{corners.max()}")
    start, end = corners.reshape(-1), corners[:, (1, 2, 0)].reshape(-1)
    used = _sides_that_are(corners)
    if used is not None:
        start, end = start[used], end[used]
    bits = max((n_vertices - 1).bit_length(), 1)
    key = np.minimum(start, end).astype(np.int64)
    key <<= bits
    key |= np.maximum(start, end)
    key, order, first = grouped_order(key, 2 * bits)
    edges = np.empty((len(first), 2), dtype=np.int32)
    edges[:, 0], edges[:, 1] = key[first] >> bits, key[first] & ((1 << bits) - 1)
    edge_start = np.append(first, len(order)).astype(np.int32)
    halfedges = order if used is None else used[order]
    triangle_edges = np.full(corners.size, -1, dtype=np.int32)
    triangle_edges[halfedges] = np.repeat(np.arange(len(edges), dtype=np.int32), np.diff(edge_start))
    opposite = _paired(halfedges, edge_start, corners.size)
    _, at_vertex, _ = grouped_order(start.astype(np.int64), bits)
    vertex_start = np.zeros(n_vertices + 1, dtype=np.int32)
    np.cumsum(np.bincount(start, minlength=n_vertices), out=vertex_start[1:])
    corners_at = at_vertex if used is None else used[at_vertex]
    # A view: the caller's own array stays as it was.
    made = (corners.view(), edges, triangle_edges.reshape(-1, 3), edge_start, halfedges, opposite, vertex_start, corners_at)
    for array in made:
        array.flags.writeable = False
    return Adjacency(n_vertices, *made)


def _sides_that_are(corners: Indices) -> Indices | None:
    """The half-edges of triangles that have not collapsed; None: all."""
    a, b, c = corners.T
    collapsed = (a == b) | (b == c) | (c == a)
    return np.flatnonzero(np.repeat(~collapsed, 3)).astype(np.int32) if collapsed.any() else None


def grouped_order(key: NDArray[np.int64], key_bits: int) -> tuple[NDArray[np.int64], Indices, NDArray[np.int64]]:
    """Sort keys and tell what was where.

    Parameters
    ----------
    key : (k,) int64, 0 <= key < 2**key_bits

    Returns
    -------
    key : (k,) int64
        Sorted.
    order : (k,) int32
        Where each was; ascending where keys are equal.
    first : (g,) int64
        Where each distinct key begins.
    """
    number_bits = len(key).bit_length()
    if key_bits + number_bits <= _KEY_BITS:
        packed = key << number_bits
        packed |= np.arange(len(key))
        packed.sort()
        order = (packed & ((1 << number_bits) - 1)).astype(np.int32)
        key = packed >> number_bits
    else:
        order = np.argsort(key, kind="stable").astype(np.int32)
        key = key[order]
    is_first = np.ones(len(key), dtype=bool)
    np.not_equal(key[1:], key[:-1], out=is_first[1:])
    return key, order, np.flatnonzero(is_first)


def _paired(halfedges: Indices, edge_start: Indices, n_halfedges: int) -> Indices:
    opposite = np.full(n_halfedges, -1, dtype=np.int32)
    pair = edge_start[:-1][np.diff(edge_start) == 2]
    one, other = halfedges[pair], halfedges[pair + 1]
    opposite[one], opposite[other] = other, one
    return opposite
