"""The channels beside the picture, from the sample in the centre of each pixel."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..shading.aov import write_aov
from ..shading.visible import visible_point
from .fill import eight_pixels, fill_opaque, vertices_of
from .tile import farthest_depth

__all__ = ["draw_aov_tile"]

f32, i32 = np.float32, np.int32


@kernel
def draw_aov_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, floats, ints, values, ids,
    tile, first_column, first_row, columns, rows,
):  # fmt: skip
    """Fill the channels of a tile: values (height, width, 16), ids (height, width, 3), row 0 at the bottom."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    frame = (vertices, first_vertex, cuts)
    camera = camera_table[0]
    window = (first_column, first_row, columns, rows)
    depth, seen = floats[0], ints[0]
    for p in range(columns * rows):
        depth[p], seen[p] = farthest_depth(camera), i32(-1)
    fill_opaque(screen, binned, bin_range[tile], bin_range[tile + 1], window, eight_pixels(0, 0), camera, scene, frame, depth, seen)
    for p in range(columns * rows):
        if seen[p] >= 0:
            i, j = first_column + p % columns, first_row + p // columns
            t = screen[seen[p]]
            v0, v1, v2 = vertices_of(t, instances, meshes, triangles, vertices, first_vertex)
            instance, triangle = np.int64(t["instance"]), np.int64(t["triangle"])
            point = visible_point(scene, camera, instance, triangle, v0, v1, v2, f32(i), f32(j))
            write_aov(scene, camera, instance, triangle, point, values, ids, i, j)
