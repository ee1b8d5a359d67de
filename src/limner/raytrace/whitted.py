"""Ray tracing as the book tells it (FoCG 4, 13; Whitted 1980): hit, shade, shadow, reflect, refract.

A ray that meets a mirror, glass or something half transparent goes on as other rays with less to contribute. The rays that wait stand on
a small stack, so the tree of rays needs no recursion; a ray is followed until it contributes nothing that could be seen, or has been
reflected and refracted `max_depth` times.

Distribution (FoCG 13.4) is a matter of what each of a pixel's samples sees, never of more rays at a hit: every sample is one tree, with
one point of the lens, one time, and at each hit one point of each light and one facet of what is rough. Which one, a number decides that
belongs to (seed, pixel, sample, dimension); a hit's dimensions follow from the way in the tree that leads to it.

    node 1            the camera ray's hit
    node 2k, 2k + 1   where the ray reflected at node k ends, and where the one that goes on behind it does
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..accel.walk import first_hit
from ..kernel.sampler import Sampler, draw_2d
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, length, luminance, max_component, normalize, reflect
from ..shading.analytic import view_ray
from ..shading.area_lights import has_area, pdf_light, sample_light
from ..shading.bsdf import eval_bsdf, resolve, shading_normal, tint_at
from ..shading.emitters import pdf_emitter, sample_emitter
from ..shading.frosted import meet_surface
from ..shading.glossy import eval_facets, pdf_facets, sample_facets, scatter_in_square, without_facets
from ..shading.layered import facets_alone, far_share, far_side, is_polished, veil, without_glass
from ..shading.layers import glass_share, interface_alpha
from ..shading.lights import ambient_level, ambient_radiance
from ..shading.medium import cross_surface, filling, haze_of, passed
from ..shading.sky import ambient_from_sky, sky_radiance
from ..shading.surface import SurfacePoint, flip_to_front, turned_over
from ..shading.visible import direction_to_eye
from ..tables.layouts import AMBIENT_LIGHT, DIRECTIONAL_LIGHT, METALLIC_ROUGHNESS, SHADOW_CATCHER
from ..visibility.hit import first_hit_point, hit_point, lens_hit_point
from ..visibility.shadow import transmittance
from ..visibility.spawn import off_surface
from .lens import lens_ray
from .rules import Rules
from .start import LENS

__all__ = ["MAX_PENDING", "PENDING_NUMBERS", "PENDING_WORDS", "radiance"]

f32, i64 = np.float32, np.int64
_INFINITY = f32(np.inf)
_HALF = f32(0.5)
_LEAST_CONTRIBUTION = f32(1.0 / 1024.0)
_STEP = f32(1e-6)
_MAX_SURFACES = 256  # that one ray goes through
_NODES = i64(0x3FFFFFFF)

MAX_PENDING = 64
"""Rays of one tree that wait."""

PENDING_NUMBERS, PENDING_WORDS = 10, 4
"""What a waiting ray is: origin, direction, throughput, density as float32; reflections, media, node and whether it
looks through (only been refracted since the eye) as int64."""

# Decisions at a hit, after one for each light
_WHERE_ON_EMITTER, _WHICH_FACET, _DECISIONS = 0, 1, 2


@kernel
def _balance(a: np.float32, b: np.float32) -> np.float32:
    """a / (a + b): the balance heuristic (Veach 1997, 9.2.2)."""
    return a / (a + b) if a + b > ZERO else ZERO


@kernel
def _is_seen_by_facets(bsdf, wo: Vec3, wi: Vec3, pdf: np.float32) -> Color:
    """What a light must not count twice: what rays reflected by microfacets find of it."""
    density = pdf_facets(bsdf, wo, wi)
    return eval_facets(bsdf, wo, wi) * _balance(density, pdf)


@kernel
def _with_lights(
    total: Color, scene, accelerator, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, bsdf,
    glossy: bool, points_only: bool, wo: Vec3, stack,
) -> Color:  # fmt: skip
    """Radiance and that of every light that is not hidden (FoCG 4.5-4.7, 13.4.2).

    `first` is the dimension of the first light. `glossy`: rays reflected by microfacets will look for areas, too; `points_only`: leave
    areas to other rays altogether.
    """
    lights = scene[7]
    for k in range(lights.shape[0]):
        is_area = has_area(lights[k])
        if lights[k]["kind"] == AMBIENT_LIGHT or (is_area and points_only):
            continue
        u, v = _HALF, _HALF
        if is_area:
            u, v = draw_2d(sampler, first + k)
        light = sample_light(lights[k], point.position, u, v)
        value = eval_bsdf(bsdf, wo, light.wi)
        if glossy and is_area and lights[k]["visible"] != 0 and light.pdf > ZERO:
            value = value - _is_seen_by_facets(bsdf, wo, light.wi, light.pdf)
        from_light = value * light.irradiance
        if max_component(from_light) > ZERO:
            if rules.shadows != 0:
                distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
                seen = transmittance(
                    scene, accelerator, media, inside, rules.tinted, rules.has_alpha, point, light.wi, distance, stack
                )
                from_light = from_light * seen.share
            total = total + from_light
    return total


@outlined
def _emitters_radiance(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, bsdf, glossy: bool,
    wo: Vec3, stack,
) -> Color:  # fmt: skip
    """Light from one point of all surfaces that shine."""
    u, v = draw_2d(sampler, first + _WHERE_ON_EMITTER)
    shine = sample_emitter(scene, accelerator[5], lighting, point.position, u, v)
    if shine.pdf <= ZERO:
        return Color(ZERO, ZERO, ZERO)
    value = eval_bsdf(bsdf, wo, shine.wi)
    if glossy:
        value = value - _is_seen_by_facets(bsdf, wo, shine.wi, shine.pdf)
    value = value * shine.radiance * (ONE / shine.pdf)
    if rules.shadows != 0 and max_component(value) > ZERO:
        seen = transmittance(scene, accelerator, media, inside, rules.tinted, rules.has_alpha, point, shine.wi, shine.distance, stack)
        value = value * seen.share
    return value


@kernel
def _local_radiance(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, bsdf, shown: Color,
    glossy: bool, wo: Vec3, stack,
) -> Color:  # fmt: skip
    """What is shown anyway, ambient light, the sky, every light and what shines."""
    lights = scene[7]
    spread = bsdf
    if glossy:
        spread = without_facets(bsdf)
    total = shown + ambient_radiance(lights, spread) + ambient_from_sky(lighting, spread, wo)
    total = _with_lights(
        total, scene, accelerator, media, inside, rules, sampler, first, point, bsdf, glossy, False, wo, stack
    )
    if rules.emitters != 0:
        total = total + _emitters_radiance(
            scene, accelerator, lighting, media, inside, rules, sampler, first + lights.shape[0], point, bsdf, glossy, wo, stack
        )
    return total


@outlined
def _lit_share(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, bsdf, wo: Vec3, stack
) -> np.float32:
    """How much of the light that would fall on a white surface does fall on it: what a shadow catcher lets through."""
    lights = scene[7]
    base = luminance(ambient_level(lights) + ambient_from_sky(lighting, bsdf, wo))
    everything, arriving = base, base
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            u, v = draw_2d(sampler, first + k)
            light = sample_light(lights[k], point.position, u, v)
            from_light = luminance(eval_bsdf(bsdf, wo, light.wi) * light.irradiance)
            if from_light > ZERO:
                distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
                everything = everything + from_light
                if rules.shadows != 0:
                    seen = transmittance(
                        scene, accelerator, media, inside, rules.tinted, rules.has_alpha, point, light.wi, distance, stack
                    )
                    from_light = from_light * luminance(seen.share)
                arriving = arriving + from_light
    return arriving / everything if everything > ZERO else ONE


@kernel
def _far_radiance(
    scene, accelerator, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, far, layers, wo: Vec3, stack
) -> Color:
    """Light from the far side of a surface that lets it through, both turned over; of what shines there, only lights."""
    nothing = Color(ZERO, ZERO, ZERO)
    if layers is None:
        return nothing
    return _with_lights(nothing, scene, accelerator, media, inside, rules, sampler, first, point, far, False, False, wo, stack)


@kernel
def _push(
    pending, waiting, top: int, o: Vec3, d: Vec3, throughput: Color, pdf: np.float32, reflections: int, inside: int, node: int,
    looks_through: int,
) -> int:  # fmt: skip
    """Let a ray wait, if it matters and there is room."""
    if top >= MAX_PENDING or max_component(throughput) < _LEAST_CONTRIBUTION:
        return top
    pending[top, 0], pending[top, 1], pending[top, 2] = o.x, o.y, o.z
    pending[top, 3], pending[top, 4], pending[top, 5] = d.x, d.y, d.z
    pending[top, 6], pending[top, 7], pending[top, 8] = throughput.r, throughput.g, throughput.b
    pending[top, 9] = pdf
    waiting[top, 0], waiting[top, 1], waiting[top, 2], waiting[top, 3] = reflections, inside, node, looks_through
    return top + 1


@outlined
def _push_both(
    pending, waiting, top: int, media, material, roughness2: np.float32, tint: Color, sampler: Sampler, first: int, point: SurfacePoint,
    ns: Vec3, d: Vec3, throughput: Color, crossing, reflections: int, inside: int, node: int, looks_through: int,
) -> int:  # fmt: skip
    """Let the rays wait that leave the surface of a dielectric: the reflected one, and the refracted one."""
    u, v = _HALF, _HALF
    if roughness2 > ZERO:
        u, v = draw_2d(sampler, first + _WHICH_FACET)
    n_i, n_t = media[crossing.before]["ior"], media[crossing.after]["ior"]
    ways = meet_surface(material, roughness2, point.n, ns, normalize(d), n_i, n_t, u, v)
    squeeze = n_i / n_t
    above, below = off_surface(point, point.n), off_surface(point, -point.n)
    top = _push(
        pending, waiting, top, above, ways.reflected, throughput * ways.reflectance, ZERO, reflections + 1, inside, (2 * node) & _NODES,
        0,
    )  # fmt: skip
    through = throughput * tint * (ways.transmittance * squeeze * squeeze)
    return _push(
        pending, waiting, top, below, ways.transmitted, through, ZERO, reflections + 1, crossing.inside, (2 * node + 1) & _NODES,
        looks_through,
    )  # fmt: skip


@kernel
def _behind(lighting, background, straight: bool, d: Vec3):
    """(radiance, alpha) of what a ray meets that meets nothing: the sky, or else the background.

    A sky that the camera is not to see is still seen by what mirrors it.
    """
    header = lighting[0][0]
    if header["sky_visible"] != 0 or (header["sky_present"] != 0 and not straight):
        return sky_radiance(lighting, normalize(d)), ONE
    return Color(background[0], background[1], background[2]) * background[3], background[3]


@kernel
def _shown(scene, lighting, rules: Rules, hit, material, point: SurfacePoint, bsdf, is_front: bool, pdf: np.float32, o: Vec3, wo) -> Color:
    """What a surface itself gives off: of what lights ask for themselves, a ray reflected by microfacets from o counts its share."""
    instances, lights = scene[0], scene[7]
    lamp = np.int64(instances[hit.instance]["lamp"])
    if lamp > 0:
        if not is_front:
            return Color(ZERO, ZERO, ZERO)
        if pdf > ZERO:
            return bsdf.emission * _balance(pdf, pdf_light(lights[lamp - 1], o, point.position, dot(point.n, wo)))
        return bsdf.emission
    if pdf > ZERO and rules.emitters != 0 and hit.triangle >= 0:
        to_point = point.position - o
        density = pdf_emitter(lighting, material, hit, o, dot(point.n, wo), dot(to_point, to_point))
        return bsdf.emission * _balance(pdf, density)
    return bsdf.emission


@kernel
def radiance(
    scene, accelerator, lighting, media, camera, raster_from_object, background, rules: Rules, sampler: Sampler, outside: int, moves: bool,
    x: np.float32, y: np.float32, pending, waiting, stack,
):  # fmt: skip
    """(radiance, alpha) at raster point (x, y), premultiplied.

    `outside`: the media that the eye is in; `moves`: whether this is a time of its own. `pending` (MAX_PENDING, PENDING_NUMBERS) float32,
    `waiting` (MAX_PENDING, PENDING_WORDS) int64 and `stack` are scratch memory.
    """
    instances, _, _, _, _, _, materials, lights, textures, texels = scene
    total, clear, alpha_behind = Color(ZERO, ZERO, ZERO), ONE, ZERO
    ray = view_ray(camera, x, y)
    has_lens = camera["aperture_radius"] > ZERO
    if has_lens:
        u, v = draw_2d(sampler, LENS)
        ray = lens_ray(camera, x, y, u, v)
    by_raster = not has_lens and not moves
    o, d, throughput, reflections = ray.o, ray.d, Color(ONE, ONE, ONE), 0
    t_min, t_max, t_done = camera["near"], camera["far"], ZERO
    inside, node, pdf = i64(outside), i64(1), ZERO
    straight, looks_through, seen_through, top = True, 1, ZERO, 0
    per_node = lights.shape[0] + _DECISIONS
    for _ in range(_MAX_SURFACES):
        hit = first_hit(accelerator, instances, o, d, t_min, t_max, not straight, stack)
        within, left = filling(inside, media), Color(ONE, ONE, ONE)
        if within > 0 or media[0]["attenuation"][0] > ZERO:
            left = passed(media, within, (hit.t - t_done) * length(d))
            total = total + throughput * haze_of(media, within) * (Color(ONE, ONE, ONE) - left)
            throughput = throughput * left
        if hit.instance < 0:
            c, alpha = _behind(lighting, background, straight, d)
            if pdf > ZERO:
                c = c + ambient_level(lights)
            total = total + throughput * c
            if straight:
                alpha_behind = max(alpha, ONE - max_component(left))
            elif looks_through != 0:
                seen_through = seen_through + max_component(throughput) * (ONE - alpha)
        else:
            if not straight:
                point = hit_point(scene, accelerator, hit, o, d)
                wo = normalize(-d)
            elif by_raster:
                point = first_hit_point(scene, accelerator, camera, raster_from_object, hit, x, y)
                wo = direction_to_eye(camera, point.position)
            else:
                point = lens_hit_point(scene, accelerator, hit, ray)
                wo = normalize(-d)
            is_front = dot(point.n, wo) >= ZERO
            point = flip_to_front(point, wo)
            material, owner = materials[point.material], instances[instances[hit.instance]["owner"]]
            first = node * per_node
            glass = glass_share(material, point, textures, texels)
            if glass > ZERO:
                crossing = cross_surface(inside, media, i64(material["medium"]), is_front)
                if straight:
                    clear = ZERO
                straight, pdf = False, ZERO
                if crossing.before == crossing.after:
                    node = (2 * node + 1) & _NODES
                    o, inside, t_min, t_max, t_done = off_surface(point, -point.n), crossing.inside, ZERO, _INFINITY, ZERO
                    continue
                roughness2 = interface_alpha(material, point, textures, texels)
                whole = throughput
                throughput = throughput * glass
                if roughness2 > ZERO:
                    bsdf = facets_alone(resolve(material, owner, point, textures, texels))
                    local = Color(ZERO, ZERO, ZERO)
                    total = total + throughput * _with_lights(
                        local, scene, accelerator, media, inside, rules, sampler, first, point, bsdf, False, True, wo, stack
                    )
                if reflections < rules.max_depth:
                    tint = tint_at(material, point, textures, texels)
                    ns = shading_normal(material, owner, point, textures, texels)
                    top = _push_both(
                        pending, waiting, top, media, material, roughness2, tint, sampler, first + lights.shape[0], point, ns, d,
                        throughput, crossing, reflections, inside, node, looks_through,
                    )  # fmt: skip
                throughput = whole * (ONE - glass)
            if glass < ONE:
                bsdf = resolve(material, owner, point, textures, texels)
                if glass > ZERO:
                    bsdf = without_glass(bsdf, glass)
                alpha = bsdf.alpha
                goes_on = reflections < rules.max_depth
                glossy = rules.glossy != 0 and goes_on and material["kind"] == METALLIC_ROUGHNESS and max_component(bsdf.f0) > ZERO
                if material["kind"] == SHADOW_CATCHER:
                    alpha = ONE - _lit_share(
                        scene, accelerator, lighting, media, inside, rules, sampler, first, point, bsdf, wo, stack
                    )
                elif bsdf.alpha > ZERO:
                    shown = _shown(scene, lighting, rules, hit, material, point, bsdf, is_front, pdf, o, wo)
                    local = _local_radiance(
                        scene, accelerator, lighting, media, inside, rules, sampler, first, point, bsdf, shown, glossy, wo, stack
                    )
                    total = total + throughput * local * bsdf.alpha
                passing = Color(ONE - alpha, ONE - alpha, ONE - alpha)
                if far_share(bsdf, wo) > ZERO:
                    far, over, towards = far_side(bsdf), turned_over(point), reflect(wo, bsdf.ns)
                    total = total + throughput * alpha * _far_radiance(
                        scene, accelerator, media, inside, rules, sampler, first, over, far, far.layers, towards, stack
                    )
                    if is_polished(bsdf):
                        passing = passing + veil(bsdf, wo) * alpha
                    elif goes_on and max_component(far.f0) > ZERO:
                        u, v = draw_2d(sampler, first + lights.shape[0] + _WHICH_FACET)
                        facet = sample_facets(far, towards, u, v)
                        if facet.pdf > ZERO and dot(facet.wi, over.n) > ZERO:
                            top = _push(
                                pending, waiting, top, off_surface(over, over.n), facet.wi, throughput * facet.weight * alpha, ZERO,
                                reflections + 1, inside, (2 * node + 1) & _NODES, 0,
                            )  # fmt: skip
                if straight:
                    clear = clear * max_component(passing)
                if goes_on and max_component(bsdf.mirror) > ZERO:
                    r = reflect(normalize(d), bsdf.ns)
                    if dot(r, point.n) > ZERO:
                        if material["mirror_blur"] > ZERO:
                            u, v = draw_2d(sampler, first + lights.shape[0] + _WHICH_FACET)
                            r = scatter_in_square(r, point.n, material["mirror_blur"], u, v)
                        top = _push(
                            pending, waiting, top, off_surface(point, point.n), r, throughput * bsdf.mirror * bsdf.alpha, ZERO,
                            reflections + 1, inside, (2 * node) & _NODES, 0,
                        )  # fmt: skip
                if glossy:
                    u, v = draw_2d(sampler, first + lights.shape[0] + _WHICH_FACET)
                    facet = sample_facets(bsdf, wo, u, v)
                    if facet.pdf > ZERO and dot(facet.wi, point.n) > ZERO:
                        top = _push(
                            pending, waiting, top, off_surface(point, point.n), facet.wi, throughput * facet.weight * bsdf.alpha, facet.pdf,
                            reflections + 1, inside, (2 * node) & _NODES, 0,
                        )  # fmt: skip
                if max_component(passing) > ZERO:
                    # What lies behind comes next, so that `straight` holds until the first ray is at its end. A ray of the camera
                    # keeps its origin, for what it meets is looked up by the raster point.
                    throughput = throughput * passing
                    node = (2 * node + 1) & _NODES
                    if straight:
                        t_min, t_done = hit.t + abs(hit.t) * _STEP, hit.t
                    else:
                        o, t_max = off_surface(point, -point.n), t_max - hit.t
                    continue
        straight = False
        if top == 0:
            break
        top -= 1
        o = Vec3(pending[top, 0], pending[top, 1], pending[top, 2])
        d = Vec3(pending[top, 3], pending[top, 4], pending[top, 5])
        throughput = Color(pending[top, 6], pending[top, 7], pending[top, 8])
        pdf, reflections, inside = pending[top, 9], waiting[top, 0], waiting[top, 1]
        node, looks_through = waiting[top, 2], waiting[top, 3]
        t_min, t_max, t_done = ZERO, _INFINITY, ZERO
    return total, max((ONE - clear) + clear * alpha_behind - seen_through, ZERO)
