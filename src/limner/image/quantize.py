"""From continuous values to n bits (FoCG 3.2.1), and how to spread the error so that it does not show.

A stored pixel has 2^n values. Rounding to the nearest is off by half a step at most, but in a smooth gradient the error is the same
over whole areas, and the eye sees bands. Dithering adds what differs from pixel to pixel before rounding: the error of one pixel grows
to a step, that of any area vanishes.

    None               the nearest value
    "ordered"          thresholds from Bayer's 8 x 8 matrix: a regular texture
    "blue_noise"       thresholds without pattern (`limner.image.blue_noise`)
    "random"           thresholds drawn for each pixel: grain
    "floyd_steinberg"  each pixel's error is handed on to those not yet rounded: sharpest
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .blue_noise import SIDE, blue_noise

__all__ = ["DITHERS", "quantize"]

DITHERS = ("ordered", "blue_noise", "random", "floyd_steinberg")

Floats = NDArray[np.float64]


def quantize(values: ArrayLike, bits: int, dither: str | None = None, seed: int = 0) -> NDArray[np.unsignedinteger]:
    """Round values to the 2^bits that a file can hold.

    Parameters
    ----------
    values : (height, width) or (height, width, channels) float
        Clipped to [0, 1]; NaN counts as 0. Encoded, if the file's codes are.
    bits : int, 1 to 16
    dither : "ordered" | "blue_noise" | "random" | "floyd_steinberg", optional
        None: the nearest, half up.
    seed : int >= 0
        Draws the thresholds of "random", and shifts the table of "blue_noise".

    Returns
    -------
    uint8 (up to 8 bits) or uint16 of the same shape
        Codes 0 .. 2^bits - 1; code / (2^bits - 1) is what they stand for. Values that are codes stay them, dithered or not.

    >>> quantize([[0.0, 0.3, 0.5, 1.0]], 1).tolist()
    [[0, 0, 1, 1]]

    **Source**: Bayer, *An optimum method for two-level rendition of continuous-tone pictures*, 1973; Floyd and Steinberg, *An adaptive
    algorithm for spatial greyscale*, 1976; Ulichney, *The void-and-cluster method*, 1993.
    """
    if isinstance(bits, bool) or not isinstance(bits, (int, np.integer)) or not 1 <= bits <= 16:
        raise SceneError(f"bits must be an integer from 1 to 16, got {bits!r}")
    given = np.asarray(values, dtype=np.float64)
    if given.ndim not in (2, 3):
        raise SceneError(f"values must be (height, width) or (height, width, channels), got shape {given.shape}")
    greatest = (1 << int(bits)) - 1
    scaled = np.clip(np.nan_to_num(given, nan=0.0), 0.0, 1.0) * greatest
    planes = scaled[:, :, None] if given.ndim == 2 else scaled
    if dither is None:
        codes = np.floor(planes + 0.5)
    elif dither == "floyd_steinberg":
        codes = _diffused(planes, greatest)
    else:
        codes = np.floor(planes + _thresholds(planes.shape, dither, seed))
    return np.minimum(codes, greatest).reshape(given.shape).astype(np.uint8 if bits <= 8 else np.uint16)


def _thresholds(shape: tuple[int, ...], dither: str, seed: int) -> Floats:
    """What is added before rounding down: (height, width, channels) in [0, 1), even on the whole; each channel has its own."""
    height, width, channels = shape
    if dither == "random":
        return np.random.default_rng(seed).random(shape)
    if dither == "ordered":
        table, shifts = _bayer(3), np.zeros((channels, 2), dtype=np.int64)
    elif dither == "blue_noise":
        table, shifts = blue_noise(), np.random.default_rng(seed).integers(0, SIDE, (channels, 2))
    else:
        raise UnsupportedError(f"dither must be one of {', '.join(DITHERS)} or None, got {dither!r}")
    levels = (table + 0.5) / table.size
    rows, columns = np.arange(height)[:, None], np.arange(width)
    side = len(table)
    return np.stack([levels[(rows + down) % side, (columns + right) % side] for down, right in shifts.tolist()], axis=-1)


def _bayer(order: int) -> NDArray[np.int64]:
    """Bayer's matrix of side 2^order: ranks 0 .. 4^order - 1."""
    made = np.zeros((1, 1), dtype=np.int64)
    for _ in range(order):
        made = np.block([[4 * made, 4 * made + 2], [4 * made + 3, 4 * made + 1]])
    return made


def _diffused(planes: Floats, greatest: int) -> Floats:
    """Hand each pixel's error on: 7/16 to the right, 3/16, 5/16 and 1/16 to the row below; what leaves the picture is lost.

    A pixel needs those to its left and the three above it. Where column + 2 row is the same, none needs another, so these are done
    at once: laid out flat, they are a stride of the row's length less two.
    """
    height, width, channels = planes.shape
    padded = width + 2  # a column on each side takes the errors that leave the picture
    flat = np.zeros((height + 1, padded, channels))
    flat[:height, 1:-1] = planes
    flat = flat.reshape(-1, channels)
    step = padded - 2
    for time in range(width + 2 * (height - 1)):
        first = max(0, (time - width + 2) // 2)
        last = min(height - 1, time // 2)
        if first > last:
            continue
        start = first * padded + 1 + time - 2 * first
        end = start + (last - first) * step + 1

        def neighbours(offset: int, start: int = start, end: int = end) -> Floats:
            return flat[start + offset : end + offset : step]

        here = neighbours(0)
        code = np.clip(np.floor(here + 0.5), 0.0, greatest)
        error = here - code
        here[...] = code
        for offset, share in ((1, 7.0), (padded - 1, 3.0), (padded, 5.0), (padded + 1, 1.0)):
            neighbours(offset)[...] += error * (share / 16.0)
    return flat.reshape(height + 1, padded, channels)[:height, 1:-1]
