"""Ray and disk: the points of y = 0 within a radius of the origin, front towards +y. A sheet without an inside."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import PI, sqrt
from ..kernel.vec import ONE, ZERO, Vec3
from .interval import Ray, ShapeHit, is_ray, no_hit
from .object_point import ObjectPoint, cap_at

__all__ = ["disk_area", "disk_at", "disk_range", "intersect_disk", "ring_range"]

f32, f64 = np.float32, np.float64
_NONE = f64(0.0)


@kernel
def intersect_disk(ray: Ray, radius: np.float32, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """Where in (t_min, t_max) the ray meets the disk, its rim included; a parallel ray misses."""
    if not is_ray(ray) or ray.dy == _NONE or not (both_sides or ray.dy < _NONE):
        return no_hit()
    exact = -ray.oy / ray.dy
    t = f32(exact)
    x, z = ray.ox + exact * ray.dx, ray.oz + exact * ray.dz
    if t_min < t and t < t_max and x * x + z * z <= f64(radius) * radius:
        return ShapeHit(t, 0, ZERO, ZERO, ONE if ray.dy < _NONE else -ONE)
    return no_hit()


@kernel
def disk_at(p: Vec3, radius: np.float32) -> ObjectPoint:
    """The disk's point next to p; u = (1 + x/r) / 2, v = (1 - z/r) / 2."""
    return cap_at(p, ZERO, radius, ONE)


@kernel
def disk_range(a: Vec3, radius: np.float32) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p."""
    return ring_range(a, ZERO, radius)


@kernel
def ring_range(a: Vec3, y: np.float32, radius: np.float32) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p on the circle about +y at height y."""
    half = radius * sqrt(a.x * a.x + a.z * a.z)
    return a.y * y - half, a.y * y + half


@kernel
def disk_area(radius: np.float32) -> np.float32:
    """pi r^2, of one side"""
    return PI * radius * radius
