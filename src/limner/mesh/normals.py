"""Normals for meshes that come without: flat per face, smooth per vertex, and smooth up to creases (FoCG 10.1.3, 12.1).

A vertex normal is the mean of the normals of the faces around it, each weighted by the face's angle there, so that it does not
depend on how the surface was cut into triangles. Across an edge that is meant to be sharp no mean should be taken: each corner
averages only those faces whose normals lie within the crease angle of its own face's. Sums run in the order of the triangles,
whatever the path, so the same mesh gets the same bits.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["crease_normals", "face_normals", "vertex_normals"]

Floats = NDArray[np.float64]

# A triangle whose area falls below this share of its longest edge's square has no direction worth averaging.
_DEGENERATE = 1e-12
# Faces that differ by just the crease angle belong together in spite of rounding.
_ANGLE_SLACK = 1e-6
# Pairs of faces around creased vertices that are compared at a time: bounds the memory where thousands of faces meet.
_PAIRS_AT_ONCE = 1 << 22
_ANY_NORMAL = (0.0, 0.0, 1.0)


def face_normals(positions: ArrayLike, triangles: ArrayLike) -> Floats:
    """Compute the unit normal of each triangle.

    Parameters
    ----------
    positions : (n, 3) float
    triangles : (m, 3) int
        Counter-clockwise seen from where the normal points to.

    Returns
    -------
    (m, 3) float64
        Zero for a degenerate triangle.

    Examples
    --------
    >>> face_normals([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 1]]).tolist()
    [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]
    """
    return _faces(*_arrays(positions, triangles))[0]


def vertex_normals(positions: ArrayLike, triangles: ArrayLike) -> NDArray[np.float32]:
    """Compute one smooth normal per vertex: the angle-weighted mean of the faces around it.

    Parameters
    ----------
    positions : (n, 3) float
    triangles : (m, 3) int

    Returns
    -------
    (n, 3) float32
        Unit; +z where no face, or faces that cancel, meet.

    **Source**: Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets", *Journal of Graphics Tools* 3(1), 1998.
    """
    points, corners = _arrays(positions, triangles)
    normals, angles = _faces(points, corners)
    weighted = (angles[:, :, None] * normals[:, None, :]).reshape(-1, 3)
    return _unit(_sum_by(corners.reshape(-1), weighted, len(points))).astype(np.float32)


def crease_normals(
    positions: ArrayLike, triangles: ArrayLike, crease_degrees: float = 40.0
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Compute normals that are smooth but for creases.

    Parameters
    ----------
    positions : (n, 3) float
    triangles : (m, 3) int
    crease_degrees : float in [0, 180]
        A corner averages the faces around its vertex whose normals lie within this angle of its own face's normal. 0: faceted;
        180: one normal per vertex.

    Returns
    -------
    normals : (k, 3) float32
        Unit. Row i < n is the one of vertex i where the surface is smooth there; the rows from n on belong to creased vertices,
        equal ones shared.
    normal_triangles : (m, 3) int32
        Normal indices of the corners. A corner of a degenerate triangle takes its vertex's mean, or +z where there is none.

    Notes
    -----
    Time is linear in the number of corners, but quadratic in the number of faces that meet at one creased vertex.

    **Source**: the weights are Thürmer and Wüthrich's (1998); the rule is that of normal creation in VRML's creaseAngle
    (ISO/IEC 14772-1, 4.6.3.5), by angle to the corner's own face instead of across an edge.
    """
    if not 0.0 <= crease_degrees <= 180.0:
        raise SceneError(f"crease_degrees must lie in [0, 180], got {crease_degrees}")
    points, corners = _arrays(positions, triangles)
    normals, angles = _faces(points, corners)
    vertex = corners.reshape(-1)
    own = np.repeat(normals, 3, axis=0)
    weighted = angles.reshape(-1, 1) * own
    means = _unit(_sum_by(vertex, weighted, len(points)))
    creased = _creased_vertices(vertex, own, means, crease_degrees)
    picked = np.flatnonzero(creased[vertex] & own.any(axis=1))
    if not len(picked):
        return means.astype(np.float32), corners.astype(np.int32)
    split = _unit(_sum_over_crease(picked, vertex, own, weighted, crease_degrees)).astype(np.float32)
    shared, index = _share_equal(vertex[picked], split)
    normal_triangles = vertex.astype(np.int32)
    normal_triangles[picked] = len(points) + index
    return np.concatenate([means.astype(np.float32), shared]), normal_triangles.reshape(-1, 3)


def _arrays(positions: ArrayLike, triangles: ArrayLike) -> tuple[Floats, NDArray[np.int64]]:
    points = np.asarray(positions, dtype=np.float64).reshape(-1, 3)
    corners = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
        raise SceneError(f"triangles must index into {len(points)} positions, got {corners.min()}..{corners.max()}")
    return points, corners


def _faces(points: Floats, corners: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """(m, 3) unit normals and (m, 3) angles of the corners; both zero for degenerate triangles."""
    a, b, c = (points[corners[:, k]] for k in range(3))
    edges = (b - a, c - b, a - c)
    normal = _cross(edges[0], -edges[2])
    double_area = np.sqrt(_dot(normal, normal))
    longest = np.max([_dot(e, e) for e in edges], axis=0)
    valid = double_area > _DEGENERATE * longest
    # + 0.0 turns -0.0 into 0.0, so that equal normals have equal bits.
    normal = normal * np.where(valid, 1.0 / np.where(valid, double_area, 1.0), 0.0)[:, None] + 0.0
    # atan2(|cross|, dot) keeps its digits where the arc cosine loses them; |cross| is the double area at every corner.
    angles = np.stack([np.arctan2(double_area, -_dot(edges[k], edges[k - 1])) for k in range(3)], axis=1)
    return normal, np.where(valid[:, None], angles, 0.0)


def _cross(p: Floats, q: Floats) -> Floats:
    x, y, z = p.T
    a, b, c = q.T
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=1)


def _dot(p: Floats, q: Floats) -> Floats:
    return p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1] + p[:, 2] * q[:, 2]


def _sum_by(index: NDArray[np.int64], values: Floats, count: int) -> Floats:
    """Sum rows with the same index, in their order."""
    return np.stack([np.bincount(index, weights=values[:, axis], minlength=count) for axis in range(3)], axis=1)


def _unit(vectors: Floats) -> Floats:
    length = np.sqrt(_dot(vectors, vectors))
    # Opposite faces cancel but for rounding; what is left is no direction.
    known = length > 1e-9
    return np.where(known[:, None], vectors / np.where(known, length, 1.0)[:, None], _ANY_NORMAL)


def _creased_vertices(vertex: NDArray[np.int64], own: Floats, means: Floats, crease_degrees: float) -> NDArray[np.bool_]:
    """Mark the vertices whose faces may differ by more than the crease angle.

    Faces within half the angle of their mean are within the angle of each other: those vertices, nearly all of a smooth mesh,
    need no pairs.
    """
    half = math.cos(math.radians(crease_degrees) / 2.0) - _ANGLE_SLACK
    stray = (_dot(own, means[vertex]) < half) & own.any(axis=1)
    marked = np.zeros(len(means), dtype=bool)
    if crease_degrees < 180.0:
        marked[vertex[stray]] = True
    return marked


def _sum_over_crease(
    picked: NDArray[np.int64], vertex: NDArray[np.int64], own: Floats, weighted: Floats, crease_degrees: float
) -> Floats:
    """For each picked corner, sum the weighted normals of the picked corners of its vertex within the crease angle."""
    least = math.cos(math.radians(crease_degrees)) - _ANGLE_SLACK
    order = np.argsort(vertex[picked], kind="stable")
    _, start, count = np.unique(vertex[picked][order], return_index=True, return_counts=True)
    group_start, group_count = np.repeat(start, count), np.repeat(count, count)
    ends = np.cumsum(group_count)
    sums = np.empty((len(picked), 3))
    begin = 0
    while begin < len(picked):
        done = ends[begin - 1] if begin else 0
        end = max(int(np.searchsorted(ends, done + _PAIRS_AT_ONCE, side="right")), begin + 1)
        first = np.repeat(np.arange(begin, end), group_count[begin:end])
        offset = np.arange(len(first)) - np.repeat(ends[begin:end] - group_count[begin:end] - done, group_count[begin:end])
        second = picked[order[group_start[first] + offset]]
        near = _dot(own[picked[order[first]]], own[second]) >= least
        sums[order[begin:end]] = _sum_by(first[near] - begin, weighted[second[near]], end - begin)
        begin = end
    return sums


def _share_equal(vertex: NDArray[np.int64], normals: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Keep one of equal normals at a vertex; return them, by vertex, and where each row went."""
    order = np.lexsort((normals[:, 2], normals[:, 1], normals[:, 0], vertex))
    v, n = vertex[order], normals[order]
    new = np.ones(len(order), dtype=bool)
    new[1:] = (v[1:] != v[:-1]) | (n[1:] != n[:-1]).any(axis=1)
    index = np.empty(len(order), dtype=np.int64)
    index[order] = np.cumsum(new) - 1
    return n[new], index
