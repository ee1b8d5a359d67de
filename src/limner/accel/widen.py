"""From a tree of two children to one of eight: nodes and triangles as the registers of a CPU want them.

A node of eight takes the place of several nodes of two, and a pack of triangles that of several leaves. Which, follows from the
expected cost of a ray, area times visits, by dynamic programming from the leaves up: the least cost of everything below a box if it may
become 1, 2, ... 7 children of the node above.

**Source**: Ylitie, Karras and Laine, *Efficient incoherent ray traversal on GPUs through compressed wide BVHs*, HPG 2017, 4.1; the wide
tree itself: Wald, Benthin and Boulos, *Getting rid of packets*, 2008.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import as_int
from ..kernel.lanes import at, put
from .layouts import CORNERS, LINKS, NODE_WORDS, NOT_OPAQUE, NOT_PLAIN, ONLY_BACK, ONLY_FRONT, PACK_WORDS, TAG_WORDS, TREE_LINK

__all__ = ["fill_packs", "widen"]

f32, i32 = np.float32, np.int32
_INFINITY = f32(np.inf)
_NAN = f32(np.nan)
_NODE_COST, _PACK_COST = f32(1.0), f32(1.2)  # of a visit


@kernel
def _half_area(box, place: int) -> np.float32:
    x, y, z = box[place + 3] - box[place], box[place + 4] - box[place + 1], box[place + 5] - box[place + 2]
    return x * y + y * z + z * x


@kernel
def _tag(primitive) -> int:
    """The bits that a pack keeps of a primitive."""
    facing = ONLY_FRONT if primitive["facing"] > 0 else ONLY_BACK if primitive["facing"] < 0 else 0
    return facing + (NOT_OPAQUE if primitive["opaque"] == 0 else 0) + (NOT_PLAIN if primitive["triangle"] < 0 else 0)


@kernel
def _fill_pack(packs, tags, pack: int, primitives, points, triangles, order, first: int, count: int) -> int:
    """Write the primitives order[first : first + count] as one pack. Returns its link.

    Each has the points of a row of `triangles`, or three of its own, if there are no rows. Without `primitives`, all are plain triangles.
    """
    link = -1 - 2 * pack
    for i in range(8):
        place = np.int64(order[first + i]) if i < count else 0
        tag, name = 0, place
        if i < count and primitives.shape[0] > 0:
            p = primitives[place]
            tag, name = 16 * np.int64(p["instance"]) + _tag(p), np.int64(p["triangle"])
            if p["triangle"] < 0:
                name, link = place, -2 - 2 * pack
        for c in range(3):
            row = np.int64(at(triangles, (place, c))) if triangles.shape[0] > 0 else 3 * place + c
            for axis in range(3):
                put(packs, PACK_WORDS * pack + 24 * c + 8 * axis + i, at(points, (row, axis)) if i < count else _NAN)
        put(tags, TAG_WORDS * pack + i, tag)
        put(tags, TAG_WORDS * pack + 8 + i, name)
    return link


@kernel
def fill_packs(primitives, points, triangles, order, packs, tags):
    """Write all primitives into packs, eight by eight: what there is without a tree."""
    n = order.shape[0]
    for pack in range((n + 7) // 8):
        _fill_pack(packs, tags, pack, primitives, points, triangles, order, 8 * pack, min(8, n - 8 * pack))


@kernel
def _least_distribution(costs, left: int, right: int, n: int):
    """The least cost of two boxes that become n children together, and how many of these the left one becomes."""
    best, chosen = _INFINITY, 1
    for k in range(1, n):
        if k <= 7 and n - k <= 7:
            cost = costs[left, k - 1] + costs[right, n - k - 1]
            if cost < best:
                best, chosen = cost, k
    return best, chosen


@kernel
def _weigh(binary, box: int, order, n_trees: int, costs, splits, counts, firsts):
    """Fill the row of a box (2 node + side) in the tables of `widen`; the boxes below have theirs. A tree counts as nine: no pack's."""
    node, side = box // 2, box % 2
    parent = binary[node]
    area = _half_area(parent["box"], 6 * side)
    child, count = np.int64(parent["child"][side]), np.int64(parent["count"][side])
    if child < 0:
        counts[box], firsts[box] = count if order[-1 - child] >= n_trees else 9, -1 - child
        for i in range(7):
            costs[box, i], splits[box, i] = area * _PACK_COST, 0
        splits[box, 7] = 0
        return
    left, right = 2 * child, 2 * child + 1
    counts[box], firsts[box] = counts[left] + counts[right], min(firsts[left], firsts[right])
    inner, splits[box, 7] = _least_distribution(costs, left, right, 8)
    as_node = inner + area * _NODE_COST
    as_pack = area * _PACK_COST if counts[box] <= 8 else _INFINITY
    costs[box, 0], splits[box, 0] = min(as_node, as_pack), 0
    if as_pack <= as_node:
        splits[box, 7] = 0
    for i in range(1, 7):
        cost, k = _least_distribution(costs, left, right, i + 1)
        is_less = cost < costs[box, i - 1]
        costs[box, i] = cost if is_less else costs[box, i - 1]
        splits[box, i] = k if is_less else 0


@kernel
def _gather_children(binary, splits, node: int, slots) -> int:
    """Write the boxes that become the children of the node of eight in the place of `node` to slots[0]. Returns how many they are.

    slots[1] and slots[2]: what waits, as boxes and how many children each may become.
    """
    parts = np.int64(slots[3, 0])
    slots[1, 0], slots[2, 0], slots[1, 1], slots[2, 1] = 2 * node + 1, 8 - parts, 2 * node, parts
    n, top = 0, 2
    while top > 0:
        top -= 1
        box, room = np.int64(slots[1, top]), np.int64(slots[2, top])
        while room > 1 and splits[box, room - 1] == 0:
            room -= 1
        if room == 1:
            slots[0, n] = box
            n += 1
        else:
            k = np.int64(splits[box, room - 1])
            child = np.int64(binary[box // 2]["child"][box % 2])
            slots[1, top], slots[2, top], slots[1, top + 1], slots[2, top + 1] = 2 * child + 1, room - k, 2 * child, k
            top += 2
    return n


@kernel
def widen(
    binary, primitives, points, triangles, order, nodes, packs, tags, costs, splits, counts, firsts, waiting, slots, used
):  # fmt: skip
    """Fill nodes, packs and tags from a tree of two children; used[0] and used[1] are how many nodes and packs there are.

    Of the primitives, the first used[1], on entry, are trees.

    Scratch, with a row for each box of the tree of two, 2 node + side: `costs` (n, 7) float32, the least cost if it may become 1..7
    children; `splits` (n, 8) int8, how many of these its left part becomes, 0 where one less does as well, the last: of 8, 0 for a pack;
    `counts` and `firsts` (n,) int32, its primitives. `waiting` (n, 2) int32: pairs of a node of two and its node of eight. `slots` (4, 16)
    int32.
    """
    n_trees = used[1]
    for box in range(2 * binary.shape[0] - 1, -1, -1):
        _weigh(binary, box, order, n_trees, costs, splits, counts, firsts)
    n_nodes, n_packs, top = 1, 0, 1
    waiting[0, 0], waiting[0, 1] = 0, 0
    _, root_split = _least_distribution(costs, 0, 1, 8)
    while top > 0:
        top -= 1
        source, target = np.int64(waiting[top, 0]), np.int64(waiting[top, 1])
        slots[3, 0] = root_split if source == 0 else waiting[top, 2]
        n = _gather_children(binary, splits, source, slots)
        place = NODE_WORDS * target
        for i in range(8):
            box = np.int64(slots[0, i]) if i < n else 0
            for c in range(6):
                edge = _INFINITY if c < 3 else -_INFINITY
                if i < n:
                    edge = binary[box // 2]["box"][6 * (box % 2) + c]
                nodes[place + 8 * c + i] = as_int(edge)
            link = 0
            if i < n:
                if splits[box, 7] == 0 and counts[box] > 8:
                    link = TREE_LINK - np.int64(order[firsts[box]])
                elif splits[box, 7] == 0:
                    first, count = np.int64(firsts[box]), np.int64(counts[box])
                    link = _fill_pack(packs, tags, n_packs, primitives, points, triangles, order, first, count)
                    n_packs += 1
                else:
                    link = n_nodes
                    waiting[top, 0], waiting[top, 1], waiting[top, 2] = binary[box // 2]["child"][box % 2], n_nodes, splits[box, 7]
                    top += 1
                    n_nodes += 1
            nodes[place + LINKS + i] = link
    for c in range(3):
        low, high = binary[0]["box"][c], binary[0]["box"][3 + c]
        nodes[CORNERS + c] = as_int(min(low, binary[0]["box"][6 + c]))
        nodes[CORNERS + 3 + c] = as_int(max(high, binary[0]["box"][9 + c]))
    used[0], used[1] = n_nodes, n_packs
