"""Normals for meshes that come without: flat per face, smooth per vertex, and smooth up to creases (FoCG 10.1.3, 12.1).

A vertex normal is the mean of the normals of the faces around it, each weighted by the face's angle there, so that it does not
depend on how the surface was cut into triangles. Across an edge that is meant to be sharp no mean should be taken: each corner
averages only those faces whose normals lie within the crease angle of its own face's. Sums run in the order of the triangles,
whatever the path, so the same mesh gets the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["DEGENERATE", "Columns", "are_degenerate", "crease_normals", "face_normals", "inner", "triangle_vectors", "vertex_normals"]

Floats = NDArray[np.float64]
Columns: TypeAlias = tuple[Floats, Floats, Floats]

# A triangle whose area falls below this share of its longest edge's square has no direction worth averaging.
DEGENERATE = 1e-12
# Faces that differ by just the crease angle belong together in spite of rounding.
_ANGLE_SLACK = 1e-6
# Pairs of faces around creased vertices that are compared at a time: bounds the memory where thousands of faces meet.
_PAIRS_AT_ONCE = 1 << 22
_ANY_NORMAL = (0.0, 0.0, 1.0)
# Triangles at a time that stay in the cache from one step to the next.
_BLOCK = 1 << 14

Weights: TypeAlias = Literal["angle", "area"]



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
    return np.stack(_faces(*_arrays(positions, triangles))[0], axis=1)


def vertex_normals(positions: ArrayLike, triangles: ArrayLike, weights: Weights = "angle") -> NDArray[np.float32]:
    """Compute one smooth normal per vertex: the weighted mean of the faces around it.

    Parameters
    ----------
    positions : (n, 3) float
    triangles : (m, 3) int
    weights : "angle" | "area"
        What each face counts: its angle at the vertex, so that the normal does not depend on how the surface is cut into triangles; or
        its area, which favours what is large and flat.

    Returns
    -------
    (n, 3) float32
        Unit; +z where no face, or faces that cancel, meet.

    **Source**: Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets", *Journal of Graphics Tools* 3(1), 1998.
    """
    if weights not in get_args(Weights):
        raise SceneError(f'weights must be "angle" or "area", got {weights!r}')
    points, corners = _arrays(positions, triangles)
    normal, angles = _faces(points, corners)
    if weights == "area":
        across = triangle_vectors(points, corners)[3]
        angles = np.where(angles > 0.0, np.sqrt(inner(across, across))[:, None], 0.0)
    return _means(corners, normal, angles, len(points)).astype(np.float32)


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
    normal, angles = _faces(points, corners)
    vertex = corners.reshape(-1)
    means = _means(corners, normal, angles, len(points))
    creased = _creased_vertices(corners, normal, means, crease_degrees)
    picked = np.flatnonzero(creased[vertex]) if creased.any() else np.zeros(0, dtype=np.int64)
    own = np.stack([part[picked // 3] for part in normal], axis=1)
    known = own.any(axis=1)
    picked, own = picked[known], own[known]
    if not len(picked):
        return means.astype(np.float32), corners.astype(np.int32)
    weighted = angles.reshape(-1)[picked, None] * own
    split = _unit(_sum_over_crease(vertex[picked], own, weighted, crease_degrees)).astype(np.float32)
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


def _faces(points: Floats, corners: NDArray[np.int64]) -> tuple[Columns, Floats]:
    """Unit normals, as three columns (m,), and (m, 3) angles of the corners; both zero for degenerate triangles."""
    n_faces = len(corners)
    normal, angles = (np.empty(n_faces), np.empty(n_faces), np.empty(n_faces)), np.empty((n_faces, 3))
    for start in range(0, n_faces, _BLOCK):
        part = slice(start, start + _BLOCK)
        own = points.take(corners[part].reshape(-1), axis=0)
        x, y, z = normal
        _fill_faces(own, np.arange(len(own)).reshape(-1, 3), (x[part], y[part], z[part]), angles[part])
    return normal, angles


def _fill_faces(points: Floats, corners: NDArray[np.int64], normal: Columns, angles: Floats) -> None:
    e, f, g, across = triangle_vectors(points, corners)
    double_area = np.sqrt(inner(across, across))
    valid = double_area > DEGENERATE * _longest(e, f, g)
    scale = np.where(valid, 1.0 / np.where(valid, double_area, 1.0), 0.0)
    # atan2(|cross|, dot) keeps its digits where the arc cosine loses them; |cross| is the double area at every corner.
    for corner, (ahead, behind) in enumerate(((e, g), (f, e), (g, f))):
        angles[:, corner] = np.arctan2(double_area, -inner(ahead, behind))
    if not valid.all():
        angles[~valid] = 0.0
    for column, part in zip(normal, across, strict=True):
        # + 0.0 turns -0.0 into 0.0, so that equal normals have equal bits.
        column[:] = part * scale + 0.0


def _means(corners: NDArray[np.int64], normal: Columns, angles: Floats, count: int) -> Floats:
    """(count, 3): the unit mean of the normals around each vertex, weighted by their angles there, summed in their order."""
    vertex = corners.reshape(-1)
    weights = ((angles * part[:, None]).reshape(-1) for part in normal)
    sums = [np.asarray(np.bincount(vertex, weights=weight, minlength=count), dtype=np.float64) for weight in weights]
    return np.stack(_unit_columns(sums), axis=1)


def triangle_vectors(points: Floats, corners: NDArray[Any]) -> tuple[Columns, Columns, Columns, Columns]:
    """The sides of triangles from corner to corner, and the cross product of the first two: three columns (m,) float64 each.

    Columns are read and written in one go, where rows of three would be picked apart.
    """
    x, y, z = np.ascontiguousarray(points.T)
    i, j, k = np.ascontiguousarray(corners.T)
    a, b, c = ((x[v], y[v], z[v]) for v in (i, j, k))
    e, f, g = _minus(b, a), _minus(c, b), _minus(a, c)
    back = (-g[0], -g[1], -g[2])
    normal = (e[1] * back[2] - e[2] * back[1], e[2] * back[0] - e[0] * back[2], e[0] * back[1] - e[1] * back[0])
    return e, f, g, normal


def are_degenerate(points: Floats, corners: NDArray[Any]) -> NDArray[np.bool_]:
    """(m,) bool: which triangles have no area worth a direction."""
    e, f, g, normal = triangle_vectors(points, corners)
    return np.asarray(~(np.sqrt(inner(normal, normal)) > DEGENERATE * _longest(e, f, g)))


def _minus(p: Columns, q: Columns) -> Columns:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def inner(p: Columns, q: Columns) -> Floats:
    """The inner products of two vectors in columns, (m,)."""
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def _longest(e: Columns, f: Columns, g: Columns) -> Floats:
    """The square of the longest side."""
    return np.maximum(np.maximum(inner(e, e), inner(f, f)), inner(g, g))


def _unit_columns(vectors: Sequence[Floats]) -> Columns:
    x, y, z = vectors
    length = np.sqrt(inner((x, y, z), (x, y, z)))
    # Opposite faces cancel but for rounding; what is left is no direction.
    known = length > 1e-9
    scale = np.where(known, length, 1.0)
    x, y, z = (np.where(known, part / scale, any_part) for part, any_part in zip((x, y, z), _ANY_NORMAL, strict=True))
    return x, y, z


def _dot(p: Floats, q: Floats) -> Floats:
    return p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1] + p[:, 2] * q[:, 2]


def _sum_by(index: NDArray[np.int64], values: Floats, count: int) -> Floats:
    """Sum rows with the same index, in their order."""
    return np.stack([np.bincount(index, weights=values[:, axis], minlength=count) for axis in range(3)], axis=1)


def _unit(vectors: Floats) -> Floats:
    x, y, z = np.ascontiguousarray(vectors.T)
    return np.stack(_unit_columns((x, y, z)), axis=1)


def _creased_vertices(corners: NDArray[np.int64], normal: Columns, means: Floats, crease_degrees: float) -> NDArray[np.bool_]:
    """Mark the vertices whose faces may differ by more than the crease angle.

    Faces within half the angle of their mean are within the angle of each other: those vertices, nearly all of a smooth mesh,
    need no pairs.
    """
    half = math.cos(math.radians(crease_degrees) / 2.0) - _ANGLE_SLACK
    marked = np.zeros(len(means), dtype=bool)
    for start in range(0, len(corners) if crease_degrees < 180.0 else 0, _BLOCK):
        part = slice(start, start + _BLOCK)
        x, y, z = (column[part] for column in normal)
        known = (x != 0.0) | (y != 0.0) | (z != 0.0)
        for vertex in corners[part].T:
            mean = means.take(vertex, axis=0)
            stray = (inner((x, y, z), (mean[:, 0], mean[:, 1], mean[:, 2])) < half) & known
            marked[vertex[stray]] = True
    return marked


def _sum_over_crease(vertex: NDArray[np.int64], own: Floats, weighted: Floats, crease_degrees: float) -> Floats:
    """For each corner, given with its vertex, sum the weighted normals of the corners of its vertex within the crease angle."""
    least = math.cos(math.radians(crease_degrees)) - _ANGLE_SLACK
    order = np.argsort(vertex, kind="stable")
    _, start, count = np.unique(vertex[order], return_index=True, return_counts=True)
    group_start, group_count = np.repeat(start, count), np.repeat(count, count)
    ends = np.cumsum(group_count)
    sums = np.empty((len(vertex), 3))
    begin = 0
    while begin < len(vertex):
        done = ends[begin - 1] if begin else 0
        end = max(int(np.searchsorted(ends, done + _PAIRS_AT_ONCE, side="right")), begin + 1)
        first = np.repeat(np.arange(begin, end), group_count[begin:end])
        offset = np.arange(len(first)) - np.repeat(ends[begin:end] - group_count[begin:end] - done, group_count[begin:end])
        second = order[group_start[first] + offset]
        near = _dot(own[order[first]], own[second]) >= least
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
