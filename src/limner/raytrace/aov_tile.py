"""The channels beside the picture, from one ray through the centre of each pixel."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..accel.walk import exact_tables, nearest
from ..kernel.vec import ZERO
from ..shading.analytic import view_ray
from ..shading.aov import write_aov
from ..shading.bsdf import alpha_at
from ..visibility.hit import first_hit_point

__all__ = ["trace_aov_tile", "trace_aov_tile_exact"]

f32 = np.float32
_STEP = f32(1e-6)
_MAX_SURFACES = 256


@kernel
def trace_aov_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    nodes, packs, tags, primitives, planes, camera_table, raster_from_object, stack, ends, values, ids,
    tile, first_column, first_row, columns, rows,
):  # fmt: skip
    """Fill the channels of a tile: values (height, width, 16), ids (height, width, 3), row 0 at the bottom."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    accelerator = (nodes, packs, tags, primitives, planes, exact_tables(attributes, slots, ends))
    camera = camera_table[0]
    for j in range(first_row, first_row + rows):
        for i in range(first_column, first_column + columns):
            ray = view_ray(camera, f32(i), f32(j))
            t_min = camera["near"]
            for _ in range(_MAX_SURFACES):
                hit = nearest(accelerator, instances, ray.o, ray.d, t_min, camera["far"], stack)
                if hit.instance < 0:
                    break
                point = first_hit_point(scene, accelerator, camera, raster_from_object, hit, f32(i), f32(j))
                if alpha_at(materials[point.material], point, textures, texels) > ZERO:
                    write_aov(scene, camera, hit.instance, hit.triangle, point, values, ids, i, j)
                    break
                t_min = hit.t + abs(hit.t) * _STEP


trace_aov_tile_exact = trace_aov_tile
"""The same, compiled for scenes with exact shapes beside spheres and planes."""
