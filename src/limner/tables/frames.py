"""Tangents for meshes that are shown with a normal map and come without (glTF 2.0, 3.7.2.1: MikkTSpace)."""

from __future__ import annotations

import dataclasses
from weakref import WeakKeyDictionary

import numpy as np

from ..mesh.mesh import Mesh
from ..mesh.tangents import corner_tangents, with_tangents
from ..scene.material import Material

__all__ = ["framed_alike", "with_frames"]

_kept: WeakKeyDictionary[Mesh, dict[int, Mesh]] = WeakKeyDictionary()
"""What meshes turned into. They never change, and are shared by the pictures of a series."""


def with_frames(mesh: Mesh, materials: tuple[Material, ...]) -> Mesh:
    """The mesh with tangents, where its materials look at them, and it has what they follow from; else the very same.

    Of several normal maps on one mesh, the first says which set of texture coordinates counts.
    """
    if mesh.tangents is not None or mesh.normals is None or mesh.uvs is None:
        return mesh
    sets = [uv_set for material in materials for uv_set in _sets_asked_for(material)]
    if not sets or (sets[0] == 1 and mesh.uvs1 is None):
        return mesh
    known = _kept.setdefault(mesh, {})
    uv_set = sets[0]
    if uv_set not in known:
        known[uv_set] = with_tangents(mesh, uv_set)
    return known[uv_set]


def framed_alike(key: Mesh, framed: Mesh, first: Mesh, materials: tuple[Material, ...]) -> Mesh:
    """A later key of a mesh, with tangents where `framed`, made of the first key, has got some: row by row as these."""
    if framed is first:
        return key
    assert key.normals is not None
    assert framed.normals is not None
    assert framed.normal_triangles is not None
    uv_set = next(uv_set for material in materials for uv_set in _sets_asked_for(material))
    before = (key.triangles if key.normal_triangles is None else key.normal_triangles).reshape(-1)
    now = framed.normal_triangles.reshape(-1)
    # A row of the normals is one corner's as much as another's.
    corner = np.zeros(len(framed.normals), dtype=np.int64)
    corner[now] = np.arange(len(now))
    tangents = corner_tangents(key, uv_set).reshape(-1, 4)[corner]
    return dataclasses.replace(key, normals=key.normals[before[corner]], normal_triangles=framed.normal_triangles, tangents=tangents)


def _sets_asked_for(material: Material) -> list[int]:
    """The sets of texture coordinates along which a material wants tangents."""
    coat, anisotropy = getattr(material, "clearcoat", None), getattr(material, "anisotropy", None)
    maps = [getattr(material, "normal_texture", None), getattr(coat, "normal_texture", None), getattr(anisotropy, "texture", None)]
    sets = [texture.uv_set for texture in maps if texture is not None]
    return sets if sets or anisotropy is None else [0]
