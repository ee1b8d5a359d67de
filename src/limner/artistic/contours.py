"""Suggestive contours: where a surface does not turn away yet, but would if the eye moved a little (FoCG 10.3.1).

There the curvature towards the eye passes through zero, and grows towards it.

**Source**: D. DeCarlo, A. Finkelstein, S. Rusinkiewicz and A. Santella, "Suggestive Contours for Conveying Shape", SIGGRAPH 2003;
S. Rusinkiewicz, "Estimating Curvatures and Their Derivatives on Triangle Meshes", 3DPVT 2004 (the tensor of curvature; ours is carried
from triangle to corner without a rotation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..mesh.adjacency import Adjacency
from .segments import Segments
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals
from .zeros import gradients, segments_in, zero_segments

__all__ = ["curvature_tensors", "suggestive_contours"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_SMOOTHED = 3  # times that curvature is averaged with that of the neighbours
_LEAST_TURN = 0.2  # cosine between normal and ray: nearer to the silhouette there would be two lines for one
_LEAST_CHANGE = 0.5  # of curvature along the surface towards the eye, times the square of the object's extent over 10

_curve = Door(
    "limner.artistic.contours_kernel",
    "curve",
    (
        Array(np.float64, 2), Array(np.int64, 2), Array(np.float64, 2), Scalar(np.int64), Array(np.float64, 1), Array(np.float64, 1),
        Array(np.float64, 2), Array(np.float64, 2),
    ),
    "how surfaces are curved",
)  # fmt: skip
_bend_towards = Door(
    "limner.artistic.contours_kernel",
    "bend_towards",
    (
        Array(np.float64, 2), Array(np.float64, 2), Array(np.float64, 2), Array(np.float64, 1), Scalar(np.int64), Array(np.float64, 2),
        Array(np.float64, 1), Array(np.float64, 1),
    ),
    "how surfaces bend towards the eye",
)  # fmt: skip


def suggestive_contours(surfaces: Surfaces, adjacency: Adjacency, sight: SightLines, kind: int) -> Segments:
    """The zeros of the curvature in the direction of the eye, on what faces it, where the surface bends away in front of them."""
    normals = corner_normals(surfaces, adjacency, adjacency.edge_counts != 2)
    points, triangles = surfaces.points, surfaces.triangles
    at_points = np.zeros((len(points), 3))
    at_points[triangles.reshape(-1)] = normals.reshape(-1, 3)
    tensors, n = _tensors(points, triangles, at_points), len(points)
    along, facing, radial = np.empty((n, 3)), np.empty(n), np.empty(n)
    eye = np.ascontiguousarray(sight.eye if sight.perspective else sight.back)
    _bend_towards(points, at_points, tensors, eye, int(sight.perspective), along, facing, radial)
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
    xx, yy, zz, xy, xz, yz = _tensors(points, triangles, normals).T
    return np.asarray(np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3))


def _tensors(points: Floats, triangles: Indices, normals: Floats) -> Floats:
    n = len(points)
    made = np.zeros((n, 6))
    _curve(
        np.ascontiguousarray(points, dtype=np.float64), np.ascontiguousarray(triangles, dtype=np.int64),
        np.ascontiguousarray(normals, dtype=np.float64), _SMOOTHED, np.zeros(len(triangles)), np.zeros(n), made, np.zeros((n, 6)),
    )  # fmt: skip
    return made
