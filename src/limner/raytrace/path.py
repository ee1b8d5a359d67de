"""Path tracing (FoCG 23; Kajiya, *The rendering equation*, 1986): all light, however often it was scattered.

A path starts at the eye and is scattered at every surface as the surface scatters light. At each it asks the lights directly
(next-event estimation), and what it meets by chance counts too; where both ways can find the same light, each is weighted by how likely
it was to (multiple importance sampling, balance heuristic: Veach 1997, 9.2.2). After a few surfaces a path that carries little is ended
by lot and the others are strengthened for it (Russian roulette), which changes no mean.

Ambient light is a sky of one brightness that the camera does not see.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..accel.walk import first_hit
from ..kernel.sampler import SOBOL, sample_1d, sample_2d
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, luminance, max_component, normalize
from ..shading.analytic import view_ray
from ..shading.bsdf import eval_bsdf, resolve
from ..shading.emitters import pdf_emitter, sample_emitter
from ..shading.lights import ambient_level, illuminate, lit_radiance
from ..shading.sample import pdf_bsdf, sample_bsdf
from ..shading.sky import pdf_sky, sample_sky, sky_radiance
from ..shading.surface import flip_to_front
from ..shading.visible import direction_to_eye, is_analytic
from ..tables.layouts import AMBIENT_LIGHT, DIRECTIONAL_LIGHT, SHADOW_CATCHER
from .spawn import off_surface
from .whitted import first_hit_point, hit_point, transmittance

__all__ = ["path_radiance"]

f32 = np.float32
_INFINITY = f32(np.inf)
_HALF = f32(0.5)
_FIRST_ROULETTE = 3
_LEAST_SURVIVAL = f32(0.05)
_MAX_SURFACES = 256
# Dimensions of the sampler: two for the pixel, then so many for every surface of a path.
_PER_SURFACE = 7


@kernel
def _balance(a: np.float32, b: np.float32) -> np.float32:
    """a / (a + b)"""
    return a / (a + b) if a + b > ZERO else ZERO


@kernel
def _direct(scene, accelerator, lighting, has_alpha, point, bsdf, wo: Vec3, choice, u1, v1, u2, v2, stack) -> Color:
    """Light that comes straight from lights, shining surfaces and the sky, one sample of each of the latter."""
    lights = scene[7]
    p, n = point.position, point.n
    total = Color(ZERO, ZERO, ZERO)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] == AMBIENT_LIGHT:
            continue
        light = illuminate(lights[k], p)
        value = lit_radiance(bsdf, wo, light)
        if max_component(value) > ZERO and dot(n, light.wi) > ZERO:
            distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
            total = total + value * transmittance(scene, accelerator, has_alpha, point, light.wi, distance, stack)
    shine = sample_emitter(scene, lighting, p, choice, u1, v1)
    if shine.pdf > ZERO and dot(n, shine.wi) > ZERO:
        value = eval_bsdf(bsdf, wo, shine.wi) * shine.radiance
        if max_component(value) > ZERO:
            weight = _balance(shine.pdf, pdf_bsdf(bsdf, wo, shine.wi)) / shine.pdf
            total = total + value * (weight * transmittance(scene, accelerator, has_alpha, point, shine.wi, shine.distance, stack))
    sky = sample_sky(lighting, u2, v2)
    if sky.pdf > ZERO and dot(n, sky.wi) > ZERO:
        value = eval_bsdf(bsdf, wo, sky.wi) * sky.radiance
        if max_component(value) > ZERO:
            weight = _balance(sky.pdf, pdf_bsdf(bsdf, wo, sky.wi)) / sky.pdf
            total = total + value * (weight * transmittance(scene, accelerator, has_alpha, point, sky.wi, _INFINITY, stack))
    return total


@kernel
def _lit_share(scene, accelerator, lighting, has_alpha, point, bsdf, wo: Vec3, choice, u1, v1, u2, v2, stack) -> np.float32:
    """How much of the light that would fall on a white surface does fall on it, by one sample of each kind of light."""
    lights = scene[7]
    everything, arriving = ZERO, ZERO
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            light = illuminate(lights[k], point.position)
            from_light = luminance(lit_radiance(bsdf, wo, light))
            if from_light > ZERO:
                distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
                everything = everything + from_light
                arriving = arriving + from_light * transmittance(scene, accelerator, has_alpha, point, light.wi, distance, stack)
    shine = sample_emitter(scene, lighting, point.position, choice, u1, v1)
    if shine.pdf > ZERO:
        value = luminance(eval_bsdf(bsdf, wo, shine.wi) * shine.radiance) / shine.pdf
        if value > ZERO:
            everything = everything + value
            arriving = arriving + value * transmittance(scene, accelerator, has_alpha, point, shine.wi, shine.distance, stack)
    sky = sample_sky(lighting, u2, v2)
    if sky.pdf > ZERO:
        value = luminance(eval_bsdf(bsdf, wo, sky.wi) * sky.radiance) / sky.pdf
        if value > ZERO:
            everything = everything + value
            arriving = arriving + value * transmittance(scene, accelerator, has_alpha, point, sky.wi, _INFINITY, stack)
    ambient = sample_bsdf(bsdf, wo, ZERO, u2, v1)
    level = luminance(ambient_level(lights))
    if level > ZERO and ambient.pdf > ZERO:
        everything = everything + level
        arriving = arriving + level * transmittance(scene, accelerator, has_alpha, point, ambient.wi, _INFINITY, stack)
    return arriving / everything if everything > ZERO else ONE


@kernel
def path_radiance(
    scene, accelerator, lighting, camera, raster_from_object, background, has_alpha, max_depth, seed, i: int, j: int, sample: int, stack
):
    """(radiance, alpha) of one path through pixel (i, j), premultiplied; at most `max_depth` scatterings."""
    instances, _, _, _, _, _, materials, lights, textures, texels = scene
    header = lighting[0][0]
    dx, dy = sample_2d(SOBOL, seed, i, j, sample, 0)
    x, y = f32(i) + dx - _HALF, f32(j) + dy - _HALF
    ray = view_ray(camera, x, y)
    o, d, t_min, t_max = ray.o, ray.d, camera["near"], camera["far"]
    total, throughput = Color(ZERO, ZERO, ZERO), Color(ONE, ONE, ONE)
    alpha, from_camera, untouched = ONE, True, True
    pdf, by_chance_only, last, scatterings, dimension = ZERO, True, o, 0, 1
    for _ in range(_MAX_SURFACES):
        hit = first_hit(accelerator, instances, o, d, t_min, t_max, not untouched, stack)
        if hit.instance < 0:
            if untouched:
                alpha = background[3]
                total = total + Color(background[0], background[1], background[2]) * background[3]
                if header["sky_visible"] != 0:
                    total, alpha = total + sky_radiance(lighting, normalize(d)), ONE
            else:
                wi = normalize(d)
                weight = ONE if by_chance_only else _balance(pdf, pdf_sky(lighting, wi))
                total = total + throughput * (sky_radiance(lighting, wi) * weight + ambient_level(lights))
            break
        if from_camera:
            point = first_hit_point(scene, camera, raster_from_object, hit, x, y)
            wo = direction_to_eye(camera, point.position)
        else:
            point = hit_point(scene, hit, o, d)
            wo = normalize(-d)
        material = materials[point.material]
        is_front = dot(point.n, wo) >= ZERO
        point = flip_to_front(point, wo)
        bsdf = resolve(material, point, textures, texels)
        u1, v1 = sample_2d(SOBOL, seed, i, j, sample, dimension)
        u2, v2 = sample_2d(SOBOL, seed, i, j, sample, dimension + 1)
        choice = sample_1d(SOBOL, seed, i, j, sample, dimension + 2)
        coverage = bsdf.alpha
        if material["kind"] == SHADOW_CATCHER:
            # Only the camera's own view has use for it; other light goes through.
            coverage = ZERO
            if untouched:
                coverage = ONE - _lit_share(scene, accelerator, lighting, has_alpha, point, bsdf, wo, choice, u1, v1, u2, v2, stack)
        if coverage < ONE and sample_1d(SOBOL, seed, i, j, sample, dimension + 5) >= coverage:
            # Straight on: neither the direction's density nor what is owed to the lights changes.
            o, t_min, t_max, from_camera = off_surface(point, -point.n), ZERO, _INFINITY, False
            dimension += _PER_SURFACE
            continue
        if max_component(bsdf.emission) > ZERO and (is_front or material["double_sided"] != 0):
            weight = ONE
            if not by_chance_only and not is_analytic(instances[hit.instance]):
                to_point = point.position - last
                weight = _balance(pdf, pdf_emitter(lighting, material, dot(point.n, wo), dot(to_point, to_point)))
            total = total + throughput * bsdf.emission * weight
        if scatterings >= max_depth or material["kind"] == SHADOW_CATCHER:
            break
        total = total + throughput * _direct(scene, accelerator, lighting, has_alpha, point, bsdf, wo, choice, u1, v1, u2, v2, stack)
        u, v = sample_2d(SOBOL, seed, i, j, sample, dimension + 3)
        scattered = sample_bsdf(bsdf, wo, sample_1d(SOBOL, seed, i, j, sample, dimension + 4), u, v)
        if scattered.pdf <= ZERO or dot(scattered.wi, point.n) <= ZERO:
            break
        throughput = throughput * scattered.value * (ONE / scattered.pdf)
        scatterings += 1
        if scatterings >= _FIRST_ROULETTE:
            survival = min(max(max_component(throughput), _LEAST_SURVIVAL), ONE)
            if sample_1d(SOBOL, seed, i, j, sample, dimension + 6) >= survival:
                break
            throughput = throughput * (ONE / survival)
        if max_component(throughput) <= ZERO:
            break
        pdf, by_chance_only, last = scattered.pdf, scattered.is_mirror, point.position
        o, d, t_min, t_max = off_surface(point, point.n), scattered.wi, ZERO, _INFINITY
        from_camera, untouched = False, False
        dimension += _PER_SURFACE
    return total, alpha
