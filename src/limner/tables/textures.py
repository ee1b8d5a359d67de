"""Textures as kernels read them: one record each, and the texels of all mipmap levels in one array of bytes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..image.mipmap import level_sizes, mipmaps
from ..scene.texture import Texels, Texture
from . import layouts

__all__ = ["texture_tables"]

_WRAPS = {"repeat": layouts.REPEAT, "mirror": layouts.MIRROR, "clamp": layouts.CLAMP}
_FILTERS = {"nearest": layouts.NEAREST, "bilinear": layouts.BILINEAR, "trilinear": layouts.TRILINEAR}


def texture_tables(textures: Sequence[Texture]) -> tuple[NDArray[np.void], NDArray[np.uint8]]:
    """(n,) TEXTURE and (k,) uint8: texels shared by several textures stand there once."""
    records = np.zeros(len(textures), dtype=layouts.TEXTURE)
    starts: dict[int, int] = {}
    distinct: list[Texels] = []
    total = 0
    for texture in textures:
        if id(texture.texels) not in starts:
            starts[id(texture.texels)] = total
            distinct.append(texture.texels)
            height, width = texture.texels.pixels.shape[:2]
            total += sum(4 * w * h for w, h in level_sizes(width, height))
    texels = np.empty(total, dtype=np.uint8)
    for held in distinct:
        mipmaps(held.pixels, held.srgb, texels[starts[id(held)] :])
    for record, texture in zip(records, textures, strict=True):
        _fill(record, texture, starts[id(texture.texels)])
    return records, texels


def _fill(record: np.void, texture: Texture, start: int) -> None:
    height, width = texture.texels.pixels.shape[:2]
    sizes = level_sizes(width, height)
    place = start
    for level, (w, h) in enumerate(sizes):
        record["level"][level] = place
        place += 4 * w * h
    c, s = math.cos(texture.rotation), math.sin(texture.rotation)
    su, sv = texture.scale
    record["transform"] = [[c * su, -s * sv, texture.offset[0]], [s * su, c * sv, texture.offset[1]]]
    record["width"], record["height"], record["n_levels"] = width, height, len(sizes)
    record["srgb"], record["uv_set"] = texture.texels.srgb, texture.uv_set
    record["wrap_u"], record["wrap_v"] = _WRAPS[texture.wrap_u], _WRAPS[texture.wrap_v]
    record["filter"] = _FILTERS[texture.filter]
