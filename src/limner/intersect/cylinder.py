"""Ray and cylinder about +y, from y = -h/2 to h/2; with caps a solid, without them an open tube whose inside is seen.

Parts: 0 the side, 1 the cap at -h/2, 2 the cap at h/2.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import TWO_PI
from ..kernel.vec import ONE, ZERO, Vec3
from .disk import disk_area, ring_range
from .interval import (
    Ray,
    ShapeHit,
    Spans,
    clipped,
    everywhere,
    first_hit,
    first_hit_between,
    is_ray,
    nowhere,
    ordered_roots,
    slab,
    span,
)  # fmt: skip
from .object_point import ObjectPoint, around, around_gradient, around_tangent, axis_distance, cap_at

__all__ = ["cylinder_area", "cylinder_at", "cylinder_range", "cylinder_spans", "intersect_cylinder"]

f32, f64 = np.float32, np.float64
_NONE, _HALF64 = f64(0.0), f64(0.5)
_HALF, _TWO = f32(0.5), f32(2.0)


@kernel
def _side_spans(ray: Ray, radius: np.float32) -> Spans:
    """Where the ray is inside the endless cylinder: b^2 - a c = a r^2 - (o_x d_z - o_z d_x)^2."""
    if not is_ray(ray):
        return nowhere()
    a = ray.dx * ray.dx + ray.dz * ray.dz
    b = ray.ox * ray.dx + ray.oz * ray.dz
    c = ray.ox * ray.ox + ray.oz * ray.oz - f64(radius) * radius
    if a == _NONE:
        return everywhere() if c <= _NONE else nowhere()
    across = ray.ox * ray.dz - ray.oz * ray.dx
    discriminant = a * (f64(radius) * radius) - across * across
    if not discriminant >= _NONE:
        return nowhere()
    near, far = ordered_roots(a, b, c, discriminant)
    return span(near, 0, far, 0)


@kernel
def cylinder_spans(ray: Ray, radius: np.float32, height: np.float32) -> Spans:
    """Where the ray is inside the solid cylinder."""
    low, high = slab(ray.oy, ray.dy, -_HALF64 * height, _HALF64 * height)
    in_cap, out_cap = (1, 2) if ray.dy > _NONE else (2, 1)
    return clipped(_side_spans(ray, radius), low, in_cap, high, out_cap)


@kernel
def intersect_cylinder(
    ray: Ray, radius: np.float32, height: np.float32, capped: int, t_min: np.float32, t_max: np.float32, both_sides: bool
) -> ShapeHit:
    """The nearest hit in (t_min, t_max); `capped` 0: there are no caps, and the side is seen from inside as well."""
    if capped != 0:
        return first_hit(cylinder_spans(ray, radius, height), t_min, t_max, both_sides)
    low, high = slab(ray.oy, ray.dy, -_HALF64 * height, _HALF64 * height)
    return first_hit_between(_side_spans(ray, radius), low, high, t_min, t_max, both_sides)


@kernel
def cylinder_at(p: Vec3, radius: np.float32, height: np.float32, part: int) -> ObjectPoint:
    """The point next to p of the side (u around, v = 1/2 + y/h) or of a cap (as of a disk)."""
    if part == 1:
        return cap_at(p, -_HALF * height, radius, -ONE)
    if part == 2:
        return cap_at(p, _HALF * height, radius, ONE)
    distance = axis_distance(p)
    n = Vec3(p.x / distance, ZERO, p.z / distance) if distance > ZERO else Vec3(ONE, ZERO, ZERO)
    place = Vec3(n.x * radius, p.y, n.z * radius)
    return ObjectPoint(
        place, n, around_tangent(place, radius), around(place), _HALF + p.y / height, around_gradient(place, radius),
        Vec3(ZERO, ONE / height, ZERO),
    )  # fmt: skip


@kernel
def cylinder_range(a: Vec3, radius: np.float32, height: np.float32) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p."""
    _, high = ring_range(a, ZERO, radius)
    high = high + abs(a.y) * (_HALF * height)
    return -high, high


@kernel
def cylinder_area(radius: np.float32, height: np.float32, capped: int) -> np.float32:
    """2 pi r h, and 2 pi r^2 of the caps"""
    side = TWO_PI * radius * height
    return side + _TWO * disk_area(radius) if capped != 0 else side
