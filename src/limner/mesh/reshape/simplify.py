"""Fewer triangles for nearly the same surface: edges are collapsed, the one that moves the surface least first.

The work is done by the library fast-simplification, which is imported when it is needed. It tells which vertices it has joined, from which
what belongs to vertices and to faces is found again.

**Source**: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997; the library's threshold, which is
raised until enough edges have gone, is Forstmann's.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, UnsupportedError
from ..mesh import Mesh
from ..normals import crease_normals
from ..sizes import check_count

__all__ = ["simplify"]

Indices = NDArray[np.int64]


def simplify(
    mesh: Mesh,
    triangles: int | None = None,
    *,
    share: float | None = None,
    aggressiveness: float = 7.0,
    keep_border: bool = False,
    crease_degrees: float = 40.0,
) -> Mesh:
    """Simplify a mesh to about a number of triangles.

    Parameters
    ----------
    mesh : Mesh
    triangles : int >= 0, or share : float in [0, 1]
        How many to leave, or which part of them: one of both must be given. A mesh that has fewer is returned as it is; where more edges
        cannot go without folding the surface, more are left.
    aggressiveness : float in [0, 10]
        Low: slower and truer, and perhaps not down to the number; high: faster.
    keep_border : bool
        Vertices on borders stay.
    crease_degrees : float in [0, 180]
        Normals are made anew, smooth but where faces differ by more; a mesh without normals gets none.

    Returns
    -------
    Mesh
        Colours, scalars and attributes of vertices are means over the vertices that became one; a triangle keeps its material and its
        attributes. Texture coordinates, tangents and attributes of edges are dropped.

    Raises UnsupportedError where the library is not installed.

    **Source**: see the module.
    """
    target = _target(mesh, triangles, share)
    if not 0.0 <= aggressiveness <= 10.0:
        raise SceneError(f"simplify.aggressiveness must lie in [0, 10], got {aggressiveness}")
    if target >= len(mesh.triangles):
        return mesh
    points, corners, vertex_of = _collapsed(mesh, target, aggressiveness, keep_border)
    corners, source = _survivors(mesh.triangles, vertex_of, corners)
    normals, normal_corners = crease_normals(points, corners, crease_degrees) if mesh.normals is not None else (None, None)
    return Mesh(
        positions=points.astype(np.float32),
        triangles=corners.astype(np.int32),
        normals=normals,
        normal_triangles=normal_corners,
        colors=None if mesh.colors is None else _means(mesh.colors, vertex_of, len(points)),
        triangle_materials=None if mesh.triangle_materials is None else mesh.triangle_materials[source],
        scalars=_all_means(mesh.scalars, vertex_of, len(points)),
        vertex_attributes=_all_means(mesh.vertex_attributes, vertex_of, len(points)),
        face_attributes={name: given[source] for name, given in (mesh.face_attributes or {}).items()} or None,
        name=mesh.name,
    )


def _target(mesh: Mesh, triangles: int | None, share: float | None) -> int:
    if (triangles is None) == (share is None):
        raise SceneError("simplify takes either a number of triangles or a share, one of both")
    if triangles is not None:
        return check_count(triangles, 0, "simplify.triangles")
    assert share is not None
    if not 0.0 <= share <= 1.0:
        raise SceneError(f"simplify.share must lie in [0, 1], got {share}")
    return int(share * len(mesh.triangles))


def _library() -> Any:
    try:
        return importlib.import_module("fast_simplification")
    except ImportError:
        raise UnsupportedError('simplify needs the library fast-simplification: pip install "limner[mesh]"') from None


def _collapsed(mesh: Mesh, target: int, aggressiveness: float, keep_border: bool) -> tuple[NDArray[np.float64], Indices, Indices]:
    """Positions (k, 3), triangles (m, 3), and what each of the old vertices has become (n,)."""
    library = _library()
    points, corners = mesh.positions.astype(np.float64), mesh.triangles.astype(np.int32)
    _, _, collapses = library.simplify(
        points, corners, target_count=target, agg=aggressiveness, return_collapses=True, preserve_border=keep_border
    )
    made, faces, vertex_of = library.replay_simplification(points, corners, collapses)
    return np.asarray(made, dtype=np.float64), np.asarray(faces, dtype=np.int64).reshape(-1, 3), np.asarray(vertex_of, dtype=np.int64)


def _survivors(triangles: NDArray[np.int32], vertex_of: Indices, corners: Indices) -> tuple[Indices, Indices]:
    """The triangles that are left, and which of the old ones each is."""
    became = vertex_of[triangles]
    whole = np.flatnonzero((became != np.roll(became, 1, axis=1)).all(axis=1))
    rows = np.concatenate([_turned(became[whole]), _turned(corners)])
    _, number = np.unique(rows, axis=0, return_inverse=True)
    old, new = number.reshape(-1)[: len(whole)], number.reshape(-1)[len(whole) :]
    source = np.full(len(rows), -1, dtype=np.int64)
    source[old] = whole
    known = source[new] >= 0
    return corners[known], source[new[known]]


def _turned(corners: Indices) -> Indices:
    """Triangles that begin with their least corner, so that the same ones are equal."""
    first = np.argmin(corners, axis=1)[:, None]
    return np.take_along_axis(corners, (first + np.arange(3)) % 3, axis=1)


def _means(values: NDArray[Any], vertex_of: Indices, count: int) -> NDArray[Any]:
    flat = values.reshape(len(values), -1)
    sizes = np.maximum(np.bincount(vertex_of, minlength=count), 1)
    dtype = values.dtype if values.dtype.kind in "fc" else np.dtype(np.float32)
    columns = [np.bincount(vertex_of, weights=flat[:, k], minlength=count) / sizes for k in range(flat.shape[1])]
    return np.stack(columns, axis=1).reshape(count, *values.shape[1:]).astype(dtype)


def _all_means(given: Mapping[str, NDArray[Any]] | None, vertex_of: Indices, count: int) -> dict[str, NDArray[Any]] | None:
    return {name: _means(values, vertex_of, count) for name, values in (given or {}).items()} or None
