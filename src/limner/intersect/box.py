"""Ray and axis-aligned box (FoCG 12.3.1): the slab test, as hierarchies need it."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO, Vec3

__all__ = ["enter_box", "moved_on"]

f32 = np.float32
_INFINITY = f32(np.inf)
_ERROR = f32(2.0**-20)


@kernel
def enter_box(box, place: int, o: Vec3, inverse: Vec3, t_min: np.float32, t_max: np.float32) -> np.float32:
    """Where the ray enters the box (low x, y, z, high x, y, z) at box[place : place + 6], or infinity.

    `inverse` is 1/d by component, infinite for a ray along a slab; its sign tells which side of a slab is met first. On a slab's very
    plane 0 times infinity is NaN, and counts as inside: `max` and `min` keep their first argument where the second is NaN. The far
    end, `t_max` among it, is moved on by the error of all that is compared here (Ize, *Robust BVH ray traversal*, 2013), so that a hit
    on the box's face is never lost.
    """
    x = place + 3 if inverse.x < ZERO else place
    y = place + 4 if inverse.y < ZERO else place + 1
    z = place + 5 if inverse.z < ZERO else place + 2
    opposite = 2 * place + 3
    enter = max(t_min, (box[x] - o.x) * inverse.x)
    enter = max(enter, (box[y] - o.y) * inverse.y)
    enter = max(enter, (box[z] - o.z) * inverse.z)
    leave = min(t_max, (box[opposite - x] - o.x) * inverse.x)
    leave = min(leave, (box[opposite + 2 - y] - o.y) * inverse.y)
    leave = min(leave, (box[opposite + 4 - z] - o.z) * inverse.z)
    return enter if enter <= moved_on(leave) else _INFINITY


@kernel
def moved_on(t: np.float32) -> np.float32:
    """A little more than t: what lies no farther up to rounding counts as before it."""
    return t + abs(t) * _ERROR
