"""One tile of the picture, path by path."""

from __future__ import annotations

from .._jit import kernel
from .path import path_radiance

__all__ = ["trace_path_tile"]


@kernel
def trace_path_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    nodes, primitives, corners, planes,
    header, sky, sky_cumulative, emitters, blurred, camera_table, raster_from_object, background, has_alpha,
    max_depth, seed, stack, film, tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Trace some paths for every pixel of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    accelerator = (nodes, primitives, corners, planes)
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    camera = camera_table[0]
    for j in range(first_row, first_row + rows):
        for i in range(first_column, first_column + columns):
            for s in range(first_sample, last_sample):
                c, alpha = path_radiance(
                    scene, accelerator, lighting, camera, raster_from_object, background, has_alpha, max_depth, seed, i, j, s, stack
                )
                film[j, i, 0] += c.r
                film[j, i, 1] += c.g
                film[j, i, 2] += c.b
                film[j, i, 3] += alpha
