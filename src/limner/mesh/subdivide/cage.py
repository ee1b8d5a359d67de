"""What is subdivided besides positions: colours and other numbers of vertices, textures with their seams, materials.

What belongs to vertices is a row of columns (position, colour, attributes) that all get the weights of the positions: a number that was
a linear function of the place stays one. Texture coordinates have a topology of their own, which ends at seams; there they are divided
linearly, so that both sides of a seam stay as they were cut. What belongs to a face is handed on to its parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..sizes import check_count, check_triangles

__all__ = ["UV_RULES", "Cage", "cage_of", "check_levels"]

UV_RULES = ("smooth", "linear")
_VERTEX_FIELDS = ("scalars", "vertex_attributes")

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cage:
    """The columns of a mesh.

    Attributes
    ----------
    mesh : Mesh
        What they are from.
    values : (n, c) float64
        Positions, colours, attributes of vertices.
    uv_triangles : (m, 3) int32, or None
    uv_values : (k, 2 or 4) float64
        Both sets of texture coordinates.
    """

    mesh: Mesh
    values: Values
    uv_triangles: NDArray[np.int32] | None
    uv_values: Values

    def mesh_of(
        self,
        values: Values,
        triangles: NDArray[np.integer],
        normals: tuple[NDArray[np.floating], NDArray[np.integer] | None],
        uvs: tuple[Values, NDArray[np.integer]] | None,
        parent: NDArray[np.integer],
    ) -> Mesh:
        """Put a mesh together; `parent` (m,): the triangle of the cage that each of its triangles is a part of."""
        source = self.mesh
        n_colors = 0 if source.colors is None else source.colors.shape[1]
        more: dict[str, Any] = {}
        at = 3 + n_colors
        for field in _VERTEX_FIELDS:
            made = {}
            for name, given in (getattr(source, field) or {}).items():
                columns = values[:, at : at + _columns(given).shape[1]]
                at += columns.shape[1]
                made[name] = _restored(columns, given)
            more[field] = made or None
        if source.face_attributes:
            more["face_attributes"] = {name: given[parent] for name, given in source.face_attributes.items()}
        if uvs is not None:
            more |= {"uvs": uvs[0][:, :2].astype(np.float32), "uv_triangles": uvs[1].astype(np.int32)}
            more["uvs1"] = uvs[0][:, 2:].astype(np.float32) if source.uvs1 is not None else None
        return Mesh(
            positions=values[:, :3].astype(np.float32),
            triangles=triangles.astype(np.int32),
            normals=normals[0].astype(np.float32),
            normal_triangles=None if normals[1] is None else normals[1].astype(np.int32),
            colors=values[:, 3 : 3 + n_colors].astype(np.float32) if n_colors else None,
            triangle_materials=None if source.triangle_materials is None else source.triangle_materials[parent],
            name=source.name,
            **more,
        )


def cage_of(mesh: Mesh, name: str) -> Cage:
    """Take the columns of a mesh apart."""
    if not len(mesh.triangles):
        raise SceneError(f"{name}.mesh must have triangles, got none", mesh.name)
    columns = [mesh.positions.astype(np.float64)]
    if mesh.colors is not None:
        columns.append(mesh.colors.astype(np.float64))
    columns += [_columns(given) for field in _VERTEX_FIELDS for given in (getattr(mesh, field) or {}).values()]
    if mesh.uvs is None:
        return Cage(mesh, np.concatenate(columns, axis=1), None, np.zeros((0, 2)))
    uvs = [mesh.uvs] if mesh.uvs1 is None else [mesh.uvs, mesh.uvs1]
    corners = mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles
    return Cage(mesh, np.concatenate(columns, axis=1), corners, np.concatenate(uvs, axis=1).astype(np.float64))


def _columns(given: NDArray[Any]) -> Values:
    """Numbers of vertices, of any kind and shape, as (n, c)."""
    flat = given.reshape(len(given), -1)
    return np.ascontiguousarray(flat, dtype=np.complex128).view(np.float64) if given.dtype.kind == "c" else flat.astype(np.float64)


def _restored(columns: Values, given: NDArray[Any]) -> NDArray[Any]:
    """(n, c) as numbers of the shape and kind that are given; whole numbers and truths have become fractions."""
    if given.dtype.kind == "c":
        columns = np.ascontiguousarray(columns).view(np.complex128)
    dtype = given.dtype if given.dtype.kind in "fc" else np.float32
    return columns.reshape(len(columns), *given.shape[1:]).astype(dtype)


def check_levels(levels: int, triangles: int, growth: int, name: str, uv_rule: str) -> int:
    """Return the number of steps; raise SceneError where it is none, or the result would be huge."""
    levels = check_count(levels, 0, f"{name}.levels")
    check_triangles(triangles * growth ** min(levels, 64), f"{name}.levels = {levels} of {triangles} triangles")
    if uv_rule not in UV_RULES:
        raise SceneError(f"{name}.uv_rule must be one of {', '.join(UV_RULES)}, got {uv_rule!r}")
    return levels
