"""Ray and axis-aligned box (FoCG 12.3.1): the slab test, as hierarchies need it."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import Vec3

__all__ = ["enter_box"]

f32 = np.float32
_INFINITY = f32(np.inf)
_WIDEN = f32(1.0 + 4.0 * 2.0**-24)


@kernel
def enter_box(box, place: int, o: Vec3, inverse: Vec3, t_min: np.float32, t_max: np.float32) -> np.float32:
    """Where the ray enters the box (low x, y, z, high x, y, z) at box[place : place + 6], or infinity.

    `inverse` is 1/d by component, infinite for a ray along a slab. The minima and maxima are ordered so that the NaN of 0 times
    infinity, on a slab's very plane, counts as inside; the far end is widened by the error of its computation (Ize, *Robust BVH ray
    traversal*, 2013), so that a hit on the box's face is never lost.
    """
    x0, x1 = (box[place] - o.x) * inverse.x, (box[place + 3] - o.x) * inverse.x
    y0, y1 = (box[place + 1] - o.y) * inverse.y, (box[place + 4] - o.y) * inverse.y
    z0, z1 = (box[place + 2] - o.z) * inverse.z, (box[place + 5] - o.z) * inverse.z
    enter = max(max(max(t_min, min(x1, x0)), min(y1, y0)), min(z1, z0))
    leave = min(min(min(t_max, max(x1, x0) * _WIDEN), max(y1, y0) * _WIDEN), max(z1, z0) * _WIDEN)
    return enter if enter <= leave else _INFINITY
