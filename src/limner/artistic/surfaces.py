"""All triangles of a scene as one list in the world: where lines are looked for, and what hides them.

Corners in one place are one point, whatever their normals and texture coordinates, so that the topology is that of the surface; exact
shapes are there by the triangles that stand for them. All is float64 and object after object in the scene's order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linear.transform import normal_matrix
from ..mesh.adjacency import Adjacency, following
from ..mesh.components import component_labels
from ..mesh.mesh import Mesh
from ..mesh.normals import vertex_normals
from ..mesh.weld import welded
from ..scene.camera import Camera
from ..scene.node import Placed
from ..scene.scene import Scene
from ..scene.shape import Plane, Shape
from ..tables.relief import Reliefs
from ..tables.stand_ins import Sight, StandIns, inverse, tessellation

__all__ = ["Surfaces", "corner_normals", "smooth_groups", "surfaces_of"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Surfaces(NamedTuple):
    """The triangles of a scene.

    Attributes
    ----------
    points : (n, 3) float64
        World.
    triangles : (m, 3) int64
        Rows of `points`; counter-clockwise from outside.
    instance : (m,) int64
        Which shape of the scene each is of.
    material : (m,) int64
        Which of the shape's materials.
    uvs : (m, 3, 2) float32
        Texture coordinates at the corners; 0 where there are none.
    exact : (m,) bool
        Of a shape that its triangles only stand for; their normals are its own.
    bounded : (m,) bool
        False: of the disk that stands for an infinite plane, whose rim is nowhere.
    extent : float
        The diagonal of what is bounded, metres.
    shapes : tuple of (Mesh, (4, 4) float64)
        What the triangles were made of, in the order of `instance`.
    """

    points: Floats
    triangles: Indices
    instance: Indices
    material: Indices
    uvs: NDArray[np.float32]
    exact: NDArray[np.bool_]
    bounded: NDArray[np.bool_]
    extent: float
    shapes: tuple[tuple[Mesh, Floats], ...]


class _Part(NamedTuple):
    """Of one mesh: welded points, triangles by them, materials and texture coordinates of the triangles."""

    points: Floats
    triangles: Indices
    material: Indices
    uvs: NDArray[np.float32]


@np.errstate(over="ignore", invalid="ignore")  # what is too large to be a number is left out
def surfaces_of(scene: Scene, camera: Camera, width: int, height: int) -> Surfaces:
    """The triangles of all visible shapes of a scene.

    `camera`, `width` and `height` decide how finely exact shapes are divided: to a tenth of a pixel.
    """
    sight = Sight(camera, width, height, scene.bounds())
    stand_ins, reliefs = StandIns(), Reliefs()
    known: dict[int, _Part] = {}
    meshes: list[tuple[Mesh, Floats]] = []
    points, triangles, instance, material, uvs, exact, bounded = [], [], [], [], [], [], []
    n_points = 0
    for number, (placed, shape) in enumerate(scene.shapes()):
        mesh, matrix = _mesh_of(placed, shape, sight, stand_ins, reliefs), placed.world_from_object
        meshes.append((mesh, matrix))
        if id(mesh) not in known:
            known[id(mesh)] = _part(mesh)
        part = known[id(mesh)]
        where = part.points @ matrix[:3, :3].T + matrix[:3, 3]
        finite = np.asarray(np.isfinite(where).all(axis=1))
        whole = np.asarray(finite[part.triangles].all(axis=1))
        corners = part.triangles if np.linalg.det(matrix[:3, :3]) >= 0.0 else part.triangles[:, ::-1]
        points.append(where)
        triangles.append(corners[whole] + n_points)
        instance.append(np.full(int(whole.sum()), number))
        material.append(part.material[whole])
        uvs.append((part.uvs if corners is part.triangles else part.uvs[:, ::-1])[whole])
        exact.append(np.full(int(whole.sum()), not isinstance(shape.geometry, Mesh) and shape.displacement is None))
        bounded.append(np.full(int(whole.sum()), not isinstance(shape.geometry, Plane)))
        n_points += len(where)
    if not points:
        return Surfaces(
            np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64),
            np.zeros((0, 3, 2), dtype=np.float32), np.zeros(0, dtype=bool), np.zeros(0, dtype=bool), 0.0, (),
        )  # fmt: skip
    all_points, all_triangles, all_bounded = np.concatenate(points), np.concatenate(triangles), np.concatenate(bounded)
    return Surfaces(
        all_points, all_triangles, np.concatenate(instance), np.concatenate(material), np.concatenate(uvs), np.concatenate(exact),
        all_bounded,
        _extent(all_points, all_triangles[all_bounded]), tuple(meshes),
    )  # fmt: skip


def _mesh_of(placed: Placed, shape: Shape, sight: Sight, stand_ins: StandIns, reliefs: Reliefs) -> Mesh:
    matrix = placed.world_from_object
    mesh = tessellation(shape, matrix, sight, stand_ins)
    if shape.displacement is None:
        return mesh
    return reliefs.get(shape, mesh, matrix, inverse(matrix), sight, placed.path)


def _part(mesh: Mesh) -> _Part:
    index, first = welded(mesh.positions)
    triangles = index[mesh.triangles]
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    n = int(whole.sum())
    slots, uvs = np.zeros(n, dtype=np.int64), np.zeros((n, 3, 2), dtype=np.float32)
    if mesh.triangle_materials is not None:
        slots = mesh.triangle_materials[whole].astype(np.int64)
    if mesh.uvs is not None:
        uvs = mesh.uvs[(mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles)[whole]]
    return _Part(mesh.positions[first].astype(np.float64), triangles[whole], slots, uvs)


def _extent(points: Floats, triangles: Indices) -> float:
    if not len(triangles):
        return 1.0
    used = np.zeros(len(points), dtype=bool)
    used[triangles] = True
    held = points[used]
    return float(np.linalg.norm(held.max(axis=0) - held.min(axis=0)))


def corner_normals(surfaces: Surfaces, adjacency: Adjacency, sharp: NDArray[np.bool_]) -> Floats:
    """(m, 3, 3) float64: the normals of the smooth surface at the corners, unit, in the world; 0 where there is none.

    Those that a mesh came with; where it has none, those of the triangles round the corner, weighted by their angles, as far as one comes
    without crossing an edge that is `sharp`, (k,) of the adjacency's.
    """
    made = np.zeros((len(surfaces.triangles), 3, 3))
    first = np.searchsorted(surfaces.instance, np.arange(len(surfaces.shapes) + 1))
    groups: Indices | None = None
    for number, (mesh, matrix) in enumerate(surfaces.shapes):
        rows = slice(int(first[number]), int(first[number + 1]))
        triangles = surfaces.triangles[rows]
        kept = _kept(mesh, len(triangles))
        if mesh.normals is None or kept is None:
            groups = smooth_groups(adjacency, sharp) if groups is None else groups
            _, index, local = np.unique(groups[rows], return_index=True, return_inverse=True)
            local = local.reshape(-1, 3)
            made[rows] = _unit(np.asarray(vertex_normals(surfaces.points[triangles.reshape(-1)[index]], local), dtype=np.float64))[local]
            continue
        corners = (mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles)[kept]
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            corners = corners[:, ::-1]
        made[rows] = _unit(mesh.normals @ normal_matrix(matrix).T)[corners]
    return made


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0.0, length, 1.0))


def smooth_groups(adjacency: Adjacency, sharp: NDArray[np.bool_]) -> Indices:
    """(m, 3): numbers of corners, one for those in one place between which no sharp edge lies."""
    vertex = adjacency.triangles.reshape(-1).astype(np.int64)
    split = np.zeros(adjacency.n_vertices, dtype=bool)
    split[adjacency.edges[sharp]] = True
    picked = np.flatnonzero(split[vertex])
    number = np.full(len(vertex), -1, dtype=np.int64)
    number[picked] = np.arange(len(picked))
    edge = np.flatnonzero(~sharp & (adjacency.edge_counts == 2))
    start = adjacency.edge_start[edge]
    one, other = adjacency.edge_halfedges[start], adjacency.edge_halfedges[start + 1]
    # Of half-edges that run against each other the one begins where the other ends.
    alike = vertex[one] != vertex[other]
    after_one, after_other = following(one), following(other)
    a = np.concatenate([one, after_one])
    b = np.concatenate([np.where(alike, after_other, other), np.where(alike, other, after_other)])
    a, b = number[a], number[b]
    label = component_labels(len(picked), a[a >= 0], b[a >= 0])
    made = vertex.copy()
    made[picked] = adjacency.n_vertices + label
    return np.ascontiguousarray(made.reshape(-1, 3))


def _kept(mesh: Mesh, n_triangles: int) -> NDArray[np.bool_] | None:
    """(m,) bool: which triangles of a mesh became triangles of the surfaces; None where that can no longer be told."""
    corners = welded(mesh.positions)[0][mesh.triangles]
    a, b, c = corners.T
    whole = np.asarray((a != b) & (b != c) & (c != a))
    return whole if int(whole.sum()) == n_triangles else None
