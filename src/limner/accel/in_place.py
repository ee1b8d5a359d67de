"""Walks that stand in the loop that asks for them, for a tracer that asks in one place and does little else.

`first_hit_in_place` is `walk.first_hit`. `is_blocked` is `walk.occluded` without what only a nearest hit needs: no order among the boxes
that a ray enters, nothing remembered but links, and the first triangle that is met ends the walk. Shadow rays are nearly half of all rays,
and most of them meet nothing.
"""

from __future__ import annotations

import numpy as np

from .._jit import inlined
from ..intersect.triangle import TurnedRay, hit_triangle
from ..kernel.lanes import any_of, first_set, load8
from ..kernel.vec import Vec3
from .layouts import FIRST_TREE, LINKS, NODE_WORDS, NOT_OPAQUE, NOT_PLAIN, PACK_WORDS, TAG_WORDS, TREE_LINK
from .walk import Hit, hit_of_others, line_of, line_within, met_boxes, miss, occluded, walk

__all__ = ["first_hit_in_place", "is_blocked"]

f32 = np.float32
_INFINITY = f32(np.inf)
_LEAVE = -(1 << 31)  # where a mesh's tree ends: back to the world


@inlined
def first_hit_in_place(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool, stack) -> Hit:
    """`first_hit`"""
    hit = walk(accelerator, instances, o, d, t_min, t_max, stack, False, both_sides, False)
    return hit if hit.instance >= 0 else miss(_INFINITY)


@inlined
def _blocked_by_pack(packs, tags, pack: int, ray: TurnedRay, t_min: np.float32, t_max: np.float32) -> bool:
    """Whether an opaque triangle of a pack is met, from either side."""
    place = PACK_WORDS * pack
    x, y, z = place + 8 * ray.kx, place + 8 * ray.ky, place + 8 * ray.kz
    a = Vec3(load8(packs, x), load8(packs, y), load8(packs, z))
    b = Vec3(load8(packs, x + 24), load8(packs, y + 24), load8(packs, z + 24))
    c = Vec3(load8(packs, x + 48), load8(packs, y + 48), load8(packs, z + 48))
    met = hit_triangle(ray, a, b, c, t_min, t_max).t < t_max
    return any_of(met) and any_of(met & ((load8(tags, TAG_WORDS * pack) & (NOT_PLAIN | NOT_OPAQUE)) == 0))


@inlined
def is_blocked(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack) -> bool:
    """`occluded`, sooner; not of what bends."""
    nodes, packs, tags, primitives, planes, exact = accelerator
    if nodes.shape[0] == 0 or planes.shape[0] > 0:
        return occluded(accelerator, instances, o, d, t_min, t_max, stack)
    in_world = line_of(nodes, 0, o, d)
    line, current, top = in_world, 0, 0
    while True:
        place = NODE_WORDS * current + LINKS
        _, entered = met_boxes(nodes, current, line, t_min, t_max)
        while entered != 0:
            link = np.int64(nodes[place + np.int64(first_set(entered))])
            entered = entered & (entered - 1)
            if link > TREE_LINK and link < 0:
                pack = (-1 - link) >> 1
                if _blocked_by_pack(packs, tags, pack, line.turned, t_min, t_max):
                    return True
                if link & 1 == 0:
                    best = hit_of_others(instances, tags, primitives, exact, pack, o, d, t_min, miss(t_max), True, True)
                    if best.instance != -1:
                        return True
            else:
                stack[top] = link
                top += 1
        while True:
            if top == 0:
                return False
            top -= 1
            current = np.int64(stack[top])
            if current >= 0:
                break
            if current == _LEAVE:
                line = in_world
            else:
                p = primitives[TREE_LINK - current]
                if p["opaque"] != 0:
                    stack[top] = _LEAVE
                    top += 1
                    current = FIRST_TREE - np.int64(p["triangle"])
                    line = line_within(nodes, instances[np.int64(p["instance"])], current, o, d)
                    break
