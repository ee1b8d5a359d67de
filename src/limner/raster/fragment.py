"""The fragment stage: the colour of what samples see, by the shading functions that all renderers share.

Eight fragments of one material on one instance are shaded at once, wherever in the tile they lie: what a material or an instance decides
is decided once for all eight, and no lane waits for another that does something else. So the fragments of a tile are listed first, and
sorted by what they show (Seiler et al., *Larrabee: a many-core x86 architecture for visual computing*, 2008, shade in such groups, too).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.lanes import all_of, at, f32x8, i32x8, lane, load8, max, min, put, splat8, splat8_int, spread, store8, where
from ..kernel.vec import ONE, ZERO, Color, luminance, normalize, reflect
from ..shading.analytic import view_ray
from ..shading.bsdf import resolve
from ..shading.layered import far_side, veil
from ..shading.lights import ambient_radiance, illuminate, lit_radiance
from ..shading.sky import ambient_from_sky, sky_radiance
from ..shading.surface import Barycentrics, SurfacePoint, barycentrics_at, flip_to_front, surface_at, with_normal
from ..shading.visible import direction_to_eye, visible_point
from ..tables.layouts import AMBIENT_LIGHT, BEHIND, SHADOW_CATCHER, SHEET, VOLUME
from .layouts import INSTANCE_WORD, MATERIAL_WORD, PER_TRIANGLE, PER_VERTEX, TRIANGLE_WORD
from .shadow import lit_share, seen_light

__all__ = ["Fragments", "shade_fragments"]

f32, i32 = np.float32, np.int32
_LEAST_ALPHA = f32(1.0 / 64.0)
_THIRD = f32(1.0 / 3.0)
_COUNTING = np.arange(8, dtype=np.int32)


class Fragments(NamedTuple):
    """What is to be shaded, in the order of the pixels, and what came of it: arrays with room for 16 more than there can be."""

    surface: np.ndarray  # int32: row of the screen triangle; -1: what lies behind everything
    triangle: np.ndarray  # int32: of the instance's mesh
    pixel: np.ndarray  # int32: place in the tile
    place: np.ndarray  # int32: row of the film
    group: np.ndarray  # int32: which of the groups it belongs to
    order: np.ndarray  # int32: the fragments, group by group
    first: np.ndarray  # int32: of each group, its first fragment in `order`; one more at the end
    table: np.ndarray  # int32: the groups, hashed; a power of two
    x: np.ndarray  # float32: raster coordinates
    y: np.ndarray
    weight: np.ndarray  # float32: how many samples it stands for
    r: np.ndarray  # float32: its radiance
    g: np.ndarray
    b: np.ndarray
    alpha: np.ndarray


# --- groups ---------------------------------------------------------------------------------------------------------------


@kernel
def _shown(screen, surface: int):
    """(instance, material) of what a fragment shows, or eight do; -2 for what lies behind everything."""
    held = max(surface, 0)
    instance = where(surface < 0, -2, at(screen, (held, INSTANCE_WORD)))
    return instance, where(surface < 0, -2, at(screen, (held, MATERIAL_WORD)))


@kernel
def _find_group(fragments: Fragments, screen, instance: int, material: int, n_groups: int) -> int:
    """The group of an instance and a material among those in the table, or the next one, n_groups, and then it is entered."""
    mask = fragments.table.shape[0] - 1
    place = ((instance * 73856093) ^ (material * 19349663)) & mask
    while fragments.table[place] >= 0:
        group = np.int64(fragments.table[place])
        of_instance, of_material = _shown(screen, np.int64(fragments.surface[fragments.first[group]]))
        if of_instance == instance and of_material == material:
            return group
        place = (place + 1) & mask
    fragments.table[place] = n_groups
    return n_groups


@kernel
def _number_groups(fragments: Fragments, n: int, screen) -> int:
    """Give each fragment its triangle and the number of its group, in the order in which groups appear. Returns how many there are.

    `first` holds the first fragment of each.
    """
    n_groups, last_group, last_surface = 0, 0, -3
    last_instance, last_material = -3, -3
    for start in range(0, n, 8):
        surface = load8(fragments.surface, start)
        if all_of(surface == last_surface):
            store8(fragments.triangle, start, splat8_int(fragments.triangle[start - 1]))
            store8(fragments.group, start, splat8_int(last_group))
            continue
        last_surface = np.int64(lane(surface, 7))
        instances, materials = _shown(screen, surface)
        store8(fragments.triangle, start, at(screen, (max(surface, 0), TRIANGLE_WORD)))
        store8(fragments.group, start, splat8_int(last_group))
        if all_of((instances == last_instance) & (materials == last_material)):
            continue
        for k in range(start, min(start + 8, n)):
            instance, material = np.int64(lane(instances, k - start)), np.int64(lane(materials, k - start))
            if instance != last_instance or material != last_material:
                if n_groups == 1:
                    for place in range(fragments.table.shape[0]):
                        fragments.table[place] = -1
                    _find_group(fragments, screen, last_instance, last_material, 0)
                last_instance, last_material = instance, material
                last_group = _find_group(fragments, screen, instance, material, n_groups) if n_groups > 0 else 0
                if last_group == n_groups:
                    fragments.first[n_groups] = k
                    n_groups += 1
            fragments.group[k] = last_group
    return n_groups


@kernel
def _sort_groups(fragments: Fragments, n: int, n_groups: int):
    """Fill `order` and `first`: a counting sort, which keeps the order within a group."""
    first, order = fragments.first, fragments.order
    for group in range(n_groups + 1):
        first[group] = 0
    for k in range(n):
        first[fragments.group[k] + 1] += 1
    for group in range(n_groups):
        first[group + 1] += first[group]
    for k in range(n):
        group = fragments.group[k]
        order[first[group]] = k
        first[group] += 1
    for group in range(n_groups, 0, -1):
        first[group] = first[group - 1]
    first[0] = 0


# --- shading --------------------------------------------------------------------------------------------------------------


@kernel
def _let_through(radiance: Color, bsdf, layers, wo, lights, point: SurfacePoint):
    """(radiance, alpha) with what shines through from behind, and as thin as it is clear."""
    if layers is None:
        return radiance, bsdf.alpha
    if bsdf.layered & BEHIND != 0:
        radiance = radiance + _from_behind(bsdf, wo, lights, point)
    if bsdf.layered & (SHEET | VOLUME) == 0:
        return radiance, bsdf.alpha
    # Straight alpha: what is reflected must not fade with the veil.
    veiled = max(bsdf.alpha * (ONE - min(luminance(veil(bsdf, wo)), ONE)), _LEAST_ALPHA)
    return radiance * (bsdf.alpha / veiled), veiled


@outlined
def _from_behind(bsdf, wo, lights, point: SurfacePoint) -> Color:
    """What lights on the far side shine through, unshadowed."""
    far, towards, total = far_side(bsdf), reflect(wo, bsdf.ns), bsdf.emission * ZERO
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            total = total + lit_radiance(far, towards, illuminate(lights[k], point.position))
    return total


@kernel
def _shade(point: SurfacePoint, instance, material, camera, scene, lighting, shadowing):
    """(radiance, alpha) of a surface point: emission, ambient light, the sky, and every light; without shadows, if `shadowing` is None."""
    _, _, _, _, _, _, _, lights, textures, texels = scene
    wo = direction_to_eye(camera, point.position)
    point = flip_to_front(point, wo)
    bsdf = resolve(material, instance, point, textures, texels)
    if shadowing is not None and material["kind"] == SHADOW_CATCHER:
        black = spread(ZERO, point.u)
        return Color(black, black, black), ONE - lit_share(point, bsdf, wo, scene, lighting, shadowing)
    radiance = bsdf.emission + ambient_radiance(lights, bsdf) + ambient_from_sky(lighting, bsdf, wo)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] == AMBIENT_LIGHT:
            continue
        if shadowing is not None:
            radiance = radiance + seen_light(lights[k], point, bsdf, wo, scene, shadowing)
        else:
            radiance = radiance + lit_radiance(bsdf, wo, illuminate(lights[k], point.position))
    return _let_through(radiance, bsdf, bsdf.layers, wo, lights, point)


@kernel
def _corner(scene, instance, triangle: i32x8, b0: np.float32, b1: np.float32, b2: np.float32, faceted: bool) -> SurfacePoint:
    """A point of a triangle by its weights alone, with no footprint; `faceted`: with the triangle's own normal."""
    _, meshes, positions, triangles, attributes, slots, _, _, _, _ = scene
    zero = splat8(ZERO)
    w = Barycentrics(splat8(b0), splat8(b1), splat8(b2), zero, zero, zero, zero)
    point = surface_at((positions, triangles, attributes, slots), instance, meshes[instance["mesh"]], triangle, w, meshes, None)
    return with_normal(point, point.n) if faceted else point


@kernel
def _gouraud(instance, triangle: i32x8, w: Barycentrics, material, camera, scene, lighting, shadowing):
    """Shade the three vertices and interpolate their colours (FoCG 8.2.4, 10.1.3)."""
    radiance, alpha = Color(splat8(ZERO), ZERO, ZERO), splat8(ZERO)
    for k in range(3):
        b0, b1, b2 = f32(k == 0), f32(k == 1), f32(k == 2)
        corner = _corner(scene, instance, triangle, b0, b1, b2, False)
        c, a = _shade(corner, instance, material, camera, scene, lighting, shadowing)
        share = w.b0 if k == 0 else (w.b1 if k == 1 else w.b2)
        radiance, alpha = radiance + c * share, alpha + a * share
    return radiance, alpha


@kernel
def _vertex(vertices, row: i32x8):
    return at(vertices, (row, 0)), at(vertices, (row, 1)), at(vertices, (row, 2)), at(vertices, (row, 3))


@kernel
def _vertices(vertices, triangles, row: i32x8, start: int):
    """The homogeneous raster vertices of the triangles at some rows of the table."""
    v0 = _vertex(vertices, at(triangles, (row, 0)) + start)
    v1 = _vertex(vertices, at(triangles, (row, 1)) + start)
    return v0, v1, _vertex(vertices, at(triangles, (row, 2)) + start)


@kernel
def _shade_eight(
    instance_id: int, material_id: int, triangle: i32x8, x: f32x8, y: f32x8, camera, scene, lighting, frame, frequency: int, shadowing
):
    """(radiance, alpha) of eight points of an instance's triangles at raster points (x, y), shaded there, at the vertices, or once each."""
    instances, meshes, _, triangles, _, _, materials, _, _, _ = scene
    vertices, first_vertex, _ = frame
    instance, material = instances[instance_id], materials[material_id]
    if frequency == PER_TRIANGLE:
        middle = _corner(scene, instance, triangle, _THIRD, _THIRD, _THIRD, True)
        return _shade(middle, instance, material, camera, scene, lighting, shadowing)
    first_row, start = np.int64(meshes[instance["mesh"]]["triangle"]), first_vertex[instance_id]
    only = np.int64(lane(triangle, 0))
    if frequency == PER_VERTEX:
        v0, v1, v2 = _vertices(vertices, triangles, triangle + first_row, start)
        return _gouraud(instance, triangle, barycentrics_at(x, y, v0, v1, v2), material, camera, scene, lighting, shadowing)
    if all_of(triangle == only):
        # A triangle that is seen in many pixels need be fetched once only.
        v0, v1, v2 = _vertices(vertices, triangles, only + first_row, start)
        point = visible_point(scene, camera, instance_id, only, v0, v1, v2, x, y)
    else:
        v0, v1, v2 = _vertices(vertices, triangles, triangle + first_row, start)
        point = visible_point(scene, camera, instance_id, triangle, v0, v1, v2, x, y)
    return _shade(point, instance, material, camera, scene, lighting, shadowing)


@kernel
def _behind(x: f32x8, y: f32x8, lighting, camera):
    """(radiance, alpha) of the sky at raster points."""
    return sky_radiance(lighting, normalize(view_ray(camera, x, y).d)), spread(ONE, x)


@kernel
def _pad(fragments: Fragments, n: int):
    """Repeat the last of n fragments: lanes beyond it do its work again."""
    for k in range(n, n + 8):
        fragments.surface[k], fragments.x[k], fragments.y[k] = fragments.surface[n - 1], fragments.x[n - 1], fragments.y[n - 1]


@kernel
def _chosen(fragments: Fragments, k: int, last: int, is_sorted: bool):
    """The places of eight fragments from `k` on, of which `last` is the last: (places, triangles, x, y)."""
    places = load8(_COUNTING, 0) + k
    if is_sorted:
        return places, load8(fragments.triangle, k), load8(fragments.x, k), load8(fragments.y, k)
    places = at(fragments.order, min(places, last))
    return places, at(fragments.triangle, places), at(fragments.x, places), at(fragments.y, places)


@kernel
def shade_fragments(fragments: Fragments, n: int, screen, camera, scene, lighting, frame, frequency: int, shadowing):
    """Fill the radiance and alpha of the first n fragments.

    `screen` (n, words) int32: the screen triangles as plain numbers. `shadowing`: a Shadowing, or None.
    """
    if n == 0:
        return
    _pad(fragments, n)
    n_groups = _number_groups(fragments, n, screen)
    is_sorted = n_groups <= 1
    if is_sorted:
        fragments.first[0], fragments.first[n_groups] = 0, n
    else:
        _sort_groups(fragments, n, n_groups)
    for group in range(n_groups):
        begin, end = np.int64(fragments.first[group]), np.int64(fragments.first[group + 1])
        surface = np.int64(fragments.surface[begin if is_sorted else np.int64(fragments.order[begin])])
        instance_id, material_id = _shown(screen, surface)
        for k in range(begin, end, 8):
            chosen, triangle, x, y = _chosen(fragments, k, end - 1, is_sorted)
            if surface < 0:
                c, alpha = _behind(x, y, lighting, camera)
            else:
                c, alpha = _shade_eight(
                    np.int64(instance_id), np.int64(material_id), triangle, x, y, camera, scene, lighting, frame, frequency, shadowing
                )
            if is_sorted:
                store8(fragments.r, k, c.r)
                store8(fragments.g, k, c.g)
                store8(fragments.b, k, c.b)
                store8(fragments.alpha, k, alpha)
            else:
                put(fragments.r, chosen, c.r)
                put(fragments.g, chosen, c.g)
                put(fragments.b, chosen, c.b)
                put(fragments.alpha, chosen, alpha)
