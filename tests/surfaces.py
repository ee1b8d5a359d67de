"""Small surfaces whose topology is known."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limner.mesh.adjacency import adjacency
from limner.mesh.mesh import Mesh
from limner.mesh.polygons import mesh_from_polygons

__all__ = [
    "bow_tie", "brute_edges", "fin", "heap", "klein_bottle", "large_torus", "moebius_strip", "open_cylinder", "plate", "platonic_solids",
    "shuffled", "split_apart", "voxels", "with_all_attributes",
]  # fmt: skip

GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0


def platonic_solids() -> dict[str, Mesh]:
    """All five, with unit-ish edges, facing outwards."""
    tetrahedron = Mesh([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], name="tetrahedron")
    axes = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    octants = [(x, y, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    octahedron = Mesh(axes, [f if sum(f) % 2 == 0 else f[::-1] for f in octants], name="octahedron")
    g = GOLDEN
    corners = [p for a in (-1, 1) for b in (-g, g) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    sides = np.linalg.norm(np.array(corners)[:, None] - np.array(corners)[None], axis=2)
    near = np.abs(sides - 2.0) < 1e-9
    triples = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]]
    outward = [t if np.linalg.det(np.array(corners)[list(t)]) > 0 else t[::-1] for t in triples]
    icosahedron = Mesh(corners, outward, name="icosahedron")
    cube = mesh_from_polygons([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], _CUBE, "cube")
    return {m.name: m for m in (tetrahedron, cube, octahedron, _dual(icosahedron, "dodecahedron"), icosahedron)}


_CUBE = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def _dual(mesh: Mesh, name: str) -> Mesh:
    """A polygon for each vertex, through the middles of the triangles around it."""
    middles = mesh.positions[mesh.triangles].astype(np.float64).mean(axis=1)
    around, polygons = adjacency(mesh).next_around, []
    for vertex in range(len(mesh.positions)):
        begin = int(np.flatnonzero(mesh.triangles.reshape(-1) == vertex)[0])
        ring, halfedge = [begin // 3], int(around[begin])
        while halfedge != begin:
            ring.append(halfedge // 3)
            halfedge = int(around[halfedge])
        polygons.append(ring)
    return mesh_from_polygons(middles, polygons, name)


def moebius_strip(n: int = 9) -> Mesh:
    """A band of n quadrilaterals with a half-turn in it."""
    turn = 2.0 * np.pi * np.arange(n) / n
    side = np.stack([np.cos(turn / 2) * np.cos(turn), np.cos(turn / 2) * np.sin(turn), np.sin(turn / 2)], axis=1)
    middle = np.stack([2 * np.cos(turn), 2 * np.sin(turn), 0 * turn], axis=1)
    low, high = np.arange(n), n + np.arange(n)
    next_low, next_high = np.append(low[1:], high[0]), np.append(high[1:], low[0])
    triangles = np.concatenate([np.stack([low, next_low, next_high], axis=1), np.stack([low, next_high, high], axis=1)])
    return Mesh(np.concatenate([middle - side, middle + side]), triangles, name="Moebius strip")


def klein_bottle(n: int = 8, m: int = 6) -> Mesh:
    """A torus whose tube comes back mirrored; the positions are those of the torus, the triangles are not."""
    return _sewn(n, m, mirrored=True, name="Klein bottle")


def _sewn(n: int, m: int, *, mirrored: bool, name: str) -> Mesh:
    i, j = (index.reshape(-1) for index in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))

    def vertex(i: Any, j: Any) -> Any:
        back = -j if mirrored else j
        return (i % n) * m + np.where(i < n, j, back) % m

    a, b, c, d = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    points = np.stack([(2 + np.cos(v)) * np.cos(u), np.sin(v), -(2 + np.cos(v)) * np.sin(u)], axis=1)
    return Mesh(points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]), name=name)


def large_torus(n: int, m: int) -> Mesh:
    """A torus of 2 n m triangles, whose vertices and triangles stand in no order."""
    mesh = _sewn(n, m, mirrored=False, name="torus")
    rng = np.random.default_rng(1)
    order = rng.permutation(len(mesh.positions))
    place = np.empty(len(order), dtype=np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    return Mesh(mesh.positions[order], place[mesh.triangles][rng.permutation(len(mesh.triangles))])


def open_cylinder(n: int = 7) -> Mesh:
    """A tube without lids."""
    turn = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(turn), 0 * turn, -np.sin(turn)], axis=1)
    a, b = np.arange(n), (np.arange(n) + 1) % n
    triangles = np.concatenate([np.stack([a, b, n + b], axis=1), np.stack([a, n + b, n + a], axis=1)])
    return Mesh(np.concatenate([ring, ring + np.array([0, 1, 0])]), triangles, name="cylinder")


def voxels(*filled: tuple[int, int, int]) -> Mesh:
    """The surface of unit cubes at integer places: as many cubes as its volume says."""
    solid, quads = set(filled), []
    for cell in filled:
        for axis in range(3):
            for step in (-1, 1):
                beside = tuple(cell[k] + (step if k == axis else 0) for k in range(3))
                if beside in solid:
                    continue
                u, v = np.roll(np.eye(3, dtype=int), -axis, axis=0)[1:][::step]
                corner = np.array(cell) + np.eye(3, dtype=int)[axis] * max(step, 0)
                quads.append([corner, corner + u, corner + u + v, corner + v])
    points, index = np.unique(np.array(quads).reshape(-1, 3), axis=0, return_inverse=True)
    return mesh_from_polygons(points, index.reshape(-1, 4), "voxels")


def plate(holes: int) -> Mesh:
    """A plate with square holes in a row: as many handles."""
    return voxels(*((x, y, 0) for x in range(2 * holes + 1) for y in range(3) if not (y == 1 and x % 2)))


def bow_tie() -> Mesh:
    """Two triangles that meet in vertex 2."""
    return Mesh([[0, 0, 0], [0, 1, 0], [1, 0.5, 0], [2, 1, 0], [2, 0, 0]], [[0, 2, 1], [2, 4, 3]], name="bow-tie")


def fin() -> Mesh:
    """Three triangles at the edge 0-1."""
    return Mesh([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]], name="fin")


def heap(rng: np.random.Generator, n_vertices: int, n_triangles: int, scale: int = 3) -> Mesh:
    """Triangles of whatever kind: collapsed, degenerate, twice, back to back, at the same edge; vertices in one place or unused."""
    points = rng.integers(0, scale, (n_vertices, 3))
    return Mesh(points, rng.integers(0, n_vertices, (n_triangles, 3)), name="heap")


def split_apart(mesh: Mesh) -> Mesh:
    """The same triangles without a common vertex."""
    return Mesh(mesh.positions[mesh.triangles].reshape(-1, 3), np.arange(mesh.triangles.size).reshape(-1, 3), name=mesh.name)


def shuffled(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    """The same surface with half of its triangles turned over, each begun anywhere."""
    triangles = np.stack([np.roll(row, rng.integers(3)) for row in mesh.triangles])
    over = rng.random(len(triangles)) < 0.5
    triangles[over] = triangles[over][:, ::-1]
    return Mesh(mesh.positions, triangles, name=mesh.name)


def with_all_attributes(mesh: Mesh) -> Mesh:
    """The same mesh, and on it values that tell where they belong: affine in the position, or the number of the triangle."""
    points = mesh.positions
    uvs = points[:, :2] + 2.0 * points[:, 2:]
    faces = np.arange(len(mesh.triangles), dtype=np.int32)
    ends = points[adjacency(mesh).edges]
    return Mesh(
        points, mesh.triangles, uvs=uvs, uvs1=-uvs, colors=np.abs(points), triangle_materials=faces, name=mesh.name,
        scalars={"x": points[:, 0]}, vertex_attributes={"place": points.astype(np.float64)}, face_attributes={"number": faces},
        edge_attributes={"middle": ends.mean(axis=1), "known": np.ones(len(ends), dtype=bool)},
    )  # fmt: skip


def brute_edges(triangles: NDArray[Any]) -> dict[tuple[int, int], list[int]]:
    """Half-edges by the ends of their edge, found one by one."""
    found: dict[tuple[int, int], list[int]] = {}
    for number, corners in enumerate(triangles.tolist()):
        if len(set(corners)) == 3:
            for k in range(3):
                ends = sorted((corners[k], corners[(k + 1) % 3]))
                found.setdefault((ends[0], ends[1]), []).append(3 * number + k)
    return dict(sorted(found.items()))
