"""Many rays through one tree of triangles: the loops behind `accel.batch`.

Rays are taken in blocks (`ray_block`). Eight neighbours of a block that go nearly the same way are traced together (`bundle`), all others
several by turns (`flight`).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO
from .bundle import is_bundle, meet_bundle
from .flight import follow_rays
from .layouts import BLOCK, TAG_WORDS
from .ray_block import HIT_T, HIT_TRIANGLE, HIT_U, HIT_V, put_rays, try_pack

__all__ = ["intersect_batch", "occluded_batch"]

f32, f64 = np.float32, np.float64


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
    """Fill a block with the rays from `begin` on, and find what they hit. Returns how many they are."""
    n = min(BLOCK, origins.shape[0] - begin)
    single = 0  # from this column on to the present one, rays are to be followed singly
    for column in range(0, n, 8):
        put_rays(numbers, integers, places, column, origins, directions, t_max, begin + column, frame, nodes)
        if nodes.shape[0] > 0 and is_bundle(numbers, column, f32(frame[7])):
            follow_rays(nodes, packs, tags, numbers, integers, single, column, flight, stack, any_hit)
            meet_bundle(nodes, packs, tags, numbers, integers, column, stack, any_hit)
            single = column + 8
    if nodes.shape[0] > 0:
        follow_rays(nodes, packs, tags, numbers, integers, single, n, flight, stack, any_hit)
    else:
        _try_all(packs, tags, numbers, integers, n, any_hit)
    return n


@kernel
def intersect_batch(
    nodes, packs, tags, frame, origins, directions, t_max, t, triangle, uv, first, numbers, integers, places, flight, stack
):  # fmt: skip
    """Fill t, triangle and uv from row `first` with the nearest hits of the rays (n, 3), each within (0, t_max).

    numbers, integers, places: a block, of BLOCK_NUMBERS, BLOCK_INTEGERS and BLOCK_PLACES; flight, stack: see `flight.follow_rays`.
    """
    for begin in range(0, origins.shape[0], BLOCK):
        n = _trace_block(
            nodes, packs, tags, frame, origins, directions, t_max, begin, numbers, integers, places, flight, stack, False
        )  # fmt: skip
        for ray in range(n):
            row, found = first + begin + ray, integers[HIT_TRIANGLE + ray]
            t[row], triangle[row], uv[0, row], uv[1, row] = f32(np.inf), found, ZERO, ZERO
            if found >= 0:
                t[row] = f32((places[ray] + f64(numbers[HIT_T + ray])) / places[BLOCK + ray])
                uv[0, row], uv[1, row] = numbers[HIT_U + ray], numbers[HIT_V + ray]


@kernel
def occluded_batch(nodes, packs, tags, frame, origins, directions, t_max, dark, first, numbers, integers, places, flight, stack):
    """Fill `dark` (uint8) from row `first`: whether anything lies within (0, t_max) of each ray."""
    for begin in range(0, origins.shape[0], BLOCK):
        n = _trace_block(
            nodes, packs, tags, frame, origins, directions, t_max, begin, numbers, integers, places, flight, stack, True
        )  # fmt: skip
        for ray in range(n):
            dark[first + begin + ray] = 1 if integers[HIT_TRIANGLE + ray] >= 0 else 0
