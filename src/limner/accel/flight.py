"""Rays that go anywhere, sixty-four followed by turns: while one waits for memory, others are at work.

A ray through a large tree waits most of its time for the next node, and where the tree is small, for the processor, which guessed the
ray's way wrongly and has to begin again. So all rays of a block are under way at once. In each round every ray takes one step, those that
are at a node first, those at a pack of triangles then, and asks for what its next step will look at; when it is this ray's turn again, what
it asked for is there. And a step decides nothing by a branch that a ray could take either way: whatever a ray meets, the same is done.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import meet_slabs
from ..kernel.elementary import as_float, as_int
from ..kernel.lanes import (
    at,
    compressed,
    count_set,
    i32x8,
    lanes_of,
    load8,
    lowest,
    mask_of,
    prefetch,
    put,
    splat8_int,
    store8,
    where,
    with_lane,
)
from ..kernel.vec import ZERO, Vec3
from .layouts import BLOCK, ENTRIES, LINKS, NODE_WORDS, PACK_WORDS, WAITING
from .ray_block import END, FIRST_EDGES, HIT_T, n_triangles_in, slabs_in, try_pack
from .walk import edges_of

__all__ = ["follow_rays"]

_DONE = -(1 << 31)  # the link below all others on a ray's stack
_LARGEST = (1 << 31) - 1
_AT_NODES, _AT_PACKS, _LINK, _TOP = 0, BLOCK, 2 * BLOCK, 3 * BLOCK  # what is known of a flight: lists of rays, link and top of each
_BELOW_ALL = int(np.float32(-np.inf).view(np.int32))


@kernel
def _lane_numbers() -> i32x8:
    numbers = splat8_int(0)
    for k in range(8):
        numbers = with_lane(numbers, k, np.int32(k))
    return numbers


@kernel
def _pushed(nodes, node: int, numbers, integers, ray: int, stack, top: int) -> int:
    """The top of a ray's stack when the children of a node that it enters are on it, the nearest uppermost, the others in any order."""
    place, edges = NODE_WORDS * node, FIRST_EDGES + ray
    x, y, z = np.int64(at(integers, edges)), np.int64(at(integers, edges + BLOCK)), np.int64(at(integers, edges + 2 * BLOCK))
    near = Vec3(edges_of(nodes, place + x), edges_of(nodes, place + y), edges_of(nodes, place + z))
    far = Vec3(edges_of(nodes, place + 24 - x), edges_of(nodes, place + 40 - y), edges_of(nodes, place + 56 - z))
    enter, leave = meet_slabs(near, far, slabs_in(numbers, ray), ZERO, at(numbers, END + ray))
    entered = enter <= leave
    # Where the ray enters, but for the last bits, which say by which lane.
    entries = (as_int(enter) & -8) | _lane_numbers()
    nearest = np.int64(lowest(where(entered, entries, splat8_int(_LARGEST))))
    mask = mask_of(entered)
    rest = mask & ~(np.int32(1) << np.int32(nearest & 7))
    others, n = lanes_of(rest), top + np.int64(count_set(rest))
    store8(stack, top, compressed(load8(nodes, place + LINKS), others))
    store8(stack, ENTRIES + top, compressed(entries, others))
    put(stack, n, at(nodes, place + LINKS + (nearest & 7)))
    put(stack, ENTRIES + n, nearest)
    return top + np.int64(count_set(mask))


@kernel
def _go_on(nodes, packs, numbers, ray: int, flight, stack, top: int) -> int:
    """Take what is uppermost on a ray's stack and near enough, and ask for it. Returns its link."""
    end = at(numbers, END + ray)
    top -= 1
    while as_float(at(stack, ENTRIES + top)) > end:
        top -= 1
    link = np.int64(at(stack, top))
    put(flight, _LINK + ray, link)
    put(flight, _TOP + ray, top)
    node, pack = where(link >= 0, link, 0), where((link < 0) & (link != _DONE), (-1 - link) >> 1, 0)
    for line in range(0, NODE_WORDS, 16):
        prefetch(nodes, NODE_WORDS * node + line)
    for line in range(0, PACK_WORDS, 16):
        prefetch(packs, PACK_WORDS * pack + line)
    return link


@kernel
def follow_rays(nodes, packs, tags, numbers, integers, first: int, end: int, flight, stack, any_hit, visits):
    """Find the nearest hit, or any, of the rays `first` to `end` - 1 of a block, in a tree of triangles alone.

    HIT_T then is below 0 where any hit was asked for, and found. Scratch: `flight` (4 BLOCK,) int64, `stack` (STACKS,) int32. `visits`, if
    any (BLOCK, 2) int32: how many nodes each ray meets, and triangles, is added to it.
    """
    n_nodes, n_packs = 0, 0
    for ray in range(first, end):
        bottom = WAITING * ray
        stack[bottom], stack[ENTRIES + bottom] = _DONE, _BELOW_ALL
        flight[_LINK + ray], flight[_TOP + ray] = 0, bottom + 1
        flight[_AT_NODES + n_nodes] = ray
        n_nodes += 1 if numbers[HIT_T + ray] > ZERO else 0
    while n_nodes + n_packs > 0:
        here, n_nodes = n_nodes, 0
        for k in range(here):
            ray = at(flight, _AT_NODES + k)
            if visits is not None:  # known to the compiler
                visits[ray, 0] += 1
            top = _pushed(nodes, at(flight, _LINK + ray), numbers, integers, ray, stack, at(flight, _TOP + ray))
            link = _go_on(nodes, packs, numbers, ray, flight, stack, top)
            # A ray is in one list or the other, or in none.
            put(flight, _AT_NODES + n_nodes, ray)
            put(flight, _AT_PACKS + n_packs, ray)
            n_nodes += np.int64(link >= 0)
            n_packs += np.int64((link < 0) & (link != _DONE))
        here, n_packs = n_packs, 0
        for k in range(here):
            ray = at(flight, _AT_PACKS + k)
            pack = (-1 - at(flight, _LINK + ray)) >> 1
            if visits is not None:
                visits[ray, 1] += n_triangles_in(packs, pack)
            try_pack(packs, tags, pack, numbers, integers, ray, any_hit)
            link = _go_on(nodes, packs, numbers, ray, flight, stack, at(flight, _TOP + ray))
            put(flight, _AT_NODES + n_nodes, ray)
            put(flight, _AT_PACKS + n_packs, ray)
            n_nodes += np.int64(link >= 0)
            n_packs += np.int64((link < 0) & (link != _DONE))
