"""Textures of Mitsuba scenes: pictures and checkerboards, and how they lie on texture coordinates.

Mitsuba's v runs downwards in pictures: v = 0 is their first row. Inside, v points up, so what lies between, a placement of the texture
coordinates ``to_uv``, is seen in a mirror: ``F T F`` with ``F: v -> 1 - v``. Readers of shapes turn the coordinates themselves.
"""

from __future__ import annotations

import dataclasses
import math
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError, LimnerWarning
from ..scene.procedural import Checker
from ..scene.texture import AnyTexture, Filter, Texels, Texture, Wrap
from .mitsuba_properties import Properties
from .mitsuba_xml import Element
from .notes import Notes, quoted, without_path
from .pictures import Pictures, picture_format
from .radiance import read_radiance
from .sources import Sources

__all__ = ["Painted", "Textures", "green_turned", "grey_of"]

Triple = tuple[float, float, float]

_FLIP = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, 1.0]])
_WRAPS: dict[str, Wrap] = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp", "zero": "clamp", "one": "clamp"}
_FILTERS: dict[str, Filter] = {"bilinear": "trilinear", "nearest": "nearest", "trilinear": "trilinear", "ewa": "anisotropic"}
_GREY = (0.5, 0.5, 0.5)


class Painted(NamedTuple):
    """A colour, and what multiplies it; `by_vertex`: the mesh's own colours do."""

    color: Triple
    texture: AnyTexture | None = None
    by_vertex: bool = False


class Textures:
    """The textures of one scene; each picture is decoded once.

    Parameters
    ----------
    sources : Sources
    notes : Notes
    """

    def __init__(self, sources: Sources, notes: Notes) -> None:
        self._sources = sources
        self._notes = notes
        self._pictures = Pictures(sources.limits)
        self._decoded: set[str] = set()
        self._light: dict[str, Texels] = {}

    def painted(self, element: Element, *, data: bool = False) -> Painted:
        """What a texture shows; `data`: its numbers are no colours (roughness, heights, normals)."""
        properties = Properties(element, self._sources)
        if element.kind == "bitmap":
            return self._bitmap(properties, data)
        if element.kind == "checkerboard":
            return self._checkerboard(properties)
        if element.kind == "mesh_attribute" and properties.text("name").startswith("vertex_"):
            scale = properties.number("scale", 1.0)
            return Painted((scale, scale, scale), by_vertex=True)
        color = self._mean(properties)
        self._notes.add(f"{properties.what} is not read; one colour stands in", properties.where, kind="replaced", what=properties.what)
        return Painted(color)

    def _mean(self, properties: Properties) -> Triple:
        colors = [properties.color_in(child) for child in properties.element.children if child.tag in ("rgb", "spectrum")]
        if not colors:
            return _GREY
        red, green, blue = np.mean(colors, axis=0).tolist()
        return red, green, blue

    # Pictures

    def _bitmap(self, properties: Properties, data: bool) -> Painted:
        name = properties.text("filename")
        raw = properties.flag("raw", False) or data
        wrap, kind = properties.text("wrap_mode", "repeat"), properties.text("filter_type", "bilinear")
        place = _placement(properties)
        properties.skip("gamma", "max_anisotropy", "cache", "format", "accel")
        try:
            if not name:
                raise properties.error("bitmap needs a filename")
            texels = self._texels(name, properties.where, srgb=not raw)
        except LimnerError as error:
            text = f"drawn without its texture {quoted(name)}: {without_path(error)}"
            self._notes.slip(text, properties.where, kind="replaced", what=properties.what)
            return Painted(_GREY)
        if wrap not in _WRAPS or wrap in ("zero", "one"):
            self._notes.add(f"wrap_mode {quoted(wrap)} is drawn as clamp", properties.where, kind="approximated", what=properties.what)
        rotation, scale, is_exact = _decomposed(place)
        if not is_exact:
            text = "the texture coordinates are sheared; they are only turned and scaled"
            self._notes.add(text, properties.where, kind="approximated", what=properties.what)
        along: Wrap = _WRAPS.get(wrap, "clamp")
        texture = Texture(
            texels, wrap_u=along, wrap_v=along, filter=_FILTERS.get(kind, "trilinear"),
            offset=(float(place[0, 2]), float(place[1, 2])), scale=scale, rotation=rotation,
        )  # fmt: skip
        self._note_unknown(properties)
        return Painted((1.0, 1.0, 1.0), texture)

    def _texels(self, name: str, where: str, *, srgb: bool) -> Texels:
        if name in self._light:
            return self._light[name]
        if name in self._decoded:
            return self._pictures.texels(name, bytes, srgb=srgb, name=name)
        data = self._sources.read_beside(name, where)
        if picture_format(data):
            self._decoded.add(name)
            return self._pictures.texels(name, lambda: data, srgb=srgb, name=name)
        with warnings.catch_warnings():
            # Its repairs are told in the report, like everything else.
            warnings.simplefilter("ignore", LimnerWarning)
            pixels = read_radiance(self._sources.locate(name, where), limits=self._sources.limits)
        self._light[name] = Texels.from_top_down(pixels, srgb=False, name=name)
        return self._light[name]

    # Checkerboards

    def _checkerboard(self, properties: Properties) -> Painted:
        """color0 where both halves of u and v are the lower, or both the upper; seen with v upwards, the other way about."""
        first, second = (self._plain(properties, name, level) for name, level in (("color0", 0.4), ("color1", 0.2)))
        place = _placement(properties)
        rotation, scale, is_exact = _decomposed(place)
        if abs(math.sin(2.0 * rotation)) > 1e-9 or not is_exact:
            text = "a checkerboard that is turned on the texture coordinates is drawn straight"
            self._notes.add(text, properties.where, kind="approximated", what=properties.what)
        swaps = abs(math.sin(rotation)) > 0.5
        scale_u, scale_v = (scale[1], scale[0]) if swaps else scale
        across, up = 2.0 * float(place[0, 2]), 2.0 * float(place[1, 2])
        self._note_unknown(properties)
        return Painted(
            (1.0, 1.0, 1.0),
            Checker((second, first), scale=(2.0 * scale_u or 1.0, 2.0 * scale_v or 1.0, 1.0), offset=(across, up, 0.0), mapping="uv"),
        )

    def _plain(self, properties: Properties, name: str, level: float) -> Triple:
        child = properties.child(name)
        if child is not None and child.tag == "texture":
            painted = self.painted(child)
            if painted.texture is not None:
                text = "a picture in a checkerboard is drawn as one colour"
                self._notes.add(text, properties.where, kind="approximated", what=properties.what)
                return _GREY
            return painted.color
        return properties.color(name, level)

    def _note_unknown(self, properties: Properties) -> None:
        for child in properties.unknown():
            self._notes.add(f"{properties.what}: {quoted(child.name)} is ignored", child.where, kind="ignored", what=properties.what)


def green_turned(texture: Texture) -> Texture:
    """A normal map whose green channel points the other way.

    Mitsuba's green points along n x dp/du, limner's along dp/dv, which is the other way where a picture lies mirrored on its surface.
    """
    texels = texture.texels
    pixels = texels.pixels.copy()
    pixels[..., 1] = pixels.dtype.type(texels.white) - pixels[..., 1]
    return dataclasses.replace(texture, texels=Texels(pixels, srgb=texels.srgb, name=texels.name))


def grey_of(texture: Texture) -> Texture:
    """The picture with its luminance in every channel: of a colour, Mitsuba takes that as a height."""
    texels = texture.texels
    colors = texels.pixels[..., :3]
    if (colors == colors[..., :1]).all():
        return texture
    grey = colors @ np.array([0.2126, 0.7152, 0.0722])
    pixels = texels.pixels.copy()
    pixels[..., :3] = (grey if pixels.dtype.kind == "f" else np.round(grey))[..., None]
    return dataclasses.replace(texture, texels=Texels(pixels, srgb=texels.srgb, name=texels.name))


def _placement(properties: Properties) -> NDArray[np.float64]:
    """(3, 3) float64: from texture coordinates with v upwards to those of the picture, v upwards too."""
    matrix = properties.transform("to_uv")
    place = np.eye(3)
    place[:2, :2], place[:2, 2] = matrix[:2, :2], matrix[:2, 3]
    for axis, letter in enumerate("uv"):  # as scenes before 2.0 said it
        place[axis] *= properties.number(f"{letter}scale", 1.0)
        place[axis, 2] += properties.number(f"{letter}offset", 0.0)
    flipped: NDArray[np.float64] = _FLIP @ place @ _FLIP
    return flipped


def _decomposed(place: NDArray[np.float64]) -> tuple[float, tuple[float, float], bool]:
    """The angle and the scales of R(angle) S(scale), and whether that is all there is."""
    a = place[:2, :2]
    rotation = math.atan2(float(a[1, 0]), float(a[0, 0]))
    c, s = math.cos(rotation), math.sin(rotation)
    turned_back = np.array([[c, s], [-s, c]]) @ a
    return rotation, (float(turned_back[0, 0]), float(turned_back[1, 1])), bool(abs(turned_back[0, 1]) < 1e-6 * (1.0 + np.abs(a).max()))
