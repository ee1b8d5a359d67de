"""Lights that have an area (FoCG 13.4.2): one point of the light for every look at it, and how likely that point was.

    sampled = sample_light(light, p, u, v)          # direction, distance, irradiance of a surface that faces it

Points of rectangles and disks are uniform over the area. Seen from p, an area dA at distance r whose normal is turned away by theta fills
the solid angle cos(theta) dA / r^2 (FoCG 18.2), so that radiance L from a point drawn with density 1/A is the irradiance
L A cos(theta) / r^2. Of a sphere, directions are drawn uniformly in the cone that it fills, none of which is wasted on its far side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import safe_sqrt, sqrt
from ..kernel.frame import frame_from_normal, to_world
from ..kernel.vec import ONE, TWO, ZERO, Color, Vec3, dot
from ..kernel.warp import pdf_cone, warp_cone, warp_disk
from ..tables.layouts import RECTANGLE_LIGHT, SPHERE_LIGHT
from .lights import illuminate

__all__ = ["LightSample", "has_area", "pdf_light", "sample_light"]

f32 = np.float32


class LightSample(NamedTuple):
    """Light at a point, as `Illumination`, and the density per steradian with which its direction was drawn; 0 for lights without area."""

    wi: Vec3
    distance: np.float32
    irradiance: Color
    pdf: np.float32


@kernel
def has_area(light) -> bool:
    """Whether a light is a surface."""
    return light["kind"] >= RECTANGLE_LIGHT


@kernel
def _vector(row) -> Vec3:
    return Vec3(row[0], row[1], row[2])


@kernel
def _cap(light, squared: np.float32) -> np.float32:
    """1 - cos of the half angle of the cone that a sphere fills at a squared distance from its centre; 0 inside it."""
    axis = _vector(light["axis_u"])
    sin2 = dot(axis, axis) / squared
    return sin2 / (ONE + sqrt(ONE - sin2)) if sin2 < ONE else ZERO


@kernel
def _sample_sphere(light, p: Vec3, u: np.float32, v: np.float32) -> LightSample:
    to_centre = _vector(light["position"]) - p
    squared = dot(to_centre, to_centre)
    height = _cap(light, squared)
    distance = sqrt(squared)
    if height <= ZERO:
        return LightSample(Vec3(ZERO, ONE, ZERO), distance, Color(ZERO, ZERO, ZERO), ZERO)
    local = warp_cone(u, v, height)
    sin2 = local.x * local.x + local.y * local.y
    axis = _vector(light["axis_u"])
    nearer = safe_sqrt(dot(axis, axis) - squared * sin2)
    pdf = pdf_cone(height)
    radiance = Color(light["intensity"][0], light["intensity"][1], light["intensity"][2])
    return LightSample(to_world(frame_from_normal(to_centre / distance), local), distance * local.z - nearer, radiance / pdf, pdf)


@kernel
def sample_light(light, p: Vec3, u: np.float32, v: np.float32) -> LightSample:
    """The light that reaches p if nothing stands between, from the point of the light that u and v in [0, 1) choose."""
    if light["kind"] < RECTANGLE_LIGHT:
        plain = illuminate(light, p)
        return LightSample(plain.wi, plain.distance, plain.irradiance, ZERO)
    if light["kind"] == SPHERE_LIGHT:
        return _sample_sphere(light, p, u, v)
    a, b = TWO * u - ONE, TWO * v - ONE
    if light["kind"] != RECTANGLE_LIGHT:
        a, b = warp_disk(u, v)
    to_light = _vector(light["position"]) + _vector(light["axis_u"]) * a + _vector(light["axis_v"]) * b - p
    squared = dot(to_light, to_light)
    distance = sqrt(squared)
    wi = to_light * (ONE / distance) if distance > ZERO else Vec3(ZERO, ONE, ZERO)
    cos_theta = -dot(_vector(light["direction"]), wi)
    if not (cos_theta > ZERO and distance > ZERO):
        return LightSample(wi, distance, Color(ZERO, ZERO, ZERO), ZERO)
    pdf = squared / (cos_theta * light["area"])
    radiance = Color(light["intensity"][0], light["intensity"][1], light["intensity"][2])
    return LightSample(wi, distance, radiance / pdf, pdf)


@kernel
def pdf_light(light, p: Vec3, at: Vec3, cos_theta: np.float32) -> np.float32:
    """The density per steradian with which `sample_light` at p draws the point `at` of a light's surface."""
    if light["kind"] == SPHERE_LIGHT:
        to_centre = _vector(light["position"]) - p
        height = _cap(light, dot(to_centre, to_centre))
        return pdf_cone(height) if height > ZERO else ZERO
    to_point = at - p
    return dot(to_point, to_point) / (cos_theta * light["area"]) if cos_theta > ZERO else ZERO
