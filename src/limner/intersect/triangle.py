"""Ray and triangle (FoCG 4.4.2), watertight: a ray at an edge shared by two triangles hits at least one of them.

The ray is turned so that it runs along +z of its own space, and the question becomes on which side of the three edges the origin
of a plane lies. Neighbouring triangles compute the very same number for their common edge, so nothing slips between.

**Source**: Woop, Benthin and Wald, *Watertight ray/triangle intersection*, JCGT 2(1), 2013.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = ["TriangleHit", "TurnedRay", "intersect_triangle", "turned_ray"]

f32, f64 = np.float32, np.float64
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
    if k == 0:
        return v.x
    return v.y if k == 1 else v.z


@kernel
def turned_ray(o: Vec3, d: Vec3) -> TurnedRay:
    """What is computed once for a ray and used for every triangle."""
    ax, ay, az = abs(d.x), abs(d.y), abs(d.z)
    kz = 2
    if ax >= ay and ax >= az:
        kz = 0
    elif ay >= az:
        kz = 1
    kx = kz + 1 if kz < 2 else 0
    ky = kx + 1 if kx < 2 else 0
    dz = _component(d, kz)
    if dz < ZERO:
        kx, ky = ky, kx
    return TurnedRay(
        kx, ky, kz, _component(d, kx) / dz, _component(d, ky) / dz, ONE / dz, _component(o, kx), _component(o, ky), _component(o, kz)
    )


@kernel
def intersect_triangle(ray: TurnedRay, v, row: int, t_min: np.float32, t_max: np.float32) -> TriangleHit:
    """Hit the triangle whose vertices stand in v[row, 0:9]. Comparisons are written so that a NaN is a miss."""
    az, bz, cz = v[row, ray.kz] - ray.oz, v[row, 3 + ray.kz] - ray.oz, v[row, 6 + ray.kz] - ray.oz
    ax, ay = v[row, ray.kx] - ray.ox - ray.sx * az, v[row, ray.ky] - ray.oy - ray.sy * az
    bx, by = v[row, 3 + ray.kx] - ray.ox - ray.sx * bz, v[row, 3 + ray.ky] - ray.oy - ray.sy * bz
    cx, cy = v[row, 6 + ray.kx] - ray.ox - ray.sx * cz, v[row, 6 + ray.ky] - ray.oy - ray.sy * cz
    e0, e1, e2 = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
    if e0 == ZERO or e1 == ZERO or e2 == ZERO:
        # On an edge to within rounding: the products of float32 are exact in float64.
        e0 = f32(f64(cx) * f64(by) - f64(cy) * f64(bx))
        e1 = f32(f64(ax) * f64(cy) - f64(ay) * f64(cx))
        e2 = f32(f64(bx) * f64(ay) - f64(by) * f64(ax))
    outside = (e0 < ZERO or e1 < ZERO or e2 < ZERO) and (e0 > ZERO or e1 > ZERO or e2 > ZERO)
    total = e0 + e1 + e2
    inverse = ONE / total
    t = (e0 * az + e1 * bz + e2 * cz) * ray.sz * inverse
    if outside or total == ZERO or not (t_min < t and t < t_max):
        return TriangleHit(_INFINITY, ZERO, ZERO, ZERO)
    return TriangleHit(t, e1 * inverse, e2 * inverse, total)
