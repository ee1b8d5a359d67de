"""Where surfaces turn away from the eye: silhouettes, smooth where the surface is and along edges where it is not (FoCG 10.3.1).

Every triangle has a number at each corner, n . e: positive where the surface faces the eye, and the silhouette is where it changes sign.

    n the triangle's own        all three are one number; the sign changes at edges: (e . n0)(e . n1) <= 0, the summary's test
    n the smooth surface's      the sign changes within triangles, along a line that does not zigzag from edge to edge

A triangle that stands for a part of a smooth surface, and is so small that one cannot see how far it is from it, has the normals of that
surface; others have their own. Where neighbours disagree at their common edge (at a crease, or where the one is smooth and the other is
not), the parts of the edge at which the one faces the eye and the other does not close the gap. So silhouettes are rings, or end where
the surface does, however the normals are chosen.

A triangle that is seen edge-on counts as facing away, so that of a box seen from the front one side of each edge does, and not both.

**Source**: FoCG 10.3.1 (the test); A. Hertzmann and D. Zorin, "Illustrating smooth surfaces", SIGGRAPH 2000 (smooth silhouettes); the
choice between them, and the joints, are ours.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..mesh.adjacency import Adjacency
from .edges import EdgeKinds, Faces
from .grain import without_grain
from .segments import ROUNDING, Segments, joined
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals
from .zeros import gradients, on, segments_in, zero_segments

__all__ = ["Outlines", "outlines", "towards_eye"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_EDGE_ON = 1e-4  # cosine between a normal and the ray to the eye: what rounding, to six digits or to float32, leaves of 0
_NOISE = 0.05  # of the grain's angle: what more than that would be no longer at the outline
_BENT = 2.0  # times longest side times turn of the normals: how far a mesh and its smooth surface are apart
_VISIBLE = 1.0  # pixels between a triangle and the smooth surface that it stands for


_face_eye = Door(
    "limner.artistic.grain_kernel",
    "face_eye",
    (
        Array(np.float64, 3), Array(np.float64, 2), Array(np.float64, 3), Array(np.float64, 2), Scalar(np.int64), Array(np.float64, 1),
        Scalar(np.int64), Array(np.float64, 1), Scalar(np.float64), Scalar(np.float64), Array(np.float64, 1), Array(np.float64, 2),
        Array(np.float64, 1),
    ),
    "what faces the eye",
)  # fmt: skip


class Outlines(NamedTuple):
    """Silhouettes.

    Attributes
    ----------
    segments : Segments
    free : (k,) bool
        Which edges have no part in them.
    rest : Segments
        Of edges that have, and are lines of another kind, the parts that are no silhouettes.
    """

    segments: Segments
    free: Flags
    rest: Segments


def outlines(surfaces: Surfaces, faces: Faces, sight: SightLines, kinds: EdgeKinds, kind: int, *, smooth: bool = False) -> Outlines:
    """Find silhouettes; `smooth`: as of smooth surfaces, however rough the mesh is."""
    normals, noise = without_grain(surfaces, faces.adjacency, kinds.sharp, corner_normals(surfaces, faces.adjacency, kinds.sharp))
    corners, m = surfaces.points[surfaces.triangles], len(surfaces.triangles)
    values, apart = np.empty((m, 3)), np.empty(m)
    eye = sight.eye if sight.perspective else sight.back
    _face_eye(
        corners, faces.normals, normals, noise, int(smooth), np.ascontiguousarray(eye), int(sight.perspective),
        np.ascontiguousarray(sight.matrix[2]), max(sight.near, 1e-300), sight.pixels, np.array([_EDGE_ON, _NOISE, _VISIBLE, _BENT]), values,
        apart,
    )  # fmt: skip
    values[~surfaces.bounded] = 1.0
    ends, rows = zero_segments(surfaces, values)
    gradient, _ = gradients(corners[rows], values[rows])
    # Towards the eye n . e grows where the surface bends away, and falls where it hollows: there it hides its own silhouette.
    inwards = (gradient * sight.towards(ends.mean(axis=1))).sum(axis=1) < 0.0
    within = segments_in(surfaces, kind, ends, rows, apart[rows], inwards.astype(np.int64))
    within = within._replace(soft=~surfaces.exact[rows])
    jumps = _jumps(surfaces, faces.adjacency, values)
    return Outlines(joined([within, _along(surfaces, apart, jumps, kinds, kind)]), *_others(surfaces, kinds, jumps))


def towards_eye(sight: SightLines, points: Floats, normals: Floats) -> Flags:
    """Whether surfaces face the eye at points, (k, 3), with unit normals, (k, 3)."""
    towards = sight.towards(points)
    return np.asarray((normals * towards).sum(axis=1) > _EDGE_ON * np.sqrt((towards * towards).sum(axis=1)))


# --- along edges ----------------------------------------------------------------------------------------------------------


class _Jumps(NamedTuple):
    """Parts of edges that have a part in silhouettes: their ends (k, 2, 3), which edge, the triangles on both sides, and whether they face
    the eye on one side only."""

    ends: Floats
    edge: Indices
    one: Indices
    other: Indices
    parted: Flags


def _jumps(surfaces: Surfaces, adjacency: Adjacency, values: Floats) -> _Jumps:
    edge = np.flatnonzero(adjacency.edge_counts == 2)
    first = adjacency.edge_start[:-1][edge]
    one, other = adjacency.edge_halfedges[first].astype(np.int64), adjacency.edge_halfedges[first + 1].astype(np.int64)
    flat, corner = values.reshape(-1), surfaces.triangles.reshape(-1)
    f, g = _from_lesser(flat, corner, one), _from_lesser(flat, corner, other)
    # Sides that have different sides out face the eye with opposite signs.
    alike = corner[one] != corner[other]
    g = np.where(alike, g, -g)
    # Also where both change their sign, but in different places.
    apart = ((f > 0.0) != (g > 0.0)).any(axis=0) | (_zero(f) != _zero(g))
    edge, one, other, f, g = edge[apart], one[apart], other[apart], f[:, apart], g[:, apart]
    p, q = (surfaces.points[adjacency.edges[edge, k]] for k in (0, 1))
    zeros = np.sort(np.stack([_zero(f), _zero(g)]), axis=0)
    stops = np.stack([np.zeros(len(one)), zeros[0], zeros[1], np.ones(len(one))])
    ends, rows, parted = [], [], []
    for a, b in itertools.pairwise(stops):
        middle = 0.5 * (a + b)
        differ = (f[0] + middle * (f[1] - f[0]) > 0.0) != (g[0] + middle * (g[1] - g[0]) > 0.0)
        row = np.flatnonzero(a < b)
        ends.append(np.stack([on(p[row], q[row], a[row]), on(p[row], q[row], b[row])], axis=1))
        rows.append(row)
        parted.append(differ[row])
    row, made = np.concatenate(rows), np.concatenate(ends)
    kept = (made[:, 0] != made[:, 1]).any(axis=1)
    row = row[kept]
    return _Jumps(made[kept], edge[row], one[row] // 3, other[row] // 3, np.concatenate(parted)[kept])


def _from_lesser(flat: Floats, corner: Indices, half_edge: Indices) -> Floats:
    """Values at the ends of half-edges, (2, k), that of the lesser point first."""
    following = np.where(half_edge % 3 == 2, half_edge - 2, half_edge + 1)
    swap = corner[half_edge] > corner[following]
    return np.stack([flat[np.where(swap, following, half_edge)], flat[np.where(swap, half_edge, following)]])


def _zero(f: Floats) -> Floats:
    """Where values that go evenly from f[0] to f[1] pass through zero; 1: nowhere."""
    mixed = (f[0] > 0.0) != (f[1] > 0.0)
    return np.asarray(np.where(mixed, f[0] / np.where(mixed, f[0] - f[1], 1.0), 1.0))


def _along(surfaces: Surfaces, apart: Floats, jumps: _Jumps, kinds: EdgeKinds, kind: int) -> Segments:
    """The parts of edges that are silhouettes; what hides them where both sides are as flat as they look follows from the numbers."""
    row = np.flatnonzero(jumps.parted)
    one, other = jumps.one[row], jumps.other[row]
    slack = np.maximum(apart[one], apart[other])
    made = segments_in(surfaces, kind, jumps.ends[row], one, slack, np.zeros(len(row), dtype=np.int64))
    made.triangles[:] = np.where((slack == 0.0)[:, None], -1, np.stack([one, other], axis=1))
    return made._replace(soft=~kinds.sharp[jumps.edge[row]] & ~surfaces.exact[one], beside=one)


def _others(surfaces: Surfaces, kinds: EdgeKinds, jumps: _Jumps) -> tuple[Flags, Segments]:
    free = np.ones(len(kinds.kind), dtype=bool)
    free[jumps.edge] = False
    row = np.flatnonzero(~jumps.parted & (kinds.kind[jumps.edge] >= 0))
    n, triangles = len(row), np.stack([jumps.one[row], jumps.other[row]], axis=1)
    slack = np.full(n, ROUNDING * surfaces.extent)
    return free, Segments(
        kinds.kind[jumps.edge[row]], jumps.ends[row], triangles, slack, np.zeros(n, dtype=np.int64), surfaces.instance[triangles[:, 0]],
        np.zeros(n, dtype=bool), triangles[:, 0].copy(),
    )  # fmt: skip
