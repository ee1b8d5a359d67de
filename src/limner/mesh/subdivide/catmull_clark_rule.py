"""Catmull and Clark's scheme: every polygon of k sides into k quadrilaterals.

    face point F     the mean of a polygon's corners
    edge point       (a + b + F + F') / 4 of an edge a b between two polygons
    vertex           (mean of the F + 2 mean of the edges' middles + (n - 3) v) / n where n edges meet

On borders and creases 1/2 1/2 and 1/8 3/4 1/8, which are the cubic B-spline's; where all is quadrilaterals, four round every vertex, the
surface is the bicubic B-spline's.

**Source**: Catmull and Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes", *Computer-Aided Design* 10(6),
1978. Limits and tangents: Halstead, Kass and DeRose, "Efficient, Fair Interpolation using Catmull-Clark Surfaces", SIGGRAPH 1993; at
borders, whose rules depend on no valence here, derived in `sectors.border_weights`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..normals import vertex_normals
from ..polygons import mesh_from_polygons
from ..shapes.bands import halved
from ..sizes import check_triangles
from .cage import cage_of, check_levels
from .creases import NO_CREASES, Sharpness, blended, checked_creases, sharpness_of
from .faces import Faces, faces_of, summed
from .polygons import merged, pairs_of_triangles
from .sectors import Sectors, border_weights, sectors_of, unit_normals

__all__ = ["catmull_clark"]

_POLYGON = "polygon"  # the attribute of faces that says what triangles are parts of

Values = NDArray[np.float64]
Indices = NDArray[np.int32]


def catmull_clark(
    mesh: Mesh | tuple[ArrayLike, Iterable[ArrayLike]],
    levels: int = 1,
    *,
    polygons: str | ArrayLike | None = None,
    creases: ArrayLike = (),
    sharpness: ArrayLike = math.inf,
    keep_corners: bool = False,
    uv_rule: str = "smooth",
    limit: bool = False,
) -> Mesh:
    """Subdivide polygons by Catmull and Clark's scheme.

    Parameters
    ----------
    mesh : Mesh, or (positions, polygons)
        Triangles, or what `mesh_from_polygons` takes: (n, 3) float, and the vertices of each polygon.
    levels : int >= 0
        Steps; the first makes a quadrilateral of every corner, each later one four of one.
    polygons : "quads", "triangles", or (m,) int, optional
        What the triangles of a mesh are: "quads" joins neighbours a b c and a c d in the list, as quadrilaterals are stored; "triangles"
        joins none; numbers say which polygon each triangle is a part of. None: the attribute "polygon" of the faces tells, which
        `mesh_from_polygons` sets; without it "quads".
    creases : (k, 2) int
        Edges of the polygons, by their vertices, that stay sharp.
    sharpness : float >= 0, or (k,)
        For how many steps: inf for ever.
    keep_corners : bool
        A vertex that has but one polygon stays; else the border is a smooth curve there too.
    uv_rule : "smooth" or "linear"
        How texture coordinates are divided away from seams; at seams they are divided linearly.
    limit : bool
        Move the vertices to where they would be after infinitely many steps, and give them the normals they would have there: exactly,
        but at a vertex in which a single crease ends within the surface. Takes at least one level.

    Returns
    -------
    Mesh
        Two triangles for each quadrilateral, in the order of the polygons; smooth normals, split at creases that are still sharp.
        Colours and attributes of vertices are averaged as positions are; materials and attributes of faces are handed on, those of a
        polygon being those of its first triangle, but "polygon" numbers the quadrilaterals; tangents and attributes of edges are
        dropped.

    Examples
    --------
    >>> from limner.mesh.shapes.primitives import box
    >>> catmull_clark(box(), 2)
    Mesh('box', 98 positions, 192 triangles)
    """
    if not isinstance(mesh, Mesh):
        mesh, polygons = mesh_from_polygons(*mesh), None
    cage = cage_of(mesh, "catmull_clark")
    levels = check_levels(levels, len(mesh.triangles), 1, "catmull_clark", uv_rule)
    numbers = _numbers(mesh, polygons)
    vertex, counts, source = merged(mesh.triangles, numbers)
    check_triangles(len(vertex) * 2 * 4 ** min(max(levels - 1, 0), 32), f"catmull_clark.levels = {levels} of {len(counts)} polygons")
    faces = faces_of(vertex, len(mesh.positions), counts)
    sharp = checked_creases(creases, sharpness, keep_corners, faces, "catmull_clark")
    if levels == 0:
        if limit:
            raise SceneError("catmull_clark.levels must be at least 1 for limit = True, got 0")
        return mesh
    values, parent = cage.values, np.repeat(source, counts)
    uvs, uv_faces = cage.uv_values, None
    if cage.uv_triangles is not None:
        uv_faces = faces_of(merged(mesh.triangles, numbers, cage.uv_triangles)[0], len(uvs), counts)
    for step in range(levels):
        values, quads = _divided(faces, values, sharpness_of(faces, sharp))
        sharp = sharp.divided(faces)
        if uv_faces is not None:
            uvs, uv_quads = _divided_uvs(uv_faces, uvs, uv_rule)
            uv_faces = faces_of(uv_quads, len(uvs)) if step < levels - 1 else uv_faces
        faces = faces_of(quads, len(values))
    parent = np.repeat(parent, 2 * 4 ** (levels - 1))
    triangles = halved(*quads.T)
    weights = sharpness_of(faces, sharp, at_the_limit=True)
    normals: tuple[NDArray[np.floating], NDArray[np.integer] | None]
    if limit or (weights.along & ~faces.is_sharp).any():
        of_fans, corners = _limit_normals(faces, values[:, :3], weights)
        normals = of_fans, halved(*corners.reshape(-1, 4).T)
        values = _limit_values(faces, values, weights) if limit else values
    else:
        normals = vertex_normals(values[:, :3], triangles), None
    made = cage.mesh_of(values, triangles, normals, None if uv_faces is None else (uvs, halved(*uv_quads.T)), parent)
    if _POLYGON not in (made.face_attributes or {}):
        return made
    quads_of = np.arange(len(triangles), dtype=np.int32) // 2
    return dataclasses.replace(made, face_attributes={**(made.face_attributes or {}), _POLYGON: quads_of})


def _numbers(mesh: Mesh, polygons: str | ArrayLike | None) -> NDArray[np.int64]:
    """The polygon of each triangle, 0 .. m - 1 in the order of their first triangles."""
    if polygons is None:
        polygons = (mesh.face_attributes or {}).get(_POLYGON, "quads")
    if isinstance(polygons, str):
        if polygons == "triangles":
            return np.arange(len(mesh.triangles))
        if polygons == "quads":
            return pairs_of_triangles(mesh)
        raise SceneError(f"catmull_clark.polygons must be quads, triangles or numbers, got {polygons!r}")
    numbers = np.asarray(polygons)
    if numbers.shape != (len(mesh.triangles),) or numbers.dtype.kind not in "iu":
        raise SceneError(
            f"catmull_clark.polygons must hold one whole number per triangle ({len(mesh.triangles)}), got {numbers.dtype} {numbers.shape}"
        )
    _, first, inverse = np.unique(numbers, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse.reshape(-1)]


def _divided(faces: Faces, values: Values, sharp: Sharpness) -> tuple[Values, Indices]:
    """One step: the vertices, then one on every edge, then one in every face."""
    middles = faces.means(values)
    points = [_vertex_points(faces, values, middles, sharp), _edge_points(faces, values, middles, sharp.edge), middles]
    return np.concatenate(points), _quads(faces)


def _divided_uvs(faces: Faces, values: Values, rule: str) -> tuple[Values, Indices]:
    """One step of what stays where it is at seams."""
    middles = faces.means(values)
    if rule == "linear":
        return np.concatenate([values, values[faces.edges].mean(axis=1), middles]), _quads(faces)
    at_seam = np.zeros(len(values), dtype=bool)
    at_seam[faces.edges[faces.is_sharp].reshape(-1)] = True
    free = sharpness_of(faces, NO_CREASES)
    vertices = np.where(at_seam[:, None], values, _vertex_points(faces, values, middles, free))
    return np.concatenate([vertices, _edge_points(faces, values, middles, free.edge), middles]), _quads(faces)


def _quads(faces: Faces) -> Indices:
    """(h, 4): corner, middle of the side after it, middle of the face, middle of the side before it."""
    quads = np.empty((len(faces.vertex), 4), dtype=np.int32)
    quads[:, 0] = faces.vertex
    quads[:, 1] = faces.n_vertices + faces.edge_of
    quads[:, 2] = faces.n_vertices + len(faces.edges) + faces.face
    quads[:, 3] = faces.n_vertices + faces.edge_of[faces.preceding]
    return quads


def _edge_points(faces: Faces, values: Values, middles: Values, sharpness: Values) -> Values:
    points = (values[faces.edges[:, 0]] + values[faces.edges[:, 1]]) * 0.5
    side = np.flatnonzero(faces.twin > np.arange(len(faces.twin)))
    edge = faces.edge_of[side]
    beside = (middles[faces.face[side]] + middles[faces.face[faces.twin[side]]]) * 0.5
    points[edge] += (0.5 * (1.0 - sharpness[edge]))[:, None] * (beside - points[edge])
    return points


def _vertex_points(faces: Faces, values: Values, middles: Values, sharp: Sharpness) -> Values:
    n = len(values)
    of_faces = summed(faces.vertex, middles, n, faces.face)
    n_faces = np.maximum(np.bincount(faces.vertex, minlength=n), 1)[:, None]
    around, valence = faces.neighbours(values)
    valence = np.maximum(valence, 1.0)[:, None]
    smooth = of_faces / (n_faces * valence) + (around / valence + values) / valence + (valence - 3.0) / valence * values
    return blended(faces, values, sharp, smooth, 0.125)


def _limit_values(faces: Faces, values: Values, sharp: Sharpness) -> Values:
    """(n^2 v + 4 the neighbours + the opposite corners of the quadrilaterals) / (n (n + 5))."""
    around, valence = faces.neighbours(values)
    n = np.maximum(valence, 1.0)[:, None]
    opposite = summed(faces.vertex, values, len(values), faces.vertex[faces.following[faces.following]])
    smooth = (n * n * values + 4.0 * around + opposite) / (n * (n + 5.0))
    return blended(faces, values, sharp, smooth, 1.0 / 6.0)


def _limit_normals(faces: Faces, points: Values, sharp: Sharpness) -> tuple[Values, NDArray[np.int64]]:
    """Normals of the fans between creases, and the fan of every corner."""
    sectors = sectors_of(faces, sharp)
    right, left = _closed_tangents(faces, sectors, points)
    open_ = np.flatnonzero(~sectors.closes)
    if len(open_):
        right[open_], left[open_] = _border_tangents(faces, sectors, points, open_, sharp.corner > 0.0)
    return unit_normals(sectors, faces, points, (right, left)), sectors.of_corner


def _closed_tangents(faces: Faces, sectors: Sectors, points: Values) -> tuple[Values, Values]:
    n, i, s = sectors.count[sectors.of_corner], sectors.place, len(sectors.vertex)
    neighbour, opposite = faces.vertex[faces.following], faces.vertex[faces.following[faces.following]]
    turn = 2.0 * math.pi / n
    weight = 1.0 + np.cos(turn) + np.cos(turn / 2.0) * np.sqrt(2.0 * (9.0 + np.cos(turn)))
    tangents = []
    for wave in (np.cos, np.sin):
        here, there = wave(i * turn), wave((i + 1) * turn)
        edges = summed(sectors.of_corner, points, s, neighbour, weights=weight * here)
        tangents.append(edges + summed(sectors.of_corner, points, s, opposite, weights=here + there))
    return tangents[0], tangents[1]


def _border_tangents(
    faces: Faces, sectors: Sectors, points: Values, open_: NDArray[np.int64], at_corner: NDArray[np.bool_]
) -> tuple[Values, Values]:
    """Away from a border and along it, for fans that do not close."""
    number = np.full(len(sectors.vertex), -1, dtype=np.int64)
    number[open_] = np.arange(len(open_))
    corners = np.flatnonzero(number[sectors.of_corner] >= 0)
    fan = number[sectors.of_corner[corners]]
    theta = math.pi / np.maximum(sectors.count[open_], 2)
    # A spoke's weight is sin(i theta); a far corner's is a share of those of the spokes on both sides
    half = (1.0 + np.cos(theta)) / 16.0
    excess = half + np.sqrt(half * half + half / 2.0)  # the eigenvalue - 1/4
    share = 1.0 / (16.0 * excess)
    angle = sectors.place[corners] * theta[fan]
    here, there = np.sin(angle), np.sin(angle + theta[fan])
    neighbour = faces.vertex[faces.following[corners]]
    opposite = faces.vertex[faces.following[faces.following[corners]]]
    inner = summed(fan, points, len(open_), neighbour, weights=here)
    inner += summed(fan, points, len(open_), opposite, weights=(here + there) * share[fan])
    spread = 1.0 / np.tan(theta / 2.0)  # the sum of the spokes' weights
    at_ends, at_vertex = np.sin(theta) * (0.0625 + 0.25 * share), spread * (0.375 + 0.5 * share)
    beside, own = border_weights(0.25 + excess, at_ends, at_vertex)
    first = points[faces.vertex[faces.following[sectors.first[open_]]]]
    last = points[faces.vertex[faces.preceding[sectors.last[open_]]]]
    middle = points[sectors.vertex[open_]]
    across = inner + beside[:, None] * (first + last) + own[:, None] * middle
    # One quadrilateral between its border's sides: these bend, and that is all there is across
    across = np.where((sectors.count[open_] > 1)[:, None], across, first + last - 2.0 * middle)
    stays = at_corner[sectors.vertex[open_]][:, None]
    return np.where(stays, first - middle, across), np.where(stays, last - middle, last - first)
