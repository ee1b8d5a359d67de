"""The grain of a surface, and the surface without it.

What is scanned is rough in every triangle: its normals stagger about those of the form that one sees. Averaged with their neighbours they
become that form's, and by how much they change tells how rough it is. A form that is designed has no grain. Its normals may change quickly,
at a fillet beside a plane, and averages would only blur it. The two are told apart by how much neighbours differ, before and after: of a
grain that becomes less, of a form it stays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..mesh.adjacency import Adjacency
from ..mesh.normals import inner, triangle_vectors
from .surfaces import Surfaces, smooth_groups

__all__ = ["without_grain"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROUNDS = 2
_FLAT = 1e-6  # that normals differ on the mean, where a shape is not flat
_EVEN, _MIXED = 0.91, 0.03  # of how much averages of normals differ from one place to the next, to how much normals do
_RIM = 0.2  # between unit normals: what changes by more is no grain, but the rim of something thin
_SPLIT = 1e-3  # between unit normals that are not one

_average_normals = Door(
    "limner.artistic.grain_kernel",
    "average_normals",
    (
        Array(np.int64, 2), Array(np.int64, 1), Array(np.float64, 1), Array(np.float64, 3), Scalar(np.int64), Scalar(np.float64),
        Scalar(np.float64), Array(np.float64, 2), Array(np.float64, 2), Array(np.float64, 2), Array(np.float64, 1), Array(np.float64, 1),
        Array(np.int64, 1), Array(np.float64, 1), Array(np.float64, 1),
    ),
    "the grain of surfaces",
)  # fmt: skip
_take_averages = Door(
    "limner.artistic.grain_kernel",
    "take_averages",
    (
        Array(np.int64, 2), Array(np.int64, 1), Array(np.float64, 1), Array(np.float64, 2), Array(np.float64, 1), Array(np.int64, 1),
        Array(np.float64, 3), Array(np.float64, 2),
    ),
    "surfaces without grain",
)  # fmt: skip


def without_grain(surfaces: Surfaces, adjacency: Adjacency, sharp: NDArray[np.bool_], normals: Floats) -> tuple[Floats, Floats]:
    """Take the grain out of the normals at corners, (m, 3, 3) float64, unit, which are changed.

    Returns
    -------
    (m, 3, 3) float64
        The same array. Where a mesh has several normals in one place, which is meant, and at rims, they stay; exact shapes have no grain.
    (m, 3) float64
        How rough the surface is at the corners: the sine of the mean angle by which normals changed, thereabouts.
    """
    noise = np.zeros(normals.shape[:2])
    if surfaces.exact.all():
        return normals, noise
    groups = smooth_groups(adjacency, sharp)
    across = triangle_vectors(surfaces.points, surfaces.triangles)[3]
    area = np.where(surfaces.exact, 0.0, np.sqrt(inner(across, across)))
    instance, count, n = surfaces.instance.astype(np.int64), int(groups.max()) + 1, len(surfaces.shapes)
    own, mean, total = (np.zeros((count, 3)) for _ in range(3))
    weight, change, kept = np.zeros(count), np.zeros(count), np.zeros(count, dtype=np.int64)
    before, after = np.zeros(n), np.zeros(n)
    _average_normals(
        groups, instance, area, normals, _ROUNDS, _SPLIT, _RIM, own, mean, total, weight, change, kept, before, after
    )  # fmt: skip
    left = after / np.where(before > 0.0, before, 1.0)
    curved = before > _FLAT * np.bincount(instance, area, n)
    share = np.where(curved, np.clip((_EVEN - left) / _MIXED, 0.0, 1.0), 0.0)
    if share.any():
        _take_averages(groups, instance, share, mean, change, kept, normals, noise)
    return normals, noise
