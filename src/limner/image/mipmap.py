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

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..color.transfer import linear_from_srgb, srgb_from_linear

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


def mipmaps(pixels: NDArray[Any], srgb: bool, out: NDArray[np.uint8]) -> None:
    """Write all levels of `pixels`, one after the other, into `out`.

    Parameters
    ----------
    pixels : (height, width, 4) uint8, uint16 or float32
    srgb : bool
        Whether the colours are sRGB-encoded; they are averaged decoded.
    out : (>= 4 * sum of all levels * bytes a channel,) uint8
    """
    height, width = pixels.shape[:2]
    if pixels.dtype != np.uint8:
        _deep_mipmaps(pixels, srgb, out)
        return
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


def ripmaps(pixels: NDArray[Any], srgb: bool, out: NDArray[np.uint8]) -> None:
    """Write `pixels` at every pair of halved widths and halved heights into `out`, where `copy_places` says.

    What was halved oftener is halved once more, both where they are even: so the copies reduced alike in width and height are the
    mipmap levels, and none is rounded oftener than they.

    Parameters
    ----------
    pixels : (height, width, 4) uint8, uint16 or float32
    srgb : bool
        Whether the colours are sRGB-encoded; they are averaged decoded.
    out : (>= 4 * sum of all widths * sum of all heights * bytes a channel,) uint8
    """
    height, width = pixels.shape[:2]
    if pixels.dtype != np.uint8:
        _deep_ripmaps(pixels, srgb, out)
        return
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


# --- deeper texels ----------------------------------------------------------------------------------------------------------


def _deep_mipmaps(pixels: NDArray[Any], srgb: bool, out: NDArray[np.uint8]) -> None:
    """Levels of 16-bit and float pictures, which are few: by NumPy, each from the one above before that was rounded."""
    place, light = 0, _light(pixels, srgb)
    _write(pixels, out, place)
    place += pixels.nbytes
    for _ in level_sizes(pixels.shape[1], pixels.shape[0])[1:]:
        light = _halved(light, 2, 2)
        level = _encoded(light, srgb, pixels.dtype)
        _write(level, out, place)
        place += level.nbytes


def _deep_ripmaps(pixels: NDArray[Any], srgb: bool, out: NDArray[np.uint8]) -> None:
    height, width = pixels.shape[:2]
    places = copy_places(width, height) * pixels.itemsize
    first = _light(pixels, srgb)
    for row in range(places.shape[0]):
        if row > 0:
            first = _halved(first, 1, 2)
        light = first
        for column in range(places.shape[1]):
            if column > 0:
                light = _halved(light, 2, 1)
            _write(pixels if row == column == 0 else _encoded(light, srgb, pixels.dtype), out, int(places[row, column]))


def _write(level: NDArray[Any], out: NDArray[np.uint8], place: int) -> None:
    out[place : place + level.nbytes] = np.ascontiguousarray(level).view(np.uint8).reshape(-1)


def _light(pixels: NDArray[Any], srgb: bool) -> NDArray[np.float64]:
    """Linear colour and alpha in [0, 1], or as they are where they are floats."""
    light = pixels.astype(np.float64)
    if pixels.dtype != np.float32:
        light /= 65535.0
    if srgb:
        light[..., :3] = linear_from_srgb(light[..., :3])
    return light


def _encoded(light: NDArray[np.float64], srgb: bool, dtype: Any) -> NDArray[Any]:
    if dtype == np.float32:
        return light.astype(np.float32)
    encoded = light.copy()
    if srgb:
        encoded[..., :3] = srgb_from_linear(light[..., :3])
    return np.rint(np.clip(encoded, 0.0, 1.0) * 65535.0).astype(np.uint16)


def _halved(light: NDArray[np.float64], columns: int, rows: int) -> NDArray[np.float64]:
    """Means of `columns` by `rows` texels, of colours weighted by alpha; the last one of an odd side is left out."""
    height, width = light.shape[:2]
    rows, columns = min(rows, height), min(columns, width)
    light = light[: height // rows * rows, : width // columns * columns]
    blocks = light.reshape(light.shape[0] // rows, rows, light.shape[1] // columns, columns, 4)
    alpha = blocks[..., 3:]
    total = alpha.sum(axis=(1, 3))
    weighted = (blocks[..., :3] * alpha).sum(axis=(1, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        color = np.where(total > 0.0, weighted / total, blocks[..., :3].mean(axis=(1, 3)))
    return np.concatenate([color, alpha.mean(axis=(1, 3))], axis=-1)
