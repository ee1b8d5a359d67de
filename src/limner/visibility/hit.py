"""From a hit to the surface point, for the three kinds of rays: through a pinhole, through a lens or at a time of its own, and all others.

A pinhole's rays look their point up by the raster point, by the function that the rasteriser calls too, so that both see the same bits. A
ray through a lens has no raster point that a vertex could be taken to; how its point moves from pixel to pixel follows from how the ray
does (Igehy, *Tracing ray differentials*, 1999).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.transform import transform_vector
from ..kernel.vec import ONE, ZERO, Vec3, cross, dot
from ..shading.analytic import ViewRay, moved, ray_without_view, view_ray
from ..shading.exact import exact_at
from ..shading.surface import (
    Barycentrics,
    SurfacePoint,
    barycentrics_of_hit,
    surface_at,
    to_raster,
    vertices_at,
)
from ..shading.visible import visible_point

__all__ = ["first_hit_point", "hit_point", "lens_hit_point"]

f32 = np.float32


@kernel
def _vertex(positions, mesh, row: int) -> Vec3:
    i = mesh["position"] + row
    return Vec3(positions[i, 0], positions[i, 1], positions[i, 2])


@kernel
def first_hit_point(scene, accelerator, camera, raster_from_object, hit, x: np.float32, y: np.float32) -> SurfacePoint:
    """The surface point of a camera ray's hit, from the raster point, by the function that the rasteriser calls."""
    instances, meshes, positions, triangles, _, _, _, _, _, _ = scene
    if hit.triangle < 0:
        return exact_at(instances, hit.instance, accelerator[5], view_ray(camera, x, y), hit.t, hit.triangle, hit.u, hit.v)
    mesh = meshes[instances[hit.instance]["mesh"]]
    row = mesh["triangle"] + hit.triangle
    v0 = to_raster(raster_from_object, hit.instance, _vertex(positions, mesh, triangles[row, 0]))
    v1 = to_raster(raster_from_object, hit.instance, _vertex(positions, mesh, triangles[row, 1]))
    v2 = to_raster(raster_from_object, hit.instance, _vertex(positions, mesh, triangles[row, 2]))
    return visible_point(scene, camera, hit.instance, hit.triangle, v0, v1, v2, x, y)


@kernel
def hit_point(scene, accelerator, hit, o: Vec3, d: Vec3) -> SurfacePoint:
    """The surface point of any other ray's hit."""
    instances, meshes, positions, triangles, attributes, slots, _, _, _, _ = scene
    instance = instances[hit.instance]
    if hit.triangle < 0:
        return exact_at(instances, hit.instance, accelerator[5], ray_without_view(o, d), hit.t, hit.triangle, hit.u, hit.v)
    w, mesh = barycentrics_of_hit(hit.u, hit.v), meshes[instance["mesh"]]
    return surface_at((positions, triangles, attributes, slots), instance, mesh, hit.triangle, w, meshes, accelerator[5])


@outlined
def _weights_seen_by(instance, v0: Vec3, v1: Vec3, v2: Vec3, ray: ViewRay, hit) -> Barycentrics:
    """The hit's barycentric coordinates, with their change from pixel to pixel: of ``du = (dp x b).n / n.n``, ``dv = (a x dp).n / n.n``."""
    m = instance["object_from_world"]
    a, b = v1 - v0, v2 - v0
    n = cross(a, b)
    squared = dot(n, n)
    scale = ONE / squared if squared > ZERO else ZERO
    d = transform_vector(m, ray.d)
    dpdx = moved(transform_vector(m, ray.dodx), transform_vector(m, ray.dddx), hit.t, d, n)
    dpdy = moved(transform_vector(m, ray.dody), transform_vector(m, ray.dddy), hit.t, d, n)
    dudx, dvdx = dot(cross(dpdx, b), n) * scale, dot(cross(a, dpdx), n) * scale
    dudy, dvdy = dot(cross(dpdy, b), n) * scale, dot(cross(a, dpdy), n) * scale
    return Barycentrics((ONE - hit.u) - hit.v, hit.u, hit.v, -dudx - dvdx, dudx, -dudy - dvdy, dudy)


@kernel
def lens_hit_point(scene, accelerator, hit, ray: ViewRay) -> SurfacePoint:
    """The surface point of a hit of a ray that knows how it changes from pixel to pixel."""
    instances, meshes, positions, triangles, attributes, slots, _, _, _, _ = scene
    instance = instances[hit.instance]
    if hit.triangle < 0:
        return exact_at(instances, hit.instance, accelerator[5], ray, hit.t, hit.triangle, hit.u, hit.v)
    mesh = meshes[instance["mesh"]]
    v0, v1, v2 = vertices_at(positions, triangles, instance, mesh, hit.triangle, meshes, accelerator[5])
    w = _weights_seen_by(instance, v0, v1, v2, ray, hit)
    return surface_at((positions, triangles, attributes, slots), instance, mesh, hit.triangle, w, meshes, accelerator[5])
