"""The key to a picture of numbers: a strip of all the colours, with marks at round numbers.

    image = limner.with_color_bar(limner.render(mesh), limner.ColorBar("viridis", (0.0, 37.5), "temperature, K"))

The colours of the strip are those of the map itself, without light on them: on the model they are as bright as it is lit.

**Source**: round steps of 1, 2 or 5 times a power of ten: Heckbert, *Nice Numbers for Graph Labels*, Graphics Gems, 1990.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..color.maps import DEFAULT_MAP, Range, checked_map, checked_range, encoded_map
from ..color.transfer import linear_from_srgb
from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from .canvas import Canvas
from .ink import Ink
from .text import Text, measure

__all__ = ["PLACES", "ColorBar", "round_ticks", "with_color_bar"]

PLACES = ("inside", "beside")

_LEAST_SIDE = 32  # pixels of a picture that a bar fits into
_TEXT_SHARE = 0.03  # of the picture's height
_BAR_SHARE = 0.62
_MOST_TICKS = 7


@dataclass(frozen=True)
class ColorBar:
    """What colours mean.

    Parameters
    ----------
    color_map : str or (n, 3) float
        As in `limner.color_by`.
    range : (low, high)
        What its ends stand for.
    label : str
        What is shown, and in which unit.
    """

    color_map: Any = DEFAULT_MAP
    range: Range = (0.0, 1.0)
    label: str = ""

    def __post_init__(self) -> None:
        known = checked_map(self.color_map)
        if not isinstance(known, str):
            object.__setattr__(self, "color_map", tuple(map(tuple, known.tolist())))
        object.__setattr__(self, "range", checked_range(self.range))
        if not isinstance(self.label, str):
            raise SceneError(f"color_bar.label must be a string, got {self.label!r}")


def round_ticks(low: float, high: float, most: int = _MOST_TICKS) -> list[tuple[float, str]]:
    """Find round numbers in a range, and how to write them.

    Parameters
    ----------
    low, high : float
        The same number, or nearly: only the first.
    most : int >= 2
        How many there may be.

    >>> round_ticks(0.0, 37.5)
    [(0.0, '0'), (10.0, '10'), (20.0, '20'), (30.0, '30')]
    >>> round_ticks(-2e-7, 2e-7, 5)
    [(-2e-07, '-2e-7'), (-1e-07, '-1e-7'), (0.0, '0'), (1e-07, '1e-7'), (2e-07, '2e-7')]
    """
    span = high - low
    magnitude = max(abs(low), abs(high))
    if not math.isfinite(span):
        return [(low, _written(low, 0.0)), (high, _written(high, 0.0))]
    if span <= 1e-9 * magnitude:
        return [(low, _written(low, 0.0))]
    power = 10.0 ** math.floor(math.log10(span / most))
    for digit in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0):
        step = power * digit
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last - first < most:
            break
    return [(k * step, _written(k * step, step)) for k in range(first, last + 1)]


def _written(value: float, step: float) -> str:
    """A number with as many digits as tell it from its neighbours."""
    if value == 0.0:
        return "0"
    size = abs(value)
    digits = 4 if step == 0.0 else max(1, 1 + math.floor(math.log10(size) + 1e-9) - math.floor(math.log10(step) + 1e-9))
    if 1e-3 <= size < 1e5:
        places = max(0, digits - 1 - math.floor(math.log10(size) + 1e-9))
        text = f"{value:.{places}f}"
        return text.rstrip("0").rstrip(".") if step == 0.0 and "." in text else text
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}"


def with_color_bar(
    image: Image, bar: ColorBar, *, place: str = "inside", color: Ink = "black", background: Ink = (1.0, 1.0, 1.0, 0.8)
) -> Image:
    """Draw the key to its colours into a picture, or beside it.

    Parameters
    ----------
    image : Image
    bar : ColorBar
    place : "inside" | "beside"
        On the right of the picture, over what is there; or on a strip of its own, by which the picture gets wider (what lies beside the
        picture, depth and the like, is left out then).
    color, background : colours
        Of the writing, and of what it stands on.

    Returns
    -------
    Image
        A picture too small to write in (32 pixels) as it was.
    """
    if not isinstance(bar, ColorBar):
        raise SceneError(f"bar must be a ColorBar, got {type(bar).__name__}")
    if place not in PLACES:
        raise UnsupportedError(f"place must be one of {', '.join(PLACES)}, got {place!r}")
    if min(image.width, image.height) < _LEAST_SIDE:
        return image
    layout = _Layout(bar, image.height)
    if place == "inside":
        canvas = Canvas.on(image)
        left = image.width - layout.width - layout.margin
        canvas.rectangle(left - 0.5, layout.top - 0.5, layout.width, layout.height, fill=background)
        layout.draw(canvas, bar, left, color)
        return canvas.image()
    canvas = Canvas(image.width + round(layout.width), image.height)
    canvas.paste(image, 0, 0)
    canvas.rectangle(image.width - 0.5, -0.5, round(layout.width), image.height, fill=background)
    layout.draw(canvas, bar, image.width, color)
    made = canvas.image()
    return dataclasses.replace(image, pixels=made.pixels, aov={}, id_names={}, recipe={})


class _Layout:
    """Where the parts of a bar lie: label, strip, ticks, numbers; pixels."""

    def __init__(self, bar: ColorBar, height: int) -> None:
        low, high = bar.range
        self.size = min(max(_TEXT_SHARE * height, 9.0), 40.0)
        self.margin = round(self.size)
        most = int(min(max(_BAR_SHARE * height / (2.0 * self.size), 2), _MOST_TICKS))
        self.ticks = round_ticks(low, high, most)
        self.strip_width = 1.2 * self.size
        self.tick_length = 0.35 * self.size
        words = [text for _, text in self.ticks] or [""]
        numbers = max(measure(Text(text, self.size)).width for text in words)
        self.label_height = 1.6 * self.size if bar.label else 0.0
        label = measure(Text(bar.label, self.size)).width if bar.label else 0.0
        pad = 0.6 * self.size
        self.width = 2.0 * pad + max(self.strip_width + 2.0 * self.tick_length + numbers, label)
        self.height = _BAR_SHARE * height + self.label_height + 2.0 * pad
        self.top = (height - self.height) / 2.0
        self.pad = pad

    def draw(self, canvas: Canvas, bar: ColorBar, left: float, color: Ink) -> None:
        """Draw the bar with its left edge at `left`."""
        x, top = left + self.pad, self.top + self.pad
        if bar.label:
            canvas.text(x, top, bar.label, color, self.size, baseline="top")
        top += self.label_height
        length = self.height - self.label_height - 2.0 * self.pad
        self._strip(canvas, bar, x, top, length)
        low, high = bar.range
        right = x + self.strip_width
        for value, text in self.ticks:
            y = top + length * (0.5 if low == high else 1.0 - (value / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0))
            canvas.line(right, y, right + self.tick_length, y, color, max(1.0, self.size / 16.0))
            canvas.text(right + 1.6 * self.tick_length, y, text, color, self.size, baseline="middle")

    def _strip(self, canvas: Canvas, bar: ColorBar, x: float, top: float, length: float) -> None:
        encoded = encoded_map(bar.color_map)
        n = max(2, round(length))
        share = np.full(n, 0.5) if bar.range[0] == bar.range[1] else np.linspace(1.0, 0.0, n)
        at = share * (len(encoded) - 1)
        colors = linear_from_srgb(np.stack([np.interp(at, np.arange(len(encoded)), encoded[:, k]) for k in range(3)], axis=1))
        pixels = np.ones((n, max(1, round(self.strip_width)), 4), dtype=np.float32)
        pixels[..., :3] = colors[:, None]
        canvas.paste(Image(pixels), round(x), round(top))
