"""Many rays through one tree of triangles: the loops behind `accel.batch`.

Rays are taken in blocks (`ray_block`). Where all rays of a block, or eight neighbours, go nearly the same way, they are traced together
(`bundle`), all others by turns (`flight`).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import load8, store8, where
from ..kernel.vec import ZERO
from .bundle import is_bundle, meet_bundle
from .flight import follow_rays
from .layouts import BLOCK, TAG_WORDS
from .ray_block import HIT_T, HIT_TRIANGLE, HIT_U, HIT_V, n_triangles_in, put_rays, try_pack

__all__ = ["intersect_batch", "intersect_batch_single", "occluded_batch", "occluded_batch_single", "visits_batch"]

f32, f64 = np.float32, np.float64
_MISS = f32(np.inf)


@kernel
def _try_all(packs, tags, numbers, integers, n: int, any_hit):
    """Without a tree: every ray tries every triangle."""
    for ray in range(n):
        for pack in range(tags.shape[0] // TAG_WORDS):
            if numbers[HIT_T + ray] > ZERO:
                try_pack(packs, tags, pack, numbers, integers, ray, any_hit)


@kernel
def _trace_block(
    nodes, packs, tags, frame, origins, directions, t_max, begin: int, numbers, integers, places, flight, stack, any_hit
) -> int:
    """Fill a block with the rays from `begin` on, and find what they hit. Returns which eights are followed as they are given, as bits."""
    n, as_given, size = min(BLOCK, origins.shape[0] - begin), 0, f32(frame[7])
    for column in range(0, n, 8):
        if put_rays(numbers, integers, places, column, origins, directions, t_max, begin + column, frame, nodes):
            as_given = as_given | (1 << (column >> 3))
    if nodes.shape[0] == 0:
        _try_all(packs, tags, numbers, integers, n, any_hit)
    elif is_bundle(numbers, 0, n, size):
        meet_bundle(nodes, packs, tags, numbers, integers, 0, n, stack, any_hit)
    else:
        single = 0  # from this column on to the present one, rays are to be followed singly
        for column in range(0, n, 8):
            if is_bundle(numbers, column, column + 8, size):
                follow_rays(nodes, packs, tags, numbers, integers, single, column, flight, stack, any_hit, None)
                meet_bundle(nodes, packs, tags, numbers, integers, column, column + 8, stack, any_hit)
                single = column + 8
        follow_rays(nodes, packs, tags, numbers, integers, single, n, flight, stack, any_hit, None)
    return as_given


@kernel
def intersect_batch(
    nodes, packs, tags, frame, origins, directions, t_max, t, triangle, u, v, first, numbers, integers, places, flight, stack
):
    """Fill t, triangle, u and v from row `first` with the nearest hits of the rays (n, 3), each within (0, t_max).

    numbers, integers, places: a block, of BLOCK_NUMBERS, BLOCK_INTEGERS and BLOCK_PLACES; flight, stack: see `flight.follow_rays`.
    """
    for begin in range(0, origins.shape[0], BLOCK):
        as_given = _trace_block(
            nodes, packs, tags, frame, origins, directions, t_max, begin, numbers, integers, places, flight, stack, False
        )  # fmt: skip
        for column in range(0, min(BLOCK, origins.shape[0] - begin), 8):
            row = first + begin + column
            if as_given & (1 << (column >> 3)) != 0:
                found = load8(integers, HIT_TRIANGLE + column)
                store8(triangle, row, found)
                store8(t, row, where(found >= 0, load8(numbers, HIT_T + column), _MISS))
                store8(u, row, load8(numbers, HIT_U + column))
                store8(v, row, load8(numbers, HIT_V + column))
                continue
            for i in range(min(8, origins.shape[0] - begin - column)):
                ray = column + i
                triangle[row + i], u[row + i], v[row + i] = integers[HIT_TRIANGLE + ray], numbers[HIT_U + ray], numbers[HIT_V + ray]
                t[row + i] = _MISS
                if integers[HIT_TRIANGLE + ray] >= 0:
                    t[row + i] = f32((places[ray] + f64(numbers[HIT_T + ray])) / places[BLOCK + ray])


@kernel
def occluded_batch(nodes, packs, tags, frame, origins, directions, t_max, dark, first, numbers, integers, places, flight, stack):
    """Fill `dark` (uint8) from row `first`: whether anything lies within (0, t_max) of each ray."""
    for begin in range(0, origins.shape[0], BLOCK):
        _trace_block(nodes, packs, tags, frame, origins, directions, t_max, begin, numbers, integers, places, flight, stack, True)
        for ray in range(min(BLOCK, origins.shape[0] - begin)):
            dark[first + begin + ray] = 1 if integers[HIT_TRIANGLE + ray] >= 0 else 0


@kernel
def intersect_batch_single(
    nodes, packs, tags, frame, origins, directions, t_max, t, triangle, u, v, first, numbers, integers, places, flight, stack
):
    """As `intersect_batch`, for rays in float32."""
    intersect_batch(
        nodes, packs, tags, frame, origins, directions, t_max, t, triangle, u, v, first, numbers, integers, places, flight, stack
    )  # fmt: skip


@kernel
def occluded_batch_single(nodes, packs, tags, frame, origins, directions, t_max, dark, first, numbers, integers, places, flight, stack):
    """As `occluded_batch`, for rays in float32."""
    occluded_batch(nodes, packs, tags, frame, origins, directions, t_max, dark, first, numbers, integers, places, flight, stack)


@kernel
def visits_batch(nodes, packs, tags, frame, origins, directions, t_max, visits, first, any_hit, numbers, integers, places, flight, stack):
    """Add to `visits` (n, 2) int32 from row `first` how many nodes each ray meets, and triangles, followed by itself."""
    for begin in range(0, origins.shape[0], BLOCK):
        n = min(BLOCK, origins.shape[0] - begin)
        for column in range(0, n, 8):
            put_rays(numbers, integers, places, column, origins, directions, t_max, begin + column, frame, nodes)
        if nodes.shape[0] > 0:
            rows = visits[first + begin : first + begin + n]
            follow_rays(nodes, packs, tags, numbers, integers, 0, n, flight, stack, any_hit != 0, rows)
            continue
        for ray in range(n):
            for pack in range(tags.shape[0] // TAG_WORDS):
                if numbers[HIT_T + ray] > ZERO:
                    visits[first + begin + ray, 1] += n_triangles_in(packs, pack)
                    try_pack(packs, tags, pack, numbers, integers, ray, any_hit != 0)
