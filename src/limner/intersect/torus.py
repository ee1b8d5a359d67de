"""Ray and torus about +y: all points within r of the circle of radius R around the origin in y = 0, where 0 < r <= R.

Along a ray, counted from where it is closest to the centre and in units of length R + r, the surface is a quartic without its cubic
term, f(s) = s^4 + p s^2 + q s + w. Closed formulas for its roots lose them where the ray grazes. Here they are fenced in instead
(Yuksel, *High-performance polynomial root finding for graphics*, 2022): between two neighbouring roots of f' the quartic is monotone,
so it has a root there exactly if its sign changes, and the roots of f', a cubic, are fenced in by those of f'', which a square root
gives. What is missed is what float64 cannot tell from a ray that passes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import PI, TWO_PI, atan2, sqrt
from ..kernel.vec import ONE, ZERO, Vec3, dot
from .interval import FAR, Ray, ShapeHit, Spans, first_hit, is_ray, nowhere, slab
from .object_point import ObjectPoint, around, around_gradient, around_tangent, axis_distance

__all__ = ["intersect_torus", "torus_area", "torus_at", "torus_range", "torus_spans"]

f32, f64 = np.float32, np.float64
_NONE, _HALF64, _ONE64, _TWO64, _THREE64, _FOUR64, _SIX64 = f64(0.0), f64(0.5), f64(1.0), f64(2.0), f64(3.0), f64(4.0), f64(6.0)
_HALF, _FOUR = f32(0.5), f32(4.0)
_ROOM = f64(1e-9)  # the ray is followed a little beyond the torus, so that it begins and ends outside
_PRECISION = f64(1e-12)  # of a root, in units of the torus: float32 keeps 1e-7
_MOST_STEPS = 64


class _Quartic(NamedTuple):
    """e4 s^4 + e2 s^2 + e1 s + e0, or with e3 in place of e4 its derivative."""

    e4: np.float64
    e3: np.float64
    e2: np.float64
    e1: np.float64
    e0: np.float64


@kernel
def _value(f: _Quartic, s: np.float64) -> np.float64:
    return (((f.e4 * s + f.e3) * s + f.e2) * s + f.e1) * s + f.e0


@kernel
def _slope(f: _Quartic, s: np.float64) -> np.float64:
    return ((_FOUR64 * f.e4 * s + _THREE64 * f.e3) * s + _TWO64 * f.e2) * s + f.e1


@kernel
def _crossing(f: _Quartic, a: np.float64, b: np.float64, otherwise: np.float64) -> np.float64:
    """Where f changes its sign between a and b, monotone there; `otherwise` if it does not. Newton's steps, halving where they leave."""
    rising = _value(f, a) <= _NONE
    if rising == (_value(f, b) <= _NONE):
        return otherwise
    s = _HALF64 * (a + b)
    for _ in range(_MOST_STEPS):
        value = _value(f, s)
        if (value > _NONE) == rising:
            b = s
        else:
            a = s
        following = s - value / _slope(f, s)
        if not (a <= following and following <= b):
            following = _HALF64 * (a + b)
        if abs(following - s) <= _PRECISION:
            return following
        s = following
    return s


@kernel
def _in_order(a: np.float64, b: np.float64) -> tuple[np.float64, np.float64]:
    return (a, b) if a <= b else (b, a)


@kernel
def torus_spans(ray: Ray, major: np.float32, minor: np.float32) -> Spans:
    """Where the ray is inside."""
    if not is_ray(ray):
        return nowhere()
    size = f64(major) + f64(minor)
    R, r = f64(major) / size, f64(minor) / size
    # The ray from its point closest to the centre
    squared = ray.dx * ray.dx + ray.dy * ray.dy + ray.dz * ray.dz
    length = np.sqrt(squared)
    t_closest = -(ray.ox * ray.dx + ray.oy * ray.dy + ray.oz * ray.dz) / squared
    x, y, z = (ray.ox + t_closest * ray.dx) / size, (ray.oy + t_closest * ray.dy) / size, (ray.oz + t_closest * ray.dz) / size
    dx, dy, dz = ray.dx / length, ray.dy / length, ray.dz / length
    # Within the sphere and the slab around the torus
    off_axis = x * x + z * z
    room = _ONE64 + _ROOM - (off_axis + y * y)
    if not room >= _NONE:
        return nowhere()
    reach = np.sqrt(room)
    low, high = slab(y, dy, -r - _ROOM, r + _ROOM)
    low, high = max(-reach, low), min(reach, high)
    if not low < high:
        return nowhere()
    # The quartic; its constant term as a product, in which nothing cancels
    k = off_axis + y * y + R * R - r * r
    p = _TWO64 * k - _FOUR64 * R * R * (dx * dx + dz * dz)
    q = -_FOUR64 * _TWO64 * R * R * (x * dx + z * dz)
    distance = np.sqrt(off_axis)
    inner, outer = distance - R, distance + R
    w = (inner * inner + y * y - r * r) * (outer * outer + y * y - r * r)
    s0, s1, s2, s3 = _roots(_Quartic(_ONE64, _NONE, p, q, w), low, high)
    # Back to the ray's own parameter
    unit = size / length
    return Spans(t_closest + s0 * unit, t_closest + s1 * unit, t_closest + s2 * unit, t_closest + s3 * unit, 0, 0, 0, 0)


@kernel
def _roots(f: _Quartic, low: np.float64, high: np.float64) -> tuple[np.float64, np.float64, np.float64, np.float64]:
    """The roots of f from `low` to `high`, ascending, infinite where there are fewer; f > 0 at both ends."""
    df = _Quartic(_NONE, _FOUR64, _NONE, _TWO64 * f.e2, f.e1)
    turn = np.sqrt(max(_NONE, -f.e2 / _SIX64))
    left, right = min(max(-turn, low), high), min(max(turn, low), high)
    a = _crossing(df, low, left, low)
    b = _crossing(df, left, right, left)
    c = _crossing(df, right, high, right)
    s0, s1 = _in_order(_crossing(f, low, a, FAR), _crossing(f, a, b, FAR))
    s2, s3 = _in_order(_crossing(f, b, c, FAR), _crossing(f, c, high, FAR))
    s0, s2 = _in_order(s0, s2)
    s1, s3 = _in_order(s1, s3)
    s1, s2 = _in_order(s1, s2)
    # An end of the stretch may lie on the surface, by rounding: then inside begins or ends there.
    if _value(f, low) <= _NONE:
        s0, s1, s2, s3 = low, s0, s1, s2
    if s0 < FAR and s1 == FAR:
        s1 = high
    elif s2 < FAR and s3 == FAR:
        s3 = high
    return s0, s1, s2, s3


@kernel
def intersect_torus(ray: Ray, major: np.float32, minor: np.float32, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """The nearest hit in (t_min, t_max)."""
    return first_hit(torus_spans(ray, major, minor), t_min, t_max, both_sides)


@kernel
def torus_at(p: Vec3, major: np.float32, minor: np.float32) -> ObjectPoint:
    """The surface's point next to p; u around the axis, v = 1/2 + atan2(y, sqrt(x^2 + z^2) - R) / 2 pi around the tube."""
    distance = axis_distance(p)
    x, z = (p.x / distance, p.z / distance) if distance > ZERO else (ONE, ZERO)
    outwards, up = distance - major, p.y
    from_circle = sqrt(outwards * outwards + up * up)
    cosine, sine = (outwards / from_circle, up / from_circle) if from_circle > ZERO else (ONE, ZERO)
    n = Vec3(x * cosine, sine, z * cosine)
    radius = major + minor * cosine
    place = Vec3(x * radius, minor * sine, z * radius)
    along_v = Vec3(-x * sine, cosine, -z * sine)
    return ObjectPoint(
        place, n, around_tangent(Vec3(x, ZERO, z), ONE), around(p), _HALF + atan2(up, outwards) / TWO_PI, around_gradient(place, radius),
        along_v / (TWO_PI * minor),
    )  # fmt: skip


@kernel
def torus_range(a: Vec3, major: np.float32, minor: np.float32) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p."""
    half = major * sqrt(a.x * a.x + a.z * a.z) + minor * sqrt(dot(a, a))
    return -half, half


@kernel
def torus_area(major: np.float32, minor: np.float32) -> np.float32:
    """4 pi^2 R r"""
    return _FOUR * PI * PI * major * minor
