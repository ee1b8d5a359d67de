"""From a material row to a fixed set of lobes, and their sum.

`resolve` looks the textures up and leaves plain numbers; `eval_bsdf` adds the lobes. A material kind is a way to fill the lobes,
so a new kind changes `resolve` alone, and lobes never see textures or tables.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import any_of, max, min, spread, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, lerp, max_component, normalize, reflect
from ..tables.layouts import BLINN_PHONG, COOL_TO_WARM, DIELECTRIC, MASK, METALLIC_ROUGHNESS, OPAQUE, PHONG, SOLID
from .bump import bumped_normal
from .cool_to_warm import cool_to_warm
from .fresnel import schlick_weight
from .lambert import eval_lambert
from .layer_row import if_layered, layer_row
from .layered import eval_layers
from .layers import resolve_layers
from .lobes import Bsdf, Layers, no_layers, rough_matte, with_layers, with_lobes
from .microfacet import eval_ggx
from .normal_map import mapped_normal
from .phong import eval_blinn_phong, eval_phong
from .surface import SurfacePoint
from .texture import place_in, sample_place, sample_texture

__all__ = ["Bsdf", "alpha_at", "eval_bsdf", "resolve", "resolve_matte", "seen_in_mirrors", "shading_normal", "tint_at"]

f32 = np.float32
_CLEARANCE, _LEAST_COSINE = f32(0.01), f32(1e-3)


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
    return with_lobes(bsdf, ns, bsdf.diffuse, bsdf.f0, bsdf.ambient)


@kernel
def _coverage(material, alpha: np.float32) -> np.float32:
    """Alpha as the material uses it: 1 if opaque, 0 or 1 behind a mask, itself if blended."""
    if material["alpha_mode"] == OPAQUE or material["layers"] & SOLID != 0:
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
def shading_normal(material, instance, point: SurfacePoint, textures, texels) -> Vec3:
    """The shading normal after the normal map, and after the bump map on top of it."""
    ns = point.ns
    if material["normal_texture"] >= 0:
        c, _ = sample_texture(textures[material["normal_texture"]], texels, point)
        ns = mapped_normal(c, material["normal_scale"], point)
    if material["bump_texture"] >= 0:
        ns = bumped_normal(material, instance, ns, point, textures, texels)
    return ns


@kernel
def _metallic(row, bare: Bsdf, metallic: np.float32, point: SurfacePoint, textures, texels) -> Bsdf:
    """The lobes of a metallic-roughness material, of which `bare` has all but these, its diffuse coefficient the base colour."""
    base, f0d = bare.diffuse, bare.dielectric_f0
    if row is not None:
        if bare.layered != 0:
            made = resolve_layers(row, point, bare.ns, base, metallic, bare.roughness2, bare.occlusion, textures, texels)
            return with_layers(with_lobes(bare, bare.ns, made.diffuse, made.f0, made.ambient), bare.layered, made.layers)
    f0 = Color(f0d, f0d, f0d) * (ONE - metallic) + base * metallic
    diffuse = base * (ONE - metallic)
    ambient = (diffuse * (ONE - f0d) + f0) * bare.occlusion
    return with_lobes(bare, bare.ns, diffuse, f0, ambient)


@kernel
def _rough_matte(row, layers: Layers):
    if row is None:
        return layers
    return rough_matte(layers, row["matte_roughness"])


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
    kind, bits = material["kind"], np.int64(material["layers"])
    row, f0d = layer_row(material), material["dielectric_f0"]
    layers = if_layered(row, no_layers(point.u))
    if kind == BLINN_PHONG:
        ks = _color3(material["specular"]) * _textured(material["specular_texture"], point, textures, texels)
        ks = ks * material["specular_scale"]
        km = _color3(material["mirror"]) + black
        p = spread(-material["exponent"] if material["highlight"] == PHONG else material["exponent"], point.u)
        return Bsdf(ns, base, ks, p, black, one, ambient, one, km, emission, alpha, base, f0d, bits, layers)
    if kind == METALLIC_ROUGHNESS:
        if material["unlit"] != 0:
            return Bsdf(point.ns, black, black, one, black, one, black, one, black, base + emission, alpha, base, f0d, bits, layers)
        rough = _textured(material["metallic_roughness_texture"], point, textures, texels)
        roughness, metallic = material["roughness"] * rough.g, material["metallic"] * rough.b
        occlusion = one
        if material["occlusion_texture"] >= 0:
            o = _textured(material["occlusion_texture"], point, textures, texels)
            occlusion = lerp(ONE, o.r, material["occlusion_strength"])
        bare = Bsdf(
            ns, base, black, one, black, roughness * roughness, black, occlusion, black, emission, alpha, base, f0d, bits, layers
        )
        return _metallic(row, bare, metallic, point, textures, texels)
    if kind == DIELECTRIC:
        # What goes through is the affair of renderers that follow rays.
        alpha2 = spread(material["roughness"] * material["roughness"], point.u)
        f0 = _color3(material["specular"]) + black
        return Bsdf(ns, black, black, one, f0, alpha2, black, one, black, black, alpha, base, f0d, np.int64(0), layers)
    if kind == COOL_TO_WARM:
        towards = Vec3(material["towards"][0], material["towards"][1], material["towards"][2])
        shown = cool_to_warm(_color3(material["cool"]), base, point.ns, towards)
        return Bsdf(point.ns, black, black, one, black, one, black, one, black, shown, alpha, base, f0d, bits, layers)
    layers = _rough_matte(row, layers)
    return Bsdf(ns, base, black, one, black, one, ambient, one, black, emission, alpha, base, f0d, bits, layers)


@kernel
def resolve_matte(material, point: SurfacePoint) -> Bsdf:
    """`resolve` of a material that is matte, opaque and without texture, at one point."""
    black, base = Color(ZERO, ZERO, ZERO), _color3(material["color"]) * point.color
    layers = if_layered(layer_row(material), no_layers(point.u))
    return Bsdf(
        point.ns, base, black, ONE, black, ONE, base, ONE, black, _color3(material["emission"]), ONE, base,
        material["dielectric_f0"], np.int64(0), layers,
    )  # fmt: skip


@kernel
def eval_bsdf(bsdf: Bsdf, wo: Vec3, wi: Vec3) -> Color:
    """The sum of the lobes, cosine included: radiance towards wo per irradiance facing wi."""
    return _eval(bsdf, bsdf.layers, wo, wi)


@kernel
def _eval(bsdf: Bsdf, layers: Layers | None, wo: Vec3, wi: Vec3) -> Color:
    if layers is not None:
        if bsdf.layered != 0:
            parts = eval_layers(bsdf, wo, wi)
            return parts.matte + parts.facets
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
        reflected = bsdf.dielectric_f0 + (ONE - bsdf.dielectric_f0) * schlick_weight(dot(wo, normalize(wo + wi)))
        faceted = value * (ONE - reflected) + eval_ggx(bsdf.f0, bsdf.roughness2, bsdf.ns, wi, wo)
        value = where(has_facets, faceted, value)
    return value
