"""Kernels that gather a scene's primitives and build the tree over them."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import sqrt
from ..kernel.transform import transform_point
from ..kernel.vec import ZERO, Vec3
from ..tables.layouts import OPAQUE, SPHERE
from .layouts import MAX_DEPTH

__all__ = ["build_tree", "gather_primitives"]

f32, i32 = np.float32, np.int32
_BINS = 16
_INFINITY = f32(np.inf)
_ONE = f32(1.0)


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


@kernel
def _center(bounds, k: int, axis: int) -> np.float32:
    """Twice the middle of a primitive's box: halving would change nothing."""
    return bounds[k, axis] + bounds[k, 3 + axis]


@kernel
def _half_area(b, row: int) -> np.float32:
    """Half the surface of the box in b[row, 0:6]; 0 for an empty one."""
    x, y, z = b[row, 3] - b[row, 0], b[row, 4] - b[row, 1], b[row, 5] - b[row, 2]
    return x * y + y * z + z * x if x >= ZERO else ZERO


@kernel
def _clear(b, row: int):
    for axis in range(3):
        b[row, axis], b[row, 3 + axis] = _INFINITY, -_INFINITY
    b[row, 6] = ZERO


@kernel
def _grow(b, row: int, source, k: int):
    for axis in range(3):
        b[row, axis] = min(b[row, axis], source[k, axis])
        b[row, 3 + axis] = max(b[row, 3 + axis], source[k, 3 + axis])


@kernel
def _center_range(bounds, order, first: int, last: int, axis: int):
    low, high = _INFINITY, -_INFINITY
    for i in range(first, last):
        c = _center(bounds, order[i], axis)
        low, high = min(low, c), max(high, c)
    return low, high


@kernel
def _bin_of(c: np.float32, low: np.float32, scale: np.float32) -> int:
    return min(max(int((c - low) * scale), 0), _BINS - 1)


@kernel
def _best_split(bounds, order, first: int, last: int, bins):
    """(axis, bin) after which to split, by the surface area heuristic; axis -1 where all centres coincide.

    `bins` (64, 8): rows 0..15 the bins (box and count), rows 16..31 the area times count of what lies right of each.
    """
    best, best_axis, best_bin = _INFINITY, -1, 0
    for axis in range(3):
        low, high = _center_range(bounds, order, first, last, axis)
        scale = f32(_BINS) / (high - low)
        if not (low < high and high - low < _INFINITY and scale < _INFINITY):
            continue
        for b in range(_BINS):
            _clear(bins, b)
        for i in range(first, last):
            b = _bin_of(_center(bounds, order[i], axis), low, scale)
            _grow(bins, b, bounds, np.int64(order[i]))
            bins[b, 6] += _ONE
        _clear(bins, 40)
        for b in range(_BINS - 1, 0, -1):
            _grow(bins, 40, bins, b)
            bins[40, 6] += bins[b, 6]
            bins[16 + b, 0] = _half_area(bins, 40) * bins[40, 6]
        _clear(bins, 41)
        for b in range(_BINS - 1):
            _grow(bins, 41, bins, b)
            bins[41, 6] += bins[b, 6]
            cost = _half_area(bins, 41) * bins[41, 6] + bins[16 + b + 1, 0]
            if cost < best and bins[41, 6] > ZERO and bins[41, 6] < f32(last - first):
                best, best_axis, best_bin = cost, axis, b
    return best_axis, best_bin


@kernel
def _partition(bounds, order, first: int, last: int, axis: int, split: int) -> int:
    """Bring what lies up to a bin to the front. Returns where the rest begins."""
    low, high = _center_range(bounds, order, first, last, axis)
    scale = f32(_BINS) / (high - low)
    i, j = first, last - 1
    while i <= j:
        if _bin_of(_center(bounds, order[i], axis), low, scale) <= split:
            i += 1
        else:
            order[i], order[j] = order[j], order[i]
            j -= 1
    return i


@kernel
def _set_child(node, side: int, bounds, order, first: int, last: int, bins):
    """Write the box of a child into its parent."""
    _clear(bins, 42)
    for i in range(first, last):
        _grow(bins, 42, bounds, np.int64(order[i]))
    for c in range(6):
        node["box"][6 * side + c] = bins[42, c]


@kernel
def _any_before(n, order, first: int, last: int) -> bool:
    """Whether any primitive of a range is one of the first n."""
    if n > 0:
        for i in range(first, last):
            if order[i] < n:
                return True
    return False


@kernel
def build_tree(bounds, order, nodes, stack, bins, leaf_size, used):
    """Fill `nodes` and bring `order` into the order of the leaves; used[0] is the number of nodes.

    The first used[1] primitives are trees, each a leaf of its own.

    `stack` (k, 4) holds what waits: node, first, last, depth. Deep down, where the heuristic would make a list of it, the tree is
    split in the middle, so that no walk needs more than the stack it has.
    """
    count, top = 1, 1
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0, 0, order.shape[0], 0
    while top > 0:
        top -= 1
        n, first, last, depth = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
        middle = (first + last) // 2
        if depth < MAX_DEPTH // 2:
            axis, split = _best_split(bounds, order, first, last, bins)
            if axis >= 0:
                middle = _partition(bounds, order, first, last, axis, split)
        for side in range(2):
            a, b = (first, middle) if side == 0 else (middle, last)
            _set_child(nodes[n], side, bounds, order, a, b, bins)
            if b - a == 1 or (b - a <= leaf_size and not _any_before(used[1], order, a, b)):
                nodes[n]["child"][side], nodes[n]["count"][side] = -1 - a, b - a
            else:
                nodes[n]["child"][side], nodes[n]["count"][side] = count, 0
                stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3] = count, a, b, depth + 1
                top += 1
                count += 1
    used[0] = count
