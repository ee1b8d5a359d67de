"""Writing PLY: one mesh of all that there is, or one cloud, in bytes, low ones first.

Positions and faces stay as they are. Normals and texture coordinates are written where each position has one of its own; texture
coordinates of corners go with the faces (``texcoord``, as MeshLab writes them), and normals of corners, which PLY has no place for, are
left to be found again from the surface. Colours are those of the vertices times that of the material, as sRGB bytes; single numbers
(`Mesh.scalars`, `Mesh.vertex_attributes`) are written by their names.

**Source**: Greg Turk, *The PLY Polygon File Format*, 1994.
"""

from __future__ import annotations

import re
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import bytes_from_linear, bytes_from_unit
from ..mesh.mesh import Mesh
from ..scene.color_by import named_numbers
from ..scene.material import Lambert
from ..scene.points import PointCloud
from .world_parts import Part, base_color, per_vertex

__all__ = ["write_ply"]

_AT_ONCE = 1 << 18


def write_ply(parts: list[Part], stream: IO[bytes]) -> None:
    """Write all parts as one."""
    columns = [_columns(part) for part in parts]
    named = _common(parts, columns)
    # Coordinates at corners are for all faces or for none.
    at_corners = any(
        isinstance(part.geometry, Mesh) and part.geometry.uvs is not None and "s" not in own
        for part, own in zip(parts, columns, strict=True)
    )
    if at_corners:
        named = {name: kind for name, kind in named.items() if name not in ("s", "t")}
    n_vertices = sum(len(part.geometry.positions) for part in parts)
    meshes = [part.geometry for part in parts if isinstance(part.geometry, Mesh)]
    n_faces = sum(len(mesh.triangles) for mesh in meshes)
    lines = ["ply", "format binary_little_endian 1.0", "comment limner", f"element vertex {n_vertices}"]
    lines += [f"property {'uchar' if kind == 'u1' else 'float'} {name}" for name, kind in named.items()]
    face: list[Any] = [("n", "u1"), ("corners", "<i4", 3)]
    if n_faces:
        lines += [f"element face {n_faces}", "property list uchar int vertex_indices"]
    if n_faces and at_corners:
        lines.append("property list uchar float texcoord")
        face += [("n_texcoord", "u1"), ("texcoord", "<f4", 6)]
    stream.write("\n".join([*lines, "end_header", ""]).encode("ascii"))
    dtype = np.dtype([(name, "u1" if kind == "u1" else "<f4") for name, kind in named.items()])
    for part, own in zip(parts, columns, strict=True):
        _write_vertices(len(part.geometry.positions), own, dtype, stream)
    first = 0
    for part in parts:
        if isinstance(part.geometry, Mesh):
            _write_faces(part.geometry, first, np.dtype(face), stream)
        first += len(part.geometry.positions)


def _columns(part: Part) -> dict[str, NDArray[Any]]:
    """What is known of each position, by the names of PLY."""
    geometry = part.geometry
    found: dict[str, NDArray[Any]] = dict(zip("xyz", geometry.positions.T, strict=True))
    normals = geometry.normals if isinstance(geometry, PointCloud) else None
    uvs = None
    if isinstance(geometry, Mesh):
        normals = per_vertex(geometry.normals, geometry.normal_triangles, geometry)
        uvs = per_vertex(geometry.uvs, geometry.uv_triangles, geometry)
    if normals is not None:
        found |= dict(zip(("nx", "ny", "nz"), normals.T, strict=True))
    if uvs is not None:
        found |= dict(zip("st", uvs.T, strict=True))
    for name, values in named_numbers(geometry).items():
        found.setdefault(re.sub(r"[^!-~]", "_", name) or "_", values)
    if isinstance(geometry, PointCloud) and geometry.radii is not None:
        found.setdefault("radius", geometry.point_radii)
    return found


def _common(parts: list[Part], columns: list[dict[str, NDArray[Any]]]) -> dict[str, str]:
    """The properties of all vertices, and their types; adds colours where some part has any."""
    plain = {base_color(material) for part in parts for material in part.materials}
    if any(part.geometry.colors is not None for part in parts) or len(plain) > 1 or plain - {base_color(Lambert())}:
        colors = [_colors(part) for part in parts]
        with_alpha = any(color.shape[1] == 4 for color in colors)
        for own, color in zip(columns, colors, strict=True):
            encoded = bytes_from_linear(np.ascontiguousarray(color[:, :3]))
            own |= dict(zip(("red", "green", "blue"), encoded.T, strict=True))
            if with_alpha:
                own["alpha"] = bytes_from_unit(color[:, 3]) if color.shape[1] == 4 else np.full(len(color), 255, dtype=np.uint8)
    names = list(dict.fromkeys(name for own in columns for name in own))
    # A normal or a coordinate that some vertices lack is no property; a number may be unknown.
    everywhere = {name for name in names if all(name in own for own in columns)}
    kept = [name for name in names if name in everywhere or name not in ("nx", "ny", "nz", "s", "t", "radius")]
    return {name: "u1" if name in ("red", "green", "blue", "alpha") else "f4" for name in kept}


def _colors(part: Part) -> NDArray[np.float32]:
    """(n, 3) or (n, 4) linear: colours of vertices times those of their materials."""
    geometry = part.geometry
    own = np.ones((len(geometry.positions), 3), dtype=np.float32) if geometry.colors is None else geometry.colors.copy()
    slots = geometry.triangle_materials if isinstance(geometry, Mesh) else None
    if slots is None or not isinstance(geometry, Mesh):
        own[:, :3] *= np.array(base_color(part.materials[0]), dtype=np.float32)
        return own
    factor = np.ones((len(own), 3), dtype=np.float32)
    for slot, material in enumerate(part.materials):
        factor[geometry.triangles[slots == slot].reshape(-1)] = base_color(material)
    own[:, :3] *= factor
    return own


def _write_vertices(count: int, own: dict[str, NDArray[Any]], dtype: np.dtype[Any], stream: IO[bytes]) -> None:
    for start in range(0, count, _AT_ONCE):
        rows = np.empty(min(_AT_ONCE, count - start), dtype=dtype)
        for name in dtype.names or ():
            rows[name] = own[name][start : start + _AT_ONCE] if name in own else np.nan
        stream.write(rows.tobytes())


def _write_faces(mesh: Mesh, first: int, dtype: np.dtype[Any], stream: IO[bytes]) -> None:
    for start in range(0, len(mesh.triangles), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        rows = np.zeros(len(mesh.triangles[part]), dtype=dtype)
        rows["n"], rows["corners"] = 3, mesh.triangles[part] + first
        if "texcoord" in (dtype.names or ()):
            rows["n_texcoord"] = 6
            if mesh.uvs is not None:
                corners = (mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles)[part]
                rows["texcoord"] = mesh.uvs[corners].reshape(-1, 6)
        stream.write(rows.tobytes())
