"""Ray and triangle (FoCG 4.4.2), watertight: a ray at an edge shared by two triangles hits at least one of them.

The ray is turned so that it runs along +z of its own space, and the question becomes on which side of the three edges the origin
of a plane lies. Neighbouring triangles compute the very same number for their common edge, so nothing slips between.

**Source**: Woop, Benthin and Wald, *Watertight ray/triangle intersection*, JCGT 2(1), 2013.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.lanes import any_of, double, single, where
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = ["TriangleHit", "TurnedRay", "hit_triangle", "turned_ray"]

f32 = np.float32
_INFINITY = f32(np.inf)


class TurnedRay(NamedTuple):
    """A ray's own space: the permutation that makes its longest component z, and the shear that makes it straight."""

    kx: int
    ky: int
    kz: int
    sx: np.float32
    sy: np.float32
    sz: np.float32
    ox: np.float32
    oy: np.float32
    oz: np.float32


class TriangleHit(NamedTuple):
    """t (infinity: miss), barycentrics u and v of the second and third vertex, and the sign of the facing: > 0 from the front."""

    t: np.float32
    u: np.float32
    v: np.float32
    facing: np.float32


@kernel
def _component(v: Vec3, k: int) -> np.float32:
    return where(k == 0, v.x, where(k == 1, v.y, v.z))


@kernel
def turned_ray(o: Vec3, d: Vec3) -> TurnedRay:
    """What is computed once for a ray and used for every triangle. No branches: rays go every way."""
    ax, ay, az = abs(d.x), abs(d.y), abs(d.z)
    kz = where((ax >= ay) & (ax >= az), 0, where(ay >= az, 1, 2))
    after = where(kz < 2, kz + 1, 0)
    before = where(kz > 0, kz - 1, 2)
    dz = _component(d, kz)
    kx, ky = where(dz < ZERO, before, after), where(dz < ZERO, after, before)
    return TurnedRay(
        kx, ky, kz, _component(d, kx) / dz, _component(d, ky) / dz, ONE / dz, _component(o, kx), _component(o, ky), _component(o, kz)
    )


@kernel
def _edges(ax, ay, bx, by, cx, cy):
    """On which side of its three edges the origin lies. On an edge to within rounding: the products of float32 are exact in float64."""
    e0, e1, e2 = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
    on_edge = (e0 == ZERO) | (e1 == ZERO) | (e2 == ZERO)
    if any_of(on_edge):
        x0, y0, x1, y1, x2, y2 = double(ax), double(ay), double(bx), double(by), double(cx), double(cy)
        e0 = where(on_edge, single(x2 * y1 - y2 * x1), e0)
        e1 = where(on_edge, single(x0 * y2 - y0 * x2), e1)
        e2 = where(on_edge, single(x1 * y0 - y1 * x0), e2)
    return e0, e1, e2


@kernel
def hit_triangle(ray: TurnedRay, a: Vec3, b: Vec3, c: Vec3, t_min: np.float32, t_max: np.float32) -> TriangleHit:
    """Hit the triangle a, b, c, or eight of them, whose components stand in the ray's order kx, ky, kz.

    Comparisons are written so that a NaN is a miss.
    """
    az, bz, cz = a.z - ray.oz, b.z - ray.oz, c.z - ray.oz
    ax, ay = a.x - ray.ox - ray.sx * az, a.y - ray.oy - ray.sy * az
    bx, by = b.x - ray.ox - ray.sx * bz, b.y - ray.oy - ray.sy * bz
    cx, cy = c.x - ray.ox - ray.sx * cz, c.y - ray.oy - ray.sy * cz
    e0, e1, e2 = _edges(ax, ay, bx, by, cx, cy)
    outside = ((e0 < ZERO) | (e1 < ZERO) | (e2 < ZERO)) & ((e0 > ZERO) | (e1 > ZERO) | (e2 > ZERO))
    total = e0 + e1 + e2
    inverse = ONE / where(total == ZERO, ONE, total)
    t = (e0 * az + e1 * bz + e2 * cz) * ray.sz * inverse
    is_hit = (t_min < t) & (t < t_max) & (total != ZERO) & ~outside
    return TriangleHit(where(is_hit, t, _INFINITY), e1 * inverse, e2 * inverse, total)
