"""One ray, one exact shape, whatever its kind: the dispatcher of this room.

`shape` is a row of `tables.layouts.INSTANCE`, `numbers` the array that it may refer to (`intersect.layouts`). Rays are in the world and
come into the shape's space in float64, so that a float32 transform is the only thing that rounds; t stays what it was.

    hit = intersect_shape(shape, numbers, o, d, t_min, t_max, True)
    point = shape_at(shape, numbers, o, d, hit.t, hit.part, hit.u, hit.v)
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO, Vec3
from .ball import ball_area, ball_at, ball_range, ball_spans
from .cone import cone_area, cone_at, cone_range, cone_spans, intersect_cone
from .cuboid import cuboid_area, cuboid_at, cuboid_range, cuboid_spans
from .cylinder import cylinder_area, cylinder_at, cylinder_range, cylinder_spans, intersect_cylinder
from .disk import disk_area, disk_at, disk_range, intersect_disk
from .distance_field import distance_field_range
from .half_space import half_space_at, half_space_spans
from .interval import Ray, ShapeHit, Spans, first_hit, no_hit, nowhere, point_at, ray_in
from .layouts import BOX, CONE, CYLINDER, DISK, DISTANCE_FIELD, PATCH, PLANE, QUADRIC, SPHERE, TORUS
from .object_point import ObjectPoint
from .patch import intersect_patch, patch_at, patch_range
from .quadric import intersect_quadric, quadric_at, quadric_range, quadric_spans
from .torus import intersect_torus, torus_area, torus_at, torus_range, torus_spans

__all__ = ["intersect_shape", "shape_area", "shape_at", "shape_bounds", "shape_range", "solid_spans"]

f32 = np.float32
_INFINITY = f32(np.inf)
_MARGIN = f32(1e-6)


@kernel
def _size(shape) -> Vec3:
    return Vec3(shape["size"][0], shape["size"][1], shape["size"][2])


@kernel
def solid_spans(shape, numbers, ray: Ray) -> Spans:
    """Where a ray in the shape's own space is inside; nowhere for what has no inside. Cylinders, cones and quadrics are closed."""
    kind, size = shape["kind"], _size(shape)
    if kind == SPHERE:
        return ball_spans(ray, size.x)
    if kind == BOX:
        return cuboid_spans(ray, size)
    if kind == CYLINDER:
        return cylinder_spans(ray, size.x, size.y)
    if kind == CONE:
        return cone_spans(ray, size.x, size.y, size.z)
    if kind == TORUS:
        return torus_spans(ray, size.x, size.y)
    if kind == QUADRIC:
        return quadric_spans(ray, numbers, shape["place"])
    if kind == PLANE:
        return half_space_spans(ray)
    return nowhere()


@kernel
def intersect_shape(shape, numbers, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, both_sides: bool) -> ShapeHit:
    """The nearest hit in (t_min, t_max) of the world ray o + t d; without `both_sides`, of the front only."""
    kind, size, place = shape["kind"], _size(shape), shape["place"]
    ray = ray_in(shape["object_from_world"], o, d)
    if kind == DISK:
        return intersect_disk(ray, size.x, t_min, t_max, both_sides)
    if kind == CYLINDER:
        return intersect_cylinder(ray, size.x, size.y, shape["capped"], t_min, t_max, both_sides)
    if kind == CONE:
        return intersect_cone(ray, size.x, size.y, size.z, shape["capped"], t_min, t_max, both_sides)
    if kind == TORUS:
        return intersect_torus(ray, size.x, size.y, t_min, t_max, both_sides)
    if kind == QUADRIC:
        return intersect_quadric(ray, numbers, place, shape["capped"], t_min, t_max, both_sides)
    if kind == PATCH:
        return intersect_patch(ray, numbers, place, t_min, t_max, both_sides)
    if kind == SPHERE:
        return first_hit(ball_spans(ray, size.x), t_min, t_max, both_sides)
    if kind == BOX:
        return first_hit(cuboid_spans(ray, size), t_min, t_max, both_sides)
    if kind == PLANE:
        return first_hit(half_space_spans(ray), t_min, t_max, both_sides)
    return no_hit()


@kernel
def shape_at(shape, numbers, o: Vec3, d: Vec3, t: np.float32, part: int, u: np.float32, v: np.float32) -> ObjectPoint:
    """The point, in object space, at which the world ray hits; `part`, `u` and `v` as `intersect_shape` found them."""
    kind, size, place = shape["kind"], _size(shape), shape["place"]
    if kind == PATCH:
        return patch_at(numbers, place, u, v)
    p = point_at(ray_in(shape["object_from_world"], o, d), t)
    if kind == DISK:
        return disk_at(p, size.x)
    if kind == CYLINDER:
        return cylinder_at(p, size.x, size.y, part)
    if kind == CONE:
        return cone_at(p, size.x, size.y, size.z, part)
    if kind == TORUS:
        return torus_at(p, size.x, size.y)
    if kind == QUADRIC:
        return quadric_at(p, numbers, place, part)
    if kind == SPHERE:
        return ball_at(p, size.x)
    if kind == BOX:
        return cuboid_at(p, size, part)
    return half_space_at(p)


@kernel
def shape_range(shape, numbers, a: Vec3) -> tuple[np.float32, np.float32]:
    """The least and the greatest a . p over the shape, p in object space; infinite for what has no end."""
    kind, size, place = shape["kind"], _size(shape), shape["place"]
    if kind == SPHERE:
        return ball_range(a, size.x)
    if kind == BOX:
        return cuboid_range(a, size)
    if kind == DISK:
        return disk_range(a, size.x)
    if kind == CYLINDER:
        return cylinder_range(a, size.x, size.y)
    if kind == CONE:
        return cone_range(a, size.x, size.y, size.z)
    if kind == TORUS:
        return torus_range(a, size.x, size.y)
    if kind == QUADRIC:
        return quadric_range(a, numbers, place)
    if kind == PATCH:
        return patch_range(a, numbers, place)
    if kind == DISTANCE_FIELD:
        return distance_field_range(a, numbers, place)
    return -_INFINITY, _INFINITY


@kernel
def shape_bounds(shape, numbers) -> tuple[Vec3, Vec3]:
    """The low and the high corner of the shape's box in the world, wider by some rounding: a . p for the rows a of its transform."""
    m = shape["world_from_object"]
    x0, x1 = shape_range(shape, numbers, Vec3(m[0, 0], m[0, 1], m[0, 2]))
    y0, y1 = shape_range(shape, numbers, Vec3(m[1, 0], m[1, 1], m[1, 2]))
    z0, z1 = shape_range(shape, numbers, Vec3(m[2, 0], m[2, 1], m[2, 2]))
    reach = Vec3(max(abs(x0), abs(x1)) + abs(m[0, 3]), max(abs(y0), abs(y1)) + abs(m[1, 3]), max(abs(z0), abs(z1)) + abs(m[2, 3]))
    margin, middle = reach * _MARGIN, Vec3(m[0, 3], m[1, 3], m[2, 3])
    return Vec3(x0, y0, z0) + middle - margin, Vec3(x1, y1, z1) + middle + margin


@kernel
def shape_area(shape) -> np.float32:
    """The area of its surface in object space, of one side; 0 where there is no formula (quadric, patch) and no end (plane)."""
    kind, size = shape["kind"], _size(shape)
    if kind == SPHERE:
        return ball_area(size.x)
    if kind == BOX:
        return cuboid_area(size)
    if kind == DISK:
        return disk_area(size.x)
    if kind == CYLINDER:
        return cylinder_area(size.x, size.y, shape["capped"])
    if kind == CONE:
        return cone_area(size.x, size.y, size.z, shape["capped"])
    if kind == TORUS:
        return torus_area(size.x, size.y)
    return ZERO
