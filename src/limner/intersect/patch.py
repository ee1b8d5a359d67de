"""Ray and bilinear patch (FoCG 15.6's simplest surface): four corners, and straight lines between opposite sides.

    p(u, v) = (1-u)(1-v) p00 + u (1-v) p10 + u v p11 + (1-u) v p01

Its twelve numbers stand in `numbers[place : place + 12]`: p00, p10, p11, p01, counter-clockwise seen from the front. Not flat in
general, and then hit at most twice.

For each u the patch holds a straight line, between the points at u of two opposite sides. The ray meets it where their distance, a
quadratic in u, is 0; v and t are where on the two lines.

**Source**: Reshetov, *Cool patches: a geometric approach to ray/bilinear patch intersections*, Ray Tracing Gems, 2019, here in
float64, with the roots by their product.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3, cross, dot, normalize
from .interval import Ray, ShapeHit, is_ray, no_hit
from .object_point import ObjectPoint

__all__ = ["PATCH_NUMBERS", "intersect_patch", "patch_at", "patch_range"]

PATCH_NUMBERS = 12

f32, f64 = np.float32, np.float64
_NONE, _HALF64, _ONE64, _FOUR64 = f64(0.0), f64(0.5), f64(1.0), f64(4.0)
_EDGE = f64(2.0**-40)  # how far beyond its edge a patch is still hit, so that neighbours leave no gap


@kernel
def _corner(numbers, place: int, k: int) -> Vec3:
    return Vec3(numbers[place + 3 * k], numbers[place + 3 * k + 1], numbers[place + 3 * k + 2])


@kernel
def _determinant(ax, ay, az, bx, by, bz, cx, cy, cz) -> np.float64:
    """(a x b) . c"""
    return (ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz


@kernel
def intersect_patch(ray: Ray, numbers, place: int, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """The nearest hit in (t_min, t_max), its edges included, with u and v; a ray in the plane of a flat patch misses."""
    if not is_ray(ray):
        return no_hit()
    dx, dy, dz = ray.dx, ray.dy, ray.dz
    # The sides p00-p10 and p01-p11, along which u runs, as seen from the ray's origin
    ax, ay, az = numbers[place] - ray.ox, numbers[place + 1] - ray.oy, numbers[place + 2] - ray.oz
    bx, by, bz = numbers[place + 3] - ray.ox, numbers[place + 4] - ray.oy, numbers[place + 5] - ray.oz
    cx, cy, cz = numbers[place + 6] - ray.ox, numbers[place + 7] - ray.oy, numbers[place + 8] - ray.oz
    ex, ey, ez = numbers[place + 9] - ray.ox, numbers[place + 10] - ray.oy, numbers[place + 11] - ray.oz
    # The volume between the ray and the line at u, at u = 0, at u = 1, and its curvature
    at_0 = _determinant(ax, ay, az, dx, dy, dz, ex - ax, ey - ay, ez - az)
    at_1 = _determinant(bx, by, bz, dx, dy, dz, cx - bx, cy - by, cz - bz)
    curved = _determinant(bx - ax, by - ay, bz - az, ex - cx, ey - cy, ez - cz, dx, dy, dz)
    linear = at_1 - at_0 - curved
    discriminant = linear * linear - _FOUR64 * at_0 * curved
    if not discriminant >= _NONE:
        return no_hit()
    root = np.sqrt(discriminant)
    q = -_HALF64 * (linear + root) if linear >= _NONE else _HALF64 * (root - linear)
    best = _on_line(ray, numbers, place, at_0 / q, t_min, t_max, both_sides)
    other = _on_line(ray, numbers, place, q / curved, t_min, t_max, both_sides)
    return other if other.t < best.t else best


@kernel
def _on_line(ray: Ray, numbers, place: int, u: np.float64, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """The hit on the line at u, which the ray meets. Comparisons are written so that a NaN is a miss."""
    if not (u >= -_EDGE and u <= _ONE64 + _EDGE):
        return no_hit()
    u = min(_ONE64, max(_NONE, u))
    rest = _ONE64 - u
    # From the line's foot to the ray's origin, and along the line
    px = rest * numbers[place] + u * numbers[place + 3] - ray.ox
    py = rest * numbers[place + 1] + u * numbers[place + 4] - ray.oy
    pz = rest * numbers[place + 2] + u * numbers[place + 5] - ray.oz
    lx = rest * numbers[place + 9] + u * numbers[place + 6] - ray.ox - px
    ly = rest * numbers[place + 10] + u * numbers[place + 7] - ray.oy - py
    lz = rest * numbers[place + 11] + u * numbers[place + 8] - ray.oz - pz
    nx, ny, nz = ray.dy * lz - ray.dz * ly, ray.dz * lx - ray.dx * lz, ray.dx * ly - ray.dy * lx
    squared = nx * nx + ny * ny + nz * nz
    t = f32(_determinant(nx, ny, nz, px, py, pz, lx, ly, lz) / squared)
    v = _determinant(nx, ny, nz, px, py, pz, ray.dx, ray.dy, ray.dz) / squared
    if not (t_min < t and t < t_max and v >= -_EDGE and v <= _ONE64 + _EDGE):
        return no_hit()
    v32, u32 = f32(min(_ONE64, max(_NONE, v))), f32(u)
    n = _across(numbers, place, u32, v32)
    facing = ONE if n.x * ray.dx + n.y * ray.dy + n.z * ray.dz <= _NONE else -ONE
    if facing < ZERO and not both_sides:
        return no_hit()
    return ShapeHit(t, 0, u32, v32, facing)


@kernel
def _along_u(numbers, place: int, v: np.float32) -> Vec3:
    bottom = _corner(numbers, place, 1) - _corner(numbers, place, 0)
    return bottom * (ONE - v) + (_corner(numbers, place, 2) - _corner(numbers, place, 3)) * v


@kernel
def _along_v(numbers, place: int, u: np.float32) -> Vec3:
    left = _corner(numbers, place, 3) - _corner(numbers, place, 0)
    return left * (ONE - u) + (_corner(numbers, place, 2) - _corner(numbers, place, 1)) * u


@kernel
def _across(numbers, place: int, u: np.float32, v: np.float32) -> Vec3:
    """dp/du x dp/dv; where it vanishes, as at a corner where two corners meet, the normal between the diagonals."""
    n = cross(_along_u(numbers, place, v), _along_v(numbers, place, u))
    if dot(n, n) > ZERO:
        return n
    return cross(_corner(numbers, place, 2) - _corner(numbers, place, 0), _corner(numbers, place, 3) - _corner(numbers, place, 1))


@kernel
def patch_at(numbers, place: int, u: np.float32, v: np.float32) -> ObjectPoint:
    """The patch's point at (u, v)."""
    along_u, along_v = _along_u(numbers, place, v), _along_v(numbers, place, u)
    bottom = _corner(numbers, place, 0) * (ONE - u) + _corner(numbers, place, 1) * u
    top = _corner(numbers, place, 3) * (ONE - u) + _corner(numbers, place, 2) * u
    n = _across(numbers, place, u, v)
    squared = dot(n, n)
    gradient_u, gradient_v = Vec3(ZERO, ZERO, ZERO), Vec3(ZERO, ZERO, ZERO)
    if squared > ZERO:
        gradient_u, gradient_v = cross(along_v, n) / squared, cross(n, along_u) / squared
    return ObjectPoint(bottom * (ONE - v) + top * v, normalize(n), along_u, u, v, gradient_u, gradient_v)


@kernel
def patch_range(a: Vec3, numbers, place: int) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p: at corners."""
    k0, k1 = dot(a, _corner(numbers, place, 0)), dot(a, _corner(numbers, place, 1))
    k2, k3 = dot(a, _corner(numbers, place, 2)), dot(a, _corner(numbers, place, 3))
    return min(min(k0, k1), min(k2, k3)), max(max(k0, k1), max(k2, k3))
