"""Pictures on surfaces: the texels, and how they are looked up (FoCG 11)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["MAX_TEXTURE_SIZE", "Filter", "Texels", "Texture", "Wrap"]

Wrap = Literal["repeat", "mirror", "clamp"]
Filter = Literal["nearest", "bilinear", "trilinear", "anisotropic", "ripmap"]

MAX_TEXTURE_SIZE = 16384


@dataclass(frozen=True, eq=False)
class Texels:
    """A raster of texels, shared by the textures that look into it.

    Parameters
    ----------
    pixels : (height, width, 4) uint8
        RGBA, straight alpha, row 0 at the *bottom* (v = 0): readers turn pictures once, on loading.
    srgb : bool
        The colour channels hold sRGB-encoded values; alpha is always linear.
    name : str
    """

    pixels: NDArray[np.uint8]
    srgb: bool = True
    name: str = ""

    def __post_init__(self) -> None:
        pixels = np.ascontiguousarray(self.pixels)
        if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 4 or 0 in pixels.shape:
            raise SceneError(f"texels.pixels must be (height, width, 4) uint8, got {pixels.shape} {pixels.dtype}", self.name)
        if max(pixels.shape[:2]) > MAX_TEXTURE_SIZE:
            raise SceneError(f"texels.pixels must not exceed {MAX_TEXTURE_SIZE} a side, got {pixels.shape[:2]}", self.name)
        pixels = pixels.view()
        pixels.flags.writeable = False
        object.__setattr__(self, "pixels", pixels)

    def __repr__(self) -> str:
        return f"Texels({self.name!r}, {self.pixels.shape[1]} x {self.pixels.shape[0]})"

    @classmethod
    def from_top_down(cls, pixels: Any, *, srgb: bool = True, name: str = "") -> Texels:
        """Make texels of a picture as Python holds it: (height, width) or (height, width, 1|2|3|4) uint8, row 0 on top."""
        given = np.asarray(pixels)
        if given.ndim == 2:
            given = given[:, :, None]
        if given.dtype != np.uint8 or given.ndim != 3 or given.shape[2] not in (1, 2, 3, 4) or 0 in given.shape:
            raise SceneError(f"a texture must be (height, width, channels) uint8, got {given.shape} {given.dtype}", name)
        channels = given.shape[2]
        rgba = np.empty((*given.shape[:2], 4), dtype=np.uint8)
        rgba[..., :3] = given[..., :3] if channels >= 3 else given[..., :1]
        rgba[..., 3] = given[..., channels - 1] if channels in (2, 4) else 255
        return cls(rgba[::-1], srgb=srgb, name=name)


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
    """

    texels: Texels
    wrap_u: Wrap = "repeat"
    wrap_v: Wrap = "repeat"
    filter: Filter = "trilinear"
    uv_set: int = 0
    offset: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0

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
