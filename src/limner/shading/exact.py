"""Points of exact shapes, whatever their kind, from the ray that met them.

Spheres and planes have formulas of their own (`shading.analytic`), which the rasteriser shares; here is what only rays see exactly:
disks, cylinders, cones, tori, quadrics, patches, and the leaves of combinations, turned inside out where they were cut away.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..intersect.shape import shape_at
from ..intersect.surface_code import is_turned, part_of
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot
from .analytic import ViewRay, analytic_at, moved
from .surface import Footprint, SurfacePoint, transform_normal, transformed_reach
from .visible import is_analytic

__all__ = ["exact_at"]


@kernel
def exact_at(instance, exact, ray: ViewRay, t: np.float32, code: int, u: np.float32, v: np.float32) -> SurfacePoint:
    """The surface point of an exact shape that a ray meets at t; `code`, u and v as a hit has them (`accel.walk.Hit`).

    `exact`: (attributes, slots, ends), or None where there are only spheres and planes.
    """
    if exact is not None:  # known to the compiler
        if is_turned(code) or not is_analytic(instance):
            return _shape_point(instance, exact[0], ray, t, code, u, v)
    return analytic_at(instance, ray, t)


@outlined
def _shape_point(instance, numbers, ray: ViewRay, t: np.float32, code: int, u: np.float32, v: np.float32) -> SurfacePoint:
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
    return SurfacePoint(
        transform_point(w, at.p), n, n, transform_vector(w, at.tangent), sign, at.u, at.v, ZERO, ZERO, Color(ONE, ONE, ONE), ONE, footprint,
        np.int64(instance["material"]), Vec3(ZERO, ZERO, ZERO), transformed_reach(w, abs(at.p.x), abs(at.p.y), abs(at.p.z)),
    )  # fmt: skip
