"""Ray and ball: the sphere of FoCG 4.4.1 with what is inside it, |p| <= r."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import PI, acos, sqrt
from ..kernel.vec import ONE, ZERO, Vec3, dot, normalize
from .interval import Ray, Spans, is_ray, nowhere, ordered_roots, span
from .object_point import ObjectPoint, around, around_gradient, around_tangent, axis_distance

__all__ = ["ball_area", "ball_at", "ball_range", "ball_spans"]

f32, f64 = np.float32, np.float64
_NONE = f64(0.0)
_FOUR = f32(4.0)


@kernel
def ball_spans(ray: Ray, radius: np.float32) -> Spans:
    """Where the ray is inside. b^2 - a c = a r^2 - |o x d|^2, in which only the ray's distance from the centre counts."""
    if not is_ray(ray):
        return nowhere()
    a = ray.dx * ray.dx + ray.dy * ray.dy + ray.dz * ray.dz
    b = ray.ox * ray.dx + ray.oy * ray.dy + ray.oz * ray.dz
    c = ray.ox * ray.ox + ray.oy * ray.oy + ray.oz * ray.oz - f64(radius) * radius
    x, y, z = ray.oy * ray.dz - ray.oz * ray.dy, ray.oz * ray.dx - ray.ox * ray.dz, ray.ox * ray.dy - ray.oy * ray.dx
    discriminant = a * (f64(radius) * radius) - (x * x + y * y + z * z)
    if not discriminant >= _NONE:
        return nowhere()
    near, far = ordered_roots(a, b, c, discriminant)
    return span(near, 0, far, 0)


@kernel
def ball_at(p: Vec3, radius: np.float32) -> ObjectPoint:
    """The surface's point next to p; v = 1 - acos(y/r) / pi."""
    n = normalize(p)
    p = n * radius
    distance = axis_distance(p)
    gradient_v = ZERO
    if distance > ZERO:
        gradient_v = ONE / (PI * distance)
    slope = Vec3(-n.x * n.y, ONE - n.y * n.y, -n.z * n.y)  # +y in the tangent plane
    return ObjectPoint(p, n, around_tangent(p, distance), around(p), ONE - acos(n.y) / PI, around_gradient(p, distance), slope * gradient_v)


@kernel
def ball_range(a: Vec3, radius: np.float32) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p."""
    half = radius * sqrt(dot(a, a))
    return -half, half


@kernel
def ball_area(radius: np.float32) -> np.float32:
    """4 pi r^2"""
    return _FOUR * PI * radius * radius
