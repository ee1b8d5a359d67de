"""Many rays through one tree of triangles: the loops behind `accel.batch`.

Eight neighbours that go nearly the same way are traced together (`bundle`), all others one by one.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO
from .bundle import HIT_T, HIT_TRIANGLE, HIT_U, HIT_V, is_bundle, meet_bundle, put_ray
from .near_ray import near_ray
from .walk import nearest, occluded

__all__ = ["intersect_batch", "occluded_batch"]

f32, f64 = np.float32, np.float64
_ALIKE = f64(0.05)


@kernel
def _look_alike(directions, k: int) -> bool:
    """Whether it is worth asking if eight rays are a bundle: the first and the last of them go the same way."""
    d0, d1, d2 = directions[k, 0], directions[k, 1], directions[k, 2]
    most = _ALIKE * max(max(abs(d0), abs(d1)), abs(d2))
    return (
        abs(directions[k + 7, 0] - d0) <= most and abs(directions[k + 7, 1] - d1) <= most and abs(directions[k + 7, 2] - d2) <= most
    )


@kernel
def _gathered(origins, directions, t_max, k: int, frame, numbers, integers, places) -> bool:
    """Write rays k to k + 7 as a bundle, if they are one; `places` (16,): where each starts, and its length."""
    if not _look_alike(directions, k):
        return False
    for i in range(8):
        ray = near_ray(origins, directions, k + i, frame)
        end = f32(t_max[k + i] * ray.length - ray.start)
        if not (ray.sound and end > ZERO):
            return False
        put_ray(numbers, integers, i, ray.o, ray.d, end)
        places[i], places[8 + i] = ray.start, ray.length
    return is_bundle(numbers, f32(frame[7]))


@kernel
def intersect_batch(
    nodes, packs, tags, primitives, planes, instances, frame, origins, directions, t_max, t, triangle, uv, first, stack, numbers, integers,
    places,
):  # fmt: skip
    """Fill t, triangle and uv from row `first` with the nearest hits of the rays (n, 3), each within (0, t_max).

    numbers, integers, places: scratch of BUNDLE_NUMBERS, BUNDLE_INTEGERS and 16.
    """
    accelerator = (nodes, packs, tags, primitives, planes, None)
    n = origins.shape[0]
    for begin in range(0, n, 8):
        is_one = begin + 8 <= n and nodes.shape[0] > 0
        if is_one and _gathered(origins, directions, t_max, begin, frame, numbers, integers, places):
            meet_bundle(accelerator, numbers, integers, stack, False)
            for i in range(8):
                row, found = first + begin + i, integers[HIT_TRIANGLE + i]
                t[row], triangle[row], uv[0, row], uv[1, row] = f32(np.inf), found, ZERO, ZERO
                if found >= 0:
                    t[row] = f32((places[i] + f64(numbers[HIT_T + i])) / places[8 + i])
                    uv[0, row], uv[1, row] = numbers[HIT_U + i], numbers[HIT_V + i]
            continue
        for k in range(begin, min(begin + 8, n)):
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
def occluded_batch(
    nodes, packs, tags, primitives, planes, instances, frame, origins, directions, t_max, dark, first, stack, numbers, integers, places
):
    """Fill `dark` (uint8) from row `first`: whether anything lies within (0, t_max) of each ray."""
    accelerator = (nodes, packs, tags, primitives, planes, None)
    n = origins.shape[0]
    for begin in range(0, n, 8):
        is_one = begin + 8 <= n and nodes.shape[0] > 0
        if is_one and _gathered(origins, directions, t_max, begin, frame, numbers, integers, places):
            meet_bundle(accelerator, numbers, integers, stack, True)
            for i in range(8):
                dark[first + begin + i] = 1 if numbers[HIT_T + i] < ZERO else 0
            continue
        for k in range(begin, min(begin + 8, n)):
            dark[first + k] = 0
            ray = near_ray(origins, directions, k, frame)
            end = f32(t_max[k] * ray.length - ray.start)
            if ray.sound and end > ZERO and occluded(accelerator, instances, ray.o, ray.d, ZERO, end, stack):
                dark[first + k] = 1
