"""Ray and field of distances, by sphere tracing (FoCG 22, Hart 1996).

Nothing of the surface is nearer than |f(p)| / L, so a ray may go so far at once, and again from there. Near the surface steps grow short;
then a least step, a small part of the field's box, takes over, until the field's sign changes, and between the last two points the place
is fenced in to what float32 can tell:

    o──────────────────►┼────────────►┼──────►┼──►┼─►┼►|►   the sign has changed: fence in

A ray that grazes the surface makes many short steps. After some hundred the least step doubles again and again, so that every ray comes to
its end; what is missed is what is thinner than a least step, along the ray. Since only a change of sign counts as a hit, a ray that begins
close to the surface, on either side of it, leaves it.

All in float64, in the space of the field; the parameter t is the ray's own.

**Source**: Hart, *Sphere tracing*, 1996, with signs in place of a distance at which to stop.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.vec import ONE, ZERO, Vec3, dot, length
from ..tables.distance_codes import HEADER, HIGH, LENGTH, LOW, SLOPE
from .cuboid import box_spans, face_at
from .distance_program import field_value
from .interval import FAR, Ray, ShapeHit, no_hit, ray_in
from .object_point import ObjectPoint

__all__ = ["distance_field_at", "distance_field_range", "intersect_distance_field"]

f32, f64 = np.float32, np.float64
_HALF = f32(0.5)
_NONE, _ONE64, _HALF64, _TWO64 = f64(0.0), f64(1.0), f64(0.5), f64(2.0)
_LEAST = f64(2.0**-18)  # step, in units of the box's diagonal
_ROUNDING = f64(2.0**-50)  # of t: a step must be longer
_PATIENCE, _MOST_STEPS, _DOUBLING = 256, 640, 8
_FENCE = f64(2.0**-44)  # how near both ends are in the end, relative to t: asked again, float32 shall round the place alike
_FEW_FENCES, _MOST_FENCES = 16, 64  # then by halves
_DIFFERENCE = f64(2.0**-21)  # over which slopes are taken, in units of the box's diagonal
_PUT_BACK = f64(2.0**-18)  # how far off the surface rounding may have put a point, relative to where the ray comes from


class _Field(NamedTuple):
    """Where a field's program stands, and how large its box is."""

    first: int
    last: int
    diagonal: np.float64


@kernel
def _low(numbers, place: int) -> Vec3:
    i = place + LOW
    return Vec3(numbers[i], numbers[i + 1], numbers[i + 2])


@kernel
def _high(numbers, place: int) -> Vec3:
    i = place + HIGH
    return Vec3(numbers[i], numbers[i + 1], numbers[i + 2])


@kernel
def _field(numbers, place: int) -> _Field:
    first = place + HEADER
    return _Field(first, first + int(numbers[place + LENGTH]), f64(length(_high(numbers, place) - _low(numbers, place))))


@kernel
def _value(numbers, field: _Field, ray: Ray, t: np.float64, stack) -> np.float64:
    return field_value(numbers, field.first, field.last, ray.ox + t * ray.dx, ray.oy + t * ray.dy, ray.oz + t * ray.dz, stack)


@kernel
def _slope(numbers, field: _Field, axis: Ray, step: np.float64, stack) -> np.float64:
    """How the field grows along a ray at its origin: its difference over a step to both sides."""
    return (_value(numbers, field, axis, step, stack) - _value(numbers, field, axis, -step, stack)) / (_TWO64 * step)


@kernel
def _crossing(numbers, field: _Field, ray: Ray, a: np.float64, at_a: np.float64, b: np.float64, at_b: np.float64, stack) -> np.float64:
    """Where the field changes its sign between a and b: regula falsi; the value at an end that stays twice is halved (Illinois).

    A step is no shorter than half of what is asked for, so that both ends come near.

    **Source**: Dowell and Jarratt, *A modified regula falsi method for computing the root of an equation*, 1971.
    """
    moved = 0
    for k in range(_MOST_FENCES):
        room = _FENCE * max(abs(a), abs(b))
        if not b - a > room:
            break
        t = min(max(a - at_a * (b - a) / (at_b - at_a), a + _HALF64 * room), b - _HALF64 * room)
        if k >= _FEW_FENCES:
            t = _HALF64 * (a + b)
        value = _value(numbers, field, ray, t, stack)
        if (value < _NONE) == (at_a < _NONE):
            a, at_a = t, value
            at_b = at_b * _HALF64 if moved < 0 else at_b
            moved = -1
        else:
            b, at_b = t, value
            at_a = at_a * _HALF64 if moved > 0 else at_a
            moved = 1
    return _HALF64 * (a + b)


@outlined
def intersect_distance_field(shape, numbers, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool, stack) -> ShapeHit:
    """The nearest hit in (t_min, t_max) of the world ray o + t d; without `both_sides`, the first where the inside is entered.

    `stack` (n, 6) float64 is scratch (`intersect.distance_program`).
    """
    ray, place = ray_in(shape["object_from_world"], o, d), shape["place"]
    box = box_spans(ray, _low(numbers, place), _high(numbers, place), 0)
    t, end = max(box.t0, f64(t_min)), min(box.t1, f64(t_max))
    if not t < end or box.t0 == FAR:
        return no_hit()
    field = _field(numbers, place)
    speed = np.sqrt(ray.dx * ray.dx + ray.dy * ray.dy + ray.dz * ray.dz)
    per_value = _ONE64 / (f64(numbers[place + SLOPE]) * speed)
    least = max(_LEAST * field.diagonal / speed, _ROUNDING * max(abs(t), abs(end)))
    value = _value(numbers, field, ray, t, stack)
    for k in range(_MOST_STEPS):
        ahead = min(t + max(abs(value) * per_value, least), end)
        value_ahead = _value(numbers, field, ray, ahead, stack)
        if (value_ahead < _NONE) != (value < _NONE):
            found, enters = f32(_crossing(numbers, field, ray, t, value, ahead, value_ahead, stack)), value_ahead < _NONE
            if found > t_min and (enters or both_sides):
                return ShapeHit(found, 0, ZERO, ZERO, ONE if enters else -ONE) if found < t_max else no_hit()
        if ahead >= end:
            return no_hit()
        t, value = ahead, value_ahead
        if k >= _PATIENCE and k % _DOUBLING == 0:
            least = least * _TWO64
    return no_hit()


@outlined
def distance_field_at(shape, numbers, o: Vec3, d: Vec3, t: np.float32, stack) -> ObjectPoint:
    """The point of the surface next to where the world ray hits it; the normal is the gradient's direction, zero where there is none.

    The point is put back along the gradient, twice, to first order. Texture coordinates as on the faces of its box: of that to which the
    normal looks most.
    """
    ray, place = ray_in(shape["object_from_world"], o, d), shape["place"]
    field = _field(numbers, place)
    along = f64(t)
    x, y, z = ray.ox + along * ray.dx, ray.oy + along * ray.dy, ray.oz + along * ray.dz
    step = _DIFFERENCE * field.diagonal
    gx = _slope(numbers, field, Ray(x, y, z, _ONE64, _NONE, _NONE), step, stack)
    gy = _slope(numbers, field, Ray(x, y, z, _NONE, _ONE64, _NONE), step, stack)
    gz = _slope(numbers, field, Ray(x, y, z, _NONE, _NONE, _ONE64), step, stack)
    norm = np.sqrt(gx * gx + gy * gy + gz * gz)
    if norm > _NONE:
        gx, gy, gz = gx / norm, gy / norm, gz / norm
        farthest = _PUT_BACK * (abs(ray.ox) + abs(ray.oy) + abs(ray.oz) + abs(along) * (abs(ray.dx) + abs(ray.dy) + abs(ray.dz)))
        for _ in range(2):
            back = field_value(numbers, field.first, field.last, x, y, z, stack) / norm
            back = min(max(back, -farthest), farthest)
            x, y, z = x - gx * back, y - gy * back, z - gz * back
    p, n = Vec3(x, y, z), Vec3(gx, gy, gz)
    at = face_at(p, _low(numbers, place), _high(numbers, place), _face(n))
    tangent = at.tangent - n * dot(at.tangent, n)
    return ObjectPoint(p, n, tangent, at.u, at.v, at.gradient_u, at.gradient_v)


@kernel
def _face(n: Vec3) -> int:
    """The face of a box to which a normal looks most; the earlier axis where it cannot be told."""
    x, y, z = abs(n.x), abs(n.y), abs(n.z)
    if x >= y and x >= z:
        return 0 if n.x >= ZERO else 1
    if y >= z:
        return 2 if n.y >= ZERO else 3
    return 4 if n.z >= ZERO else 5


@kernel
def distance_field_range(a: Vec3, numbers, place: int) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p in the box that holds it."""
    low, high = _low(numbers, place), _high(numbers, place)
    middle, half = dot(a, (low + high) * _HALF), (high - low) * _HALF
    reach = abs(a.x) * half.x + abs(a.y) * half.y + abs(a.z) * half.z
    return middle - reach, middle + reach
