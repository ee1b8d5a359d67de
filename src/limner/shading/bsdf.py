"""From a material row to a fixed set of lobes, and their sum.

`resolve` looks the textures up and leaves plain numbers; `eval_bsdf` adds the lobes. A material kind is a way to fill the lobes,
so a new kind changes `resolve` alone, and lobes never see textures or tables.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.lanes import any_of, max, min, spread, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, lerp, max_component, normalize, reflect
from ..tables.layouts import BLINN_PHONG, COOL_TO_WARM, DIELECTRIC, MASK, METALLIC_ROUGHNESS, OPAQUE, PHONG
from .bump import bumped_normal
from .cool_to_warm import cool_to_warm
from .fresnel import schlick_weight
from .lambert import eval_lambert
from .microfacet import eval_ggx
from .phong import eval_blinn_phong, eval_phong
from .surface import SurfacePoint
from .texture import place_in, sample_place, sample_texture

__all__ = ["Bsdf", "alpha_at", "eval_bsdf", "resolve", "seen_in_mirrors", "shading_normal", "tint_at"]

f32 = np.float32
_DIELECTRIC_F0 = f32(0.04)
_TWO = f32(2.0)
_CLEARANCE, _LEAST_COSINE = f32(0.01), f32(1e-3)


class Bsdf(NamedTuple):
    """What light meets at a point."""

    ns: Vec3  # shading normal, unit, after the normal map
    diffuse: Color  # kd
    specular: Color  # ks of the highlight
    exponent: np.float32  # its p; negative: Phong's with exponent -p
    f0: Color  # microfacet lobe: reflectance at normal incidence
    roughness2: np.float32  # its alpha: perceptual roughness squared
    ambient: Color  # what ambient light is multiplied by
    occlusion: np.float32  # the share of it that is not hidden nearby
    mirror: Color  # ideal reflection
    emission: Color
    alpha: np.float32  # coverage
    albedo: Color  # the base colour as painted


@kernel
def seen_in_mirrors(bsdf: Bsdf, n: Vec3, wo: Vec3) -> Bsdf:
    """The same lobes about a normal in whose mirror the outside is seen.

    A normal map, or a coarse mesh with smooth normals, can turn the shading normal so far that what wo sees in it would lie below the
    geometric surface n, where there is nothing: metals get black rims. There the normal is bent back until the mirrored direction just
    clears the horizon.

    **Source**: Keller et al., *The Iray light transport simulation and rendering system*, 2017, A.3.
    """
    r = reflect(-wo, bsdf.ns)
    below = dot(n, r)
    if below >= _CLEARANCE or max_component(bsdf.f0) + max_component(bsdf.mirror) <= ZERO:
        return bsdf
    above = normalize(r + bsdf.ns * ((_CLEARANCE - below) / max(dot(n, bsdf.ns), _LEAST_COSINE)))
    ns = normalize(wo + above)
    return Bsdf(
        ns, bsdf.diffuse, bsdf.specular, bsdf.exponent, bsdf.f0, bsdf.roughness2, bsdf.ambient, bsdf.occlusion, bsdf.mirror, bsdf.emission,
        bsdf.alpha, bsdf.albedo,
    )  # fmt: skip


@kernel
def _coverage(material, alpha: np.float32) -> np.float32:
    """Alpha as the material uses it: 1 if opaque, 0 or 1 behind a mask, itself if blended."""
    if material["alpha_mode"] == OPAQUE:
        return spread(ONE, alpha)
    if material["alpha_mode"] == MASK:
        return where(alpha >= material["alpha_cutoff"], spread(ONE, alpha), ZERO)
    return min(max(alpha, ZERO), ONE)


@kernel
def alpha_at(material, point: SurfacePoint, textures, texels) -> np.float32:
    """The coverage of a surface at a point, without the rest of its material."""
    alpha = material["alpha"] * point.alpha
    if material["color_texture"] >= 0:
        _, a = sample_texture(textures[material["color_texture"]], texels, point)
        alpha = alpha * a
    return _coverage(material, _cut_out(material, alpha, point, textures, texels))


@kernel
def _cut_out(material, alpha: np.float32, point: SurfacePoint, textures, texels) -> np.float32:
    """Alpha times a channel of the texture that is there for it alone."""
    if material["alpha_texture"] < 0:
        return alpha
    texture = textures[material["alpha_texture"]]
    c, a = sample_place(texture, texels, place_in(texture, point))
    channel = material["alpha_channel"]
    if channel == 0:
        a = c.r
    if channel == 1:
        a = c.g
    if channel == 2:
        a = c.b
    return alpha * a


@kernel
def tint_at(material, point: SurfacePoint, textures, texels) -> Color:
    """What light is multiplied by that passes the surface of a dielectric."""
    tint = _color3(material["color"])
    if material["color_texture"] < 0:
        return tint
    texture = textures[material["color_texture"]]
    c, _ = sample_place(texture, texels, place_in(texture, point))
    return Color(min(tint.r * c.r, ONE), min(tint.g * c.g, ONE), min(tint.b * c.b, ONE))


@kernel
def _color3(row) -> Color:
    return Color(row[0], row[1], row[2])


@kernel
def _even(level: np.float32, point: SurfacePoint) -> Color:
    """The same grey at one point or at eight."""
    grey = spread(level, point.u)
    return Color(grey, grey, grey)


@kernel
def _textured(index: int, point: SurfacePoint, textures, texels) -> Color:
    """The colour of a texture; white where there is none."""
    if index < 0:
        return _even(ONE, point)
    c, _ = sample_texture(textures[index], texels, point)
    return c


@kernel
def _mapped_normal(material, point: SurfacePoint, textures, texels) -> Vec3:
    """The shading normal bent by a normal map (glTF 2.0, 3.9.3): t x + b y + n z, with b = sign (n x t)."""
    n = point.ns
    t = point.tangent - n * dot(n, point.tangent)
    has_direction = dot(t, t) > ZERO
    t = normalize(t)
    b = cross(n, t) * point.bitangent_sign
    c, _ = sample_texture(textures[material["normal_texture"]], texels, point)
    s = material["normal_scale"]
    mapped = normalize(t * ((_TWO * c.r - ONE) * s) + b * ((_TWO * c.g - ONE) * s) + n * (_TWO * c.b - ONE))
    return where(has_direction & (dot(mapped, mapped) > ZERO), mapped, n)


@kernel
def shading_normal(material, instance, point: SurfacePoint, textures, texels) -> Vec3:
    """The shading normal after the normal map, and after the bump map on top of it."""
    ns = point.ns
    if material["normal_texture"] >= 0:
        ns = _mapped_normal(material, point, textures, texels)
    if material["bump_texture"] >= 0:
        ns = bumped_normal(material, instance, ns, point, textures, texels)
    return ns


@kernel
def resolve(material, instance, point: SurfacePoint, textures, texels) -> Bsdf:
    """The lobes of a material at a point of an instance: textures looked up, kinds forgotten."""
    black, one = _even(ZERO, point), spread(ONE, point.u)
    ns = shading_normal(material, instance, point, textures, texels)
    base, alpha = _color3(material["color"]) * point.color, material["alpha"] * point.alpha
    if material["color_texture"] >= 0:
        c, a = sample_texture(textures[material["color_texture"]], texels, point)
        base, alpha = base * c, alpha * a
    alpha = _coverage(material, _cut_out(material, alpha, point, textures, texels))
    emission = _color3(material["emission"]) * _textured(material["emission_texture"], point, textures, texels)
    ka = _color3(material["ambient"])
    ambient = base
    if ka.r >= ZERO:
        ambient = ka
    kind = material["kind"]
    if kind == BLINN_PHONG:
        ks = _color3(material["specular"]) * _textured(material["specular_texture"], point, textures, texels)
        ks = ks * material["specular_scale"]
        km = _color3(material["mirror"]) + black
        p = spread(-material["exponent"] if material["highlight"] == PHONG else material["exponent"], point.u)
        return Bsdf(ns, base, ks, p, black, one, ambient, one, km, emission, alpha, base)
    if kind == METALLIC_ROUGHNESS:
        if material["unlit"] != 0:
            return Bsdf(point.ns, black, black, one, black, one, black, one, black, base + emission, alpha, base)
        rough = _textured(material["metallic_roughness_texture"], point, textures, texels)
        roughness, metallic = material["roughness"] * rough.g, material["metallic"] * rough.b
        occlusion = one
        if material["occlusion_texture"] >= 0:
            o = _textured(material["occlusion_texture"], point, textures, texels)
            occlusion = lerp(ONE, o.r, material["occlusion_strength"])
        f0 = Color(_DIELECTRIC_F0, _DIELECTRIC_F0, _DIELECTRIC_F0) * (ONE - metallic) + base * metallic
        diffuse = base * (ONE - metallic)
        ambient = (diffuse * (ONE - _DIELECTRIC_F0) + f0) * occlusion
        return Bsdf(ns, diffuse, black, one, f0, roughness * roughness, ambient, occlusion, black, emission, alpha, base)
    if kind == DIELECTRIC:
        # What goes through is the affair of renderers that follow rays.
        alpha2 = spread(material["roughness"] * material["roughness"], point.u)
        f0 = _color3(material["specular"]) + black
        return Bsdf(ns, black, black, one, f0, alpha2, black, one, black, black, alpha, base)
    if kind == COOL_TO_WARM:
        towards = Vec3(material["towards"][0], material["towards"][1], material["towards"][2])
        shown = cool_to_warm(_color3(material["cool"]), base, point.ns, towards)
        return Bsdf(point.ns, black, black, one, black, one, black, one, black, shown, alpha, base)
    return Bsdf(ns, base, black, one, black, one, ambient, one, black, emission, alpha, base)


@kernel
def eval_bsdf(bsdf: Bsdf, wo: Vec3, wi: Vec3) -> Color:
    """The sum of the lobes, cosine included: radiance towards wo per irradiance facing wi."""
    value = eval_lambert(bsdf.diffuse, bsdf.ns, wi)
    has_highlight = max_component(bsdf.specular) > ZERO
    if any_of(has_highlight):
        # All of a material's points have one kind of highlight.
        if any_of(bsdf.exponent < ZERO):
            highlight = eval_phong(bsdf.specular, -bsdf.exponent, bsdf.ns, wi, wo)
        else:
            highlight = eval_blinn_phong(bsdf.specular, bsdf.exponent, bsdf.ns, wi, wo)
        value = where(has_highlight, value + highlight, value)
    has_facets = max_component(bsdf.f0) > ZERO
    if any_of(has_facets):
        # What the coat of microfacets reflects does not reach the base (glTF 2.0, B.2.1: fresnel_mix).
        reflected = _DIELECTRIC_F0 + (ONE - _DIELECTRIC_F0) * schlick_weight(dot(wo, normalize(wo + wi)))
        faceted = value * (ONE - reflected) + eval_ggx(bsdf.f0, bsdf.roughness2, bsdf.ns, wi, wo)
        value = where(has_facets, faceted, value)
    return value
