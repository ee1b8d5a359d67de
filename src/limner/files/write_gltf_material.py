"""Materials and textures into glTF (glTF 2.0, sections 3.8 and 3.9).

`MetallicRoughness` is glTF's own material and is written as it is. All others become the nearest one, which a note says; glass keeps its
index of refraction and its colour in depth by extensions.

    Lambert      a dielectric without gloss
    BlinnPhong   base colour, metallic and roughness whose highlight is as bright and as wide
    Dielectric   KHR_materials_transmission, _ior and _volume

What a `MetallicRoughness` has beyond the core is an extension each (`gltf_material_parts`). Its variants are materials of their own, to
which the primitives that show it refer (KHR_materials_variants).

Emission beyond 1 is a factor times KHR_materials_emissive_strength, a power of two, so that their product is exact.
"""

from __future__ import annotations

import dataclasses
import hashlib
import math
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..color.metals import normal_reflectance
from ..color.transfer import linear_from_srgb, srgb_from_linear
from ..image.png import png_bytes
from ..scene._values import Triple
from ..scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, Material, MetallicRoughness, ShadowCatcher
from ..scene.texture import AnyTexture, Texels, Texture
from .gltf_material_parts import DISPERSION, IOR, NORMAL_SCALE, PARTS, Part
from .notes import Notes
from .world_parts import base_color
from .write_gltf_buffers import Json
from .write_gltf_exact import given_transform

__all__ = ["TEXTURES", "VARIANTS", "Materials", "identity", "nearest", "picture_of", "plain_text", "strength_for"]

TEXTURES = {
    "base_color_texture": "pbrMetallicRoughness/baseColorTexture",
    "metallic_roughness_texture": "pbrMetallicRoughness/metallicRoughnessTexture",
    "normal_texture": "normalTexture",
    "occlusion_texture": "occlusionTexture",
    "emissive_texture": "emissiveTexture",
}
VARIANTS = "KHR_materials_variants"
_NUMBERED = re.compile(r" \(\d+\)$")
_LEFT_OUT = ("specular_texture", "bump_texture", "alpha_texture", "energy_compensation", "roughness_degrees")
_COLORED = frozenset({"base_color_texture", "emissive_texture"})
_WRAPS = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
_FILTERS = {"nearest": (9728, 9728), "bilinear": (9729, 9729), "trilinear": (9729, 9987)}
_ALPHA_MODES = {"mask": "MASK", "blend": "BLEND"}
_DEFAULT = MetallicRoughness()
_DIELECTRIC = 0.04  # what glTF's dielectrics mirror, seen straight


def identity(material: Material) -> Any:
    """What equal materials share; one that holds lists is equal to itself alone."""
    try:
        hash(material)
    except TypeError:
        return id(material)
    return material


def strength_for(greatest: float) -> float:
    """The least power of two, at least 1, that a number is not above.

    >>> strength_for(0.5), strength_for(2.0), strength_for(5.0)
    (1.0, 2.0, 8.0)
    """
    if greatest <= 1.0:
        return 1.0
    mantissa, exponent = math.frexp(greatest)
    return math.ldexp(1.0, exponent - (mantissa == 0.5))


def nearest(material: Material) -> MetallicRoughness:
    """The MetallicRoughness of glTF that looks most like a material; itself where it is one."""
    if isinstance(material, MetallicRoughness):
        return _without_conductor(material)
    if isinstance(material, BlinnPhong):
        return _from_blinn_phong(material)
    common: dict[str, Any] = {
        "name": material.name, "metallic": 0.0, "double_sided": material.double_sided, "alpha": material.alpha,
        "alpha_mode": material.alpha_mode, "alpha_cutoff": material.alpha_cutoff, "emission": material.emission,
    }  # fmt: skip
    if isinstance(material, Lambert):
        return MetallicRoughness(
            base_color=material.color, base_color_texture=material.texture, emissive_texture=material.emission_texture,
            normal_texture=material.normal_texture, normal_scale=material.normal_scale, **common,
        )  # fmt: skip
    if isinstance(material, Dielectric):
        glass = common | {"alpha": 1.0, "alpha_mode": "opaque", "roughness": material.roughness}
        return MetallicRoughness(base_color=material.tint, base_color_texture=material.tint_texture, **glass)
    if isinstance(material, CoolToWarm):
        return MetallicRoughness(base_color=_mapped(lambda a, b: (a + b) / 2.0, material.cool, material.warm), **common)
    color = (0.0, 0.0, 0.0) if isinstance(material, ShadowCatcher) else base_color(material)
    return MetallicRoughness(base_color=color, **common)


def picture_of(texture: AnyTexture | None) -> Texture | None:
    """A texture, if it is one that glTF can hold: a picture that is looked up by texture coordinates."""
    return texture if isinstance(texture, Texture) and texture.mapping == "uv" else None


def _mapped(function: Callable[..., float], *colors: Triple) -> Triple:
    red, green, blue = (function(*channels) for channels in zip(*colors, strict=True))
    return red, green, blue


def _from_blinn_phong(material: BlinnPhong) -> MetallicRoughness:
    """Take the highlight for a mirror that is not quite smooth.

    A normalised highlight of ks reflects ks, seen straight, and one without normalisation ``8 ks / (p + 2)``; with the mirror that is s.
    Then base colour b and metallic m are looked for so that diffuse light and mirrored light are kept in the strongest channel:
    ``d = b (1 - m)`` and ``s = 0.04 (1 - m) + b m``. With k = 1 - m that is ``0.04 k^2 - (d + s) k + d = 0``. The width is
    ``alpha^2 = 2 / (p + 2)``, and roughness the root of alpha.

    **Source**: Walter, Marschner, Li, Torrance, *Microfacet Models for Refraction through Rough Surfaces*, EGSR 2007, 5.2
    (``p = 2 / alpha^2 - 2``); glTF 2.0, appendix B.
    """
    gain = 1.0 if material.normalized else 8.0 / (material.exponent + 2.0)
    mirrored = _mapped(lambda s, m: min(gain * s + m, 1.0), material.specular, material.mirror)
    d, s = max(material.diffuse), max(mirrored)
    share = 1.0
    if s > _DIELECTRIC:
        share = ((d + s) - math.sqrt(max((d + s) ** 2 - 4.0 * _DIELECTRIC * d, 0.0))) / (2.0 * _DIELECTRIC)
    share = min(max(share, 0.0), 1.0)
    glossy = max(mirrored) > 0.0
    width = 0.0 if max(material.mirror) > gain * max(material.specular) else math.sqrt(2.0 / (material.exponent + 2.0))
    color = material.diffuse if share == 1.0 else _mapped(lambda a, b: max(a + b - _DIELECTRIC * share, 0.0), material.diffuse, mirrored)
    return MetallicRoughness(
        base_color=color, metallic=1.0 - share, roughness=math.sqrt(width) if glossy else 1.0,
        base_color_texture=material.diffuse_texture, emission=material.emission, emissive_texture=material.emission_texture,
        normal_texture=material.normal_texture, normal_scale=material.normal_scale, name=material.name,
        double_sided=material.double_sided, alpha=material.alpha, alpha_mode=material.alpha_mode, alpha_cutoff=material.alpha_cutoff,
    )  # fmt: skip


def _without_conductor(material: MetallicRoughness) -> MetallicRoughness:
    """A metal by the colour that it reflects straight on."""
    metal = material.conductor
    if metal is None:
        return material
    red, green, blue = (normal_reflectance(n, k) * c for n, k, c in zip(metal.eta, metal.k, material.base_color, strict=True))
    return dataclasses.replace(material, base_color=(red, green, blue), conductor=None)


def _without_variants(material: Material) -> Material:
    varied = isinstance(material, MetallicRoughness) and material.variants
    return dataclasses.replace(material, variants=()) if varied else material  # type: ignore[arg-type]


class Materials:
    """The materials, textures, samplers and pictures of one file; what is equal is written once.

    Parameters
    ----------
    store : callable
        Takes an encoded PNG and its name, and returns where it is, as an image of glTF says it.
    moving : mapping
        The names of materials that are animated, with what is: of each field the greatest number that it takes.
    """

    def __init__(self, store: Callable[[bytes, str], Json], notes: Notes, moving: Mapping[str, Mapping[str, float]]) -> None:
        self._store = store
        self._notes = notes
        self._moving = moving
        self.materials: list[Json] = []
        self.textures: list[Json] = []
        self.samplers: list[Json] = []
        self.images: list[Json] = []
        self.variants: list[Json] = []
        self.extensions: set[str] = set()
        self._sources: list[tuple[Material, MetallicRoughness]] = []
        self._known: dict[Any, int] = {}
        self._pictures: dict[tuple[Any, ...], int] = {}

    def index_of(self, material: Material) -> int | None:
        """The number of a material; None for glTF's default one, which is not written."""
        material = _without_variants(material)
        return None if material == _DEFAULT and material.name not in self._moving else self._number(material)

    def mappings(self, material: Material) -> Json:
        """What a primitive says of the variants of its material, as an extension; nothing where there are none."""
        found = material.variants if isinstance(material, MetallicRoughness) else ()
        if not found:
            return {}
        rows: dict[int, list[int]] = {}
        for variant in found:
            index = self._number(_without_variants(variant.material))
            rows.setdefault(index, []).append(_number_of(self.variants, {"name": plain_text(variant.name)}))
        self.extensions.add(VARIANTS)
        return {"extensions": {VARIANTS: {"mappings": [{"material": index, "variants": names} for index, names in rows.items()]}}}

    def _number(self, material: Material) -> int:
        key = identity(material)
        if key not in self._known:
            made = nearest(material)
            if getattr(material, "conductor", None) is not None:
                self._notes.add("conductor is written as the colour that it reflects straight on", material.name)
            elif made is not material:
                self._notes.add(f"{type(material).__name__} is written as the nearest metallic-roughness material", material.name)
            for field in _LEFT_OUT:
                if getattr(material, field, None):
                    self._notes.add(f"{field} is left out: glTF has none", material.name)
            self._known[key] = len(self.materials)
            self._sources.append((material, made))
            self.materials.append(self._described(made) | self._glass(material))
        return self._known[key]

    def named(self, name: str) -> list[tuple[int, Material, MetallicRoughness]]:
        """The materials of a name: number, as it was given, as it was written."""
        return [(index, given, made) for index, (given, made) in enumerate(self._sources) if given.name == name]

    def strength(self, index: int) -> float:
        """What the emissive factor of a material is multiplied by."""
        extension = self.materials[index].get("extensions", {}).get("KHR_materials_emissive_strength", {})
        return float(extension.get("emissiveStrength", 1.0))

    def uv_sets(self, index: int) -> list[int]:
        """The texture coordinates that a material looks at."""
        made = self._sources[index][1]
        parts = [(getattr(made, part.field), part) for part in PARTS]
        given = [getattr(value, field) for value, part in parts if value is not None for field, _ in part.textures.values()]
        textures = [picture_of(texture) for texture in (*(getattr(made, field) for field in TEXTURES), *given)]
        return sorted({texture.uv_set for texture in textures if texture is not None})

    def _described(self, material: MetallicRoughness) -> Json:
        moving = self._moving.get(material.name, {})
        made: Json = {}
        # The reader tells animated materials of one name apart by their numbers, which are not for another file.
        name = _NUMBERED.sub("", material.name) if moving else material.name
        if name:
            made["name"] = plain_text(name)
        core = self._core(material, moving)
        if core:
            made["pbrMetallicRoughness"] = core
        for key, field, factor, value in (
            ("normalTexture", "normal_texture", "scale", material.normal_scale),
            ("occlusionTexture", "occlusion_texture", "strength", material.occlusion_strength),
        ):  # fmt: skip
            information = self._information(material, field, moving)
            if information is not None:
                made[key] = information | ({factor: value} if value != 1.0 else {})
        made |= self._emission(material, moving)
        if material.alpha_mode != "opaque":
            made["alphaMode"] = _ALPHA_MODES[material.alpha_mode]
        if material.alpha_mode == "mask" and material.alpha_cutoff != 0.5:
            made["alphaCutoff"] = material.alpha_cutoff
        if material.double_sided:
            made["doubleSided"] = True
        if material.unlit:
            self._extend(made, "KHR_materials_unlit", {})
        self._write_parts(made, material, moving)
        return made

    def _write_parts(self, made: Json, material: MetallicRoughness, moving: Mapping[str, float]) -> None:
        for extension, key, value, usual in ((IOR, "ior", material.ior, 1.5), (DISPERSION, "dispersion", material.dispersion, 0.0)):
            if value != usual or key in moving:
                self._extend(made, extension, {key: value})
        for part in PARTS:
            value = getattr(material, part.field)
            if value is not None:
                self._extend(made, part.extension, self._part(value, part, material.name, moving))

    def _part(self, value: Any, part: Part, name: str, moving: Mapping[str, float]) -> Json:
        made: Json = {}
        for key, (field, usual) in (*part.numbers.items(), *part.colors.items()):
            held = getattr(value, field)
            if held != usual or (held is not None and f"{part.field}.{field}" in moving):
                made[key] = list(held) if isinstance(held, tuple) else held
        for key, (field, srgb) in part.textures.items():
            is_animated = any(moved.startswith(f"{part.field}.{field}.") for moved in moving)
            information = self._texture_information(getattr(value, field), colored=srgb, name=name, is_animated=is_animated)
            if information is not None:
                scale = getattr(value, NORMAL_SCALE) if field == "normal_texture" else 1.0
                made[key] = information | ({"scale": scale} if scale != 1.0 else {})
        return made

    def _core(self, material: MetallicRoughness, moving: Mapping[str, float]) -> Json:
        made: Json = {}
        color = (*(min(channel, 1.0) for channel in material.base_color), material.alpha)
        if max(material.base_color) > 1.0:
            self._notes.add("a base colour above 1 is written as 1", material.name)
        if color != (1.0, 1.0, 1.0, 1.0):
            made["baseColorFactor"] = list(color)
        for key, value in (("metallicFactor", material.metallic), ("roughnessFactor", material.roughness)):
            if value != 1.0:
                made[key] = value
        for key, field in (("baseColorTexture", "base_color_texture"), ("metallicRoughnessTexture", "metallic_roughness_texture")):
            information = self._information(material, field, moving)
            if information is not None:
                made[key] = information
        return made

    def _emission(self, material: MetallicRoughness, moving: Mapping[str, float]) -> Json:
        made: Json = {}
        information = self._information(material, "emissive_texture", moving)
        if information is not None:
            made["emissiveTexture"] = information
        strength = strength_for(max(*material.emission, moving.get("emission", 0.0)))
        if max(material.emission) > 0.0:
            made["emissiveFactor"] = [channel / strength for channel in material.emission]
        if strength > 1.0:
            self._extend(made, "KHR_materials_emissive_strength", {"emissiveStrength": strength})
        return made

    def _glass(self, material: Material) -> Json:
        """What glTF can say of the inside of things. A thickness it has to be told, for those who do not follow light."""
        if not isinstance(material, Dielectric):
            return {}
        made: Json = {}
        self._extend(made, "KHR_materials_transmission", {"transmissionFactor": 1.0})
        if material.ior >= 1.0:
            self._extend(made, "KHR_materials_ior", {"ior": material.ior})
        else:
            self._notes.add("an index of refraction below 1 is left out", material.name)
        densest = max(material.absorption)
        if densest > 0.0:
            color = [math.exp(-a / densest) for a in material.absorption]
            volume = {"thicknessFactor": 1.0, "attenuationDistance": 1.0 / densest, "attenuationColor": color}
            self._extend(made, "KHR_materials_volume", volume)
        if max(material.haze) > 0.0:
            self._notes.add("haze is left out", material.name)
        return made

    def _extend(self, owner: Json, name: str, fields: Json) -> None:
        owner.setdefault("extensions", {})[name] = fields
        self.extensions.add(name)

    # Textures

    def _information(self, material: MetallicRoughness, field: str, moving: Mapping[str, float]) -> Json | None:
        is_animated = any(key.startswith(f"{field}.") for key in moving)
        return self._texture_information(
            getattr(material, field), colored=field in _COLORED, name=material.name, is_animated=is_animated
        )

    def _texture_information(self, given: AnyTexture | None, *, colored: bool, name: str, is_animated: bool = False) -> Json | None:
        texture = picture_of(given)
        if texture is None:
            if given is not None:
                kind = "tri-planar mapping" if isinstance(given, Texture) else f"the pattern {type(given).__name__}"
                self._notes.add(f"{kind} is left out: glTF has pictures by texture coordinates only", name)
            return None
        made: Json = {"index": self._texture(texture, colored=colored, name=name)}
        if texture.uv_set:
            made["texCoord"] = texture.uv_set
        offset, rotation, scale = given_transform(texture.offset, texture.rotation, texture.scale)
        transform: Json = {}
        for key, value, default in (("offset", offset, (0.0, 0.0)), ("rotation", rotation, 0.0), ("scale", scale, (1.0, 1.0))):
            if value != default or is_animated:
                transform[key] = list(value) if isinstance(value, tuple) else value
        if transform:
            self._extend(made, "KHR_texture_transform", transform)
        return made

    def _texture(self, texture: Texture, *, colored: bool, name: str) -> int:
        if texture.filter not in _FILTERS:
            self._notes.add(f"{texture.filter} filtering is written as trilinear", name)
        magnify, shrink = _FILTERS.get(texture.filter, _FILTERS["trilinear"])
        sampler = {"magFilter": magnify, "minFilter": shrink, "wrapS": _WRAPS[texture.wrap_u], "wrapT": _WRAPS[texture.wrap_v]}
        source = self._picture(texture.texels, colored=colored, name=name)
        return _number_of(self.textures, {"sampler": _number_of(self.samplers, sampler), "source": source})

    def _picture(self, texels: Texels, *, colored: bool, name: str) -> int:
        """The number of a picture; one that is looked at as colours and as numbers is there twice only where it must be."""
        pixels: NDArray[Any] = np.asarray(texels.pixels)
        content = hashlib.blake2b(np.ascontiguousarray(pixels).data.cast("B"), digest_size=16).digest()
        key = content, pixels.shape, pixels.dtype.str, texels.srgb == colored, colored and texels.srgb != colored
        if key not in self._pictures:
            if pixels.dtype.kind == "f":
                self._notes.add("a texture of floats is written with 16 bits, clipped to [0, 1]", name)
            elif texels.srgb != colored:
                self._notes.add("a texture is encoded anew: glTF decides by its use whether it is sRGB", name)
            encoded = _encoded(pixels, texels.srgb, colored)
            image = self._store(png_bytes(np.ascontiguousarray(encoded[::-1])), texels.name)
            if texels.name:
                image["name"] = plain_text(texels.name)
            self._pictures[key] = len(self.images)
            self.images.append(image)
        return self._pictures[key]


def _encoded(pixels: NDArray[Any], srgb: bool, colored: bool) -> NDArray[Any]:
    """Texels as a PNG has them: 8 or 16 bits as they are; floats, and what changes its encoding, in 16 bits."""
    if pixels.dtype.kind == "u" and srgb == colored:
        return pixels
    greatest = np.iinfo(pixels.dtype).max if pixels.dtype.kind == "u" else 1.0
    values = np.clip(np.nan_to_num(pixels.astype(np.float64)) / greatest, 0.0, 1.0)
    if srgb != colored:
        values[..., :3] = (srgb_from_linear if colored else linear_from_srgb)(values[..., :3])
    return np.round(values * 65535.0).astype(np.uint16)


def _number_of(held: list[Json], wanted: Json) -> int:
    if wanted not in held:
        held.append(wanted)
    return held.index(wanted)


def plain_text(text: str) -> str:
    """A name that UTF-8 can hold.

    >>> plain_text("a\\ud800")
    'a?'
    """
    return text.encode("utf-8", "replace").decode()
