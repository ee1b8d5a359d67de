"""One tile of the picture, from its triangles to its pixels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..accel.walk import exact_tables
from ..film_kernel import clear_rows, encode_rows
from ..kernel.lanes import (
    ALL_LANES,
    add_rows,
    add_rows_at,
    all_of,
    any_of,
    at,
    count_set,
    first_set,
    i32x8,
    lane,
    lanes_of,
    load8,
    mask_of,
    splat8,
    store8,
    sum8,
    to_float,
    where,
)
from ..kernel.vec import ONE, ZERO, Color
from ..tables.layouts import PERSPECTIVE
from .fill import eight_pixels, eight_samples, fill_opaque, fill_transparent
from .fragment import Fragments, shade_fragments
from .layouts import SUBPIXELS
from .shadow import Shadowing

__all__ = ["draw_layered_shadowed_tile", "draw_layered_tile", "draw_shadowed_tile", "draw_tile", "farthest_depth"]

f32, i32 = np.float32, np.int32
_GRID_STEP = f32(1.0 / SUBPIXELS)
_COUNTING = np.arange(8, dtype=np.int32)
_MAX_LAYERS = 64
_SHARES = np.array([0.0, *(1.0 / n for n in range(1, 9))], dtype=np.float32)
_NOTHING = i32(-1)
_NEAREST_POSSIBLE = f32(3e38)


class Target(NamedTuple):
    """Where the sums of a tile's pixels stand: pixel (i, j) of it in row origin + j stride + i."""

    sums: np.ndarray  # (n, 4) float32
    stride: int
    origin: int


@kernel
def farthest_depth(camera) -> np.float32:
    """The depth-buffer value beyond which nothing is seen."""
    return camera["near"] / camera["far"] if camera["kind"] == PERSPECTIVE else ZERO


@kernel
def _clear(depth, seen, farthest: np.float32, n: int):
    for p in range(n):
        depth[p], seen[p] = farthest, _NOTHING


@kernel
def _add(film, place: int, r: np.float32, g: np.float32, b: np.float32, alpha: np.float32):
    film[place, 0] += r
    film[place, 1] += g
    film[place, 2] += b
    film[place, 3] += alpha


@kernel
def _leave_empty(window, background, weight: np.float32, target: Target):
    """The even background for a tile that nothing touches, with the bits of a pixel that merely sees nothing."""
    opacity = background[3]
    r, g, b = opacity * background[0] * weight, opacity * background[1] * weight, opacity * background[2] * weight
    alpha = opacity * weight
    for j in range(window[3]):
        place = target.origin + j * target.stride
        whole = window[2] - window[2] % 8
        for i in range(0, whole, 8):
            add_rows(target.sums, place + i, splat8(r), splat8(g), splat8(b), splat8(alpha))
        for i in range(whole, window[2]):
            _add(target.sums, place + i, r, g, b, alpha)


@kernel
def _list_seen(fragments: Fragments, seen, window, target: Target, ox: int, oy: int, shows_sky: bool) -> int:
    """List what one sample of every pixel sees; the sky, too, where it is shown. Returns how many fragments there are."""
    n = 0
    fx, fy = f32(ox) * _GRID_STEP, f32(oy) * _GRID_STEP
    counting = load8(_COUNTING, 0)
    for j in range(window[3]):
        y = f32(window[1] + j) + fy
        for i0 in range(0, window[2], 8):
            pixel, place = j * window[2] + i0, target.origin + j * target.stride + i0
            surface = load8(seen, pixel)
            listed = mask_of(((surface >= 0) | shows_sky) & (counting < window[2] - i0))
            if listed == 0:
                continue
            x = to_float(counting + (window[0] + i0)) + fx
            if listed == ALL_LANES:
                store8(fragments.surface, n, surface)
                store8(fragments.pixel, n, counting + pixel)
                store8(fragments.place, n, counting + place)
                store8(fragments.x, n, x)
                store8(fragments.y, n, splat8(y))
                n += 8
                continue
            while listed != 0:
                k = np.int64(first_set(listed))
                listed = listed & (listed - 1)
                fragments.surface[n], fragments.pixel[n], fragments.place[n] = lane(surface, k), pixel + k, place + k
                fragments.x[n], fragments.y[n] = lane(x, k), y
                n += 1
    return n


@kernel
def _weigh_bare(seen, n: int, weight: np.float32, bare):
    """Fill `bare`: the weight of a pixel's only sample where it sees nothing solid, else 0."""
    for p in range(0, n, 8):
        store8(bare, p, where(load8(seen, p) < 0, splat8(weight), ZERO))


@kernel
def _add_backdrop(background, bare, layers, has_blend: bool, window, target: Target):
    """Add the even background with the weights in `bare`, one of each pixel; behind the blended layers where there are some."""
    counting = load8(_COUNTING, 0)
    opacity = splat8(background[3])
    even = Color(opacity * background[0], opacity * background[1], opacity * background[2])
    for j in range(window[3]):
        for i0 in range(0, window[2], 8):
            pixel, place = j * window[2] + i0, target.origin + j * target.stride + i0
            left = window[2] - i0
            w = load8(bare, pixel)
            shown = (w != ZERO) & (counting < left)
            if not any_of(shown):
                continue
            c, alpha = even, opacity
            if has_blend:
                red, green, blue, transmittance = layers
                t = load8(transmittance, pixel)
                c = Color(load8(red, pixel), load8(green, pixel), load8(blue, pixel)) + even * t
                alpha = (ONE - t) + t * alpha
            r, g, b, alpha = where(shown, c.r * w, ZERO), where(shown, c.g * w, ZERO), where(shown, c.b * w, ZERO), alpha * w
            if left >= 8:
                add_rows(target.sums, place, r, g, b, where(shown, alpha, ZERO))
                continue
            for k in range(left):
                if lane(shown, k):
                    _add(target.sums, place + k, lane(r, k), lane(g, k), lane(b, k), lane(alpha, k))


@kernel
def _add_fragments(fragments: Fragments, n: int, layers, has_blend: bool, has_weights: bool, weight: np.float32, sums):
    """Add the shaded fragments to the film, in their order; behind the blended layers where there are some.

    Each with its own weight, or all with the same.
    """
    red, green, blue, transmittance = layers
    counting = load8(_COUNTING, 0)
    for start in range(0, n, 8):
        r, g, b = load8(fragments.r, start), load8(fragments.g, start), load8(fragments.b, start)
        # Of an opaque surface alpha is 1, whatever its texture says.
        alpha = where(load8(fragments.surface, start) >= 0, ONE, load8(fragments.alpha, start))
        if has_blend:
            p = load8(fragments.pixel, start)
            t = at(transmittance, p)
            r, g, b = at(red, p) + r * t, at(green, p) + g * t, at(blue, p) + b * t
            alpha = (ONE - t) + t * alpha
        w = load8(fragments.weight, start) if has_weights else splat8(weight)
        r, g, b, alpha = r * w, g * w, b * w, alpha * w
        place = load8(fragments.place, start)
        first = np.int64(lane(place, 0))
        if start + 8 > n:
            for k in range(n - start):
                _add(sums, np.int64(lane(place, k)), lane(r, k), lane(g, k), lane(b, k), lane(alpha, k))
        elif all_of(place == counting + first):
            add_rows(sums, first, r, g, b, alpha)
        else:
            add_rows_at(sums, place, r, g, b, alpha)


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
    screen, binned, first, last, window, ox, oy, weight, has_blend, shows_sky, camera, scene, lighting, frame, frequency, background,
    floats, ints, fragments: Fragments, words, shadowing, target: Target,
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
            count = _list_seen(fragments, next_seen, window, target, ox, oy, False)
            shade_fragments(fragments, count, words, camera, scene, lighting, frame, frequency, shadowing)
            _blend_layer(fragments, count, layers, last_depth, last_seen, next_depth, next_seen)
    count = _list_seen(fragments, seen, window, target, ox, oy, shows_sky)
    shade_fragments(fragments, count, words, camera, scene, lighting, frame, frequency, shadowing)
    _add_fragments(fragments, count, layers, has_blend != 0, False, weight, target.sums)
    if not shows_sky and (has_blend != 0 or background[3] != ZERO):
        _weigh_bare(seen, n, weight, floats[14])
        _add_backdrop(background, floats[14], layers, has_blend != 0, window, target)


@kernel
def _middle(column: i32x8, row: i32x8, covered: int):
    """(x, y) of the middle of the samples in a mask, relative to the centre of their pixel."""
    step = _GRID_STEP * _SHARES[count_set(covered)]
    x, y = sum8(where(lanes_of(covered), column, 0)), sum8(where(lanes_of(covered), row, 0))
    return f32(x) * step, f32(y) * step


@kernel
def _list_surfaces(
    fragments: Fragments, seen, places, weights, samples: int, window, target: Target, shows_sky: bool, bare
) -> int:
    """List the surfaces that the samples of each pixel see, each once, in the middle of the samples that it covers.

    `bare` becomes the weight of those of each pixel that see nothing, where no sky is shown.
    """
    n = 0
    column, row, weight = load8(places, 0), load8(places, 8), load8(weights, 0)
    taken = (1 << samples) - 1
    all_taken = lanes_of(taken)
    of_all = sum8(where(all_taken, weight, ZERO))
    middle_x, middle_y = _middle(column, row, taken)
    for j in range(window[3]):
        for i in range(window[2]):
            pixel = j * window[2] + i
            surfaces = load8(seen, 8 * pixel)
            only = lane(surfaces, 0)
            if all_of((surfaces == only) | ~all_taken):
                # Most pixels see one thing.
                is_listed = only >= 0 or shows_sky
                bare[pixel] = ZERO if is_listed else of_all
                if is_listed:
                    fragments.surface[n], fragments.pixel[n] = only, pixel
                    fragments.place[n] = target.origin + j * target.stride + i
                    fragments.x[n], fragments.y[n] = f32(window[0] + i) + middle_x, f32(window[1] + j) + middle_y
                    fragments.weight[n] = of_all
                    n += 1
                continue
            left = np.int64(mask_of((surfaces >= 0) | shows_sky)) & taken
            bare[pixel] = ZERO
            if left != taken:
                bare[pixel] = of_all if left == 0 else sum8(where(lanes_of(taken & ~left), weight, ZERO))
            while left != 0:
                surface = lane(surfaces, first_set(left))
                same = np.int64(mask_of(surfaces == surface)) & left
                left = left & ~same
                dx, dy = _middle(column, row, same)
                fragments.surface[n], fragments.pixel[n] = surface, pixel
                fragments.place[n] = target.origin + j * target.stride + i
                fragments.x[n], fragments.y[n] = f32(window[0] + i) + dx, f32(window[1] + j) + dy
                fragments.weight[n] = sum8(where(lanes_of(same), weight, ZERO))
                n += 1
    return n


@kernel
def _fetch_samples(sample_places, sample_weights, first: int, last: int, places, weights):
    """Fill places (16,) and weights (8,) with up to eight samples, the last one repeated; returns the least and the greatest place."""
    low, high = 0, 0
    for s in range(8):
        row = min(first + s, last - 1)
        places[s], places[8 + s], weights[s] = sample_places[row, 0], sample_places[row, 1], sample_weights[row]
        low = min(low, min(np.int64(places[s]), np.int64(places[8 + s])))
        high = max(high, max(np.int64(places[s]), np.int64(places[8 + s])))
    return low, high


@kernel
def _leave_group_empty(sample_places, sample_weights, first: int, last: int, window, background, floats, ints, target: Target):
    """`_leave_empty` for up to eight samples that are taken at once."""
    _fetch_samples(sample_places, sample_weights, first, last, ints[9], floats[14])
    taken = lanes_of((1 << (last - first)) - 1)
    _leave_empty(window, background, sum8(where(taken, load8(floats[14], 0), ZERO)), target)


@kernel
def _multisample(
    screen, binned, first, last, window, sample_places, sample_weights, first_sample, last_sample, shows_sky, camera, scene, lighting,
    frame, frequency,
    background, floats, ints, fragments: Fragments, words, shadowing, target: Target,
):  # fmt: skip
    """Up to eight samples of every pixel; what covers several of them is shaded once, in the middle of those it covers."""
    depth, seen, places, weights = floats[0], ints[0], ints[9], floats[14]
    n, samples = window[2] * window[3], last_sample - first_sample
    low, high = _fetch_samples(sample_places, sample_weights, first_sample, last_sample, places, weights)
    _clear(depth, seen, farthest_depth(camera), 8 * n)
    pattern = eight_samples(places, samples, low, high)
    fill_opaque(screen, binned, first, last, window, pattern, camera, scene, frame, depth, seen)
    bare = floats[10]
    count = _list_surfaces(fragments, seen, places, weights, samples, window, target, shows_sky, bare)
    shade_fragments(fragments, count, words, camera, scene, lighting, frame, frequency, shadowing)
    none = (depth, depth, depth, depth)
    _add_fragments(fragments, count, none, False, True, ONE, target.sums)
    if not shows_sky and background[3] != ZERO:
        _add_backdrop(background, bare, none, False, window, target)


@kernel
def _expose(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words, has_blend,
    multisample, frequency, sample_places, sample_weights, background, shadowing, floats, ints, table, target: Target,
    tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Add some samples of a tile to its sums."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    frame = (vertices, first_vertex, cuts)
    camera = camera_table[0]
    window = (first_column, first_row, columns, rows)
    first, last = bin_range[tile], bin_range[tile + 1]
    shows_sky = header[0]["sky_visible"] != 0
    is_empty = first == last and not shows_sky
    if is_empty and background[3] == ZERO:
        return
    fragments = Fragments(
        ints[3], ints[4], ints[5], ints[6], ints[7], ints[8], ints[10], table,
        floats[3], floats[4], floats[5], floats[6], floats[7], floats[8], floats[9],
    )  # fmt: skip
    if multisample != 0 and has_blend == 0 and last_sample - first_sample > 1:
        for start in range(first_sample, last_sample, 8):
            end = min(start + 8, last_sample)
            if is_empty:
                _leave_group_empty(sample_places, sample_weights, start, end, window, background, floats, ints, target)
                continue
            _multisample(
                screen, binned, first, last, window, sample_places, sample_weights, start, end, shows_sky,
                camera, scene,
                lighting, frame, frequency, background, floats, ints, fragments, words, shadowing, target,
            )  # fmt: skip
        return
    for s in range(first_sample, last_sample):
        if is_empty:
            _leave_empty(window, background, sample_weights[s], target)
            continue
        ox, oy = np.int64(sample_places[s, 0]), np.int64(sample_places[s, 1])
        _supersample(
            screen, binned, first, last, window, ox, oy, sample_weights[s], has_blend, shows_sky, camera, scene, lighting, frame,
            frequency, background,
            floats, ints, fragments, words, shadowing, target,
        )  # fmt: skip


@kernel
def _draw(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words, has_blend,
    multisample, width, frequency, sample_places, sample_weights, background, shadowing, floats, ints, table, film, codes, changes, encoded,
    bad, share, tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    is_encoded = encoded.shape[0] > 0
    first = first_row * width + first_column
    if is_encoded:
        clear_rows(film, 0, columns, columns, rows)
    target = Target(film, columns if is_encoded else width, 0 if is_encoded else first)
    _expose(
        instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
        header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words,
        has_blend, multisample, frequency, sample_places, sample_weights, background, shadowing, floats, ints, table, target,
        tile, first_column, first_row, columns, rows, first_sample, last_sample,
    )  # fmt: skip
    if is_encoded:
        out = (encoded.shape[0] // width - 1 - first_row) * width + first_column
        bad[tile] = encode_rows(film, 0, columns, codes, changes, encoded, out, width, share, columns, rows)


@kernel
def draw_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words, has_blend,
    multisample, width, frequency, sample_places, sample_weights, background, floats, ints, table, film, codes, changes, encoded, bad,
    share, tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Draw some samples of a tile and add them to the film (height * width, 4), premultiplied, row 0 at the bottom.

    bin_range (tiles + 1): where each tile's triangles stand in `binned`. words: `screen` as int32. sample_places (n, 2) int32: on the
    subpixel grid, and what each counts in sample_weights (n,).
    multisample: 0: every sample is shaded for itself, as it also is where there is transparency. floats (FLOAT_ROWS, k), ints
    (INT_ROWS, k): scratch memory for 1, or 8 if multisampled, samples of a tile, and 16 more. table: a power of two, more than twice the
    pairs of instance and material that k samples can show.

    encoded (height * width,) int32: where it is not empty, the tile becomes bytes at once, as `film_kernel.encode_tile` makes them with
    codes, changes, bad and share, and film (columns * rows, 4) is scratch memory, too.
    """
    _draw(
        instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
        header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words,
        has_blend, multisample, width, frequency, sample_places, sample_weights, background, None, floats, ints, table, film,
        codes, changes, encoded, bad, share, tile, first_column, first_row, columns, rows, first_sample, last_sample,
    )  # fmt: skip


@kernel
def draw_shadowed_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words, has_blend,
    multisample, width, frequency, sample_places, sample_weights, background, nodes, packs, tags, primitives, planes, media,
    tinted, has_alpha, stack, ends,
    floats, ints, table, film, codes, changes, encoded, bad, share,
    tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """As `draw_tile`, with the shadows that rays through a tree find: nodes, primitives, corners and planes are an Accelerator.

    media (n,) MEDIUM; tinted, has_alpha: as in `shadow.Shadowing`; stack (STACK_SIZE,) int32, ends (0,) float64: scratch of the walk.
    """
    accelerator = (nodes, packs, tags, primitives, planes, exact_tables(attributes, slots, ends))
    shadowing = Shadowing(accelerator, media, tinted, has_alpha, stack)
    _draw(
        instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
        header, sky, sky_cumulative, emitters, blurred, camera_table, vertices, first_vertex, screen, cuts, binned, bin_range, words,
        has_blend, multisample, width, frequency, sample_places, sample_weights, background, shadowing, floats, ints, table, film,
        codes, changes, encoded, bad, share, tile, first_column, first_row, columns, rows, first_sample, last_sample,
    )  # fmt: skip


draw_layered_tile, draw_layered_shadowed_tile = draw_tile, draw_shadowed_tile
"""The same, compiled for scenes with layered materials."""
