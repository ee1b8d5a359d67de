"""Ray tracing as the book tells it (FoCG 4; Whitted 1980): hit, shade, shadow, reflect.

A ray that meets a mirror or something half transparent goes on as another ray with less to contribute. The rays that wait stand on a
small stack, so the tree of rays needs no recursion; a ray is followed until it contributes nothing that could be seen, or has been
reflected `max_depth` times.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..accel.walk import first_hit, occluded
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, length, luminance, max_component, normalize, reflect
from ..shading.analytic import analytic_at, ray_without_view, view_ray
from ..shading.bsdf import alpha_at, resolve
from ..shading.lights import ambient_level, ambient_radiance, illuminate, lit_radiance
from ..shading.sky import ambient_from_sky, sky_radiance
from ..shading.surface import SurfacePoint, barycentrics_of_hit, flip_to_front, surface_at, to_raster
from ..shading.visible import direction_to_eye, is_analytic, visible_point
from ..tables.layouts import AMBIENT_LIGHT, DIRECTIONAL_LIGHT, SHADOW_CATCHER
from .spawn import off_surface

__all__ = ["MAX_PENDING", "first_hit_point", "hit_point", "radiance", "transmittance"]

f32 = np.float32
_INFINITY = f32(np.inf)
_LEAST_CONTRIBUTION = f32(1.0 / 1024.0)
_BEFORE_LIGHT = f32(1.0 - 1e-4)
MAX_PENDING = 32
_STEP = f32(1e-6)
_MAX_SURFACES = 256  # that one ray goes through


@kernel
def _raster_vertex(positions, mesh, row: int, raster_from_object, instance: int):
    i = mesh["position"] + row
    return to_raster(raster_from_object, instance, Vec3(positions[i, 0], positions[i, 1], positions[i, 2]))


@kernel
def first_hit_point(scene, camera, raster_from_object, hit, x: np.float32, y: np.float32) -> SurfacePoint:
    """The surface point of a camera ray's hit, from the raster point, by the function that the rasteriser calls."""
    instances, meshes, positions, triangles, _, _, _, _, _, _ = scene
    if hit.triangle < 0:
        return analytic_at(instances[hit.instance], view_ray(camera, x, y), hit.t)
    mesh = meshes[instances[hit.instance]["mesh"]]
    row = mesh["triangle"] + hit.triangle
    v0 = _raster_vertex(positions, mesh, triangles[row, 0], raster_from_object, hit.instance)
    v1 = _raster_vertex(positions, mesh, triangles[row, 1], raster_from_object, hit.instance)
    v2 = _raster_vertex(positions, mesh, triangles[row, 2], raster_from_object, hit.instance)
    return visible_point(scene, camera, hit.instance, hit.triangle, v0, v1, v2, x, y)


@kernel
def hit_point(scene, hit, o: Vec3, d: Vec3) -> SurfacePoint:
    """The surface point of any other ray's hit."""
    instances, meshes, positions, triangles, attributes, slots, _, _, _, _ = scene
    instance = instances[hit.instance]
    if is_analytic(instance):
        return analytic_at(instance, ray_without_view(o, d), hit.t)
    w = barycentrics_of_hit(hit.u, hit.v)
    return surface_at((positions, triangles, attributes, slots), instance, meshes[instance["mesh"]], hit.triangle, w)


@kernel
def transmittance(scene, accelerator, has_alpha, point: SurfacePoint, wi: Vec3, distance: np.float32, stack) -> np.float32:
    """How much of a light reaches a point: nothing through what is opaque, 1 - alpha through the rest (FoCG 4.7)."""
    instances, _, _, _, _, _, materials, _, textures, texels = scene
    o = off_surface(point, point.n) + point.bulge if dot(point.n, wi) >= ZERO else off_surface(point, -point.n)
    t_max = _INFINITY
    if distance < _INFINITY:
        # The origin has moved: aim anew, and stop short of the light, which may be a surface.
        to_light = point.position + wi * distance - o
        distance = length(to_light)
        wi, t_max = normalize(to_light), distance * _BEFORE_LIGHT
    if occluded(accelerator, instances, o, wi, ZERO, t_max, stack):
        return ZERO
    left = ONE
    if has_alpha == 0:
        return left
    for _ in range(_MAX_SURFACES):
        hit = first_hit(accelerator, instances, o, wi, ZERO, t_max, True, stack)
        if hit.instance < 0 or left <= ZERO:
            break
        point = hit_point(scene, hit, o, wi)
        left = left * (ONE - alpha_at(materials[point.material], point, textures, texels))
        t_max = t_max - hit.t
        o = off_surface(point, point.n if dot(point.n, wi) >= ZERO else -point.n)
    return left


@kernel
def _local_radiance(scene, accelerator, lighting, has_alpha, shadows, point: SurfacePoint, bsdf, wo: Vec3, stack) -> Color:
    """Emission, ambient, and every light that is not hidden (FoCG 4.5-4.7)."""
    _, _, _, _, _, _, _, lights, _, _ = scene
    total = bsdf.emission + ambient_radiance(lights, bsdf) + ambient_from_sky(lighting, bsdf, wo)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] == AMBIENT_LIGHT:
            continue
        light = illuminate(lights[k], point.position)
        from_light = lit_radiance(bsdf, wo, light)
        if max_component(from_light) > ZERO:
            if shadows != 0:
                distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
                seen = transmittance(scene, accelerator, has_alpha, point, light.wi, distance, stack)
                from_light = from_light * seen
            total = total + from_light
    return total


@kernel
def _lit_share(scene, accelerator, lighting, has_alpha, shadows, point: SurfacePoint, bsdf, wo: Vec3, stack) -> np.float32:
    """How much of the light that would fall on a white surface does fall on it: what a shadow catcher lets through."""
    lights = scene[7]
    base = luminance(ambient_level(lights) + ambient_from_sky(lighting, bsdf, wo))
    everything, arriving = base, base
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            light = illuminate(lights[k], point.position)
            from_light = luminance(lit_radiance(bsdf, wo, light))
            if from_light > ZERO:
                distance = _INFINITY if lights[k]["kind"] == DIRECTIONAL_LIGHT else light.distance
                everything = everything + from_light
                if shadows != 0:
                    from_light = from_light * transmittance(scene, accelerator, has_alpha, point, light.wi, distance, stack)
                arriving = arriving + from_light
    return arriving / everything if everything > ZERO else ONE


@kernel
def _push(pending, top: int, o: Vec3, d: Vec3, throughput: Color, reflections: int) -> int:
    """Let a ray wait, if it matters and there is room."""
    if top >= MAX_PENDING or max_component(throughput) < _LEAST_CONTRIBUTION:
        return top
    pending[top, 0], pending[top, 1], pending[top, 2] = o.x, o.y, o.z
    pending[top, 3], pending[top, 4], pending[top, 5] = d.x, d.y, d.z
    pending[top, 6], pending[top, 7], pending[top, 8] = throughput.r, throughput.g, throughput.b
    pending[top, 9] = f32(reflections)
    return top + 1


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
def radiance(
    scene, accelerator, lighting, camera, raster_from_object, background, has_alpha, shadows, max_depth, x: np.float32, y: np.float32,
    pending, stack,
):  # fmt: skip
    """(radiance, alpha) at raster point (x, y), premultiplied; `pending` (MAX_PENDING, 10) and `stack` are scratch memory."""
    instances, _, _, _, _, _, materials, _, textures, texels = scene
    total, clear, alpha_behind = Color(ZERO, ZERO, ZERO), ONE, ZERO
    ray = view_ray(camera, x, y)
    o, d, throughput, reflections = ray.o, ray.d, Color(ONE, ONE, ONE), 0
    t_min, t_max = camera["near"], camera["far"]
    straight, top = True, 0
    for _ in range(_MAX_SURFACES):
        hit = first_hit(accelerator, instances, o, d, t_min, t_max, not straight, stack)
        if hit.instance < 0:
            c, alpha = _behind(lighting, background, straight, d)
            total = total + throughput * c
            if straight:
                alpha_behind = alpha
        else:
            if straight:
                point = first_hit_point(scene, camera, raster_from_object, hit, x, y)
                wo = direction_to_eye(camera, point.position)
            else:
                point = hit_point(scene, hit, o, d)
                wo = normalize(-d)
            point = flip_to_front(point, wo)
            bsdf = resolve(materials[point.material], point, textures, texels)
            alpha = bsdf.alpha
            if materials[point.material]["kind"] == SHADOW_CATCHER:
                alpha = ONE - _lit_share(scene, accelerator, lighting, has_alpha, shadows, point, bsdf, wo, stack)
            elif bsdf.alpha > ZERO:
                local = _local_radiance(scene, accelerator, lighting, has_alpha, shadows, point, bsdf, wo, stack)
                total = total + throughput * local * bsdf.alpha
            if straight:
                clear = clear * (ONE - alpha)
            if reflections < max_depth:
                r = reflect(normalize(d), bsdf.ns)
                if dot(r, point.n) > ZERO:
                    start = off_surface(point, point.n)
                    top = _push(pending, top, start, r, throughput * bsdf.mirror * bsdf.alpha, reflections + 1)
            if alpha < ONE:
                # What lies behind comes next, so that `straight` holds until the first ray is at its end. A ray of the camera
                # keeps its origin, for what it meets is looked up by the raster point.
                throughput = throughput * (ONE - alpha)
                if straight:
                    t_min = hit.t + abs(hit.t) * _STEP
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
        reflections = int(pending[top, 9])
        t_min, t_max = ZERO, _INFINITY
    return total, (ONE - clear) + clear * alpha_behind
