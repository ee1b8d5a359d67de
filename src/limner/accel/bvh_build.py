"""Kernels that gather a scene's primitives and build the tree over them."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import sqrt
from ..kernel.lanes import at, halves_swapped, lane, load8, max, min, put, splat8, store8, where
from ..kernel.transform import transform_point
from ..kernel.vec import ZERO, Vec3
from ..tables.layouts import OPAQUE, SPHERE
from .layouts import MAX_DEPTH

__all__ = ["bound_triangles", "build_tree", "gather_primitives", "turn_bounds"]

f32, i32 = np.float32, np.int32
_BINS = 16
_INFINITY = f32(np.inf)
_LEFT, _RIGHT = 48, 50  # rows of the bins: of what lies to one side of a split


@kernel
def gather_primitives(
    instances, meshes, positions, triangles, slots, materials, places, first, last, primitives, corners, bounds
):
    """Fill primitives, corners (n, 9) and bounds (n, 6) from instances first..last; instance k has places[k]..places[k + 1]."""
    for k in range(first, last):
        instance = instances[k]
        if places[k] == places[k + 1]:
            continue
        m = instance["world_from_object"]
        if instance["kind"] == SPHERE:
            place = places[k]
            primitives[place]["instance"], primitives[place]["triangle"] = k, -1
            primitives[place]["facing"] = 0 if materials[instance["material"]]["double_sided"] != 0 else 1
            primitives[place]["opaque"] = 1 if materials[instance["material"]]["alpha_mode"] == OPAQUE else 0
            r = instance["size"][0]
            for axis in range(3):
                # Half the extent of an ellipsoid along an axis is the length of the matrix's row.
                half = r * sqrt(m[axis, 0] * m[axis, 0] + m[axis, 1] * m[axis, 1] + m[axis, 2] * m[axis, 2])
                margin = f32(1e-6) * (half + abs(m[axis, 3]))
                bounds[place, axis] = m[axis, 3] - half - margin
                bounds[place, 3 + axis] = m[axis, 3] + half + margin
            continue
        mesh = meshes[instance["mesh"]]
        for t in range(mesh["n_triangles"]):
            place = places[k] + t
            material = np.int64(instance["material"])
            if mesh["slot"] >= 0:
                material = material + slots[mesh["slot"] + t]
            primitives[place]["instance"], primitives[place]["triangle"] = k, t
            facing = -1 if instance["flipped"] != 0 else 1
            primitives[place]["facing"] = 0 if materials[material]["double_sided"] != 0 else facing
            primitives[place]["opaque"] = 1 if materials[material]["alpha_mode"] == OPAQUE else 0
            for axis in range(3):
                bounds[place, axis], bounds[place, 3 + axis] = _INFINITY, -_INFINITY
            for c in range(3):
                row = mesh["position"] + triangles[mesh["triangle"] + t, c]
                p = transform_point(m, Vec3(positions[row, 0], positions[row, 1], positions[row, 2]))
                corners[place, 3 * c], corners[place, 3 * c + 1], corners[place, 3 * c + 2] = p.x, p.y, p.z
                for axis in range(3):
                    bounds[place, axis] = min(bounds[place, axis], corners[place, 3 * c + axis])
                    bounds[place, 3 + axis] = max(bounds[place, 3 + axis], corners[place, 3 * c + axis])


# Rows of eight: of a box, the low corner, negated, and the high corner, each with a fourth number that says nothing, so that the greater of
# each two numbers is the box that holds both. Of a primitive, its box; of a node, also that in which all centres lie. Centres are twice
# what they are called: halving would change nothing.


@kernel
def bound_triangles(points, triangles, boxes):
    """Fill the row of each triangle (n, 3) over points (k, 3), `boxes` (8 n,)."""
    for k in range(triangles.shape[0]):
        a, b, c = at(triangles, (k, 0)), at(triangles, (k, 1)), at(triangles, (k, 2))
        for axis in range(3):
            x, y, z = at(points, (a, axis)), at(points, (b, axis)), at(points, (c, axis))
            put(boxes, 8 * k + axis, -min(min(x, y), z))
            put(boxes, 8 * k + 4 + axis, max(max(x, y), z))
        put(boxes, 8 * k + 3, ZERO)
        put(boxes, 8 * k + 7, ZERO)


@kernel
def turn_bounds(bounds, boxes):
    """Fill the row of each primitive, `boxes` (8 n,), from bounds (n, 6)."""
    for k in range(bounds.shape[0]):
        for axis in range(3):
            put(boxes, 8 * k + axis, -bounds[k, axis])
            put(boxes, 8 * k + 4 + axis, bounds[k, 3 + axis])
        put(boxes, 8 * k + 3, ZERO)
        put(boxes, 8 * k + 7, ZERO)


@kernel
def _center(box):
    """The centre of a box as one that holds nothing else."""
    return box - halves_swapped(box)


@kernel
def _center_along(boxes, i: int, axis: int) -> np.float32:
    return at(boxes, 8 * i + 4 + axis) - at(boxes, 8 * i + axis)


@kernel
def _half_area(box) -> np.float32:
    """Half the surface of a box; 0 for an empty one."""
    x, y, z = lane(box, 4) + lane(box, 0), lane(box, 5) + lane(box, 1), lane(box, 6) + lane(box, 2)
    return where(x >= ZERO, x * y + y * z + z * x, ZERO)


@kernel
def _clear(rows, row: int):
    store8(rows, 8 * row, splat8(-_INFINITY))


@kernel
def _grow(rows, row: int, box):
    """Make a box hold another one: the greater of each two numbers, since low corners are negated."""
    store8(rows, 8 * row, max(load8(rows, 8 * row), box))


@kernel
def _scale(ranges, row: int, axis: int) -> np.float32:
    """Bins by centre; 0 where all centres coincide, or are too far apart for a number."""
    low, high = -ranges[8 * row + axis], ranges[8 * row + 4 + axis]
    scale = f32(_BINS) / (high - low)
    return scale if low < high and high - low < _INFINITY and scale < _INFINITY else ZERO


@kernel
def _bin_of(c: np.float32, low: np.float32, scale: np.float32) -> int:
    return min(max(int((c - low) * scale), 0), _BINS - 1)


@kernel
def _put_in_bins(boxes, i: int, low: Vec3, scale: Vec3, bins, counts):
    """Sort a primitive into a bin of each axis."""
    box = load8(boxes, 8 * i)
    x = _bin_of(_center_along(boxes, i, 0), low.x, scale.x)
    y = _BINS + _bin_of(_center_along(boxes, i, 1), low.y, scale.y)
    z = 2 * _BINS + _bin_of(_center_along(boxes, i, 2), low.z, scale.z)
    _grow(bins, x, box)
    _grow(bins, y, box)
    _grow(bins, z, box)
    put(counts, x, at(counts, x) + 1)
    put(counts, y, at(counts, y) + 1)
    put(counts, z, at(counts, z) + 1)


@kernel
def _fill_bins(boxes, first: int, last: int, ranges, row: int, bins, counts):
    """Sort primitives into the bins of all three axes at once: rows 16 axis + bin, boxes and counts."""
    for b in range(3 * _BINS):
        _clear(bins, b)
        counts[b] = 0
    low = Vec3(-ranges[8 * row], -ranges[8 * row + 1], -ranges[8 * row + 2])
    scale = Vec3(_scale(ranges, row, 0), _scale(ranges, row, 1), _scale(ranges, row, 2))
    # From both halves by turns: neighbours fall into the same bin, and would wait for each other.
    half = (last - first) // 2
    for i in range(first, first + half):
        _put_in_bins(boxes, i, low, scale, bins, counts)
        _put_in_bins(boxes, i + half, low, scale, bins, counts)
    if first + 2 * half < last:
        _put_in_bins(boxes, last - 1, low, scale, bins, counts)


@kernel
def _best_split(boxes, first: int, last: int, ranges, row: int, bins, counts, costs):
    """(axis, bin) after which to split, by the surface area heuristic; axis -1 where all centres coincide."""
    _fill_bins(boxes, first, last, ranges, row, bins, counts)
    best, best_axis, best_bin = _INFINITY, -1, 0
    for axis in range(3):
        if _scale(ranges, row, axis) == ZERO:
            continue
        box, n = splat8(-_INFINITY), 0
        for b in range(_BINS - 1, 0, -1):
            box = max(box, load8(bins, 8 * (_BINS * axis + b)))
            n += at(counts, _BINS * axis + b)
            put(costs, b, _half_area(box) * f32(n))
        box, n = splat8(-_INFINITY), 0
        for b in range(_BINS - 1):
            box = max(box, load8(bins, 8 * (_BINS * axis + b)))
            n += at(counts, _BINS * axis + b)
            cost = _half_area(box) * f32(n) + at(costs, b + 1)
            if cost < best and n > 0 and n < last - first:
                best, best_axis, best_bin = cost, axis, b
    return best_axis, best_bin


@kernel
def _bound_sides(bins, axis: int, split: int):
    """Join the bins on either side of a split."""
    for side, begin, end in ((_LEFT, 0, split + 1), (_RIGHT, split + 1, _BINS)):
        box = splat8(-_INFINITY)
        for b in range(begin, end):
            box = max(box, load8(bins, 8 * (_BINS * axis + b)))
        store8(bins, 8 * side, box)


@kernel
def _partition(boxes, order, first: int, last: int, ranges, row: int, axis: int, split: int, bins) -> int:
    """Bring what lies up to a bin to the front; bound both sides, as `_bound` does. Returns where the rest begins.

    Each primitive changes places with the first of the rest, also one that stays there: on which side it is cannot be guessed.
    """
    low, scale = -ranges[8 * row + axis], _scale(ranges, row, axis)
    _bound_sides(bins, axis, split)
    _clear(bins, _LEFT + 1)
    _clear(bins, _RIGHT + 1)
    middle = first
    for k in range(first, last):
        box = load8(boxes, 8 * k)
        is_left = _bin_of(_center_along(boxes, k, axis), low, scale) <= split
        store8(boxes, 8 * k, load8(boxes, 8 * middle))
        store8(boxes, 8 * middle, box)
        number = at(order, k)
        put(order, k, at(order, middle))
        put(order, middle, number)
        _grow(bins, where(is_left, _LEFT + 1, _RIGHT + 1), _center(box))
        middle += np.int64(is_left)
    return middle


@kernel
def _bound(boxes, first: int, last: int, bins, side: int):
    """The box of a range of primitives, into row `side` of `bins`, and the range of their centres into the next."""
    _clear(bins, side)
    _clear(bins, side + 1)
    for i in range(first, last):
        box = load8(boxes, 8 * i)
        _grow(bins, side, box)
        _grow(bins, side + 1, _center(box))


@kernel
def _any_before(n, order, first: int, last: int) -> bool:
    """Whether any primitive of a range is one of the first n."""
    if n > 0:
        for i in range(first, last):
            if order[i] < n:
                return True
    return False


@kernel
def build_tree(boxes, order, nodes, stack, ranges, bins, counts, costs, leaf_size, above, used):
    """Fill `nodes`, and bring `order` and `boxes` into the order of the leaves; used[0] is the number of nodes.

    `boxes` (8 n,): the row of each primitive. The first used[1] primitives are trees, each a leaf of its own. `above`: how deep the
    root stands in a larger tree.

    `stack` (k, 4) holds what waits: node, first, last, depth; `ranges` (8 k + 8,) where its centres lie. Deep down, where the heuristic
    would make a list of it, the tree is split in the middle, so that no walk needs more than the stack it has. Scratch: `bins` (416,)
    float32, `counts` (48,) int32, `costs` (16,) float32.
    """
    count, top, n_trees = 1, 1, used[1]
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0, 0, order.shape[0], above
    _bound(boxes, 0, order.shape[0], bins, _LEFT)
    store8(ranges, 0, load8(bins, 8 * (_LEFT + 1)))
    while top > 0:
        top -= 1
        n, first, last, depth = np.int64(stack[top, 0]), np.int64(stack[top, 1]), np.int64(stack[top, 2]), stack[top, 3]
        middle, axis = (first + last) // 2, -1
        if depth < MAX_DEPTH // 2:
            axis, split = _best_split(boxes, first, last, ranges, top, bins, counts, costs)
            if axis >= 0:
                middle = _partition(boxes, order, first, last, ranges, top, axis, split, bins)
        if axis < 0:
            _bound(boxes, first, middle, bins, _LEFT)
            _bound(boxes, middle, last, bins, _RIGHT)
        for side in range(2):
            a, b = (first, middle) if side == 0 else (middle, last)
            row = 8 * (_LEFT + 2 * side)
            for c in range(3):
                nodes[n]["box"][6 * side + c], nodes[n]["box"][6 * side + 3 + c] = -bins[row + c], bins[row + 4 + c]
            if b - a == 1 or (b - a <= leaf_size and not _any_before(n_trees, order, a, b)):
                nodes[n]["child"][side], nodes[n]["count"][side] = -1 - a, b - a
            else:
                nodes[n]["child"][side], nodes[n]["count"][side] = count, 0
                stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3] = count, a, b, depth + 1
                store8(ranges, 8 * top, load8(bins, row + 8))
                top += 1
                count += 1
    used[0] = count
