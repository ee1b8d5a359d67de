"""Solids of solids, as triangles: the union, the intersection and the difference of closed meshes.

The work is done by the library manifold3d, which is imported when it is needed and whose results are closed whatever touches whatever.
What lives on the surfaces goes with them: normals, texture coordinates and colours are interpolated where triangles are cut, and every
triangle knows the mesh and the material that it comes from.

    exact shapes, rendered by rays        `limner.Union`, `limner.Intersection`, `limner.Difference`
    meshes                                here

**Source**: Lalish, *Manifold*, github.com/elalish/manifold; after Smith, *Towards robust inexact geometric computation*, University of
Cambridge 2009.
"""

from __future__ import annotations

import importlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, UnsupportedError
from ..mesh import Mesh
from ..normals import face_normals

__all__ = ["MATERIALS", "OPERATIONS", "boolean"]

OPERATIONS = ("union", "intersection", "difference")
MATERIALS = ("own", "operand")

Floats = NDArray[np.float32]
Indices = NDArray[np.int64]


class _Columns(NamedTuple):
    """What all operands carry besides positions and normals."""

    uvs: bool
    colors: bool


def boolean(operation: str, *meshes: Mesh, materials: str = "own") -> Mesh:
    """Combine closed meshes.

    Parameters
    ----------
    operation : "union", "intersection" or "difference"
        Of all; the difference is the first without the others.
    meshes : Mesh
        At least one; each closed, every edge the side of two triangles that are turned alike, their front outside. Where vertices lie in
        the same place and edges gape, they are welded.
    materials : "own" or "operand"
        A triangle has the material index that it had, or the number of the mesh that it comes from: the cut in another colour.

    Returns
    -------
    Mesh
        Closed; without triangles where nothing is left. Corner normals of the meshes (those of the faces where there are none), turned
        over where the front has become the back; texture coordinates where any mesh has them (0 elsewhere), colours likewise (white).
        Second texture coordinates, tangents and named attributes are dropped.

    Raises SceneError where a mesh is not closed, UnsupportedError where the library is not installed.
    """
    if operation not in OPERATIONS:
        raise SceneError(f"boolean.operation must be one of {', '.join(OPERATIONS)}, got {operation!r}")
    if materials not in MATERIALS:
        raise SceneError(f"boolean.materials must be one of {', '.join(MATERIALS)}, got {materials!r}")
    if not meshes:
        raise SceneError("boolean.meshes must be at least one mesh, got none")
    library = _library()
    columns = _Columns(any(mesh.uvs is not None for mesh in meshes), any(mesh.colors is not None for mesh in meshes))
    origins: dict[int, tuple[int, int]] = {}
    solids = [_solid(library, mesh, k, columns, origins) for k, mesh in enumerate(meshes)]
    kinds = {"union": library.OpType.Add, "intersection": library.OpType.Intersect, "difference": library.OpType.Subtract}
    made = library.Manifold.batch_boolean(solids, kinds[operation])
    if made.status() != library.Error.NoError:
        raise SceneError(f"boolean.{operation} of {len(meshes)} meshes failed: {made.status().name}")
    has_materials = materials == "operand" or any(mesh.triangle_materials is not None for mesh in meshes)
    return _mesh(made.to_mesh(), columns, origins, operation, materials if has_materials else None)


def _library() -> Any:
    try:
        return importlib.import_module("manifold3d")
    except ImportError:
        raise UnsupportedError('booleans of meshes need the library manifold3d: pip install "limner[mesh]"') from None


def _solid(library: Any, mesh: Mesh, k: int, columns: _Columns, origins: dict[int, tuple[int, int]]) -> Any:
    """A mesh as the library has it; `origins` learns which mesh and material each of its runs of triangles is."""
    if not len(mesh.triangles):
        return library.Manifold()
    slots = np.zeros(len(mesh.triangles), dtype=np.int32) if mesh.triangle_materials is None else mesh.triangle_materials
    order = np.argsort(slots, kind="stable")
    used, first = np.unique(slots[order], return_index=True)
    begin = int(library.Manifold.reserve_ids(len(used)))
    origins.update({begin + run: (k, int(slot)) for run, slot in enumerate(used)})
    properties, triangles, place = _corners(mesh, columns)
    # Corners in one place are one vertex: the first of them
    leader = np.full(len(mesh.positions), -1, dtype=np.int64)
    leader[place[::-1]] = np.arange(len(place))[::-1]
    follows = np.flatnonzero(leader[place] != np.arange(len(place)))
    given = library.Mesh(
        vert_properties=properties,
        tri_verts=np.ascontiguousarray(triangles[order], dtype=np.uint32),
        merge_from_vert=follows.astype(np.uint32),
        merge_to_vert=leader[place[follows]].astype(np.uint32),
        run_index=np.append(3 * first, 3 * len(order)).astype(np.uint32),
        run_original_id=np.arange(begin, begin + len(used), dtype=np.uint32),
    )
    solid = library.Manifold(given)
    if solid.status() == library.Error.NotManifold and given.merge():
        solid = library.Manifold(given)
    if solid.status() != library.Error.NoError:
        what = "closed, with triangles that are turned alike" if solid.status() == library.Error.NotManifold else "a solid"
        raise SceneError(f"boolean.meshes[{k}] must be {what}; the library says {solid.status().name}", mesh.name)
    if solid.volume() < 0.0:
        raise SceneError(f"boolean.meshes[{k}] must be turned with its front outside, its volume is {solid.volume():.6g}", mesh.name)
    return solid


def _corners(mesh: Mesh, columns: _Columns) -> tuple[Floats, Indices, Indices]:
    """The distinct corners of a mesh: their columns (n, c), the triangles by them (m, 3), and their positions' numbers (n,)."""
    flat = mesh.normals is None
    per_triangle = np.repeat(np.arange(len(mesh.triangles)), 3).reshape(-1, 3)
    normals = face_normals(mesh.positions, mesh.triangles).astype(np.float32) if mesh.normals is None else mesh.normals
    normal_corners = per_triangle if flat else mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles
    uv_corners = mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles
    keys = np.stack([mesh.triangles, normal_corners, uv_corners], axis=-1).reshape(-1, 3)
    distinct, corner = np.unique(keys, axis=0, return_inverse=True)
    parts = [mesh.positions[distinct[:, 0]], normals[distinct[:, 1]]]
    if columns.uvs:
        parts.append(np.zeros((len(distinct), 2), dtype=np.float32) if mesh.uvs is None else mesh.uvs[distinct[:, 2]])
    if columns.colors:
        colors = np.ones((len(distinct), 4), dtype=np.float32)
        if mesh.colors is not None:
            colors[:, : mesh.colors.shape[1]] = mesh.colors[distinct[:, 0]]
        parts.append(colors)
    return np.ascontiguousarray(np.concatenate(parts, axis=1), dtype=np.float32), corner.reshape(-1, 3), distinct[:, 0].astype(np.int64)


def _mesh(made: Any, columns: _Columns, origins: dict[int, tuple[int, int]], operation: str, materials: str | None) -> Mesh:
    """The library's result as a mesh over shared positions."""
    properties = np.asarray(made.vert_properties, dtype=np.float32)
    if not len(properties):
        return Mesh(np.zeros((0, 3), dtype=np.float32), np.zeros((0, 3), dtype=np.int32), name=operation)
    corners = np.asarray(made.tri_verts, dtype=np.int64).reshape(-1, 3)
    leader = np.arange(len(properties))
    leader[np.asarray(made.merge_from_vert, dtype=np.int64)] = np.asarray(made.merge_to_vert, dtype=np.int64)
    places, place = np.unique(leader, return_inverse=True)
    bounds = np.asarray(made.run_index, dtype=np.int64) // 3
    runs = bounds[1:] - bounds[:-1]
    sources = np.array([origins[int(run)] for run in made.run_original_id], dtype=np.int64).reshape(-1, 2)
    source = np.repeat(sources, runs, axis=0)
    normals = properties[:, 3:6].astype(np.float64)
    if operation == "difference":
        # What is left of a solid that was taken away shows its back
        normals[np.unique(corners[source[:, 0] > 0])] *= -1.0
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), (0.0, 0.0, 1.0))
    at = 6 + 2 * int(columns.uvs)
    triangles = place.reshape(-1)[corners].astype(np.int32)
    return Mesh(
        positions=properties[places, :3],
        triangles=triangles,
        normals=normals.astype(np.float32),
        normal_triangles=corners.astype(np.int32),
        uvs=properties[:, 6:8] if columns.uvs else None,
        uv_triangles=corners.astype(np.int32) if columns.uvs else None,
        colors=properties[places, at : at + 4] if columns.colors else None,
        triangle_materials=None if materials is None else source[:, 0 if materials == "operand" else 1].astype(np.int32),
        name=operation,
    )
