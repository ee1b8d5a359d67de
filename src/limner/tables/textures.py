"""Textures as kernels read them: one record each, and the texels of all levels in one array of bytes.

Texels are reduced to mipmaps, or to ripmaps where a texture asks for them; the mipmaps are then among these.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..image.mipmap import copy_places, level_sizes, mipmaps, ripmaps, side_lengths
from ..linear.transform import rotate
from ..scene.procedural import Checker, Gradient, Marble, Noise, Pattern, Stripes, Turbulence, Wood
from ..scene.texture import AnyTexture, Texels, Texture
from . import layouts

__all__ = ["asks_for_detail", "mean_color", "texture_tables"]

_WRAPS = {"repeat": layouts.REPEAT, "mirror": layouts.MIRROR, "clamp": layouts.CLAMP}
_FILTERS = {
    "nearest": layouts.NEAREST,
    "bilinear": layouts.BILINEAR,
    "trilinear": layouts.TRILINEAR,
    "anisotropic": layouts.ANISOTROPIC,
    "ripmap": layouts.RIPMAP,
}


_KINDS: dict[type, int] = {
    Checker: layouts.CHECKER,
    Stripes: layouts.STRIPES,
    Gradient: layouts.GRADIENT,
    Noise: layouts.NOISE,
    Turbulence: layouts.TURBULENCE,
    Marble: layouts.MARBLE,
    Wood: layouts.WOOD,
}
_FORMATS = {np.dtype(np.uint8): layouts.BYTE_TEXELS, np.dtype(np.uint16): layouts.WORD_TEXELS, np.dtype(np.float32): layouts.FLOAT_TEXELS}
_SHARE_OF_CELL = 1.0 / 32.0  # of the finest octave: where a difference of heights is a slope


def texture_tables(textures: Sequence[AnyTexture]) -> tuple[NDArray[np.void], NDArray[np.uint8]]:
    """(n,) TEXTURE and (k,) uint8: texels shared by several textures stand there once."""
    records = np.zeros(len(textures), dtype=layouts.TEXTURE)
    pictures = [texture for texture in textures if isinstance(texture, Texture)]
    ripmapped = {id(texture.texels) for texture in pictures if texture.filter == "ripmap"}
    starts: dict[int, int] = {}
    distinct: list[Texels] = []
    total = 0
    for texture in pictures:
        held = texture.texels
        if id(held) not in starts:
            starts[id(held)] = total
            distinct.append(held)
            total += _n_bytes(held, id(held) in ripmapped)
    texels = np.empty(total, dtype=np.uint8)
    for held in distinct:
        reduce = ripmaps if id(held) in ripmapped else mipmaps
        reduce(held.pixels, held.srgb, texels[starts[id(held)] :])
    for record, given in zip(records, textures, strict=True):
        if isinstance(given, Texture):
            _fill(record, given)
            _place(record, starts[id(given.texels)], id(given.texels) in ripmapped)
        else:
            _fill_pattern(record, given)
    return records, texels


def _n_bytes(texels: Texels, ripmapped: bool) -> int:
    height, width = texels.pixels.shape[:2]
    if ripmapped:
        return 4 * texels.pixels.itemsize * sum(side_lengths(width)) * sum(side_lengths(height))
    return sum(4 * texels.pixels.itemsize * w * h for w, h in level_sizes(width, height))


def _place(record: np.void, start: int, ripmapped: bool) -> None:
    """Fill in where the levels begin."""
    width, height = int(record["width"]), int(record["height"])
    n_levels, per_channel = int(record["n_levels"]), 1 << int(record["format"])
    if not ripmapped:
        sizes = [4 * per_channel * w * h for w, h in level_sizes(width, height)]
        record["level"][:n_levels] = start + np.cumsum([0, *sizes[:-1]])
        return
    widths, heights = side_lengths(width), side_lengths(height)
    record["n_columns"], record["n_rows"] = len(widths), len(heights)
    record["widths"][: len(widths) + 1] = np.cumsum([0, *widths])
    record["heights"][: len(heights) + 1] = np.cumsum([0, *heights])
    diagonal = np.arange(n_levels)
    places = copy_places(width, height) * per_channel
    record["level"][:n_levels] = start + places[np.minimum(diagonal, len(heights) - 1), np.minimum(diagonal, len(widths) - 1)]


def _fill(record: np.void, texture: Texture) -> None:
    height, width = texture.texels.pixels.shape[:2]
    c, s = math.cos(texture.rotation), math.sin(texture.rotation)
    su, sv = texture.scale
    record["transform"] = [[c * su, -s * sv, texture.offset[0]], [s * su, c * sv, texture.offset[1]]]
    record["width"], record["height"], record["n_levels"] = width, height, max(width, height).bit_length()
    record["srgb"], record["uv_set"] = texture.texels.srgb, texture.uv_set
    record["wrap_u"], record["wrap_v"] = _WRAPS[texture.wrap_u], _WRAPS[texture.wrap_v]
    record["filter"] = _FILTERS[texture.filter]
    record["kind"], record["format"] = layouts.PICTURE, _FORMATS[texture.texels.pixels.dtype]
    record["mapping"] = layouts.TRIPLANAR_MAPPING if texture.mapping == "triplanar" else layouts.UV_MAPPING
    record["sharpness"] = texture.sharpness
    is_usual = texture.mapping == "uv" and texture.filter in ("nearest", "bilinear", "trilinear")
    record["seldom"] = not (is_usual and record["format"] == layouts.BYTE_TEXELS)
    # Half a texel, in texture coordinates before the transform, or in object space.
    linear = np.abs(record["transform"][:, :2].astype(np.float64))
    texels_per_uv = np.maximum(linear[0] * width, linear[1] * height)
    steps = 0.5 / np.maximum(texels_per_uv, 1e-6)
    record["bump_step"] = steps.min() if texture.mapping == "triplanar" else steps


def _fill_pattern(record: np.void, pattern: Pattern) -> None:
    record["kind"], record["seldom"], record["uv_set"] = _KINDS[type(pattern)], 1, pattern.uv_set
    record["mapping"] = layouts.OBJECT_MAPPING if pattern.mapping == "object" else layouts.UV_MAPPING
    scale = np.array(pattern.scale)
    record["pattern_from_place"][:, :3] = _turned(pattern) * scale
    record["pattern_from_place"][:, 3] = pattern.offset
    record["octaves"], record["gain"], record["lacunarity"] = getattr(pattern, "octaves", 1), 0.5, 2.0
    record["seed"] = getattr(pattern, "seed", 0)
    if isinstance(pattern, (Noise, Turbulence)):
        record["gain"], record["lacunarity"] = pattern.gain, pattern.lacunarity
    if isinstance(pattern, Noise):
        record["amount"] = 1.0 / sum(pattern.gain**k for k in range(pattern.octaves))
    elif isinstance(pattern, (Marble, Wood)):
        record["amount"] = pattern.amount
    elif isinstance(pattern, Stripes):
        record["amount"] = pattern.share
    elif isinstance(pattern, Gradient):
        record["wrap_u"] = _WRAPS[pattern.wrap]
    finest = float(record["lacunarity"]) ** (int(record["octaves"]) - 1) * float(np.abs(scale).max())
    record["bump_step"] = _SHARE_OF_CELL / max(finest, float(np.abs(scale).max()))
    _fill_ramp(record, pattern)


def _turned(pattern: Pattern) -> NDArray[np.float64]:
    """The rotation that takes a pattern's axis to the one along which the kernels have it: +y for rings, else +x."""
    axis, target = np.array(pattern.axis), np.array([0.0, 1.0, 0.0]) if isinstance(pattern, Wood) else np.array([1.0, 0.0, 0.0])
    if np.array_equal(axis, target):
        return np.eye(3)
    turn = np.cross(axis, target)
    if np.linalg.norm(turn) < 1e-12:
        return rotate((0.0, 0.0, 1.0), math.pi)[:3, :3] if axis @ target < 0.0 else np.eye(3)
    return rotate(turn, math.atan2(float(np.linalg.norm(turn)), float(axis @ target)))[:3, :3]


def _fill_ramp(record: np.void, pattern: Pattern) -> None:
    assert pattern.positions is not None
    n = len(pattern.colors)
    stops = np.array(pattern.positions, dtype=np.float32)
    gaps = np.diff(stops)
    record["n_stops"], record["stop"][:n] = n, stops
    # Two stops in one place: a step, which any number above it has passed.
    record["stop_rise"][1:n] = np.where(gaps > 1e-30, 1.0 / np.maximum(gaps, np.float32(1e-30)), np.float32(3e38))
    record["stop_color"][:n] = [(*color, 1.0)[:4] for color in pattern.colors]


def asks_for_detail(texture: AnyTexture | None) -> bool:
    """Whether looking a texture up takes the place on the object."""
    return texture is not None and texture.mapping in ("object", "triplanar")


def mean_color(texture: AnyTexture) -> NDArray[np.float64]:
    """About what a texture is in the mean, linear: (3,) float64, of some of its texels, or of its ramp."""
    if not isinstance(texture, Texture):
        return np.asarray(np.mean([color[:3] for color in texture.colors], axis=0))
    pixels, white = texture.texels.pixels, texture.texels.white
    few = pixels[:: max(1, pixels.shape[0] // 64), :: max(1, pixels.shape[1] // 64), :3] / np.float64(white)
    return np.asarray((few**2.2 if white > 1.0 else np.maximum(few, 0.0)).mean(axis=(0, 1)))
