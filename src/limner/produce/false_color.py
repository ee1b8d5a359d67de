"""Numbers as colours: what has no colour of its own (depth, counts, normals) made to be seen, and the key that tells how to read it.

    colors = along(depth, near, far, DEPTH)          (height, width, 3) uint8, as a screen has them
    Ramp(DEPTH, "1.2 m", "4.8 m")                    its key

Colours here are sRGB codes, 0 to 255, and are mixed as such: what matters is that steps look even.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.decode_table import SRGB_DECODE
from ..image.image import Image
from .sheet import Rgb

__all__ = ["COVERAGE", "DEPTH", "LAYERS", "LEVELS", "Ramp", "Swatches", "along", "from_unit", "picture"]

Codes = NDArray[np.uint8]

DEPTH: tuple[Rgb, ...] = ((255, 236, 150), (250, 178, 92), (226, 104, 94), (152, 55, 118), (78, 30, 108), (24, 14, 58))
"""From near to far: bright comes forward."""

COVERAGE: tuple[Rgb, ...] = ((255, 224, 178), (244, 150, 60), (196, 66, 22))
"""From one sample to all but one."""

LAYERS: tuple[Rgb, ...] = ((150, 196, 218), (84, 148, 190), (250, 190, 84), (228, 104, 52), (150, 28, 44))
"""One triangle, two, and so on; the last: or more."""

LEVELS: tuple[Rgb, ...] = (
    (70, 104, 170), (62, 158, 178), (116, 190, 120), (240, 214, 98), (238, 150, 62), (212, 70, 56), (160, 40, 100), (78, 34, 92),
)  # fmt: skip
"""The levels of a mipmap, the full texture first; the last: or smaller."""


class Ramp(NamedTuple):
    """A key of colours that run into each other, and what stands at its ends."""

    stops: tuple[Rgb, ...]
    low: str
    high: str


class Swatches(NamedTuple):
    """A key of single colours with a word each."""

    entries: tuple[tuple[Rgb, str], ...]


def along(values: ArrayLike, low: float, high: float, stops: tuple[Rgb, ...]) -> Codes:
    """Colours for values: `stops` evenly from `low` to `high`, and between them by their distance.

    Parameters
    ----------
    values : (...) float
        What lies outside has the colour of the nearer end, what is no number that of `low`.
    low, high : float
        Where they are equal everything has the first colour.

    Returns
    -------
    (..., 3) uint8

    >>> along([0.0, 0.5, 9.0], 0.0, 1.0, ((0, 0, 0), (200, 100, 50))).tolist()
    [[0, 0, 0], [100, 50, 25], [200, 100, 50]]
    """
    colors = np.asarray(stops, dtype=np.float64)
    given = np.asarray(values, dtype=np.float64)
    share = (given - low) / (high - low) if high > low else np.zeros_like(given)
    place = np.clip(np.nan_to_num(share, nan=0.0), 0.0, 1.0) * (len(stops) - 1)
    step = np.minimum(place.astype(int), max(len(stops) - 2, 0))
    part = (place - step)[..., None]
    mixed = colors[step] * (1.0 - part) + colors[np.minimum(step + 1, len(stops) - 1)] * part
    return np.rint(mixed).astype(np.uint8)


def from_unit(values: ArrayLike) -> Codes:
    """(..., 3) numbers from 0 to 1 as codes, as they stand."""
    return np.rint(np.clip(np.nan_to_num(np.asarray(values, dtype=np.float64)), 0.0, 1.0) * 255.0).astype(np.uint8)


def picture(codes: Codes, shown: NDArray[np.bool_]) -> Image:
    """(height, width, 3) codes as a picture that is transparent where nothing is `shown`."""
    pixels = np.concatenate([SRGB_DECODE[codes], shown[..., None].astype(np.float32)], axis=2)
    return Image(np.ascontiguousarray(pixels, dtype=np.float32))
