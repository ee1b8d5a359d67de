"""Which edges of triangles are lines of a drawing (FoCG 10.3.1): silhouettes, boundaries, creases, material and uv seams.

              n0     n1                       n0 . e > 0: this side faces the eye
               \\     /
          ______\\ | /______                  an edge is a silhouette where one side faces the eye and the other does not,
                 \\|/                         (e . n0)(e . n1) <= 0; a crease where n0 and n1 differ by more than an angle
                 edge

A triangle that is seen edge-on counts as facing away, so that of a box seen from the front one side of each edge does, and not both.

**Source**: FoCG 10.3.1; the summary's test.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.adjacency import Adjacency, adjacency_of_triangles
from ..mesh.normals import inner, triangle_vectors
from .creases import lasting
from .segments import Segments
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals

__all__ = ["Faces", "Wanted", "edge_segments", "faces_of"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_EDGE_ON = 1e-7  # sine of the angle between a triangle and the ray to the eye: what rounding to float32 leaves of 0
_SLIVER = 1e-6  # height by longest side of a triangle whose normal is noise
_ON = 2e-7  # of the scene's extent: how far rounding to float32 moves a surface through a line that lies on it


class Faces(NamedTuple):
    """What edges need to know of their triangles.

    Attributes
    ----------
    adjacency : Adjacency
    normals : (m, 3) float64
        Unit; of a sliver that of its neighbour across its longest side.
    facing : (m,) int64
        1: towards the eye, -1: away, 0: edge-on.
    """

    adjacency: Adjacency
    normals: Floats
    facing: Indices


class Wanted(NamedTuple):
    """Rows of the kinds of lines among those of a drawing; -1: not asked for. The first that an edge fits is what it is."""

    boundary: int
    silhouette: int
    crease: int
    material: int
    uv_seam: int


def faces_of(surfaces: Surfaces, sight: SightLines) -> Faces:
    """Find which triangles touch, and which way they face."""
    adjacency = adjacency_of_triangles(surfaces.triangles, len(surfaces.points))
    e, f, g, across = triangle_vectors(surfaces.points, surfaces.triangles)
    double_area = np.sqrt(inner(across, across))
    sides = np.stack([inner(e, e), inner(f, f), inner(g, g)], axis=1)
    sliver = double_area <= _SLIVER * sides.max(axis=1, initial=0.0)
    scale = np.where(sliver, 0.0, 1.0 / np.where(sliver, 1.0, double_area))
    normals = np.stack(across, axis=1) * scale[:, None]
    towards = sight.towards(surfaces.points[surfaces.triangles[:, 0]]) if len(normals) else np.zeros((0, 3))
    length = np.sqrt((towards * towards).sum(axis=1))
    cosine = (normals * towards).sum(axis=1)
    facing = (cosine > _EDGE_ON * length).astype(np.int64) - (cosine < -_EDGE_ON * length)
    if sliver.any():
        _borrow(adjacency, sides, np.flatnonzero(sliver), sliver, normals, facing)
    return Faces(adjacency, normals, facing)


def _borrow(adjacency: Adjacency, sides: Floats, rows: Indices, sliver: Flags, normals: Floats, facing: Indices) -> None:
    """Give slivers what their neighbour across the longest side has; twice, for slivers lie beside slivers."""
    for _ in range(2):
        half_edge = 3 * rows + sides[rows].argmax(axis=1)
        beside = adjacency.opposite[half_edge]
        known = (beside >= 0) & ~sliver[beside // 3]
        mine, other = rows[known], beside[known] // 3
        normals[mine], facing[mine] = normals[other], facing[other]
        sliver[mine] = False
        rows = rows[~known]


def edge_segments(surfaces: Surfaces, faces: Faces, wanted: Wanted, crease_degrees: float) -> Segments:
    """The edges that are lines of a drawing, each once."""
    adjacency = faces.adjacency
    count, first = adjacency.edge_counts, adjacency.edge_start[:-1]
    one = adjacency.edge_halfedges[first] if len(first) else first
    other = adjacency.edge_halfedges[np.minimum(first + 1, max(len(adjacency.edge_halfedges) - 1, 0))] if len(first) else first
    s, t = one // 3, other // 3
    paired, branching = count == 2, count > 2
    bounded = surfaces.bounded[s]
    # Where both half-edges run the same way, one of the triangles is turned over.
    alike = adjacency.triangles.reshape(-1)[one] != adjacency.triangles.reshape(-1)[other]
    facing_t = np.where(alike, faces.facing[t], -faces.facing[t])
    turned = paired & ((faces.facing[s] > 0) != (facing_t > 0))
    cosine = (faces.normals[s] * faces.normals[t]).sum(axis=1) * np.where(alike, 1.0, -1.0)
    creased = branching | (paired & (cosine < math.cos(math.radians(crease_degrees))))
    if wanted.crease >= 0:
        limit = math.cos(math.radians(crease_degrees))
        creased[creased & paired & surfaces.exact[s]] = _bent(surfaces, one, other, creased & paired & surfaces.exact[s], limit)
        creased = lasting(surfaces.points, adjacency.edges, creased, count == 1, _extents(surfaces)[surfaces.instance[s]])
    kind = np.full(len(count), -1, dtype=np.int64)
    tests = (
        (wanted.uv_seam, lambda: paired & _torn(surfaces, one, other, alike)),
        (wanted.material, lambda: paired & (surfaces.material[s] != surfaces.material[t])),
        (wanted.crease, lambda: creased),
        (wanted.silhouette, lambda: turned),
        (wanted.boundary, lambda: count == 1),
    )
    for number, holds in tests:
        if number >= 0:
            kind[holds()] = number
    kind[~bounded] = -1
    found = np.flatnonzero(kind >= 0)
    ends = surfaces.points[adjacency.edges[found]]
    none = np.full((len(found), 2), -1, dtype=np.int64)
    slack, own = np.full(len(found), _ON * surfaces.extent), np.zeros(len(found), dtype=np.int64)
    return Segments(kind[found], ends, none, slack, own, surfaces.instance[s[found]])


def _bent(surfaces: Surfaces, one: NDArray[np.int32], other: NDArray[np.int32], which: Flags, limit: float) -> Flags:
    """Of some edges of exact shapes, whether the shape bends there, and not only the triangles that stand for it."""
    if not which.any():
        return np.zeros(0, dtype=bool)
    normals = corner_normals(surfaces).reshape(-1, 3)
    a, b = one[which], other[which]
    after_a, after_b = (np.where(k % 3 == 2, k - 2, k + 1) for k in (a, b))
    cosines = [(normals[p] * normals[q]).sum(axis=1) for p, q in ((a, after_b), (after_a, b))]
    return np.asarray((cosines[0] < limit) | (cosines[1] < limit))


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
