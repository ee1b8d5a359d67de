"""Where a new ray starts: off the surface that it leaves, at any scale.

A hit is rounded, so the point may lie a little below its surface, and a ray from there would hit it again. Points are interpolated
from vertices, not followed along the ray, so they err by a few units in the last place of their *largest* coordinate (Wächter and
Binder, *A fast and robust method for avoiding self-intersection*, Ray Tracing Gems, 2019, ch. 6); the point is pushed along the normal
by 64 of these.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import Vec3

__all__ = ["off_surface"]

_PUSH = np.float32(2.0**-18)


@kernel
def off_surface(p: Vec3, n: Vec3) -> Vec3:
    """A point just off the surface, on the side to which n points."""
    return p + n * (_PUSH * max(abs(p.x), max(abs(p.y), abs(p.z))))
