"""What a denoiser is told: paint, normal and depth of what each pixel shows, as means over the pixel, seen in mirrors and through holes.

A picture's noise comes from light; what a ray meets is known exactly. A few rays through every pixel tell it, through the picture's lens
and at its times, and a mirror's pixel is told what is seen in it, since that is what must stay sharp there. Glass counts as what it is:
white, where it stands.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..accel.walk import exact_tables, first_hit
from ..kernel.rng import combine, float_from_word, pixel_word
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, length, luminance, max_component, normalize, reflect
from ..shading.analytic import view_ray
from ..shading.bsdf import resolve
from ..shading.surface import flip_to_front
from ..shading.visible import direction_to_eye
from ..tables.layouts import DIELECTRIC, SHADOW_CATCHER
from ..visibility.hit import first_hit_point, hit_point, lens_hit_point
from ..visibility.spawn import off_surface
from .lens import lens_ray
from .start import set_instant

__all__ = ["feature_tile", "feature_tile_exact"]

f32, i64 = np.float32, np.int64
_INFINITY = f32(np.inf)
_SUBPIXEL = f32(1.0 / 256.0)
_MAX_SURFACES = 64
_MAX_MIRRORS = 4
_SMOOTH = f32(0.0025)  # alpha of a microfacet lobe that is as good as a mirror
# Plastic numbers: multiples of them, modulo 1, fill a square evenly
_PLASTIC_U, _PLASTIC_V = f32(0.7548777), f32(0.5698403)


@kernel
def _mirror_of(bsdf) -> Color:
    """What a surface reflects as a mirror does, if that is most of what it does; else black."""
    diffuse, facets, mirror = luminance(bsdf.diffuse), luminance(bsdf.f0), luminance(bsdf.mirror)
    if mirror > diffuse + facets:
        return bsdf.mirror
    if bsdf.roughness2 <= _SMOOTH and facets > diffuse + mirror:
        return bsdf.f0
    return Color(ZERO, ZERO, ZERO)


@kernel
def feature_tile(
    instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels,
    nodes, packs, tags, primitives, planes, camera_table, raster_from_object, instants, moving, cameras,
    places, seed, stack, ends, features,
    tile, first_column, first_row, columns, rows,
):  # fmt: skip
    """Fill a tile of features (height, width, 7): albedo, normal, one over the way to it; row 0 at the bottom.

    `places` (n, 2) int32 are the rays of every pixel, relative to its centre, in 1/256 pixel.
    """
    scene = (instances, meshes, positions, triangles, attributes, slots, materials, lights, textures, texels)
    accelerator = (nodes, packs, tags, primitives, planes, exact_tables(attributes, slots, ends))
    camera, moves = camera_table[0], cameras.shape[0] > 0
    has_lens = camera["aperture_radius"] > ZERO
    n = places.shape[0]
    share = ONE / f32(n)
    for j in range(first_row, first_row + rows):
        for i in range(first_column, first_column + columns):
            chance = pixel_word(seed, i, j)
            turn_u, turn_v = float_from_word(combine(chance, i64(0))), float_from_word(combine(chance, i64(1)))
            albedo, normal, nearness = Color(ZERO, ZERO, ZERO), Vec3(ZERO, ZERO, ZERO), ZERO
            for s in range(n):
                if moves:
                    set_instant(instances, camera_table, instants, moving, cameras, (f32(s) + turn_u) * share)
                x, y = f32(i) + f32(places[s, 0]) * _SUBPIXEL, f32(j) + f32(places[s, 1]) * _SUBPIXEL
                ray = view_ray(camera, x, y)
                if has_lens:
                    u, v = turn_u + f32(s) * _PLASTIC_U, turn_v + f32(s) * _PLASTIC_V
                    ray = lens_ray(camera, x, y, u - f32(i64(u)), v - f32(i64(v)))
                o, d, t_min, t_max = ray.o, ray.d, camera["near"], camera["far"]
                tint, way, mirrors, from_camera, untouched = Color(ONE, ONE, ONE), ZERO, 0, True, True
                for _ in range(_MAX_SURFACES):
                    hit = first_hit(accelerator, instances, o, d, t_min, t_max, not untouched, stack)
                    if hit.instance < 0:
                        break
                    way += hit.t * length(d)
                    if not from_camera:
                        point, wo = hit_point(scene, accelerator, hit, o, d), normalize(-d)
                    elif has_lens or moves:
                        point, wo = lens_hit_point(scene, accelerator, hit, ray), normalize(-d)
                    else:
                        point = first_hit_point(scene, accelerator, camera, raster_from_object, hit, x, y)
                        wo = direction_to_eye(camera, point.position)
                    material = materials[point.material]
                    point = flip_to_front(point, wo)
                    if material["kind"] == DIELECTRIC:
                        albedo, normal, nearness = albedo + tint, normal + point.ns, nearness + ONE / way
                        break
                    bsdf = resolve(material, instances[instances[hit.instance]["owner"]], point, textures, texels)
                    from_camera, t_min, t_max = False, ZERO, _INFINITY
                    if material["kind"] != SHADOW_CATCHER and bsdf.alpha <= (f32(s) + turn_v) * share:
                        o = off_surface(point, -point.n)
                        continue
                    mirror = _mirror_of(bsdf)
                    if max_component(mirror) <= ZERO or mirrors >= _MAX_MIRRORS:
                        albedo, normal, nearness = albedo + tint * bsdf.albedo, normal + bsdf.ns, nearness + ONE / way
                        break
                    tint, d = tint * mirror, reflect(-wo, bsdf.ns)
                    if dot(d, point.n) <= ZERO:
                        break
                    o, mirrors, untouched = off_surface(point, point.n), mirrors + 1, False
            row = features[j, i]
            row[0], row[1], row[2] = albedo.r * share, albedo.g * share, albedo.b * share
            row[3], row[4], row[5] = normal.x * share, normal.y * share, normal.z * share
            row[6] = nearness * share


feature_tile_exact = feature_tile
"""The same, compiled for scenes with exact shapes beside spheres and planes."""
