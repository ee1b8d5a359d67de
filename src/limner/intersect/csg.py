"""Constructive solid geometry (FoCG 13.3): union, intersection, difference and complement of solids, by the ray's spans in each.

Along a ray, a solid is where it begins and where it ends. All ends of all leaves, in order, are the only places where the answer to
"is this point in the whole?" can change; between them each leaf is in or out, one bit each, and the program of Boolean operations says
what follows. The first end at which the answer changes is the hit:

    A      ├────────────┤                A - B
    B            ├──────────┤
           ├─────┤                       hit at A's first end, left at B's first: B's surface, turned inside out

Where surfaces of two leaves coincide, rounding would decide which comes first, and a film without thickness would flicker. Ends
of different leaves closer together than rounding can tell count as one place, crossed at once: A - B has no film where A and B begin
together, and A | B no wall where one ends and the other begins. Of leaves that share a place, the surface belongs to the first, in
the order of the leaves, at which the answer changes. That is the regularised set operation of Requicha (1977).

Layouts of solids, leaves and programs: `intersect.layouts`.

**Source**: Roth, *Ray casting for modeling solids*, 1982, with bits in place of merged lists.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3
from .interval import FAR, ray_in
from .layouts import COMPLEMENT, INTERSECTION, UNION
from .shape import shape_at, solid_spans

__all__ = ["CsgHit", "holds", "intersect_csg", "is_inside"]

f32, f64, i64 = np.float32, np.float64, np.int64
_INFINITY = f32(np.inf)
_ONE_BIT, _NO_BITS = i64(1), i64(0)
_SAME = f64(2.0**-20)  # how far apart rounded transforms may put what is one place, relative to what was rounded
_STEEPEST = f64(64.0)  # beyond, the surface is met at less than a degree
_BEYOND, _PASSED = 4, 5  # columns of `ends` after a leaf's four


class CsgHit(NamedTuple):
    """What a ray meets of a solid.

    t: its parameter, infinity for a miss. leaf: the row of the leaf whose surface it is, -1 for a miss. part: of the leaf's surface.
    flipped: 1 where the whole lies outside the leaf, so that its normals are the leaf's, negated. facing: 1 where the whole is
    entered, -1 where it is left; 0 for a miss.
    """

    t: np.float32
    leaf: int
    part: int
    flipped: int
    facing: np.float32


@kernel
def _miss() -> CsgHit:
    return CsgHit(_INFINITY, -1, -1, 0, ZERO)


@kernel
def holds(programs, first: int, count: int, inside: np.int64) -> bool:
    """What the program programs[first : first + count] says of a point that is in the leaves whose bits are set.

    Its stack of truth values is a number, too: one bit each, the lowest on top.
    """
    stack = _NO_BITS
    for k in range(first, first + count):
        token = i64(programs[k])
        if token >= 0:
            stack = (stack << _ONE_BIT) | ((inside >> token) & _ONE_BIT)
        elif token == COMPLEMENT:
            stack = stack ^ _ONE_BIT
        else:
            top = stack & _ONE_BIT
            stack = stack >> _ONE_BIT
            if token == UNION:
                stack = stack | top
            elif token == INTERSECTION:
                stack = stack & (top | ~_ONE_BIT)
            else:
                stack = stack & ~top
    return (stack & _ONE_BIT) != _NO_BITS


@kernel
def _begin(solid, leaves, numbers, o: Vec3, d: Vec3, t_min: np.float32, ends) -> np.int64:
    """Fill `ends` with where the ray is inside each leaf, and count those up to t_min. Returns the leaves that it is in there."""
    inside = _NO_BITS
    for k in range(solid["n_leaves"]):
        leaf = leaves[solid["leaf"] + k]
        s = solid_spans(leaf, numbers, ray_in(leaf["object_from_world"], o, d))
        ends[k, 0], ends[k, 1], ends[k, 2], ends[k, 3], ends[k, _BEYOND] = s.t0, s.t1, s.t2, s.t3, FAR
        passed = 0
        while passed < _BEYOND and f32(ends[k, passed]) <= t_min and ends[k, passed] < FAR:
            passed += 1
        ends[k, _PASSED] = passed
        if passed % 2 == 1:
            inside = inside | (_ONE_BIT << i64(k))
    return inside


@kernel
def _part(leaf, numbers, o: Vec3, d: Vec3, end: int) -> int:
    """The part of a leaf's surface at one of its four ends."""
    s = solid_spans(leaf, numbers, ray_in(leaf["object_from_world"], o, d))
    if end < 2:
        return s.part0 if end == 0 else s.part1
    return s.part2 if end == 2 else s.part3


@kernel
def _same_place(leaf, o: Vec3, d: Vec3, t: np.float64) -> np.float64:
    """How much greater than t, an end of a leaf met head on, another may be and still be the same place.

    Rays are taken to the leaves without rounding, so an end is as wrong as the numbers of the leaf's transform make it: relative to
    where it lies, in the world and in the leaf, not to how far away the ray began.
    """
    ray = ray_in(leaf["object_from_world"], o, d)
    in_leaf = abs(ray.ox + t * ray.dx) + abs(ray.oy + t * ray.dy) + abs(ray.oz + t * ray.dz)
    in_world = abs(o.x + t * d.x) + abs(o.y + t * d.y) + abs(o.z + t * d.z)
    leaf_unit, world_unit = abs(ray.dx) + abs(ray.dy) + abs(ray.dz), f64(abs(d.x)) + abs(d.y) + abs(d.z)
    return _SAME * (in_leaf / leaf_unit + in_world / world_unit)


@kernel
def _slant(leaf, numbers, o: Vec3, d: Vec3, t: np.float64, end: int) -> np.float64:
    """How much longer the way between two surfaces is for the ray than straight across: 1 / cos, at most `_STEEPEST`."""
    ray, at = ray_in(leaf["object_from_world"], o, d), f32(t)
    n = shape_at(leaf, numbers, o, d, at, _part(leaf, numbers, o, d, end), ZERO, ZERO).n
    across = abs(n.x * ray.dx + n.y * ray.dy + n.z * ray.dz)
    length = np.sqrt(ray.dx * ray.dx + ray.dy * ray.dy + ray.dz * ray.dz)
    return length / across if length < _STEEPEST * across else _STEEPEST


@kernel
def _place_ends(solid, leaves, numbers, o: Vec3, d: Vec3, ahead: int, ends) -> np.float64:
    """Up to where ends count as one place with the next one, which is of leaf `ahead`. Its slope is asked for only if it decides."""
    end = int(ends[ahead, _PASSED])
    t, leaf = ends[ahead, end], leaves[solid["leaf"] + ahead]
    reach = _same_place(leaf, o, d, t)
    for k in range(solid["n_leaves"]):
        beyond = ends[k, int(ends[k, _PASSED])] - t
        if k != ahead and beyond > reach and beyond <= _STEEPEST * reach:
            return t + reach * _slant(leaf, numbers, o, d, t, end)
    return t + reach


@kernel
def _next_end(n_leaves: int, ends) -> int:
    """The leaf with the nearest end ahead, -1 where there is none."""
    nearest, found = FAR, -1
    for k in range(n_leaves):
        t = ends[k, int(ends[k, _PASSED])]
        if t < nearest:
            nearest, found = t, k
    return found


@kernel
def intersect_csg(
    solid, leaves, numbers, programs, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool, ends
) -> CsgHit:
    """The nearest hit in (t_min, t_max) of the world ray o + t d; without `both_sides`, the first where the solid is entered.

    `solid` is a row of its own, `leaves` are the rows that it refers to, `ends` (n, 6) float64 is scratch with a row for each leaf.
    """
    place, length, n = solid["place"], solid["n_program"], solid["n_leaves"]
    inside = _begin(solid, leaves, numbers, o, d, t_min, ends)
    before = holds(programs, place, length, inside)
    while True:
        ahead = _next_end(n, ends)
        if ahead < 0:
            return _miss()
        t = ends[ahead, int(ends[ahead, _PASSED])]
        if not f32(t) < t_max:
            return _miss()
        limit = _place_ends(solid, leaves, numbers, o, d, ahead, ends)
        # Cross all ends of this place, one of each leaf at most
        owner, after = -1, before
        for k in range(n):
            end = int(ends[k, _PASSED])
            if ends[k, end] <= limit and ends[k, end] < FAR:
                inside = inside ^ (_ONE_BIT << i64(k))
                ends[k, _PASSED] = end + 1
                after = holds(programs, place, length, inside)
                if owner < 0 and after != before:
                    owner = k
        if after != before and (after or both_sides):
            end = int(ends[owner, _PASSED]) - 1
            t_hit = f32(ends[owner, end])
            if not t_hit < t_max:
                return _miss()
            entered = ((inside >> i64(owner)) & _ONE_BIT) != _NO_BITS
            row = solid["leaf"] + owner
            part = _part(leaves[row], numbers, o, d, end)
            return CsgHit(t_hit, row, part, 0 if entered == after else 1, ONE if after else -ONE)
        before = after


@kernel
def is_inside(solid, leaves, numbers, programs, p: Vec3, ends) -> bool:
    """Whether a point of the world is in the solid: asked of a ray that passes through it at t = 0."""
    inside = _begin(solid, leaves, numbers, p, Vec3(ONE, ZERO, ZERO), ZERO, ends)
    return holds(programs, solid["place"], solid["n_program"], inside)
