"""Surfaces of Mitsuba scenes as limner's materials.

    diffuse, roughdiffuse                 Lambert                         as it is; rough by Oren and Nayar's sigma
    dielectric, roughdielectric           Dielectric                      as it is, where nothing is coloured by reflection
    conductor, roughconductor             MetallicRoughness, metallic     alpha is the square of the roughness; by name: Schlick's Fresnel
    plastic, roughplastic, principled     MetallicRoughness               light that is caught below the coat is left out
    thindielectric                        an ideal mirror, mostly clear   the same at all angles
    twosided, mask, bumpmap, normalmap    fields of what is in them

A surface that is not `twosided` is black from behind in Mitsuba. limner has no such thing: it shows its back like its front, which makes a
difference only where the back is both seen and lit.

**Source**: the Mitsuba 3 documentation, *BSDFs*; Burley, *Physically Based Shading at Disney*, 2012, for alpha = roughness squared.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..errors import FileFormatError
from ..scene.material import BlinnPhong, Dielectric, Lambert, MetallicRoughness
from ..scene.material_extensions import Conductor
from ..scene.texture import AnyTexture, Texels, Texture
from .mitsuba_color import curve_of, rgb_from_reflectance
from .mitsuba_conductor import IOR, normal_reflectance, reflectance_of
from .mitsuba_properties import Properties
from .mitsuba_texture import Painted, Textures, grey_of
from .mitsuba_xml import Element
from .notes import Kind, Notes, quoted
from .sources import Sources

__all__ = ["Materials", "Surface"]

Triple = tuple[float, float, float]
Find = Callable[[Element], Element]
Opaque = Lambert | BlinnPhong | MetallicRoughness

_WHITE, _BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
_MAX_NESTING = 16


class Surface(NamedTuple):
    """A material, and what Mitsuba says about it that a material does not hold.

    `material` None: nothing is seen of the surface. `by_vertex`: the mesh's own colours are shown. `two_sided`: its back is drawn like its
    front in Mitsuba, too.
    """

    material: Opaque | Dielectric | None
    by_vertex: bool = False
    two_sided: bool = False


class Materials:
    """The surfaces of one scene, each read once.

    Parameters
    ----------
    sources : Sources
    notes : Notes
    textures : Textures
    find : callable
        The element that a <ref> means.
    """

    def __init__(self, sources: Sources, notes: Notes, textures: Textures, find: Find) -> None:
        self._sources = sources
        self._notes = notes
        self._textures = textures
        self._find = find
        self._read: dict[int, Surface] = {}
        self._kinds: dict[str, Callable[[Properties], Surface]] = {
            "diffuse": self._diffuse, "roughdiffuse": self._diffuse, "dielectric": self._dielectric, "roughdielectric": self._dielectric,
            "thindielectric": self._thin, "conductor": self._conductor, "roughconductor": self._conductor, "plastic": self._plastic,
            "roughplastic": self._plastic, "principled": self._principled, "principledthin": self._principled, "null": self._null,
            "phong": self._phong,
        }  # fmt: skip
        self._around: dict[str, Callable[[Properties, int], Surface]] = {
            "twosided": self._two_sided, "mask": self._mask, "bumpmap": self._bump_map, "bump": self._bump_map,
            "normalmap": self._normal_map, "blendbsdf": self._blend,
        }  # fmt: skip

    def surface(self, element: Element, depth: int = 0) -> Surface:
        """What a <bsdf>, or a <ref> to one, makes of a shape."""
        target = self._find(element)
        if id(target) not in self._read:
            if depth > _MAX_NESTING:
                raise FileFormatError(f"surfaces stand deeper in each other than {_MAX_NESTING}", self._sources.path, element.where)
            self._read[id(target)] = self._made(Properties(target, self._sources), depth)
        return self._read[id(target)]

    def _made(self, properties: Properties, depth: int) -> Surface:
        kind = properties.element.kind
        if kind in self._around:
            surface = self._around[kind](properties, depth)
        elif kind in self._kinds:
            surface = self._kinds[kind](properties)
        else:
            self._note("replaced", f"{properties.what} is not read; a grey matte surface stands in", properties, slip=True)
            return Surface(Lambert((0.5, 0.5, 0.5), name=properties.element.id))
        for child in properties.unknown():
            self._notes.add(f"{properties.what}: {quoted(child.name)} is ignored", child.where, kind="ignored", what=properties.what)
        if surface.material is None or not properties.element.id:
            return surface
        return surface._replace(material=dataclasses.replace(surface.material, name=properties.element.id))

    def _note(self, kind: Kind, text: str, properties: Properties, *, slip: bool = False) -> None:
        self._notes.add(text, properties.where, slip=slip, kind=kind, what=properties.what)

    # What the properties hold

    def _paint(self, properties: Properties, name: str, default: float | Triple) -> Painted:
        child = properties.child(name)
        if child is None or child.tag not in ("texture", "ref"):
            return Painted(properties.color(name, default))
        return self._textures.painted(self._find(child))

    def _level(self, properties: Properties, name: str, default: float) -> tuple[float, AnyTexture | None]:
        """A number, or a texture of numbers, which multiplies 1."""
        child = properties.child(name)
        if child is not None and child.tag in ("rgb", "spectrum"):
            return float(np.mean(properties.color_in(child))), None
        if child is None or child.tag not in ("texture", "ref"):
            return properties.number(name, default), None
        painted = self._textures.painted(self._find(child), data=True)
        return (1.0, painted.texture) if painted.texture is not None else (float(np.mean(painted.color)), None)

    def _plain(self, properties: Properties, name: str, default: float | Triple) -> Triple:
        """A colour where limner takes no texture."""
        painted = self._paint(properties, name, default)
        if painted.texture is not None:
            self._note("approximated", f"the texture of {name} is drawn as one colour", properties)
            red, green, blue = (c * m for c, m in zip(painted.color, _mean(painted.texture), strict=True))
            return red, green, blue
        return painted.color

    def _ior(self, properties: Properties, name: str, default: str) -> float:
        text = properties.text(name, default).strip()
        if text.lower() in IOR:
            return IOR[text.lower()]
        value = properties.number(name, 1.0) if properties.has(name) else IOR[default]
        if value <= 0.0:
            raise properties.error(f"{name} must be positive, got {value:g}", properties.child(name))
        return value

    def _roughness(self, properties: Properties, default: float, *, rough: bool) -> float:
        """The square root of alpha: 0 for polished surfaces."""
        if not rough:
            return 0.0
        if properties.text("distribution", "beckmann") != "ggx":
            self._note("approximated", "microfacets of Beckmann's distribution are drawn as GGX of the same width", properties)
        if properties.has("alpha_u") or properties.has("alpha_v"):
            alpha_u, alpha_v = (self._level(properties, f"alpha_{axis}", default)[0] for axis in "uv")
            if alpha_u != alpha_v:
                self._note("approximated", "brushed (anisotropic) microfacets are drawn alike in all directions", properties)
            alpha = math.sqrt(max(alpha_u * alpha_v, 0.0))
        else:
            alpha, texture = self._level(properties, "alpha", default)
            if texture is not None:
                self._note("approximated", "the texture of alpha is drawn as one number", properties)
                alpha = _mean(texture)[0]
        properties.skip("sample_visible", "nonlinear")  # how it is sampled; `nonlinear` is told of by `_plastic`
        return math.sqrt(min(max(alpha, 0.0), 1.0))

    # Kinds

    def _diffuse(self, properties: Properties) -> Surface:
        paint = self._paint(properties, "reflectance", 0.5)
        degrees = self._slope_degrees(properties) if properties.element.kind == "roughdiffuse" else 0.0
        return Surface(Lambert(paint.color, texture=paint.texture, roughness_degrees=degrees), paint.by_vertex)

    def _slope_degrees(self, properties: Properties) -> float:
        """Oren and Nayar's sigma for a root mean square slope alpha.

        **Source**: the Mitsuba 0.6 documentation, *Rough diffuse material*: alpha is that of Beckmann's distribution, whose slopes along
        one axis vary by ``alpha / sqrt(2)``, small angles taken for their tangents.
        """
        alpha, texture = self._level(properties, "alpha", 0.2)
        if texture is not None:
            self._note("approximated", "the texture of alpha is drawn as one number", properties)
            alpha = _mean(texture)[0]
        if not properties.flag("use_fast_approx", False):
            self._note("approximated", "roughdiffuse is drawn by Oren and Nayar's short formula, as with use_fast_approx", properties)
        return min(math.degrees(max(alpha, 0.0) / math.sqrt(2.0)), 90.0)

    def _dielectric(self, properties: Properties) -> Surface:
        ratio = self._ior(properties, "int_ior", "bk7") / self._ior(properties, "ext_ior", "air")
        paint = self._paint(properties, "specular_transmittance", 1.0)
        if self._plain(properties, "specular_reflectance", 1.0) != _WHITE:
            self._note("ignored", "specular_reflectance is ignored: reflections in glass are not coloured", properties)
        tint = paint.color
        if max(tint) > 1.0:
            self._note("approximated", "specular_transmittance above 1 is taken as 1", properties)
            tint = tuple(min(c, 1.0) for c in tint)  # type: ignore[assignment]
        roughness = self._roughness(properties, 0.1, rough=properties.element.kind == "roughdielectric")
        return Surface(Dielectric(ratio, tint, roughness=roughness, tint_texture=paint.texture))

    def _thin(self, properties: Properties) -> Surface:
        """What a sheet reflects straight on, with all that goes to and fro in it: 2 R / (1 + R)."""
        ratio = self._ior(properties, "int_ior", "bk7") / self._ior(properties, "ext_ior", "air")
        once = normal_reflectance(ratio, 0.0)
        tint = self._plain(properties, "specular_reflectance", 1.0)
        if self._plain(properties, "specular_transmittance", 1.0) != _WHITE:
            self._note("ignored", "specular_transmittance is ignored: thin glass is not coloured", properties)
        self._note("approximated", "thin glass reflects at all angles what it reflects straight on", properties)
        share = min(2.0 * once / (1.0 + once), 1.0)
        return Surface(BlinnPhong(_BLACK, mirror=tint, alpha=share, alpha_mode="blend", ambient=_BLACK), two_sided=True)

    def _conductor(self, properties: Properties) -> Surface:
        rough = properties.element.kind == "roughconductor"
        tint = self._paint(properties, "specular_reflectance", 1.0)
        metal = self._metal(properties)
        if metal is None and not rough and tint.texture is None:
            return Surface(BlinnPhong(_BLACK, mirror=tint.color, ambient=_BLACK))
        measured = metal if isinstance(metal, Conductor) else None
        f0 = _WHITE if metal is None or isinstance(metal, Conductor) else metal
        red, green, blue = (a * b for a, b in zip(f0, tint.color, strict=True))
        roughness = self._roughness(properties, 0.1, rough=rough)
        properties.skip("distribution", "alpha")
        return Surface(
            MetallicRoughness(
                (red, green, blue), 1.0, roughness, base_color_texture=tint.texture, double_sided=True, conductor=measured
            )
        )  # fmt: skip

    def _metal(self, properties: Properties) -> Conductor | Triple | None:
        """A metal by its index of refraction for red, green and blue, or what it reflects straight on; None: all is reflected.

        By name or by wavelength it is known better than three numbers tell, so there its colour is worked out over all wavelengths.
        """
        if properties.has("eta") or properties.has("k"):
            properties.skip("material")
            n, k = (self._spectrum(properties, name, default) for name, default in (("eta", 0.0), ("k", 1.0)))
            if np.ndim(n) == np.ndim(k) == 1 and len(n) == len(k) != 3:
                return rgb_from_reflectance(np.minimum(normal_reflectance(n, k), 1.0))
            n, k = (np.broadcast_to(rgb_from_reflectance(v) if np.size(v) > 3 else v, 3) for v in (n, k))
            if n.min() > 0.0 and k.min() >= 0.0:
                return Conductor(tuple(n.tolist()), tuple(k.tolist()))
            red, green, blue = normal_reflectance(n, k).tolist()
            return red, green, blue
        name = properties.text("material", "none")
        if name.lower() == "none":
            return None
        found = reflectance_of(name)
        if found is None:
            self._note("replaced", f"the metal {quoted(name)} is not known; chromium stands in", properties, slip=True)
            return reflectance_of("Cr")
        return found

    def _spectrum(self, properties: Properties, name: str, default: float) -> Any:
        """Optical constants: by wavelength, as three numbers, or as one for all."""
        child = properties.child(name)
        if child is None:
            return np.full(3, default)
        if child.tag == "spectrum" and ("filename" in child.attributes or ":" in child.attributes.get("value", "")):
            try:
                return curve_of(child, lambda file: self._sources.read_beside(file, child.where))
            except ValueError as error:
                raise properties.error(f"{name}: {error}", child) from None
        return np.array(properties.color(name, default))

    def _plastic(self, properties: Properties) -> Surface:
        paint = self._paint(properties, "diffuse_reflectance", 0.5)
        ratio = self._ior(properties, "int_ior", "polypropylene") / self._ior(properties, "ext_ior", "air")
        if abs(normal_reflectance(ratio, 0.0) - 0.04) > 0.01:
            self._note("approximated", "a coat of another index of refraction is drawn as one of 1.5", properties)
        if self._plain(properties, "specular_reflectance", 1.0) != _WHITE:
            self._note("ignored", "specular_reflectance is ignored: reflections in a coat are not coloured", properties)
        properties.skip("nonlinear")
        roughness = self._roughness(properties, 0.1, rough=properties.element.kind == "roughplastic")
        self._note("approximated", "plastic is a coat over a matte base, without the light that is caught between them", properties)
        material = MetallicRoughness(paint.color, 0.0, roughness, base_color_texture=paint.texture, double_sided=True)
        return Surface(material, paint.by_vertex)

    def _phong(self, properties: Properties) -> Surface:
        paint, shine = self._paint(properties, "diffuse_reflectance", 0.5), self._plain(properties, "specular_reflectance", 0.2)
        exponent = properties.number("exponent", 30.0)
        material = BlinnPhong(
            paint.color, shine, max(exponent, 0.0), highlight="phong", normalized=True, diffuse_texture=paint.texture
        )  # fmt: skip
        self._note("approximated", "phong is scaled so that it keeps its energy straight on only", properties)
        return Surface(material, paint.by_vertex)

    def _principled(self, properties: Properties) -> Surface:
        paint = self._paint(properties, "base_color", 0.5)
        (roughness, rough_map), (metallic, metal_map) = (
            self._level(properties, name, default) for name, default in (("roughness", 0.5), ("metallic", 0.0))
        )
        spec_trans = self._level(properties, "spec_trans", 0.0)[0]
        eta = self._ior(properties, "eta", "bk7") if properties.has("eta") else 1.5
        properties.skip("diffuse_reflectance_sampling_rate", "specular_sampling_rate", "clearcoat_sampling_rate")
        specular = self._level(properties, "specular", 0.5)[0]
        lobes = ("anisotropic", "sheen", "sheen_tint", "clearcoat", "clearcoat_gloss", "flatness", "spec_tint", "diff_trans")
        kept = [name for name in lobes if properties.has(name) and self._level(properties, name, 0.0)[0] > 0.0]
        if kept:
            self._note("ignored", f"{', '.join(kept)} of principled {'are' if len(kept) > 1 else 'is'} ignored", properties)
        if spec_trans > 0.5 and metallic < 0.5:
            if spec_trans < 1.0:
                self._note("approximated", "what is partly of glass is drawn as glass", properties)
            tint = tuple(math.sqrt(min(c, 1.0)) for c in self._plain(properties, "base_color", 0.5))
            return Surface(Dielectric(eta, tint, roughness=min(max(roughness, 0.0), 1.0)))  # type: ignore[arg-type]
        if abs(eta - 1.5) > 0.05 or specular != 0.5:
            self._note("approximated", "what principled reflects head on is drawn as of an index of refraction of 1.5", properties)
        if spec_trans > 0.0:
            self._note("ignored", "what is less than half of glass is drawn opaque: spec_trans is ignored", properties)
        if rough_map is not None or metal_map is not None:
            properties.skip("roughness", "metallic")
        rough = self._packed(properties, rough_map, metal_map)
        return Surface(
            MetallicRoughness(
                paint.color, min(max(metallic, 0.0), 1.0), min(max(roughness, 0.0), 1.0), base_color_texture=paint.texture,
                metallic_roughness_texture=rough, double_sided=True,
            ),
            paint.by_vertex,
        )  # fmt: skip

    def _packed(self, properties: Properties, rough: AnyTexture | None, metal: AnyTexture | None) -> AnyTexture | None:
        """Roughness in green and metal in blue, of one picture, as glTF has them."""
        if rough is None and metal is None:
            return None
        first = rough if rough is not None else metal
        if not isinstance(first, Texture):
            self._note("approximated", "a pattern of roughness or metal is drawn as one number", properties)
            return None
        pixels = np.full(first.texels.pixels.shape, first.texels.white, dtype=first.texels.pixels.dtype)
        for channel, texture in ((1, rough), (2, metal)):
            if isinstance(texture, Texture) and texture.texels.pixels.shape == pixels.shape:
                pixels[..., channel] = texture.texels.pixels[..., 0]
            elif texture is not None:
                self._note("ignored", "pictures of roughness and of metal differ in size; that of metal is ignored", properties)
        return dataclasses.replace(first, texels=Texels(pixels, srgb=False, name=first.texels.name))

    def _null(self, _properties: Properties) -> Surface:
        return Surface(None)

    # What stands around others

    def _inner(self, properties: Properties, depth: int) -> list[Surface]:
        held = [child for child in properties.element.children if child.tag == "bsdf" or (child.tag == "ref" and self._is_bsdf(child))]
        properties.skip(*(child.name for child in held))
        if not held:
            raise properties.error(f"{properties.what} must hold a <bsdf>")
        return [self.surface(child, depth + 1) for child in held]

    def _is_bsdf(self, reference: Element) -> bool:
        return self._find(reference).tag == "bsdf"

    def _two_sided(self, properties: Properties, depth: int) -> Surface:
        inner = self._inner(properties, depth)
        if len(inner) > 1:
            self._note("ignored", "the second surface of twosided is ignored: the back is drawn like the front", properties)
        return inner[0]._replace(two_sided=True)

    def _mask(self, properties: Properties, depth: int) -> Surface:
        inner = self._inner(properties, depth)[0]
        if isinstance(inner.material, Dielectric) or inner.material is None:
            self._note("ignored", "the mask of what is not opaque is ignored", properties)
            properties.skip("opacity")
            return inner
        level, texture = self._level(properties, "opacity", 0.5)
        return inner._replace(
            material=dataclasses.replace(inner.material, alpha=min(max(level, 0.0), 1.0), alpha_mode="blend", alpha_texture=texture)
        )

    def _bump_map(self, properties: Properties, depth: int) -> Surface:
        inner = self._inner(properties, depth)[0]
        found = self._held_texture(properties)
        scale = properties.number("scale", 1.0)
        if found is None or inner.material is None:
            self._note("ignored", "the bump map is ignored: it cannot be read, or what it lies on is not seen", properties)
            return inner
        found = grey_of(found) if isinstance(found, Texture) else found
        return inner._replace(material=dataclasses.replace(inner.material, bump_texture=found, bump_scale=scale))

    def _normal_map(self, properties: Properties, depth: int) -> Surface:
        inner = self._inner(properties, depth)[0]
        found = self._held_texture(properties)
        if not isinstance(found, Texture) or inner.material is None:
            self._note("ignored", "the normal map is ignored: it is no picture, or what it lies on is not seen", properties)
            return inner
        if isinstance(inner.material, Dielectric):
            self._note("ignored", "the normal map of glass is ignored", properties)
            return inner
        return inner._replace(material=dataclasses.replace(inner.material, normal_texture=found))

    def _held_texture(self, properties: Properties) -> AnyTexture | None:
        for child in properties.element.children:
            target = self._find(child) if child.tag == "ref" else child
            if target.tag == "texture":
                properties.skip(child.name)
                return self._textures.painted(target, data=True).texture
        raise properties.error(f"{properties.what} must hold a <texture>")

    def _blend(self, properties: Properties, depth: int) -> Surface:
        inner = self._inner(properties, depth)
        weight, texture = self._level(properties, "weight", 0.5)
        weight = _mean(texture)[0] if texture is not None else weight
        self._note("replaced", "of two surfaces that are blended, the one with the greater share stands in for both", properties, slip=True)
        return inner[1 if weight > 0.5 and len(inner) > 1 else 0]


def _mean(texture: AnyTexture) -> Triple:
    """The mean of a picture, or of the colours of a pattern, linear."""
    if not isinstance(texture, Texture):
        red, green, blue = np.mean([color[:3] for color in texture.colors], axis=0).tolist()
        return red, green, blue
    from ..color.transfer import linear_from_srgb

    levels = texture.texels.pixels[..., :3].reshape(-1, 3).astype(np.float64) / texture.texels.white
    red, green, blue = (linear_from_srgb(levels) if texture.texels.srgb else levels).mean(axis=0).tolist()
    return red, green, blue
