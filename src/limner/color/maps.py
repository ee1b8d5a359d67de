"""Colour maps: numbers as colours, so that a surface can show what is known about it.

    colors = mapped(temperatures, "viridis", (0.0, 100.0))

A number's place in its range is a place in a row of colours. Rows made for this purpose get lighter, or leave the middle, at an even
pace, so that equal steps of the number look equal; a rainbow does not. The default, viridis, does, is safe for the colour-blind and
keeps its order in grey.

    sequential   viridis, magma, inferno, plasma, cividis, grey
    diverging    cool_warm: blue below the middle, red above it
    rainbow      turbo: many hues, for finding places rather than for comparing sizes

Maps are published as sRGB codes. Inside, colours are linear light: they are decoded once, and interpolated as codes, as their authors
meant them to be.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .map_tables import TABLES
from .transfer import linear_from_srgb, srgb_from_linear
from .uniform import lab_from_xyz, xyz_from_lab

__all__ = ["COLOR_MAPS", "DEFAULT_MAP", "NAN_COLOR", "Range", "checked_map", "checked_range", "encoded_map", "mapped"]

Floats = NDArray[np.float64]
Range = tuple[float, float]

COLOR_MAPS = ("viridis", "magma", "inferno", "plasma", "cividis", "turbo", "cool_warm", "grey")
DEFAULT_MAP = "viridis"
NAN_COLOR = (0.2, 0.2, 0.2)
"""Linear; what no number has to show for itself."""

_COOL, _WARM = (59.0, 76.0, 192.0), (180.0, 4.0, 38.0)
_XYZ_FROM_RGB = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
_WHITE = np.array([0.95047, 1.0, 1.08883])
_CHUNK = 1 << 18  # numbers at a time: bounds the memory


def checked_map(color_map: Any) -> str | Floats:
    """Return the name of a known map, or a map of one's own as (n, 3) float64; else raise, with the names that are known."""
    if isinstance(color_map, str):
        if color_map not in COLOR_MAPS:
            raise UnsupportedError(f"color_map must be one of {', '.join(COLOR_MAPS)}, got {color_map!r}")
        return color_map
    try:
        colors = np.array(color_map, dtype=np.float64)
    except (TypeError, ValueError):
        colors = np.zeros(0)
    if colors.ndim != 2 or colors.shape[1] != 3 or len(colors) < 2:
        raise SceneError(f"color_map must be a name ({', '.join(COLOR_MAPS)}) or linear colours of shape (n, 3) with n >= 2")
    if not (np.isfinite(colors).all() and colors.min() >= 0.0 and colors.max() <= 1.0):
        raise SceneError("the colours of a color_map must lie in [0, 1]")
    return colors


def checked_range(range: Any, values: ArrayLike | None = None) -> Range:
    """Return the least and the greatest number of a map; None: of the values themselves, what is not finite left out."""
    if range is None:
        finite = np.asarray(values, dtype=np.float64)
        finite = finite[np.isfinite(finite)]
        if not finite.size:
            raise SceneError("values has no finite number to make a range of: give one, as in range=(0, 1)")
        return float(finite.min()), float(finite.max())
    try:
        low, high = (float(end) for end in range)
    except (TypeError, ValueError):
        raise SceneError(f"range must be two numbers, got {range!r}") from None
    if not (math.isfinite(low) and math.isfinite(high) and low <= high):
        raise SceneError(f"range must be finite, its first number not the greater one, got ({low:g}, {high:g})")
    return low, high


def mapped(
    values: ArrayLike,
    color_map: str | ArrayLike = DEFAULT_MAP,
    range: tuple[float, float] | None = None,
    nan_color: tuple[float, float, float] = NAN_COLOR,
) -> NDArray[np.float32]:
    """Show numbers as colours.

    Parameters
    ----------
    values : (...) float
    color_map : str or (n, 3) float in [0, 1]
        One of `COLOR_MAPS`, or linear colours from the least number to the greatest.
    range : (low, high), optional
        What lies beyond has the colour of the nearer end. None: of the finite values. Where both ends are the same number, that one has
        the colour in the middle.
    nan_color : three floats
        Linear; of what is no number.

    Returns
    -------
    (..., 3) float32
        Linear light.

    >>> srgb_from_linear(mapped([0.0, 1.0, 2.0])).round(2).tolist()
    [[0.27, 0.0, 0.33], [0.13, 0.57, 0.55], [0.99, 0.91, 0.15]]
    """
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"values must be numbers, got {type(values).__name__}") from None
    encoded = encoded_map(color_map)
    low, high = checked_range(range, numbers)
    flat = numbers.reshape(-1)
    colors = np.empty((flat.size, 3), dtype=np.float32)
    for start in np.arange(0, flat.size, _CHUNK).tolist():
        colors[start : start + _CHUNK] = _looked_up(flat[start : start + _CHUNK], encoded, low, high, nan_color)
    return colors.reshape(*numbers.shape, 3)


def _looked_up(values: Floats, encoded: Floats, low: float, high: float, nan_color: tuple[float, float, float]) -> Floats:
    known = ~np.isnan(values)
    clipped = np.clip(np.where(known, values, low), low, high)
    # Halved first: the ends may be so far apart that float64 cannot hold their distance.
    span = high / 2.0 - low / 2.0
    share = (clipped / 2.0 - low / 2.0) / span if span > 0.0 else np.full(values.shape, 0.5)
    at = share * (len(encoded) - 1)
    first = np.minimum(at.astype(np.intp), len(encoded) - 2)
    colors = linear_from_srgb(encoded[first] + (at - first)[:, None] * (encoded[first + 1] - encoded[first]))
    return np.where(known[:, None], colors, np.asarray(nan_color, dtype=np.float64))


def encoded_map(color_map: str | ArrayLike = DEFAULT_MAP) -> Floats:
    """(n, 3) float64: the row of colours of a map, sRGB-encoded."""
    known = checked_map(color_map)
    return _by_name(known) if isinstance(known, str) else srgb_from_linear(known)


@cache
def _by_name(name: str) -> Floats:
    if name in TABLES:
        made = np.frombuffer(bytes.fromhex(TABLES[name]), dtype=np.uint8).reshape(-1, 3) / 255.0
    elif name == "grey":
        # Two ends are all: between codes grey is even to the eye.
        made = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    else:
        made = _cool_warm(np.linspace(0.0, 1.0, 257))
    made.flags.writeable = False
    return made


# --- diverging --------------------------------------------------------------------------------------------------------------


def _cool_warm(share: Floats) -> Floats:
    """(n, 3) float64, sRGB-encoded: from blue over a light grey to red, even in both halves.

    Two colours meet in a grey between them along straight lines in polar coordinates of CIELAB: magnitude M = |(L, a, b)|, saturation
    s = acos(L / M), hue h = atan2(b, a). The grey has M = 88 and the hue that keeps the pace even.

    **Source**: Moreland, *Diverging Color Maps for Scientific Visualization*, ISVC 2009, sections 5 and 6.
    """
    cool, warm = _polar(np.array(_COOL) / 255.0), _polar(np.array(_WARM) / 255.0)
    middle = max(cool[0], warm[0], 88.0)
    at = np.asarray(share)[:, None]
    below = (1.0 - 2.0 * at) * cool + 2.0 * at * np.array([middle, 0.0, _spun_hue(cool, middle)])
    above = (2.0 - 2.0 * at) * np.array([middle, 0.0, _spun_hue(warm, middle)]) + (2.0 * at - 1.0) * warm
    magnitude, saturation, hue = np.where(at < 0.5, below, above).T
    lightness = magnitude * np.cos(saturation)
    a, b = magnitude * np.sin(saturation) * np.cos(hue), magnitude * np.sin(saturation) * np.sin(hue)
    xyz = xyz_from_lab(np.column_stack([lightness, a, b]), _WHITE)
    return srgb_from_linear(xyz @ np.linalg.inv(_XYZ_FROM_RGB).T)


def _polar(encoded: Floats) -> Floats:
    """(3,): magnitude, saturation and hue of a colour."""
    lightness, a, b = lab_from_xyz(_XYZ_FROM_RGB @ linear_from_srgb(encoded), _WHITE).tolist()
    magnitude = math.sqrt(lightness**2 + a**2 + b**2)
    return np.array([magnitude, math.acos(lightness / magnitude), math.atan2(b, a)])


def _spun_hue(saturated: Floats, magnitude: float) -> float:
    """The hue that a grey of a greater magnitude is given, so that the way to it is even."""
    own, saturation, hue = saturated.tolist()
    if own >= magnitude:
        return float(hue)
    spin = saturation * math.sqrt(magnitude**2 - own**2) / (own * math.sin(saturation))
    return float(hue + spin if hue > -math.pi / 3.0 else hue - spin)
