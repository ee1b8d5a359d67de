"""Clipping in homogeneous coordinates (FoCG 8.1.3, 8.1.5, 8.1.6): a polygon against one plane after the other.

Only what must be clipped is: the near plane, because behind the eye there is no picture, and a guard band far outside the
picture, because the edge functions' integers have an end. All else the fill stage leaves out by not visiting it. A plane is a
function of a vertex (x w, y w, depth, w), positive inside; where it changes its sign the edge is cut at ``t = f(a) / (f(a) - f(b))``.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from .layouts import GUARD_BAND

__all__ = ["clip_polygon", "inside_all"]

f32 = np.float32
NEAR, LEFT, RIGHT, BOTTOM, TOP = 0, 1, 2, 3, 4
_PLANES = 5


@kernel
def _signed_distance(plane: int, x: np.float32, y: np.float32, depth: np.float32, w: np.float32, near: np.float32) -> np.float32:
    """Positive on the inner side of a clipping plane."""
    if plane == NEAR:
        return depth - near
    if plane == LEFT:
        return x + GUARD_BAND * w
    if plane == RIGHT:
        return GUARD_BAND * w - x
    if plane == BOTTOM:
        return y + GUARD_BAND * w
    return GUARD_BAND * w - y


@kernel
def inside_all(vertex, near: np.float32) -> bool:
    """Whether a vertex needs no clipping."""
    x, y, depth, w = vertex[0], vertex[1], vertex[2], vertex[3]
    limit = GUARD_BAND * w
    return (depth >= near) & (-limit <= x) & (x <= limit) & (-limit <= y) & (y <= limit)


@kernel
def _clip_against(plane: int, source, n: int, target, near: np.float32) -> int:
    """Copy the part of a polygon inside a plane (Sutherland and Hodgman 1974). Returns its number of vertices."""
    count = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        fa = _signed_distance(plane, source[i, 0], source[i, 1], source[i, 2], source[i, 3], near)
        fb = _signed_distance(plane, source[j, 0], source[j, 1], source[j, 2], source[j, 3], near)
        if fa >= f32(0.0):
            for c in range(4):
                target[count, c] = source[i, c]
            count += 1
        if (fa >= f32(0.0)) != (fb >= f32(0.0)):
            # Always from the inner end: the neighbour that runs along this edge the other way must find the very same point.
            inner, outer = (i, j) if fa >= f32(0.0) else (j, i)
            t = fa / (fa - fb) if fa >= f32(0.0) else fb / (fb - fa)
            for c in range(4):
                target[count, c] = source[inner, c] + t * (source[outer, c] - source[inner, c])
            count += 1
    return count


@kernel
def clip_polygon(polygon, scratch, near: np.float32) -> int:
    """Clip the triangle in the first three rows of `polygon` (k, 4) in place. Returns its number of vertices, 0 if nothing is left."""
    n = 3
    for plane in range(_PLANES):
        n = _clip_against(plane, polygon, n, scratch, near)
        for i in range(n):
            for c in range(4):
                polygon[i, c] = scratch[i, c]
    return n
