"""Textures as kernels read them: one record each, and the texels of all levels in one array of bytes.

Texels are reduced to mipmaps, or to ripmaps where a texture asks for them; the mipmaps are then among these.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..image.mipmap import copy_places, level_sizes, mipmaps, ripmaps, side_lengths
from ..scene.texture import Texels, Texture
from . import layouts

__all__ = ["texture_tables"]

_WRAPS = {"repeat": layouts.REPEAT, "mirror": layouts.MIRROR, "clamp": layouts.CLAMP}
_FILTERS = {
    "nearest": layouts.NEAREST,
    "bilinear": layouts.BILINEAR,
    "trilinear": layouts.TRILINEAR,
    "anisotropic": layouts.ANISOTROPIC,
    "ripmap": layouts.RIPMAP,
}


def texture_tables(textures: Sequence[Texture]) -> tuple[NDArray[np.void], NDArray[np.uint8]]:
    """(n,) TEXTURE and (k,) uint8: texels shared by several textures stand there once."""
    records = np.zeros(len(textures), dtype=layouts.TEXTURE)
    ripmapped = {id(texture.texels) for texture in textures if texture.filter == "ripmap"}
    starts: dict[int, int] = {}
    distinct: list[Texels] = []
    total = 0
    for texture in textures:
        held = texture.texels
        if id(held) not in starts:
            starts[id(held)] = total
            distinct.append(held)
            total += _n_bytes(held, id(held) in ripmapped)
    texels = np.empty(total, dtype=np.uint8)
    for held in distinct:
        reduce = ripmaps if id(held) in ripmapped else mipmaps
        reduce(held.pixels, held.srgb, texels[starts[id(held)] :])
    for record, texture in zip(records, textures, strict=True):
        _fill(record, texture)
        _place(record, starts[id(texture.texels)], id(texture.texels) in ripmapped)
    return records, texels


def _n_bytes(texels: Texels, ripmapped: bool) -> int:
    height, width = texels.pixels.shape[:2]
    if ripmapped:
        return 4 * sum(side_lengths(width)) * sum(side_lengths(height))
    return sum(4 * w * h for w, h in level_sizes(width, height))


def _place(record: np.void, start: int, ripmapped: bool) -> None:
    """Fill in where the levels begin."""
    width, height = int(record["width"]), int(record["height"])
    n_levels = int(record["n_levels"])
    if not ripmapped:
        sizes = [4 * w * h for w, h in level_sizes(width, height)]
        record["level"][:n_levels] = start + np.cumsum([0, *sizes[:-1]])
        return
    widths, heights = side_lengths(width), side_lengths(height)
    record["n_columns"], record["n_rows"] = len(widths), len(heights)
    record["widths"][: len(widths) + 1] = np.cumsum([0, *widths])
    record["heights"][: len(heights) + 1] = np.cumsum([0, *heights])
    diagonal = np.arange(n_levels)
    places = copy_places(width, height)
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
