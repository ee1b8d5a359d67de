"""A ray and a solid: the stretches of the ray that lie inside (FoCG 13.3), and the nearest hit among their ends.

The question "where does the ray hit?" has one answer; the question "where is the ray inside?" has an answer that can be computed
with: clipped, joined, subtracted. So each solid tells its *spans*, at most two (a torus is entered twice, nothing here three times),
and the nearest hit is the first end of a span within the limits:

    spans = cylinder_spans(ray, radius, height)          # [t0, t1] and [t2, t3], ascending; what is absent lies at infinity
    hit = first_hit(spans, t_min, t_max, both_sides)     # entered at t0 or t2: the front; left at t1 or t3: the back

All this is computed in float64 from numbers of float32. Products of two such numbers are then exact, so a discriminant keeps its sign
where the ray grazes, and an ordinary computer takes no longer. What comes out, a hit, is float32 again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = [
    "FAR", "Ray", "ShapeHit", "Spans", "clipped", "everywhere", "first_hit", "first_hit_between", "is_ray", "no_hit", "nowhere",
    "ordered_roots", "point_at", "ray_in", "ray_of", "slab", "span",
]  # fmt: skip

f32, f64 = np.float32, np.float64
FAR = f64(np.inf)
_NONE = f64(0.0)
_INFINITY = f32(np.inf)


class Ray(NamedTuple):
    """A ray in a shape's own space: origin, and direction of any length."""

    ox: np.float64
    oy: np.float64
    oz: np.float64
    dx: np.float64
    dy: np.float64
    dz: np.float64


class Spans(NamedTuple):
    """Where a ray is inside a solid: from t0 to t1 and from t2 to t3, ascending, and the part of the surface at each end.

    An end that is not there lies at infinity: a ray that never enters has t0 = inf, one that was always inside t0 = -inf.
    """

    t0: np.float64
    t1: np.float64
    t2: np.float64
    t3: np.float64
    part0: int
    part1: int
    part2: int
    part3: int


class ShapeHit(NamedTuple):
    """What a ray meets of a shape.

    t: the ray's parameter, infinity for a miss. part: of its surface, as the shape numbers them; -1 for a miss. u, v: of a patch, the
    texture coordinates found on the way; else 0. facing: 1 from the side to which the normals point, -1 from the other; 0 for a miss.
    """

    t: np.float32
    part: int
    u: np.float32
    v: np.float32
    facing: np.float32


# --- rays -----------------------------------------------------------------------------------------------------------------


@kernel
def ray_of(o: Vec3, d: Vec3) -> Ray:
    """The ray o + t d."""
    return Ray(f64(o.x), f64(o.y), f64(o.z), f64(d.x), f64(d.y), f64(d.z))


@kernel
def ray_in(m, o: Vec3, d: Vec3) -> Ray:
    """The ray M (o + t d) for a (3, 4) matrix: in another space, with the same t."""
    ox, oy, oz, dx, dy, dz = f64(o.x), f64(o.y), f64(o.z), f64(d.x), f64(d.y), f64(d.z)
    return Ray(
        m[0, 0] * ox + m[0, 1] * oy + m[0, 2] * oz + m[0, 3],
        m[1, 0] * ox + m[1, 1] * oy + m[1, 2] * oz + m[1, 3],
        m[2, 0] * ox + m[2, 1] * oy + m[2, 2] * oz + m[2, 3],
        m[0, 0] * dx + m[0, 1] * dy + m[0, 2] * dz,
        m[1, 0] * dx + m[1, 1] * dy + m[1, 2] * dz,
        m[2, 0] * dx + m[2, 1] * dy + m[2, 2] * dz,
    )


@kernel
def point_at(ray: Ray, t: np.float32) -> Vec3:
    """o + t d"""
    return Vec3(ray.ox + t * ray.dx, ray.oy + t * ray.dy, ray.oz + t * ray.dz)


@kernel
def is_ray(ray: Ray) -> bool:
    """Whether all its numbers are finite, and it leads anywhere. Written so that a NaN is none."""
    along = abs(ray.dx) + abs(ray.dy) + abs(ray.dz)
    return abs(ray.ox) + abs(ray.oy) + abs(ray.oz) + along < FAR and along > _NONE


# --- spans ----------------------------------------------------------------------------------------------------------------


@kernel
def nowhere() -> Spans:
    """The ray passes the solid by."""
    return Spans(FAR, FAR, FAR, FAR, 0, 0, 0, 0)


@kernel
def everywhere() -> Spans:
    """The ray is inside all along."""
    return Spans(-FAR, FAR, FAR, FAR, 0, 0, 0, 0)


@kernel
def span(enter: np.float64, enter_part: int, leave: np.float64, leave_part: int) -> Spans:
    """Inside from `enter` to `leave`; nowhere if they are out of order or no numbers."""
    if not enter <= leave or enter == FAR or leave == -FAR:
        return nowhere()
    return Spans(enter, leave, FAR, FAR, enter_part, leave_part, 0, 0)


@kernel
def clipped(s: Spans, low: np.float64, low_part: int, high: np.float64, high_part: int) -> Spans:
    """What of the spans lies between two parameters; where they cut, the end is of the part given with them."""
    first, second = s.t0 <= high and s.t1 >= low and s.t0 < FAR, s.t2 <= high and s.t3 >= low and s.t2 < FAR
    t0, part0 = (s.t0, s.part0) if s.t0 >= low else (low, low_part)
    t1, part1 = (s.t1, s.part1) if s.t1 <= high else (high, high_part)
    t2, part2 = (s.t2, s.part2) if s.t2 >= low else (low, low_part)
    t3, part3 = (s.t3, s.part3) if s.t3 <= high else (high, high_part)
    if not low <= high or not (first or second):
        return nowhere()
    if first and second:
        return Spans(t0, t1, t2, t3, part0, part1, part2, part3)
    if first:
        return Spans(t0, t1, FAR, FAR, part0, part1, 0, 0)
    return Spans(t2, t3, FAR, FAR, part2, part3, 0, 0)


# --- hits -----------------------------------------------------------------------------------------------------------------


@kernel
def no_hit() -> ShapeHit:
    """A miss."""
    return ShapeHit(_INFINITY, -1, ZERO, ZERO, ZERO)


@kernel
def first_hit(s: Spans, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """The first end of a span in (t_min, t_max); without `both_sides`, the first where the solid is entered."""
    return first_hit_between(s, -FAR, FAR, t_min, t_max, both_sides)


@kernel
def first_hit_between(s: Spans, low: np.float64, high: np.float64, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """As `first_hit`, among the ends from `low` to `high`: of a surface that is cut off there and left open."""
    t = f32(s.t0)
    if t_min < t and t < t_max and low <= s.t0 and s.t0 <= high:
        return ShapeHit(t, s.part0, ZERO, ZERO, ONE)
    t = f32(s.t1)
    if both_sides and t_min < t and t < t_max and low <= s.t1 and s.t1 <= high:
        return ShapeHit(t, s.part1, ZERO, ZERO, -ONE)
    t = f32(s.t2)
    if t_min < t and t < t_max and low <= s.t2 and s.t2 <= high:
        return ShapeHit(t, s.part2, ZERO, ZERO, ONE)
    t = f32(s.t3)
    if both_sides and t_min < t and t < t_max and low <= s.t3 and s.t3 <= high:
        return ShapeHit(t, s.part3, ZERO, ZERO, -ONE)
    return no_hit()


# --- equations ------------------------------------------------------------------------------------------------------------


@kernel
def slab(o: np.float64, d: np.float64, low: np.float64, high: np.float64) -> tuple[np.float64, np.float64]:
    """From where to where low <= o + t d <= high; from inf to -inf where nowhere."""
    if d == _NONE:
        return (-FAR, FAR) if low <= o and o <= high else (FAR, -FAR)
    at_low, at_high = (low - o) / d, (high - o) / d
    return (at_low, at_high) if d > _NONE else (at_high, at_low)


@kernel
def ordered_roots(a: np.float64, b: np.float64, c: np.float64, discriminant: np.float64) -> tuple[np.float64, np.float64]:
    """Both solutions of a t^2 + 2 b t + c = 0, ascending; a is not 0, and the discriminant b^2 - a c, given, not negative.

    The greater by sum, the other by the product of both, so that nothing cancels. The discriminant comes from the caller, who can
    often write it without a difference of great numbers.

    **Source**: Forsythe, *How do you solve a quadratic equation?*, 1966; Haines et al., *Precision improvements for ray/sphere
    intersection*, Ray Tracing Gems, 2019.
    """
    root = np.sqrt(discriminant)
    q = -(b + root) if b >= _NONE else root - b
    first = q / a
    second = c / q if q != _NONE else first
    return (first, second) if first <= second else (second, first)
