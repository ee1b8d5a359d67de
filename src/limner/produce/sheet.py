"""Contact sheets: pictures side by side with words and lines on them.

    sheet = Canvas(640, 340, GROUND)
    sheet.picture(0, 20, image)
    sheet.text(4, 2, "front", size=14)
    sheet.lines([Stroke(((0, 0), (100, 50)), RED)])
    sheet.image().save("sheet.png")

What is drawn has the colours of a screen; pictures are mixed with what lies under them in linear light. This is the one place that knows
which library draws words and lines.
"""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Iterable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..color.decode_table import SRGB_DECODE
from ..image.image import Image

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont, ImageFont

__all__ = ["Canvas", "Grid", "Rgb", "Stroke", "grid_for", "legible", "shortened", "text_width", "wrapped"]

Rgb: TypeAlias = tuple[int, int, int]

_FINER = 4  # sides of a pixel that lines are drawn in, to be averaged


class Stroke(NamedTuple):
    """A line through points, in pixels of the canvas: x from the left edge, y from the top edge."""

    points: Sequence[tuple[float, float]]
    color: Rgb
    width: float = 1.0
    alpha: float = 1.0


class Grid(NamedTuple):
    """Equal cells in rows.

    Attributes
    ----------
    columns, rows : int
    cell_width, cell_height : int
    gap : int
        Between cells, and around all of them.
    """

    columns: int
    rows: int
    cell_width: int
    cell_height: int
    gap: int

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the whole."""
        width = self.columns * (self.cell_width + self.gap) + self.gap
        return width, self.rows * (self.cell_height + self.gap) + self.gap

    def corner(self, index: int) -> tuple[int, int]:
        """x and y of a cell's upper left corner; cells are counted as words are read.

        >>> Grid(2, 2, 100, 50, 10).corner(3)
        (120, 70)
        """
        row, column = divmod(index, self.columns)
        return self.gap + column * (self.cell_width + self.gap), self.gap + row * (self.cell_height + self.gap)


def grid_for(n: int, cell_width: int, cell_height: int, gap: int, aspect: float = 4.0 / 3.0) -> Grid:
    """As many cells as `n`, so arranged that the whole is about `aspect` times as wide as high.

    >>> grid_for(7, 100, 100, 0)[:2]
    (3, 3)
    """
    columns = max(1, min(n, round(math.sqrt(n * aspect * cell_height / cell_width))))
    return Grid(columns, max(1, -(-n // columns)), cell_width, cell_height, gap)


class Canvas:
    """A picture that is drawn on.

    Parameters
    ----------
    width, height : int
    ground : three ints, 0 to 255
    """

    def __init__(self, width: int, height: int, ground: Rgb) -> None:
        from PIL import Image as pillow  # noqa: N813 - the module

        self._picture = pillow.new("RGB", (width, height), ground)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self._picture.size

    def box(self, x: float, y: float, width: float, height: float, color: Rgb) -> None:
        """Fill a rectangle, its edges rounded to whole pixels."""
        area = round(x), round(y), round(x + width), round(y + height)
        if area[0] < area[2] and area[1] < area[3]:
            self._picture.paste(color, area)

    def picture(self, x: int, y: int, image: Image) -> None:
        """Lay a picture on, its upper left corner at (x, y); what is transparent in it shows what is below."""
        from PIL import Image as pillow  # noqa: N813 - the module

        area = (x, y, x + image.width, y + image.height)
        below = SRGB_DECODE[np.asarray(self._picture.crop(area))]
        alpha = np.clip(image.pixels[..., 3:], 0.0, 1.0)
        mixed = np.concatenate([image.pixels[..., :3] * alpha + below * (1.0 - alpha), np.ones_like(alpha)], axis=2)
        encoded = Image(mixed.astype(np.float32)).to_uint8()[..., :3]
        self._picture.paste(pillow.fromarray(np.ascontiguousarray(encoded)), (x, y))

    def lines(self, strokes: Iterable[Stroke]) -> None:
        """Draw lines with smooth edges, one over the other."""
        from PIL import Image as pillow  # noqa: N813 - the module
        from PIL import ImageDraw

        for stroke in strokes:
            points = np.asarray(stroke.points, dtype=np.float64)
            if len(points) < 2 or not np.isfinite(points).all():
                continue
            reach = stroke.width + 1.0
            low = np.maximum(np.floor(points.min(axis=0) - reach), 0.0).astype(int)
            high = np.minimum(np.ceil(points.max(axis=0) + reach), self.size).astype(int)
            if (low >= high).any():
                continue
            width, height = (high - low).tolist()
            cover = pillow.new("L", (width * _FINER, height * _FINER), 0)
            finer = [tuple(((point - low) * _FINER - 0.5).tolist()) for point in points]  # Pillow counts from the middle of a pixel
            ImageDraw.Draw(cover).line(finer, fill=round(255 * stroke.alpha), width=max(1, round(stroke.width * _FINER)), joint="curve")
            cover = cover.reduce(_FINER)
            self._picture.paste(stroke.color, (*low.tolist(), *high.tolist()), cover)

    def circle(self, x: float, y: float, radius: float, color: Rgb, width: float = 1.0) -> None:
        """Draw a circle's line; with a width of its radius or more, a disk."""
        turns = 2.0 * np.pi * np.arange(33) / 32
        middle = max(radius - width / 2.0, radius / 2.0)
        ring = np.stack([x + middle * np.cos(turns), y + middle * np.sin(turns)], axis=1)
        self.lines([Stroke([(float(a), float(b)) for a, b in ring], color, min(width, radius))])

    def text(self, x: float, y: float, words: str, *, size: int, color: Rgb, anchor: str = "la", halo: Rgb | None = None) -> None:
        """Write a line.

        Parameters
        ----------
        x, y : float
        words : str
            Letters that the font lacks are replaced.
        size : int
            Of the letters, pixels.
        color : three ints
        anchor : str
            Which point of the words stands at (x, y): l, m, r from left to right, then a, m, s from the top to the baseline.
        halo : three ints, optional
            Drawn round the letters, so that they can be read on anything.
        """
        from PIL import ImageDraw

        font = _font(size)
        stroke: dict[str, Any] = {} if halo is None else {"stroke_width": max(1, size // 8), "stroke_fill": halo}
        ImageDraw.Draw(self._picture).text((round(x), round(y)), legible(words), fill=color, font=font, anchor=anchor, **stroke)

    def to_uint8(self) -> NDArray[np.uint8]:
        """(height, width, 3) uint8, sRGB."""
        return np.array(self._picture)

    def image(self, **fields: Any) -> Image:
        """The same as an Image, which gives the same bytes again; `fields` are further fields of it."""
        linear = SRGB_DECODE[self.to_uint8()]
        pixels = np.concatenate([linear, np.ones((*linear.shape[:2], 1), dtype=np.float32)], axis=2)
        return Image(pixels, **fields)


# --- words ----------------------------------------------------------------------------------------------------------------


@cache
def _font(size: int) -> FreeTypeFont | ImageFont:
    from PIL import ImageFont

    return ImageFont.load_default(size)


def legible(words: str) -> str:
    """The same words in the letters that the font has: ASCII.

    >>> legible("4 × 3 – Château 城")
    '4 x 3 - Chateau ?'
    """
    told = words.replace("×", "x").replace("–", "-").replace("…", "...").replace("ß", "ss")
    plain = "".join(c for c in unicodedata.normalize("NFKD", told) if not unicodedata.combining(c))
    return "".join(c if c.isascii() and c.isprintable() else " " if c.isspace() else "?" for c in plain)


def text_width(words: str, size: int) -> float:
    """Pixels that a line takes."""
    return float(_font(size).getlength(legible(words)))


def shortened(words: str, size: int, width: float) -> str:
    """The words, cut in the middle where they are wider than `width` pixels; beginning and end tell files apart."""
    words = legible(words)
    if text_width(words, size) <= width:
        return words
    kept = len(words) - 1
    while kept > 1 and text_width(words[: kept - kept // 2] + "..." + words[len(words) - kept // 2 :], size) > width:
        kept -= 1
    return words[: kept - kept // 2] + "..." + words[len(words) - kept // 2 :]


def wrapped(words: str, size: int, width: float) -> list[str]:
    """The words in lines of at most `width` pixels; a word that is wider is shortened."""
    lines: list[str] = []
    for word in legible(words).split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, size) <= width:
            lines[-1] = longer
        else:
            lines.append(shortened(word, size, width))
    return lines
