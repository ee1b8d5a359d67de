"""Eight rays that go nearly the same way, through the tree together: those of neighbouring pixels, say.

They meet nearly the same nodes, so these are looked at once for all: an interval that holds all eight origins and all eight directions
meets the eight boxes of a node (Reshetov, Soupikov and Hurley, *Multi-level ray tracing algorithm*, 2005; Boulos, Wald and Shirley,
*Geometric and arithmetic culling methods for entire ray packets*, 2006). Before a child is entered, its box is met by the eight rays, each
for itself; in a pack of triangles, only those that meet it are tried, one by one, by the function that tries single rays. What is found is
what single rays find, but where two triangles are hit at the very same t.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import meet_box, moved_on
from ..intersect.triangle import TurnedRay, turned_ray
from ..kernel.elementary import as_float, as_int
from ..kernel.lanes import first_set, highest, lane, load8, lowest, mask_of, max, min
from ..kernel.vec import ONE, ZERO, Vec3
from .layouts import LINKS, NODE_WORDS
from .walk import Hit, edges_of, pack_hit, slack_of

__all__ = ["HIT_T", "HIT_TRIANGLE", "HIT_U", "HIT_V", "is_bundle", "meet_bundle", "put_ray"]

f32 = np.float32
_MISS = f32(np.inf)

# Rows of eight, one number of each ray: the ray, the ray as triangles want it, and the best hit so far.
_O, _D, _INVERSE, _TURNED, HIT_T, HIT_U, HIT_V = 0, 24, 48, 72, 120, 128, 136
_AXES, HIT_TRIANGLE = 0, 24
_WIDEST, _FARTHEST = f32(0.05), f32(0.02)  # of a bundle: its directions, its origins as a share of what is looked at


@kernel
def put_ray(numbers, integers, k: int, o: Vec3, d: Vec3, t_max: np.float32):
    """Write ray k of a bundle."""
    ray = turned_ray(o, d)
    numbers[_O + k], numbers[_O + 8 + k], numbers[_O + 16 + k] = o.x, o.y, o.z
    numbers[_D + k], numbers[_D + 8 + k], numbers[_D + 16 + k] = d.x, d.y, d.z
    numbers[_INVERSE + k], numbers[_INVERSE + 8 + k], numbers[_INVERSE + 16 + k] = ONE / d.x, ONE / d.y, ONE / d.z
    numbers[_TURNED + k], numbers[_TURNED + 8 + k], numbers[_TURNED + 16 + k] = ray.sx, ray.sy, ray.sz
    numbers[_TURNED + 24 + k], numbers[_TURNED + 32 + k], numbers[_TURNED + 40 + k] = ray.ox, ray.oy, ray.oz
    integers[_AXES + k], integers[_AXES + 8 + k], integers[_AXES + 16 + k] = ray.kx, ray.ky, ray.kz
    numbers[HIT_T + k], integers[HIT_TRIANGLE + k] = t_max, -1


@kernel
def _turned(numbers, integers, k: int) -> TurnedRay:
    """Ray k as triangles want it."""
    kx, ky, kz = integers[_AXES + k], integers[_AXES + 8 + k], integers[_AXES + 16 + k]
    sx, sy, sz = numbers[_TURNED + k], numbers[_TURNED + 8 + k], numbers[_TURNED + 16 + k]
    ox, oy, oz = numbers[_TURNED + 24 + k], numbers[_TURNED + 32 + k], numbers[_TURNED + 40 + k]
    return TurnedRay(np.int64(kx), np.int64(ky), np.int64(kz), sx, sy, sz, ox, oy, oz)


@kernel
def is_bundle(numbers, size: np.float32) -> bool:
    """Whether the eight rays keep together: origins near each other, for a mesh of a size, directions too, none along a slab."""
    widest = ZERO
    for axis in range(3):
        o, d = load8(numbers, _O + 8 * axis), load8(numbers, _D + 8 * axis)
        low, high = lowest(d), highest(d)
        # An axis that some rays go up and others down has no near side.
        if not (low > ZERO or high < ZERO) or not highest(o) - lowest(o) <= _FARTHEST * size:
            return False
        widest = max(widest, high - low)
        inverse = load8(numbers, _INVERSE + 8 * axis)
        if not (lowest(inverse) > -_MISS and highest(inverse) < _MISS):
            return False
    length = max(max(abs(numbers[_D]), abs(numbers[_D + 8])), abs(numbers[_D + 16]))
    return widest <= _WIDEST * length


@kernel
def _three(numbers, row: int) -> Vec3:
    return Vec3(load8(numbers, row), load8(numbers, row + 8), load8(numbers, row + 16))


@kernel
def _pushed(place: int, enter, entered, stack, top: int) -> int:
    """The new top of the stack, with a node's children on it that are entered, the nearest uppermost; `place`: eight times the node."""
    bottom = top
    while entered != 0:
        i = np.int64(first_set(entered))
        entered = entered & (entered - 1)
        bits, j = as_int(lane(enter, i)), top
        while j > bottom and stack[2 * j - 1] < bits:
            stack[2 * j], stack[2 * j + 1] = stack[2 * j - 2], stack[2 * j - 1]
            j -= 1
        stack[2 * j], stack[2 * j + 1] = place + i, bits
        top += 1
    return top


@kernel
def _try_pack(packs, tags, pack: int, numbers, integers, active, any_hit):
    """Let the rays of a mask try the triangles of a pack."""
    while active != 0:
        k = np.int64(first_set(active))
        active = active & (active - 1)
        best = Hit(numbers[HIT_T + k], -1, -1, ZERO, ZERO)
        hit = pack_hit(packs, tags, pack, _turned(numbers, integers, k), 0, ZERO, best, True, False)
        if hit.instance >= 0:
            numbers[HIT_U + k], numbers[HIT_V + k], integers[HIT_TRIANGLE + k] = hit.u, hit.v, hit.triangle
            # Who needs no more than one hit meets nothing from here on.
            numbers[HIT_T + k] = -ONE if any_hit else hit.t


@kernel
def _first_bound(edge, o: np.float32, low: np.float32, high: np.float32):
    """The least t at which a ray of the bundle can meet a plane, or eight; `o`: the origin that is farthest on."""
    return min((edge - o) * low, (edge - o) * high)


@kernel
def _last_bound(edge, o: np.float32, low: np.float32, high: np.float32):
    return max((edge - o) * low, (edge - o) * high)


@kernel
def meet_bundle(accelerator, numbers, integers, stack, any_hit):
    """Find the nearest hit of each of the eight rays, or any, in a tree of triangles alone that has nodes.

    HIT_T then is below 0 where any hit was asked for, and found.
    """
    nodes, packs, tags, _, _, _ = accelerator
    o, inverse = _three(numbers, _O), _three(numbers, _INVERSE)
    slack = ZERO
    for k in range(8):
        slack = max(slack, slack_of(nodes, 0, _turned(numbers, integers, k)))
    lowest_o, highest_o = Vec3(lowest(o.x), lowest(o.y), lowest(o.z)), Vec3(highest(o.x), highest(o.y), highest(o.z))
    low = Vec3(lowest(inverse.x), lowest(inverse.y), lowest(inverse.z))
    high = Vec3(highest(inverse.x), highest(inverse.y), highest(inverse.z))
    back_x, back_y, back_z = low.x < ZERO, low.y < ZERO, low.z < ZERO
    near_x, near_y, near_z = 24 if back_x else 0, 32 if back_y else 8, 40 if back_z else 16
    ahead = Vec3(lowest_o.x if back_x else highest_o.x, lowest_o.y if back_y else highest_o.y, lowest_o.z if back_z else highest_o.z)
    behind = Vec3(highest_o.x if back_x else lowest_o.x, highest_o.y if back_y else lowest_o.y, highest_o.z if back_z else lowest_o.z)
    farthest = highest(load8(numbers, HIT_T))
    current, top = 0, 0
    while True:
        place = NODE_WORDS * current
        near = Vec3(edges_of(nodes, place + near_x), edges_of(nodes, place + near_y), edges_of(nodes, place + near_z))
        far = Vec3(edges_of(nodes, place + 24 - near_x), edges_of(nodes, place + 40 - near_y), edges_of(nodes, place + 56 - near_z))
        enter = max(ZERO, _first_bound(near.x, ahead.x, low.x, high.x))
        enter = max(enter, _first_bound(near.y, ahead.y, low.y, high.y))
        enter = max(enter, _first_bound(near.z, ahead.z, low.z, high.z))
        leave = min(farthest, _last_bound(far.x, behind.x, low.x, high.x))
        leave = min(leave, _last_bound(far.y, behind.y, low.y, high.y))
        leave = min(leave, _last_bound(far.z, behind.z, low.z, high.z))
        top = _pushed(8 * current, enter, mask_of(enter <= moved_on(leave, slack)), stack, top)
        current = -1
        while current < 0:
            if top == 0:
                return
            top -= 1
            if as_float(stack[2 * top + 1]) > moved_on(farthest, slack):
                continue
            child = np.int64(stack[2 * top])
            place = NODE_WORDS * (child >> 3) + (child & 7)
            box_near = Vec3(as_float(nodes[place + near_x]), as_float(nodes[place + near_y]), as_float(nodes[place + near_z]))
            box_far = Vec3(as_float(nodes[place + 24 - near_x]), as_float(nodes[place + 40 - near_y]), as_float(nodes[place + 56 - near_z]))
            begin, end = meet_box(box_near, box_far, o, inverse, ZERO, load8(numbers, HIT_T), slack)
            active = mask_of(begin <= end)
            if active == 0:
                continue
            link = np.int64(nodes[place + LINKS])
            if link >= 0:
                current = link
            else:
                _try_pack(packs, tags, (-1 - link) >> 1, numbers, integers, active, any_hit)
                farthest = highest(load8(numbers, HIT_T))
                if any_hit and farthest < ZERO:
                    return
