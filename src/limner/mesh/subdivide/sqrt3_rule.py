"""Kobbelt's square root of three: every triangle into three about its middle, then the old edges are turned.

       /|\\                 two steps divide every edge in three,            border, every second step:
      / | \\                and a triangle into nine                          1/27 (10 16 1)  (4 19 4)  (1 16 10)
     /.' '.\\                                                                 the ternary cubic B-spline
    '-------'     vertex: (1 - a) v + a mean of its n neighbours, a = (4 - 2 cos(2 pi / n)) / 9

Two steps are made in one: the nine parts of a triangle are known beforehand, so that seams of textures and the borders between materials
run along edges again. What is left of an odd number of levels turns all edges but those.

**Source**: Kobbelt, "√3-Subdivision", SIGGRAPH 2000.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..mesh import Mesh
from ..normals import vertex_normals
from .cage import cage_of, check_levels
from .creases import NO_CREASES, blended, sharpness_of
from .faces import Faces, faces_of, summed

__all__ = ["sqrt3"]

Values = NDArray[np.float64]
Indices = NDArray[np.int32]


def sqrt3(mesh: Mesh, levels: int = 2, *, uv_rule: str = "smooth", limit: bool = False) -> Mesh:
    """Subdivide triangles by Kobbelt's scheme.

    Parameters
    ----------
    mesh : Mesh
    levels : int >= 0
        Steps; each makes three triangles of one. Borders are divided in every second one.
    uv_rule : "smooth" or "linear"
        How texture coordinates are divided away from seams; at seams they are divided linearly.
    limit : bool
        Move the vertices to where they would be after infinitely many steps; beside borders that is exact after an even number.

    Returns
    -------
    Mesh
        ``3^levels`` triangles for each; smooth normals. After an even number of levels they are in the order of those they are parts
        of. After an odd number a triangle reaches over an old edge into the neighbour, whose material it may have; over seams and
        between materials it does not. Colours and attributes of vertices are averaged as positions are; tangents and attributes of
        edges are dropped.

    Examples
    --------
    >>> from limner.mesh.shapes.primitives import icosahedron
    >>> sqrt3(icosahedron(), 3)
    Mesh('icosahedron', 272 positions, 540 triangles)
    """
    cage = cage_of(mesh, "sqrt3")
    levels = check_levels(levels, len(mesh.triangles), 3, "sqrt3", uv_rule)
    values, triangles = cage.values, mesh.triangles
    uvs, corners = cage.uv_values, cage.uv_triangles
    parent = np.arange(len(triangles))
    for _ in range(levels // 2):
        faces = faces_of(triangles, len(values))
        values, triangles = _twice_divided(faces, values), _ninths(faces)
        parent = np.repeat(parent, 9)
        if corners is not None:
            uv_faces = faces_of(corners, len(uvs))
            uvs, corners = _twice_divided_uvs(uv_faces, uvs, uv_rule), _ninths(uv_faces)
    if levels % 2:
        faces = faces_of(triangles, len(values))
        turned = _turned_sides(faces, mesh, parent, corners)
        values = _divided(faces, values)
        values = _limit_values(faces_of(_thirds(faces, faces.twin >= 0), len(values)), values) if limit else values
        triangles = _thirds(faces, turned)
        parent = np.repeat(parent, 3)
        if corners is not None:
            uv_faces = faces_of(corners, len(uvs))
            uvs, corners = np.concatenate([uvs, uv_faces.means(uvs)]), _thirds(uv_faces, turned, faces.twin)
    elif limit:
        values = _limit_values(faces_of(triangles, len(values)), values)
    normals = vertex_normals(values[:, :3], triangles), None
    return cage.mesh_of(values, triangles, normals, None if corners is None else (uvs, corners), parent)


def _alpha(valence: Values) -> Values:
    return (4.0 - 2.0 * np.cos(2.0 * math.pi / np.maximum(valence, 1.0))) / 9.0


def _on_border(faces: Faces) -> NDArray[np.bool_]:
    border = np.bincount(faces.vertex, minlength=faces.n_vertices) == 0
    border[faces.edges[faces.is_sharp].reshape(-1)] = True
    return border


def _smoothed(faces: Faces, values: Values) -> tuple[Values, Values]:
    """One step's vertices, and how much of the mean of its neighbours each has; 0 on borders."""
    around, valence = faces.neighbours(values)
    alpha = np.where(_on_border(faces), 0.0, _alpha(valence))
    return values + alpha[:, None] * (around / np.maximum(valence, 1.0)[:, None] - values), alpha


def _divided(faces: Faces, values: Values) -> Values:
    """One step: the vertices, then one in every face."""
    return np.concatenate([_smoothed(faces, values)[0], faces.means(values)])


def _twice_divided(faces: Faces, values: Values) -> Values:
    """Two steps: the vertices, one in every face, and one near each end of every edge, the lesser vertex' first."""
    once, alpha = _smoothed(faces, values)
    middles = faces.means(values)
    n_faces = np.bincount(faces.vertex, minlength=len(values))
    beside = summed(faces.vertex, middles, len(values), faces.face) / np.maximum(n_faces, 1)[:, None]
    vertices = once + alpha[:, None] * (beside - once)
    # Near an end: the middle of the triangle between that end and the faces on both sides
    paired = faces.twin >= 0
    both = summed(faces.edge_of[paired], middles, len(faces.edges), faces.face[paired])
    thirds = (np.repeat(both, 2, axis=0) + once[faces.edges.reshape(-1)]) / 3.0
    _cut_border(faces, values, vertices, thirds)
    return np.concatenate([vertices, _smoothed_middles(faces, once, middles), thirds])


def _smoothed_middles(faces: Faces, once: Values, middles: Values) -> Values:
    """The second step of what the first has put into the faces: among its corners and the middles beyond its inner edges."""
    inner = (faces.twin >= 0).reshape(-1, 3)
    beyond = np.where(inner.reshape(-1)[:, None], middles[faces.face[np.maximum(faces.twin, 0)]], 0.0)
    total = (once[faces.vertex] + beyond).reshape(len(middles), 3, -1).sum(axis=1)
    valence = 3.0 + inner.sum(axis=1)
    alpha = _alpha(valence)
    return middles + alpha[:, None] * (total / valence[:, None] - middles)


def _cut_border(faces: Faces, values: Values, vertices: Values, thirds: Values) -> None:
    """Put the points on borders where the cubic B-spline has them."""
    sharp = np.flatnonzero(faces.is_sharp)
    if not len(sharp):
        return
    edges = faces.edges[sharp]
    ends = np.concatenate([edges[:, 0], edges[:, 1]])
    beside = summed(ends, values[np.concatenate([edges[:, 1], edges[:, 0]])], len(values))
    is_curve = np.bincount(ends, minlength=len(values)) == 2
    vertices[is_curve] = (19.0 * values[is_curve] + 4.0 * beside[is_curve]) / 27.0
    for end in (0, 1):
        near, far = edges[:, end], edges[:, 1 - end]
        before = beside[near] - values[far]
        curve = (before + 16.0 * values[near] + 10.0 * values[far]) / 27.0
        # Where borders meet there is no before: the curve ends
        straight = (2.0 * values[near] + values[far]) / 3.0
        thirds[2 * sharp + end] = np.where(is_curve[near][:, None], curve, straight)


def _twice_divided_uvs(faces: Faces, values: Values, rule: str) -> Values:
    """Two steps of what stays where it is at seams."""
    a, b = values[faces.edges[:, 0]], values[faces.edges[:, 1]]
    straight = np.stack([(2.0 * a + b) / 3.0, (a + 2.0 * b) / 3.0], axis=1).reshape(-1, values.shape[1])
    if rule == "linear":
        return np.concatenate([values, faces.means(values), straight])
    made = _twice_divided(faces, values)
    n, m = len(values), len(faces.start) - 1
    at_seam = _on_border(faces)
    made[:n][at_seam] = values[at_seam]
    sharp = np.repeat(faces.is_sharp, 2)
    made[n + m :][sharp] = straight[sharp]
    return made


def _ninths(faces: Faces) -> Indices:
    """(9 m, 3): the parts of triangles whose edges are cut in three."""
    m = len(faces.start) - 1
    a, b, c = faces.vertex.reshape(-1, 3).T
    base = faces.n_vertices + m + 2 * faces.edge_of
    # The lesser vertex' point comes first
    forwards = faces.vertex <= faces.vertex[faces.following]
    near, far = (np.where(forwards, base, base + 1).reshape(-1, 3).T, np.where(forwards, base + 1, base).reshape(-1, 3).T)
    (ab, bc, ca), (ba, cb, ac) = near, far
    o = faces.n_vertices + np.arange(m)
    parts = [(a, ab, ac), (ab, ba, o), (ba, b, bc), (bc, cb, o), (cb, c, ca), (ca, ac, o), (ac, ab, o), (ba, bc, o), (cb, ca, o)]
    return np.stack([np.stack(part, axis=1) for part in parts], axis=1).reshape(-1, 3).astype(np.int32)


def _turned_sides(faces: Faces, mesh: Mesh, parent: NDArray[np.int64], corners: Indices | None) -> NDArray[np.bool_]:
    """The sides (h,) between triangles of one material and one piece of texture."""
    turned = faces.twin >= 0
    other = np.maximum(faces.twin, 0)
    if mesh.triangle_materials is not None:
        material = mesh.triangle_materials[parent][faces.face]
        turned &= material == material[other]
    if corners is not None:
        uv = corners.reshape(-1)
        turned &= (uv == uv[faces.following[other]]) & (uv[faces.following] == uv[other])
    return turned


def _thirds(faces: Faces, turned: NDArray[np.bool_], twin: Indices | None = None) -> Indices:
    """(3 m, 3): a triangle for every side: its begin, the middle beyond it and its own face's; or, unturned, its ends and the middle."""
    beyond = faces.face[np.maximum(faces.twin if twin is None else twin, 0)]
    second = np.where(turned, faces.n_vertices + beyond, faces.vertex[faces.following])
    return np.stack([faces.vertex, second, faces.n_vertices + faces.face], axis=1).astype(np.int32)


def _limit_values(faces: Faces, values: Values) -> Values:
    """(1 - b) v + b the mean of the neighbours, b = 3 a / (1 + 3 a); on borders the cubic B-spline's."""
    around, valence = faces.neighbours(values)
    alpha = _alpha(valence)
    beta = (3.0 * alpha / (1.0 + 3.0 * alpha))[:, None]
    smooth = (1.0 - beta) * values + beta * around / np.maximum(valence, 1.0)[:, None]
    return blended(faces, values, sharpness_of(faces, NO_CREASES), smooth, 1.0 / 6.0)
