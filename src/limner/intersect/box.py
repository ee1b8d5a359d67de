"""Ray and axis-aligned box (FoCG 12.3.1): the slab test, as hierarchies need it."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import max, min
from ..kernel.vec import Vec3

__all__ = ["meet_box", "moved_on"]

f32 = np.float32
_ERROR = f32(2.0**-20)


@kernel
def meet_box(near: Vec3, far: Vec3, o: Vec3, inverse: Vec3, t_min: np.float32, t_max: np.float32, slack: np.float32):
    """Where the ray enters and leaves a box, or one ray eight boxes; where it leaves before it enters, it misses.

    `near` and `far`: the box's planes across x, y and z that the ray meets first and last: the low and the high corner where the
    direction is positive. `inverse` is 1/d by component, infinite for a ray along a slab. On a slab's very plane 0 times infinity is
    NaN, and counts as inside: `max` and `min` keep their first argument where the second is NaN. The far end, `t_max` among it, is
    moved on by the error of all that is compared here (Ize, *Robust BVH ray traversal*, 2013), so that a hit on the box's face is never
    lost; `slack` is added to it.
    """
    enter = max(t_min, (near.x - o.x) * inverse.x)
    enter = max(enter, (near.y - o.y) * inverse.y)
    enter = max(enter, (near.z - o.z) * inverse.z)
    leave = min(t_max, (far.x - o.x) * inverse.x)
    leave = min(leave, (far.y - o.y) * inverse.y)
    leave = min(leave, (far.z - o.z) * inverse.z)
    return enter, moved_on(leave, slack)


@kernel
def moved_on(t: np.float32, slack: np.float32) -> np.float32:
    """A little more than t: what lies no farther up to rounding counts as before it."""
    return t + abs(t) * _ERROR + slack
