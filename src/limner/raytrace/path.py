"""Path tracing (FoCG 23; Kajiya, *The rendering equation*, 1986): all light, however often it was scattered.

A path starts at the eye and is scattered at every surface as the surface scatters light. At each it asks the lights directly
(next-event estimation), and what it meets by chance counts too; where both ways can find the same light, each is weighted by how likely
it was to (multiple importance sampling, balance heuristic: Veach 1997, 9.2.2).
A path that carries much less than after its first scattering is ended by lot, and those that go on are strengthened for it (Russian
roulette), which changes no mean. How much less is measured by what the first surface left, since a dark pixel's error counts as a bright
one's does; and it may be the second already, since each further surface costs as much and tells less (efficiency-optimised roulette:
Veach 1997, 10.4; Rath et al., *EARS: Efficiency-aware Russian roulette and splitting*, 2022).

Glass and water send a path one of two ways, by lot. What they focus (caustics) is found by chance alone, so only of lights that have an
area, and of the sky; unless light is taken to go straight through them (`tinted`), and then is asked for like any other.

Ambient light is a sky of one brightness that the camera does not see. A background is seen past things, in mirrors and through glass, but
lights nothing.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..accel.walk import first_hit
from ..kernel.lanes import where
from ..kernel.sampler import Sampler, draw_1d, draw_2d
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, length, luminance, max_component, normalize, reflect
from ..shading.analytic import view_ray
from ..shading.area_lights import has_area, pdf_light, sample_light
from ..shading.bsdf import eval_bsdf, resolve, seen_in_mirrors, shading_normal, tint_at
from ..shading.emitters import pdf_emitter, sample_emitter
from ..shading.frosted import meet_surface
from ..shading.glossy import scatter_in_square
from ..shading.layered import facets_alone, far_share, far_side, is_polished, one_channel, veil, without_glass
from ..shading.layers import glass_share, interface_alpha
from ..shading.lights import ambient_level
from ..shading.matte_row import only_matte
from ..shading.medium import cross_surface, filling, haze_of, passed
from ..shading.sample import is_matte, pdf_bsdf, sample_bsdf
from ..shading.sky import pdf_sky, sample_sky, sky_radiance
from ..shading.surface import SurfacePoint, flip_to_front, turned_over
from ..shading.visible import direction_to_eye
from ..tables.layouts import AMBIENT_LIGHT, DIRECTIONAL_LIGHT, SHADOW_CATCHER
from ..visibility.hit import first_hit_point, hit_point, lens_hit_point
from ..visibility.shadow import transmittance
from ..visibility.spawn import off_surface
from .lens import lens_ray
from .rules import Rules
from .start import LENS

__all__ = [
    "LEAST_SHARE", "MAX_SURFACES", "balance", "chance_weight", "emitters_asked", "from_lights", "is_asked", "path_radiance", "sky_asked",
]  # fmt: skip

f32, i64 = np.float32, np.int64
_INFINITY = f32(np.inf)
_HALF = f32(0.5)
LEAST_SHARE = f32(0.35)
MAX_SURFACES = 256
# Dimensions of the sampler: two for the pixel, then so many for every surface of a path. Lights count downwards, after lens and time.
PER_SURFACE = 7
EMITTER_PLACE, SKY_PLACE, DIRECTION_PLACE, _LOBE, _COVERAGE, _KIND, ROULETTE_PLACE = 0, 1, 2, 3, 4, 5, 6
FIRST_LIGHT = -3


@kernel
def balance(a: np.float32, b: np.float32) -> np.float32:
    """a / (a + b)"""
    both = a + b
    has_any = both > ZERO
    return where(has_any, a / where(has_any, both, ONE), ZERO)


@kernel
def from_lights(
    scene, accelerator, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, bsdf, points_only: bool,
    wo: Vec3, stack,
) -> Color:  # fmt: skip
    """Light that comes straight from the lights, one point of each; `points_only`: not from those that paths meet by chance."""
    lights, has_alpha = scene[7], 0 if only_matte(scene[6]) else rules.has_alpha
    p, n = point.position, point.n
    total = Color(ZERO, ZERO, ZERO)
    for k in range(lights.shape[0]):
        is_area = has_area(lights[k])
        if lights[k]["kind"] == AMBIENT_LIGHT or (is_area and points_only):
            continue
        u, v = _HALF, _HALF
        if is_area:
            u, v = draw_2d(sampler, first - k)
        light = sample_light(lights[k], p, u, v)
        value = eval_bsdf(bsdf, wo, light.wi) * light.irradiance
        if max_component(value) > ZERO and dot(n, light.wi) > ZERO:
            distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
            seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, light.wi, distance, stack)
            if is_area and lights[k]["visible"] != 0 and not seen.through_glass:
                value = value * balance(light.pdf, pdf_bsdf(bsdf, wo, light.wi))
            total = total + value * seen.share
    return total


@kernel
def is_asked(lighting, rules: Rules) -> bool:
    """Whether the sky is asked for light: no path that scatters as its surface does can find an even one better by asking."""
    header = lighting[0][0]
    return header["sky_present"] != 0 and (header["sky_even"] == 0 or rules.tinted != 0)


@kernel
def emitters_asked(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, dimension: int, point: SurfacePoint, bsdf, wo: Vec3,
    stack,
) -> Color:  # fmt: skip
    """Light that comes straight from shining surfaces, one sample of all."""
    u, v = draw_2d(sampler, dimension + EMITTER_PLACE)
    shine = sample_emitter(scene, accelerator[5], lighting, point.position, u, v)
    if shine.pdf > ZERO and dot(point.n, shine.wi) > ZERO:
        value = eval_bsdf(bsdf, wo, shine.wi) * shine.radiance
        if max_component(value) > ZERO:
            has_alpha = 0 if only_matte(scene[6]) else rules.has_alpha
            seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, shine.wi, shine.distance, stack)
            weight = ONE if seen.through_glass else balance(shine.pdf, pdf_bsdf(bsdf, wo, shine.wi))
            return value * (weight / shine.pdf) * seen.share
    return Color(ZERO, ZERO, ZERO)


@kernel
def sky_asked(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, dimension: int, point: SurfacePoint, bsdf, wo: Vec3,
    stack,
) -> Color:  # fmt: skip
    """Light that comes straight from the sky, one sample of it."""
    u, v = draw_2d(sampler, dimension + SKY_PLACE)
    sky = sample_sky(lighting, u, v)
    if sky.pdf > ZERO and dot(point.n, sky.wi) > ZERO:
        value = eval_bsdf(bsdf, wo, sky.wi) * sky.radiance
        if max_component(value) > ZERO:
            has_alpha = 0 if only_matte(scene[6]) else rules.has_alpha
            seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, sky.wi, _INFINITY, stack)
            weight = ONE if seen.through_glass else balance(sky.pdf, pdf_bsdf(bsdf, wo, sky.wi))
            return value * (weight / sky.pdf) * seen.share
    return Color(ZERO, ZERO, ZERO)


@kernel
def _direct(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, first: int, dimension: int, point: SurfacePoint, bsdf,
    wo: Vec3, stack,
) -> Color:  # fmt: skip
    """Light that comes straight from lights, shining surfaces and the sky, one sample of each."""
    total = from_lights(scene, accelerator, media, inside, rules, sampler, first, point, bsdf, False, wo, stack)
    if lighting[3].shape[0] > 0:
        total = total + emitters_asked(scene, accelerator, lighting, media, inside, rules, sampler, dimension, point, bsdf, wo, stack)
    if is_asked(lighting, rules):
        total = total + sky_asked(scene, accelerator, lighting, media, inside, rules, sampler, dimension, point, bsdf, wo, stack)
    return total


@outlined
def _lit_share(
    scene, accelerator, lighting, media, inside: int, rules: Rules, sampler: Sampler, first: int, point: SurfacePoint, bsdf, wo: Vec3,
    u1, v1, u2, v2, stack,
) -> np.float32:  # fmt: skip
    """How much of the light that would fall on a white surface does fall on it, by one sample of each kind of light."""
    lights, has_alpha = scene[7], rules.has_alpha
    everything, arriving = ZERO, ZERO
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            u, v = draw_2d(sampler, first - k)
            light = sample_light(lights[k], point.position, u, v)
            from_light = luminance(eval_bsdf(bsdf, wo, light.wi) * light.irradiance)
            if from_light > ZERO:
                distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
                seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, light.wi, distance, stack)
                everything = everything + from_light
                arriving = arriving + from_light * luminance(seen.share)
    shine = sample_emitter(scene, accelerator[5], lighting, point.position, u1, v1)
    if shine.pdf > ZERO:
        value = luminance(eval_bsdf(bsdf, wo, shine.wi) * shine.radiance) / shine.pdf
        if value > ZERO:
            seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, shine.wi, shine.distance, stack)
            everything = everything + value
            arriving = arriving + value * luminance(seen.share)
    sky = sample_sky(lighting, u2, v2)
    if sky.pdf > ZERO:
        value = luminance(eval_bsdf(bsdf, wo, sky.wi) * sky.radiance) / sky.pdf
        if value > ZERO:
            seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, sky.wi, _INFINITY, stack)
            everything = everything + value
            arriving = arriving + value * luminance(seen.share)
    ambient = sample_bsdf(bsdf, wo, ZERO, u2, v1)
    level = luminance(ambient_level(lights))
    if level > ZERO and ambient.pdf > ZERO:
        seen = transmittance(scene, accelerator, media, inside, rules.tinted, has_alpha, point, ambient.wi, _INFINITY, stack)
        everything = everything + level
        arriving = arriving + level * luminance(seen.share)
    return arriving / everything if everything > ZERO else ONE


@kernel
def chance_weight(scene, lighting, hit, material, point: SurfacePoint, wo: Vec3, last: Vec3, pdf: np.float32) -> np.float32:
    """The weight of a shining surface that a path met by chance, which might have been asked from `last`, too."""
    instances, lights = scene[0], scene[7]
    cos_theta = dot(point.n, wo)
    lamp = i64(instances[hit.instance]["lamp"])
    if lamp > 0:
        return balance(pdf, pdf_light(lights[lamp - 1], last, point.position, cos_theta))
    if hit.triangle < 0:
        return ONE
    to_point = point.position - last
    return balance(pdf, pdf_emitter(lighting, material, hit, last, cos_theta, dot(to_point, to_point)))


@kernel
def path_radiance(
    scene, accelerator, lighting, media, camera, raster_from_object, background, rules: Rules, sampler: Sampler, outside: int, moves: bool,
    i: int, j: int, stack,
):  # fmt: skip
    """(radiance, alpha) of one path through pixel (i, j), premultiplied; at most `max_depth` scatterings.

    `outside`: the media that the eye is in; `moves`: whether this is a time of its own.
    """
    instances, _, _, _, _, _, materials, lights, textures, texels = scene
    header = lighting[0][0]
    dx, dy = draw_2d(sampler, 0)
    x, y = f32(i) + dx - _HALF, f32(j) + dy - _HALF
    ray = view_ray(camera, x, y)
    # Only textures ask how a point moves from pixel to pixel.
    has_lens, shows_texture = camera["aperture_radius"] > ZERO, textures.shape[0] > 0
    if has_lens:
        u, v = draw_2d(sampler, LENS)
        ray = lens_ray(camera, x, y, u, v)
    o, d, t_min, t_max = ray.o, ray.d, camera["near"], camera["far"]
    total, throughput = Color(ZERO, ZERO, ZERO), Color(ONE, ONE, ONE)
    alpha, from_camera, untouched = ONE, True, True
    pdf, by_chance_only, last, scatterings, dimension, light_dimension = ZERO, True, o, 0, 1, FIRST_LIGHT
    # Whether only mirrors and glass lie between the path and the eye; whether the light it looks for now was asked for straight on; whether
    # it has only been refracted.
    as_seen, was_asked, looks_through, inside = True, False, True, i64(outside)
    # What a path carries after the first surface that scatters: what the pixel's light is in proportion to.
    carried = ONE
    for _ in range(MAX_SURFACES):
        is_first = as_seen
        hit = first_hit(accelerator, instances, o, d, t_min, t_max, not untouched, stack)
        within = filling(inside, media)
        if within > 0 or (as_seen and media[0]["attenuation"][0] > ZERO):
            left = passed(media, within, hit.t * length(d))
            total = total + throughput * haze_of(media, within) * (Color(ONE, ONE, ONE) - left)
            throughput = throughput * left
        if hit.instance < 0:
            if looks_through and (untouched or header["sky_present"] == 0):
                alpha = max(background[3], ONE - max_component(throughput))
            if untouched or (as_seen and header["sky_present"] == 0):
                total = total + throughput * Color(background[0], background[1], background[2]) * background[3]
            if untouched:
                if header["sky_visible"] != 0:
                    total, alpha = total + throughput * sky_radiance(lighting, normalize(d)), ONE
            else:
                wi = normalize(d)
                weight = ONE
                if is_asked(lighting, rules):
                    weight = ONE if by_chance_only else balance(pdf, pdf_sky(lighting, wi))
                    if was_asked:
                        weight = ZERO
                total = total + throughput * (sky_radiance(lighting, wi) * weight + ambient_level(lights))
            break
        if not from_camera or not shows_texture:
            point = hit_point(scene, accelerator, hit, o, d)
            wo = normalize(-d) if from_camera else -d
        elif has_lens or moves:
            point = lens_hit_point(scene, accelerator, hit, ray)
            wo = normalize(-d)
        else:
            point = first_hit_point(scene, accelerator, camera, raster_from_object, hit, x, y)
            wo = direction_to_eye(camera, point.position)
        material, owner = materials[point.material], instances[instances[hit.instance]["owner"]]
        is_front = dot(point.n, wo) >= ZERO
        point = flip_to_front(point, wo)
        glass = glass_share(material, point, textures, texels)
        # A surface that is part glass and part something else is the one or the other, by lot.
        if glass >= ONE or (glass > ZERO and draw_1d(sampler, dimension + _KIND) < glass):
            crossing = cross_surface(inside, media, i64(material["medium"]), is_front)
            untouched, from_camera, t_min, t_max = False, False, ZERO, _INFINITY
            if crossing.before == crossing.after:
                o, inside = off_surface(point, -point.n), crossing.inside
                dimension += PER_SURFACE
                continue
            if scatterings >= rules.max_depth:
                break
            roughness2 = interface_alpha(material, point, textures, texels)
            if roughness2 > ZERO:
                bsdf = facets_alone(resolve(material, owner, point, textures, texels))
                total = total + throughput * from_lights(
                    scene, accelerator, media, inside, rules, sampler, light_dimension, point, bsdf, True, wo, stack
                )
            light_dimension -= lights.shape[0]
            u, v = draw_2d(sampler, dimension)
            n_i, n_t = media[crossing.before]["ior"], media[crossing.after]["ior"]
            if media[crossing.before]["dispersion"] + media[crossing.after]["dispersion"] > ZERO:
                throughput = one_channel(throughput, draw_1d(sampler, dimension + _COVERAGE))
                bluer = ZERO if throughput.g > ZERO else (ONE if throughput.b > ZERO else -ONE)
                n_i = n_i + bluer * media[crossing.before]["dispersion"]
                n_t = n_t + bluer * media[crossing.after]["dispersion"]
            ns = shading_normal(material, owner, point, textures, texels)
            ways = meet_surface(material, roughness2, point.n, ns, -wo, n_i, n_t, u, v)
            both = ways.reflectance + ways.transmittance
            if draw_1d(sampler, dimension + _LOBE) * both < ways.reflectance:
                o, d, looks_through = off_surface(point, point.n), ways.reflected, False
                throughput = throughput * both
            else:
                squeeze = n_i / n_t
                tint = tint_at(material, point, textures, texels)
                o, d, inside = off_surface(point, -point.n), ways.transmitted, crossing.inside
                throughput = throughput * tint * (both * squeeze * squeeze)
                carried = carried * (squeeze * squeeze)  # given back on the way out: no reason to end a path
                was_asked = rules.tinted != 0 and not as_seen
            pdf, by_chance_only, last = ZERO, True, point.position
        else:
            bsdf = seen_in_mirrors(resolve(material, owner, point, textures, texels), point.n, wo)
            coverage = bsdf.alpha
            if material["kind"] == SHADOW_CATCHER:
                # Only the camera's own view has use for it; other light goes through.
                coverage = ZERO
                if untouched:
                    u1, v1 = draw_2d(sampler, dimension + EMITTER_PLACE)
                    u2, v2 = draw_2d(sampler, dimension + SKY_PLACE)
                    coverage = ONE - _lit_share(
                        scene, accelerator, lighting, media, inside, rules, sampler, light_dimension, point, bsdf, wo, u1, v1, u2, v2, stack
                    )
            lot = ZERO
            far = far_share(bsdf, wo)
            if coverage < ONE or far > ZERO:
                lot = draw_1d(sampler, dimension + _COVERAGE)
            if coverage < ONE and lot >= coverage:
                # Straight on: neither the direction's density nor what is owed to the lights changes.
                o, t_min, t_max, from_camera = off_surface(point, -point.n), ZERO, _INFINITY, False
                dimension += PER_SURFACE
                continue
            if far > ZERO:
                if lot >= far * coverage:
                    far = far - ONE
                elif is_polished(bsdf):
                    # As above, but for what the sheet keeps.
                    throughput = throughput * veil(bsdf, wo) * (ONE / far)
                    o, t_min, t_max, from_camera = off_surface(point, -point.n), ZERO, _INFINITY, False
                    dimension += PER_SURFACE
                    continue
            if glass > ZERO:
                bsdf = without_glass(bsdf, glass)
            if max_component(bsdf.emission) > ZERO and (is_front or material["double_sided"] != 0) and not was_asked:
                weight = ONE
                if not by_chance_only:
                    weight = chance_weight(scene, lighting, hit, material, point, wo, last, pdf)
                total = total + throughput * bsdf.emission * weight
            if scatterings >= rules.max_depth or material["kind"] == SHADOW_CATCHER:
                break
            if far != ZERO:
                throughput = throughput * (ONE / abs(far))
                if far > ZERO:
                    point, bsdf, wo = turned_over(point), far_side(bsdf), reflect(wo, bsdf.ns)
            total = total + throughput * _direct(
                scene, accelerator, lighting, media, inside, rules, sampler, light_dimension, dimension, point, bsdf, wo, stack
            )
            light_dimension -= lights.shape[0]
            u, v = draw_2d(sampler, dimension + DIRECTION_PLACE)
            scattered = sample_bsdf(bsdf, wo, ZERO if is_matte(bsdf) else draw_1d(sampler, dimension + _LOBE), u, v)
            if scattered.pdf <= ZERO or dot(scattered.wi, point.n) <= ZERO:
                break
            throughput = throughput * scattered.value * (ONE / scattered.pdf)
            pdf, by_chance_only, last = scattered.pdf, scattered.is_mirror, point.position
            o, d, t_min, t_max = off_surface(point, point.n), scattered.wi, ZERO, _INFINITY
            if scattered.is_mirror:
                if material["mirror_blur"] > ZERO:
                    d = scatter_in_square(d, point.n, material["mirror_blur"], u, v)
            else:
                as_seen, was_asked = False, False
            from_camera, untouched, looks_through = False, False, False
        scatterings += 1
        weight = max_component(throughput)
        if weight <= ZERO:
            break
        if is_first:
            carried = weight
        elif weight < LEAST_SHARE * carried:
            if draw_1d(sampler, dimension + ROULETTE_PLACE) * (LEAST_SHARE * carried) >= weight:
                break
            throughput = throughput * (LEAST_SHARE * carried / weight)
        dimension += PER_SURFACE
    return total, alpha
