"""A mesh that is being changed: its triangles, and where everything that lives on them comes from.

While a mesh is repaired, its corners keep naming their normals and texture coordinates, and each vertex and triangle remembers which of
the given ones it was. What lives on vertices, edges and triangles is looked up once, at the end.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..adjacency import Adjacency, adjacency_of_triangles
from ..mesh import Mesh

__all__ = ["Draft"]

Floats = NDArray[np.float32]
Indices = NDArray[np.int32]
Flags = NDArray[np.bool_]


class Draft:
    """A mesh taken apart.

    Attributes
    ----------
    given : Mesh
        What it was made of.
    positions : (n, 3) float32
    vertex_source : (n,) int32
        The given vertex that each was.
    triangles : (m, 3) int32
    triangle_source : (m,) int32
        The given triangle that each was, or takes after.
    normal_corners, uv_corners : (m, 3) int32 or None
        Rows of `normals` (and `tangents`) and of `uvs` (and `uvs1`) at the corners.
    merged : (n,) int32
        For each given vertex the one that stands for it.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.given = mesh
        self._found: Adjacency | None = None
        self.positions = mesh.positions
        self.vertex_source = np.arange(len(mesh.positions), dtype=np.int32)
        self.merged = self.vertex_source.copy()
        self.triangles = mesh.triangles.copy()
        self.triangle_source = np.arange(len(mesh.triangles), dtype=np.int32)
        self.normals, self.tangents, self.uvs, self.uvs1 = mesh.normals, mesh.tangents, mesh.uvs, mesh.uvs1
        self.normal_corners = _corners(mesh.normals, mesh.normal_triangles, mesh.triangles)
        self.uv_corners = _corners(mesh.uvs, mesh.uv_triangles, mesh.triangles)

    def adjacency(self) -> Adjacency:
        """What touches what now."""
        if self._found is None or self._found.triangles.base is not self.triangles:
            self._found = adjacency_of_triangles(self.triangles, len(self.positions))
        return self._found

    def bare(self) -> Mesh:
        """Positions and triangles alone."""
        return Mesh(self.positions, self.triangles, name=self.given.name)

    def merge(self, root: Indices) -> None:
        """Let other vertices stand for vertices: ``root[i]`` for vertex i."""
        self.triangles = root[self.triangles]
        self.merged = root[self.merged]

    def keep(self, kept: Flags) -> None:
        """Drop all other triangles."""
        self.triangles, self.triangle_source = self.triangles[kept], self.triangle_source[kept]
        if self.normal_corners is not None:
            self.normal_corners = self.normal_corners[kept]
        if self.uv_corners is not None:
            self.uv_corners = self.uv_corners[kept]

    def add(self, corners: NDArray[np.int64], source: Indices) -> None:
        """Add triangles.

        Parameters
        ----------
        corners : (k, 3, 3) int64
            At each corner the vertex, the row of its normal and the row of its texture coordinate; -1: there are none.
        source : (k,) int32
            The triangle now in the draft that each takes after.
        """
        self.triangle_source = np.concatenate([self.triangle_source, self.triangle_source[source]])
        self.triangles = np.concatenate([self.triangles, corners[:, :, 0].astype(np.int32)])
        if self.normal_corners is not None:
            self.normal_corners = np.concatenate([self.normal_corners, corners[:, :, 1].astype(np.int32)])
        if self.uv_corners is not None:
            self.uv_corners = np.concatenate([self.uv_corners, corners[:, :, 2].astype(np.int32)])

    def corner(self, halfedges: NDArray[Any]) -> NDArray[np.int64]:
        """(k, 3): vertex, row of the normal, row of the texture coordinate where half-edges begin."""
        found = np.full((len(halfedges), 3), -1, dtype=np.int64)
        found[:, 0] = self.triangles.reshape(-1)[halfedges]
        if self.normal_corners is not None:
            found[:, 1] = self.normal_corners.reshape(-1)[halfedges]
        if self.uv_corners is not None:
            found[:, 2] = self.uv_corners.reshape(-1)[halfedges]
        return found

    def between(
        self, one: NDArray[np.int64], other: NDArray[np.int64], t: NDArray[np.float64], vertex: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """Make corners (k, 3) at given vertices that lie a part t of the way from one corner to the other."""
        made = np.full((len(one), 3), -1, dtype=np.int64)
        made[:, 0] = vertex
        if self.normals is not None:
            a, b = one[:, 1], other[:, 1]
            normals = _unit(_mixed(self.normals, a, b, t), self.normals[a])
            tangents = None
            if self.tangents is not None:
                along = _unit(_mixed(self.tangents[:, :3], a, b, t), self.tangents[a, :3])
                tangents = np.concatenate([along, self.tangents[a, 3:]], axis=1)
            made[:, 1] = self.add_normals(normals, tangents)
        if self.uvs is not None:
            a, b = one[:, 2], other[:, 2]
            made[:, 2] = len(self.uvs) + np.arange(len(one))
            if self.uvs1 is not None:
                self.uvs1 = np.concatenate([self.uvs1, _mixed(self.uvs1, a, b, t)])
            self.uvs = np.concatenate([self.uvs, _mixed(self.uvs, a, b, t)])
        return made

    def add_normals(self, normals: Floats, tangents: Floats | None) -> NDArray[np.int64]:
        """Add rows, and return their numbers."""
        assert self.normals is not None
        rows = len(self.normals) + np.arange(len(normals))
        self.normals = np.concatenate([self.normals, normals.astype(np.float32)])
        if self.tangents is not None:
            assert tangents is not None
            self.tangents = np.concatenate([self.tangents, tangents.astype(np.float32)])
        return rows

    def flip(self, flips: Flags) -> None:
        """Turn triangles over; normals that then point to their back are turned, too."""
        self.triangles = np.where(flips[:, None], self.triangles[:, (0, 2, 1)], self.triangles)
        if self.uv_corners is not None:
            self.uv_corners[flips] = self.uv_corners[flips][:, (0, 2, 1)]
        if self.normal_corners is None or self.normals is None:
            return
        self.normal_corners[flips] = self.normal_corners[flips][:, (0, 2, 1)]
        rows = self.normal_corners[flips]
        front = self.front(self.triangles[flips])
        behind = (self.normals[rows] * front[:, None]).sum(axis=2) < 0.0
        turned, place = np.unique(rows[behind], return_inverse=True)
        tangents = None if self.tangents is None else self.tangents[turned] * np.array([1, 1, 1, -1], dtype=np.float32)
        rows[behind] = self.add_normals(-self.normals[turned], tangents)[place]
        self.normal_corners[flips] = rows

    def front(self, triangles: NDArray[Any]) -> NDArray[np.float64]:
        """Unit normals (k, 3) of triangles; zero where they have no area."""
        a, b, c = (self.positions[triangles[:, k]].astype(np.float64) for k in range(3))
        normals = np.cross(b - a, c - a)
        return _unit(normals, np.zeros_like(normals))

    def divide(self, corner_vertices: Indices, source: Indices) -> None:
        """Name other vertices at the corners, (m, 3); `source` are the vertices that the added ones are copies of."""
        self.triangles = corner_vertices
        self.positions = np.concatenate([self.positions, self.positions[source]])
        self.vertex_source = np.concatenate([self.vertex_source, self.vertex_source[source]])

    def finished(self, *, drop_unused: bool) -> tuple[Mesh, int]:
        """The mesh, and how many vertices were dropped that no triangle ever used; those merged into others always go."""
        used = np.zeros(len(self.positions), dtype=bool)
        used[self.triangles.reshape(-1)] = True
        gone = np.zeros(len(self.positions), dtype=bool)
        gone[: len(self.merged)] = self.merged != np.arange(len(self.merged))
        kept = used if drop_unused else used | ~gone
        n_dropped = int(np.count_nonzero(~kept & ~gone))
        number = np.cumsum(kept, dtype=np.int32) - np.int32(1)
        triangles, source = number[self.triangles], self.vertex_source[kept]
        normals, tangents, normal_triangles = _compact(self.normals, self.tangents, self.normal_corners, triangles, len(source))
        uvs, uvs1, uv_triangles = _compact(self.uvs, self.uvs1, self.uv_corners, triangles, len(source))
        given = self.given
        mesh = Mesh(
            self.positions[kept], triangles, normals=normals, normal_triangles=normal_triangles, uvs=uvs, uv_triangles=uv_triangles,
            uvs1=uvs1, colors=None if given.colors is None else given.colors[source], tangents=tangents,
            triangle_materials=None if given.triangle_materials is None else given.triangle_materials[self.triangle_source],
            name=given.name, scalars=_rows(given.scalars, source), vertex_attributes=_rows(given.vertex_attributes, source),
            face_attributes=_rows(given.face_attributes, self.triangle_source),
            edge_attributes=self._edge_attributes(adjacency_of_triangles(triangles, len(source)), source),
        )  # fmt: skip
        return mesh, n_dropped

    def _edge_attributes(self, now: Adjacency, source: Indices) -> dict[str, NDArray[Any]] | None:
        """Look up the edges by the vertices that they joined."""
        if self.given.edge_attributes is None:
            return None
        before = adjacency_of_triangles(self.given.triangles, len(self.given.positions))
        n = len(self.given.positions)
        old, new = _edge_keys(self.merged[before.edges], n), _edge_keys(source[now.edges], n)
        keys, first = np.unique(old, return_index=True)
        at = np.minimum(np.searchsorted(keys, new), max(len(keys) - 1, 0))
        known = keys[at] == new if len(keys) else np.zeros(len(new), dtype=bool)
        return {name: _looked_up(values, first[at[known]], known) for name, values in self.given.edge_attributes.items()}


def _corners(values: Any, corners: Indices | None, triangles: Indices) -> Indices | None:
    if values is None:
        return None
    return (triangles if corners is None else corners).copy()


def _mixed(values: NDArray[Any], a: NDArray[np.int64], b: NDArray[np.int64], t: NDArray[np.float64]) -> Floats:
    return ((1.0 - t)[:, None] * values[a] + t[:, None] * values[b]).astype(np.float32)


def _unit(vectors: NDArray[Any], otherwise: NDArray[Any]) -> NDArray[Any]:
    length = np.sqrt((vectors * vectors).sum(axis=1, keepdims=True))
    return np.where(length > 0.0, vectors / np.where(length > 0.0, length, 1.0), otherwise)


def _compact(
    values: Floats | None, others: Floats | None, corners: Indices | None, triangles: Indices, n_vertices: int
) -> tuple[Floats | None, Floats | None, Indices | None]:
    """Keep the rows that corners use; name no corners where they are the triangles'."""
    if values is None or corners is None:
        return None, None, None
    if len(values) == n_vertices and np.array_equal(corners, triangles):
        return values, others, None
    used = np.zeros(len(values), dtype=bool)
    used[corners.reshape(-1)] = True
    number = np.cumsum(used, dtype=np.int32) - np.int32(1)
    corners = number[corners]
    values, others = values[used], None if others is None else others[used]
    return values, others, None if len(values) == n_vertices and np.array_equal(corners, triangles) else corners


def _rows(attributes: Mapping[str, NDArray[Any]] | None, rows: Indices) -> dict[str, NDArray[Any]] | None:
    return None if attributes is None else {name: values[rows] for name, values in attributes.items()}


def _edge_keys(ends: NDArray[Any], n: int) -> NDArray[np.int64]:
    return ends.min(axis=1).astype(np.int64) * n + ends.max(axis=1)


def _looked_up(values: NDArray[Any], rows: NDArray[np.int64], known: Flags) -> NDArray[Any]:
    """Rows where they are known; NaN, or 0 of what knows no NaN, elsewhere."""
    made = np.full((len(known), *values.shape[1:]), np.nan if values.dtype.kind in "fc" else 0, dtype=values.dtype)
    made[known] = values[rows]
    return made
