"""Mipmaps and ripmaps: a picture at ever halved resolution (FoCG 11.3.3).

A mipmap halves width and height together (Williams, *Pyramidal parametrics*, 1983) and takes a third more than the picture; a ripmap
halves them separately, for footprints that are longer than wide, and takes four times the picture.

Each level averages two by two texels of the one above, in linear light; where a side is odd its last row or column is left out.
Colour is weighted by alpha, so that what is transparent does not bleed in.

    mipmap         ripmap
    +-----+        +-----+--+-+
    |     |        |     |  | |    a row of copies has one height, a column one width;
    |     |        |     |  | |    the mipmap is the diagonal, to the bit
    +-----+--+     +-----+--+-+
          |  |     |     |  | |
          +--+-+   +-----+--+-+
             +-+   +-----+--+-+
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar

__all__ = ["copy_places", "level_sizes", "mipmaps", "ripmaps", "side_lengths"]

_reduce = Door(
    "limner.image.mipmap_kernel",
    "reduce_level",
    (Array(np.uint8, 1), *(7 * (Scalar(np.int64),))),
    "texture mipmaps",
)


def level_sizes(width: int, height: int) -> list[tuple[int, int]]:
    """(width, height) of each level, from the full picture to one texel."""
    sizes = [(width, height)]
    while sizes[-1] != (1, 1):
        sizes.append((max(1, sizes[-1][0] // 2), max(1, sizes[-1][1] // 2)))
    return sizes


def side_lengths(side: int) -> list[int]:
    """A side and its halves, rounded down, to one texel."""
    return [side >> k for k in range(side.bit_length())]


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
        _reduce(out, place, place + 4 * w * h, w, h, 2, 2, int(srgb))
        place += 4 * w * h


def copy_places(width: int, height: int) -> NDArray[np.int64]:
    """Where the copies of a ripmap begin, in bytes: ``[k, l]`` is halved k times in height, l times in width."""
    widths, heights = side_lengths(width), side_lengths(height)
    rows = np.array([sum(heights[:k]) * sum(widths) for k in range(len(heights))], dtype=np.int64)
    columns = np.array([sum(widths[:k]) for k in range(len(widths))], dtype=np.int64)
    return 4 * (rows[:, None] + np.array(heights, dtype=np.int64)[:, None] * columns)


def ripmaps(pixels: NDArray[np.uint8], srgb: bool, out: NDArray[np.uint8]) -> None:
    """Write `pixels` at every pair of halved widths and halved heights into `out`, where `copy_places` says.

    What was halved oftener is halved once more, both where they are even: so the copies reduced alike in width and height are the
    mipmap levels, and none is rounded oftener than they.

    Parameters
    ----------
    pixels : (height, width, 4) uint8
    srgb : bool
        Whether the colours are sRGB-encoded; they are averaged decoded.
    out : (>= 4 * sum of all widths * sum of all heights,) uint8
    """
    height, width = pixels.shape[:2]
    out[: pixels.size] = pixels.reshape(-1)
    places = copy_places(width, height)
    widths, heights = side_lengths(width), side_lengths(height)
    for row in range(len(heights)):
        for column in range(len(widths)):
            if row == column == 0:
                continue
            down, across = int(row >= column), int(column >= row)
            source, target = places[row - down, column - across], places[row, column]
            _reduce(out, source, target, widths[column - across], heights[row - down], 1 + across, 1 + down, int(srgb))
