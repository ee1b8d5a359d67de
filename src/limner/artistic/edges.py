"""Which edges of triangles are lines of a drawing whatever the eye sees (FoCG 10.3.1): boundaries, creases, material and uv seams.

              n0     n1
               \\     /
          ______\\ | /______                  an edge is a crease where n0 and n1 differ by more than an angle, and a boundary where
                 \\|/                         there is one side only
                 edge

Which of them the surface turns away at, and so are silhouettes, says `outlines`.

**Source**: FoCG 10.3.1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.adjacency import Adjacency, adjacency_of_triangles
from ..mesh.normals import inner, triangle_vectors
from .creases import UNEVEN, lasting, unlike
from .segments import ROUNDING, Segments
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals

__all__ = ["EdgeKinds", "Faces", "Wanted", "edge_kinds", "edge_segments", "faces_of"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_SLIVER = 1e-6  # height by longest side of a triangle whose normal is noise


class Faces(NamedTuple):
    """What edges need to know of their triangles.

    Attributes
    ----------
    adjacency : Adjacency
    normals : (m, 3) float64
        Unit; of a sliver that of its neighbour across its longest side.
    """

    adjacency: Adjacency
    normals: Floats


class Wanted(NamedTuple):
    """Rows of the kinds of lines among those of a drawing; -1: not asked for. The first that an edge fits is what it is."""

    boundary: int
    crease: int
    material: int
    uv_seam: int


class EdgeKinds(NamedTuple):
    """What the edges of an adjacency are.

    Attributes
    ----------
    kind : (k,) int64
        -1: no line that was asked for.
    sharp : (k,) bool
        Creases, asked for or not, and all edges at which not two triangles meet: there the surface is not smooth.
    rough : (k,) bool
        Creases beside which the surface turns, too, as one that is scanned does: its grain hides parts of them.
    """

    kind: Indices
    sharp: Flags
    rough: Flags


def faces_of(surfaces: Surfaces) -> Faces:
    """Find which triangles touch, and their normals."""
    adjacency = adjacency_of_triangles(surfaces.triangles, len(surfaces.points))
    e, f, g, across = triangle_vectors(surfaces.points, surfaces.triangles)
    double_area = np.sqrt(inner(across, across))
    sides = np.stack([inner(e, e), inner(f, f), inner(g, g)], axis=1)
    sliver = double_area <= _SLIVER * sides.max(axis=1, initial=0.0)
    scale = np.where(sliver, 0.0, 1.0 / np.where(sliver, 1.0, double_area))
    normals = np.stack(across, axis=1) * scale[:, None]
    if sliver.any():
        _borrow(adjacency, sides, np.flatnonzero(sliver), sliver, normals)
    return Faces(adjacency, normals)


def _borrow(adjacency: Adjacency, sides: Floats, rows: Indices, sliver: Flags, normals: Floats) -> None:
    """Give slivers the normal of their neighbour across the longest side; twice, for slivers lie beside slivers."""
    for _ in range(2):
        half_edge = 3 * rows + sides[rows].argmax(axis=1)
        beside = adjacency.opposite[half_edge]
        known = (beside >= 0) & ~sliver[beside // 3]
        mine, other = rows[known], beside[known] // 3
        normals[mine] = normals[other]
        sliver[mine] = False
        rows = rows[~known]


def edge_segments(surfaces: Surfaces, faces: Faces, kinds: EdgeKinds, chosen: Flags, sight: SightLines) -> Segments:
    """Those of the chosen edges, (k,), that are lines of a drawing."""
    found = np.flatnonzero((kinds.kind >= 0) & chosen)
    ends = surfaces.points[faces.adjacency.edges[found]]
    none = np.full((len(found), 2), -1, dtype=np.int64)
    slack, own = np.full(len(found), ROUNDING * surfaces.extent), np.zeros(len(found), dtype=np.int64)
    slack = np.where(kinds.rough[found], np.maximum(slack, sight.pixel_at(ends[:, 0])), slack)
    beside = _beside(faces.adjacency).one[found].astype(np.int64) // 3
    return Segments(
        kinds.kind[found], ends, none, slack, own, surfaces.instance[beside], np.zeros(len(found), dtype=bool), beside
    )


class _Beside(NamedTuple):
    """The half-edges of edges: the first two (the first twice where there is one), how many there are, and whether the two run against
    each other, as they do where both triangles have the same side out."""

    one: NDArray[np.int32]
    other: NDArray[np.int32]
    n_triangles: NDArray[np.int32]
    alike: Flags


def _beside(adjacency: Adjacency) -> _Beside:
    count, first = adjacency.edge_counts, adjacency.edge_start[:-1]
    one, other = adjacency.edge_halfedges[first], adjacency.edge_halfedges[first + (count > 1)]
    start = adjacency.triangles.reshape(-1)
    return _Beside(one, other, count, start[one] != start[other])


def edge_kinds(surfaces: Surfaces, faces: Faces, wanted: Wanted, crease_degrees: float) -> EdgeKinds:
    """Of what kind each edge is, whichever way it is seen."""
    beside = _beside(faces.adjacency)
    one, other, count, alike = beside
    s, t = one // 3, other // 3
    paired = count == 2
    kind = np.full(len(count), -1, dtype=np.int64)
    creased, surroundings = _creased(surfaces, faces, beside, math.cos(math.radians(crease_degrees)))
    # What comes later counts more.
    if wanted.uv_seam >= 0:
        kind[paired & _torn(surfaces, one, other, alike)] = wanted.uv_seam
    if wanted.material >= 0:
        kind[paired & (surfaces.material[s] != surfaces.material[t])] = wanted.material
    if wanted.crease >= 0:
        kind[creased] = wanted.crease
    if wanted.boundary >= 0:
        kind[count == 1] = wanted.boundary
    kind[~surfaces.bounded[s]] = -1
    return EdgeKinds(kind, creased | ~paired, paired & creased & (surroundings > UNEVEN))


def _creased(surfaces: Surfaces, faces: Faces, beside: _Beside, limit: float) -> tuple[Flags, Floats]:
    """Which edges turn by more than an angle, whose cosine is given, or have more than two triangles; and by how much the surface turns
    beside them."""
    one, other, count, alike = beside
    cosine = (faces.normals[one // 3] * faces.normals[other // 3]).sum(axis=1) * np.where(alike, 1.0, -1.0)
    paired = (count == 2) & (cosine < limit)
    exact = paired & surfaces.exact[one // 3]
    paired[exact] = _bent(surfaces, faces.adjacency, one[exact], other[exact], limit)
    cosine = np.where(count == 2, cosine, 1.0)
    meshed = paired & ~surfaces.exact[one // 3]
    doubtful = meshed & (_turns_beside(faces, beside, cosine, paired | (count != 2), UNEVEN) > 0.5 * UNEVEN)
    for _ in range(2):
        near = doubtful[faces.adjacency.triangle_edges].any(axis=1)
        doubtful |= meshed & (near[one // 3] | near[other // 3])
    paired[meshed] = unlike(faces.adjacency, faces.normals, _areas(surfaces), meshed, doubtful, limit)[meshed]
    extents = _extents(surfaces)[surfaces.instance[one // 3]]
    surroundings = _turns_beside(faces, beside, cosine, paired | (count != 2))
    return lasting(surfaces.points, faces.adjacency.edges, paired | (count > 2), count == 1, extents, surroundings), surroundings


def _bent(surfaces: Surfaces, adjacency: Adjacency, one: NDArray[np.int32], other: NDArray[np.int32], limit: float) -> Flags:
    """Of some edges of exact shapes, whether the shape bends there, and not only the triangles that stand for it."""
    if not len(one):
        return np.zeros(0, dtype=bool)
    normals = corner_normals(surfaces, adjacency, adjacency.edge_counts != 2).reshape(-1, 3)
    after, before = (np.where(k % 3 == 2, k - 2, k + 1) for k in (one, other))
    first, second = ((normals[p] * normals[q]).sum(axis=1) for p, q in ((one, before), (after, other)))
    return np.asarray((first < limit) | (second < limit))


def _turns_beside(faces: Faces, beside: _Beside, cosine: Floats, lines: Flags, alone: float = 0.0) -> Floats:
    """By how much the surface turns, on the mean, at the other edges of the triangles beside each edge, but for those that are lines;
    `alone` where all are."""
    one, other, _, _ = beside
    turn = np.zeros(len(cosine))
    turn[~lines] = np.arccos(np.clip(cosine[~lines], -1.0, 1.0))
    edges = faces.adjacency.triangle_edges
    turns = np.stack([turn[edges].sum(axis=1), (~lines)[edges].sum(axis=1)])
    total, count = turns[:, one // 3] + turns[:, other // 3]
    return np.asarray(np.where(count > 0.0, total / np.maximum(count, 1.0), alone))


def _areas(surfaces: Surfaces) -> Floats:
    """Twice those of the triangles."""
    across = triangle_vectors(surfaces.points, surfaces.triangles)[3]
    return np.asarray(np.sqrt(inner(across, across)))


def _extents(surfaces: Surfaces) -> Floats:
    """Of every shape, metres."""
    made = np.zeros(len(surfaces.shapes))
    first = np.searchsorted(surfaces.instance, np.arange(len(made) + 1))
    for number in range(len(made)):
        held = surfaces.points[surfaces.triangles[first[number] : first[number + 1]]].reshape(-1, 3)
        made[number] = np.linalg.norm(np.ptp(held, axis=0)) if len(held) else 0.0
    return made


def _torn(surfaces: Surfaces, one: NDArray[np.int32], other: NDArray[np.int32], alike: Flags) -> Flags:
    """Whether texture coordinates differ across edges, given by their half-edges; `alike`: those run against each other."""
    uvs = surfaces.uvs.reshape(-1, 2)

    def ends(half_edge: NDArray[np.int32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        return uvs[half_edge], uvs[np.where(half_edge % 3 == 2, half_edge - 2, half_edge + 1)]

    (a, b), (c, d) = ends(one), ends(other)
    swapped = alike[:, None]
    return np.asarray(((a != np.where(swapped, d, c)) | (b != np.where(swapped, c, d))).any(axis=1))
