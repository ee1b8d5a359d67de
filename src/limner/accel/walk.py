"""The walk of a ray through the tree: near boxes first, and what lies behind the best hit so far not at all."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import inlined, kernel, outlined
from ..intersect.box import meet_box, moved_on
from ..intersect.csg import intersect_csg
from ..intersect.distance_field import intersect_distance_field
from ..intersect.layouts import CSG, DISTANCE_FIELD
from ..intersect.shape import intersect_shape
from ..intersect.surface_code import surface_code
from ..intersect.triangle import TriangleHit, TurnedRay, hit_triangle, turned_ray
from ..kernel.elementary import as_float, as_int
from ..kernel.lanes import any_of, first_set, lane, load8, lowest, mask_of, prefetch, where
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Vec3
from ..shading.analytic import hit_analytic, meets_outside
from .layouts import (
    CORNERS,
    FIRST_TREE,
    KEY_NODES,
    KEY_PACKS,
    LINKS,
    NODE_WORDS,
    NOT_OPAQUE,
    NOT_PLAIN,
    ONLY_BACK,
    ONLY_FRONT,
    PACK_WORDS,
    TAG_WORDS,
    TREE_LINK,
)  # fmt: skip

__all__ = [
    "Hit", "edges_of", "exact_tables", "first_hit", "hit_of_others", "line_of", "line_within", "met_boxes", "miss", "nearest", "occluded",
    "pack_hit", "slack_of", "walk",
]  # fmt: skip

f32 = np.float32
_INFINITY = f32(np.inf)
_ERROR = f32(2.0**-21)
_NOWHERE = -(1 << 40)  # no link
_LEAVE = -(1 << 31)  # where a mesh's tree ends: back to the world


class Hit(NamedTuple):
    """What a ray meets.

    t: its parameter, infinity for a miss. instance: -1 for a miss; of a combination of solids, the leaf whose surface it is.
    triangle: of the instance's mesh; negative for an exact shape: `intersect.surface_code`.
    u, v: barycentrics of the triangle's second and third vertex; of a patch, its own.
    """

    t: np.float32
    instance: int
    triangle: int
    u: np.float32
    v: np.float32


class _Bend(NamedTuple):
    """How a mesh bends: how far behind its packs those of the next key stand, 0 where it does not, and the share of the way to them."""

    later: int
    share: np.float32


_NO_BEND = _Bend(0, ZERO)


@kernel
def miss(t_max: np.float32) -> Hit:
    return Hit(t_max, -1, -1, ZERO, ZERO)


@kernel
def exact_tables(attributes, slots, ends):
    """The sixth of what kernels take for an accelerator (`accel.layouts.Accelerator`), from a door's arguments.

    None, known to the compiler, where `ends` has one dimension: such a door meets no exact shapes but spheres and planes, and neither
    compiles nor asks for the others.
    """
    if ends.ndim == 1:
        return None
    return attributes, slots, ends


@outlined
def _exact_hit(instances, row: int, exact, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool) -> Hit:
    """The nearest hit of any exact shape but spheres and planes, which stand in the loop itself."""
    numbers, programs, ends = exact
    shape = instances[row]
    if shape["kind"] == CSG:
        c = intersect_csg(shape, instances, numbers, programs, o, d, t_min, t_max, both_sides, ends)
        return Hit(c.t, np.int64(c.leaf), surface_code(c.part, c.flipped), ZERO, ZERO) if c.leaf >= 0 else miss(t_max)
    if shape["kind"] == DISTANCE_FIELD:
        h = intersect_distance_field(shape, numbers, o, d, t_min, t_max, both_sides, ends)
    else:
        h = intersect_shape(shape, numbers, o, d, t_min, t_max, both_sides)
    return Hit(h.t, np.int64(row), surface_code(h.part, 0), h.u, h.v) if h.part >= 0 else miss(t_max)


@kernel
def _other_hit(instances, p, exact, o: Vec3, d: Vec3, t_min: np.float32, best: Hit, both_sides: bool) -> Hit:
    """The nearer of `best` and a primitive that is no triangle."""
    both = both_sides or p["facing"] == 0
    if exact is not None:  # known to the compiler
        if p["triangle"] < -1:
            hit = _exact_hit(instances, np.int64(p["instance"]), exact, o, d, t_min, best.t, both)
            return hit if hit.t < best.t else best
    t = hit_analytic(instances[p["instance"]], o, d, t_min, best.t)
    if t < best.t and (both or meets_outside(instances[p["instance"]], o, d, t)):
        return Hit(t, np.int64(p["instance"]), -1, ZERO, ZERO)
    return best


@kernel
def _unbounded_hit(instances, planes, exact, o: Vec3, d: Vec3, t_min: np.float32, best: Hit, both_sides, opaque_only) -> Hit:
    """The nearer of `best` and what has no bounds."""
    for k in range(planes.shape[0]):
        if not (opaque_only and planes[k]["opaque"] == 0):
            best = _other_hit(instances, planes[k], exact, o, d, t_min, best, both_sides)
    return best


@inlined
def pack_hit(packs, tags, pack: int, ray: TurnedRay, owner: int, t_min, best: Hit, both_sides, opaque_only) -> Hit:
    """The nearer of `best` and the triangles of a pack; `owner`: the instance in whose space it stands, 0 in the world's."""
    place = PACK_WORDS * pack
    x, y, z = place + 8 * ray.kx, place + 8 * ray.ky, place + 8 * ray.kz
    a = Vec3(load8(packs, x), load8(packs, y), load8(packs, z))
    b = Vec3(load8(packs, x + 24), load8(packs, y + 24), load8(packs, z + 24))
    c = Vec3(load8(packs, x + 48), load8(packs, y + 48), load8(packs, z + 48))
    return _nearest_of_eight(hit_triangle(ray, a, b, c, t_min, best.t), tags, pack, owner, best, both_sides, opaque_only)


@kernel
def _nearest_of_eight(h: TriangleHit, tags, pack: int, owner: int, best: Hit, both_sides, opaque_only) -> Hit:
    """The nearer of `best` and what eight triangles say of a ray."""
    met = h.t < best.t
    if any_of(met):
        tag = load8(tags, TAG_WORDS * pack)
        met = met & ((tag & NOT_PLAIN) == 0)
        if opaque_only:
            met = met & ((tag & NOT_OPAQUE) == 0)
        if not both_sides:
            met = met & (((tag & ONLY_FRONT) == 0) | (h.facing > ZERO)) & (((tag & ONLY_BACK) == 0) | (h.facing < ZERO))
        if any_of(met):
            nearest_t = lowest(where(met, h.t, _INFINITY))
            i = np.int64(first_set(mask_of(met & (h.t == nearest_t))))
            row = TAG_WORDS * pack + i
            return Hit(nearest_t, owner + (np.int64(tags[row]) >> 4), np.int64(tags[row + 8]), lane(h.u, i), lane(h.v, i))
    return best


@kernel
def _between(packs, now: int, later: int, share: np.float32):
    """Eight numbers on their way from one key to the next."""
    a = load8(packs, now)
    return a + (load8(packs, now + later) - a) * share


@outlined
def _bent_pack_hit(packs, tags, pack: int, bend: _Bend, ray: TurnedRay, owner: int, t_min, best: Hit, both_sides, opaque_only) -> Hit:
    """As `pack_hit`, of a mesh that bends, at its instance's time."""
    place, later, share = PACK_WORDS * pack, bend.later, bend.share
    x, y, z = place + 8 * ray.kx, place + 8 * ray.ky, place + 8 * ray.kz
    a = Vec3(_between(packs, x, later, share), _between(packs, y, later, share), _between(packs, z, later, share))
    b = Vec3(_between(packs, x + 24, later, share), _between(packs, y + 24, later, share), _between(packs, z + 24, later, share))
    c = Vec3(_between(packs, x + 48, later, share), _between(packs, y + 48, later, share), _between(packs, z + 48, later, share))
    return _nearest_of_eight(hit_triangle(ray, a, b, c, t_min, best.t), tags, pack, owner, best, both_sides, opaque_only)


@kernel
def _hit_of_triangles(
    exact, packs, tags, pack: int, bend: _Bend, ray: TurnedRay, owner: int, t_min, best: Hit, both_sides, opaque_only,
) -> Hit:
    """The nearer of `best` and the triangles of a pack; whether a door knows of what bends, the compiler knows."""
    if exact is not None:
        if bend.later > 0:
            return _bent_pack_hit(packs, tags, pack, bend, ray, owner, t_min, best, both_sides, opaque_only)
    return pack_hit(packs, tags, pack, ray, owner, t_min, best, both_sides, opaque_only)


@kernel
def _bend_of(exact, nodes, instance, root: int):
    """The root of an instance's tree at its time, and how it bends."""
    if exact is not None:
        if instance["key"] > 0:
            place = NODE_WORDS * root
            later = PACK_WORDS * np.int64(nodes[place + KEY_PACKS])
            root = root + np.int64(nodes[place + KEY_NODES]) * (np.int64(instance["key"]) - 1)
            return root, _Bend(later, instance["share"])
    return root, _NO_BEND


@outlined
def hit_of_others(
    instances, tags, primitives, exact, pack: int, o: Vec3, d: Vec3, t_min: np.float32, best: Hit, both_sides: bool, opaque_only: bool,
) -> Hit:
    """The nearer of `best` and what in a pack is no triangle."""
    for i in range(8):
        if tags[TAG_WORDS * pack + i] & NOT_PLAIN != 0:
            p = primitives[tags[TAG_WORDS * pack + 8 + i]]
            if not (opaque_only and p["opaque"] == 0):
                best = _other_hit(instances, p, exact, o, d, t_min, best, both_sides)
    return best


@kernel
def _with_nearest_first(nodes, place: int, enter, entered, link: int, bits, stack, top: int):
    """The link of the nearest of a node's children, the other ones pushed; `link` is the one that enters at `bits`, `entered` the rest."""
    bottom = top
    while entered != 0:
        i = np.int64(first_set(entered))
        entered = entered & (entered - 1)
        other, other_bits = np.int64(nodes[place + i]), as_int(lane(enter, i))
        is_nearer = other_bits < bits
        pushed, pushed_bits = (link, bits) if is_nearer else (other, other_bits)
        link, bits = (other, other_bits) if is_nearer else (link, bits)
        j = top
        while j > bottom and stack[2 * j - 1] < pushed_bits:
            stack[2 * j], stack[2 * j + 1] = stack[2 * j - 2], stack[2 * j - 1]
            j -= 1
        stack[2 * j], stack[2 * j + 1] = pushed, pushed_bits
        top += 1
        if pushed >= 0:
            for line in range(0, NODE_WORDS, 16):
                prefetch(nodes, NODE_WORDS * pushed + line)
    return link, top


@kernel
def edges_of(nodes, place: int):
    """One edge of the eight boxes of a node."""
    return as_float(load8(nodes, place))


class _Line(NamedTuple):
    """A ray in the space of a tree, as its boxes and its triangles want it."""

    o: Vec3
    inverse: Vec3
    turned: TurnedRay
    slack: np.float32  # by how much the t of a hit may be off
    near_x: int  # where, in a node, the planes stand that the ray meets first
    near_y: int
    near_z: int


@kernel
def slack_of(nodes, root: int, ray: TurnedRay) -> np.float32:
    """By how much the t of a hit may be off: it is a mean of its vertices' t, so its error is one of the greatest of them, not its own."""
    place = NODE_WORDS * root + CORNERS + ray.kz
    low, high = as_float(nodes[place]), as_float(nodes[place + 3])
    return max(abs(low - ray.oz), abs(high - ray.oz)) * abs(ray.sz) * _ERROR


@kernel
def line_of(nodes, root: int, o: Vec3, d: Vec3) -> _Line:
    """The ray for the tree at `root`."""
    ray = turned_ray(o, d)
    inverse = Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
    near_x, near_y, near_z = 24 if inverse.x < ZERO else 0, 32 if inverse.y < ZERO else 8, 40 if inverse.z < ZERO else 16
    return _Line(o, inverse, ray, slack_of(nodes, root, ray), near_x, near_y, near_z)


@kernel
def line_within(nodes, instance, root: int, o: Vec3, d: Vec3) -> _Line:
    """The ray in an instance's own space; its parameter stays what it is."""
    m = instance["object_from_world"]
    return line_of(nodes, root, transform_point(m, o), transform_vector(m, d))


@kernel
def met_boxes(nodes, node: int, line: _Line, t_min: np.float32, t_max: np.float32):
    """(where the ray enters each of a node's boxes, which of them it meets, as bits)"""
    place = NODE_WORDS * node
    x, y, z = line.near_x, line.near_y, line.near_z
    near = Vec3(edges_of(nodes, place + x), edges_of(nodes, place + y), edges_of(nodes, place + z))
    far = Vec3(edges_of(nodes, place + 24 - x), edges_of(nodes, place + 40 - y), edges_of(nodes, place + 56 - z))
    enter, leave = meet_box(near, far, line.o, line.inverse, t_min, t_max, line.slack)
    return enter, mask_of(enter <= leave)


@inlined
def walk(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack, any_hit, both_sides, opaque_only) -> Hit:
    """The nearest hit in (t_min, t_max), or any; t_min >= 0.

    What waits is on `stack` (int32), two words each: the link, and the bits of where the ray enters its box, the nearest on top; it is
    dropped when it comes up if something nearer was found meanwhile. In a mesh's own space the walk goes on as in the world, above a link
    that leads back.
    """
    nodes, packs, tags, primitives, planes, exact = accelerator
    best = _unbounded_hit(instances, planes, exact, o, d, t_min, miss(t_max), both_sides, opaque_only)
    if any_hit and best.instance != -1:
        return best
    if nodes.shape[0] == 0:
        ray = turned_ray(o, d)
        for pack in range(tags.shape[0] // TAG_WORDS):
            best = pack_hit(packs, tags, pack, ray, 0, t_min, best, both_sides, opaque_only)
            best = hit_of_others(instances, tags, primitives, exact, pack, o, d, t_min, best, both_sides, opaque_only)
        return best
    in_world = line_of(nodes, 0, o, d)
    line, owner, current, top = in_world, 0, 0, 0
    bend = _NO_BEND
    while True:
        enter, entered = met_boxes(nodes, current, line, t_min, best.t)
        link = _NOWHERE
        if entered != 0:
            i = np.int64(first_set(entered))
            entered = entered & (entered - 1)
            place = NODE_WORDS * current + LINKS
            link = np.int64(nodes[place + i])
            if entered != 0:
                link, top = _with_nearest_first(nodes, place, enter, entered, link, as_int(lane(enter, i)), stack, top)
        while link < 0:
            if link > TREE_LINK:
                pack = (-1 - link) >> 1
                best = _hit_of_triangles(exact, packs, tags, pack, bend, line.turned, owner, t_min, best, both_sides, opaque_only)
                if link & 1 == 0:
                    best = hit_of_others(instances, tags, primitives, exact, pack, o, d, t_min, best, both_sides, opaque_only)
                if any_hit and best.instance != -1:
                    return best
            elif link == _LEAVE:
                line, owner, bend = in_world, 0, _NO_BEND
            elif link != _NOWHERE:
                p = primitives[TREE_LINK - link]
                if not (opaque_only and p["opaque"] == 0):
                    stack[2 * top], stack[2 * top + 1] = _LEAVE, 0
                    top += 1
                    owner = np.int64(p["instance"])
                    link, bend = _bend_of(exact, nodes, instances[owner], FIRST_TREE - np.int64(p["triangle"]))
                    line = line_within(nodes, instances[owner], link, o, d)
                    break
            while True:
                if top == 0:
                    return best
                top -= 1
                if as_float(stack[2 * top + 1]) <= moved_on(best.t, line.slack):
                    break
            link = np.int64(stack[2 * top])
        current = link


@kernel
def nearest(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack) -> Hit:
    """The nearest hit in (t_min, t_max); single-sided triangles are met from their front only. t is infinite for a miss."""
    hit = walk(accelerator, instances, o, d, t_min, t_max, stack, False, False, False)
    return hit if hit.instance >= 0 else miss(_INFINITY)


@kernel
def first_hit(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool, stack) -> Hit:
    """The nearest hit in (t_min, t_max); `both_sides`: single-sided triangles are met from behind as well. t is infinite for a miss."""
    hit = walk(accelerator, instances, o, d, t_min, t_max, stack, False, both_sides, False)
    return hit if hit.instance >= 0 else miss(_INFINITY)


@kernel
def occluded(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack) -> bool:
    """Whether anything opaque lies in (t_min, t_max); both sides of every triangle count."""
    return walk(accelerator, instances, o, d, t_min, t_max, stack, True, True, True).instance != -1
