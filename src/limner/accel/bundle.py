"""Rays that go nearly the same way, eight or a whole block of them, through the tree together: those of neighbouring pixels, say.

They meet nearly the same nodes, so these are looked at once for all: an interval that holds all origins and all directions meets the eight
boxes of a node (Reshetov, Soupikov and Hurley, *Multi-level ray tracing algorithm*, 2005; Boulos, Wald and Shirley, *Geometric and
arithmetic culling methods for entire ray packets*, 2006). Before a child is entered, its box is met by eight rays at once, each for itself,
and only by those eights of which one met the parent; in a pack of triangles, only rays that meet it are tried, one by one, by the function
that tries single rays. What is found is what single rays find, but where two triangles are hit at the very same t.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import meet_slabs
from ..kernel.elementary import as_float, as_int
from ..kernel.lanes import at, first_set, highest, lane, load8, lowest, mask_of, max, min, put, splat8
from ..kernel.vec import ZERO, Vec3
from .layouts import BLOCK, LINKS, NODE_WORDS
from .ray_block import DIRECTION, END, HIT_T, INVERSE, INVERSE_FAR, ORIGIN, ORIGIN_FAR, slabs_of_eight, try_pack
from .walk import edges_of

__all__ = ["is_bundle", "meet_bundle"]

f32 = np.float32
_MISS = f32(np.inf)

_WIDEST, _FARTHEST = f32(0.05), f32(0.02)  # of a bundle: its directions, its origins as a share of what is looked at


@kernel
def _range_of(numbers, row: int, first: int, end: int):
    """The least and the greatest number of a row, columns `first` to `end` - 1."""
    low = high = load8(numbers, row + first)
    for column in range(first + 8, end, 8):
        found = load8(numbers, row + column)
        low, high = min(low, found), max(high, found)
    return lowest(low), highest(high)


@kernel
def is_bundle(numbers, first: int, end: int, size: np.float32) -> bool:
    """Whether the rays of some eights keep together: origins near each other, for a mesh of a size, directions too.

    None of them goes along a slab, and all have something to look for.
    """
    least, _ = _range_of(numbers, HIT_T, first, end)
    if not least > ZERO:
        return False
    widest, length = ZERO, ZERO
    for axis in range(3):
        low, high = _range_of(numbers, DIRECTION + BLOCK * axis, first, end)
        near, far = _range_of(numbers, ORIGIN + BLOCK * axis, first, end)
        # An axis that some rays go up and others down has no near side.
        if not (low > ZERO or high < ZERO) or not far - near <= _FARTHEST * size:
            return False
        widest, length = max(widest, high - low), max(length, abs(low))
        low, high = _range_of(numbers, INVERSE + BLOCK * axis, first, end)
        if not (low > -_MISS and high < _MISS):
            return False
    return widest <= _WIDEST * length


@kernel
def _pushed(place: int, enter, entered, eights: int, stack, top: int) -> int:
    """The new top of the stack, with a node's children on it that are entered, the nearest uppermost; `place`: eight times the node."""
    bottom = top
    while entered != 0:
        i = np.int64(first_set(entered))
        entered = entered & (entered - 1)
        bits, j = as_int(lane(enter, i)), top
        while j > bottom and at(stack, 3 * j - 2) < bits:
            put(stack, 3 * j, at(stack, 3 * j - 3))
            put(stack, 3 * j + 1, at(stack, 3 * j - 2))
            j -= 1
        put(stack, 3 * j, place + i)
        put(stack, 3 * j + 1, bits)
        put(stack, 3 * top + 2, eights)
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
def meet_bundle(nodes, packs, tags, numbers, integers, first: int, last: int, stack, any_hit):
    """Find the nearest hit of each of the rays `first` to `last` - 1, or any, in a tree of triangles alone that has nodes.

    HIT_T then is below 0 where any hit was asked for, and found.
    """
    low_x, high_x = _range_of(numbers, INVERSE, first, last)
    low_y, high_y = _range_of(numbers, INVERSE + BLOCK, first, last)
    low_z, high_z = _range_of(numbers, INVERSE + 2 * BLOCK, first, last)
    back_x, back_y, back_z = low_x < ZERO, low_y < ZERO, low_z < ZERO
    near_x, near_y, near_z = 24 if back_x else 0, 32 if back_y else 8, 40 if back_z else 16
    least, most = _range_of(numbers, ORIGIN, first, last)
    ahead_x = least if back_x else most
    least, most = _range_of(numbers, ORIGIN + BLOCK, first, last)
    ahead_y = least if back_y else most
    least, most = _range_of(numbers, ORIGIN + 2 * BLOCK, first, last)
    ahead_z = least if back_z else most
    least, most = _range_of(numbers, ORIGIN_FAR, first, last)
    behind_x = most if back_x else least
    least, most = _range_of(numbers, ORIGIN_FAR + BLOCK, first, last)
    behind_y = most if back_y else least
    least, most = _range_of(numbers, ORIGIN_FAR + 2 * BLOCK, first, last)
    behind_z = most if back_z else least
    least_x, most_x = _range_of(numbers, INVERSE_FAR, first, last)
    least_y, most_y = _range_of(numbers, INVERSE_FAR + BLOCK, first, last)
    least_z, most_z = _range_of(numbers, INVERSE_FAR + 2 * BLOCK, first, last)
    _, farthest = _range_of(numbers, END, first, last)
    eights = (1 << ((last - first) >> 3)) - 1
    current, top = 0, 0
    while True:
        place = NODE_WORDS * current
        near = Vec3(edges_of(nodes, place + near_x), edges_of(nodes, place + near_y), edges_of(nodes, place + near_z))
        far = Vec3(edges_of(nodes, place + 24 - near_x), edges_of(nodes, place + 40 - near_y), edges_of(nodes, place + 56 - near_z))
        x, y, z = _first_bound(near.x, ahead_x, low_x, high_x), _first_bound(near.y, ahead_y, low_y, high_y), splat8(ZERO)
        enter = max(max(z, _first_bound(near.z, ahead_z, low_z, high_z)), max(x, y))
        x, y = _last_bound(far.x, behind_x, least_x, most_x), _last_bound(far.y, behind_y, least_y, most_y)
        leave = min(min(splat8(farthest), _last_bound(far.z, behind_z, least_z, most_z)), min(x, y))
        top = _pushed(8 * current, enter, mask_of(enter <= leave), eights, stack, top)
        current = -1
        while current < 0:
            if top == 0:
                return
            top -= 1
            if as_float(at(stack, 3 * top + 1)) > farthest:
                continue
            child, waiting = np.int64(at(stack, 3 * top)), np.int64(at(stack, 3 * top + 2))
            place = NODE_WORDS * (child >> 3) + (child & 7)
            link = np.int64(at(nodes, place + LINKS))
            box_near = Vec3(as_float(at(nodes, place + near_x)), as_float(at(nodes, place + near_y)), as_float(at(nodes, place + near_z)))
            x, y, z = at(nodes, place + 24 - near_x), at(nodes, place + 40 - near_y), at(nodes, place + 56 - near_z)
            box_far = Vec3(as_float(x), as_float(y), as_float(z))
            eights = 0
            while waiting != 0:
                k = np.int64(first_set(waiting))
                waiting = waiting & (waiting - 1)
                column = first + 8 * k
                begin, end = meet_slabs(box_near, box_far, slabs_of_eight(numbers, column), ZERO, load8(numbers, END + column))
                active = mask_of(begin <= end)
                if link < 0:
                    _try_pack(packs, tags, (-1 - link) >> 1, numbers, integers, column, active, any_hit)
                eights = eights | (np.int64(active != 0) << k)
            if eights == 0:
                continue
            if link >= 0:
                current = link
            else:
                _, farthest = _range_of(numbers, END, first, last)
                if any_hit and farthest < ZERO:
                    return
