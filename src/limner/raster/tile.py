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
def _blend_layer(
    screen,
    window,
    ox,
    oy,
    n,
    camera,
    scene,
    lighting,
    frame,
    frequency,
    next_depth,
    next_seen,
    last_depth,
    last_seen,
    layers,
    transmittance,
):
    """Put one layer of transparent fragments behind those already there (front to back), and remember how far it went."""
    for p in range(n):
        if next_seen[p] < 0:
            continue
        x, y = _sample_point(p, window, ox, oy)
        c, alpha = shade_fragment(screen[next_seen[p]], x, y, camera, scene, lighting, frame, frequency)
        weight = transmittance[p] * alpha
        layers[p, 0] += weight * c.r
        layers[p, 1] += weight * c.g
        layers[p, 2] += weight * c.b
        transmittance[p] *= ONE - alpha
        last_depth[p], last_seen[p] = next_depth[p], next_seen[p]


@kernel
def _add(film, i: int, j: int, c: Color, alpha: np.float32):
    film[j, i, 0] += c.r
    film[j, i, 1] += c.g
    film[j, i, 2] += c.b
    film[j, i, 3] += alpha


@kernel
def _behind(lighting, background, camera, x: np.float32, y: np.float32):
    """(radiance, alpha), premultiplied, of what lies behind everything at a raster point."""
    if lighting[0][0]["sky_visible"] != 0:
        return sky_radiance(lighting, normalize(view_ray(camera, x, y).d)), ONE
    return Color(background[0], background[1], background[2]) * background[3], background[3]


@kernel
def _leave_empty(window, background, samples: int, film):
    """A tile that nothing touches; sample by sample, so that it has the bits of a pixel that merely sees nothing."""
    if background[3] == ZERO:
        return
    c = Color(background[0], background[1], background[2]) * background[3]
    for _ in range(samples):
        for j in range(window[1], window[1] + window[3]):
            for i in range(window[0], window[0] + window[2]):
                _add(film, i, j, c, background[3])


@kernel
def _supersample(
    screen, binned, first, last, window, ox, oy, farthest, has_blend, camera, scene, lighting, frame, frequency, background, scratch, film
):
    """One sample of every pixel, shaded for itself (FoCG 8.3): opaque first, then transparent layers from the front."""
    depth, seen, last_depth, last_seen, next_depth, next_seen, layers, transmittance = scratch
    n = window[2] * window[3]
    for p in range(n):
        depth[p], seen[p] = farthest, _NOTHING
    fill_opaque(screen, binned, first, last, window, ox, oy, camera, scene, frame, depth, seen, 0)
    if has_blend != 0:
        for p in range(n):
            layers[p, 0], layers[p, 1], layers[p, 2], transmittance[p] = ZERO, ZERO, ZERO, ONE
        _clear(last_depth, last_seen, _NEAREST_POSSIBLE, n)
        for _ in range(_MAX_LAYERS):
            _clear(next_depth, next_seen, -ONE, n)
            if not fill_transparent(
                screen, binned, first, last, window, ox, oy, frame, depth, last_depth, last_seen, next_depth, next_seen
            ):
                break
            _blend_layer(
                screen, window, ox, oy, n, camera, scene, lighting, frame, frequency, next_depth, next_seen, last_depth, last_seen, layers,
                transmittance,
            )  # fmt: skip
    p = 0
    for j in range(window[1], window[1] + window[3]):
        y = f32(j) + f32(oy) * _GRID_STEP
        for i in range(window[0], window[0] + window[2]):
            x = f32(i) + f32(ox) * _GRID_STEP
            t, in_front, alpha_in_front = ONE, Color(ZERO, ZERO, ZERO), ZERO
            if has_blend != 0:
                t = transmittance[p]
                in_front, alpha_in_front = Color(layers[p, 0], layers[p, 1], layers[p, 2]), ONE - t
            if seen[p] < 0:
                c, alpha = _behind(lighting, background, camera, x, y)
            else:
                c, alpha = Color(ZERO, ZERO, ZERO), ONE
                if t > BLACK_LIMIT:
                    c, _ = shade_fragment(screen[seen[p]], x, y, camera, scene, lighting, frame, frequency)
            _add(film, i, j, in_front + c * t, alpha_in_front + t * alpha)
            p += 1


@kernel
def _multisample(
    screen, binned, first, last, window, sample_places, first_sample, last_sample, farthest, camera, scene, lighting, frame,
    frequency, background,
    depth, seen, film,
):  # fmt: skip
    """Some samples of every pixel; what covers several of them is shaded once, in the middle of those it covers."""
    n, samples = window[2] * window[3], last_sample - first_sample
    for s in range(samples):
        for p in range(n):
            depth[p], seen[s * n + p] = farthest, _NOTHING
        ox, oy = np.int64(sample_places[first_sample + s, 0]), np.int64(sample_places[first_sample + s, 1])
        fill_opaque(screen, binned, first, last, window, ox, oy, camera, scene, frame, depth, seen, s * n)
    p = 0
    for j in range(window[1], window[1] + window[3]):
        for i in range(window[0], window[0] + window[2]):
            for s in range(samples):
                surface = seen[s * n + p]
                count, ox, oy = 0, 0, 0
                for k in range(samples):
                    if seen[k * n + p] == surface:
                        if k < s:
                            count = 0
                            break  # done with the first of its samples
                        count += 1
                        ox += sample_places[first_sample + k, 0]
                        oy += sample_places[first_sample + k, 1]
                if count == 0:
                    continue
                weight = f32(count)
                x, y = f32(i) + f32(ox) * _GRID_STEP / weight, f32(j) + f32(oy) * _GRID_STEP / weight
                if surface < 0:
                    c, alpha = _behind(lighting, background, camera, x, y)
                else:
                    c, _ = shade_fragment(screen[surface], x, y, camera, scene, lighting, frame, frequency)
                    alpha = ONE
                _add(film, i, j, c * weight, alpha * weight)
                if count == samples:
                    break
            p += 1


@kernel
def draw_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, has_blend,
    multisample,
    frequency, sample_places, background, depth, seen, last_depth, last_seen, next_depth, next_seen, layers, transmittance, film,
    tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Draw some samples of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom.

    bin_range (tiles + 1): where each tile's triangles stand in `binned`. sample_places (n, 2) int32: on the subpixel grid. `seen` has
    room for `multisample` samples a pixel; 0: every sample is shaded for itself, as it also is where there is transparency.
    """
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    frame = (vertices, first_vertex, cuts)
    camera = camera_table[0]
    window = (first_column, first_row, columns, rows)
    first, last = bin_range[tile], bin_range[tile + 1]
    farthest = camera["near"] / camera["far"] if camera["kind"] == PERSPECTIVE else ZERO
    scratch = (depth, seen, last_depth, last_seen, next_depth, next_seen, layers, transmittance)
    if first == last and header[0]["sky_visible"] == 0:
        _leave_empty(window, background, last_sample - first_sample, film)
        return
    if multisample != 0 and has_blend == 0:
        _multisample(
            screen, binned, first, last, window, sample_places, first_sample, last_sample, farthest, camera, scene, lighting, frame,
            frequency, background, depth, seen, film,
        )  # fmt: skip
        return
    for s in range(first_sample, last_sample):
        ox, oy = np.int64(sample_places[s, 0]), np.int64(sample_places[s, 1])
        _supersample(
            screen,
            binned,
            first,
            last,
            window,
            ox,
            oy,
            farthest,
            has_blend,
            camera,
            scene,
            lighting,
            frame,
            frequency,
            background,
            scratch,
            film,
        )
