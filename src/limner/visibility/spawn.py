"""Where a new ray starts: off the surface that it leaves, at any scale.

A hit is rounded, so the point may lie a little below its surface, and a ray from there would hit it again. Points are interpolated
from vertices, not followed along the ray, so they err by a few units in the last place of the largest number that they were computed
from: a vertex, or the way from object to world, not the point itself, which may lie at the origin (Wächter and Binder, *A fast and
robust method for avoiding self-intersection*, Ray Tracing Gems, 2019, ch. 6, measure by the point). The point is pushed along the
normal by 64 of these units.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import Vec3
from ..shading.surface import SurfacePoint

__all__ = ["off_surface", "pushed"]

_PUSH = np.float32(2.0**-18)


@kernel
def pushed(position: Vec3, n: Vec3, reach: np.float32) -> Vec3:
    """`off_surface` of a point, or of eight, that was computed from numbers up to `reach`."""
    return position + n * (_PUSH * reach)


@kernel
def off_surface(point: SurfacePoint, n: Vec3) -> Vec3:
    """A place just off the surface, on the side to which n points."""
    return pushed(point.position, n, point.reach)
