"""Pictures on surfaces: the texels, and how they are looked up (FoCG 11)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ._values import finite
from .procedural import Pattern

__all__ = ["MAX_TEXTURE_SIZE", "AnyTexture", "Filter", "Mapping", "Texels", "Texture", "Wrap"]

Wrap = Literal["repeat", "mirror", "clamp"]
Filter = Literal["nearest", "bilinear", "trilinear", "anisotropic", "ripmap"]
Mapping = Literal["uv", "triplanar"]

MAX_TEXTURE_SIZE = 16384
_DEPTHS = {np.dtype(np.uint8): 255, np.dtype(np.uint16): 65535, np.dtype(np.float32): 1.0}


@dataclass(frozen=True, eq=False)
class Texels:
    """A raster of texels, shared by the textures that look into it.

    Parameters
    ----------
    pixels : (height, width, 4) uint8, uint16 or float32
        RGBA, straight alpha, row 0 at the *bottom* (v = 0): readers turn pictures once, on loading. Integers stand for [0, 1]; floats
        are finite, may exceed 1, and are linear.
    srgb : bool
        The colour channels hold sRGB-encoded values; alpha is always linear.
    name : str
    """

    pixels: NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]
    srgb: bool = True
    name: str = ""

    def __post_init__(self) -> None:
        pixels: NDArray[Any] = np.ascontiguousarray(self.pixels)
        if pixels.dtype not in _DEPTHS or pixels.ndim != 3 or pixels.shape[2] != 4 or 0 in pixels.shape:
            kinds = "(height, width, 4) uint8, uint16 or float32"
            raise SceneError(f"texels.pixels must be {kinds}, got {pixels.shape} {pixels.dtype}", self.name)
        _check_size(pixels, self.name)
        if pixels.dtype == np.float32:
            if self.srgb:
                raise SceneError("texels.srgb must be False for float32 texels, which are linear", self.name)
            if not np.isfinite(pixels).all():
                row, column = (int(k) for k in np.argwhere(~np.isfinite(pixels).all(axis=2))[0])
                raise SceneError(f"texels.pixels must be finite, got {pixels[row, column]} at row {row}, column {column}", self.name)
        pixels = pixels.view()
        pixels.flags.writeable = False
        object.__setattr__(self, "pixels", pixels)

    def __repr__(self) -> str:
        return f"Texels({self.name!r}, {self.pixels.shape[1]} x {self.pixels.shape[0]})"

    @classmethod
    def from_top_down(cls, pixels: Any, *, srgb: bool = True, name: str = "") -> Texels:
        """Make texels of a picture as Python holds it, row 0 on top.

        Parameters
        ----------
        pixels : (height, width) or (height, width, 1 to 4 channels) uint8, uint16 or floats
            Grey or colour, with alpha where there are 2 or 4 channels.
        srgb : bool
            Of integers; floats are linear, whatever is said here.
        name : str
        """
        given = np.asarray(pixels)
        if given.ndim == 2:
            given = given[:, :, None]
        if given.dtype.kind == "f":
            with np.errstate(over="ignore"):
                given = given.astype(np.float32)
        if given.dtype not in _DEPTHS or given.ndim != 3 or given.shape[2] not in (1, 2, 3, 4) or 0 in given.shape:
            kinds = "(height, width, channels) uint8, uint16 or floats"
            raise SceneError(f"a texture must be {kinds}, got {given.shape} {given.dtype}", name)
        _check_size(given, name)
        channels = given.shape[2]
        rgba = np.empty((*given.shape[:2], 4), dtype=given.dtype)
        rgba[..., :3] = given[..., :3] if channels >= 3 else given[..., :1]
        rgba[..., 3] = given[..., channels - 1] if channels in (2, 4) else _DEPTHS[given.dtype]
        return cls(rgba[::-1], srgb=srgb and given.dtype != np.float32, name=name)

    @property
    def white(self) -> float:
        """The number that stands for 1: 255, 65535 or 1.0."""
        return _DEPTHS[self.pixels.dtype]


def _check_size(pixels: NDArray[Any], name: str) -> None:
    height, width = pixels.shape[:2]
    if max(width, height) > MAX_TEXTURE_SIZE:
        raise SceneError(f"a texture must not exceed {MAX_TEXTURE_SIZE} texels a side, got {width} x {height}", name)


@dataclass(frozen=True)
class Texture:
    """How a surface looks into texels.

    Parameters
    ----------
    texels : Texels
    wrap_u, wrap_v : "repeat" | "mirror" | "clamp"
        What lies outside [0, 1].
    filter : "nearest" | "bilinear" | "trilinear" | "anisotropic" | "ripmap"
        Trilinear: bilinear in two mipmap levels, the level from the longer side of the pixel's footprint. Anisotropic: up to 16 such
        lookups along it, the level from the shorter side; the sharpest and the slowest towards the horizon. Ripmap: one lookup in
        copies reduced separately in width and height, which take four times the texels' memory; for footprints along u or v.
    uv_set : 0 or 1
        Which texture coordinates of the mesh.
    offset, scale : (2,) floats
    rotation : float
        Radians, counter-clockwise with v up: the coordinates become ``T(offset) R(rotation) S(scale) (u, v)``.
    mapping : "uv" | "triplanar"
        By texture coordinates; or tri-planar: the picture is seen along each axis of the object, upright, one unit of the object wide, and
        the three are mixed as the surface faces them. For shapes without texture coordinates; the picture should tile.
    sharpness : float from 0 to 64
        Tri-planar: the weights are |n|^sharpness. The greater, the narrower are the places where two pictures mix.
    """

    texels: Texels
    wrap_u: Wrap = "repeat"
    wrap_v: Wrap = "repeat"
    filter: Filter = "trilinear"
    uv_set: int = 0
    offset: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0
    mapping: Mapping = "uv"
    sharpness: float = 4.0

    def __post_init__(self) -> None:
        for field in ("wrap_u", "wrap_v"):
            if getattr(self, field) not in ("repeat", "mirror", "clamp"):
                raise SceneError(f'texture.{field} must be "repeat", "mirror" or "clamp", got {getattr(self, field)!r}')
        if self.filter not in get_args(Filter):
            names = ", ".join(f'"{name}"' for name in get_args(Filter)[:-1])
            raise SceneError(f'texture.filter must be {names} or "{get_args(Filter)[-1]}", got {self.filter!r}')
        if self.uv_set not in (0, 1):
            raise SceneError(f"texture.uv_set must be 0 or 1, got {self.uv_set!r}")
        if not all(math.isfinite(x) for x in (*self.offset, *self.scale, self.rotation)):
            raise SceneError("texture.offset, scale and rotation must be finite")
        if self.mapping not in ("uv", "triplanar"):
            raise SceneError(f'texture.mapping must be "uv" or "triplanar", got {self.mapping!r}')
        if not 0.0 <= finite(self.sharpness, "texture.sharpness") <= 64.0:
            raise SceneError(f"texture.sharpness must lie in [0, 64], got {self.sharpness}")


AnyTexture: TypeAlias = Texture | Pattern
"""What a material can look up: a picture or a pattern."""
