"""Words in pictures: set by Pillow's FreeType, in the face that comes with Pillow, so that nothing need be installed.

A line of text stands on its baseline. Where that lies relative to the given point (x, y) is said by `align` and `baseline`:

    align      left, center or right: which part of the line stands at x
    baseline   top, middle, baseline or bottom: which height of the whole block stands at y;
               "baseline" is that of the first line

The face that comes with Pillow, Aileron, has the letters of English; for others name a font file. Pillow is imported when the
first text is set.
"""

from __future__ import annotations

import math
import os
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, SceneError, UnsupportedError

__all__ = ["ALIGNS", "BASELINES", "Line", "Text", "TextBox", "family", "measure", "rasterized"]

ALIGNS = ("left", "center", "right")
BASELINES = ("top", "middle", "baseline", "bottom")
_SHARE = {"left": 0.0, "center": 0.5, "right": 1.0}
_GREATEST_SIZE = 4096.0


class Text(NamedTuple):
    """What is written, and how; sizes in pixels."""

    words: str
    size: float = 16.0
    align: str = "left"
    baseline: str = "baseline"
    spacing: float = 1.2
    font: str | None = None


class Line(NamedTuple):
    """One line: its words, where its baseline begins, and how far it runs; pixels."""

    words: str
    x: float
    y: float
    advance: float


class TextBox(NamedTuple):
    """Where a text lies: its bounds in pixels, with room for the tallest and lowest letters of the face, and its lines."""

    left: float
    top: float
    right: float
    bottom: float
    lines: tuple[Line, ...]

    @property
    def width(self) -> float:
        """Pixels."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Pixels."""
        return self.bottom - self.top


def measure(text: Text, x: float = 0.0, y: float = 0.0) -> TextBox:
    """Find where a text lies that is written at (x, y).

    >>> box = measure(Text("limner", size=20.0, align="center"))
    >>> box.left == -box.right, 10.0 < box.height < 40.0, len(box.lines)
    (True, True, 1)
    """
    _check(text, x, y)
    face = _face(text.font, text.size)
    ascent, descent = face.getmetrics()
    words = text.words.split("\n")
    leading = text.spacing * text.size
    height = ascent + descent + leading * (len(words) - 1)
    above = {"top": 0.0, "middle": 0.5 * height, "baseline": float(ascent), "bottom": height}[text.baseline]
    advances = [float(face.getlength(line)) for line in words]
    widest, share = max(advances), _SHARE[text.align]
    lines = tuple(
        Line(line, x - share * advance, y - above + ascent + k * leading, advance)
        for k, (line, advance) in enumerate(zip(words, advances, strict=True))
    )
    left = x - share * widest
    return TextBox(left, y - above, left + widest, y - above + height, lines)


def family(text: Text) -> str:
    """The names of typefaces that a text may be set in, the canvas's own first, as style sheets write them."""
    name = str(_face(text.font, text.size).getname()[0])
    return f"{name}, Helvetica, Arial, sans-serif"


def rasterized(text: Text, x: float, y: float, width: int, height: int) -> tuple[NDArray[np.float32], int, int]:
    """Compute how much of each pixel the letters cover.

    Parameters
    ----------
    text : Text
    x, y : float
        Where it stands, in pixels with their centres at integers.
    width, height : int
        Of the picture; what lies outside is left out.

    Returns
    -------
    mask : (rows, columns) float32 in [0, 1]
        Empty where the text lies outside.
    left, top : int
        Where in the picture the mask lies.
    """
    from PIL import Image, ImageDraw

    box = measure(text, x, y)
    margin = math.ceil(text.size)  # letters may lean out of their box
    left, top = max(0, math.floor(box.left) - margin), max(0, math.floor(box.top) - margin)
    right, bottom = min(width, math.ceil(box.right) + margin), min(height, math.ceil(box.bottom) + margin)
    if left >= right or top >= bottom:
        return np.zeros((0, 0), dtype=np.float32), 0, 0
    page = Image.new("L", (right - left, bottom - top))
    pen = ImageDraw.Draw(page)
    for line in box.lines:
        pen.text((line.x + 0.5 - left, line.y + 0.5 - top), line.words, fill=255, font=_face(text.font, text.size), anchor="ls")
    return np.asarray(page, dtype=np.float32) / np.float32(255.0), left, top


def _check(text: Text, x: float, y: float) -> None:
    if not isinstance(text.words, str):
        raise SceneError(f"text must be a string, got {text.words!r}")
    if not 0.0 < text.size <= _GREATEST_SIZE:
        raise SceneError(f"text.size must be positive and at most {_GREATEST_SIZE:g} pixels, got {text.size!r}")
    if text.align not in ALIGNS:
        raise UnsupportedError(f"text.align must be one of {', '.join(ALIGNS)}, got {text.align!r}")
    if text.baseline not in BASELINES:
        raise UnsupportedError(f"text.baseline must be one of {', '.join(BASELINES)}, got {text.baseline!r}")
    if not all(map(math.isfinite, (x, y, text.spacing))):
        raise SceneError(f"text must stand at finite x and y, got {x} and {y}, spacing {text.spacing}")


@lru_cache(maxsize=64)
def _face(font: str | None, size: float) -> Any:
    """A typeface at a size: a file's, or Aileron, which Pillow carries."""
    from PIL import ImageFont, features

    if not features.check("freetype2"):
        raise UnsupportedError("text needs a Pillow that was built with FreeType: those that pip installs are")
    if font is None:
        # The plain layout: the other needs a library that may or may not be there, and pictures must not depend on that.
        carried: Any = ImageFont.load_default(size)
        return carried.font_variant(layout_engine=ImageFont.Layout.BASIC)
    try:
        return ImageFont.truetype(os.fspath(font), size)
    except OSError as error:
        raise FileFormatError(f"not a font that can be read ({error})", font) from None
