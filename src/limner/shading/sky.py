"""Light from all around: an environment, equirectangular.

Direction (x, y, z) looks into it at ``u = 1/2 + atan2(z, x) / 2 pi`` and, with v up, ``v = 1 - acos(y) / pi``: its middle column is +x,
its upper edge +y. A direction is drawn in proportion to the radiance, first the row, then the column (Pharr, Jakob and Humphreys,
*Physically Based Rendering*, 4th ed., 12.5). What matte surfaces get of it is nine numbers a channel (Ramamoorthi and Hanrahan, *An
efficient representation for irradiance environment maps*, 2001).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import INV_PI, PI, TWO_PI, acos, atan2, cos, floor, safe_sqrt, sin, sqrt
from ..kernel.lanes import any_of, at, max, min, spread, to_int, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, max_component, normalize, reflect
from ..tables.layouts import ANISOTROPY, BEHIND, COAT, COMPENSATED, CONDUCTOR, FILM, MATTE_ONLY, ROUGH_MATTE, SHEEN, SHEET
from .fresnel import schlick_weight
from .iridescence import film_reflectance
from .layered import facets_reflectance, given_back
from .lobes import Bsdf, Layers
from .multiscatter import energy_gain
from .oren_nayar import rough_matte_sent_on
from .prefilter import blurred_radiance, facets_share, sent_on
from .sheen import sheen_sent_on

__all__ = ["SkySample", "ambient_from_sky", "pdf_sky", "sample_sky", "sky_irradiance", "sky_radiance"]

f32 = np.float32
_HALF = f32(0.5)
_COAT_F0, _LEAST_ALPHA = f32(0.04), f32(1e-3)
_Y00 = f32(0.5 / math.sqrt(math.pi))
_Y1 = f32(math.sqrt(3.0 / (4.0 * math.pi)))
_Y2 = f32(math.sqrt(15.0 / (4.0 * math.pi)))
_Y20 = f32(math.sqrt(5.0 / (16.0 * math.pi)))


class SkySample(NamedTuple):
    """A direction towards the sky, unit, its radiance, and its density per steradian."""

    wi: Vec3
    radiance: Color
    pdf: np.float32


@kernel
def _turned(header, d: Vec3) -> Vec3:
    """A world direction in the sky's own frame: turned back about +y."""
    c, s = header["sky_cos"], header["sky_sin"]
    return Vec3(c * d.x - s * d.z, d.y, s * d.x + c * d.z)


@kernel
def _turned_back(header, d: Vec3) -> Vec3:
    c, s = header["sky_cos"], header["sky_sin"]
    return Vec3(c * d.x + s * d.z, d.y, -s * d.x + c * d.z)


@kernel
def _texel(sky, j: int, i: int) -> Color:
    return Color(at(sky, (j, i, 0)), at(sky, (j, i, 1)), at(sky, (j, i, 2)))


@kernel
def _black(d: Vec3) -> Color:
    """No light at one point or at eight."""
    zero = spread(ZERO, d.x)
    return Color(zero, zero, zero)


@kernel
def sky_radiance(lighting, d: Vec3) -> Color:
    """The radiance from a unit direction, bilinear between texel centres; black where there is no sky."""
    header_table, sky, _, _, _ = lighting
    header = header_table[0]
    if header["sky_present"] == 0:
        return _black(d)
    p = _turned(header, d)
    w, h = np.int64(header["sky_width"]), np.int64(header["sky_height"])
    x = (_HALF + atan2(p.z, p.x) / TWO_PI) * f32(w) - _HALF
    y = (ONE - acos(p.y) * INV_PI) * f32(h) - _HALF
    fx, fy = floor(x), floor(y)
    a, b = x - fx, y - fy
    i0, j0 = to_int(fx), to_int(fy)
    i1, j1 = i0 + 1, min(j0 + 1, h - 1)
    i0 = where(i0 < 0, i0 + w, i0)
    i1 = where(i1 >= w, i1 - w, i1)
    j0 = max(j0, 0)
    lower = _texel(sky, j0, i0) * (ONE - a) + _texel(sky, j0, i1) * a
    upper = _texel(sky, j1, i0) * (ONE - a) + _texel(sky, j1, i1) * a
    return (lower * (ONE - b) + upper * b) * header["sky_intensity"]


@kernel
def _find(cumulative, start: int, n: int, u: np.float32) -> int:
    """The k in 0..n-1 with cumulative[start + k] <= u < cumulative[start + k + 1]."""
    low, high = 0, n
    while high - low > 1:
        middle = (low + high) // 2
        if cumulative[start + middle] <= u:
            low = middle
        else:
            high = middle
    return low


@kernel
def sample_sky(lighting, u: np.float32, v: np.float32) -> SkySample:
    """Draw a direction in proportion to the radiance; pdf 0 where there is no sky."""
    header_table, _, cumulative, _, _ = lighting
    header = header_table[0]
    up = Vec3(ZERO, ONE, ZERO)
    if header["sky_present"] == 0:
        return SkySample(up, Color(ZERO, ZERO, ZERO), ZERO)
    w, h = np.int64(header["sky_width"]), np.int64(header["sky_height"])
    j = _find(cumulative, 0, h, v)
    row = (h + 1) + j * (w + 1)
    i = _find(cumulative, row, w, u)
    low_v, high_v = cumulative[j], cumulative[j + 1]
    low_u, high_u = cumulative[row + i], cumulative[row + i + 1]
    share_v, share_u = high_v - low_v, high_u - low_u
    if share_v <= ZERO or share_u <= ZERO:
        return SkySample(up, Color(ZERO, ZERO, ZERO), ZERO)
    s = (f32(i) + (u - low_u) / share_u) / f32(w)
    t = (f32(j) + (v - low_v) / share_v) / f32(h)
    theta, phi = PI * (ONE - t), TWO_PI * (s - _HALF)
    sin_theta = sin(theta)
    if sin_theta <= ZERO:
        return SkySample(up, Color(ZERO, ZERO, ZERO), ZERO)
    wi = _turned_back(header, Vec3(sin_theta * cos(phi), cos(theta), sin_theta * sin(phi)))
    pdf = share_u * share_v * f32(w) * f32(h) / (TWO_PI * PI * sin_theta)
    return SkySample(wi, sky_radiance(lighting, wi), pdf)


@kernel
def pdf_sky(lighting, d: Vec3) -> np.float32:
    """The density with which `sample_sky` draws a direction, per steradian."""
    header_table, _, cumulative, _, _ = lighting
    header = header_table[0]
    if header["sky_present"] == 0:
        return ZERO
    p = _turned(header, d)
    w, h = np.int64(header["sky_width"]), np.int64(header["sky_height"])
    i = min(max(int((_HALF + atan2(p.z, p.x) / TWO_PI) * f32(w)), 0), w - 1)
    j = min(max(int((ONE - acos(p.y) * INV_PI) * f32(h)), 0), h - 1)
    sin_theta = safe_sqrt(ONE - p.y * p.y)
    if sin_theta <= ZERO:
        return ZERO
    row = (h + 1) + j * (w + 1)
    share = (cumulative[j + 1] - cumulative[j]) * (cumulative[row + i + 1] - cumulative[row + i])
    return share * f32(w) * f32(h) / (TWO_PI * PI * sin_theta)


@kernel
def _harmonic(header, k: int) -> Color:
    return Color(header["irradiance"][k, 0], header["irradiance"][k, 1], header["irradiance"][k, 2])


@kernel
def sky_irradiance(lighting, n: Vec3) -> Color:
    """The sky's irradiance on a surface of unit normal n, nothing in the way: second-order spherical harmonics, not below zero."""
    header = lighting[0][0]
    if header["sky_present"] == 0:
        return _black(n)
    x, y, z = n.x, n.y, n.z
    e = _harmonic(header, 0) * _Y00
    e = e + _harmonic(header, 1) * (_Y1 * y) + _harmonic(header, 2) * (_Y1 * z) + _harmonic(header, 3) * (_Y1 * x)
    e = e + _harmonic(header, 4) * (_Y2 * x * y) + _harmonic(header, 5) * (_Y2 * y * z)
    e = e + _harmonic(header, 6) * (_Y20 * (f32(3.0) * z * z - ONE)) + _harmonic(header, 7) * (_Y2 * x * z)
    e = e + _harmonic(header, 8) * (_Y2 * _HALF * (x * x - y * y))
    return Color(max(e.r, ZERO), max(e.g, ZERO), max(e.b, ZERO))


@outlined
def _mirrored(lighting, r: Vec3, roughness: np.float32) -> Color:
    """The sky about direction r, as a mirror of perceptual roughness sees it."""
    header = lighting[0][0]
    return blurred_radiance(lighting[4], sky_radiance(lighting, r), _turned(header, r), roughness, header["sky_intensity"])


@kernel
def _bent(bsdf: Bsdf, wo: Vec3) -> Vec3:
    """The normal about which a stretched lobe mirrors the eye: leant towards the eye in the plane across the brush strokes.

    **Source**: Revie, *Implementing Fur in Deferred Shading*, GPU Pro 2, 2011; as Guy and Agopian, *Physically based rendering in
    Filament*, 2018, 5.3.5 have it.
    """
    layers = bsdf.layers
    across = cross(bsdf.ns, layers.tangent)
    strength = (layers.along - bsdf.roughness2) / max(ONE - bsdf.roughness2, _LEAST_ALPHA)
    bend = safe_sqrt(min(max(strength, ZERO), ONE)) * min(sqrt(bsdf.roughness2) * f32(5.0), ONE)
    leaning = cross(cross(across, wo), across)
    return normalize(bsdf.ns * (ONE - bend) + normalize(leaning) * bend)


@outlined
def _from_layers(lighting, bsdf: Bsdf, wo: Vec3) -> Color:
    """What a surface with layers sends on of the whole sky: each layer by the sky as it sees it, dimmed by those above."""
    layers, bits = bsdf.layers, bsdf.layered
    n_v, roughness = max(dot(bsdf.ns, wo), ZERO), sqrt(bsdf.roughness2)
    total = bsdf.diffuse * (sky_irradiance(lighting, bsdf.ns) * INV_PI) * (ONE - layers.shield)
    if bits & ROUGH_MATTE != 0:
        total = total * rough_matte_sent_on(layers.matte_roughness, n_v)
    if bits & MATTE_ONLY == 0 and bits & ROUGH_MATTE == 0:
        n = bsdf.ns
        if bits & ANISOTROPY != 0:
            n = _bent(bsdf, wo)
        f0, f90 = bsdf.f0, layers.f90
        if bits & CONDUCTOR != 0:
            f0, f90 = facets_reflectance(bsdf, spread(ONE, wo.x)), spread(ONE, wo.x)
        if bits & FILM != 0:
            f0 = f0 * (ONE - layers.film) + film_reflectance(f0, layers.film_ior, layers.film_thickness, n_v) * layers.film
        share = facets_share(f0, f90, n_v, roughness)
        if bits & ANISOTROPY != 0:
            # Of a stretched lobe about as much as of its two widths, each all round.
            share = (share + facets_share(f0, f90, n_v, sqrt(layers.along))) * _HALF
        if bits & COMPENSATED != 0:
            kept = f0 if bits & SHEET == 0 else given_back(bsdf, spread(ONE, wo.x))
            share = share * energy_gain(kept, n_v, roughness)
        total = total + share * _mirrored(lighting, reflect(-wo, n), roughness)
    if bits & BEHIND != 0:
        total = total + layers.behind * (sky_irradiance(lighting, -bsdf.ns) * INV_PI) * (ONE - layers.shield)
    if bits & SHEEN != 0:
        level = sheen_sent_on(layers.sheen_alpha, n_v)
        fibres = _mirrored(lighting, reflect(-wo, bsdf.ns), sqrt(layers.sheen_alpha))
        total = total * (ONE - max_component(layers.sheen) * level) + layers.sheen * fibres * level
    if bits & COAT != 0:
        n_v = max(dot(layers.coat_normal, wo), ZERO)
        total = total * (ONE - layers.coat * (_COAT_F0 + (ONE - _COAT_F0) * schlick_weight(n_v)))
        if bits & MATTE_ONLY == 0:
            roughness = sqrt(layers.coat_alpha)
            grey = spread(_COAT_F0, wo.x)
            mirrored = sent_on(Color(grey, grey, grey), n_v, roughness) * layers.coat
            total = total + mirrored * _mirrored(lighting, reflect(-wo, layers.coat_normal), roughness)
    return total * bsdf.occlusion


@kernel
def ambient_from_sky(lighting, bsdf: Bsdf, wo: Vec3) -> Color:
    """What a surface sends on of the whole sky, unshadowed: the matte part by irradiance, the microfacets by the blurred sky."""
    header = lighting[0][0]
    if header["sky_present"] == 0:
        return _black(wo)
    return _sent_on_of(lighting, bsdf, bsdf.layers, wo)


@kernel
def _sent_on_of(lighting, bsdf: Bsdf, layers: Layers | None, wo: Vec3) -> Color:
    header = lighting[0][0]
    if layers is not None:
        if bsdf.layered != 0:
            return _from_layers(lighting, bsdf, wo)
    matte = sky_irradiance(lighting, bsdf.ns) * INV_PI
    has_facets = max_component(bsdf.f0) > ZERO
    if not any_of(has_facets):
        return bsdf.ambient * matte
    n_v = max(dot(bsdf.ns, wo), ZERO)
    roughness = sqrt(bsdf.roughness2)
    r = reflect(-wo, bsdf.ns)
    shiny = blurred_radiance(lighting[4], sky_radiance(lighting, r), _turned(header, r), roughness, header["sky_intensity"])
    coated = (bsdf.diffuse * matte * (ONE - bsdf.dielectric_f0) + sent_on(bsdf.f0, n_v, roughness) * shiny) * bsdf.occlusion
    return where(has_facets, coated, bsdf.ambient * matte)
