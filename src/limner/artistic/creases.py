"""Which creases are lines, and which are the roughness of a scanned surface.

A fold of a design runs on: round a hole, or from one corner to another. Where a surface is only rough, single edges turn by more than any
angle that one may choose, here and there. So creases that hang together are looked at as one, in space, which is why a moving camera
does not make them flicker: they stay where they are a ring, end on other lines, or are long for the object that they are on. Hairs that
stand off a fold, and end in the open, are roughness, too.

Before that, noise is averaged away, but not across what may be a crease: normals flow into each other round the ends of what is a crease by
accident, and an edge at which they then agree is none. The two sides of a fold of a design have no way round.

**Source**: P. Perona and J. Malik, "Scale-space and edge detection using anisotropic diffusion", PAMI 12(7), 1990 (averaging that stops at
edges; here of normals, and it stops altogether where the surface turns by more than the limit).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.adjacency import Adjacency
from ..mesh.components import component_labels

__all__ = ["UNEVEN", "lasting", "unlike"]

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

_SHORT, _SHORT_ROUGH = 0.04, 0.1  # of the object's extent; where it is rough
_SHAVES = 3  # times that hairs are taken away, for hairs stand on hairs
UNEVEN = math.radians(8.0)
"""How much a surface turns at an edge on the mean: where it is more, it is scanned, or roughly made."""

_JAGGED = math.radians(35.0)  # that a crease turns at a point on the mean
_ROUNDS = 8  # in which normals become means of those beside them: what is a few triangles long is averaged away
_POCKET, _AROUND = 4, 25  # triangles of a spot within one surface that is no part of a design, and of that surface at least


def unlike(adjacency: Adjacency, normals: Floats, areas: Floats, creased: Flags, doubtful: Flags, limit: float) -> Flags:
    """Which creases, (k,) bool, between two triangles each, still part normals when noise is averaged away on both sides.

    `normals` (m, 3) are unit, `areas` (m,) how much each counts, and `limit` is the cosine of the angle between what does not mix. Only
    what is `doubtful`, (k,) bool, is looked at; other creases stay.
    """
    if not doubtful.any():
        return creased
    pairs = adjacency.edge_counts == 2
    start = adjacency.edge_start[:-1]
    touched = np.zeros(len(normals), dtype=bool)
    one, other = np.full(len(pairs), -1, dtype=np.int64), np.full(len(pairs), -1, dtype=np.int64)
    one[pairs], other[pairs] = (adjacency.edge_halfedges[start[pairs] + k].astype(np.int64) for k in (0, 1))
    corner = adjacency.triangles.reshape(-1)
    alike = np.where(corner[one] != corner[other], 1.0, -1.0)
    one, other = one // 3, other // 3
    # Only what lies near them can change them.
    rows = np.flatnonzero(doubtful)
    touched[one[rows]] = touched[other[rows]] = True
    for _ in range(_ROUNDS):
        rows = np.flatnonzero(pairs & (touched[one] | touched[other]))
        touched[one[rows]] = touched[other[rows]] = True
    s, t, sign = one[rows], other[rows], alike[rows]
    shut = creased[rows] & ~_pockets(len(normals), s, t, creased[rows])
    near, local = np.unique(np.concatenate([s, t]), return_inverse=True)
    s, t = local.reshape(2, -1)
    mean, weight = normals[near], areas[near][:, None]
    for _ in range(_ROUNDS):
        agree = ~shut
        share = weight * mean
        both = np.concatenate([s[agree], t[agree]])
        given = np.concatenate([sign[agree, None] * share[t[agree]], sign[agree, None] * share[s[agree]]])
        total = share + np.stack([np.bincount(both, column, len(near)) for column in given.T], axis=1)
        length = np.sqrt((total * total).sum(axis=1, keepdims=True))
        mean = total / np.where(length > 0.0, length, 1.0)
        # What was no crease does not become one, and what agrees once goes on to mix.
        shut &= (mean[s] * mean[t]).sum(axis=1) * sign < limit
    made = creased.copy()
    made[rows] = shut | (creased[rows] & ~doubtful[rows])
    return made


def _pockets(n_triangles: int, s: Indices, t: Indices, creased: Flags) -> Flags:
    """Which creases, (k,) between triangles `s` and `t`, part a few triangles from one large surface that lies all round them."""
    label = component_labels(n_triangles, s[~creased], t[~creased])
    size = np.bincount(label, minlength=n_triangles)
    a, b = label[s], label[t]
    made = np.zeros(len(s), dtype=bool)
    for inner, outer in ((a, b), (b, a)):
        spot = creased & (size[inner] <= _POCKET) & (inner != outer)
        low, high = np.full(n_triangles, n_triangles, dtype=np.int64), np.full(n_triangles, -1, dtype=np.int64)
        for own, beside in ((a, b), (b, a)):
            apart = creased & (own != beside)
            np.minimum.at(low, own[apart], beside[apart])
            np.maximum.at(high, own[apart], beside[apart])
        made |= spot & (low[inner] == high[inner]) & (size[outer] >= _AROUND)
    return made


def lasting(
    points: Floats, edges: NDArray[np.int32], creased: Flags, firm: Flags, extents: Floats, surroundings: Floats | None = None
) -> Flags:
    """Which creases are drawn.

    Parameters
    ----------
    points : (n, 3) float64
    edges : (k, 2) int32
    creased : (k,) bool
    firm : (k,) bool
        Edges that are lines whatever the angle: boundaries, for one.
    extents : (k,) float64
        Of the object that each edge is on, metres.
    surroundings : (k,) float64, optional
        By how much the surface turns beside each crease, where there is none, radians; None: by nothing.

    Returns
    -------
    (k,) bool
    """
    made = creased.copy()
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    for _ in range(_SHAVES):
        lines_at = np.bincount(edges[made | firm].reshape(-1), minlength=len(points))
        hairs = _loose(edges, made, lines_at, length, extents, lines_at == 2)
        if not hairs.any():
            break
        made &= ~hairs
    if surroundings is not None:
        made &= ~_rough(points, edges, made, firm, length, extents, surroundings)
    lines_at = np.bincount(edges[made | firm].reshape(-1), minlength=len(points))
    return made & ~_loose(edges, made, lines_at, length, extents, np.ones(len(points), dtype=bool))


class _Links(NamedTuple):
    """Creases that hang together: the rows of all, of which chain each is, and which two follow each other at which point."""

    rows: Indices
    chain: Indices
    one: Indices
    other: Indices
    point: Indices


def _links(edges: NDArray[np.int32], creased: Flags, through: Flags) -> _Links:
    """Join creases through points, (n,)."""
    rows = np.flatnonzero(creased)
    ends = edges[rows].reshape(-1)
    at = np.argsort(ends, kind="stable")
    point = ends[at].astype(np.int64)
    linked = (point[1:] == point[:-1]) & through[point[1:]]
    one, other = at[:-1][linked] >> 1, at[1:][linked] >> 1
    return _Links(rows, component_labels(len(rows), one, other).astype(np.int64), one, other, point[1:][linked])


def _loose(edges: NDArray[np.int32], creased: Flags, lines_at: Indices, length: Floats, extents: Floats, through: Flags) -> Flags:
    """(k,) bool: creases that hang together through points, (n,), are short, and end somewhere in the open."""
    rows, chain, *_ = _links(edges, creased, through)
    long = np.bincount(chain, length[rows], len(rows)) >= _SHORT * extents[rows]
    open_end = np.zeros(len(rows), dtype=bool)
    open_end[chain[(lines_at[edges[rows]] < 2).any(axis=1)]] = True
    made = np.zeros(len(edges), dtype=bool)
    made[rows] = open_end[chain] & ~long[chain]
    return made


def _rough(
    points: Floats, edges: NDArray[np.int32], creased: Flags, firm: Flags, length: Floats, extents: Floats, surroundings: Floats
) -> Flags:
    """(k,) bool: creases whose surface turns beside them, too, and that are short or no smooth curves, wherever they end."""
    lines_at = np.bincount(edges[creased | firm].reshape(-1), minlength=len(points))
    rows, chain, one, other, point = _links(edges, creased, lines_at == 2)
    n = len(rows)
    total = np.bincount(chain, length[rows], n)
    beside = np.bincount(chain, length[rows] * surroundings[rows], n) / np.maximum(total, 1e-300)
    ways = [points[np.where(edges[rows[k], 0] == point, edges[rows[k], 1], edges[rows[k], 0])] - points[point] for k in (one, other)]
    cosine = -(ways[0] * ways[1]).sum(axis=1) / np.maximum(length[rows[one]] * length[rows[other]], 1e-300)
    turn = np.arccos(np.clip(cosine, -1.0, 1.0))
    turns = np.bincount(chain[one], turn, n) / np.maximum(np.bincount(chain[one], minlength=n), 1)
    made = np.zeros(len(edges), dtype=bool)
    noise = (beside > UNEVEN) & ((turns > _JAGGED) | (total < _SHORT_ROUGH * extents[rows]))
    made[rows] = noise[chain]
    return made
