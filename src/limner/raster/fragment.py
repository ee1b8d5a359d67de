"""The fragment stage: the colour of what a sample sees, by the shading functions that all renderers share."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..shading.bsdf import resolve
from ..shading.lights import ambient_radiance, illuminate, lit_radiance
from ..shading.sky import ambient_from_sky
from ..shading.surface import flip_to_front
from ..shading.visible import direction_to_eye, visible_point
from ..tables.layouts import AMBIENT_LIGHT
from .fill import vertices_of

__all__ = ["shade_fragment"]


@kernel
def shade_fragment(screen_triangle, x, y, camera, scene, lighting, frame):
    """(radiance, alpha) of a screen triangle at raster point (x, y): emission, ambient light, the sky, and every light, without shadows."""
    instances, meshes, _, triangles, _, _, materials, lights, textures, texels = scene
    vertices, first_vertex = frame
    v0, v1, v2 = vertices_of(screen_triangle, instances, meshes, triangles, vertices, first_vertex)
    instance, triangle = np.int64(screen_triangle["instance"]), np.int64(screen_triangle["triangle"])
    point = visible_point(scene, camera, instance, triangle, v0, v1, v2, x, y)
    wo = direction_to_eye(camera, point.position)
    point = flip_to_front(point, wo)
    bsdf = resolve(materials[point.material], point, textures, texels)
    radiance = bsdf.emission + ambient_radiance(lights, bsdf) + ambient_from_sky(lighting, bsdf, wo)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            radiance = radiance + lit_radiance(bsdf, wo, illuminate(lights[k], point.position))
    return radiance, bsdf.alpha
