"""The walk of a ray through the tree of eight children that leaves out nothing: all hits along the ray, in order."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.box import meet_box
from ..intersect.triangle import hit_triangle, turned_ray
from ..kernel.elementary import as_float
from ..kernel.lanes import first_set, lane, load8, mask_of
from ..kernel.vec import ONE, ZERO, Vec3
from .layouts import CORNERS, LINKS, NODE_WORDS, PACK_WORDS, TAG_WORDS
from .listed_triangles import insert_hit

__all__ = ["each_hit_of_eight"]

f32 = np.float32
_ERROR = f32(2.0**-21)


@kernel
def _with_pack(packs, tags, pack: int, ray, t_min, t_max, t, row, u, v, start: int, found: int) -> int:
    """Put the triangles of a pack that are hit among those already found; how many there are now."""
    place = PACK_WORDS * pack
    x, y, z = place + 8 * ray.kx, place + 8 * ray.ky, place + 8 * ray.kz
    a = Vec3(load8(packs, x), load8(packs, y), load8(packs, z))
    b = Vec3(load8(packs, x + 24), load8(packs, y + 24), load8(packs, z + 24))
    c = Vec3(load8(packs, x + 48), load8(packs, y + 48), load8(packs, z + 48))
    h = hit_triangle(ray, a, b, c, t_min, t_max)
    met = mask_of(h.t < t_max)
    while met != 0:
        i = np.int64(first_set(met))
        met = met & (met - 1)
        if t.shape[0] > 0:
            number = np.int64(tags[TAG_WORDS * pack + 8 + i])
            insert_hit(lane(h.t, i), number, lane(h.u, i), lane(h.v, i), t, row, u, v, start, start + found)
        found += 1
    return found


@kernel
def _slack(nodes, ray) -> np.float32:
    """As `accel.listed_triangles.slack_of`, from the corners that the root holds."""
    low, high = as_float(nodes[CORNERS + ray.kz]), as_float(nodes[CORNERS + 3 + ray.kz])
    return max(abs(low - ray.oz), abs(high - ray.oz)) * abs(ray.sz) * _ERROR


@kernel
def _eight(nodes, place: int):
    return as_float(load8(nodes, place))


@kernel
def each_hit_of_eight(nodes, packs, tags, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, t, row, u, v, start: int, waiting) -> int:
    """All triangles in (t_min, t_max), by t, of equal ones by number: how many. Written from `start` on, unless there is no room at all.

    Of a tree of triangles at rest alone, or of packs without a tree.
    """
    ray = turned_ray(o, d)
    inverse = Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
    found, top = 0, 0
    if nodes.shape[0] == 0:
        for pack in range(tags.shape[0] // TAG_WORDS):
            found = _with_pack(packs, tags, pack, ray, t_min, t_max, t, row, u, v, start, found)
        return found
    slack = _slack(nodes, ray)
    near_x, near_y, near_z = 24 if inverse.x < ZERO else 0, 32 if inverse.y < ZERO else 8, 40 if inverse.z < ZERO else 16
    waiting[0], top = 0, 1
    while top > 0:
        top -= 1
        link = np.int64(waiting[top])
        if link < 0:
            found = _with_pack(packs, tags, (-1 - link) >> 1, ray, t_min, t_max, t, row, u, v, start, found)
            continue
        place = NODE_WORDS * link
        near = Vec3(_eight(nodes, place + near_x), _eight(nodes, place + near_y), _eight(nodes, place + near_z))
        far = Vec3(_eight(nodes, place + 24 - near_x), _eight(nodes, place + 40 - near_y), _eight(nodes, place + 56 - near_z))
        enter, leave = meet_box(near, far, o, inverse, t_min, t_max, slack)
        entered = mask_of(enter <= leave)
        while entered != 0:
            waiting[top] = nodes[place + LINKS + np.int64(first_set(entered))]
            entered = entered & (entered - 1)
            top += 1
    return found
