"""Ray and axis-aligned box (FoCG 12.3.1): the slab test, as hierarchies need it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.lanes import max, min, where
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = ["Slabs", "meet_box", "meet_slabs", "moved_on", "slabs_of"]

f32 = np.float32
_ERROR = f32(2.0**-20)
_PLACE_ERROR = f32(2.0**-22)


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


class Slabs(NamedTuple):
    """A ray as many boxes want it: what `meet_box` does for each of them is done once for the ray.

    o, inverse: where it begins, and 1/d by component. o_far, inverse_far: the same for the planes that it meets last, so much farther back,
    and so much longer, that these are met later by more than all errors together.
    """

    o: Vec3
    inverse: Vec3
    o_far: Vec3
    inverse_far: Vec3


@kernel
def _stepped_back(o: np.float32, d: np.float32, inverse: np.float32, slack: np.float32) -> np.float32:
    step = slack * abs(d) + abs(o) * _PLACE_ERROR
    return where(inverse < ZERO, o + step, o - step)


@kernel
def slabs_of(o: Vec3, d: Vec3, inverse: Vec3, slack: np.float32) -> Slabs:
    """The ray, or eight, as `meet_slabs` wants it; `inverse` and `slack` are those of `meet_box`."""
    x, y = _stepped_back(o.x, d.x, inverse.x, slack), _stepped_back(o.y, d.y, inverse.y, slack)
    z = _stepped_back(o.z, d.z, inverse.z, slack)
    return Slabs(o, inverse, Vec3(x, y, z), inverse * (ONE + _ERROR))


@kernel
def meet_slabs(near: Vec3, far: Vec3, ray: Slabs, t_min: np.float32, t_max: np.float32):
    """Where the ray enters and leaves a box, or eight, as of `meet_box`; `t_max` has been moved on already."""
    x, y, z = (near.x - ray.o.x) * ray.inverse.x, (near.y - ray.o.y) * ray.inverse.y, (near.z - ray.o.z) * ray.inverse.z
    enter = max(max(t_min, x), max(y, z))
    x, y = (far.x - ray.o_far.x) * ray.inverse_far.x, (far.y - ray.o_far.y) * ray.inverse_far.y
    z = (far.z - ray.o_far.z) * ray.inverse_far.z
    return enter, min(min(t_max, x), min(y, z))
