"""Mipmaps: a picture at ever halved resolution (FoCG 11.3.3; Williams, *Pyramidal parametrics*, 1983).

Each level averages two by two texels of the one above, in linear light; where a side is odd the last row or column is averaged
with itself. Colour is weighted by alpha, so that what is transparent does not bleed in.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar

__all__ = ["level_sizes", "mipmaps"]

_reduce = Door(
    "limner.image.mipmap_kernel",
    "reduce_level",
    (Array(np.uint8, 1), Scalar(np.int64), Scalar(np.int64), Scalar(np.int64), Scalar(np.int64), Scalar(np.int64)),
    "texture mipmaps",
)


def level_sizes(width: int, height: int) -> list[tuple[int, int]]:
    """(width, height) of each level, from the full picture to one texel."""
    sizes = [(width, height)]
    while sizes[-1] != (1, 1):
        sizes.append((max(1, sizes[-1][0] // 2), max(1, sizes[-1][1] // 2)))
    return sizes


def mipmaps(pixels: NDArray[np.uint8], srgb: bool, out: NDArray[np.uint8]) -> None:
    """Write all levels of `pixels`, one after the other, into `out`.

    Parameters
    ----------
    pixels : (height, width, 4) uint8
    srgb : bool
        Whether the colours are sRGB-encoded; they are averaged decoded.
    out : (>= 4 * sum of all levels,) uint8
    """
    height, width = pixels.shape[:2]
    out[: pixels.size] = pixels.reshape(-1)
    place = 0
    for w, h in level_sizes(width, height)[:-1]:
        _reduce(out, place, place + 4 * w * h, w, h, int(srgb))
        place += 4 * w * h
