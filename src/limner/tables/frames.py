"""Tangents for meshes that are shown with a normal map and come without (glTF 2.0, 3.7.2.1: MikkTSpace)."""

from __future__ import annotations

from weakref import WeakKeyDictionary

from ..mesh.mesh import Mesh
from ..mesh.tangents import with_tangents
from ..scene.material import Material

__all__ = ["with_frames"]

_kept: WeakKeyDictionary[Mesh, dict[int, Mesh]] = WeakKeyDictionary()
"""What meshes turned into. They never change, and are shared by the pictures of a series."""


def with_frames(mesh: Mesh, materials: tuple[Material, ...]) -> Mesh:
    """The mesh with tangents, where its materials look at them, and it has what they follow from; else the very same.

    Of several normal maps on one mesh, the first says which set of texture coordinates counts.
    """
    if mesh.tangents is not None or mesh.normals is None or mesh.uvs is None:
        return mesh
    maps = [texture for material in materials if (texture := getattr(material, "normal_texture", None)) is not None]
    if not maps or (maps[0].uv_set == 1 and mesh.uvs1 is None):
        return mesh
    known = _kept.setdefault(mesh, {})
    uv_set = maps[0].uv_set
    if uv_set not in known:
        known[uv_set] = with_tangents(mesh, uv_set)
    return known[uv_set]
