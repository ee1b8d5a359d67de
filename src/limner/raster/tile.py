"""One tile of the picture, from its triangles to its pixels."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import BLACK_LIMIT, ONE, ZERO, Color, normalize
from ..shading.analytic import view_ray
from ..shading.sky import sky_radiance
from ..tables.layouts import PERSPECTIVE
from .fill import fill_opaque, fill_transparent
from .fragment import shade_fragment
from .layouts import SUBPIXELS

__all__ = ["draw_tile"]

f32, i32 = np.float32, np.int32
_GRID_STEP = f32(1.0 / SUBPIXELS)
_MAX_LAYERS = 64
_NOTHING = i32(-1)
_NEAREST_POSSIBLE = f32(3e38)


@kernel
def _clear(depth, seen, farthest: np.float32, n: int):
    for p in range(n):
        depth[p], seen[p] = farthest, _NOTHING


@kernel
def _sample_point(p: int, window, ox: int, oy: int):
    """Raster coordinates of pixel p of a window at a sample's place."""
    i, j = window[0] + p % window[2], window[1] + p // window[2]
    return f32(i) + f32(ox) * _GRID_STEP, f32(j) + f32(oy) * _GRID_STEP


@kernel
def _blend_layer(screen, window, ox, oy, n, camera, scene, lighting, frame, next_depth, next_seen, last_depth, last_seen, layers, transmittance):
    """Put one layer of transparent fragments behind those already there (front to back), and remember how far it went."""
    for p in range(n):
        if next_seen[p] < 0:
            continue
        x, y = _sample_point(p, window, ox, oy)
        c, alpha = shade_fragment(screen[next_seen[p]], x, y, camera, scene, lighting, frame)
        weight = transmittance[p] * alpha
        layers[p, 0] += weight * c.r
        layers[p, 1] += weight * c.g
        layers[p, 2] += weight * c.b
        transmittance[p] *= ONE - alpha
        last_depth[p], last_seen[p] = next_depth[p], next_seen[p]


@kernel
def draw_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, camera_table, vertices, first_vertex, screen, binned, bin_range, has_blend, sample_places, background,
    depth, seen, last_depth, last_seen, next_depth, next_seen, layers, transmittance, film,
    tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Draw some samples of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom.

    bin_range (tiles + 1): where each tile's triangles stand in `binned`. sample_places (n, 2) int32: on the subpixel grid.
    """
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    lighting = (header, sky, sky_cumulative, emitters)
    frame = (vertices, first_vertex)
    camera = camera_table[0]
    window = (first_column, first_row, columns, rows)
    first, last = bin_range[tile], bin_range[tile + 1]
    n = columns * rows
    farthest = camera["near"] / camera["far"] if camera["kind"] == PERSPECTIVE else ZERO
    for s in range(first_sample, last_sample):
        ox, oy = np.int64(sample_places[s, 0]), np.int64(sample_places[s, 1])
        _clear(depth, seen, farthest, n)
        fill_opaque(screen, binned, first, last, window, ox, oy, camera, scene, frame, depth, seen)
        for p in range(n):
            layers[p, 0], layers[p, 1], layers[p, 2], transmittance[p] = ZERO, ZERO, ZERO, ONE
        if has_blend != 0:
            _clear(last_depth, last_seen, _NEAREST_POSSIBLE, n)
            for _ in range(_MAX_LAYERS):
                _clear(next_depth, next_seen, -ONE, n)
                if not fill_transparent(
                    screen, binned, first, last, window, ox, oy, depth, last_depth, last_seen, next_depth, next_seen
                ):
                    break
                _blend_layer(
                    screen, window, ox, oy, n, camera, scene, lighting, frame, next_depth, next_seen, last_depth, last_seen, layers,
                    transmittance,
                )  # fmt: skip
        for p in range(n):
            t = transmittance[p]
            x, y = _sample_point(p, window, ox, oy)
            c, alpha = Color(background[0], background[1], background[2]) * background[3], background[3]
            if seen[p] < 0 and header[0]["sky_visible"] != 0:
                c, alpha = sky_radiance(lighting, normalize(view_ray(camera, x, y).d)), ONE
            if seen[p] >= 0 and t > BLACK_LIMIT:
                c, alpha = shade_fragment(screen[seen[p]], x, y, camera, scene, lighting, frame)
                alpha = ONE
            i, j = first_column + p % columns, first_row + p // columns
            film[j, i, 0] += layers[p, 0] + t * c.r
            film[j, i, 1] += layers[p, 1] + t * c.g
            film[j, i, 2] += layers[p, 2] + t * c.b
            film[j, i, 3] += (ONE - t) + t * alpha
