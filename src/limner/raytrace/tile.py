"""One tile of the picture, ray by ray."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from .whitted import radiance

__all__ = ["trace_tile"]

f32 = np.float32
_GRID_STEP = f32(1.0 / 256.0)


@kernel
def trace_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    nodes, primitives, corners, planes,
    header, sky, sky_cumulative, emitters, blurred, camera_table, raster_from_object, sample_places,
    background, has_alpha, shadows, max_depth,
    pending, stack, film, tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Trace some samples of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    accelerator = (nodes, primitives, corners, planes)
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    camera = camera_table[0]
    for j in range(first_row, first_row + rows):
        for i in range(first_column, first_column + columns):
            for s in range(first_sample, last_sample):
                x = f32(i) + f32(sample_places[s, 0]) * _GRID_STEP
                y = f32(j) + f32(sample_places[s, 1]) * _GRID_STEP
                c, alpha = radiance(
                    scene, accelerator, lighting, camera, raster_from_object, background, has_alpha, shadows, max_depth, x, y, pending,
                    stack,
                )  # fmt: skip
                film[j, i, 0] += c.r
                film[j, i, 1] += c.g
                film[j, i, 2] += c.b
                film[j, i, 3] += alpha
