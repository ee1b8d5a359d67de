"""Colours as people write them, and as drawing takes them: linear light, premultiplied by alpha.

    (1, 0.5, 0)   (1, 0.5, 0, 0.25)   0.18        linear light, alpha last; one number is a grey
    "#ff8000"     "#ff800040"         "#f80"      sRGB, as screens and style sheets count; alpha last
    "black"       "white"
"""

from __future__ import annotations

import math
import re
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.transfer import linear_from_srgb, srgb_from_linear
from ..errors import SceneError

__all__ = ["Ink", "hex_from_linear", "ink", "inks", "premultiplied"]

Ink: TypeAlias = Any
"""A colour: three or four numbers, one number, or a word that begins with #."""

Rgba = tuple[float, float, float, float]

_NAMED = {"black": "#000000", "white": "#ffffff"}
_HEX = re.compile(r"#(?:[0-9a-f]{3,4}|[0-9a-f]{6}|[0-9a-f]{8})")


def ink(color: Ink, name: str = "color") -> Rgba:
    """Return a colour as linear red, green, blue and straight alpha.

    >>> ink("#ff0000"), ink(0.18), ink((0.2, 0.4, 0.6, 0.5))
    ((1.0, 0.0, 0.0, 1.0), (0.18, 0.18, 0.18, 1.0), (0.2, 0.4, 0.6, 0.5))
    """
    if isinstance(color, str):
        return _from_hex(color, name)
    try:
        values = [float(value) for value in np.atleast_1d(color)]
    except (TypeError, ValueError):
        values = []
    if len(values) == 1:
        values *= 3
    if len(values) == 3:
        values.append(1.0)
    if len(values) != 4 or not all(math.isfinite(value) and value >= 0.0 for value in values) or values[3] > 1.0:
        expected = "three numbers of linear light, not negative, a fourth for alpha in [0, 1] if wanted, or #RRGGBB (sRGB)"
        raise SceneError(f"{name} must be {expected}, got {color!r}")
    return values[0], values[1], values[2], values[3]


def inks(colors: Any, count: int, name: str = "colors") -> NDArray[np.float64]:
    """Return one colour for all, or one for each of `count`, premultiplied: (count, 4) float64."""
    if isinstance(colors, str) or np.ndim(colors) < 2:
        try:
            single = ink(colors, name)
        except (SceneError, TypeError, ValueError):
            if isinstance(colors, str) or len(colors) != count:
                raise
            return premultiplied([ink(color, f"{name}[{k}]") for k, color in enumerate(colors)])
        return np.repeat(premultiplied([single]), count, axis=0)
    if len(colors) != count:
        raise SceneError(f"{name} must be one colour, or one for each of {count}, got {len(colors)}")
    return premultiplied([ink(color, f"{name}[{k}]") for k, color in enumerate(colors)])


def premultiplied(straight: ArrayLike) -> NDArray[np.float64]:
    """Multiply the colours of (..., 4) values by their alpha."""
    made = np.array(straight, dtype=np.float64)
    made[..., :3] *= made[..., 3:]
    return made


def hex_from_linear(color: Rgba) -> str:
    """Write a colour, without its alpha, as ``#rrggbb``, sRGB; what is brighter than 1 is clipped.

    >>> hex_from_linear((1.0, 0.5, 0.0, 1.0))
    '#ffbc00'
    """
    codes = np.floor(srgb_from_linear(color[:3]) * 255.0 + 0.5).astype(int)
    return "#" + "".join(f"{code:02x}" for code in codes.tolist())


def _from_hex(word: str, name: str) -> Rgba:
    text = _NAMED.get(word.strip().lower(), word.strip().lower())
    if not _HEX.fullmatch(text):
        raise SceneError(f"{name} must be black, white, #RGB, #RRGGBB or #RRGGBBAA (sRGB), got {word!r}")
    digits = text[1:] if len(text) > 5 else "".join(2 * digit for digit in text[1:])
    codes = [int(digits[at : at + 2], 16) / 255.0 for at in range(0, len(digits), 2)]
    red, green, blue = linear_from_srgb(codes[:3]).tolist()
    return red, green, blue, codes[3] if len(codes) > 3 else 1.0
