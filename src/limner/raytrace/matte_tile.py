"""Eight paths at a time through scenes of nothing but matte paint: the picture of `limner.raytrace.path`, bit for bit.

A path asks for little at a surface, but for much that waits: points of a sequence, square roots, divisions, each for the one before. Eight
paths ask for the same things, so eight go together: each ray meets its surface by itself (`_follow`), and what follows from that, light
asked for and a new direction, is computed for eight in vector registers (`_scatter`). Paths end at different times. Where one has, the
tile's next path takes its place, so that the eight are nearly always eight; and what it has found waits in `found`, until all paths of a
block are through and are added to the film in their order.

Eight paths stand in `state` and `words` (`limner.raytrace.eight`).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..accel.in_place import first_hit_in_place, is_blocked
from ..accel.walk import exact_tables
from ..kernel.frame import frame_from_normal, to_world
from ..kernel.lanes import any_of, f32x8, lanes_of, load8, mask_of, spread, store8, to_float, where
from ..kernel.rng import pixel_word, word
from ..kernel.sampler import SOBOL, Sampler, draw_1d, draw_2d
from ..kernel.sampler_lanes import draw_1d_of_eight, draw_2d_of_eight
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, max_component, normalize
from ..kernel.warp import pdf_hemisphere_cosine, warp_hemisphere_cosine
from ..shading.analytic import through_pinhole, view_ray
from ..shading.bsdf import resolve_matte
from ..shading.emitters_lanes import sample_emitters
from ..shading.facets import facets_at
from ..shading.lambert import eval_lambert
from ..shading.lights import ambient_level
from ..shading.sky import pdf_sky, sky_radiance
from ..shading.surface import flip_to_front
from ..tables.facets import IS_PLAIN
from ..tables.layouts import PERSPECTIVE
from ..visibility.hit import hit_point
from ..visibility.shadow import aimed
from ..visibility.spawn import pushed
from .eight import (
    AIM,
    BARYCENTRIC,
    BLOCK,
    BULGE,
    CARRIED,
    DEPTH,
    DIRECTION,
    DRAWN,
    FROM_SKY,
    INSTANCE,
    LAMPS,
    LAST,
    NEXT_COLUMN,
    NEXT_DIRECTION,
    NEXT_ORIGIN,
    NEXT_PIXEL,
    NEXT_ROW,
    NEXT_SAMPLE,
    NORMAL,
    ORIGIN,
    PAINT,
    PATH,
    PDF,
    PIXEL,
    POSITION,
    REACH,
    REACHING,
    SAMPLE,
    SHADING_NORMAL,
    THROUGHPUT,
    TOTAL,
    TRIANGLE,
)  # fmt: skip
from .lens import lens_ray
from .path import (
    DIRECTION_PLACE,
    EMITTER_PLACE,
    FIRST_LIGHT,
    LEAST_SHARE,
    MAX_SURFACES,
    PER_SURFACE,
    ROULETTE_PLACE,
    balance,
    chance_weight,
    emitters_asked,
    from_lights,
    is_asked,
    sky_asked,
)
from .rules import Rules, rules_of
from .start import LENS

__all__ = ["trace_matte_tile"]

f32, i32, i64 = np.float32, np.int32, np.int64
_HALF, _INFINITY = f32(0.5), f32(np.inf)


@kernel
def _read(state, row: int, k: int) -> Vec3:
    return Vec3(state[8 * row + k], state[8 * row + 8 + k], state[8 * row + 16 + k])


@kernel
def _write(state, row: int, k: int, x: np.float32, y: np.float32, z: np.float32) -> None:
    state[8 * row + k], state[8 * row + 8 + k], state[8 * row + 16 + k] = x, y, z


@kernel
def _load(state, row: int) -> Vec3:
    return Vec3(load8(state, 8 * row), load8(state, 8 * row + 8), load8(state, 8 * row + 16))


@kernel
def _load_color(state, row: int) -> Color:
    return Color(load8(state, 8 * row), load8(state, 8 * row + 8), load8(state, 8 * row + 16))


@kernel
def _store(state, row: int, x: f32x8, y: f32x8, z: f32x8) -> None:
    store8(state, 8 * row, x)
    store8(state, 8 * row + 8, y)
    store8(state, 8 * row + 16, z)


@kernel
def _sampler(rules: Rules, words, k: int) -> Sampler:
    return Sampler(rules.sampler, word(i64(words[8 * PIXEL + k])), i64(words[8 * SAMPLE + k]), rules.n, rules.columns)


@kernel
def _write_ray(camera, rules: Rules, words, state, k: int) -> None:
    """The ray of the path that begins k-th of the next eight."""
    sampler = Sampler(rules.sampler, word(i64(words[8 * NEXT_PIXEL + k])), i64(words[8 * NEXT_SAMPLE + k]), rules.n, rules.columns)
    dx, dy = draw_2d(sampler, 0)
    x, y = f32(words[8 * NEXT_COLUMN + k]) + dx - _HALF, f32(words[8 * NEXT_ROW + k]) + dy - _HALF
    ray = view_ray(camera, x, y)
    if camera["aperture_radius"] > ZERO:
        u, v = draw_2d(sampler, LENS)
        ray = lens_ray(camera, x, y, u, v)
    _write(state, NEXT_ORIGIN, k, ray.o.x, ray.o.y, ray.o.z)
    _write(state, NEXT_DIRECTION, k, ray.d.x, ray.d.y, ray.d.z)


@kernel
def _make_ready(camera, rules: Rules, words, state, n: int) -> None:
    """Find the rays of the n paths that begin next, whose pixels and samples stand in the words."""
    if rules.sampler != SOBOL or camera["kind"] != PERSPECTIVE or camera["aperture_radius"] > ZERO:
        for k in range(n):
            _write_ray(camera, rules, words, state, k)
        return
    pixel = load8(words, 8 * NEXT_PIXEL)
    dx, dy = draw_2d_of_eight(pixel, load8(words, 8 * NEXT_SAMPLE), pixel * i32(0))
    x, y = to_float(load8(words, 8 * NEXT_COLUMN)) + dx - _HALF, to_float(load8(words, 8 * NEXT_ROW)) + dy - _HALF
    o, d = through_pinhole(camera, x, y)
    _store(state, NEXT_ORIGIN, spread(o.x, x), spread(o.y, x), spread(o.z, x))
    _store(state, NEXT_DIRECTION, d.x, d.y, d.z)


@kernel
def _signed_pixel_word(rules: Rules, i: int, j: int) -> np.int64:
    """What lanes, which are signed, make of a pixel's word."""
    pixel = i64(pixel_word(rules.seed, i, j))
    return pixel - ((pixel >> 31) << 32)


@kernel
def _list_next(rules: Rules, words, n: int, i: int, j: int, sample: int, first_column: int, end_column: int, first_sample, last_sample):
    """Write down whose the n paths are that begin next, from a sample of pixel (i, j) on; the (i, j, sample) that comes after them."""
    pixel = _signed_pixel_word(rules, i, j)
    for place in range(n):
        words[8 * NEXT_PIXEL + place], words[8 * NEXT_SAMPLE + place] = pixel, sample
        words[8 * NEXT_COLUMN + place], words[8 * NEXT_ROW + place] = i, j
        sample += 1
        if sample == last_sample:
            sample, i = first_sample, i + 1
            if i == end_column:
                i, j = first_column, j + 1
            pixel = _signed_pixel_word(rules, i, j)
    return i, j, sample


@kernel
def _begin(words, state, k: int, path: int, place: int) -> None:
    """Let the path that stands ready in a place begin in lane k."""
    words[8 * PATH + k], words[8 * PIXEL + k] = path, words[8 * NEXT_PIXEL + place]
    words[8 * SAMPLE + k], words[8 * DEPTH + k] = words[8 * NEXT_SAMPLE + place], 0
    for row in range(3):
        state[8 * (ORIGIN + row) + k] = state[8 * (NEXT_ORIGIN + row) + place]
        state[8 * (DIRECTION + row) + k] = state[8 * (NEXT_DIRECTION + row) + place]
        state[8 * (THROUGHPUT + row) + k] = ONE
        state[8 * (TOTAL + row) + k] = ZERO


@kernel
def _end(words, state, k: int, total: Color, alpha: np.float32, found) -> None:
    path = words[8 * PATH + k]
    found[path, 0], found[path, 1], found[path, 2], found[path, 3] = total.r, total.g, total.b, alpha
    words[8 * PATH + k] = -1


@outlined
def _around(lighting, lights, background, rules: Rules, is_first: bool, d: Vec3, pdf: np.float32, throughput: Color):
    """(light, alpha) of what surrounds all things."""
    header = lighting[0][0]
    light, alpha = Color(ZERO, ZERO, ZERO), ONE
    if is_first:
        alpha = max(background[3], ONE - max_component(throughput))
        light = throughput * Color(background[0], background[1], background[2]) * background[3]
        if header["sky_visible"] != 0:
            light, alpha = light + throughput * sky_radiance(lighting, normalize(d)), ONE
        return light, alpha
    wi = normalize(d)
    weight = balance(pdf, pdf_sky(lighting, wi)) if is_asked(lighting, rules) else ONE
    return throughput * (sky_radiance(lighting, wi) * weight + ambient_level(lights)), alpha


@kernel
def _follow(
    scene, accelerator, lighting, media, camera, background, rules: Rules, places, has_others: bool, words, state, k: int, stack, found
) -> bool:  # fmt: skip
    """Follow the ray of lane k to its surface. Whether it is scattered there: if not, the path has ended."""
    instances, materials, lights = scene[0], scene[6], scene[7]
    o, d, t = _read(state, ORIGIN, k), _read(state, DIRECTION, k), _read(state, THROUGHPUT, k)
    throughput, depth = Color(t.x, t.y, t.z), i64(words[8 * DEPTH + k])
    is_first = depth == 0
    t_min, t_max = (camera["near"], camera["far"]) if is_first else (ZERO, _INFINITY)
    hit = first_hit_in_place(accelerator, instances, o, d, t_min, t_max, not is_first, stack)
    if hit.instance < 0:
        light, alpha = _around(lighting, lights, background, rules, is_first, d, state[8 * PDF + k], throughput)
        total = _read(state, TOTAL, k)
        _end(words, state, k, Color(total.x, total.y, total.z) + light, alpha, found)
        return False
    if hit.triangle >= 0 and places[hit.instance, IS_PLAIN] != 0 and not has_others:
        if depth >= rules.max_depth:
            total = _read(state, TOTAL, k)
            _end(words, state, k, Color(total.x, total.y, total.z), ONE, found)
            return False
        words[8 * INSTANCE + k], words[8 * TRIANGLE + k] = hit.instance, hit.triangle
        state[8 * BARYCENTRIC + k], state[8 * BARYCENTRIC + 8 + k] = hit.u, hit.v
        return True
    point = hit_point(scene, accelerator, hit, o, d)
    wo = normalize(-d) if is_first else -d
    material = materials[point.material]
    is_front = dot(point.n, wo) >= ZERO
    point = flip_to_front(point, wo)
    bsdf = resolve_matte(material, point)
    shines = max_component(bsdf.emission) > ZERO and (is_front or material["double_sided"] != 0)
    if shines or depth >= rules.max_depth:
        total = _read(state, TOTAL, k)
        light = Color(total.x, total.y, total.z)
        if shines:
            weight = ONE
            if not is_first:
                weight = chance_weight(scene, lighting, hit, material, point, wo, _read(state, LAST, k), state[8 * PDF + k])
            light = light + throughput * bsdf.emission * weight
            _write(state, TOTAL, k, light.r, light.g, light.b)
        if depth >= rules.max_depth:
            _end(words, state, k, light, ONE, found)
            return False
    p, n, ns, bulge, paint = point.position, point.n, point.ns, point.bulge, bsdf.diffuse
    _write(state, POSITION, k, p.x, p.y, p.z)
    _write(state, NORMAL, k, n.x, n.y, n.z)
    _write(state, SHADING_NORMAL, k, ns.x, ns.y, ns.z)
    _write(state, BULGE, k, bulge.x, bulge.y, bulge.z)
    _write(state, PAINT, k, paint.r, paint.g, paint.b)
    words[8 * TRIANGLE + k] = -1
    state[8 * REACH + k] = point.reach
    if has_others:
        sampler = _sampler(rules, words, k)
        first, dimension = FIRST_LIGHT - depth * lights.shape[0], 1 + depth * PER_SURFACE
        lamps = from_lights(scene, accelerator, media, 0, rules, sampler, first, point, bsdf, False, wo, stack)
        if lighting[0][0]["light_tree"] != 0:
            lamps = lamps + emitters_asked(scene, accelerator, lighting, media, 0, rules, sampler, dimension, point, bsdf, wo, stack)
        _write(state, LAMPS, k, lamps.r, lamps.g, lamps.b)
        sky = Color(ZERO, ZERO, ZERO)
        if is_asked(lighting, rules):
            sky = sky_asked(scene, accelerator, lighting, media, 0, rules, sampler, dimension, point, bsdf, wo, stack)
        _write(state, FROM_SKY, k, sky.r, sky.g, sky.b)
    return True


@kernel
def _find_surfaces(positions, triangles, numbers, places, words, state) -> None:
    """Look up the surfaces that `_follow` has left to be looked up together."""
    triangle = load8(words, 8 * TRIANGLE)
    is_here = (triangle >= i32(0)) & (load8(words, 8 * PATH) >= i32(0))
    if not any_of(is_here):
        return
    instance, triangle = where(is_here, load8(words, 8 * INSTANCE), i32(0)), where(is_here, triangle, i32(0))
    back = -_load(state, DIRECTION)
    wo = where(load8(words, 8 * DEPTH) == i32(0), normalize(back), back)
    u, v = load8(state, 8 * BARYCENTRIC), load8(state, 8 * BARYCENTRIC + 8)
    facets = facets_at(positions, triangles, numbers, places, instance, triangle, u, v, wo)
    p, n = where(is_here, facets.position, _load(state, POSITION)), where(is_here, facets.n, _load(state, NORMAL))
    ns, paint = where(is_here, facets.n, _load(state, SHADING_NORMAL)), where(is_here, facets.paint, _load_color(state, PAINT))
    zero = spread(ZERO, u)
    bulge = where(is_here, Vec3(zero, zero, zero), _load(state, BULGE))
    _store(state, POSITION, p.x, p.y, p.z)
    _store(state, NORMAL, n.x, n.y, n.z)
    _store(state, SHADING_NORMAL, ns.x, ns.y, ns.z)
    _store(state, BULGE, bulge.x, bulge.y, bulge.z)
    _store(state, PAINT, paint.r, paint.g, paint.b)
    store8(state, 8 * REACH, where(is_here, facets.reach, load8(state, 8 * REACH)))


@outlined
def _draw_each(rules: Rules, words, state, place: int) -> None:
    for k in range(8):
        if words[8 * PATH + k] >= 0:
            sampler, dimension = _sampler(rules, words, k), 1 + i64(words[8 * DEPTH + k]) * PER_SURFACE + place
            if place == ROULETTE_PLACE:
                state[8 * DRAWN + k] = draw_1d(sampler, dimension)
            else:
                state[8 * DRAWN + k], state[8 * DRAWN + 8 + k] = draw_2d(sampler, dimension)


@kernel
def _drawn(rules: Rules, words, state, place: int) -> tuple[f32x8, f32x8]:
    """The points that the eight draw for a decision of the surface where they are."""
    if rules.sampler != SOBOL:
        _draw_each(rules, words, state, place)
        return load8(state, 8 * DRAWN), load8(state, 8 * DRAWN + 8)
    dimension = load8(words, 8 * DEPTH) * i32(PER_SURFACE) + i32(1 + place)
    return draw_2d_of_eight(load8(words, 8 * PIXEL), load8(words, 8 * SAMPLE), dimension)


@kernel
def _lot(rules: Rules, words, state) -> f32x8:
    """The lot by which paths are ended."""
    if rules.sampler != SOBOL:
        _draw_each(rules, words, state, ROULETTE_PLACE)
        return load8(state, 8 * DRAWN)
    dimension = load8(words, 8 * DEPTH) * i32(PER_SURFACE) + i32(1 + ROULETTE_PLACE)
    return draw_1d_of_eight(load8(words, 8 * PIXEL), load8(words, 8 * SAMPLE), dimension)


@kernel
def _from_emitters(accelerator, instances, emitters, power: np.float32, rules: Rules, words, state, direct: Color, stack) -> Color:
    """Direct light, and what comes straight from shining surfaces."""
    p, n, ns = _load(state, POSITION), _load(state, NORMAL), _load(state, SHADING_NORMAL)
    u, v = _drawn(rules, words, state, EMITTER_PLACE)
    shine = sample_emitters(emitters, power, p, u, v)
    value = eval_lambert(_load_color(state, PAINT), ns, shine.wi) * shine.radiance
    wanted = (load8(words, 8 * PATH) >= i32(0)) & (shine.pdf > ZERO) & (dot(n, shine.wi) > ZERO) & (max_component(value) > ZERO)
    asked = mask_of(wanted)
    if asked == 0:
        return direct
    o = pushed(p, n, load8(state, 8 * REACH)) + _load(state, BULGE)
    aim, distance = aimed(o, p, shine.wi, shine.distance)
    # The rays' origins stand where the next rays' will.
    _store(state, ORIGIN, o.x, o.y, o.z)
    _store(state, AIM, aim.x, aim.y, aim.z)
    store8(state, 8 * REACHING, distance)
    seen = i64(0)
    for k in range(8):
        if asked >> k & 1 != 0 and not is_blocked(
            accelerator, instances, _read(state, ORIGIN, k), _read(state, AIM, k), ZERO, state[8 * REACHING + k], stack
        ):
            seen = seen | 1 << k
    weight = balance(shine.pdf, pdf_hemisphere_cosine(dot(ns, shine.wi)))
    return where(lanes_of(seen), direct + value * (weight / shine.pdf), direct)


@kernel
def _scatter(accelerator, instances, lighting, emitters, rules: Rules, has_others: bool, words, state, stack) -> int:
    """Add the light asked for from eight surfaces and send eight rays on their way; which paths end there, as bits."""
    direct = _load_color(state, PAINT) * ZERO
    if has_others:
        direct = _load_color(state, LAMPS)
    if emitters.shape[0] > 0 and lighting[0][0]["light_tree"] == 0:
        power = lighting[0][0]["emitted_power"]
        direct = _from_emitters(accelerator, instances, emitters, power, rules, words, state, direct, stack)
    if has_others:
        direct = direct + _load_color(state, FROM_SKY)
    throughput, n, ns = _load_color(state, THROUGHPUT), _load(state, NORMAL), _load(state, SHADING_NORMAL)
    total = _load_color(state, TOTAL) + throughput * direct
    _store(state, TOTAL, total.r, total.g, total.b)

    u, v = _drawn(rules, words, state, DIRECTION_PLACE)
    local = warp_hemisphere_cosine(u, v)
    pdf = pdf_hemisphere_cosine(local.z)
    wi = to_world(frame_from_normal(ns), local)
    goes_on = (pdf > ZERO) & (dot(wi, n) > ZERO)
    throughput = throughput * (_load_color(state, PAINT) * pdf) * (ONE / where(goes_on, pdf, ONE))
    weight, depth = max_component(throughput), load8(words, 8 * DEPTH)
    goes_on = goes_on & (weight > ZERO) & (depth < i32(MAX_SURFACES - 1))
    carried = where(depth == i32(0), weight, load8(state, 8 * CARRIED))
    least = carried * LEAST_SHARE
    is_weak = weight < least
    if any_of(is_weak & goes_on):
        goes_on = goes_on & ~(is_weak & (_lot(rules, words, state) * least >= weight))
        throughput = where(is_weak, throughput * (least / where(goes_on, weight, ONE)), throughput)
    p = _load(state, POSITION)
    o = pushed(p, n, load8(state, 8 * REACH))
    _store(state, ORIGIN, o.x, o.y, o.z)
    _store(state, DIRECTION, wi.x, wi.y, wi.z)
    _store(state, LAST, p.x, p.y, p.z)
    _store(state, THROUGHPUT, throughput.r, throughput.g, throughput.b)
    store8(state, 8 * PDF, pdf)
    store8(state, 8 * CARRIED, carried)
    store8(words, 8 * DEPTH, depth + i32(1))
    return i64(mask_of(~goes_on))


@kernel
def _add_block(film, found, start: int, size: int, samples: int, first_column: int, first_row: int, columns: int) -> None:
    """Add what the paths of a block have found to the film, in their order."""
    for path in range(size):
        pixel = (start + path) // samples
        i, j = first_column + pixel % columns, first_row + pixel // columns
        for channel in range(4):
            film[j, i, channel] += found[path, channel]


@kernel
def trace_matte_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    nodes, packs, tags, primitives, planes,
    header, sky, sky_cumulative, emitters, blurred, camera_table, raster_from_object,
    media, instants, moving, cameras, background, rule_numbers,
    stack, ends, numbers, places, emitter_words, words, state, found, film,
    tile, first_column, first_row, columns, rows, first_sample, last_sample,
):  # fmt: skip
    """Trace some paths for every pixel of a tile and add them to the film (height, width, 4), premultiplied, row 0 at the bottom."""
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    accelerator = (nodes, packs, tags, primitives, planes, exact_tables(attributes, slots, ends))
    lighting = (header, sky, sky_cumulative, emitters, blurred)
    camera, rules = camera_table[0], rules_of(rule_numbers)
    has_others = lights.shape[0] > 0 or header[0]["light_tree"] != 0 or is_asked(lighting, rules)
    samples = last_sample - first_sample
    paths = columns * rows * samples
    i, j, sample, end_column = first_column, first_row, first_sample, first_column + columns
    for k in range(8):
        words[8 * PATH + k] = -1
    for start in range(0, paths, BLOCK):
        size = min(BLOCK, paths - start)
        following = 0
        while True:
            under_way = 0
            for k in range(8):
                while True:
                    if words[8 * PATH + k] < 0:
                        if following == size:
                            break
                        if following % 8 == 0:
                            ready = min(8, size - following)
                            i, j, sample = _list_next(
                                rules, words, ready, i, j, sample, first_column, end_column, first_sample, last_sample
                            )
                            _make_ready(camera, rules, words, state, ready)
                        _begin(words, state, k, following, following % 8)
                        following += 1
                    meets_surface = _follow(
                        scene, accelerator, lighting, media, camera, background, rules, places, has_others, words, state, k, stack, found
                    )
                    if meets_surface:
                        under_way += 1
                        break
            if under_way == 0:
                break
            _find_surfaces(positions, triangles, numbers, places, words, state)
            ended = _scatter(accelerator, instances, lighting, emitter_words, rules, has_others, words, state, stack)
            for k in range(8):
                if ended >> k & 1 != 0 and words[8 * PATH + k] >= 0:
                    total = _read(state, TOTAL, k)
                    _end(words, state, k, Color(total.x, total.y, total.z), ONE, found)
        _add_block(film, found, start, size, samples, first_column, first_row, columns)
