"""The layers of a material at a point: textures looked up, for what most materials do not have."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.lanes import max, min, spread, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, lerp, max_component, normalize, spread3
from ..tables.layouts import ANISOTROPY, BEHIND, COAT, CONDUCTOR, DIELECTRIC, FILM, SHEEN, SHEET, SPECULAR_LAYER, VOLUME
from .fresnel import schlick_weight
from .layer_row import layer_row
from .lobes import Layers, no_layers
from .normal_map import mapped_normal
from .sheen import sheen_sent_on
from .surface import SurfacePoint
from .texture import sample_texture

__all__ = ["Layered", "glass_share", "interface_alpha", "resolve_layers", "sheet_veil"]

f32 = np.float32
_HALF, _TWO = f32(0.5), f32(2.0)
_COAT_F0, _POLISHED = f32(0.04), f32(1e-3)
_LEAST_DIRECTION = f32(1e-6)


class Layered(NamedTuple):
    """What a base, its metalness and its roughness become under their layers."""

    diffuse: Color
    f0: Color
    ambient: Color
    layers: Layers


@outlined
def _found(texture, texels, point: SurfacePoint):
    return sample_texture(texture, texels, point)


@kernel
def _looked_up(index: int, point: SurfacePoint, textures, texels):
    """(Color, alpha) of a texture; ones where there is none."""
    one = spread(ONE, point.u)
    if index < 0:
        return Color(one, one, one), one
    return _found(textures[index], texels, point)


@kernel
def _color3(row) -> Color:
    return Color(row[0], row[1], row[2])


@kernel
def glass_share(material, point: SurfacePoint, textures, texels) -> np.float32:
    """The share of light that meets the inside of a material, of what its microfacets let through: not its matte base, nor metal."""
    if material["kind"] == DIELECTRIC:
        return ONE
    return _glass_share(layer_row(material), point, textures, texels)


@kernel
def _glass_share(row, point: SurfacePoint, textures, texels) -> np.float32:
    if row is None:
        return ZERO
    if row["layers"] & VOLUME == 0:
        return ZERO
    return _let_in(row, point, textures, texels)


@outlined
def _let_in(row, point: SurfacePoint, textures, texels) -> np.float32:
    t, _ = _looked_up(row["transmission_texture"], point, textures, texels)
    rough, _ = _looked_up(row["metallic_roughness_texture"], point, textures, texels)
    return row["transmission"] * t.r * (ONE - row["metallic"] * rough.b)


@kernel
def interface_alpha(material, point: SurfacePoint, textures, texels) -> np.float32:
    """GGX's alpha of the surface of a medium: roughness squared, times the texture that a glTF material may have for it."""
    return _interface_alpha(layer_row(material), material, point, textures, texels)


@kernel
def _interface_alpha(row, material, point: SurfacePoint, textures, texels) -> np.float32:
    roughness = material["roughness"]
    if row is not None:
        rough, _ = _looked_up(row["metallic_roughness_texture"], point, textures, texels)
        roughness = roughness * rough.g
    return roughness * roughness


@kernel
def sheet_veil(material, point: SurfacePoint, wi: Vec3, alpha: np.float32, textures, texels) -> Color:
    """What is left of light along wi that goes straight through a surface; `alpha`: its coverage. Through a rough sheet, nothing does."""
    clear = ONE - alpha
    return _sheet_veil(layer_row(material), point, wi, clear, textures, texels)


@kernel
def _sheet_veil(row, point: SurfacePoint, wi: Vec3, clear: np.float32, textures, texels) -> Color:
    left = Color(clear, clear, clear)
    if row is None:
        return left
    if row["layers"] & SHEET == 0:
        return left
    if _interface_alpha(row, row, point, textures, texels) > _POLISHED:
        return left
    c, _ = _looked_up(row["color_texture"], point, textures, texels)
    kept = row["dielectric_f0"] + (ONE - row["dielectric_f0"]) * schlick_weight(abs(dot(point.ns, wi)))
    if row["layers"] & SPECULAR_LAYER != 0:
        kept = kept * row["specular_factor"]
    passed = _let_in(row, point, textures, texels) * (ONE - kept) * (ONE - clear)
    return left + _color3(row["color"]) * point.color * c * passed


@kernel
def _direction(material, ns: Vec3, point: SurfacePoint, textures, texels):
    """(unit tangent along which highlights are drawn out, strength); 0 where the surface has no direction."""
    x, y = material["anisotropy_direction"][0], material["anisotropy_direction"][1]
    c, _ = _looked_up(material["anisotropy_texture"], point, textures, texels)
    along, aside = spread(ONE, point.u), spread(ZERO, point.u)
    if material["anisotropy_texture"] >= 0:
        along, aside = c.r * _TWO - ONE, c.g * _TWO - ONE
    flat = point.tangent - ns * dot(ns, point.tangent)
    has_direction = dot(flat, flat) > ZERO
    t = normalize(flat)
    b = cross(ns, t) * point.bitangent_sign
    # The texture's direction, turned.
    turned = t * (along * x - aside * y) + b * (along * y + aside * x)
    has_direction = has_direction & (dot(turned, turned) > _LEAST_DIRECTION)
    strength = where(has_direction, material["anisotropy"] * c.b, ZERO)
    # Any direction does where the strength is 0.
    up, right = spread3(Vec3(ZERO, ONE, ZERO), point.u), spread3(Vec3(ONE, ZERO, ZERO), point.u)
    upright = where(abs(ns.y) < f32(0.9), up, right)
    return where(has_direction, normalize(turned), normalize(cross(ns, upright))), strength


@outlined
def resolve_layers(
    material, point: SurfacePoint, ns: Vec3, base: Color, metallic: np.float32, alpha: np.float32, occlusion: np.float32, textures, texels
) -> Layered:
    """The lobes of a glTF material with extensions; `alpha`: of its microfacets, its roughness squared."""
    bits = material["layers"]
    zero, one = spread(ZERO, point.u), spread(ONE, point.u)
    plain = spread(material["dielectric_f0"], point.u)
    straight, grazing = Color(plain, plain, plain), one
    if bits & SPECULAR_LAYER != 0:
        _, factor = _looked_up(material["specular_factor_texture"], point, textures, texels)
        color, _ = _looked_up(material["specular_texture"], point, textures, texels)
        tinted = straight * _color3(material["specular"]) * color
        grazing = material["specular_factor"] * factor
        straight = Color(min(tinted.r, ONE), min(tinted.g, ONE), min(tinted.b, ONE)) * grazing
    matte = ONE - metallic
    f0 = straight * matte + base * metallic
    diffuse = base * matte
    # Through
    t, _ = _looked_up(material["transmission_texture"], point, textures, texels)
    transmission = material["transmission"] * t.r
    through, diffuse = diffuse * transmission, diffuse * (ONE - transmission)
    behind = Color(zero, zero, zero)
    if bits & BEHIND != 0:
        _, factor = _looked_up(material["behind_texture"], point, textures, texels)
        color, _ = _looked_up(material["behind_color_texture"], point, textures, texels)
        share = material["behind"] * factor
        behind = color * _color3(material["behind_color"]) * (matte * (ONE - transmission) * share)
        diffuse = diffuse * (ONE - share)
    # The film
    film, thickness = zero, zero
    if bits & FILM != 0:
        c, _ = _looked_up(material["film_texture"], point, textures, texels)
        film = material["film"] * c.r
        thickness = zero + material["film_thickness"][1]
        if material["film_thickness_texture"] >= 0:
            c, _ = _looked_up(material["film_thickness_texture"], point, textures, texels)
            thickness = lerp(material["film_thickness"][0], material["film_thickness"][1], c.g)
    tangent, along = no_layers(point.u).tangent, alpha
    if bits & ANISOTROPY != 0:
        tangent, strength = _direction(material, ns, point, textures, texels)
        along = lerp(alpha, ONE, strength * strength)
    coat, coat_alpha, coat_normal = zero, zero, ns
    if bits & COAT != 0:
        c, _ = _looked_up(material["coat_texture"], point, textures, texels)
        coat = material["coat"] * c.r
        c, _ = _looked_up(material["coat_roughness_texture"], point, textures, texels)
        coat_alpha = material["coat_roughness"] * c.g
        coat_alpha = coat_alpha * coat_alpha
        coat_normal = point.ns
        if material["coat_normal_texture"] >= 0:
            c, _ = _looked_up(material["coat_normal_texture"], point, textures, texels)
            coat_normal = mapped_normal(c, material["coat_normal_scale"], point)
    sheen, sheen_alpha = Color(zero, zero, zero), zero
    if bits & SHEEN != 0:
        c, _ = _looked_up(material["sheen_texture"], point, textures, texels)
        sheen = _color3(material["sheen"]) * c
        _, a = _looked_up(material["sheen_roughness_texture"], point, textures, texels)
        sheen_alpha = material["sheen_roughness"] * a
        sheen_alpha = sheen_alpha * sheen_alpha
    shield = max_component(straight)
    ambient = (diffuse + behind) * (ONE - shield) + f0
    if bits & SHEEN != 0:
        level = sheen_sent_on(sheen_alpha, _HALF + zero)
        ambient = ambient * (ONE - max_component(sheen) * level) + sheen * level
    mirrored = coat * _COAT_F0
    ambient = (ambient * (ONE - mirrored) + Color(mirrored, mirrored, mirrored)) * occlusion
    eta, k = Color(ZERO, ZERO, ZERO), Color(ZERO, ZERO, ZERO)
    if bits & CONDUCTOR != 0:
        eta, k = _color3(material["eta"]), _color3(material["k"])
    f90 = max(grazing * matte, zero) + metallic
    layers = Layers(
        f90, shield, grazing, through, behind, coat, coat_alpha, coat_normal, sheen, sheen_alpha, tangent, along, film, thickness,
        material["film_ior"], eta, k, ZERO,
    )  # fmt: skip
    return Layered(diffuse, f0, ambient, layers)
