"""Shadows in the rasteriser: by the rays that the ray tracer sends (FoCG 4.7), one for each lit fragment and light.

A rasteriser that is asked for shadows has a tree of the scene like a ray tracer. Its eight fragments send their rays one after the other,
since each goes its own way.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.lanes import f32x8, first_set, lane, mask_of, splat8, where, with_lane
from ..kernel.vec import ONE, ZERO, Color, Vec3, luminance, max_component
from ..shading.bsdf import Bsdf
from ..shading.lights import Illumination, ambient_level, illuminate, lit_radiance
from ..shading.sky import ambient_from_sky
from ..shading.surface import Footprint, SurfacePoint, no_detail
from ..tables.layouts import AMBIENT_LIGHT
from ..visibility.shadow import transmittance

__all__ = ["Shadowing", "lit_share", "seen_light"]


class Shadowing(NamedTuple):
    """What shadow rays go through."""

    accelerator: Any
    media: Any
    tinted: int  # 1: light goes straight through dielectrics
    has_alpha: int  # 1: some material is not opaque
    stack: Any


@kernel
def _vector_of(v: Vec3, k: int) -> Vec3:
    return Vec3(lane(v.x, k), lane(v.y, k), lane(v.z, k))


@kernel
def _point_of(point: SurfacePoint, k: int) -> SurfacePoint:
    """One of eight points, as far as a shadow ray asks."""
    n = _vector_of(point.n, k)
    footprint = Footprint(ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO)
    return SurfacePoint(
        _vector_of(point.position, k), n, n, n, ONE, ZERO, ZERO, ZERO, ZERO, Color(ONE, ONE, ONE), ONE, footprint, np.int64(0),
        _vector_of(point.bulge, k), lane(point.reach, k), no_detail(ZERO),
    )  # fmt: skip


@kernel
def _share(point: SurfacePoint, light: Illumination, from_light: Color, scene, shadowing: Shadowing) -> Color:
    """How much of a light reaches each of eight points, where it would be seen at all."""
    red, green, blue = splat8(ONE), splat8(ONE), splat8(ONE)
    lit = mask_of(max_component(from_light) > ZERO)
    while lit != 0:
        k = first_set(lit)
        lit = lit & (lit - 1)
        seen = transmittance(
            scene, shadowing.accelerator, shadowing.media, 0, shadowing.tinted, shadowing.has_alpha, _point_of(point, k),
            _vector_of(light.wi, k), lane(light.distance, k), shadowing.stack,
        )  # fmt: skip
        red, green, blue = with_lane(red, k, seen.share.r), with_lane(green, k, seen.share.g), with_lane(blue, k, seen.share.b)
    return Color(red, green, blue)


@kernel
def seen_light(light_row, point: SurfacePoint, bsdf: Bsdf, wo: Vec3, scene, shadowing: Shadowing) -> Color:
    """The radiance towards the eye that a light causes where it is not hidden."""
    light = illuminate(light_row, point.position)
    from_light = lit_radiance(bsdf, wo, light)
    return from_light * _share(point, light, from_light, scene, shadowing)


@kernel
def lit_share(point: SurfacePoint, bsdf: Bsdf, wo: Vec3, scene, lighting, shadowing: Shadowing) -> f32x8:
    """How much of the light that would fall on a white surface does fall on it: what a shadow catcher lets through."""
    lights = scene[7]
    base = luminance(ambient_from_sky(lighting, bsdf, wo) + ambient_level(lights))
    everything, arriving = base, base
    for k in range(lights.shape[0]):
        if lights[k]["kind"] != AMBIENT_LIGHT:
            light = illuminate(lights[k], point.position)
            from_light = lit_radiance(bsdf, wo, light)
            everything = everything + luminance(from_light)
            arriving = arriving + luminance(from_light * _share(point, light, from_light, scene, shadowing))
    return where(everything > ZERO, arriving / where(everything > ZERO, everything, ONE), ONE)
