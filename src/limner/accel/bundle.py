"""Eight rays that go nearly the same way, through the tree together: those of neighbouring pixels, say.

They meet nearly the same nodes, so these are looked at once for all: an interval that holds all eight origins and all eight directions
meets the eight boxes of a node (Reshetov, Soupikov and Hurley, *Multi-level ray tracing algorithm*, 2005; Boulos, Wald and Shirley,
*Geometric and arithmetic culling methods for entire ray packets*, 2006). Before a child is entered, its box is met by the eight rays, each
for itself; in a pack of triangles, only those that meet it are tried, one by one, by the function that tries single rays. What is found is
what single rays find, but where two triangles are hit at the very same t.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import meet_box, moved_on
from ..kernel.elementary import as_float, as_int
from ..kernel.lanes import first_set, highest, lane, load8, lowest, mask_of, max, min
from ..kernel.vec import ZERO, Vec3
from .layouts import BLOCK, LINKS, NODE_WORDS
from .ray_block import DIRECTION, HIT_T, INVERSE, ORIGIN, SLACK, three, try_pack
from .walk import edges_of

__all__ = ["is_bundle", "meet_bundle"]

f32 = np.float32
_MISS = f32(np.inf)

_WIDEST, _FARTHEST = f32(0.05), f32(0.02)  # of a bundle: its directions, its origins as a share of what is looked at


@kernel
def is_bundle(numbers, column: int, size: np.float32) -> bool:
    """Whether the eight rays from a column on keep together: origins near each other, for a mesh of a size, directions too.

    None of them goes along a slab, and all have something to look for.
    """
    widest, length = ZERO, ZERO
    if not lowest(load8(numbers, HIT_T + column)) > ZERO:
        return False
    for axis in range(3):
        place = BLOCK * axis + column
        o, d = load8(numbers, ORIGIN + place), load8(numbers, DIRECTION + place)
        low, high = lowest(d), highest(d)
        # An axis that some rays go up and others down has no near side.
        if not (low > ZERO or high < ZERO) or not highest(o) - lowest(o) <= _FARTHEST * size:
            return False
        widest = max(widest, high - low)
        inverse = load8(numbers, INVERSE + place)
        if not (lowest(inverse) > -_MISS and highest(inverse) < _MISS):
            return False
        length = max(length, abs(numbers[DIRECTION + place]))
    return widest <= _WIDEST * length


@kernel
def _pushed(place: int, enter, entered, stack, top: int) -> int:
    """The new top of the stack, with a node's children on it that are entered, the nearest uppermost; `place`: eight times the node."""
    bottom = top
    while entered != 0:
        i = np.int64(first_set(entered))
        entered = entered & (entered - 1)
        bits, j = as_int(lane(enter, i)), top
        while j > bottom and stack[2 * j - 1] < bits:
            stack[2 * j], stack[2 * j + 1] = stack[2 * j - 2], stack[2 * j - 1]
            j -= 1
        stack[2 * j], stack[2 * j + 1] = place + i, bits
        top += 1
    return top


@kernel
def _try_pack(packs, tags, pack: int, numbers, integers, column: int, active, any_hit):
    """Let the rays of a mask try the triangles of a pack."""
    while active != 0:
        ray = column + np.int64(first_set(active))
        active = active & (active - 1)
        try_pack(packs, tags, pack, numbers, integers, ray, any_hit)


@kernel
def _first_bound(edge, o: np.float32, low: np.float32, high: np.float32):
    """The least t at which a ray of the bundle can meet a plane, or eight; `o`: the origin that is farthest on."""
    return min((edge - o) * low, (edge - o) * high)


@kernel
def _last_bound(edge, o: np.float32, low: np.float32, high: np.float32):
    return max((edge - o) * low, (edge - o) * high)


@kernel
def meet_bundle(nodes, packs, tags, numbers, integers, column: int, stack, any_hit):
    """Find the nearest hit of each of the eight rays from a column on, or any, in a tree of triangles alone that has nodes.

    HIT_T then is below 0 where any hit was asked for, and found.
    """
    o, inverse = three(numbers, ORIGIN + column), three(numbers, INVERSE + column)
    slack = highest(load8(numbers, SLACK + column))
    lowest_o, highest_o = Vec3(lowest(o.x), lowest(o.y), lowest(o.z)), Vec3(highest(o.x), highest(o.y), highest(o.z))
    low = Vec3(lowest(inverse.x), lowest(inverse.y), lowest(inverse.z))
    high = Vec3(highest(inverse.x), highest(inverse.y), highest(inverse.z))
    back_x, back_y, back_z = low.x < ZERO, low.y < ZERO, low.z < ZERO
    near_x, near_y, near_z = 24 if back_x else 0, 32 if back_y else 8, 40 if back_z else 16
    ahead = Vec3(lowest_o.x if back_x else highest_o.x, lowest_o.y if back_y else highest_o.y, lowest_o.z if back_z else highest_o.z)
    behind = Vec3(highest_o.x if back_x else lowest_o.x, highest_o.y if back_y else lowest_o.y, highest_o.z if back_z else lowest_o.z)
    farthest = highest(load8(numbers, HIT_T + column))
    current, top = 0, 0
    while True:
        place = NODE_WORDS * current
        near = Vec3(edges_of(nodes, place + near_x), edges_of(nodes, place + near_y), edges_of(nodes, place + near_z))
        far = Vec3(edges_of(nodes, place + 24 - near_x), edges_of(nodes, place + 40 - near_y), edges_of(nodes, place + 56 - near_z))
        enter = max(ZERO, _first_bound(near.x, ahead.x, low.x, high.x))
        enter = max(enter, _first_bound(near.y, ahead.y, low.y, high.y))
        enter = max(enter, _first_bound(near.z, ahead.z, low.z, high.z))
        leave = min(farthest, _last_bound(far.x, behind.x, low.x, high.x))
        leave = min(leave, _last_bound(far.y, behind.y, low.y, high.y))
        leave = min(leave, _last_bound(far.z, behind.z, low.z, high.z))
        top = _pushed(8 * current, enter, mask_of(enter <= moved_on(leave, slack)), stack, top)
        current = -1
        while current < 0:
            if top == 0:
                return
            top -= 1
            if as_float(stack[2 * top + 1]) > moved_on(farthest, slack):
                continue
            child = np.int64(stack[2 * top])
            place = NODE_WORDS * (child >> 3) + (child & 7)
            box_near = Vec3(as_float(nodes[place + near_x]), as_float(nodes[place + near_y]), as_float(nodes[place + near_z]))
            box_far = Vec3(as_float(nodes[place + 24 - near_x]), as_float(nodes[place + 40 - near_y]), as_float(nodes[place + 56 - near_z]))
            begin, end = meet_box(box_near, box_far, o, inverse, ZERO, load8(numbers, HIT_T + column), slack)
            active = mask_of(begin <= end)
            if active == 0:
                continue
            link = np.int64(nodes[place + LINKS])
            if link >= 0:
                current = link
            else:
                _try_pack(packs, tags, (-1 - link) >> 1, numbers, integers, column, active, any_hit)
                farthest = highest(load8(numbers, HIT_T + column))
                if any_hit and farthest < ZERO:
                    return
