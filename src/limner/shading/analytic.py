"""Points of spheres and planes, which are exact: from the ray that sees them.

Both renderers use them: the rasteriser finds *that* a sphere is seen by its tessellation and asks here *what* is seen. Texture
coordinates change from pixel to pixel as the ray's hit moves in the tangent plane (Igehy, *Tracing ray differentials*, 1999).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..intersect.plane import intersect_plane
from ..intersect.sphere import intersect_sphere
from ..kernel.elementary import PI, TWO_PI, acos, atan2, sqrt
from ..kernel.lanes import spread, where
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, spread3
from ..tables.layouts import PERSPECTIVE, SPHERE
from .surface import Detail, Footprint, SurfacePoint, no_detail, transform_normal, transformed_reach

__all__ = ["ViewRay", "analytic_at", "hit_analytic", "meets_outside", "moved", "ray_without_view", "through_pinhole", "view_ray"]

f32 = np.float32
_HALF = f32(0.5)
_INFINITY = f32(np.inf)


class ViewRay(NamedTuple):
    """A ray and how its origin and direction change from a pixel to its neighbours."""

    o: Vec3
    d: Vec3
    dodx: Vec3
    dody: Vec3
    dddx: Vec3
    dddy: Vec3


@kernel
def through_pinhole(camera, x: np.float32, y: np.float32) -> tuple[Vec3, Vec3]:
    """(origin, direction) of the ray through a raster point, or of the rays through eight, of a camera without a lens in perspective."""
    e = Vec3(camera["position"][0], camera["position"][1], camera["position"][2])
    corner = Vec3(camera["corner"][0], camera["corner"][1], camera["corner"][2])
    dx = Vec3(camera["dx"][0], camera["dx"][1], camera["dx"][2])
    dy = Vec3(camera["dy"][0], camera["dy"][1], camera["dy"][2])
    return e, corner + dx * x + dy * y


@kernel
def view_ray(camera, x: np.float32, y: np.float32) -> ViewRay:
    """The camera's ray through raster point (x, y); one unit of depth per unit of t (FoCG 4.3)."""
    zero = Vec3(ZERO, ZERO, ZERO)
    e, across = through_pinhole(camera, x, y)
    dx = Vec3(camera["dx"][0], camera["dx"][1], camera["dx"][2])
    dy = Vec3(camera["dy"][0], camera["dy"][1], camera["dy"][2])
    o, d, dodx, dody, dddx, dddy = e, across, zero, zero, dx, dy
    if camera["kind"] != PERSPECTIVE:
        gaze = Vec3(camera["gaze"][0], camera["gaze"][1], camera["gaze"][2])
        o, d, dodx, dody, dddx, dddy = e + across, gaze, dx, dy, zero, zero
    return ViewRay(o, d, dodx, dody, dddx, dddy)


@kernel
def ray_without_view(o: Vec3, d: Vec3) -> ViewRay:
    """A ray that no pixel's neighbours share."""
    zero = Vec3(ZERO, ZERO, ZERO)
    return ViewRay(o, d, zero, zero, zero, zero)


@kernel
def hit_analytic(instance, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32) -> np.float32:
    """Where a ray hits an instance's sphere or plane: the ray is taken into object space, its parameter stays."""
    m = instance["object_from_world"]
    o_object, d_object = transform_point(m, o), transform_vector(m, d)
    if instance["kind"] == SPHERE:
        return intersect_sphere(o_object, d_object, instance["size"][0], t_min, t_max)
    return intersect_plane(o_object, d_object, t_min, t_max)


@kernel
def meets_outside(instance, o: Vec3, d: Vec3, t: np.float32) -> bool:
    """Whether a ray meets an instance's sphere or plane at t from the side to which its normals point."""
    m = instance["object_from_world"]
    o_object, d_object = transform_point(m, o), transform_vector(m, d)
    if instance["kind"] == SPHERE:
        return dot(o_object + d_object * t, d_object) < ZERO
    return d_object.y < ZERO


@kernel
def moved(origin: Vec3, direction: Vec3, t: np.float32, d: Vec3, n: Vec3) -> Vec3:
    """How the hit moves in its tangent plane as the ray's origin and direction change."""
    change = origin + direction * t
    along = dot(d, n)
    aside = along != ZERO
    return where(aside, change - d * (dot(change, n) / where(aside, along, ONE)), change)


@kernel
def _sphere_uv(p: Vec3, r: np.float32):
    """FoCG 11.1, turned to y up: u = 1/2 + atan2(-z, x)/2pi, v = 1 - acos(y/r)/pi."""
    return _HALF + atan2(-p.z, p.x) / TWO_PI, ONE - acos(p.y / r) / PI


@kernel
def _sphere_uv_change(p: Vec3, r: np.float32, dp: Vec3):
    """The derivatives of the sphere's u and v along dp."""
    around = p.x * p.x + p.z * p.z
    off_axis = around > ZERO
    held = where(off_axis, around, ONE)
    du, dv = (p.z * dp.x - p.x * dp.z) / (held * TWO_PI), dp.y / (sqrt(held) * PI)
    return where(off_axis, du, ZERO), where(off_axis, dv, ZERO)


@kernel
def _uv_gradients(instance, p: Vec3, r: np.float32):
    """The gradients of u and v in object space; along the surface they tell what `_sphere_uv_change` tells."""
    zero, one = spread(ZERO, p.x), spread(ONE, p.x)
    if instance["kind"] == SPHERE:
        dudx, dvdx = _sphere_uv_change(p, r, Vec3(one, zero, zero))
        _, dvdy = _sphere_uv_change(p, r, Vec3(zero, one, zero))
        dudz, dvdz = _sphere_uv_change(p, r, Vec3(zero, zero, one))
        return Vec3(dudx, zero, dudz), Vec3(dvdx, dvdy, dvdz)
    return Vec3(one, zero, zero), Vec3(zero, zero, -one)


@kernel
def analytic_at(instance, ray: ViewRay, t: np.float32) -> SurfacePoint:
    """The surface point of a sphere or plane that a ray hits at t."""
    m = instance["object_from_world"]
    o, d = transform_point(m, ray.o), transform_vector(m, ray.d)
    p = o + d * t
    n_object, tangent = Vec3(ZERO, ONE, ZERO), Vec3(ONE, ZERO, ZERO)
    r = instance["size"][0]
    if instance["kind"] == SPHERE:
        # Back onto the sphere: what the addition rounded off is seen in shadows.
        p = p * (r / sqrt(dot(p, p)))
        n_object, tangent = p, Vec3(p.z, ZERO, -p.x)
    else:
        p = Vec3(p.x, ZERO, p.z)
    dpdx = moved(transform_vector(m, ray.dodx), transform_vector(m, ray.dddx), t, d, n_object)
    dpdy = moved(transform_vector(m, ray.dody), transform_vector(m, ray.dddy), t, d, n_object)
    if instance["kind"] == SPHERE:
        u, v = _sphere_uv(p, r)
        dudx, dvdx = _sphere_uv_change(p, r, dpdx)
        dudy, dvdy = _sphere_uv_change(p, r, dpdy)
    else:
        u, v = p.x, -p.z
        dudx, dvdx = dpdx.x, -dpdx.z
        dudy, dvdy = dpdy.x, -dpdy.z
    n = transform_normal(instance, n_object)
    w = instance["world_from_object"]
    sign = spread(where(instance["flipped"] != 0, -ONE, ONE), t)
    zero, one = spread(ZERO, t), spread(ONE, t)
    detail = no_detail(t)
    if instance["detailed"] != 0:
        gradient_u, gradient_v = _uv_gradients(instance, p, r)
        detail = Detail(p, spread3(n_object, t), dpdx, dpdy, gradient_u, gradient_v)
    return SurfacePoint(
        transform_point(w, p), n, n, transform_vector(w, tangent), sign, u, v, zero, zero, Color(one, one, one), one,
        Footprint(dudx, dvdx, dudy, dvdy, zero, zero, zero, zero), spread(np.int64(instance["material"]), t), Vec3(zero, zero, zero),
        transformed_reach(w, abs(p.x), abs(p.y), abs(p.z)), detail,
    )  # fmt: skip
