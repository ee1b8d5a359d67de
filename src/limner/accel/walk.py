"""The walk of a ray through the tree: near boxes first, and what lies behind the best hit so far not at all."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..intersect.box import enter_box, moved_on
from ..intersect.csg import intersect_csg
from ..intersect.layouts import CSG
from ..intersect.shape import intersect_shape
from ..intersect.surface_code import surface_code
from ..intersect.triangle import intersect_triangle, turned_ray
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Vec3
from ..shading.analytic import hit_analytic, meets_outside
from .layouts import FIRST_MOVING

__all__ = ["Hit", "exact_tables", "first_hit", "nearest", "occluded"]

f32 = np.float32
_INFINITY = f32(np.inf)


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


@kernel
def _miss(t_max: np.float32) -> Hit:
    return Hit(t_max, -1, -1, ZERO, ZERO)


@kernel
def exact_tables(attributes, slots, ends):
    """The fifth of what kernels take for an accelerator (`accel.layouts.Accelerator`), from a door's arguments.

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
        return Hit(c.t, np.int64(c.leaf), surface_code(c.part, c.flipped), ZERO, ZERO) if c.leaf >= 0 else _miss(t_max)
    h = intersect_shape(shape, numbers, o, d, t_min, t_max, both_sides)
    return Hit(h.t, np.int64(row), surface_code(h.part, 0), h.u, h.v) if h.part >= 0 else _miss(t_max)


@outlined
def _moving_hit(instances, p, corners, k: int, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool) -> Hit:
    """The hit of a triangle that stands in its object's space: the ray is taken there, its parameter stays."""
    m = instances[p["instance"]]["object_from_world"]
    h = intersect_triangle(turned_ray(transform_point(m, o), transform_vector(m, d)), corners, k, t_min, t_max)
    if h.t < t_max and (both_sides or h.facing > ZERO):
        return Hit(h.t, np.int64(p["instance"]), FIRST_MOVING - np.int64(p["triangle"]), h.u, h.v)
    return _miss(t_max)


@kernel
def _nearest_of(
    instances, primitives, corners, exact, first: int, last: int, ray, o: Vec3, d: Vec3, t_min, best: Hit, both_sides, opaque_only
):
    """The nearer of `best` and what the primitives first..last offer."""
    for k in range(first, last):
        p = primitives[k]
        if opaque_only and p["opaque"] == 0:
            continue
        if exact is not None:  # known to the compiler
            if p["triangle"] < -1:
                if p["triangle"] <= FIRST_MOVING:
                    hit = _moving_hit(instances, p, corners, k, o, d, t_min, best.t, both_sides or p["facing"] == 0)
                else:
                    hit = _exact_hit(instances, np.int64(p["instance"]), exact, o, d, t_min, best.t, both_sides or p["facing"] == 0)
                if hit.t < best.t:
                    best = hit
                continue
        if p["triangle"] < 0:
            t = hit_analytic(instances[p["instance"]], o, d, t_min, best.t)
            if t < best.t and (both_sides or p["facing"] == 0 or meets_outside(instances[p["instance"]], o, d, t)):
                best = Hit(t, np.int64(p["instance"]), -1, ZERO, ZERO)
        else:
            h = intersect_triangle(ray, corners, k, t_min, best.t)
            if h.t < best.t and (both_sides or p["facing"] == 0 or (h.facing > ZERO) == (p["facing"] > 0)):
                best = Hit(h.t, np.int64(p["instance"]), np.int64(p["triangle"]), h.u, h.v)
    return best


@kernel
def _walk(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack, any_hit, both_sides, opaque_only) -> Hit:
    """The nearest hit in (t_min, t_max), or any.

    A primitive's own tie is broken by the order of the leaves; the far child waits on `stack` (int32) and is dropped when it comes up
    if something nearer was found meanwhile.
    """
    nodes, primitives, corners, planes, exact = accelerator
    ray = turned_ray(o, d)
    inverse = Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
    best = _miss(t_max)
    best = _nearest_of(instances, planes, corners, exact, 0, planes.shape[0], ray, o, d, t_min, best, both_sides, opaque_only)
    if any_hit and best.instance >= 0:
        return best
    if nodes.shape[0] == 0:
        return _nearest_of(
            instances, primitives, corners, exact, 0, primitives.shape[0], ray, o, d, t_min, best, both_sides, opaque_only
        )
    current, top = 0, 0
    while True:
        node = nodes[current]
        t0 = enter_box(node["box"], 0, o, inverse, t_min, best.t)
        t1 = enter_box(node["box"], 6, o, inverse, t_min, best.t)
        near, far = (0, 1) if t0 <= t1 else (1, 0)
        near_t, far_t = min(t0, t1), max(t0, t1)
        following = -1
        if near_t < _INFINITY:
            child, count = node["child"][near], node["count"][near]
            if child < 0:
                best = _nearest_of(
                    instances, primitives, corners, exact, -1 - child, -1 - child + count, ray, o, d, t_min, best, both_sides,
                    opaque_only,
                )  # fmt: skip
                if any_hit and best.instance >= 0:
                    return best
            else:
                following = np.int64(child)
        if far_t < _INFINITY and far_t <= moved_on(best.t):
            child, count = node["child"][far], node["count"][far]
            if child < 0:
                best = _nearest_of(
                    instances, primitives, corners, exact, -1 - child, -1 - child + count, ray, o, d, t_min, best, both_sides,
                    opaque_only,
                )  # fmt: skip
                if any_hit and best.instance >= 0:
                    return best
            elif following < 0:
                following = np.int64(child)
            else:
                stack[top] = child
                top += 1
        if following < 0:
            if top == 0:
                return best
            top -= 1
            following = np.int64(stack[top])
        current = following


@kernel
def nearest(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack) -> Hit:
    """The nearest hit in (t_min, t_max); single-sided triangles are met from their front only. t is infinite for a miss."""
    hit = _walk(accelerator, instances, o, d, t_min, t_max, stack, False, False, False)
    return hit if hit.instance >= 0 else _miss(_INFINITY)


@kernel
def first_hit(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool, stack) -> Hit:
    """The nearest hit in (t_min, t_max); `both_sides`: single-sided triangles are met from behind as well. t is infinite for a miss."""
    hit = _walk(accelerator, instances, o, d, t_min, t_max, stack, False, both_sides, False)
    return hit if hit.instance >= 0 else _miss(_INFINITY)


@kernel
def occluded(accelerator, instances, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, stack) -> bool:
    """Whether anything opaque lies in (t_min, t_max); both sides of every triangle count."""
    return _walk(accelerator, instances, o, d, t_min, t_max, stack, True, True, True).instance >= 0
