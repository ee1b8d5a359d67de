"""Ray and plane."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import where
from ..kernel.vec import Vec3

__all__ = ["intersect_plane"]

_INFINITY = np.float32(np.inf)


@kernel
def intersect_plane(o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32) -> np.float32:
    """The t in (t_min, t_max) at which the ray meets y = 0; a parallel ray misses."""
    t = -o.y / d.y
    return where((t_min < t) & (t < t_max), t, _INFINITY)
