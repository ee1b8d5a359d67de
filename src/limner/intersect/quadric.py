"""Ray and quadric (FoCG 4.4.1 and 2.5.5): the surface Q(p) = 0 of a polynomial of degree two, within a box.

    Q = c0 x^2 + c1 y^2 + c2 z^2 + c3 xy + c4 xz + c5 yz + c6 x + c7 y + c8 z + c9

Its sixteen numbers stand in `numbers[place : place + 16]`: c0 … c9, then the box's low and high corner. Inside is where Q <= 0, so
normals point along the gradient; negate all to turn it inside out. Ellipsoids, paraboloids, saddles, hyperboloids of one and of two
sheets, double cones, cylinders and pairs of planes are of this kind. Closed, the box cuts it off with caps and makes it a solid;
open, it is a sheet that ends at the box.

Parts: 0 the quadric, 1 to 6 the faces of the box: +x, -x, +y, -y, +z, -z.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3, cross, dot, length, normalize
from .cuboid import box_spans, face_at
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
    no_hit,
    nowhere,
    ordered_roots,
    span,
)  # fmt: skip
from .object_point import ObjectPoint, around, around_gradient, axis_distance

__all__ = ["QUADRIC_NUMBERS", "intersect_quadric", "quadric_at", "quadric_range", "quadric_spans"]

QUADRIC_NUMBERS = 16

f32, f64 = np.float32, np.float64
_NONE, _HALF64, _TWO64 = f64(0.0), f64(0.5), f64(2.0)
_HALF, _TWO = f32(0.5), f32(2.0)


@kernel
def _low(numbers, place: int) -> Vec3:
    return Vec3(numbers[place + 10], numbers[place + 11], numbers[place + 12])


@kernel
def _high(numbers, place: int) -> Vec3:
    return Vec3(numbers[place + 13], numbers[place + 14], numbers[place + 15])


@kernel
def _endless_spans(ray: Ray, numbers, place: int, start: np.float64) -> Spans:
    """Where Q <= 0 along the ray, whose parameter is counted from `start`: next to the box its numbers are small."""
    x, y, z = ray.ox + start * ray.dx, ray.oy + start * ray.dy, ray.oz + start * ray.dz
    dx, dy, dz = ray.dx, ray.dy, ray.dz
    xx, yy, zz = f64(numbers[place]), f64(numbers[place + 1]), f64(numbers[place + 2])
    xy, xz, yz = _HALF64 * numbers[place + 3], _HALF64 * numbers[place + 4], _HALF64 * numbers[place + 5]
    lx, ly, lz = _HALF64 * numbers[place + 6], _HALF64 * numbers[place + 7], _HALF64 * numbers[place + 8]
    # Q's matrix times the direction, and times the origin
    mdx, mdy, mdz = xx * dx + xy * dy + xz * dz, xy * dx + yy * dy + yz * dz, xz * dx + yz * dy + zz * dz
    mx, my, mz = xx * x + xy * y + xz * z + lx, xy * x + yy * y + yz * z + ly, xz * x + yz * y + zz * z + lz
    a = dx * mdx + dy * mdy + dz * mdz
    b = dx * mx + dy * my + dz * mz
    c = x * (mx + lx) + y * (my + ly) + z * (mz + lz) + numbers[place + 9]
    if a == _NONE:
        if b == _NONE:
            return everywhere() if c <= _NONE else nowhere()
        t = start - c / (_TWO64 * b)
        return span(-FAR, 0, t, 0) if b > _NONE else span(t, 0, FAR, 0)
    discriminant = b * b - a * c
    if not discriminant >= _NONE:
        return everywhere() if a < _NONE and discriminant < _NONE else nowhere()
    near, far = ordered_roots(a, b, c, discriminant)
    if a > _NONE:
        return span(start + near, 0, start + far, 0)
    return Spans(-FAR, start + near, start + far, FAR, 0, 0, 0, 0)


@kernel
def _closest(ray: Ray, low: Vec3, high: Vec3) -> np.float64:
    """The parameter at which the ray is closest to the middle of the box."""
    x, y, z = ray.ox - _HALF64 * (f64(low.x) + high.x), ray.oy - _HALF64 * (f64(low.y) + high.y), ray.oz - _HALF64 * (f64(low.z) + high.z)
    return -(x * ray.dx + y * ray.dy + z * ray.dz) / (ray.dx * ray.dx + ray.dy * ray.dy + ray.dz * ray.dz)


@kernel
def quadric_spans(ray: Ray, numbers, place: int) -> Spans:
    """Where the ray is inside both the quadric and its box."""
    low, high = _low(numbers, place), _high(numbers, place)
    box = box_spans(ray, low, high, 1)
    if box.t0 == FAR or not is_ray(ray):
        return nowhere()
    return clipped(_endless_spans(ray, numbers, place, _closest(ray, low, high)), box.t0, box.part0, box.t1, box.part1)


@kernel
def intersect_quadric(ray: Ray, numbers, place: int, capped: int, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """The nearest hit in (t_min, t_max); `capped` 0: the box cuts it off and leaves it open."""
    if capped != 0:
        return first_hit(quadric_spans(ray, numbers, place), t_min, t_max, both_sides)
    low, high = _low(numbers, place), _high(numbers, place)
    box = box_spans(ray, low, high, 1)
    if box.t0 == FAR:
        return no_hit()
    return first_hit_between(_endless_spans(ray, numbers, place, _closest(ray, low, high)), box.t0, box.t1, t_min, t_max, both_sides)


@kernel
def _gradient(numbers, place: int, p: Vec3) -> Vec3:
    xy, xz, yz = numbers[place + 3], numbers[place + 4], numbers[place + 5]
    return Vec3(
        _TWO * numbers[place] * p.x + xy * p.y + xz * p.z + numbers[place + 6],
        xy * p.x + _TWO * numbers[place + 1] * p.y + yz * p.z + numbers[place + 7],
        xz * p.x + yz * p.y + _TWO * numbers[place + 2] * p.z + numbers[place + 8],
    )


@kernel
def _value(numbers, place: int, p: Vec3) -> np.float64:
    x, y, z = f64(p.x), f64(p.y), f64(p.z)
    return (
        x * (numbers[place] * x + numbers[place + 3] * y + numbers[place + 4] * z + numbers[place + 6])
        + y * (numbers[place + 1] * y + numbers[place + 5] * z + numbers[place + 7])
        + z * (numbers[place + 2] * z + numbers[place + 8])
        + numbers[place + 9]
    )


@kernel
def quadric_at(p: Vec3, numbers, place: int, part: int) -> ObjectPoint:
    """The point next to p of the quadric (u around +y; v the share of the box's height) or of a face of the box (as of a box).

    Put back along the gradient, to first order. The normal is zero at a point where the gradient is: the apex of a cone.
    """
    low, high = _low(numbers, place), _high(numbers, place)
    if part > 0:
        return face_at(p, low, high, part - 1)
    gradient = _gradient(numbers, place, p)
    squared = dot(gradient, gradient)
    if squared > ZERO:
        p = p - gradient * f32(_value(numbers, place, p) / f64(squared))
    n = normalize(_gradient(numbers, place, p))
    distance = axis_distance(p)
    gradient_u = around_gradient(p, distance)
    tangent = cross(Vec3(ZERO, ONE, ZERO), n)
    if length(tangent) > ZERO:
        # Along the surface at the same height; there are two ways, and u grows along one.
        tangent = tangent if dot(tangent, gradient_u) >= ZERO else -tangent
    else:
        tangent = Vec3(ONE, ZERO, ZERO)
    height = high.y - low.y
    return ObjectPoint(p, n, tangent, around(p), (p.y - low.y) / height, gradient_u, Vec3(ZERO, ONE / height, ZERO))


@kernel
def quadric_range(a: Vec3, numbers, place: int) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p in the box, between which those of the quadric lie."""
    low, high = _low(numbers, place), _high(numbers, place)
    middle, half = dot(a, (low + high) * _HALF), (high - low) * _HALF
    reach = abs(a.x) * half.x + abs(a.y) * half.y + abs(a.z) * half.z
    return middle - reach, middle + reach
