"""Ray and axis-aligned box as a solid, its faces told apart (FoCG 12.3.1). `intersect.box` is for trees: it only tells how near.

Faces are numbered +x, -x, +y, -y, +z, -z. Each shows the whole texture, not mirrored: v up on the walls, u along +x on the faces +y
and -y, as `mesh.shapes.platonic.box` has it.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3
from .interval import FAR, Ray, Spans, is_ray, nowhere, slab, span
from .object_point import ObjectPoint

__all__ = ["box_spans", "cuboid_area", "cuboid_at", "cuboid_range", "cuboid_spans", "face_at"]

f32, f64 = np.float32, np.float64
_HALF, _EIGHT = f32(0.5), f32(8.0)
_NONE = f64(0.0)


@kernel
def cuboid_spans(ray: Ray, half: Vec3) -> Spans:
    """Where the ray is inside the box of the given half edges around the origin."""
    return box_spans(ray, -half, half, 0)


@kernel
def box_spans(ray: Ray, low: Vec3, high: Vec3, first_part: int) -> Spans:
    """Where the ray is inside the box from corner to corner, whose faces are the parts from `first_part` on.

    In all three slabs at once; where the ray meets two faces in one point, on an edge, the earlier axis has it.
    """
    if not is_ray(ray):
        return nowhere()
    enter, leave = slab(ray.ox, ray.dx, f64(low.x), f64(high.x))
    in_face, out_face = (0, 1) if ray.dx < _NONE else (1, 0)
    near, far = slab(ray.oy, ray.dy, f64(low.y), f64(high.y))
    if near > enter:
        enter, in_face = near, 2 if ray.dy < _NONE else 3
    if far < leave:
        leave, out_face = far, 3 if ray.dy < _NONE else 2
    near, far = slab(ray.oz, ray.dz, f64(low.z), f64(high.z))
    if near > enter:
        enter, in_face = near, 4 if ray.dz < _NONE else 5
    if far < leave:
        leave, out_face = far, 5 if ray.dz < _NONE else 4
    if enter == FAR:
        return nowhere()
    return span(enter, first_part + in_face, leave, first_part + out_face)


@kernel
def cuboid_at(p: Vec3, half: Vec3, face: int) -> ObjectPoint:
    """The point next to p of a face of the box of the given half edges around the origin."""
    return face_at(p, -half, half, face)


@kernel
def face_at(p: Vec3, low: Vec3, high: Vec3, face: int) -> ObjectPoint:
    """The point next to p of a face of the box from corner to corner."""
    sign = ONE if face % 2 == 0 else -ONE
    middle, edges = (low + high) * _HALF, high - low
    q = Vec3(_share(p.x - middle.x, edges.x), _share(p.y - middle.y, edges.y), _share(p.z - middle.z, edges.z))
    x, y, z = Vec3(ONE / edges.x, ZERO, ZERO), Vec3(ZERO, ONE / edges.y, ZERO), Vec3(ZERO, ZERO, ONE / edges.z)
    if face < 2:
        place = Vec3(high.x if sign > ZERO else low.x, p.y, p.z)
        tangent = Vec3(ZERO, ZERO, -sign)
        return ObjectPoint(place, Vec3(sign, ZERO, ZERO), tangent, _HALF - sign * q.z, _HALF + q.y, z * -sign, y)
    if face < 4:
        place = Vec3(p.x, high.y if sign > ZERO else low.y, p.z)
        return ObjectPoint(place, Vec3(ZERO, sign, ZERO), Vec3(ONE, ZERO, ZERO), _HALF + q.x, _HALF - sign * q.z, x, z * -sign)
    place = Vec3(p.x, p.y, high.z if sign > ZERO else low.z)
    return ObjectPoint(place, Vec3(ZERO, ZERO, sign), Vec3(sign, ZERO, ZERO), _HALF + sign * q.x, _HALF + q.y, x * sign, y)


@kernel
def _share(distance: np.float32, edge: np.float32) -> np.float32:
    return min(_HALF, max(-_HALF, distance / edge))


@kernel
def cuboid_range(a: Vec3, half: Vec3) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p."""
    reach = abs(a.x) * half.x + abs(a.y) * half.y + abs(a.z) * half.z
    return -reach, reach


@kernel
def cuboid_area(half: Vec3) -> np.float32:
    """2 (xy + yz + zx) of the edges"""
    return _EIGHT * (half.x * half.y + half.y * half.z + half.z * half.x)
