"""The boxes of exact shapes in the world."""

from __future__ import annotations

from .._jit import kernel
from ..intersect.layouts import CSG, MESH
from ..intersect.shape import shape_bounds

__all__ = ["bound_shapes"]


@kernel
def bound_shapes(instances, numbers, boxes):
    """Fill boxes (n, 6), low and high corner, for all rows that are exact shapes; those of combinations are left to the caller."""
    for k in range(instances.shape[0]):
        if instances[k]["kind"] != MESH and instances[k]["kind"] != CSG:
            low, high = shape_bounds(instances[k], numbers)
            boxes[k, 0], boxes[k, 1], boxes[k, 2] = low.x, low.y, low.z
            boxes[k, 3], boxes[k, 4], boxes[k, 5] = high.x, high.y, high.z
