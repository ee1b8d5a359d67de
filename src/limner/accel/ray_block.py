"""Rays of a batch as the walks through a tree want them, sixty-four at a time.

What a walk needs of a ray is computed for eight rays at once, and stands in rows of a block: a row for each number, a column for each ray.
From there a walk takes eight neighbours of a row into a register, or one ray's own number.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import Slabs, moved_on, slabs_of
from ..intersect.triangle import TurnedRay, turned_ray
from ..kernel.elementary import as_float
from ..kernel.lanes import at, count_set, load8, mask_of, max, put, splat8, splat8_int, store8, three_columns, where
from ..kernel.vec import ONE, ZERO, Vec3
from .layouts import BLOCK, CORNERS, PACK_WORDS
from .near_ray import LONGEST, SHORTEST, near_ray
from .walk import Hit, pack_hit

__all__ = [
    "DIRECTION", "END", "FIRST_EDGES", "HIT_T", "HIT_TRIANGLE", "HIT_U", "HIT_V", "INVERSE", "INVERSE_FAR", "ORIGIN", "ORIGIN_FAR", "SLACK",
    "n_triangles_in", "put_rays", "slabs_in", "slabs_of_eight", "three", "try_pack",
]  # fmt: skip

f32, f64 = np.float32, np.float64

# Rows of numbers: where a ray begins, where it goes, one over that; the same for planes that it meets last; as triangles want it; by how
# much the t of a hit may be off; the t of its best hit, or up to where it is followed, below zero where nothing is to be found; the
# weights of that hit; and up to where boxes are looked at, a little more than that t.
ORIGIN, DIRECTION, INVERSE, ORIGIN_FAR, INVERSE_FAR = (3 * k * BLOCK for k in range(5))
_TURNED, SLACK, HIT_T, HIT_U, HIT_V, END = (k * BLOCK for k in (15, 21, 22, 23, 24, 25))
# Rows of integers: the order of axes for triangles, where in a node the planes stand that are met first, the triangle of the best hit.
_AXES, FIRST_EDGES, HIT_TRIANGLE = 0, 3 * BLOCK, 6 * BLOCK

_ERROR = f32(2.0**-21)
_FAR_SQUARED = f32(15.9)  # of a sphere's radius: a little less than what `near_ray` takes as it is
_LONGEST, _SHORTEST = f32(0.99 * LONGEST), f32(1.01 * SHORTEST)


@kernel
def three(rows, place: int) -> Vec3:
    """Three rows of eight rays, from a row and a column on."""
    return Vec3(load8(rows, place), load8(rows, place + BLOCK), load8(rows, place + 2 * BLOCK))


@kernel
def _put_three(rows, place: int, x, y, z):
    store8(rows, place, x)
    store8(rows, place + BLOCK, y)
    store8(rows, place + 2 * BLOCK, z)


@kernel
def _one_of_three(rows, place: int) -> Vec3:
    return Vec3(at(rows, place), at(rows, place + BLOCK), at(rows, place + 2 * BLOCK))


@kernel
def slabs_in(numbers, ray: int) -> Slabs:
    """A ray of a block as boxes want it."""
    o, inverse = _one_of_three(numbers, ORIGIN + ray), _one_of_three(numbers, INVERSE + ray)
    return Slabs(o, inverse, _one_of_three(numbers, ORIGIN_FAR + ray), _one_of_three(numbers, INVERSE_FAR + ray))


@kernel
def slabs_of_eight(numbers, column: int) -> Slabs:
    """Eight rays of a block as boxes want them."""
    o, inverse = three(numbers, ORIGIN + column), three(numbers, INVERSE + column)
    return Slabs(o, inverse, three(numbers, ORIGIN_FAR + column), three(numbers, INVERSE_FAR + column))


@kernel
def _turned_in(numbers, integers, ray: int) -> TurnedRay:
    """A ray of a block as triangles want it."""
    s, o, axes = _one_of_three(numbers, _TURNED + ray), _one_of_three(numbers, _TURNED + 3 * BLOCK + ray), _AXES + ray
    kx, ky, kz = at(integers, axes), at(integers, axes + BLOCK), at(integers, axes + 2 * BLOCK)
    return TurnedRay(np.int64(kx), np.int64(ky), np.int64(kz), s.x, s.y, s.z, o.x, o.y, o.z)


@kernel
def _are_near(o: Vec3, d: Vec3, frame) -> bool:
    """Whether eight rays can be followed as they are given: nothing about them is far away, extreme, or no number."""
    if frame[3] != f64(1.0) or frame[0] != f64(0.0) or frame[1] != f64(0.0) or frame[2] != f64(0.0):
        return False
    x, y, z = o.x - f32(frame[4]), o.y - f32(frame[5]), o.z - f32(frame[6])
    dx, dy, dz = abs(d.x), abs(d.y), abs(d.z)
    # Written so that a NaN is not near.
    is_near = (x * x + y * y + z * z <= _FAR_SQUARED * f32(frame[7]) * f32(frame[7])) & (max(max(dx, dy), dz) >= _SHORTEST)
    return mask_of(is_near & (dx <= _LONGEST) & (dy <= _LONGEST) & (dz <= _LONGEST)) == 255


@kernel
def _gather(numbers, places, column: int, origins, directions, t_max, first: int, frame) -> bool:
    """Write where eight rays begin, where they go and how far. Returns whether they are followed as they are given."""
    n, many = origins.shape[0], t_max.shape[0] > 1
    if first + 8 <= n:
        x, y, z = three_columns(origins, first)
        dx, dy, dz = three_columns(directions, first)
        _put_three(numbers, ORIGIN + column, x, y, z)
        _put_three(numbers, DIRECTION + column, dx, dy, dz)
        if _are_near(Vec3(x, y, z), Vec3(dx, dy, dz), frame):
            store8(numbers, HIT_T + column, splat8(f32(t_max[0])))
            if many:
                for i in range(8):
                    numbers[HIT_T + column + i] = f32(t_max[first + i])
            return True
    for i in range(8):
        k, ray = min(first + i, n - 1), column + i
        near = near_ray(origins, directions, k, frame)
        numbers[ORIGIN + ray], numbers[ORIGIN + BLOCK + ray], numbers[ORIGIN + 2 * BLOCK + ray] = near.o.x, near.o.y, near.o.z
        numbers[DIRECTION + ray], numbers[DIRECTION + BLOCK + ray], numbers[DIRECTION + 2 * BLOCK + ray] = near.d.x, near.d.y, near.d.z
        is_sound = near.sound and first + i < n
        numbers[HIT_T + ray] = f32(t_max[k if many else 0] * near.length - near.start) if is_sound else -ONE
        places[ray], places[BLOCK + ray] = near.start, near.length
    return False


@kernel
def _slack_of(nodes, ray: TurnedRay):
    """Of eight rays, as `walk.slack_of`; 0 where there is no tree."""
    if nodes.shape[0] == 0:
        return splat8(ZERO)
    place = CORNERS
    x, y, z = as_float(nodes[place]), as_float(nodes[place + 1]), as_float(nodes[place + 2])
    low = where(ray.kz == 0, splat8(x), where(ray.kz == 1, splat8(y), splat8(z)))
    x, y, z = as_float(nodes[place + 3]), as_float(nodes[place + 4]), as_float(nodes[place + 5])
    high = where(ray.kz == 0, splat8(x), where(ray.kz == 1, splat8(y), splat8(z)))
    return max(abs(low - ray.oz), abs(high - ray.oz)) * abs(ray.sz) * _ERROR


@kernel
def put_rays(numbers, integers, places, column: int, origins, directions, t_max, first: int, frame, nodes) -> bool:
    """Write the rays `first` to `first` + 7 of (n, 3) to a block, from a column on; those beyond the last have nothing to look for.

    Returns whether they are followed as they are given. If not, `places` (BLOCK_PLACES,) float64 says where on its given ray each begins,
    and its length. `t_max` (n,), or (1,) for all. `frame` is that of `near_ray`.
    """
    as_given = _gather(numbers, places, column, origins, directions, t_max, first, frame)
    o, d = three(numbers, ORIGIN + column), three(numbers, DIRECTION + column)
    ray, inverse = turned_ray(o, d), Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
    slack = _slack_of(nodes, ray)
    slabs = slabs_of(o, d, inverse, slack)
    _put_three(numbers, INVERSE + column, inverse.x, inverse.y, inverse.z)
    _put_three(numbers, ORIGIN_FAR + column, slabs.o_far.x, slabs.o_far.y, slabs.o_far.z)
    _put_three(numbers, INVERSE_FAR + column, slabs.inverse_far.x, slabs.inverse_far.y, slabs.inverse_far.z)
    _put_three(numbers, _TURNED + column, ray.sx, ray.sy, ray.sz)
    _put_three(numbers, _TURNED + 3 * BLOCK + column, ray.ox, ray.oy, ray.oz)
    store8(numbers, SLACK + column, slack)
    store8(numbers, END + column, moved_on(load8(numbers, HIT_T + column), slack))
    _put_three(integers, _AXES + column, ray.kx, ray.ky, ray.kz)
    x, y, z = where(inverse.x < ZERO, 24, 0), where(inverse.y < ZERO, 32, 8), where(inverse.z < ZERO, 40, 16)
    _put_three(integers, FIRST_EDGES + column, x, y, z)
    store8(integers, HIT_TRIANGLE + column, splat8_int(-1))
    store8(numbers, HIT_U + column, splat8(ZERO))
    store8(numbers, HIT_V + column, splat8(ZERO))
    return as_given


@kernel
def try_pack(packs, tags, pack: int, numbers, integers, ray: int, any_hit):
    """Let a ray try the triangles of a pack."""
    best = Hit(at(numbers, HIT_T + ray), -1, -1, ZERO, ZERO)
    hit = pack_hit(packs, tags, pack, _turned_in(numbers, integers, ray), 0, ZERO, best, True, False)
    if hit.instance >= 0:
        put(numbers, HIT_U + ray, hit.u)
        put(numbers, HIT_V + ray, hit.v)
        put(integers, HIT_TRIANGLE + ray, hit.triangle)
        # Who needs no more than one hit meets nothing from here on.
        put(numbers, HIT_T + ray, -ONE if any_hit else hit.t)
        put(numbers, END + ray, -ONE if any_hit else moved_on(hit.t, at(numbers, SLACK + ray)))


@kernel
def n_triangles_in(packs, pack: int) -> int:
    """How many triangles a pack has."""
    x = load8(packs, PACK_WORDS * pack)
    return np.int64(count_set(mask_of(x == x)))
