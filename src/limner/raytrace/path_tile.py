"""One tile of the picture, path by path."""

from __future__ import annotations

from .._jit import kernel
from ..accel.walk import exact_tables
from ..kernel.sampler import draw_1d
from ..kernel.vec import Vec3
from .path import path_radiance
from .rules import rules_of, sampler_of
from .start import TIME, media_of_eye, set_instant

__all__ = ["trace_path_tile", "trace_path_tile_exact", "trace_path_tile_layered"]


@kernel
def trace_path_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    nodes, packs, tags, primitives, planes,
    header, sky, sky_cumulative, emitters, blurred, camera_table, raster_from_object,
    media, instants, moving, cameras, background, rule_numbers,
    stack, ends, film, tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Trace some paths for every pixel of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    accelerator = (nodes, packs, tags, primitives, planes, exact_tables(attributes, slots, ends))
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    camera, rules, moves = camera_table[0], rules_of(rule_numbers), cameras.shape[0] > 0
    eye = Vec3(camera["position"][0], camera["position"][1], camera["position"][2])
    outside = media_of_eye(scene, accelerator, media, camera, eye, stack)
    for j in range(first_row, first_row + rows):
        for i in range(first_column, first_column + columns):
            for s in range(first_sample, last_sample):
                sampler = sampler_of(rules, i, j, s)
                if moves:
                    set_instant(instances, camera_table, instants, moving, cameras, draw_1d(sampler, TIME))
                    eye = Vec3(camera["position"][0], camera["position"][1], camera["position"][2])
                    outside = media_of_eye(scene, accelerator, media, camera, eye, stack)
                c, alpha = path_radiance(
                    scene, accelerator, lighting, media, camera, raster_from_object, background, rules, sampler, outside, moves, i, j, stack
                )
                film[j, i, 0] += c.r
                film[j, i, 1] += c.g
                film[j, i, 2] += c.b
                film[j, i, 3] += alpha


trace_path_tile_exact = trace_path_tile
"""The same, compiled for scenes with exact shapes beside spheres and planes."""

trace_path_tile_layered = trace_path_tile
"""The same, compiled for scenes with layered materials, too."""
