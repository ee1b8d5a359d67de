"""Surfaces that shine: a point on one of them, drawn in proportion to what it may be worth, and the density of having drawn it.

Points are drawn uniformly on triangles. A few triangles are drawn by emission times area, so that the density per area is
``weight / total`` wherever the weight of a material is known: no look-up is needed for a surface that a ray met by chance. Many are
drawn by a tree (`limner.shading.light_tree`). Seen from p, an area dA at distance r fills the solid angle cos(theta) dA / r^2 (FoCG 18.2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import sqrt
from ..kernel.transform import transform_vector
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, length
from ..kernel.warp import warp_triangle
from .bsdf import resolve
from .light_tree import draw_leaf, row_of, share_of
from .matte_row import only_matte
from .surface import barycentrics_of_hit, surface_at, vertices_at

__all__ = ["EmitterSample", "pdf_emitter", "sample_emitter"]

f32 = np.float32


class EmitterSample(NamedTuple):
    """A direction towards a shining point, unit, its distance, its radiance, and its density per steradian; pdf 0: none."""

    wi: Vec3
    distance: np.float32
    radiance: Color
    pdf: np.float32


@kernel
def _find(emitters, u: np.float32) -> int:
    """The first emitter whose share of the power reaches beyond u."""
    low, high = 0, emitters.shape[0] - 1
    while low < high:
        middle = (low + high) // 2
        if emitters[middle]["cumulative"] > u:
            high = middle
        else:
            low = middle + 1
    return low


@kernel
def pdf_emitter(lighting, material, hit, p: Vec3, cos_theta: np.float32, squared: np.float32) -> np.float32:
    """The density per steradian with which `sample_emitter` draws, as seen from p, the point of a hit at a squared distance."""
    total, emitters = lighting[0][0]["emitted_power"], lighting[3]
    if total <= ZERO or cos_theta <= ZERO:
        return ZERO
    if lighting[0][0]["light_tree"] != 0:
        row = row_of(emitters, hit.instance, hit.triangle)
        return share_of(emitters, row, p) / emitters[row]["area"] * squared / cos_theta if row >= 0 else ZERO
    return material["emission_weight"] / total * squared / cos_theta


@outlined
def _shining_point(scene, exact, emitter, b1: np.float32, b2: np.float32):
    """(position, normal, radiance) of a point of an emitter that moves or has a texture."""
    instances, meshes, positions, triangles, attributes, slots, materials, _, textures, texels = scene
    instance = instances[emitter["instance"]]
    geometry = (positions, triangles, attributes, slots)
    w = barycentrics_of_hit(b1, b2)
    point = surface_at(geometry, instance, meshes[instance["mesh"]], np.int64(emitter["triangle"]), w, meshes, exact)
    bsdf = resolve(materials[point.material], instance, point, textures, texels)
    return point.position, point.n, bsdf.emission * (bsdf.alpha * _growth(scene, exact, instance, emitter))


@kernel
def _growth(scene, exact, instance, emitter) -> np.float32:
    """How much larger a triangle that bends is than when the shutter opened: it is drawn as often as then, for all of what it is now."""
    if exact is not None:
        if instance["key"] > 0:
            _, meshes, positions, triangles, _, _, _, _, _, _ = scene
            mesh = meshes[instance["mesh"]]
            v0, v1, v2 = vertices_at(positions, triangles, instance, mesh, np.int64(emitter["triangle"]), meshes, exact)
            m = instance["world_from_object"]
            now = cross(transform_vector(m, v1 - v0), transform_vector(m, v2 - v0))
            return length(now) / length(cross(_vector(emitter["edge_u"]), _vector(emitter["edge_v"])))
    return ONE


@kernel
def _vector(row) -> Vec3:
    return Vec3(row[0], row[1], row[2])


@kernel
def sample_emitter(scene, exact, lighting, p: Vec3, u: np.float32, v: np.float32) -> EmitterSample:
    """Draw a point of the shining surfaces as seen from p; single-sided ones shine to their front only.

    `exact`: of the accelerator (`accel.walk.exact_tables`).

    u chooses the triangle, and what is left of it the point, so that points that are spread well over the unit square are so over a
    surface of many triangles, too.
    """
    emitters = lighting[3]
    nothing = EmitterSample(Vec3(ZERO, ONE, ZERO), ZERO, Color(ZERO, ZERO, ZERO), ZERO)
    if emitters.shape[0] == 0:
        return nothing
    if lighting[0][0]["light_tree"] != 0:
        drawn = draw_leaf(emitters, p, u)
        k, share, rest = drawn.row, drawn.share, drawn.rest
        if share <= ZERO:
            return nothing
        per_area = share / emitters[k]["area"]
    else:
        k = _find(emitters, u)
        before = emitters[k - 1]["cumulative"] if k > 0 else ZERO
        share = emitters[k]["cumulative"] - before
        rest = min((u - before) / share, ONE) if share > ZERO else ZERO
        per_area = emitters[k]["weight"] / lighting[0][0]["emitted_power"]
    emitter = emitters[k]
    b1, b2 = warp_triangle(rest, v)
    position = _vector(emitter["corner"]) + _vector(emitter["edge_u"]) * b1 + _vector(emitter["edge_v"]) * b2
    n, c = _vector(emitter["normal"]), emitter["radiance"]
    radiance = Color(c[0], c[1], c[2])
    if emitter["plain"] == 0 and not only_matte(scene[6]):
        position, n, radiance = _shining_point(scene, exact, emitter, b1, b2)
    to_light = position - p
    squared = dot(to_light, to_light)
    if squared <= ZERO:
        return nothing
    distance = sqrt(squared)
    wi = to_light * (ONE / distance)
    cos_theta = -dot(n, wi)
    if emitter["double_sided"] != 0:
        cos_theta = abs(cos_theta)
    if cos_theta <= ZERO:
        return nothing
    return EmitterSample(wi, distance, radiance, per_area * squared / cos_theta)
