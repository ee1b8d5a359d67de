"""What arrives from a light (FoCG 4.5; KHR_lights_punctual): direction, distance and irradiance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import sqrt
from ..kernel.lanes import max, min, spread, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, spread3
from ..tables.layouts import AMBIENT_LIGHT, DIRECTIONAL_LIGHT, RECTANGLE_LIGHT, SPHERE_LIGHT, SPOT_LIGHT
from .bsdf import Bsdf, eval_bsdf

__all__ = ["Illumination", "ambient_level", "ambient_radiance", "illuminate", "lit_radiance"]

f32 = np.float32
_INFINITY = f32(np.inf)
_QUARTER = f32(0.25)  # of a sphere's surface: the disk that is seen of it


class Illumination(NamedTuple):
    """Light at a point: where it comes from, how far that is, and the irradiance of a surface that faces it."""

    wi: Vec3
    distance: np.float32
    irradiance: Color


@kernel
def _spread_color(c: Color, like: Vec3) -> Color:
    return Color(spread(c.r, like.x), spread(c.g, like.x), spread(c.b, like.x))


@kernel
def illuminate(light, p: Vec3) -> Illumination:
    """The light that reaches p if nothing stands between; a light with an area is taken for a point in its middle."""
    intensity = Color(light["intensity"][0], light["intensity"][1], light["intensity"][2])
    axis = Vec3(light["direction"][0], light["direction"][1], light["direction"][2])
    kind = light["kind"]
    if kind == DIRECTIONAL_LIGHT:
        return Illumination(spread3(-axis, p.x), spread(_INFINITY, p.x), _spread_color(intensity, p))
    if kind == AMBIENT_LIGHT:
        return Illumination(spread3(-axis, p.x), spread(_INFINITY, p.x), _spread_color(Color(ZERO, ZERO, ZERO), p))
    to_light = Vec3(light["position"][0], light["position"][1], light["position"][2]) - p
    squared = dot(to_light, to_light)
    distance = sqrt(squared)
    apart = distance > ZERO
    wi = where(apart, to_light * (ONE / where(apart, distance, ONE)), -axis)
    strength = spread(ONE, p.x)
    if light["inverse_square"] != 0:
        strength = where(squared > ZERO, ONE / where(squared > ZERO, squared, ONE), ZERO)
    if light["inverse_range"] > ZERO:
        s = squared * light["inverse_range"] * light["inverse_range"]
        strength = strength * min(max(ONE - s * s, ZERO), ONE)
    if kind == SPOT_LIGHT:
        cone = min(max(-dot(axis, wi) * light["cone_scale"] + light["cone_offset"], ZERO), ONE)
        strength = strength * (cone * cone)
    if kind == SPHERE_LIGHT:
        strength = strength * (light["area"] * _QUARTER)
    elif kind >= RECTANGLE_LIGHT:
        strength = strength * (max(-dot(axis, wi), ZERO) * light["area"])
    return Illumination(wi, distance, intensity * strength)


@kernel
def ambient_level(lights) -> Color:
    """I_a, summed over the ambient lights."""
    total = Color(ZERO, ZERO, ZERO)
    for k in range(lights.shape[0]):
        if lights[k]["kind"] == AMBIENT_LIGHT:
            total = total + Color(lights[k]["intensity"][0], lights[k]["intensity"][1], lights[k]["intensity"][2])
    return total


@kernel
def ambient_radiance(lights, bsdf: Bsdf) -> Color:
    """ka I_a (FoCG 4.5.3)."""
    return bsdf.ambient * ambient_level(lights)


@kernel
def lit_radiance(bsdf: Bsdf, wo: Vec3, light: Illumination) -> Color:
    """The radiance towards the eye that a light causes."""
    return eval_bsdf(bsdf, wo, light.wi) * light.irradiance
