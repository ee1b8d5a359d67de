"""The fragment stage: the colour of what a sample sees, by the shading functions that all renderers share."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO
from ..shading.bsdf import resolve
from ..shading.lights import ambient_radiance, illuminate, lit_radiance
from ..shading.sky import ambient_from_sky
from ..shading.surface import Barycentrics, SurfacePoint, barycentrics_at, flip_to_front, surface_at, with_normal
from ..shading.visible import direction_to_eye, visible_point
from ..tables.layouts import AMBIENT_LIGHT
from .fill import vertices_of
from .layouts import PER_TRIANGLE, PER_VERTEX

__all__ = ["shade_fragment"]

_THIRD = np.float32(1.0 / 3.0)


@kernel
def _shade(point: SurfacePoint, camera, scene, lighting):
    """(radiance, alpha) of a surface point: emission, ambient light, the sky, and every light, without shadows."""
    _, _, _, _, _, _, materials, lights, textures, texels = scene
    wo = direction_to_eye(camera, point.position)
    point = flip_to_front(point, wo)
    bsdf = resolve(materials[point.material], point, textures, texels)
    radiance = bsdf.emission + ambient_radiance(lights, bsdf) + ambient_from_sky(lighting, bsdf, wo)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            radiance = radiance + lit_radiance(bsdf, wo, illuminate(lights[k], point.position))
    return radiance, bsdf.alpha


@kernel
def _corner(scene, instance_id: int, triangle: int, b0: np.float32, b1: np.float32, b2: np.float32, faceted: bool) -> SurfacePoint:
    """A point of a triangle by its weights alone, with no footprint; `faceted`: with the triangle's own normal."""
    instances, meshes, positions, triangles, attributes, slots, _, _, _, _ = scene
    instance = instances[instance_id]
    w = Barycentrics(b0, b1, b2, ZERO, ZERO, ZERO, ZERO)
    point = surface_at((positions, triangles, attributes, slots), instance, meshes[instance["mesh"]], triangle, w)
    return with_normal(point, point.n) if faceted else point


@kernel
def _gouraud(instance_id: int, triangle: int, w: Barycentrics, camera, scene, lighting):
    """Shade the three vertices and interpolate their colours (FoCG 8.2.4, 10.1.3)."""
    c0, a0 = _shade(_corner(scene, instance_id, triangle, ONE, ZERO, ZERO, False), camera, scene, lighting)
    c1, a1 = _shade(_corner(scene, instance_id, triangle, ZERO, ONE, ZERO, False), camera, scene, lighting)
    c2, a2 = _shade(_corner(scene, instance_id, triangle, ZERO, ZERO, ONE, False), camera, scene, lighting)
    return c0 * w.b0 + c1 * w.b1 + c2 * w.b2, a0 * w.b0 + a1 * w.b1 + a2 * w.b2


@kernel
def shade_fragment(screen_triangle, x, y, camera, scene, lighting, frame, frequency: int):
    """(radiance, alpha) of a screen triangle at raster point (x, y), shaded there, at its vertices, or once for the triangle."""
    instances, meshes, _, triangles, _, _, _, _, _, _ = scene
    vertices, first_vertex, _ = frame
    instance_id, triangle = np.int64(screen_triangle["instance"]), np.int64(screen_triangle["triangle"])
    v0, v1, v2 = vertices_of(screen_triangle, instances, meshes, triangles, vertices, first_vertex)
    if frequency == PER_VERTEX:
        return _gouraud(instance_id, triangle, barycentrics_at(x, y, v0, v1, v2), camera, scene, lighting)
    if frequency == PER_TRIANGLE:
        return _shade(_corner(scene, instance_id, triangle, _THIRD, _THIRD, _THIRD, True), camera, scene, lighting)
    return _shade(visible_point(scene, camera, instance_id, triangle, v0, v1, v2, x, y), camera, scene, lighting)
