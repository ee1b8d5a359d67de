"""One tile of the picture, from its triangles to its pixels."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import any_of, load8
from ..kernel.vec import ONE, ZERO
from ..tables.layouts import PERSPECTIVE
from .fill import eight_pixels, eight_samples, fill_opaque, fill_transparent
from .fragment import Fragments, add_fragment, shade_fragments
from .layouts import SUBPIXELS

__all__ = ["draw_tile", "farthest_depth"]

f32, i32 = np.float32, np.int32
_GRID_STEP = f32(1.0 / SUBPIXELS)
_MAX_LAYERS = 64
_NOTHING = i32(-1)
_NEAREST_POSSIBLE = f32(3e38)


@kernel
def farthest_depth(camera) -> np.float32:
    """The depth-buffer value beyond which nothing is seen."""
    return camera["near"] / camera["far"] if camera["kind"] == PERSPECTIVE else ZERO


@kernel
def _clear(depth, seen, farthest: np.float32, n: int):
    for p in range(n):
        depth[p], seen[p] = farthest, _NOTHING


@kernel
def _add(film, i: int, j: int, r: np.float32, g: np.float32, b: np.float32, alpha: np.float32):
    film[j, i, 0] += r
    film[j, i, 1] += g
    film[j, i, 2] += b
    film[j, i, 3] += alpha


@kernel
def _leave_empty(window, background, samples: int, film):
    """A tile that nothing touches; sample by sample, so that it has the bits of a pixel that merely sees nothing."""
    if background[3] == ZERO:
        return
    r, g, b, alpha = background[0] * background[3], background[1] * background[3], background[2] * background[3], background[3]
    for _ in range(samples):
        for j in range(window[1], window[1] + window[3]):
            for i in range(window[0], window[0] + window[2]):
                _add(film, i, j, r, g, b, alpha)


@kernel
def _list_seen(fragments: Fragments, seen, window, ox: int, oy: int, shows_behind: bool) -> int:
    """List what one sample of every pixel sees. Returns how many fragments there are."""
    n = 0
    fx, fy = f32(ox) * _GRID_STEP, f32(oy) * _GRID_STEP
    for j in range(window[3]):
        start = j * window[2]
        y = f32(window[1] + j) + fy
        for i0 in range(0, window[2], 8):
            if not shows_behind and not any_of(load8(seen, start + i0) >= 0):
                continue
            for i in range(i0, min(i0 + 8, window[2])):
                surface = np.int64(seen[start + i])
                if surface >= 0 or shows_behind:
                    n = add_fragment(fragments, n, surface, start + i, f32(window[0] + i) + fx, y, ONE)
    return n


@kernel
def _blend_layer(fragments: Fragments, n: int, layers, last_depth, last_seen, next_depth, next_seen):
    """Put one layer of shaded fragments behind those already there (front to back), and remember how far it went."""
    red, green, blue, transmittance = layers
    for k in range(n):
        p, alpha = fragments.pixel[k], fragments.alpha[k]
        weight = transmittance[p] * alpha
        red[p] += weight * fragments.r[k]
        green[p] += weight * fragments.g[k]
        blue[p] += weight * fragments.b[k]
        transmittance[p] *= ONE - alpha
        last_depth[p], last_seen[p] = next_depth[p], next_seen[p]


@kernel
def _supersample(
    screen, binned, first, last, window, ox, oy, has_blend, shows_behind, camera, scene, lighting, frame, frequency, background, floats,
    ints, fragments: Fragments, film,
):  # fmt: skip
    """One sample of every pixel, shaded for itself (FoCG 8.3): opaque first, then transparent layers from the front."""
    depth, last_depth, next_depth = floats[0], floats[1], floats[2]
    layers = (floats[10], floats[11], floats[12], floats[13])
    seen, last_seen, next_seen = ints[0], ints[1], ints[2]
    n = window[2] * window[3]
    pattern = eight_pixels(ox, oy)
    _clear(depth, seen, farthest_depth(camera), n)
    fill_opaque(screen, binned, first, last, window, pattern, camera, scene, frame, depth, seen)
    if has_blend != 0:
        for p in range(n):
            layers[0][p], layers[1][p], layers[2][p], layers[3][p] = ZERO, ZERO, ZERO, ONE
        _clear(last_depth, last_seen, _NEAREST_POSSIBLE, n)
        for _ in range(_MAX_LAYERS):
            _clear(next_depth, next_seen, -ONE, n)
            if not fill_transparent(
                screen, binned, first, last, window, pattern, camera, scene, frame, depth, last_depth, last_seen, next_depth, next_seen
            ):
                break
            count = _list_seen(fragments, next_seen, window, ox, oy, False)
            shade_fragments(fragments, count, screen, camera, scene, lighting, frame, frequency, background)
            _blend_layer(fragments, count, layers, last_depth, last_seen, next_depth, next_seen)
    count = _list_seen(fragments, seen, window, ox, oy, shows_behind or has_blend != 0)
    shade_fragments(fragments, count, screen, camera, scene, lighting, frame, frequency, background)
    for k in range(count):
        p = np.int64(fragments.pixel[k])
        i, j = window[0] + p % window[2], window[1] + p // window[2]
        r, g, b, alpha = fragments.r[k], fragments.g[k], fragments.b[k], fragments.alpha[k]
        # Of an opaque surface alpha is 1, whatever its texture says.
        alpha = ONE if fragments.surface[k] >= 0 else alpha
        if has_blend != 0:
            t = layers[3][p]
            r, g, b = layers[0][p] + r * t, layers[1][p] + g * t, layers[2][p] + b * t
            alpha = (ONE - t) + t * alpha
        _add(film, i, j, r, g, b, alpha)


@kernel
def _list_surfaces(fragments: Fragments, seen, places, samples: int, window, shows_behind: bool) -> int:
    """List the surfaces that the samples of each pixel see, each once, in the middle of the samples that it covers."""
    n = 0
    for j in range(window[3]):
        for i in range(window[2]):
            pixel = j * window[2] + i
            place = 8 * pixel
            if not shows_behind and not any_of(load8(seen, place) >= 0):
                continue
            for s in range(samples):
                surface = seen[place + s]
                count, ox, oy = 0, 0, 0
                for k in range(samples):
                    if seen[place + k] == surface:
                        if k < s:
                            count = 0
                            break  # done with the first of its samples
                        count += 1
                        ox += places[k]
                        oy += places[8 + k]
                if count > 0 and (surface >= 0 or shows_behind):
                    weight = f32(count)
                    x = f32(window[0] + i) + f32(ox) * _GRID_STEP / weight
                    y = f32(window[1] + j) + f32(oy) * _GRID_STEP / weight
                    n = add_fragment(fragments, n, np.int64(surface), pixel, x, y, weight)
                if count == samples:
                    break
    return n


@kernel
def _multisample(
    screen, binned, first, last, window, sample_places, first_sample, last_sample, shows_behind, camera, scene, lighting, frame, frequency,
    background, floats, ints, fragments: Fragments, film,
):  # fmt: skip
    """Up to eight samples of every pixel; what covers several of them is shaded once, in the middle of those it covers."""
    depth, seen, places = floats[0], ints[0], ints[9]
    n, samples = window[2] * window[3], last_sample - first_sample
    low, high = 0, 0
    for s in range(8):
        row = min(first_sample + s, last_sample - 1)
        places[s], places[8 + s] = sample_places[row, 0], sample_places[row, 1]
        low = min(low, min(np.int64(places[s]), np.int64(places[8 + s])))
        high = max(high, max(np.int64(places[s]), np.int64(places[8 + s])))
    _clear(depth, seen, farthest_depth(camera), 8 * n)
    pattern = eight_samples(places, samples, low, high)
    fill_opaque(screen, binned, first, last, window, pattern, camera, scene, frame, depth, seen)
    count = _list_surfaces(fragments, seen, places, samples, window, shows_behind)
    shade_fragments(fragments, count, screen, camera, scene, lighting, frame, frequency, background)
    for k in range(count):
        p, weight = np.int64(fragments.pixel[k]), fragments.weight[k]
        i, j = window[0] + p % window[2], window[1] + p // window[2]
        alpha = ONE if fragments.surface[k] >= 0 else fragments.alpha[k]
        _add(film, i, j, fragments.r[k] * weight, fragments.g[k] * weight, fragments.b[k] * weight, alpha * weight)


@kernel
def draw_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, has_blend,
    multisample, frequency, sample_places, background, floats, ints, table, film,
    tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Draw some samples of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom.

    bin_range (tiles + 1): where each tile's triangles stand in `binned`. sample_places (n, 2) int32: on the subpixel grid.
    multisample: 0: every sample is shaded for itself, as it also is where there is transparency. floats (FLOAT_ROWS, k), ints
    (INT_ROWS, k): scratch memory for 1, or 8 if multisampled, samples of a tile, and 16 more. table: a power of two, at least 2 k.
    """
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    frame = (vertices, first_vertex, cuts)
    camera = camera_table[0]
    window = (first_column, first_row, columns, rows)
    first, last = bin_range[tile], bin_range[tile + 1]
    shows_behind = header[0]["sky_visible"] != 0 or background[3] != ZERO
    if first == last and header[0]["sky_visible"] == 0:
        _leave_empty(window, background, last_sample - first_sample, film)
        return
    fragments = Fragments(
        ints[3], ints[4], ints[5], ints[6], ints[7], ints[8], table,
        floats[3], floats[4], floats[5], floats[6], floats[7], floats[8], floats[9],
    )  # fmt: skip
    if multisample != 0 and has_blend == 0:
        for start in range(first_sample, last_sample, 8):
            _multisample(
                screen, binned, first, last, window, sample_places, start, min(start + 8, last_sample), shows_behind, camera, scene,
                lighting, frame, frequency, background, floats, ints, fragments, film,
            )  # fmt: skip
        return
    for s in range(first_sample, last_sample):
        ox, oy = np.int64(sample_places[s, 0]), np.int64(sample_places[s, 1])
        _supersample(
            screen, binned, first, last, window, ox, oy, has_blend, shows_behind, camera, scene, lighting, frame, frequency, background,
            floats, ints, fragments, film,
        )  # fmt: skip
