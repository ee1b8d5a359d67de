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

from ..mesh.adjacency import Adjacency
from .edges import EdgeKinds, Faces
from .segments import ROUNDING, Segments, joined
from .sight_lines import SightLines
from .surfaces import Surfaces, calmed, corner_normals
from .zeros import gradients, on, segments_in, zero_segments

__all__ = ["Outlines", "outlines", "towards_eye"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_EDGE_ON = 1e-4  # cosine between a normal and the ray to the eye: what rounding, to six digits or to float32, leaves of 0
_NOISE = 0.05  # of the grain's angle: what more than that would be no longer at the outline
_BENT = 2.0  # times longest side times turn of the normals: how far a mesh and its smooth surface are apart
_VISIBLE = 1.0  # pixels between a triangle and the smooth surface that it stands for


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
    normals = corner_normals(surfaces, faces.adjacency, kinds.sharp)
    corners = surfaces.points[surfaces.triangles]
    normals, noise = calmed(surfaces, faces.adjacency, kinds.sharp, normals)
    if not smooth:
        rough = _stands_out(surfaces, faces, sight, normals)
        normals[rough], noise[rough] = faces.normals[rough, None], 0.0
    towards = sight.towards(corners.reshape(-1, 3)).reshape(corners.shape)
    values = (normals * towards).sum(axis=2) - (_EDGE_ON + np.minimum(noise, _NOISE)) * np.sqrt((towards * towards).sum(axis=2))
    values[~surfaces.bounded] = 1.0
    ends, rows = zero_segments(surfaces, values)
    gradient, _ = gradients(corners[rows], values[rows])
    # Towards the eye n . e grows where the surface bends away, and falls where it hollows: there it hides its own silhouette.
    inwards = (gradient * sight.towards(ends.mean(axis=1))).sum(axis=1) < 0.0
    apart = _apart(surfaces, sight, normals, noise.max(axis=1, initial=0.0))
    within = segments_in(surfaces, kind, ends, rows, apart[rows], inwards.astype(np.int64))
    within = within._replace(soft=~surfaces.exact[rows])
    jumps = _jumps(surfaces, faces.adjacency, values)
    return Outlines(joined([within, _along(surfaces, apart, jumps, kinds, kind)]), *_others(surfaces, kinds, jumps))


def towards_eye(sight: SightLines, points: Floats, normals: Floats) -> Flags:
    """Whether surfaces face the eye at points, (k, 3), with unit normals, (k, 3)."""
    towards = sight.towards(points)
    return np.asarray((normals * towards).sum(axis=1) > _EDGE_ON * np.sqrt((towards * towards).sum(axis=1)))


def _stands_out(surfaces: Surfaces, faces: Faces, sight: SightLines, normals: Floats) -> Flags:
    """Which triangles one can tell from the smooth surface that they stand for: an arc that turns by a over a chord s is a s / 8 away,
    and its ends turn by a / 2 from the chord."""
    corners = surfaces.points[surfaces.triangles]
    turn = np.linalg.norm(normals - faces.normals[:, None], axis=2).max(axis=1, initial=0.0)
    against = ((normals * faces.normals[:, None]).sum(axis=2) <= 0.0).any(axis=1)
    return np.asarray(against | (0.25 * turn * _longest(corners) > _VISIBLE * sight.pixel_at(corners[:, 0])))


def _apart(surfaces: Surfaces, sight: SightLines, normals: Floats, noise: Floats) -> Floats:
    """How far triangles and the smooth surface that they stand for may be apart, (m,) metres; where there is a grain of the angle `noise`,
    (m,), at least as far as may not show, and half as far again, for what is not seen of it hides nothing."""
    bent = np.linalg.norm(normals - np.roll(normals, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    corners = surfaces.points[surfaces.triangles]
    made = _BENT * bent * _longest(corners)
    least = _VISIBLE * (1.0 + 0.5 * np.minimum(noise / _NOISE, 1.0)) * sight.pixel_at(corners[:, 0])
    return np.asarray(np.where((bent > 0.0) & (noise > 0.0), np.maximum(made, least), made))


def _longest(corners: Floats) -> Floats:
    return np.asarray(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0))


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
