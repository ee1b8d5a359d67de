"""What a material has beyond a base under microfacets, as numbers of its row: coat, sheen, film, what goes through.

A row's `layers` says which of them it has, so that the kernels ask once, and a material without any costs nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..scene.material import Dielectric, Lambert, Material, MetallicRoughness
from ..scene.texture import AnyTexture
from . import layouts

__all__ = ["attenuation_of", "dielectric_f0", "dispersion_of", "fill_layers", "fill_rough_matte", "fills_shape"]

_Row = Callable[[AnyTexture | None], int]


def dielectric_f0(ior: float) -> float:
    """``((ior - 1) / (ior + 1))^2``: what is reflected straight on; 1 for the index 0, which glTF writes for infinity."""
    return 1.0 if ior == 0.0 else ((ior - 1.0) / (ior + 1.0)) ** 2


def fills_shape(material: Material) -> bool:
    """Whether light goes into a closed shape of this material, and is bent."""
    if isinstance(material, Dielectric):
        return True
    if not isinstance(material, MetallicRoughness) or not _lets_through(material):
        return False
    return material.volume is not None and material.volume.thickness > 0.0


def _lets_through(material: MetallicRoughness) -> bool:
    return material.transmission is not None and material.transmission.factor > 0.0 and not material.unlit


def attenuation_of(material: MetallicRoughness) -> tuple[float, float, float]:
    """Per metre, so that white light has the attenuation colour after the attenuation distance (Beer's law)."""
    volume = material.volume
    if volume is None or volume.attenuation_distance is None:
        return 0.0, 0.0, 0.0
    r, g, b = (-math.log(max(c, 1e-6)) / volume.attenuation_distance for c in volume.attenuation_color)
    return abs(r), abs(g), abs(b)


def dispersion_of(material: MetallicRoughness) -> float:
    """Half the difference of the indices for blue and red (KHR_materials_dispersion)."""
    return (material.ior - 1.0) * 0.025 * material.dispersion


def fill_layers(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    """Fill what a glTF material has beyond its core; `row_of`: the row of a texture."""
    row["dielectric_f0"] = dielectric_f0(material.ior)
    if material.unlit:
        return
    layers = layouts.COMPENSATED if material.energy_compensation else 0
    for has, fill, bit in _PARTS:
        if has(material):
            fill(row, material, row_of)
            layers |= bit
    if _lets_through(material):
        layers |= layouts.VOLUME if fills_shape(material) else layouts.SHEET
        if material.alpha_mode == "opaque":
            # Rays that look for lights must stop and see that there is a way through.
            row["alpha_mode"] = layouts.BLEND
            layers |= layouts.SOLID
    row["layers"] = layers


def fill_rough_matte(row: np.void, material: Lambert) -> None:
    """Oren and Nayar's roughness."""
    if material.roughness_degrees > 0.0:
        row["matte_roughness"], row["layers"] = math.radians(material.roughness_degrees), layouts.ROUGH_MATTE


def _fill_specular(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    assert material.specular is not None
    row["specular_factor"], row["specular"] = material.specular.factor, material.specular.color
    row["specular_factor_texture"] = row_of(material.specular.factor_texture)
    row["specular_texture"] = row_of(material.specular.color_texture)


def _fill_coat(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    coat = material.clearcoat
    assert coat is not None
    row["coat"], row["coat_roughness"], row["coat_normal_scale"] = coat.factor, coat.roughness, coat.normal_scale
    row["coat_texture"], row["coat_roughness_texture"] = row_of(coat.factor_texture), row_of(coat.roughness_texture)
    row["coat_normal_texture"] = row_of(coat.normal_texture)


def _fill_sheen(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    assert material.sheen is not None
    row["sheen"], row["sheen_roughness"] = material.sheen.color, material.sheen.roughness
    row["sheen_texture"], row["sheen_roughness_texture"] = row_of(material.sheen.color_texture), row_of(material.sheen.roughness_texture)


def _fill_anisotropy(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    part = material.anisotropy
    assert part is not None
    row["anisotropy"], row["anisotropy_direction"] = part.strength, (math.cos(part.rotation), math.sin(part.rotation))
    row["anisotropy_texture"] = row_of(part.texture)


def _fill_film(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    film = material.iridescence
    assert film is not None
    row["film"], row["film_ior"] = film.factor, film.ior
    row["film_thickness"] = film.thickness_minimum, film.thickness_maximum
    row["film_texture"], row["film_thickness_texture"] = row_of(film.factor_texture), row_of(film.thickness_texture)


def _fill_transmission(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    assert material.transmission is not None
    row["transmission"], row["transmission_texture"] = material.transmission.factor, row_of(material.transmission.factor_texture)


def _fill_behind(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    part = material.diffuse_transmission
    assert part is not None
    row["behind"], row["behind_color"] = part.factor, part.color
    row["behind_texture"], row["behind_color_texture"] = row_of(part.factor_texture), row_of(part.color_texture)


def _fill_conductor(row: np.void, material: MetallicRoughness, row_of: _Row) -> None:
    assert material.conductor is not None
    row["eta"], row["k"] = material.conductor.eta, material.conductor.k


_PARTS: tuple[tuple[Callable[[MetallicRoughness], bool], Callable[..., None], int], ...] = (
    (lambda m: m.specular is not None, _fill_specular, layouts.SPECULAR_LAYER),
    (lambda m: m.clearcoat is not None and m.clearcoat.factor > 0.0, _fill_coat, layouts.COAT),
    (lambda m: m.sheen is not None and max(m.sheen.color) > 0.0, _fill_sheen, layouts.SHEEN),
    (lambda m: m.anisotropy is not None and m.anisotropy.strength > 0.0, _fill_anisotropy, layouts.ANISOTROPY),
    (lambda m: m.iridescence is not None and m.iridescence.factor > 0.0, _fill_film, layouts.FILM),
    (_lets_through, _fill_transmission, 0),
    (lambda m: m.diffuse_transmission is not None and m.diffuse_transmission.factor > 0.0, _fill_behind, layouts.BEHIND),
    (lambda m: m.conductor is not None, _fill_conductor, layouts.CONDUCTOR),
)
