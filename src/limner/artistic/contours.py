"""Suggestive contours: where a surface does not turn away yet, but would if the eye moved a little (FoCG 10.3.1).

There the curvature towards the eye passes through zero, and grows towards it.

**Source**: D. DeCarlo, A. Finkelstein, S. Rusinkiewicz and A. Santella, "Suggestive Contours for Conveying Shape", SIGGRAPH 2003;
S. Rusinkiewicz, "Estimating Curvatures and Their Derivatives on Triangle Meshes", 3DPVT 2004 (the tensor of curvature; ours is carried
from triangle to corner without a rotation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..mesh.adjacency import Adjacency
from .segments import Segments
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals
from .zeros import gradients, segments_in, zero_segments

__all__ = ["curvature_tensors", "suggestive_contours"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # of axes: a tensor of curvature is symmetric
_SMOOTHED = 3  # times that curvature is averaged with that of the neighbours
_LEAST_TURN = 0.2  # cosine between normal and ray: nearer to the silhouette there would be two lines for one
_LEAST_CHANGE = 0.5  # of curvature along the surface towards the eye, times the square of the object's extent over 10


def suggestive_contours(surfaces: Surfaces, adjacency: Adjacency, sight: SightLines, kind: int) -> Segments:
    """The zeros of the curvature in the direction of the eye, on what faces it, where the surface bends away in front of them."""
    normals = corner_normals(surfaces, adjacency, adjacency.edge_counts != 2)
    points, triangles = surfaces.points, surfaces.triangles
    at_points = np.zeros((len(points), 3))
    at_points[triangles.reshape(-1)] = normals.reshape(-1, 3)
    tensors = curvature_tensors(points, triangles, at_points)
    to_eye = sight.towards(points)
    to_eye = to_eye / np.maximum(np.linalg.norm(to_eye, axis=1), 1e-300)[:, None]
    facing = (to_eye * at_points).sum(axis=1)
    along = to_eye - facing[:, None] * at_points
    squared = np.maximum((along * along).sum(axis=1), 1e-300)
    radial = np.einsum("ni,nij,nj->n", along, tensors, along) / squared
    values = radial[triangles]
    values[~surfaces.bounded] = 1.0
    ends, rows = zero_segments(surfaces, values)
    gradient, normal = gradients(points[triangles[rows]], values[rows])
    direction = along[triangles[rows]].mean(axis=1)
    length = np.linalg.norm(direction, axis=1)
    change = (gradient * direction).sum(axis=1) / np.maximum(length, 1e-300)
    size = 0.1 * surfaces.extent
    seen = (facing[triangles[rows]].min(axis=1) > _LEAST_TURN) & ((normal * sight.towards(ends[:, 0])).sum(axis=1) > 0.0)
    kept = seen & (change * size * size > _LEAST_CHANGE)
    return segments_in(surfaces, kind, ends[kept], rows[kept], np.zeros(int(kept.sum())), np.zeros(int(kept.sum()), dtype=np.int64))


def curvature_tensors(points: Floats, triangles: Indices, normals: Floats) -> Floats:
    """How normals turn along the surface, (n, 3, 3) float64, 1/m: d . T d is the curvature in a unit direction d, positive on a sphere.

    `normals`, (n, 3), are those at the points.
    """
    corners, at = points[triangles], normals[triangles]
    sides = np.stack([corners[:, 2] - corners[:, 1], corners[:, 0] - corners[:, 2], corners[:, 1] - corners[:, 0]], axis=1)
    turns = np.stack([at[:, 2] - at[:, 1], at[:, 0] - at[:, 2], at[:, 1] - at[:, 0]], axis=1)
    across = np.cross(sides[:, 0], sides[:, 1])
    double_area = np.linalg.norm(across, axis=1)
    safe = double_area > 1e-12 * np.maximum((sides * sides).sum(axis=2).max(axis=1, initial=0.0), 1e-300)
    u = sides[:, 0] / np.maximum(np.linalg.norm(sides[:, 0], axis=1), 1e-300)[:, None]
    v = np.cross(across / np.where(safe, double_area, 1.0)[:, None], u)
    su, sv = np.einsum("mki,mi->mk", sides, u), np.einsum("mki,mi->mk", sides, v)
    tu, tv = np.einsum("mki,mi->mk", turns, u), np.einsum("mki,mi->mk", turns, v)
    # Least squares for e, f, g in [e f; f g] side = turn, of three sides.
    uu, uv, vv = (su * su).sum(axis=1), (su * sv).sum(axis=1), (sv * sv).sum(axis=1)
    one, two, three = (su * tu).sum(axis=1), (su * tv + sv * tu).sum(axis=1), (sv * tv).sum(axis=1)
    # [uu uv 0; uv uu + vv uv; 0 uv vv] (e f g) = (one two three), by Cramer's rule.
    flat = uu * vv - uv * uv
    divisor = (uu + vv) * flat
    divisor = np.where(safe & (divisor > 0.0), divisor, np.inf)
    e = (one * (flat + vv * vv) - uv * (two * vv - uv * three)) / divisor
    f = (uu * (two * vv - uv * three) - one * uv * vv) / divisor
    g = (three * (flat + uu * uu) - uv * (two * uu - uv * one)) / divisor
    columns = [e * u[:, i] * u[:, j] + f * (u[:, i] * v[:, j] + v[:, i] * u[:, j]) + g * v[:, i] * v[:, j] for i, j in _PAIRS]
    total = np.bincount(triangles.reshape(-1), np.repeat(double_area, 3), len(points))
    share = 1.0 / np.where(total > 0.0, total, 1.0)
    made = [_at_points(triangles, column * double_area, share) for column in columns]
    for _ in range(_SMOOTHED):
        made = [_at_points(triangles, at_point[triangles].sum(axis=1) * (double_area / 3.0), share) for at_point in made]
    xx, yy, zz, xy, xz, yz = made
    return np.asarray(np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3))


def _at_points(triangles: Indices, weighted: Floats, share: Floats) -> Floats:
    """Means at points of what triangles have, (m,), given times their weights; `share`, (n,), is one by the weights round a point."""
    return np.asarray(np.bincount(triangles.reshape(-1), np.repeat(weighted, 3), len(share)) * share)
