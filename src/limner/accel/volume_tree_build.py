"""The kernel that halves a set of boxes along the axis that leaves the least volumes."""

from __future__ import annotations

import numpy as np

from .._jit import kernel

__all__ = ["build_halves"]

f32 = np.float32
_LEAF_SIZE = 4
_INFINITY = f32(np.inf)


@kernel
def _is_before(boxes, axis: int, a: int, b: int) -> bool:
    """Whether box a comes before b along an axis: by its middle, of equal ones by its number."""
    x, y = boxes[a, axis] + boxes[a, 3 + axis], boxes[b, axis] + boxes[b, 3 + axis]
    return x < y or (x == y and a < b)


@kernel
def _partition_about(boxes, axis: int, order, low: int, high: int):
    """Hoare's partition of order[low..high] about its middle element: (i, j), all up to j before it, all from i on after it."""
    pivot = order[(low + high) // 2]
    i, j = low, high
    while i <= j:
        while _is_before(boxes, axis, order[i], pivot):
            i += 1
        while _is_before(boxes, axis, pivot, order[j]):
            j -= 1
        if i <= j:
            order[i], order[j] = order[j], order[i]
            i, j = i + 1, j - 1
    return i, j


@kernel
def _part(boxes, axis: int, order, first: int, last: int, middle: int):
    """Bring those that come first to the front of order[first:last], as many as there are before `middle`.

    **Source**: Hoare, *Algorithm 65: Find*, 1961.
    """
    low, high = first, last - 1
    while low < high:
        i, j = _partition_about(boxes, axis, order, low, high)
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            return


@kernel
def _sink(boxes, axis: int, order, first: int, n: int, k: int):
    """Let element k of the heap order[first : first + n] sink to its place."""
    while 2 * k + 1 < n:
        child = 2 * k + 1
        if child + 1 < n and _is_before(boxes, axis, order[first + child], order[first + child + 1]):
            child += 1
        if not _is_before(boxes, axis, order[first + k], order[first + child]):
            return
        order[first + k], order[first + child] = order[first + child], order[first + k]
        k = child


@kernel
def _sort(boxes, axis: int, order, first: int, last: int):
    """Sort order[first:last] by a heap (Williams, *Algorithm 232: Heapsort*, 1964)."""
    n = last - first
    for k in range(n // 2 - 1, -1, -1):
        _sink(boxes, axis, order, first, n, k)
    for end in range(n - 1, 0, -1):
        order[first], order[first + end] = order[first + end], order[first]
        _sink(boxes, axis, order, first, end, 0)


@kernel
def _halve(boxes, axis: int, order, first: int, last: int, middle: int, by_sorting: int):
    if by_sorting != 0:
        _sort(boxes, axis, order, first, last)
    else:
        _part(boxes, axis, order, first, last, middle)


@kernel
def _box_of(boxes, order, first: int, last: int):
    """The box around order[first:last]: low x, y, z, high x, y, z."""
    lx, ly, lz, hx, hy, hz = _INFINITY, _INFINITY, _INFINITY, -_INFINITY, -_INFINITY, -_INFINITY
    for k in range(first, last):
        row = order[k]
        lx, ly, lz = min(lx, boxes[row, 0]), min(ly, boxes[row, 1]), min(lz, boxes[row, 2])
        hx, hy, hz = max(hx, boxes[row, 3]), max(hy, boxes[row, 4]), max(hz, boxes[row, 5])
    return lx, ly, lz, hx, hy, hz


@kernel
def _volume(boxes, order, first: int, last: int) -> np.float32:
    lx, ly, lz, hx, hy, hz = _box_of(boxes, order, first, last)
    return (hx - lx) * (hy - ly) * (hz - lz)


@kernel
def build_halves(boxes, order, nodes, stack, by_sorting, used):
    """Fill `nodes`, bring `order` into the order of the leaves; used[0] is the number of nodes. `stack` (k, 3): node, first, last."""
    n_nodes, top = 1, 1
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, 0, order.shape[0]
    while top > 0:
        top -= 1
        n, first, last = stack[top, 0], stack[top, 1], stack[top, 2]
        box = _box_of(boxes, order, first, last)
        for c in range(6):
            nodes[n]["box"][c] = box[c]
        if last - first <= _LEAF_SIZE:
            nodes[n]["first"], nodes[n]["count"] = first, last - first
            continue
        middle = (first + last) // 2
        least, best = _INFINITY, 2
        for axis in range(3):
            _halve(boxes, axis, order, first, last, middle, by_sorting)
            volumes = _volume(boxes, order, first, middle) + _volume(boxes, order, middle, last)
            if volumes < least:
                least, best = volumes, axis
        if best < 2:
            _halve(boxes, best, order, first, last, middle, by_sorting)
        nodes[n]["first"], nodes[n]["count"] = n_nodes, 0
        stack[top, 0], stack[top, 1], stack[top, 2] = n_nodes, first, middle
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = n_nodes + 1, middle, last
        top, n_nodes = top + 2, n_nodes + 2
    used[0] = n_nodes
