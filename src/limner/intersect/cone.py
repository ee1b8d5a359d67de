"""Ray and cone about +y, from radius r0 at y = -h/2 to radius r1 at h/2: a cone where one of them is 0, else a frustum.

With caps a solid, without them an open sheet. Parts: 0 the side, 1 the cap at -h/2, 2 the cap at h/2.

The side is where the distance from the axis equals w = (r0 + r1)/2 + y (r1 - r0)/h. Along a ray w is a linear function w0 + t w1, and

    |o + t d|^2 - (w0 + t w1)^2 = a t^2 + 2 b t + c        (o, d: their x and z)

The discriminant is |d w0 - o w1|^2 - (o_x d_z - o_z d_x)^2: a difference of two squares, in which nothing else cancels. The equation
knows the mirrored cone beyond the apex, too; where w < 0, the ray is there.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import PI, sqrt
from ..kernel.vec import ONE, ZERO, Vec3
from .disk import disk_area, ring_range
from .interval import (
    FAR,
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

__all__ = ["cone_area", "cone_at", "cone_range", "cone_spans", "intersect_cone"]

f32, f64 = np.float32, np.float64
_NONE, _HALF64, _TWO64 = f64(0.0), f64(0.5), f64(2.0)
_HALF = f32(0.5)


@kernel
def _side_spans(ray: Ray, r0: np.float32, r1: np.float32, height: np.float32) -> Spans:
    """Where the ray is inside the endless cone, on the side of the apex where w >= 0."""
    if not is_ray(ray):
        return nowhere()
    slope = (f64(r1) - f64(r0)) / f64(height)
    w0, w1 = _HALF64 * (f64(r0) + f64(r1)) + slope * ray.oy, slope * ray.dy
    flat = ray.dx * ray.dx + ray.dz * ray.dz
    a = flat - w1 * w1
    b = ray.ox * ray.dx + ray.oz * ray.dz - w0 * w1
    c = ray.ox * ray.ox + ray.oz * ray.oz - w0 * w0
    if a == _NONE:
        # Parallel to a line of the cone: one end only, or, along the axis of a cylinder, none.
        if b == _NONE:
            return everywhere() if c <= _NONE and w0 >= _NONE else nowhere()
        t = -c / (_TWO64 * b)
        return span(-FAR, 0, t, 0) if b > _NONE else span(t, 0, FAR, 0)
    x, z, across = ray.dx * w0 - ray.ox * w1, ray.dz * w0 - ray.oz * w1, ray.ox * ray.dz - ray.oz * ray.dx
    far_off = np.sqrt(x * x + z * z)
    discriminant = (far_off - across) * (far_off + across)
    if a > _NONE:
        if not discriminant >= _NONE:
            return nowhere()
        near, far = ordered_roots(a, b, c, discriminant)
        return span(near, 0, far, 0) if w0 + _HALF64 * (near + far) * w1 >= _NONE else nowhere()
    # Steeper than the cone: inside until one end and from the other on, once in this cone, once in the mirrored one.
    near, far = ordered_roots(a, b, c, max(_NONE, discriminant))
    return span(far, 0, FAR, 0) if w1 > _NONE else span(-FAR, 0, near, 0)


@kernel
def cone_spans(ray: Ray, r0: np.float32, r1: np.float32, height: np.float32) -> Spans:
    """Where the ray is inside the solid cone."""
    low, high = slab(ray.oy, ray.dy, -_HALF64 * height, _HALF64 * height)
    in_cap, out_cap = (1, 2) if ray.dy > _NONE else (2, 1)
    return clipped(_side_spans(ray, r0, r1, height), low, in_cap, high, out_cap)


@kernel
def intersect_cone(
    ray: Ray, r0: np.float32, r1: np.float32, height: np.float32, capped: int, t_min: np.float32, t_max: np.float32, both_sides: bool
) -> ShapeHit:
    """The nearest hit in (t_min, t_max); `capped` 0: there are no caps, and the side is seen from inside as well."""
    if capped != 0:
        return first_hit(cone_spans(ray, r0, r1, height), t_min, t_max, both_sides)
    low, high = slab(ray.oy, ray.dy, -_HALF64 * height, _HALF64 * height)
    return first_hit_between(_side_spans(ray, r0, r1, height), low, high, t_min, t_max, both_sides)


@kernel
def cone_at(p: Vec3, r0: np.float32, r1: np.float32, height: np.float32, part: int) -> ObjectPoint:
    """The point next to p, at its height, of the side (u around, v = 1/2 + y/h) or of a cap (as of a disk)."""
    if part == 1:
        return cap_at(p, -_HALF * height, r0, -ONE)
    if part == 2:
        return cap_at(p, _HALF * height, r1, ONE)
    slope = (r1 - r0) / height
    radius = max(ZERO, _HALF * (r0 + r1) + slope * p.y)
    distance = axis_distance(p)
    x, z = (p.x / distance, p.z / distance) if distance > ZERO else (ONE, ZERO)
    place = Vec3(x * radius, p.y, z * radius)
    n = Vec3(x, -slope, z) / sqrt(ONE + slope * slope)
    v = Vec3(ZERO, ONE / height, ZERO)
    return ObjectPoint(place, n, around_tangent(Vec3(x, ZERO, z), ONE), around(p), _HALF + p.y / height, around_gradient(place, radius), v)


@kernel
def cone_range(a: Vec3, r0: np.float32, r1: np.float32, height: np.float32) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p: of the two rims."""
    low0, high0 = ring_range(a, -_HALF * height, r0)
    low1, high1 = ring_range(a, _HALF * height, r1)
    return min(low0, low1), max(high0, high1)


@kernel
def cone_area(r0: np.float32, r1: np.float32, height: np.float32, capped: int) -> np.float32:
    """pi (r0 + r1) sqrt(h^2 + (r1 - r0)^2), and pi (r0^2 + r1^2) of the caps"""
    side = PI * (r0 + r1) * sqrt(height * height + (r1 - r0) * (r1 - r0))
    return side + disk_area(r0) + disk_area(r1) if capped != 0 else side
