"""Loop's scheme: every triangle into four, smooth where it may be, creased where it is told to.

          1/8                    b - - b           where n edges meet:
          / \\                   / \\   / \\              b = (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n
       3/8 - 3/8               b  1-nb  b
          \\ /                   \\ /   \\ /         on borders and creases: 1/2 1/2 and 1/8 3/4 1/8,
          1/8                    b - - b          which are the cubic B-spline's

**Source**: Loop, *Smooth Subdivision Surfaces Based on Triangles*, University of Utah 1987. Limits and tangents: Hoppe et al., "Piecewise
Smooth Surface Reconstruction", SIGGRAPH 1994; at borders, whose rules depend on no valence here, derived in `sectors.border_weights`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..mesh import Mesh
from ..normals import vertex_normals
from .cage import cage_of, check_levels
from .creases import NO_CREASES, Sharpness, blended, checked_creases, sharpness_of
from .faces import Faces, faces_of, summed
from .sectors import Sectors, border_weights, sectors_of, unit_normals

__all__ = ["loop"]

Values = NDArray[np.float64]
Indices = NDArray[np.int32]


def loop(
    mesh: Mesh,
    levels: int = 1,
    *,
    creases: ArrayLike = (),
    sharpness: ArrayLike = math.inf,
    keep_corners: bool = False,
    uv_rule: str = "smooth",
    limit: bool = False,
) -> Mesh:
    """Subdivide triangles by Loop's scheme.

    Parameters
    ----------
    mesh : Mesh
    levels : int >= 0
        Steps; each makes four triangles of one.
    creases : (k, 2) int
        Edges, by their vertices, that stay sharp.
    sharpness : float >= 0, or (k,)
        For how many steps: inf for ever.
    keep_corners : bool
        A vertex that has but one triangle stays; else the border is a smooth curve there too.
    uv_rule : "smooth" or "linear"
        How texture coordinates are divided away from seams; at seams they are divided linearly.
    limit : bool
        Move the vertices to where they would be after infinitely many steps, and give them the normals they would have there: exactly,
        but at a vertex in which a single crease ends within the surface.

    Returns
    -------
    Mesh
        ``4^levels`` triangles for each, in the order of those; smooth normals, split at creases that are still sharp. Colours and
        attributes of vertices are averaged as positions are; materials and attributes of faces are handed on; tangents and attributes
        of edges are dropped.

    Examples
    --------
    >>> from limner.mesh.shapes.primitives import icosahedron
    >>> loop(icosahedron(), 2)
    Mesh('icosahedron', 162 positions, 320 triangles)
    """
    cage = cage_of(mesh, "loop")
    levels = check_levels(levels, len(mesh.triangles), 4, "loop", uv_rule)
    faces = faces_of(mesh.triangles, len(mesh.positions))
    sharp = checked_creases(creases, sharpness, keep_corners, faces, "loop")
    values, triangles, corners, uvs = cage.values, mesh.triangles, cage.uv_triangles, cage.uv_values
    for _ in range(levels):
        values, triangles = _divided(faces, values, sharpness_of(faces, sharp))
        sharp = sharp.divided(faces)
        faces = faces_of(triangles, len(values))
        if corners is not None:
            uvs, corners = _divided_uvs(faces_of(corners, len(uvs)), uvs, uv_rule)
    weights = sharpness_of(faces, sharp, at_the_limit=True)
    normals: tuple[NDArray[np.floating], NDArray[np.integer] | None]
    if limit or (weights.along & ~faces.is_sharp).any():
        normals = _limit_normals(faces, values[:, :3], weights)
        values = _limit_values(faces, values, weights) if limit else values
    else:
        normals = vertex_normals(values[:, :3], triangles), None
    parent = np.repeat(np.arange(len(mesh.triangles)), 4**levels)
    return cage.mesh_of(values, triangles, normals, None if corners is None else (uvs, corners), parent)


def _divided(faces: Faces, values: Values, sharp: Sharpness) -> tuple[Values, Indices]:
    """One step: the vertices, then one on every edge; four triangles for each."""
    return np.concatenate([_vertex_points(faces, values, sharp), _edge_points(faces, values, sharp.edge)]), _quarters(faces)


def _divided_uvs(faces: Faces, values: Values, rule: str) -> tuple[Values, Indices]:
    """One step of what stays where it is at seams."""
    middles = values[faces.edges].mean(axis=1)
    if rule == "linear":
        return np.concatenate([values, middles]), _quarters(faces)
    at_seam = np.zeros(len(values), dtype=bool)
    at_seam[faces.edges[faces.is_sharp].reshape(-1)] = True
    free = sharpness_of(faces, NO_CREASES)
    vertices = np.where(at_seam[:, None], values, _vertex_points(faces, values, free))
    return np.concatenate([vertices, _edge_points(faces, values, free.edge)]), _quarters(faces)


def _quarters(faces: Faces) -> Indices:
    """(4 m, 3): the three corners and the middle of every triangle."""
    a, b, c = faces.vertex.reshape(-1, 3).T
    ab, bc, ca = (faces.n_vertices + faces.edge_of).reshape(-1, 3).T
    parts = np.empty((len(a), 4, 3), dtype=np.int32)
    for k, part in enumerate(((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))):
        for corner in range(3):
            parts[:, k, corner] = part[corner]
    return parts.reshape(-1, 3)


def _edge_points(faces: Faces, values: Values, sharpness: Values) -> Values:
    """Half of each end where sharp; 3/8 of each end and 1/8 of what is opposite."""
    middles = (values[faces.edges[:, 0]] + values[faces.edges[:, 1]]) * 0.5
    side = np.flatnonzero((faces.twin >= 0) & (faces.twin > np.arange(len(faces.twin))))
    edge = faces.edge_of[side]
    opposite = values[faces.vertex[faces.preceding[side]]] + values[faces.vertex[faces.preceding[faces.twin[side]]]]
    share = (0.25 * (1.0 - sharpness[edge]))[:, None]
    middles[edge] += share * (0.5 * opposite - middles[edge])
    return middles


def _vertex_points(faces: Faces, values: Values, sharp: Sharpness) -> Values:
    """Old vertices: smooth, on creases, or kept."""
    around, valence = faces.neighbours(values)
    beta = _beta(valence)
    smooth = (1.0 - valence * beta)[:, None] * values + beta[:, None] * around
    return blended(faces, values, sharp, smooth, 0.125)


def _beta(valence: Values) -> Values:
    n = np.maximum(valence, 1.0)
    return (0.625 - (0.375 + 0.25 * np.cos(2.0 * math.pi / n)) ** 2) / n


def _limit_values(faces: Faces, values: Values, sharp: Sharpness) -> Values:
    around, valence = faces.neighbours(values)
    omega = 1.0 / (np.maximum(valence, 1.0) + 0.375 / _beta(valence))
    smooth = (1.0 - valence * omega)[:, None] * values + omega[:, None] * around
    return blended(faces, values, sharp, smooth, 1.0 / 6.0)


def _limit_normals(faces: Faces, points: Values, sharp: Sharpness) -> tuple[Values, NDArray[np.int64]]:
    """Normals of the fans between creases, and the fan of every corner."""
    sectors = sectors_of(faces, sharp)
    s = len(sectors.vertex)
    k, i = sectors.count[sectors.of_corner], sectors.place
    closes = sectors.closes[sectors.of_corner]
    # An open fan of k triangles has k + 1 spokes, half a turn from the first to the last
    angle = np.where(closes, 2.0, 1.0) * math.pi / k
    sine, cosine = np.sin(i * angle), np.cos(i * angle)
    ends = faces.vertex[faces.following]
    right = summed(sectors.of_corner, points, s, ends, weights=np.where(closes, cosine, 0.0))
    left = summed(sectors.of_corner, points, s, ends, weights=sine)
    open_ = np.flatnonzero(~sectors.closes)
    if len(open_):
        # Away from the border, and along it
        right[open_], left[open_] = _border_tangents(faces, sectors, points, left[open_], open_, sharp.corner > 0.0)
    return unit_normals(sectors, faces, points, (right, left)), sectors.of_corner.reshape(-1, 3)


def _border_tangents(
    faces: Faces, sectors: Sectors, points: Values, inner: Values, open_: NDArray[np.int64], at_corner: NDArray[np.bool_]
) -> tuple[Values, Values]:
    """Away from a border and along it, for fans that do not close; `inner` is what spokes within them add."""
    middle = points[sectors.vertex[open_]]
    first = points[faces.vertex[faces.following[sectors.first[open_]]]]
    last = points[faces.vertex[faces.preceding[sectors.last[open_]]]]
    theta = math.pi / np.maximum(sectors.count[open_], 2)
    beside, at_vertex = border_weights(0.375 + 0.25 * np.cos(theta), np.sin(theta) / 8.0, 0.375 / np.tan(theta / 2.0))
    across = inner + beside[:, None] * (first + last) + at_vertex[:, None] * middle
    # One triangle between its border's sides: these bend, and that is all there is across
    across = np.where((sectors.count[open_] > 1)[:, None], across, first + last - 2.0 * middle)
    stays = at_corner[sectors.vertex[open_]][:, None]
    return np.where(stays, first - middle, across), np.where(stays, last - middle, last - first)
