"""Hue, saturation and value or lightness: the cube of red, green and blue stood on its black corner.

For choosing colours by hand, not for measuring them: that two colours have one value does not mean that they are equally bright. They are
of the stored numbers (sRGB as it stands in files), as every program has it; hue is in turns, [0, 1).

**Source**: Smith, *Color gamut transform pairs*, SIGGRAPH 1978; Joblove and Greenberg, *Color spaces for computer graphics*, SIGGRAPH 1978.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .triples import in_pieces

__all__ = ["hsl_from_rgb", "hsv_from_rgb", "rgb_from_hsl", "rgb_from_hsv"]

Floats = NDArray[np.float64]
Colors = NDArray[np.floating]


def _hue(rows: Floats, greatest: Floats, chroma: Floats) -> Floats:
    """(n,): in turns; 0 where all three are alike."""
    red, green, blue = rows.T
    with np.errstate(divide="ignore", invalid="ignore"):
        sixths = np.where(
            greatest == red,
            np.mod((green - blue) / chroma, 6.0),
            np.where(greatest == green, (blue - red) / chroma + 2.0, (red - green) / chroma + 4.0),
        )
    # A tiny negative number modulo 6 rounds to 6
    return np.where((chroma == 0.0) | (sixths >= 6.0), 0.0, sixths / 6.0)


def _share(part: Floats, whole: Floats) -> Floats:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(whole == 0.0, 0.0, part / whole)


def hsv_from_rgb(rgb: ArrayLike) -> Colors:
    """(..., 3): hue, saturation, value of stored red, green, blue in [0, 1].

    >>> hsv_from_rgb([[1.0, 0.5, 0.0], [0.2, 0.2, 0.2]]).round(4).tolist()
    [[0.0833, 1.0, 1.0], [0.0, 0.0, 0.2]]
    """

    def change(rows: Floats) -> Floats:
        greatest = rows.max(axis=1)
        chroma = greatest - rows.min(axis=1)
        return np.column_stack([_hue(rows, greatest, chroma), _share(chroma, greatest), greatest])

    return in_pieces(change, rgb, "rgb")


def hsl_from_rgb(rgb: ArrayLike) -> Colors:
    """(..., 3): hue, saturation, lightness of stored red, green, blue in [0, 1].

    >>> hsl_from_rgb([1.0, 0.5, 0.0]).round(4).tolist()
    [0.0833, 1.0, 0.5]
    """

    def change(rows: Floats) -> Floats:
        greatest, least = rows.max(axis=1), rows.min(axis=1)
        chroma, lightness = greatest - least, 0.5 * (greatest + least)
        return np.column_stack([_hue(rows, greatest, chroma), _share(chroma, 1.0 - np.abs(2.0 * lightness - 1.0)), lightness])

    return in_pieces(change, rgb, "rgb")


def _rgb(hue: Floats, chroma: Floats, least: Floats) -> Floats:
    """(n, 3): each of the three is a trapezoid over the hue."""
    sixths = np.mod(6.0 * hue[:, None] + np.array([0.0, 4.0, 2.0]), 6.0)
    return least[:, None] + chroma[:, None] * np.clip(np.abs(sixths - 3.0) - 1.0, 0.0, 1.0)


def rgb_from_hsv(hsv: ArrayLike) -> Colors:
    """(..., 3): stored red, green, blue; the inverse of `hsv_from_rgb`. Hues go round."""

    def change(rows: Floats) -> Floats:
        hue, saturation, value = rows.T
        return _rgb(hue, value * saturation, value * (1.0 - saturation))

    return in_pieces(change, hsv, "hsv")


def rgb_from_hsl(hsl: ArrayLike) -> Colors:
    """(..., 3): stored red, green, blue; the inverse of `hsl_from_rgb`. Hues go round."""

    def change(rows: Floats) -> Floats:
        hue, saturation, lightness = rows.T
        chroma = (1.0 - np.abs(2.0 * lightness - 1.0)) * saturation
        return _rgb(hue, chroma, lightness - 0.5 * chroma)

    return in_pieces(change, hsl, "hsl")
