"""What the stages of the pipeline know of each pixel and do not keep: who covers it, where in its triangle it lies, which mipmap level.

Coverage is asked of the screen triangles themselves, all of them, hidden or not; the rest is asked of the triangle that is seen, by the
functions that shade it.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO
from ..shading.anisotropy import probes_of_footprint, reduction_along
from ..shading.surface import barycentrics_at
from ..shading.texture import level_of_detail
from ..shading.visible import visible_point
from ..tables.layouts import ANISOTROPIC, PICTURE, RIPMAP, TRILINEAR
from .layouts import SUBPIXELS

__all__ = ["count_coverage", "describe_pixels"]

f32, i64 = np.float32, np.int64


@kernel
def _on_inner_side(xa: int, ya: int, xb: int, yb: int, x: int, y: int) -> bool:
    """Whether (x, y) lies to the left of a -> b, or on it where a left or top edge owns its points (FoCG 8.1.2)."""
    dx, dy = i64(xb) - i64(xa), i64(yb) - i64(ya)
    value = dx * (i64(y) - i64(ya)) - dy * (i64(x) - i64(xa))
    return value > 0 or (value == 0 and (dy < 0 or (dy == 0 and dx < 0)))


@kernel
def _contains(t, x: int, y: int) -> bool:
    """Whether a screen triangle covers a point of the subpixel grid."""
    if not _on_inner_side(t["x"][0], t["y"][0], t["x"][1], t["y"][1], x, y):
        return False
    if not _on_inner_side(t["x"][1], t["y"][1], t["x"][2], t["y"][2], x, y):
        return False
    return _on_inner_side(t["x"][2], t["y"][2], t["x"][0], t["y"][0], x, y)


@kernel
def count_coverage(screen, sample_places, samples, layers):
    """Fill samples and layers, (height, width) int32 of zeros, row 0 at the bottom.

    samples: one bit for each of up to 31 places (n, 2) in the pixel that some triangle covers; layers: how many triangles cover the centre.
    """
    height, width = layers.shape
    half = SUBPIXELS // 2
    for k in range(screen.shape[0]):
        t = screen[k]
        i0 = max(0, (i64(t["low"][0]) - half) // SUBPIXELS)
        i1 = min(width - 1, (i64(t["high"][0]) + half) // SUBPIXELS)
        j0 = max(0, (i64(t["low"][1]) - half) // SUBPIXELS)
        j1 = min(height - 1, (i64(t["high"][1]) + half) // SUBPIXELS)
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                x, y = i * SUBPIXELS, j * SUBPIXELS
                if _contains(t, x, y):
                    layers[j, i] += 1
                for s in range(sample_places.shape[0]):
                    if _contains(t, x + i64(sample_places[s, 0]), y + i64(sample_places[s, 1])):
                        samples[j, i] |= 1 << s


@kernel
def _mip_level(texture, footprint) -> np.float32:
    """The level in which a texture is looked up, as its filter chooses it; between two levels: a mixture of both."""
    m = texture["transform"]
    dudx, dvdx, dudy, dvdy = footprint.dudx, footprint.dvdx, footprint.dudy, footprint.dvdy
    if texture["uv_set"] == 1:
        dudx, dvdx, dudy, dvdy = footprint.du1dx, footprint.dv1dx, footprint.du1dy, footprint.dv1dy
    dudx, dvdx = m[0, 0] * dudx + m[0, 1] * dvdx, m[1, 0] * dudx + m[1, 1] * dvdx
    dudy, dvdy = m[0, 0] * dudy + m[0, 1] * dvdy, m[1, 0] * dudy + m[1, 1] * dvdy
    w, h = f32(texture["width"]), f32(texture["height"])
    level = ZERO
    if texture["filter"] == TRILINEAR:
        level = level_of_detail(texture, dudx, dvdx, dudy, dvdy)
    elif texture["filter"] == ANISOTROPIC:
        level = probes_of_footprint(dudx, dvdx, dudy, dvdy, w, h).level
    elif texture["filter"] == RIPMAP:
        level = max(reduction_along(dudx, dudy, w), reduction_along(dvdx, dvdy, h))
    return min(level, f32(texture["n_levels"] - 1))


@kernel
def describe_pixels(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    camera_table, vertices, first_vertex, faces, barycentrics, levels,
):  # fmt: skip
    """Fill barycentrics (height, width, 3) and levels (height, width) where faces (height, width, 2) has an instance and a triangle.

    What has no base colour texture keeps its level. Row 0 at the bottom.
    """
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    camera = camera_table[0]
    for j in range(faces.shape[0]):
        for i in range(faces.shape[1]):
            if faces[j, i, 0] < 0:
                continue
            instance, triangle = i64(faces[j, i, 0]), i64(faces[j, i, 1])
            row = meshes[instances[instance]["mesh"]]["triangle"] + triangle
            start = first_vertex[instance]
            i0, i1, i2 = start + triangles[row, 0], start + triangles[row, 1], start + triangles[row, 2]
            v0 = vertices[i0, 0], vertices[i0, 1], vertices[i0, 2], vertices[i0, 3]
            v1 = vertices[i1, 0], vertices[i1, 1], vertices[i1, 2], vertices[i1, 3]
            v2 = vertices[i2, 0], vertices[i2, 1], vertices[i2, 2], vertices[i2, 3]
            w = barycentrics_at(f32(i), f32(j), v0, v1, v2)
            barycentrics[j, i, 0], barycentrics[j, i, 1], barycentrics[j, i, 2] = w.b0, w.b1, w.b2
            point = visible_point(scene, camera, instance, triangle, v0, v1, v2, f32(i), f32(j))
            texture = materials[point.material]["color_texture"]
            if texture >= 0 and textures[texture]["kind"] == PICTURE:
                levels[j, i] = _mip_level(textures[texture], point.footprint)
