"""Points of exact shapes, whatever their kind, from the ray that met them.

Spheres and planes have formulas of their own (`shading.analytic`), which the rasteriser shares; here is what only rays see exactly:
disks, cylinders, cones, tori, quadrics, patches, fields of distances, and the leaves of combinations, turned inside out where they were
cut away.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..intersect.distance_field import distance_field_at
from ..intersect.layouts import DISTANCE_FIELD
from ..intersect.object_point import ObjectPoint
from ..intersect.shape import shape_at
from ..intersect.surface_code import is_turned, part_of
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot
from .analytic import ViewRay, analytic_at, moved
from .surface import Detail, Footprint, SurfacePoint, no_detail, transform_normal, transformed_reach, transposed_vector
from .visible import is_analytic

__all__ = ["exact_at"]


@kernel
def exact_at(instances, row: int, exact, ray: ViewRay, t: np.float32, code: int, u: np.float32, v: np.float32) -> SurfacePoint:
    """The surface point of the exact shape in a row of the instances that a ray meets at t; `code`, u and v as in `accel.walk.Hit`.

    `exact`: (attributes, slots, ends), or None where there are only spheres and planes.
    """
    instance = instances[row]
    if exact is not None:  # known to the compiler
        owner = instance["owner"]
        if is_turned(code) or not is_analytic(instance) or (instance["detailed"] != 0 and owner != row):
            return _shape_point(instance, instances[owner], owner != row, exact, ray, t, code, u, v)
    return analytic_at(instance, ray, t)


@kernel
def _detail(instance, owner, is_leaf: bool, at: ObjectPoint, turned: bool, dpdx: Vec3, dpdy: Vec3) -> Detail:
    """The point in its owner's space: a solid made of solids is carved from one piece."""
    if not is_leaf:
        return Detail(at.p, at.n, dpdx, dpdy, at.gradient_u, at.gradient_v)
    w, m = instance["world_from_object"], owner["object_from_world"]
    n = -at.n if turned else at.n
    inward, outward = instance["object_from_world"], owner["world_from_object"]
    return Detail(
        transform_point(m, transform_point(w, at.p)), transposed_vector(outward, transposed_vector(inward, n)),
        transform_vector(m, transform_vector(w, dpdx)), transform_vector(m, transform_vector(w, dpdy)),
        transposed_vector(outward, transposed_vector(inward, at.gradient_u)),
        transposed_vector(outward, transposed_vector(inward, at.gradient_v)),
    )  # fmt: skip


@outlined
def _shape_point(
    instance, owner, is_leaf: bool, exact, ray: ViewRay, t: np.float32, code: int, u: np.float32, v: np.float32
) -> SurfacePoint:
    numbers, _, ends = exact
    if instance["kind"] == DISTANCE_FIELD:
        at = distance_field_at(instance, numbers, ray.o, ray.d, t, ends)
    else:
        at = shape_at(instance, numbers, ray.o, ray.d, t, part_of(code), u, v)
    m, w = instance["object_from_world"], instance["world_from_object"]
    # An apex has no normal: it looks at whoever looks at it.
    d = transform_vector(m, ray.d)
    n_object = at.n if dot(at.n, at.n) > ZERO else -d
    dpdx = moved(transform_vector(m, ray.dodx), transform_vector(m, ray.dddx), t, d, n_object)
    dpdy = moved(transform_vector(m, ray.dody), transform_vector(m, ray.dddy), t, d, n_object)
    footprint = Footprint(
        dot(at.gradient_u, dpdx), dot(at.gradient_v, dpdx), dot(at.gradient_u, dpdy), dot(at.gradient_v, dpdy), ZERO, ZERO, ZERO, ZERO
    )
    n = transform_normal(instance, n_object)
    sign = ONE if dot(cross(n_object, at.tangent), at.gradient_v) >= ZERO else -ONE
    if instance["flipped"] != 0:
        sign = -sign
    if is_turned(code):
        n, sign = -n, -sign
    detail = no_detail(t)
    if instance["detailed"] != 0:
        detail = _detail(instance, owner, is_leaf, at, is_turned(code), dpdx, dpdy)
    return SurfacePoint(
        transform_point(w, at.p), n, n, transform_vector(w, at.tangent), sign, at.u, at.v, ZERO, ZERO, Color(ONE, ONE, ONE), ONE, footprint,
        np.int64(instance["material"]), Vec3(ZERO, ZERO, ZERO), transformed_reach(w, abs(at.p.x), abs(at.p.y), abs(at.p.z)),
        detail,
    )  # fmt: skip
