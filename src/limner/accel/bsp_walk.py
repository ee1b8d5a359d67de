"""The walk of a ray through a binary space partition along the axes (FoCG 12.3.4): front to back, and no farther than the first hit."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.triangle import turned_ray
from ..kernel.vec import Vec3
from .listed_triangles import Found, nearest_listed, nothing_before, slack_of, span_within

__all__ = ["walk_bsp"]

f64 = np.float64
_NONE = f64(0.0)


@kernel
def walk_bsp(bsp, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, any_hit: bool, tally, waiting, spans) -> Found:
    """The nearest triangle in (t_min, t_max), or any; t_min >= 0. tally[0] counts nodes, tally[1] triangles.

    A cutting plane divides the ray's span (enter, leave) in a node into a nearer and a farther one. What is on the far side waits:
    `waiting` (int32) its nodes, `spans` (k, 2) float64 where the ray is in them. Parts of space do not overlap: what is hit before the ray
    leaves one is not hidden by anything in the others.
    """
    bounds, nodes, items, corners = bsp
    ray = turned_ray(o, d)
    best = nothing_before(t_max)
    slack = slack_of(bounds, ray)
    origin, direction = (f64(o.x), f64(o.y), f64(o.z)), (f64(d.x), f64(d.y), f64(d.z))
    enter, leave = span_within(bounds, origin, direction, f64(t_min - slack), f64(t_max + slack))
    if not enter <= leave:
        return best
    current, top = 0, 0
    while True:
        tally[0] += 1
        node = nodes[current]
        axis = np.int64(node["axis"])
        if axis >= 0:
            plane, start, way = f64(node["plane"]), origin[axis], direction[axis]
            below, above = np.int64(node["first"]), np.int64(node["first"]) + 1
            is_below = start < plane or (start == plane and way < _NONE)
            near, far = (below, above) if is_below else (above, below)
            t = (plane - start) / way
            # Written so that a ray within the plane, whose t is no number, stays on its side: what touches the plane is on both.
            if t < enter and t > _NONE:
                current = far
            elif t <= leave and t > _NONE:
                waiting[top], spans[top, 0], spans[top, 1] = far, t, leave
                top += 1
                current, leave = near, t
            else:
                current = near
            continue
        first = np.int64(node["first"])
        best = nearest_listed(items, first, first + np.int64(node["count"]), corners, ray, t_min, t_max, best, tally)
        if (any_hit and best.row >= 0) or best.t + slack < leave or top == 0:
            return best
        top -= 1
        current, enter, leave = np.int64(waiting[top]), spans[top, 0], spans[top, 1]
