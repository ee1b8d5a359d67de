"""The canvas: shapes, lines, text and pictures drawn onto a picture, antialiased, in linear light (FoCG 8.2.1).

    canvas = Canvas(200, 100, background="white")
    canvas.circle(50, 50, 40, fill="#3366cc")
    canvas.line(10, 90, 190, 10, "#cc3333", Pen(3, cap="round", dashes=(8, 6)))
    canvas.text(150, 50, "limner", "black", size=24, align="center")
    canvas.image().save("drawing.png")
    canvas.svg()                                     the same commands as a vector drawing

x is the column and y the row from the top, with pixel centres at integers: the pixel (0, 0) is the square from -0.5 to 0.5.
What is drawn lies over what was there, by the part of each pixel that it covers and by its alpha, as light mixes.

**Source**: Porter and Duff, *Compositing digital images*, 1984 (over, premultiplied); FoCG 3.4.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from ..linear.project import check_size
from .coverage import RULES, Bounds, edges_of_each, edges_of_polygons, edges_of_rings, fill_edges, mosaic_edges
from .ink import Ink, Rgba, ink, inks, premultiplied
from .midpoint import draw_pixel_lines
from .path import Path
from .stroke import Pen, segment_polygons, stroke_polygons
from .text import Text, TextBox, measure, rasterized

__all__ = ["Canvas", "Command", "Filled", "Pasted", "Segments", "Stroked", "Triangles", "Written"]

Floats = NDArray[np.float64]


class Filled(NamedTuple):
    """A path's inside."""

    path: Path
    color: Rgba
    rule: str
    clip: Bounds | None


class Stroked(NamedTuple):
    """What a pen covers along a path."""

    path: Path
    color: Rgba
    pen: Pen
    clip: Bounds | None


class Segments(NamedTuple):
    """Separate lines, (n, 4), with a premultiplied colour each, (n, 4)."""

    lines: Floats
    colors: Floats
    pen: Pen
    clip: Bounds | None


class Triangles(NamedTuple):
    """Triangles, (n, 3, 2), with premultiplied colours at their corners, (n, 3, 4)."""

    corners: Floats
    colors: Floats
    clip: Bounds | None


class Written(NamedTuple):
    """Text at (x, y)."""

    text: Text
    x: float
    y: float
    color: Rgba
    clip: Bounds | None


class Pasted(NamedTuple):
    """A picture whose first pixel lies at (x, y)."""

    image: Image
    x: int
    y: int
    clip: Bounds | None


Command = Filled | Stroked | Segments | Triangles | Written | Pasted


class Canvas:
    """A picture to draw on.

    Parameters
    ----------
    width, height : int
        Pixels.
    background : colour, optional
        None: transparent.

    Attributes
    ----------
    commands : list of Command
        What has been drawn, in order.

    >>> canvas = Canvas(4, 2, background="black")
    >>> canvas.rectangle(-0.5, -0.5, 2.5, 2, fill="white").image().pixels[0, :, 0].tolist()
    [1.0, 1.0, 0.5, 0.0]
    """

    def __init__(self, width: int, height: int, background: Ink | None = None) -> None:
        check_size(width, height)
        self.background: Rgba = (0.0, 0.0, 0.0, 0.0) if background is None else ink(background, "background")
        self.commands: list[Command] = []
        self._pixels = np.empty((height, width, 4), dtype=np.float32)
        self._pixels[...] = premultiplied(self.background)
        self._clip: Bounds | None = None
        self._under: Image | None = None

    @classmethod
    def on(cls, image: Image) -> Canvas:
        """Begin with a picture. What lies beside it (depth and the like) stays, its recipe does not: it makes another."""
        canvas = cls(image.width, image.height)
        canvas._under = image
        canvas.paste(image, 0, 0)
        return canvas

    @property
    def width(self) -> int:
        """Columns."""
        return int(self._pixels.shape[1])

    @property
    def height(self) -> int:
        """Rows."""
        return int(self._pixels.shape[0])

    def image(self) -> Image:
        """The picture as it stands; the canvas may be drawn on further."""
        pixels = self._pixels.copy()
        alpha = pixels[..., 3:]
        np.divide(pixels[..., :3], alpha, out=pixels[..., :3], where=(alpha > 0.0) & (alpha < 1.0))
        if self._under is None:
            return Image(pixels)
        return dataclasses.replace(self._under, pixels=pixels, recipe={})

    def svg(self) -> str:
        """The drawing as SVG; see `limner.draw.svg`."""
        from .svg import svg

        return svg(self.commands, self.width, self.height, self.background)

    # --- where -----------------------------------------------------------------------------------------------------------

    @contextmanager
    def clipped(self, x: float, y: float, width: float, height: float) -> Iterator[Canvas]:
        """Draw only inside a rectangle meanwhile, and inside those that already hold; it may cut pixels.

        >>> canvas = Canvas(3, 1)
        >>> with canvas.clipped(-0.5, -0.5, 1.5, 1):
        ...     _ = canvas.circle(1, 0, 9, fill="white")
        >>> canvas.image().pixels[0, :, 3].tolist()
        [1.0, 0.5, 0.0]
        """
        if not (all(map(math.isfinite, (x, y, width, height))) and width >= 0.0 and height >= 0.0):
            raise SceneError(f"a clip rectangle must be finite and not negative, got {(x, y, width, height)}")
        before = self._clip
        left, top, right, bottom = before or self._whole()
        self._clip = max(left, x), max(top, y), min(right, x + width), min(bottom, y + height)
        try:
            yield self
        finally:
            self._clip = before

    def _whole(self) -> Bounds:
        return -0.5, -0.5, self.width - 0.5, self.height - 0.5

    def _bounds(self) -> Bounds:
        return self._clip or self._whole()

    # --- paths -----------------------------------------------------------------------------------------------------------

    def fill(self, path: Path, color: Ink, rule: str = "nonzero") -> Canvas:
        """Paint a path's inside.

        Parameters
        ----------
        path : Path
            Open subpaths are taken as closed.
        color : colour
        rule : "nonzero" | "evenodd"
            Inside is what the path winds around, or winds around an odd number of times.
        """
        if rule not in RULES:
            raise UnsupportedError(f"rule must be one of {', '.join(RULES)}, got {rule!r}")
        command = Filled(path.copy(), ink(color), rule, self._clip)
        edges = edges_of_rings([chain.points for chain in path.flattened()])
        fill_edges(edges, premultiplied([command.color]), rule, self._bounds(), self._pixels)
        return self._drawn(command)

    def stroke(self, path: Path, color: Ink, pen: Pen | float = 1.0) -> Canvas:
        """Paint what a pen covers that follows a path.

        Parameters
        ----------
        path : Path
        color : colour
        pen : Pen or float
            A number is a width.
        """
        command = Stroked(path.copy(), ink(color), _pen(pen), self._clip)
        edges = edges_of_polygons(stroke_polygons(path, command.pen))
        fill_edges(edges, premultiplied([command.color]), "nonzero", self._bounds(), self._pixels)
        return self._drawn(command)

    def draw(
        self, path: Path, fill: Ink | None = None, stroke: Ink | None = None, pen: Pen | float = 1.0, rule: str = "nonzero"
    ) -> Canvas:
        """Fill a path, then stroke it; None: not."""
        if fill is not None:
            self.fill(path, fill, rule)
        if stroke is not None:
            self.stroke(path, stroke, pen)
        return self

    # --- shapes ----------------------------------------------------------------------------------------------------------

    def line(self, x0: float, y0: float, x1: float, y1: float, color: Ink, pen: Pen | float = 1.0) -> Canvas:
        """Draw a line."""
        made = _pen(pen)
        if made.dashes:
            return self.stroke(Path().move_to(x0, y0).line_to(x1, y1), color, made)
        return self.segments([[x0, y0, x1, y1]], color, made)

    def polyline(self, points: ArrayLike, color: Ink, pen: Pen | float = 1.0, closed: bool = False) -> Canvas:
        """Draw lines through points, (n, 2) float."""
        return self.stroke(Path().polyline(points, closed), color, pen)

    def polygon(
        self, outline: ArrayLike, holes: Sequence[ArrayLike] = (), fill: Ink | None = None, stroke: Ink | None = None,
        pen: Pen | float = 1.0, rule: str = "nonzero",
    ) -> Canvas:  # fmt: skip
        """Draw a polygon, (n, 2) float, and holes in it."""
        return self.draw(Path().polygon(outline, holes), fill, stroke, pen, rule)

    def rectangle(
        self, x: float, y: float, width: float, height: float, fill: Ink | None = None, stroke: Ink | None = None,
        pen: Pen | float = 1.0, radius: float = 0.0,
    ) -> Canvas:  # fmt: skip
        """Draw a rectangle from its corner (x, y); the whole pixel (i, j) begins at (i - 0.5, j - 0.5)."""
        return self.draw(Path().rectangle(x, y, width, height, radius), fill, stroke, pen)

    def circle(
        self, x: float, y: float, radius: float, fill: Ink | None = None, stroke: Ink | None = None, pen: Pen | float = 1.0
    ) -> Canvas:
        """Draw a circle round (x, y)."""
        return self.draw(Path().circle(x, y, radius), fill, stroke, pen)

    def ellipse(
        self, x: float, y: float, radius_x: float, radius_y: float, rotation: float = 0.0, fill: Ink | None = None,
        stroke: Ink | None = None, pen: Pen | float = 1.0,
    ) -> Canvas:  # fmt: skip
        """Draw an ellipse whose axes are turned by `rotation` radians."""
        return self.draw(Path().ellipse(x, y, radius_x, radius_y, rotation), fill, stroke, pen)

    def arc(
        self, x: float, y: float, radius: float, start: float, sweep: float, color: Ink, pen: Pen | float = 1.0
    ) -> Canvas:
        """Draw a part of a circle: from the angle `start` on, radians from +x towards +y, over `sweep`."""
        return self.stroke(Path().arc(x, y, radius, radius, start, sweep), color, pen)

    # --- many at once ----------------------------------------------------------------------------------------------------

    def segments(self, lines: ArrayLike, colors: Ink, pen: Pen | float = 1.0) -> Canvas:
        """Draw separate lines, one over the other: tens of thousands in a blink.

        Parameters
        ----------
        lines : (n, 4) float
            x0, y0, x1, y1.
        colors : colour, or n of them
        pen : Pen or float
            Without dashes.
        """
        given, made = _numbers(lines, (4,), "lines"), _pen(pen)
        if made.dashes:
            raise UnsupportedError("segments are drawn without dashes: use stroke, or line")
        command = Segments(given, inks(colors, len(given)), made, self._clip)
        edges = edges_of_each(segment_polygons(command.lines, made))
        fill_edges(edges, command.colors, "nonzero", self._bounds(), self._pixels)
        return self._drawn(command)

    def pixel_lines(self, lines: ArrayLike, colors: Ink) -> Canvas:
        """Draw lines of whole pixels by the midpoint algorithm (`limner.draw.midpoint`), not antialiased; SVG has thin lines.

        Parameters
        ----------
        lines : (n, 4) float
            x0, y0, x1, y1.
        colors : colour, or n of them
        """
        given = _numbers(lines, (4,), "lines")
        command = Segments(given, inks(colors, len(given)), Pen(1.0, cap="square"), self._clip)
        left, top, right, bottom = self._bounds()
        box = math.ceil(left), math.ceil(top), math.ceil(right), math.ceil(bottom)
        draw_pixel_lines(given, command.colors.astype(np.float32), box, self._pixels)
        return self._drawn(command)

    def triangles(self, corners: ArrayLike, colors: ArrayLike) -> Canvas:
        """Draw triangles whose colours are interpolated between their corners.

        Parameters
        ----------
        corners : (n, 3, 2) float
        colors : (n, 3, 3) or (n, 3, 4) float
            Linear light, straight alpha.

        Notes
        -----
        Triangles of one call are tiles of one surface: where two share an edge, their parts of a pixel are added, and no seam
        is seen. Where they overlap, they mix in equal parts.

        **Source**: FoCG 8.2.1, 8.1.2 (colours by barycentric coordinates).
        """
        given = _numbers(corners, (3, 2), "corners")
        straight = _colors(colors, len(given))
        command = Triangles(given, premultiplied(straight), self._clip)
        layer = np.zeros((self.height, self.width, 5), dtype=np.float32)
        mosaic_edges(edges_of_each(given), _gradients(command.corners, command.colors), self._bounds(), layer)
        # What covers a pixel more than once counts in parts of its whole.
        layer[..., :4] /= np.maximum(layer[..., 4:], np.float32(1.0))
        self._pixels *= np.float32(1.0) - layer[..., 3:4]
        self._pixels += layer[..., :4]
        return self._drawn(command)

    # --- text and pictures -----------------------------------------------------------------------------------------------

    def text(
        self, x: float, y: float, words: str, color: Ink, size: float = 16.0, align: str = "left", baseline: str = "baseline",
        spacing: float = 1.2, font: str | None = None,
    ) -> Canvas:  # fmt: skip
        """Write.

        Parameters
        ----------
        x, y : float
        words : str
            Lines are separated by a newline.
        color : colour
        size : float
            Pixels from the top of tall letters to the bottom of low ones, about.
        align : "left" | "center" | "right"
            Which part of each line stands at x.
        baseline : "top" | "middle" | "baseline" | "bottom"
            Which height of the text stands at y.
        spacing : float
            From line to line, in sizes.
        font : str, optional
            A TrueType or OpenType file; None: the face that Pillow carries, which has the letters of English.
        """
        command = Written(Text(words, size, align, baseline, spacing, font), float(x), float(y), ink(color), self._clip)
        mask, left, top = rasterized(command.text, command.x, command.y, self.width, self.height)
        self._blend(mask[..., None] * premultiplied(command.color).astype(np.float32), left, top)
        return self._drawn(command)

    def text_box(
        self, x: float, y: float, words: str, size: float = 16.0, align: str = "left", baseline: str = "baseline",
        spacing: float = 1.2, font: str | None = None,
    ) -> TextBox:  # fmt: skip
        """Measure a text without writing it."""
        return measure(Text(words, size, align, baseline, spacing, font), x, y)

    def paste(self, image: Image, x: int, y: int) -> Canvas:
        """Lay a picture over this one, its first pixel at the pixel (x, y)."""
        if not (hasattr(x, "__index__") and hasattr(y, "__index__")):
            raise SceneError(f"pictures lie on whole pixels: x and y must be integers, got {x!r} and {y!r}")
        left, top = max(0, x), max(0, y)
        part = image.pixels[max(0, -y) : max(0, self.height - y), max(0, -x) : max(0, self.width - x)].copy()
        part[..., :3] *= part[..., 3:]
        self._blend(part, left, top)
        return self._drawn(Pasted(image, int(x), int(y), self._clip))

    def _blend(self, layer: NDArray[np.float32], left: int, top: int) -> None:
        """Lay premultiplied pixels over the picture, by the part of each that is inside the clip rectangle."""
        rows, columns = layer.shape[:2]
        if self._clip is not None:
            x0, y0, x1, y1 = self._clip
            layer = layer * np.multiply.outer(_overlap(top, rows, y0, y1), _overlap(left, columns, x0, x1))[..., None]
        under = self._pixels[top : top + rows, left : left + columns]
        under *= np.float32(1.0) - layer[..., 3:]
        under += layer

    def _drawn(self, command: Command) -> Canvas:
        self.commands.append(command)
        return self


def _overlap(first: int, count: int, low: float, high: float) -> NDArray[np.float32]:
    """The part of each of `count` pixels from `first` on that lies between two bounds."""
    at = first + np.arange(count)
    return np.clip(np.minimum(at + 0.5, high) - np.maximum(at - 0.5, low), 0.0, 1.0).astype(np.float32)


def _pen(pen: Pen | float) -> Pen:
    return pen if isinstance(pen, Pen) else Pen(pen)


def _numbers(given: Any, shape: tuple[int, ...], name: str) -> Floats:
    try:
        made = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be numbers, got {type(given).__name__}") from None
    if made.size == 0:
        return made.reshape(0, *shape)
    if made.ndim != 1 + len(shape) or made.shape[1:] != shape:
        raise SceneError(f"{name} must have shape (n, {', '.join(map(str, shape))}), got {made.shape}")
    if not np.isfinite(made).all():
        raise SceneError(f"{name} must be finite")
    return made


def _colors(colors: Any, count: int) -> Floats:
    last = np.shape(colors)[-1:] or (0,)
    made = _numbers(colors, (3, 4 if last == (4,) else 3), "colors")
    if len(made) != count:
        raise SceneError(f"colors must be as many as triangles, {count}, got {len(made)}")
    if made.size and (made.min() < 0.0 or (last == (4,) and made[..., 3].max() > 1.0)):
        raise SceneError("colors must not be negative, and alpha must lie in [0, 1]")
    return made if last == (4,) else np.concatenate([made, np.ones((count, 3, 1))], axis=2)


def _gradients(corners: Floats, colors: Floats) -> Floats:
    """(n, 20) float64: colour at x = y = 0, change along x and y, least and greatest; flat for triangles without area."""
    p0, p1, p2 = corners[:, 0], corners[:, 1], corners[:, 2]
    (ax, ay), (bx, by) = (p1 - p0).T, (p2 - p0).T
    area = ax * by - ay * bx
    with np.errstate(divide="ignore", over="ignore"):
        inverse = np.where(np.abs(area) > 1e-12, 1.0 / area, 0.0)[:, None]
    c1, c2 = colors[:, 1] - colors[:, 0], colors[:, 2] - colors[:, 0]
    along_x = (c1 * by[:, None] - c2 * ay[:, None]) * inverse
    along_y = (c2 * ax[:, None] - c1 * bx[:, None]) * inverse
    at_zero = colors[:, 0] - along_x * p0[:, :1] - along_y * p0[:, 1:]
    return np.concatenate([at_zero, along_x, along_y, colors.min(axis=1), colors.max(axis=1)], axis=1)
