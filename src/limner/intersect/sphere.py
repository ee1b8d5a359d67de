"""Ray and sphere (FoCG 4.4.1)."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import sqrt
from ..kernel.lanes import where
from ..kernel.vec import ZERO, Vec3, dot

__all__ = ["intersect_sphere"]

f32 = np.float32
_INFINITY = f32(np.inf)


@kernel
def intersect_sphere(o: Vec3, d: Vec3, radius: np.float32, t_min: np.float32, t_max: np.float32) -> np.float32:
    """The least t in (t_min, t_max) with |o + t d| = radius; d of any length.

    The discriminant is taken from the ray's closest point to the centre, which keeps its digits for a small sphere far away
    (Haines et al., *Precision improvements for ray/sphere intersection*, Ray Tracing Gems, 2019).
    """
    a = dot(d, d)
    t_closest = -dot(o, d) / a
    closest = o + d * t_closest
    squared = radius * radius - dot(closest, closest)
    meets = squared >= ZERO
    half = sqrt(where(meets, squared, ZERO) / a)
    near, far = t_closest - half, t_closest + half
    t = where((t_min < near) & (near < t_max), near, where((t_min < far) & (far < t_max), far, _INFINITY))
    return where(meets, t, _INFINITY)
