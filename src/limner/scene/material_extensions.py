"""What a `MetallicRoughness` may have beyond the core of glTF: a coat, a sheen, an inside, each a part that is there or is not.

    MetallicRoughness(base_color=(0.6, 0.0, 0.0), metallic=0.5, clearcoat=Clearcoat(roughness=0.1))     lacquer

Every part has the quantities, the channels and the units of the glTF extension it is named after. Where a texture is given, the channel
that is named multiplies the number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias, get_args

import numpy as np

from ..errors import SceneError
from ._values import Triple, finite, positive, triple, unit_interval
from .procedural import Pattern
from .texture import AnyTexture, Texture

__all__ = [
    "Anisotropy", "Clearcoat", "Conductor", "DiffuseTransmission", "Iridescence", "Part", "Sheen", "Specular", "Transmission", "Volume",
]  # fmt: skip

_WHITE: Triple = (1.0, 1.0, 1.0)
_RGB_WAVELENGTHS = (630.0, 532.0, 465.0)


def _check(part: Any, *shares: str) -> None:
    """Check the textures of a part, and that the fields `shares` lie in [0, 1]."""
    kind = type(part).__name__
    for field in shares:
        _put(part, field, unit_interval(getattr(part, field), f"{_word(kind)}.{field}"))
    for field, value in vars(part).items():
        if field.endswith("texture") and not isinstance(value, (Texture, *get_args(Pattern), type(None))):
            raise SceneError(f"{_word(kind)}.{field} must be a Texture or a pattern, got {type(value).__name__}")


def _word(kind: str) -> str:
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in kind).lstrip("_")


def _put(part: Any, field: str, value: Any) -> None:
    object.__setattr__(part, field, value)


def _put_color(part: Any, field: str, most: float = float("inf")) -> None:
    name = f"{_word(type(part).__name__)}.{field}"
    color = triple(getattr(part, field), name, minimum=0.0)
    if max(color) > most:
        raise SceneError(f"{name} must lie in [0, {most:g}], got {color}")
    _put(part, field, color)


def _put_length(part: Any, field: str) -> None:
    name = f"{_word(type(part).__name__)}.{field}"
    length = finite(getattr(part, field), name)
    if length < 0.0:
        raise SceneError(f"{name} must not be below 0, got {length}")
    _put(part, field, length)


@dataclass(frozen=True)
class Clearcoat:
    """A thin coat of lacquer over everything else (KHR_materials_clearcoat): a dielectric of index 1.5.

    Parameters
    ----------
    factor : float in [0, 1]
        How much of it there is.
    roughness : float in [0, 1]
    factor_texture, roughness_texture : Texture or pattern, optional
        Red; green.
    normal_texture, normal_scale : Texture, optional, and float
        The coat's own normals. None: those of the surface, without its normal map.
    """

    factor: float = 1.0
    roughness: float = 0.0
    factor_texture: AnyTexture | None = None
    roughness_texture: AnyTexture | None = None
    normal_texture: AnyTexture | None = None
    normal_scale: float = 1.0

    def __post_init__(self) -> None:
        _check(self, "factor", "roughness")
        _put(self, "normal_scale", finite(self.normal_scale, "clearcoat.normal_scale"))


@dataclass(frozen=True)
class Sheen:
    """Fibres that stand up from the surface (KHR_materials_sheen): velvet is brightest where it is seen from the side.

    Parameters
    ----------
    color : three floats in [0, 1]
    roughness : float in [0, 1]
    color_texture, roughness_texture : Texture or pattern, optional
        Its colour, sRGB-encoded; alpha.
    """

    color: Triple = _WHITE
    roughness: float = 0.0
    color_texture: AnyTexture | None = None
    roughness_texture: AnyTexture | None = None

    def __post_init__(self) -> None:
        _put_color(self, "color", 1.0)
        _check(self, "roughness")


@dataclass(frozen=True)
class Specular:
    """How strongly, and in which colour, what is no metal reflects (KHR_materials_specular).

    Parameters
    ----------
    factor : float in [0, 1]
        Of the reflection as a whole.
    color : three floats >= 0
        Of the reflection straight on, F0, which stays below 1; at grazing angles everything is reflected.
    factor_texture, color_texture : Texture or pattern, optional
        Alpha; its colour, sRGB-encoded.
    """

    factor: float = 1.0
    color: Triple = _WHITE
    factor_texture: AnyTexture | None = None
    color_texture: AnyTexture | None = None

    def __post_init__(self) -> None:
        _put_color(self, "color")
        _check(self, "factor")


@dataclass(frozen=True)
class Transmission:
    """Light that goes through the surface instead of being scattered below it (KHR_materials_transmission).

    Parameters
    ----------
    factor : float in [0, 1]
        The share of what is not reflected.
    factor_texture : Texture or pattern, optional
        Red.
    """

    factor: float = 1.0
    factor_texture: AnyTexture | None = None

    def __post_init__(self) -> None:
        _check(self, "factor")


@dataclass(frozen=True)
class Volume:
    """What is between the surfaces of a closed shape (KHR_materials_volume).

    Parameters
    ----------
    thickness : float >= 0
        Below the surface, in the units of the mesh, for those who do not follow light through it. 0: the surface is a thin sheet.
    thickness_texture : Texture or pattern, optional
        Green.
    attenuation_distance : float > 0, optional
        In metres, after which white light has the colour `attenuation_color`. None: nothing is absorbed.
    attenuation_color : three floats in [0, 1]
    """

    thickness: float = 0.0
    thickness_texture: AnyTexture | None = None
    attenuation_distance: float | None = None
    attenuation_color: Triple = _WHITE

    def __post_init__(self) -> None:
        _put_length(self, "thickness")
        if self.attenuation_distance is not None:
            _put(self, "attenuation_distance", positive(self.attenuation_distance, "volume.attenuation_distance"))
        _put_color(self, "attenuation_color", 1.0)
        _check(self)


@dataclass(frozen=True)
class Anisotropy:
    """Highlights that are drawn out in one direction, as on brushed metal (KHR_materials_anisotropy).

    Parameters
    ----------
    strength : float in [0, 1]
    rotation : float
        Of that direction, in radians, counter-clockwise from the tangent.
    texture : Texture or pattern, optional
        The direction in red and green, as in a normal map; blue multiplies `strength`.
    """

    strength: float = 1.0
    rotation: float = 0.0
    texture: AnyTexture | None = None

    def __post_init__(self) -> None:
        _put(self, "rotation", finite(self.rotation, "anisotropy.rotation"))
        _check(self, "strength")


@dataclass(frozen=True)
class Iridescence:
    """A film so thin that the colours of a reflection depend on the angle (KHR_materials_iridescence): soap, oil on water.

    Parameters
    ----------
    factor : float in [0, 1]
    ior : float >= 1
        Of the film.
    thickness_minimum, thickness_maximum : floats >= 0
        In nanometres, where the texture is 0 and where it is 1; without one the film is as thick as the second says.
    factor_texture, thickness_texture : Texture or pattern, optional
        Red; green.
    """

    factor: float = 1.0
    ior: float = 1.3
    thickness_minimum: float = 100.0
    thickness_maximum: float = 400.0
    factor_texture: AnyTexture | None = None
    thickness_texture: AnyTexture | None = None

    def __post_init__(self) -> None:
        _put(self, "ior", finite(self.ior, "iridescence.ior"))
        if self.ior < 1.0:
            raise SceneError(f"iridescence.ior must be at least 1, got {self.ior}")
        _put_length(self, "thickness_minimum")
        _put_length(self, "thickness_maximum")
        _check(self, "factor")


@dataclass(frozen=True)
class DiffuseTransmission:
    """Light that is scattered through to the other side (KHR_materials_diffuse_transmission): leaves, paper, lampshades.

    Parameters
    ----------
    factor : float in [0, 1]
        The share of what is scattered.
    color : three floats >= 0
    factor_texture, color_texture : Texture or pattern, optional
        Alpha; its colour, sRGB-encoded.
    """

    factor: float = 1.0
    color: Triple = _WHITE
    factor_texture: AnyTexture | None = None
    color_texture: AnyTexture | None = None

    def __post_init__(self) -> None:
        _put_color(self, "color")
        _check(self, "factor")


@dataclass(frozen=True)
class Conductor:
    """A metal by its measured index of refraction, eta - i k; no extension of glTF.

    Parameters
    ----------
    eta, k : three floats > 0 and >= 0
        At 630, 532 and 465 nm, for red, green and blue.

    >>> Conductor.named("gold").k[0] > Conductor.named("gold").k[2]
    True
    """

    eta: Triple
    k: Triple

    def __post_init__(self) -> None:
        _put_color(self, "eta")
        _put_color(self, "k")
        if min(self.eta) <= 0.0:
            raise SceneError(f"conductor.eta must be positive, got {self.eta}")

    @classmethod
    def of_spectra(cls, wavelengths: Any, n: Any, k: Any) -> Conductor:
        """What was measured over the wavelengths (n,), ascending, in nm, at those that stand for red, green and blue.

        >>> Conductor.of_spectra([400, 500, 700], [1.0, 2.0, 1.0], [3.0, 3.0, 3.0]).eta
        (1.35, 1.84, 1.65)
        """
        eta, extinction = (np.interp(_RGB_WAVELENGTHS, wavelengths, curve).tolist() for curve in (n, k))
        return cls(tuple(eta), tuple(extinction))

    @classmethod
    def named(cls, metal: str) -> Conductor:
        """A metal that has been measured, by its name in `limner.color.metals.METALS`: "aluminium", "copper", "gold", "silver", …"""
        # Read on use, so that whoever describes a scene without metals reads no tables.
        from ..color.metals import measured_metal

        return cls.of_spectra(*measured_metal(metal))


Part: TypeAlias = Anisotropy | Clearcoat | Conductor | DiffuseTransmission | Iridescence | Sheen | Specular | Transmission | Volume
