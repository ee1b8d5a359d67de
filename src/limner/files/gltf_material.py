"""Materials and textures of glTF (glTF 2.0, sections 3.8 and 3.9).

glTF counts v downwards from the top of the picture; here v points up. Everything is turned once, on reading:

    coordinates   v' = 1 - v
    texels        row 0 at the bottom
    transform     the same turn on both sides of KHR_texture_transform, see `turned_transform`
    tangents      unchanged, see `limner.files.gltf_mesh`
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import Any

from ..errors import FileFormatError, LimnerError, UnsupportedError
from ..scene.material import AlphaMode, MetallicRoughness, Variant
from ..scene.texture import Filter, Texels, Texture, Wrap
from .accessors import Accessors
from .document import Element
from .gltf_material_parts import DISPERSION, IOR, NORMAL_SCALE, PARTS, Part
from .notes import Notes, quoted, without_path
from .pictures import PictureError, Pictures
from .sources import Sources
from .specular_glossiness import converted, converted_texels

__all__ = ["Materials", "turned_transform"]

WRAPS: dict[int, Wrap] = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
NEAREST, LINEAR = 9728, 9729
FILTERS = (NEAREST, LINEAR, 9984, 9985, 9986, 9987)
ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}
_GLOSSY = "KHR_materials_pbrSpecularGlossiness"
_VARIANTS = "KHR_materials_variants"
# Where a texture may name a picture in another format than PNG and JPEG; the last is what the core says.
PICTURE_EXTENSIONS = ("KHR_texture_basisu", "EXT_texture_avif", "EXT_texture_webp")

Pair = tuple[float, float]


def turned_transform(offset: Pair, rotation: float, scale: Pair) -> tuple[Pair, float, Pair]:
    """Return KHR_texture_transform's numbers for coordinates whose v points up.

    With g the file's coordinates the extension asks for ``g' = t + R S g``, ``R = [[c, s], [-s, c]]`` (counter-clockwise by
    the angle as one sees the picture, whose v points down). Ours are ``h = D g + e`` with D = diag(1, -1), e = (0, 1), so

        h' = D g' + e = (D R D) S h + D t + e - (D R D) S e,        D R D = [[c, -s], [s, c]]

    the ordinary rotation by the same angle, the same scale, and the offset ``(t_u + s S_v, 1 - t_v - c S_v)``.

    **Source**: Khronos Group, *KHR_texture_transform*. Its GLSL listing turns the other way round; its text, its sample
    model TextureTransformTest and the Khronos sample viewer turn as here.
    """
    c, s = math.cos(rotation), math.sin(rotation)
    return (offset[0] + s * scale[1], 1.0 - offset[1] - c * scale[1]), rotation, scale


class Materials:
    """The materials of one glTF file, each built once, when it is asked for.

    Parameters
    ----------
    root : Element
        The document.
    """

    def __init__(self, root: Element, accessors: Accessors, sources: Sources, notes: Notes) -> None:
        self._materials = root.array("materials")
        self._textures = root.array("textures")
        self._images = root.array("images")
        self._samplers = root.array("samplers")
        self._accessors = accessors
        self._sources = sources
        self._notes = notes
        self._pictures = Pictures(sources.limits)
        self._built: dict[int, MetallicRoughness] = {}
        self._varied: dict[tuple[int | None, tuple[tuple[str, int], ...]], MetallicRoughness] = {}
        self._variant_names = self._names_of_variants(root)
        self._renamed: set[int] = set()

    def rename(self, indices: set[int]) -> None:
        """Give the materials `indices` names that no other has."""
        self._renamed = {index for index in indices if index < len(self._materials)}

    def name(self, index: int) -> str:
        """What material `index` is called in the scene."""
        name = self._materials[index].name()
        return f"{name or 'material'} ({index})" if index in self._renamed else name

    def prepare(self, indices: set[int]) -> None:
        """Decode the pictures of the materials `indices`, some at a time; errors show up when they are asked for."""
        wanted: dict[Any, Callable[[], bytes | memoryview]] = {}
        for index in sorted(indices):
            for information in _texture_informations(self._materials[index].value):
                try:
                    image = self._images_of(Element(information, self._materials[index].pointer, ""))[0]
                    key, give = self._picture_source(image)
                except LimnerError:
                    continue
                wanted[key] = give
        self._pictures.prepare(wanted)

    def index_of(self, primitive: Element) -> int | None:
        """The material that a primitive names, or None."""
        reference = primitive.get("material")
        return None if reference is None else reference.index(len(self._materials))

    def of(self, primitive: Element) -> MetallicRoughness:
        """Return the material of a primitive; the default one where it names none, or one that cannot be read."""
        index = None
        try:
            index = self.index_of(primitive)
            material = MetallicRoughness() if index is None else self._at(index)
        except LimnerError as error:
            self._notes.slip(f"the default material stands in: {without_path(error)}")
            material = MetallicRoughness()
        mapped = self._mapped(primitive)
        if not mapped:
            return material
        key = index, tuple(mapped.items())
        if key not in self._varied:
            variants = tuple(Variant(name, self._at(other)) for name, other in mapped.items())
            self._varied[key] = dataclasses.replace(material, variants=variants)
        return self._varied[key]

    def _at(self, index: int) -> MetallicRoughness:
        if index not in self._built:
            self._built[index] = dataclasses.replace(self._build(self._materials[index]), name=self.name(index))
        return self._built[index]

    def _names_of_variants(self, root: Element) -> list[str]:
        """What the variants of the file are called, all differently."""
        names: list[str] = []
        try:
            given = root.extension(_VARIANTS)
            for index, variant in enumerate([] if given is None else given.array("variants")):
                name = variant.name() or f"variant {index}"
                names.append(name if name not in names else f"{name} ({index})")
        except LimnerError as error:
            self._notes.slip(f"the variants are left out: {without_path(error)}")
        return names

    def _mapped(self, primitive: Element) -> dict[str, int]:
        """By which material a primitive's own is replaced, of each variant that does; in the order of the file's variants.

        **Source**: Khronos Group, *KHR_materials_variants*.
        """
        found: dict[int, int] = {}
        try:
            given = primitive.extension(_VARIANTS)
            for mapping in [] if given is None else given.array("mappings"):
                index = mapping.child("material").index(len(self._materials))
                self._at(index)
                found |= {variant.index(len(self._variant_names)): index for variant in mapping.array("variants")}
        except LimnerError as error:
            self._notes.slip(f"a variant is left out: {without_path(error)}")
        return {self._variant_names[variant]: found[variant] for variant in sorted(found)}

    def _build(self, material: Element) -> MetallicRoughness:
        fields = self._specular_glossiness(material) or self._metallic_roughness(material)
        strength_of = material.extension("KHR_materials_emissive_strength")
        strength = 1.0 if strength_of is None else strength_of.get_number("emissiveStrength", 1.0, 0.0)
        red, green, blue = material.get_numbers("emissiveFactor", (0.0, 0.0, 0.0), 0.0)
        mode = material.get_text("alphaMode", "OPAQUE")
        if mode not in ALPHA_MODES:
            raise material.error(f"must be OPAQUE, MASK or BLEND, got {quoted(mode)}", "alphaMode")
        return MetallicRoughness(
            **fields,
            **self._normal_and_occlusion(material),
            **self._parts(material),
            emission=(strength * red, strength * green, strength * blue),
            emissive_texture=self._texture(material, "emissiveTexture", srgb=True),
            unlit=material.extension("KHR_materials_unlit") is not None,
            double_sided=material.get_flag("doubleSided", False),
            alpha_mode=ALPHA_MODES[mode],
            alpha_cutoff=material.get_number("alphaCutoff", 0.5, 0.0),
            name=material.name(),
        )

    def _parts(self, material: Element) -> dict[str, Any]:
        """What the material extensions say; one that is broken is left out."""
        found: dict[str, Any] = {}
        for extension, key, usual in ((IOR, "ior", 1.5), (DISPERSION, "dispersion", 0.0)):
            try:
                given = material.extension(extension)
                value = usual if given is None else given.get_number(key, usual, 0.0)
                if key == "ior" and 0.0 < value < 1.0:
                    raise material.error(f"must be at least 1, or 0, got {value:g}", "extensions/KHR_materials_ior/ior")
                found[key] = value
            except LimnerError as error:
                self._notes.slip(f"drawn without: {without_path(error)}")
        for part in PARTS:
            try:
                given = material.extension(part.extension)
                if given is not None:
                    found[part.field] = self._part(given, part)
            except LimnerError as error:
                self._notes.slip(f"{part.extension} is left out: {without_path(error)}", material.pointer)
        return found

    def _part(self, given: Element, part: Part) -> Any:
        fields: dict[str, Any] = {}
        for key, (name, usual) in part.numbers.items():
            fields[name] = given.child(key).number() if given.has(key) else usual
        for key, (name, color) in part.colors.items():
            fields[name] = given.get_numbers(key, color, 0.0)
        for key, (name, srgb) in part.textures.items():
            fields[name] = self._texture(given, key, srgb=srgb)
            information = given.get(key)
            if name == "normal_texture" and information is not None:
                fields[NORMAL_SCALE] = information.get_number("scale", 1.0)
        return part.kind(**fields)

    def _metallic_roughness(self, material: Element) -> dict[str, Any]:
        given = material.get("pbrMetallicRoughness")
        if given is None:
            return {}
        *base, alpha = given.get_numbers("baseColorFactor", (1.0, 1.0, 1.0, 1.0), 0.0)
        return {
            "base_color": tuple(base),
            "alpha": min(alpha, 1.0),
            "metallic": given.get_number("metallicFactor", 1.0, 0.0, 1.0),
            "roughness": given.get_number("roughnessFactor", 1.0, 0.0, 1.0),
            "base_color_texture": self._texture(given, "baseColorTexture", srgb=True),
            "metallic_roughness_texture": self._texture(given, "metallicRoughnessTexture", srgb=False),
        }

    def _specular_glossiness(self, material: Element) -> dict[str, Any] | None:
        given = material.extension(_GLOSSY)
        if given is None or material.has("pbrMetallicRoughness"):
            return None
        *diffuse, alpha = (min(share, 1.0) for share in given.get_numbers("diffuseFactor", (1.0, 1.0, 1.0, 1.0), 0.0))
        specular = [min(share, 1.0) for share in given.get_numbers("specularFactor", (1.0, 1.0, 1.0), 0.0)]
        glossiness = given.get_number("glossinessFactor", 1.0, 0.0, 1.0)
        first = self._texture(given, "diffuseTexture", srgb=True)
        second = self._texture(given, "specularGlossinessTexture", srgb=True)
        if first is None and second is None:
            base, metallic = converted(diffuse, specular)
            fields: dict[str, Any] = {"base_color": tuple(base.tolist()), "metallic": float(metallic), "roughness": 1.0 - glossiness}
            return fields | {"alpha": alpha}
        self._notes.add(f"{_GLOSSY} is drawn as metallic and roughness, texel by texel", material.pointer)
        if first is not None and second is not None and not _alike(first, second):
            self._notes.add("its specular texture lies otherwise than the diffuse one and is left out", material.pointer)
            second = None
        colors, numbers = converted_texels(
            None if first is None else first.texels, None if second is None else second.texels, (diffuse, specular, glossiness)
        )
        look = first if first is not None else second
        assert look is not None
        return {
            "alpha": alpha,
            "base_color_texture": dataclasses.replace(look, texels=colors),
            "metallic_roughness_texture": dataclasses.replace(look, texels=numbers),
        }

    def _normal_and_occlusion(self, material: Element) -> dict[str, Any]:
        normal, occlusion = material.get("normalTexture"), material.get("occlusionTexture")
        fields: dict[str, Any] = {
            "normal_texture": self._texture(material, "normalTexture", srgb=False),
            "occlusion_texture": self._texture(material, "occlusionTexture", srgb=False),
        }
        if normal is not None:
            fields["normal_scale"] = normal.get_number("scale", 1.0)
        if occlusion is not None:
            fields["occlusion_strength"] = occlusion.get_number("strength", 1.0, 0.0, 1.0)
        return fields

    def _texture(self, owner: Element, key: str, *, srgb: bool) -> Texture | None:
        """Read the texture information `key`; None, with a slip, where it or its picture cannot be had."""
        information = owner.get(key)
        if information is None:
            return None
        try:
            return self._look(information, srgb=srgb)
        except LimnerError as error:
            self._notes.slip(f"drawn without, {without_path(error)}", information.pointer)
            return None

    def _look(self, information: Element, *, srgb: bool) -> Texture:
        uv_set = information.get_integer("texCoord", 0)
        offset, scale, rotation = (0.0, 0.0), (1.0, 1.0), 0.0
        transform = information.extension("KHR_texture_transform")
        if transform is not None:
            uv_set = transform.get_integer("texCoord", uv_set)
            given_offset = transform.get_numbers("offset", (0.0, 0.0))
            given_scale = transform.get_numbers("scale", (1.0, 1.0))
            rotation = transform.get_number("rotation", 0.0)
            offset, rotation, scale = turned_transform((given_offset[0], given_offset[1]), rotation, (given_scale[0], given_scale[1]))
        if uv_set > 1:
            raise information.error(f"only TEXCOORD_0 and TEXCOORD_1 are read, got {uv_set}", "texCoord")
        texels = self._texels(self._images_of(information), srgb=srgb)
        wrap_u, wrap_v, filtering = self._sampler_of(information)
        return Texture(texels, wrap_u=wrap_u, wrap_v=wrap_v, filter=filtering, uv_set=uv_set, offset=offset, scale=scale, rotation=rotation)

    def _texture_of(self, information: Element) -> Element:
        return self._textures[information.child("index").index(len(self._textures))]

    def _texels(self, images: list[Element], *, srgb: bool) -> Texels:
        """The texels of the first picture that can be had."""
        for k, image in enumerate(images):
            try:
                key, give = self._picture_source(image)
                return self._pictures.texels(key, give, srgb=srgb, name=_image_name(image))
            except LimnerError as error:
                told = image.error(str(error)) if isinstance(error, PictureError) else error
                if isinstance(error, UnsupportedError):
                    told = UnsupportedError(f"{image.path}, {image.pointer}: {error}")
                if k + 1 == len(images):
                    raise told from None
                self._notes.add(f"the picture of another format stands in: {without_path(told)}")
        raise AssertionError("a texture names at least one picture")

    def _images_of(self, information: Element) -> list[Element]:
        """The pictures that a texture names, all of the same: what is asked for first, then what may stand in for it."""
        texture = self._texture_of(information)
        extensions = [texture.extension(name) for name in PICTURE_EXTENSIONS]
        references = [extension.child("source") for extension in extensions if extension is not None]
        core = texture.get("source")
        references += [] if core is None else [core]
        if not references:
            unread = ", ".join(texture.child("extensions").keys()) if texture.has("extensions") else ""
            raise texture.error(f"its picture is in a format that is not read ({unread})" if unread else "names no picture")
        return [self._images[reference.index(len(self._images))] for reference in references]

    def _picture_source(self, image: Element) -> tuple[object, Callable[[], bytes | memoryview]]:
        """Return what names the picture (equal for the same file) and what reads its bytes."""
        uri = image.get("uri")
        if uri is None:
            view = image.child("bufferView")
            return ("view", view.integer()), lambda: self._accessors.view_bytes(view)
        reference, position = uri.text(), uri.pointer
        if reference[:5].lower() == "data:":
            return position, lambda: self._sources.read_data_uri(reference, position)
        return self._sources.locate(reference, position), lambda: self._sources.read_beside(reference, position)

    def _sampler_of(self, information: Element) -> tuple[Wrap, Wrap, Filter]:
        reference = self._texture_of(information).get("sampler")
        if reference is None:
            return "repeat", "repeat", "trilinear"
        try:
            sampler = self._samplers[reference.index(len(self._samplers))]
            wraps = [_one_of(sampler, key, tuple(WRAPS), 10497) for key in ("wrapS", "wrapT")]
            magnify = _one_of(sampler, "magFilter", FILTERS[:2], LINEAR)
            shrink = _one_of(sampler, "minFilter", FILTERS, FILTERS[-1])
        except FileFormatError as error:
            self._notes.slip(f"the default sampler stands in: {without_path(error)}")
            return "repeat", "repeat", "trilinear"
        filtering: Filter = "nearest" if magnify == NEAREST else "bilinear" if shrink in FILTERS[:2] else "trilinear"
        return WRAPS[wraps[0]], WRAPS[wraps[1]], filtering


def _one_of(owner: Element, key: str, allowed: tuple[int, ...], default: int) -> int:
    value = owner.get_integer(key, default)
    if value not in allowed:
        raise owner.error(f"must be one of {', '.join(map(str, allowed))}, got {quoted(value)}", key)
    return value


def _image_name(image: Element) -> str:
    uri = image.value.get("uri")
    beside = PurePosixPath(uri).name if isinstance(uri, str) and uri[:5].lower() != "data:" else ""
    return image.name() or beside


def _alike(one: Texture, other: Texture) -> bool:
    """Whether two textures differ in their texels at most."""
    return dataclasses.replace(other, texels=one.texels) == one


def _texture_informations(material: Any) -> list[dict[str, Any]]:
    """Find the texture informations that are read from the JSON of a material, whatever its types."""
    if not isinstance(material, dict):
        return []
    given = material.get("extensions")
    extensions = given if isinstance(given, dict) else {}
    core = material.get("pbrMetallicRoughness")
    owners = [material, core, *(extensions.get(part.extension) for part in PARTS)]
    owners += [extensions.get(_GLOSSY)] if "pbrMetallicRoughness" not in material else []
    found = [value for owner in owners if isinstance(owner, dict) for key, value in owner.items() if key.endswith("Texture")]
    return [information for information in found if isinstance(information, dict)]
