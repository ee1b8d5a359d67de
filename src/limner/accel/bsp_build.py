"""The kernel that cuts space in two, again and again, where a ray is expected to have the least to do."""

from __future__ import annotations

import numpy as np

from .._jit import kernel

__all__ = ["build_bsp_tree"]

f32 = np.float32
_BINS = 32
_NONE, _ONE = f32(0.0), f32(1.0)
_OF_EMPTY = f32(0.8)  # what a plane costs that cuts off nothing but empty space
_STEP = f32(1.0)  # what it costs to decide on which side of a plane to go on, in triangles
_INFINITY = f32(np.inf)


@kernel
def _half_area(x: np.float32, y: np.float32, z: np.float32) -> np.float32:
    return x * y + y * z + z * x


@kernel
def _range_within(boxes, lists, first: int, last: int, room, waiting: int, axis: int):
    """How far the listed boxes reach along an axis, within the node's room."""
    low, high = _INFINITY, -_INFINITY
    for k in range(first, last):
        low, high = min(low, boxes[lists[k], axis]), max(high, boxes[lists[k], 3 + axis])
    return max(low, room[waiting, axis]), min(high, room[waiting, 3 + axis])


@kernel
def _fill_bins(boxes, lists, first: int, last: int, axis: int, low: np.float32, scale: np.float32, bins):
    """bins[0]: how many boxes begin in each; bins[1]: how many end."""
    for b in range(_BINS):
        bins[0, b], bins[1, b] = 0, 0
    for k in range(first, last):
        begin = min(max(int((boxes[lists[k], axis] - low) * scale), 0), _BINS - 1)
        end = min(max(int((boxes[lists[k], 3 + axis] - low) * scale), 0), _BINS - 1)
        bins[0, begin] += 1
        bins[1, end] += 1


@kernel
def _best_plane(boxes, lists, first: int, last: int, room, waiting: int, bins):
    """(axis, place) of the plane with the least expected cost; axis -1 where all are dearer than a leaf."""
    n = last - first
    best, best_axis, best_plane = f32(n), -1, _NONE
    sx, sy, sz = room[waiting, 3] - room[waiting, 0], room[waiting, 4] - room[waiting, 1], room[waiting, 5] - room[waiting, 2]
    whole = _half_area(sx, sy, sz)
    for axis in range(3):
        low, high = _range_within(boxes, lists, first, last, room, waiting, axis)
        scale = f32(_BINS) / (high - low)
        if not (low < high and scale < _INFINITY):
            continue
        _fill_bins(boxes, lists, first, last, axis, low, scale, bins)
        side = sx if axis == 0 else (sy if axis == 1 else sz)
        a, b = (sy if axis == 0 else sx), (sy if axis == 2 else sz)
        below, above = 0, n
        for k in range(_BINS + 1):
            plane = high if k == _BINS else low + f32(k) / scale
            if room[waiting, axis] < plane and plane < room[waiting, 3 + axis]:
                part = plane - room[waiting, axis]
                empty = _OF_EMPTY if below == 0 or above == 0 else _ONE
                areas = _half_area(part, a, b) * f32(below) + _half_area(side - part, a, b) * f32(above)
                cost = _STEP + empty * areas / whole
                if cost < best:
                    best, best_axis, best_plane = cost, axis, plane
            if k < _BINS:
                below, above = below + bins[0, k], above - bins[1, k]
    return best_axis, best_plane


@kernel
def _divide(boxes, lists, first: int, last: int, axis: int, plane: np.float32, aside):
    """Where a list was, put what lies above the plane, then what lies below; what touches both is in both. How many of each."""
    for k in range(first, last):
        aside[k - first] = lists[k]
    end = first
    for k in range(last - first):
        if boxes[aside[k], 3 + axis] > plane:
            lists[end] = aside[k]
            end += 1
    n_above = end - first
    for k in range(last - first):
        if boxes[aside[k], axis] < plane:
            lists[end] = aside[k]
            end += 1
    return n_above, end - first - n_above


@kernel
def _extra(boxes, lists, first: int, last: int, axis: int, plane: np.float32) -> int:
    """How many would be listed twice."""
    count = 0
    for k in range(first, last):
        if boxes[lists[k], axis] < plane and boxes[lists[k], 3 + axis] > plane:
            count += 1
    return count


@kernel
def _push(stack, room, top: int, node: int, first: int, last: int, depth: int, source: int):
    stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3] = node, first, last, depth
    for c in range(6):
        room[top, c] = room[source, c]


@kernel
def build_bsp_tree(boxes, nodes, lists, aside, items, stack, room, bins, deepest, used):
    """Fill nodes and items; used: how many of each, and how many leaves would rather have been cut, had there been room.

    `stack` (k, 4) holds what waits (node, first and last of its list, depth), `room` (k, 6) the space each has. The lists of what waits
    stand one after the other in `lists`, the one to be divided next at its end. Where items or nodes would not have room, there is a leaf.
    """
    for k in range(boxes.shape[0]):
        lists[k] = k
    n_nodes, n_items, listed, n_crowded, top = 1, 0, boxes.shape[0], 0, 1
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0, 0, boxes.shape[0], 0
    while top > 0:
        top -= 1
        n, first, last, depth = np.int64(stack[top, 0]), stack[top, 1], stack[top, 2], stack[top, 3]
        axis, plane = -1, _NONE
        if last - first > 1 and depth < deepest:
            axis, plane = _best_plane(boxes, lists, first, last, room, top, bins)
            extra = _extra(boxes, lists, first, last, axis, plane) if axis >= 0 else 0
            if listed + extra > items.shape[0] or n_nodes + 2 > nodes.shape[0]:
                axis, n_crowded = -1, n_crowded + 1
            else:
                listed += extra
        nodes[n]["axis"] = axis
        if axis < 0:
            nodes[n]["first"], nodes[n]["count"] = n_items, last - first
            for k in range(first, last):
                items[n_items] = lists[k]
                n_items += 1
            continue
        n_above, n_below = _divide(boxes, lists, first, last, axis, plane, aside)
        nodes[n]["plane"], nodes[n]["first"], nodes[n]["count"] = plane, n_nodes, 0
        _push(stack, room, top + 1, n_nodes, first + n_above, first + n_above + n_below, depth + 1, top)
        _push(stack, room, top, n_nodes + 1, first, first + n_above, depth + 1, top)
        room[top + 1, 3 + axis], room[top, axis] = plane, plane
        top, n_nodes = top + 2, n_nodes + 2
    used[0], used[1], used[2] = n_nodes, n_items, n_crowded
