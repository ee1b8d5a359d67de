"""What surfaces are made of: descriptions, one class for each kind (FoCG 4.5, 10; glTF 2.0 section 3.9).

A surface receives irradiance E; the book's intensity I is E/pi, so that its formulas are literally what is computed:
``(kd n.l + ks (n.h)^p) E/pi``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeAlias, get_args

from ..errors import SceneError
from ._values import Triple, finite, positive, triple, unit_interval
from .material_extensions import (
    Anisotropy,
    Clearcoat,
    Conductor,
    DiffuseTransmission,
    Iridescence,
    Sheen,
    Specular,
    Transmission,
    Volume,
)  # fmt: skip
from .procedural import Pattern
from .texture import AnyTexture, Texture

__all__ = [
    "AlphaChannel", "AlphaMode", "BlinnPhong", "CoolToWarm", "Dielectric", "Lambert", "Material", "MetallicRoughness", "ShadowCatcher",
    "Variant",
]  # fmt: skip

AlphaMode = Literal["opaque", "mask", "blend"]
AlphaChannel = Literal["r", "g", "b", "alpha"]


def _check_surface(material: Lambert | BlinnPhong | MetallicRoughness) -> None:
    if material.alpha_mode not in ("opaque", "mask", "blend"):
        raise SceneError(f'material.alpha_mode must be "opaque", "mask" or "blend", got {material.alpha_mode!r}', material.name)
    _check_textures(material)
    _put_number(material, "alpha", 0.0, 1.0)
    _put_number(material, "alpha_cutoff", 0.0, 1e30)
    _put_number(material, "normal_scale", -1e6, 1e6)
    if material.alpha_channel not in get_args(AlphaChannel):
        raise SceneError(f'material.alpha_channel must be "r", "g", "b" or "alpha", got {material.alpha_channel!r}', material.name)


def _check_textures(material: Lambert | BlinnPhong | MetallicRoughness | Dielectric) -> None:
    for field, value in vars(material).items():
        if field.endswith("texture") and not isinstance(value, (Texture, *get_args(Pattern), type(None))):
            raise SceneError(f"material.{field} must be a Texture or a pattern, got {type(value).__name__}", material.name)
    if material.bump_texture is not None and material.bump_texture.uv_set != 0:
        raise SceneError("material.bump_texture must use the texture coordinates of set 0", material.name)
    _put_number(material, "bump_scale", -1e6, 1e6)


def _put_number(material: Material, field: str, least: float, most: float) -> None:
    value = finite(getattr(material, field), f"material.{field}")
    if not least <= value <= most:
        raise SceneError(f"material.{field} must lie in [{least:g}, {most:g}], got {value}", material.name)
    object.__setattr__(material, field, value)


def _put_color(material: Material, field: str) -> None:
    object.__setattr__(material, field, triple(getattr(material, field), f"material.{field}", minimum=0.0))


@dataclass(frozen=True)
class Lambert:
    """A matte surface (FoCG 4.5.1, 10.1): radiance ``kd/pi E``.

    Parameters
    ----------
    color : three floats >= 0
        The diffuse coefficient kd, linear Rec. 709.
    texture : Texture or pattern, optional
        Multiplies `color` (and its alpha `alpha`).
    emission : three floats >= 0
        Radiance that the surface itself gives off.
    double_sided : bool
        False: the camera does not see its back. Light does: it casts shadows, and is seen in mirrors.
    emission_texture : Texture or pattern, optional
        Multiplies `emission`.
    normal_texture : Texture, optional
        A normal map as in glTF: the normal is ``2 c - 1`` by tangent, bitangent and normal, the first two times `normal_scale`.
    bump_texture : Texture or pattern, optional
        The height of a rough surface over the smooth one, in its red channel (FoCG 11.4): its normals are shown, its outline is not. A
        picture's numbers are heights where its texels are linear (`srgb` False).
    bump_scale : float
        Height where the texture is 1, in the object's own units; below 0, heights are depths.
    alpha_texture, alpha_channel : Texture or pattern, optional, and "r" | "g" | "b" | "alpha"
        A channel of it multiplies `alpha`.
    roughness_degrees : float in [0, 90]
        How steep the surface is that looks flat, as the standard deviation of its slopes' angle: plaster and the full moon are brighter
        towards the edge than ``kd/pi E`` says (Oren and Nayar 1994). 0: Lambert.
    """

    color: Triple = (0.8, 0.8, 0.8)
    texture: AnyTexture | None = None
    emission: Triple = (0.0, 0.0, 0.0)
    double_sided: bool = True
    alpha: float = 1.0
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    name: str = ""
    emission_texture: AnyTexture | None = None
    normal_texture: AnyTexture | None = None
    normal_scale: float = 1.0
    bump_texture: AnyTexture | None = None
    bump_scale: float = 1.0
    alpha_texture: AnyTexture | None = None
    alpha_channel: AlphaChannel = "r"
    roughness_degrees: float = 0.0

    def __post_init__(self) -> None:
        _put_color(self, "color")
        _put_number(self, "roughness_degrees", 0.0, 90.0)
        _put_color(self, "emission")
        _check_surface(self)


@dataclass(frozen=True)
class BlinnPhong:
    """Diffuse, a highlight, ambient, and an ideal mirror (FoCG 4.5.2-4.5.3, 4.8, 10.2).

    Parameters
    ----------
    diffuse, specular : three floats >= 0
        kd and ks (the book's c_r and c_p).
    exponent : float > 0
        The Phong exponent p.
    ambient : three floats >= 0, optional
        ka; None: the diffuse coefficient, texture and all.
    mirror : three floats >= 0
        km: what an ideal reflection is multiplied by.
    mirror_blur : float >= 0, optional
        The width a of the square over which reflected rays are scattered (FoCG 13.4.4): at distance 1 along the mirrored ray, at right
        angles to it. 0.1 smears a reflection over about 6 degrees. None: an ideal mirror. For `ray` and `path`.
    highlight : "blinn" | "phong"
        (n.h)^p with the half vector (FoCG 4.5.2), or (r.e)^p with the reflected light (FoCG 10.2.1).
    normalized : bool
        Scale the highlight by (p + 2) / 8, so that seen from straight above it sends out ks of what it gets, whatever p: the integral
        of (n.h)^p over directions is ``8 pi / (p + 2)``, but for what lies below the horizon. (r.e)^p: by (p + 1) / 2. The book's
        formulas are without.
    diffuse_texture, specular_texture, emission_texture : Texture or pattern, optional
        Multiply kd, ks and `emission`.
    normal_texture : Texture, optional
        A normal map as in glTF: the normal is ``2 c - 1`` by tangent, bitangent and normal, the first two times `normal_scale`.
    bump_texture : Texture or pattern, optional
        The height of a rough surface over the smooth one, in its red channel (FoCG 11.4): its normals are shown, its outline is not. A
        picture's numbers are heights where its texels are linear (`srgb` False).
    bump_scale : float
        Height where the texture is 1, in the object's own units; below 0, heights are depths.
    alpha_texture, alpha_channel : Texture or pattern, optional, and "r" | "g" | "b" | "alpha"
        A channel of it multiplies `alpha`.
    """

    diffuse: Triple = (0.8, 0.8, 0.8)
    specular: Triple = (0.0, 0.0, 0.0)
    exponent: float = 32.0
    ambient: Triple | None = None
    mirror: Triple = (0.0, 0.0, 0.0)
    emission: Triple = (0.0, 0.0, 0.0)
    highlight: Literal["blinn", "phong"] = "blinn"
    normalized: bool = False
    diffuse_texture: AnyTexture | None = None
    specular_texture: AnyTexture | None = None
    double_sided: bool = True
    alpha: float = 1.0
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    name: str = ""
    mirror_blur: float | None = None
    emission_texture: AnyTexture | None = None
    normal_texture: AnyTexture | None = None
    normal_scale: float = 1.0
    bump_texture: AnyTexture | None = None
    bump_scale: float = 1.0
    alpha_texture: AnyTexture | None = None
    alpha_channel: AlphaChannel = "r"

    def __post_init__(self) -> None:
        for field in ("diffuse", "specular", "mirror", "emission"):
            _put_color(self, field)
        if self.mirror_blur is not None:
            _put_number(self, "mirror_blur", 0.0, 2.0)
        if self.ambient is not None:
            _put_color(self, "ambient")
        _put_number(self, "exponent", 0.0, 1e6)
        if self.highlight not in ("blinn", "phong"):
            raise SceneError(f'material.highlight must be "blinn" or "phong", got {self.highlight!r}', self.name)
        _check_surface(self)


@dataclass(frozen=True)
class MetallicRoughness:
    """The core material of glTF 2.0 (section 3.9.2, appendix B).

    Parameters
    ----------
    base_color : three floats >= 0
    metallic, roughness : floats in [0, 1]
    base_color_texture, metallic_roughness_texture, emissive_texture, normal_texture, occlusion_texture : Texture or pattern, optional
        As in glTF: roughness in G, metallic in B, occlusion in R; colours sRGB-encoded.
    normal_scale, occlusion_strength : float
    emission : three floats >= 0
        Emissive factor times emissive strength.
    unlit : bool
        Show the base colour as it is (KHR_materials_unlit).
    double_sided : bool
        False: the camera does not see its back. Light does: it casts shadows, and is seen in mirrors.
    bump_texture : Texture or pattern, optional
        The height of a rough surface over the smooth one, in its red channel (FoCG 11.4): its normals are shown, its outline is not. A
        picture's numbers are heights where its texels are linear (`srgb` False).
    bump_scale : float
        Height where the texture is 1, in the object's own units; below 0, heights are depths.
    alpha_texture, alpha_channel : Texture or pattern, optional, and "r" | "g" | "b" | "alpha"
        A channel of it multiplies `alpha`.
    ior : float >= 1, or 0
        Index of refraction of what is no metal: straight on it reflects ``((ior - 1) / (ior + 1))^2``. 0 is glTF's word for infinity.
    dispersion : float >= 0
        20 / V, V the Abbe number: how much more the blue is bent than the red. Crown glass 0.34, diamond 0.36, 0: nothing.
    clearcoat, sheen, specular, transmission, volume, anisotropy, iridescence, diffuse_transmission : optional
        What glTF has extensions for, see `limner.scene.material_extensions`. `ray` and `path` follow light through a transmission, and
        bend it where there is a volume with a thickness; only `path` tells the colours of `dispersion` apart. `raster` draws what lets
        light through as a grey veil.
    conductor : Conductor, optional
        A metal by its measured index of refraction. `base_color` then multiplies what it reflects, as a lacquer would; (1, 1, 1) is the
        metal itself. For `metallic` 1.
    energy_compensation : bool
        Give back what a rough surface loses because light that is reflected from facet to facet is not followed: at roughness 1 more
        than half. What goes through keeps its light, too. glTF's appendix B is without, and so are most viewers, which is why it is not
        the default.
    variants : tuple of Variant
        What stands in its place where the scene is shown in another variant, see `limner.scene.variants.with_variant`.
    """

    base_color: Triple = (1.0, 1.0, 1.0)
    metallic: float = 1.0
    roughness: float = 1.0
    base_color_texture: AnyTexture | None = None
    metallic_roughness_texture: AnyTexture | None = None
    normal_texture: AnyTexture | None = None
    normal_scale: float = 1.0
    occlusion_texture: AnyTexture | None = None
    occlusion_strength: float = 1.0
    emission: Triple = (0.0, 0.0, 0.0)
    emissive_texture: AnyTexture | None = None
    unlit: bool = False
    double_sided: bool = False
    alpha: float = 1.0
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    name: str = ""
    bump_texture: AnyTexture | None = None
    bump_scale: float = 1.0
    alpha_texture: AnyTexture | None = None
    alpha_channel: AlphaChannel = "r"
    ior: float = 1.5
    dispersion: float = 0.0
    clearcoat: Clearcoat | None = None
    sheen: Sheen | None = None
    specular: Specular | None = None
    transmission: Transmission | None = None
    volume: Volume | None = None
    anisotropy: Anisotropy | None = None
    iridescence: Iridescence | None = None
    diffuse_transmission: DiffuseTransmission | None = None
    variants: tuple[Variant, ...] = ()
    conductor: Conductor | None = None
    energy_compensation: bool = False

    def __post_init__(self) -> None:
        _put_color(self, "base_color")
        _put_color(self, "emission")
        for field in ("metallic", "roughness", "occlusion_strength"):
            object.__setattr__(self, field, unit_interval(getattr(self, field), f"material.{field}"))
        _check_surface(self)
        _put_number(self, "dispersion", 0.0, 1e6)
        _put_number(self, "ior", 0.0, 1e6)
        if 0.0 < self.ior < 1.0:
            raise SceneError(f"material.ior must be at least 1, or 0 for infinity, got {self.ior}", self.name)
        for field, kind in _PARTS.items():
            if not isinstance(getattr(self, field), (kind, type(None))):
                raise SceneError(f"material.{field} must be of type {kind.__name__}, got {type(getattr(self, field)).__name__}", self.name)
        object.__setattr__(self, "variants", tuple(self.variants))
        for variant in self.variants:
            if not isinstance(variant, Variant):
                raise SceneError(f"material.variants must be of type Variant, got {type(variant).__name__}", self.name)


@dataclass(frozen=True)
class Variant:
    """What a material is in one of the variants of its scene (KHR_materials_variants).

    Parameters
    ----------
    name : str
        Of the variant.
    material : any material
    """

    name: str
    material: Material

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise SceneError(f"variant.name must be text, got {type(self.name).__name__}")
        if not isinstance(self.material, Material):
            raise SceneError(f"variant.material must be a material, got {type(self.material).__name__}", self.name)


@dataclass(frozen=True)
class ShadowCatcher:
    """A surface of which only the shadows on it are seen: black, as opaque as they are dark.

    For a ground under a model on a transparent background. `raster`, which has no shadows, leaves it out.
    """

    name: str = ""

    color: ClassVar[Triple] = (1.0, 1.0, 1.0)
    emission: ClassVar[Triple] = (0.0, 0.0, 0.0)
    alpha: ClassVar[float] = 0.0
    alpha_mode: ClassVar[AlphaMode] = "blend"
    alpha_cutoff: ClassVar[float] = 0.5
    double_sided: ClassVar[bool] = True


@dataclass(frozen=True)
class Dielectric:
    """Glass, water, ice, fog in a box: what light goes through and is bent by (FoCG 13.1).

    The surfaces of the shape are where the material begins and ends, so the shape must be closed: light that meets a surface from its
    front enters, light that meets it from its back leaves. Shapes may stand inside one another (a bubble is a ball of `ior` 1 in glass),
    and may overlap: where they do, the material of the highest `priority` fills the place, and among equals the one entered last. So
    that a glass and the water in it touch without a gap, let the water reach into the glass and give the glass the higher priority.

    Parameters
    ----------
    ior : float > 0
        Index of refraction against air: water 1.33, glass 1.5, diamond 2.42; 1 bends nothing.
    tint : three floats in [0, 1]
        What light is multiplied by whenever it passes a surface.
    absorption : three floats >= 0
        Per metre: ``exp(-absorption d)`` is left of light after d metres (Beer's law). See `with_color_at`.
    haze : three floats >= 0
        The radiance of the medium itself where it is so thick that nothing else is seen: with `absorption`, fog that fills the shape.
    roughness : float in [0, 1]
        0: polished; else frosted, by GGX microfacets of width roughness squared.
    fresnel : "exact" | "schlick"
        How much is reflected: by Fresnel's equations, or by Schlick's approximation to them.
    priority : int
        Who fills the place where two overlap.
    tint_texture : Texture or pattern, optional
        Multiplies `tint`.
    bump_texture, bump_scale : Texture or pattern, optional, and float
        As for `Lambert`: ripples on water, hammered glass.
    energy_compensation : bool
        Follow light on a frosted surface from facet to facet until it leaves, so that none is lost; at roughness 1 it is more than half.
        It takes longer. For `ray` and `path`.

    `ray` and `path` follow light through it; `raster`, which cannot, draws it as a thin veil.
    """

    ior: float = 1.5
    tint: Triple = (1.0, 1.0, 1.0)
    absorption: Triple = (0.0, 0.0, 0.0)
    haze: Triple = (0.0, 0.0, 0.0)
    roughness: float = 0.0
    fresnel: Literal["exact", "schlick"] = "exact"
    priority: int = 0
    name: str = ""
    tint_texture: AnyTexture | None = None
    bump_texture: AnyTexture | None = None
    bump_scale: float = 1.0
    energy_compensation: bool = False

    emission: ClassVar[Triple] = (0.0, 0.0, 0.0)
    alpha: ClassVar[float] = 0.25
    alpha_mode: ClassVar[AlphaMode] = "blend"
    alpha_cutoff: ClassVar[float] = 0.5
    double_sided: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "ior", positive(self.ior, "material.ior"))
        for field in ("tint", "absorption", "haze"):
            _put_color(self, field)
        if max(self.tint) > 1.0:
            raise SceneError(f"material.tint must lie in [0, 1], got {self.tint}", self.name)
        object.__setattr__(self, "roughness", unit_interval(self.roughness, "material.roughness"))
        if self.fresnel not in ("exact", "schlick"):
            raise SceneError(f'material.fresnel must be "exact" or "schlick", got {self.fresnel!r}', self.name)
        if isinstance(self.priority, bool) or not isinstance(self.priority, int) or abs(self.priority) > 1 << 24:
            raise SceneError(f"material.priority must be an integer up to 2^24, got {self.priority!r}", self.name)
        _check_textures(self)

    @classmethod
    def with_color_at(cls, color: Any, depth: float, **fields: Any) -> Dielectric:
        """Choose the absorption so that white light has the given color after `depth` metres.

        Parameters
        ----------
        color : three floats in (0, 1]
        depth : float > 0
        **fields
            Any other field.

        >>> [round(a, 3) for a in Dielectric.with_color_at((1.0, 0.5, 0.25), 2.0).absorption]
        [0.0, 0.347, 0.693]

        **Source**: Beer's law, I = I_0 exp(-a d), for a.
        """
        left, d = triple(color, "color"), positive(depth, "depth")
        if not all(0.0 < c <= 1.0 for c in left):
            raise SceneError(f"color must lie in (0, 1], got {left}")
        return cls(absorption=tuple(abs(math.log(c)) / d for c in left), **fields)  # type: ignore[arg-type]


@dataclass(frozen=True)
class CoolToWarm:
    """Shading as in technical drawings (FoCG 10.3.2; Gooch et al. 1998): warm where a surface faces the light, cool where it looks away.

    ``c = k_w warm + (1 - k_w) cool`` with ``k_w = (1 + n.l) / 2``: no part is lost in the dark, whatever the lights of the scene.

    Parameters
    ----------
    cool, warm : three floats >= 0
        Radiance, linear Rec. 709.
    towards : three floats, optional
        The direction l to the light, in the world. None: to the upper left of the picture, at right angles to the gaze, where the whole
        range from cool to warm is seen.
    double_sided : bool
        False: the camera does not see its back.

    In `path` it shines with what it shows, as an unlit surface does.
    """

    cool: Triple = (0.10, 0.16, 0.42)
    warm: Triple = (0.95, 0.72, 0.38)
    towards: Triple | None = None
    double_sided: bool = True
    name: str = ""

    emission: ClassVar[Triple] = (0.0, 0.0, 0.0)
    alpha: ClassVar[float] = 1.0
    alpha_mode: ClassVar[AlphaMode] = "opaque"
    alpha_cutoff: ClassVar[float] = 0.5

    def __post_init__(self) -> None:
        _put_color(self, "cool")
        _put_color(self, "warm")
        if self.towards is not None:
            towards = triple(self.towards, "material.towards")
            if not any(towards):
                raise SceneError("material.towards must not be zero", self.name)
            object.__setattr__(self, "towards", towards)


Material: TypeAlias = Lambert | BlinnPhong | MetallicRoughness | ShadowCatcher | Dielectric | CoolToWarm

_PARTS: dict[str, type] = {
    "clearcoat": Clearcoat, "sheen": Sheen, "specular": Specular, "transmission": Transmission, "volume": Volume,
    "anisotropy": Anisotropy, "iridescence": Iridescence, "diffuse_transmission": DiffuseTransmission, "conductor": Conductor,
}  # fmt: skip
