"""The fragment stage: the colour of what a sample sees, by the shading functions that all renderers share."""

from __future__ import annotations

from .._jit import kernel
from ..kernel.vec import Vec3, normalize
from ..shading.bsdf import resolve
from ..shading.lights import ambient_radiance, illuminate, lit_radiance
from ..shading.surface import barycentrics_at, flip_to_front, surface_at
from ..tables.layouts import AMBIENT_LIGHT, ORTHOGRAPHIC
from .fill import vertices_of

__all__ = ["shade_fragment"]


@kernel
def direction_to_eye(camera, p: Vec3) -> Vec3:
    """wo: from a point to the eye, unit."""
    if camera["kind"] == ORTHOGRAPHIC:
        return Vec3(-camera["gaze"][0], -camera["gaze"][1], -camera["gaze"][2])
    return normalize(Vec3(camera["position"][0], camera["position"][1], camera["position"][2]) - p)


@kernel
def shade_fragment(screen_triangle, x, y, camera, scene, frame):
    """(radiance, alpha) of a screen triangle at raster point (x, y): emission, ambient, and every light without shadows."""
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels = scene
    vertices, first_vertex = frame
    instance = instances[screen_triangle["instance"]]
    v0, v1, v2 = vertices_of(screen_triangle, instances, meshes, triangles, vertices, first_vertex)
    w = barycentrics_at(x, y, v0, v1, v2)
    point = surface_at((positions, triangles, attributes, slots), instance, meshes[instance["mesh"]], screen_triangle["triangle"], w)
    wo = direction_to_eye(camera, point.position)
    point = flip_to_front(point, wo)
    bsdf = resolve(materials[point.material], point, textures, texels)
    radiance = bsdf.emission + ambient_radiance(lights, bsdf)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            radiance = radiance + lit_radiance(bsdf, wo, illuminate(lights[k], point.position))
    return radiance, bsdf.alpha
