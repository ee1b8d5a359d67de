"""The walk of a ray through the tree of least volumes (FoCG 12.3.2): the nearer box first; boxes behind the best hit are left out.

And the walk that leaves out nothing: all hits along the ray.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import meet_box, moved_on
from ..intersect.triangle import turned_ray
from ..kernel.vec import ONE, ZERO, Vec3
from .listed_triangles import Found, insert_hit, nearest_listed, nothing_before, slack_of, triangle_hit

__all__ = ["each_hit", "walk_volume_tree"]

f32 = np.float32
_MISSED = f32(np.inf)


@kernel
def _entered(node, o: Vec3, inverse: Vec3, t_min: np.float32, t_max: np.float32, slack: np.float32) -> np.float32:
    """Where the ray enters a node's box; infinity where it misses it."""
    b = node["box"]
    low, high = Vec3(b[0], b[1], b[2]), Vec3(b[3], b[4], b[5])
    near = Vec3(high.x if inverse.x < ZERO else low.x, high.y if inverse.y < ZERO else low.y, high.z if inverse.z < ZERO else low.z)
    far = Vec3(low.x if inverse.x < ZERO else high.x, low.y if inverse.y < ZERO else high.y, low.z if inverse.z < ZERO else high.z)
    enter, leave = meet_box(near, far, o, inverse, t_min, t_max, slack)
    return enter if enter <= leave else _MISSED


@kernel
def walk_volume_tree(tree, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, any_hit: bool, tally, waiting, spans) -> Found:
    """The nearest triangle in (t_min, t_max), or any; t_min >= 0. tally[0] counts boxes, tally[1] triangles.

    `waiting` (int32) holds nodes to come back to, `spans` (k, 2) float64 where the ray enters them. Boxes overlap: what waits may still
    hide what is found, unless it is entered behind it.
    """
    bounds, nodes, items, corners = tree
    ray = turned_ray(o, d)
    inverse = Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
    best = nothing_before(t_max)
    slack = slack_of(bounds, ray)
    tally[0] += 1
    if not nodes.shape[0] > 0 or _entered(nodes[0], o, inverse, t_min, t_max, slack) == _MISSED:
        return best
    current, top = 0, 0
    while True:
        first, count = np.int64(nodes[current]["first"]), np.int64(nodes[current]["count"])
        if count > 0:
            best = nearest_listed(items, first, first + count, corners, ray, t_min, t_max, best, tally)
            if any_hit and best.row >= 0:
                return best
        else:
            tally[0] += 2
            near, far = first, first + 1
            enter_near = _entered(nodes[near], o, inverse, t_min, best.t, slack)
            enter_far = _entered(nodes[far], o, inverse, t_min, best.t, slack)
            if enter_far < enter_near:
                near, far, enter_near, enter_far = far, near, enter_far, enter_near
            if enter_far < _MISSED:
                waiting[top], spans[top, 0] = far, enter_far
                top += 1
            if enter_near < _MISSED:
                current = near
                continue
        while True:
            if top == 0:
                return best
            top -= 1
            if spans[top, 0] <= moved_on(best.t, slack):
                break
        current = np.int64(waiting[top])


@kernel
def each_hit(tree, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, t, row, u, v, start: int, waiting) -> int:
    """All triangles in (t_min, t_max), by t, of equal ones by row: how many. Written from `start` on, unless there is no room at all."""
    bounds, nodes, items, corners = tree
    ray = turned_ray(o, d)
    inverse = Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
    slack = slack_of(bounds, ray)
    found, top = 0, 0
    if nodes.shape[0] > 0:
        waiting[0], top = 0, 1
    while top > 0:
        top -= 1
        node = nodes[waiting[top]]
        if _entered(node, o, inverse, t_min, t_max, slack) == _MISSED:
            continue
        first, count = np.int64(node["first"]), np.int64(node["count"])
        if count == 0:
            waiting[top], waiting[top + 1] = first, first + 1
            top += 2
        for k in range(first, first + count):
            hit = triangle_hit(corners, np.int64(items[k]), ray, t_min, t_max)
            if hit.t < t_max:
                if t.shape[0] > 0:
                    insert_hit(hit.t, np.int64(items[k]), hit.u, hit.v, t, row, u, v, start, start + found)
                found += 1
    return found
