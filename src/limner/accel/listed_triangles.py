"""What grid, BSP and volume tree share: a ray, and the triangles that one of their cells or leaves lists.

Each of them says where to look, and in which order; what is there is a list of triangles, which are met one by one. They stand in world
space, (n, 9) float32. Of triangles at the very same t the one with the least row is the hit, so that every structure finds the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..intersect.triangle import hit_triangle
from ..kernel.vec import ZERO, Vec3

__all__ = ["Found", "insert_hit", "nearest_listed", "nothing_before", "slack_of", "span_within", "triangle_hit"]

f32, f64 = np.float32, np.float64
_ERROR = f32(2.0**-21)
_NONE = f64(0.0)


class Found(NamedTuple):
    """The nearest triangle so far.

    t: the ray's parameter, or where the search ends. row: of the corners; -1: nothing. u, v: barycentrics.
    """

    t: np.float32
    row: int
    u: np.float32
    v: np.float32


@kernel
def nothing_before(t_max: np.float32) -> Found:
    """Nothing is found, and nothing counts from t_max on."""
    return Found(t_max, -1, ZERO, ZERO)


@kernel
def triangle_hit(corners, row: int, ray, t_min: np.float32, t_max: np.float32):
    """The hit of one triangle within (t_min, t_max)."""
    a = Vec3(corners[row, ray.kx], corners[row, ray.ky], corners[row, ray.kz])
    b = Vec3(corners[row, 3 + ray.kx], corners[row, 3 + ray.ky], corners[row, 3 + ray.kz])
    c = Vec3(corners[row, 6 + ray.kx], corners[row, 6 + ray.ky], corners[row, 6 + ray.kz])
    return hit_triangle(ray, a, b, c, t_min, t_max)


@kernel
def nearest_listed(items, first: int, last: int, corners, ray, t_min: np.float32, t_max: np.float32, best: Found, tally) -> Found:
    """The nearer of `best` and the triangles items[first:last]; tally[1] counts them."""
    tally[1] += last - first
    for k in range(first, last):
        row = np.int64(items[k])
        h = triangle_hit(corners, row, ray, t_min, t_max)
        if h.t < best.t or (h.t == best.t and row < best.row):
            best = Found(h.t, row, h.u, h.v)
    return best


@kernel
def slack_of(bounds, ray) -> np.float32:
    """By how much the t of a hit may be off: it is a mean of its vertices' t, so its error is one of the greatest of them, not its own.

    `bounds` (2, 3): the low and the high corner of all triangles. What is left at t may hide a nearer hit up to t + slack.
    """
    farthest = max(abs(f32(bounds[0, ray.kz]) - ray.oz), abs(f32(bounds[1, ray.kz]) - ray.oz))
    return farthest * abs(ray.sz) * _ERROR


@kernel
def span_within(bounds, o, d, enter: np.float64, leave: np.float64):
    """Where the ray enters and leaves the box of `bounds` (2, 3), within (enter, leave); it misses where it leaves before it enters.

    `o` and `d` are three float64 each. Along a slab, a ray is in it or it is not.
    """
    for axis in range(3):
        low, high = bounds[0, axis], bounds[1, axis]
        if d[axis] == _NONE:
            if not (low <= o[axis] and o[axis] <= high):
                leave = -np.inf
        else:
            a, b = (low - o[axis]) / d[axis], (high - o[axis]) / d[axis]
            enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    return enter, leave


@kernel
def insert_hit(hit_t: np.float32, which: int, hit_u: np.float32, hit_v: np.float32, t, row, u, v, start: int, end: int):
    """Put a hit among those of start..end, which are in order: by t, of equal ones by row."""
    k = end
    while k > start and (t[k - 1] > hit_t or (t[k - 1] == hit_t and row[k - 1] > which)):
        t[k], row[k], u[k], v[k] = t[k - 1], row[k - 1], u[k - 1], v[k - 1]
        k -= 1
    t[k], row[k], u[k], v[k] = hit_t, which, hit_u, hit_v
