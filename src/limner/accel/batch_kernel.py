"""Many rays through one tree of triangles: the loops behind `accel.batch`."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO
from .near_ray import near_ray
from .walk import nearest, occluded

__all__ = ["intersect_batch", "occluded_batch"]

f32, f64 = np.float32, np.float64


@kernel
def intersect_batch(nodes, packs, tags, primitives, planes, instances, frame, origins, directions, t_max, t, triangle, uv, first, stack):
    """Fill t, triangle and uv from row `first` with the nearest hits of the rays (n, 3), each within (0, t_max)."""
    accelerator = (nodes, packs, tags, primitives, planes, None)
    for k in range(origins.shape[0]):
        row = first + k
        t[row], triangle[row], uv[0, row], uv[1, row] = f32(np.inf), -1, ZERO, ZERO
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        if ray.sound and end > ZERO:
            hit = nearest(accelerator, instances, ray.o, ray.d, ZERO, end, stack)
            if hit.instance >= 0:
                t[row], triangle[row] = f32((ray.start + f64(hit.t)) / ray.length), hit.triangle
                uv[0, row], uv[1, row] = hit.u, hit.v


@kernel
def occluded_batch(nodes, packs, tags, primitives, planes, instances, frame, origins, directions, t_max, dark, first, stack):
    """Fill `dark` (uint8) from row `first`: whether anything lies within (0, t_max) of each ray."""
    accelerator = (nodes, packs, tags, primitives, planes, None)
    for k in range(origins.shape[0]):
        dark[first + k] = 0
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        if ray.sound and end > ZERO and occluded(accelerator, instances, ray.o, ray.d, ZERO, end, stack):
            dark[first + k] = 1
