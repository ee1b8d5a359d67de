"""Pages: vector drawings in millimetres or pixels, in named layers, for every kind of file that can hold lines (FoCG 3.1.2).

    page = Page(210, 297, "mm", (Layer("outline", (Trace([(20, 20), (60, 20)], BLACK, Pen(0.5)),)),))
    page_svg(page)      page_pdf(page)      page_dxf(page)      page_image(page, dpi=150)

A picture of pixels answers, for each of its places, what colour is there; a page keeps what the answer comes from: lines, areas, words.
Each writer turns the same marks into the words of its format, so that a sheet, its print and its picture on the screen are one drawing.

Coordinates run from the page's upper left corner, x to the right, y down, in the page's unit. A pixel is 1/96 inch, as in CSS.

Marks of equal colour and pen that follow each other in a layer are painted at once: where they cross they are no darker than each alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from .canvas import Canvas
from .ink import Rgba
from .path import Path
from .stroke import Pen
from .text import ALIGNS, Text, measure

__all__ = ["UNITS", "Caption", "Dots", "Layer", "Mark", "Page", "Patch", "Run", "Trace", "advance", "page_image", "paint_layers", "runs"]

Floats = NDArray[np.float64]

UNITS = {"mm": 1.0, "px": 25.4 / 96.0}
"""Millimetres of each unit."""

_GAUGE = 1000.0  # the size letters are measured at, where the rounding of their widths to pixels does not count


class Trace(NamedTuple):
    """A line that a pen follows: points (n, 2) float64; a pen's lengths are in the page's unit."""

    points: Floats
    color: Rgba
    pen: Pen
    closed: bool = False


class Patch(NamedTuple):
    """An area inside rings, (n, 2) float64 each, by a rule as in `Canvas.fill`."""

    rings: tuple[Floats, ...]
    color: Rgba
    rule: str = "nonzero"


class Dots(NamedTuple):
    """Discs: centres (n, 2) float64 and radii (n,) float64."""

    centers: Floats
    radii: Floats
    color: Rgba


class Caption(NamedTuple):
    """A line of words that stands on its baseline at (x, y); `upward`: it is read from below to above."""

    words: str
    x: float
    y: float
    size: float
    color: Rgba
    align: str = "left"
    upward: bool = False


Mark: TypeAlias = Trace | Patch | Dots | Caption


@dataclass(frozen=True, eq=False)
class Layer:
    """Marks under a name that drawing programs show.

    Parameters
    ----------
    name : str
        Letters, digits, "-" and "_".
    marks : sequence of Mark
        In the order in which they are painted.
    classes : tuple of str
        What style sheets may address the layer by.
    """

    name: str
    marks: Sequence[Mark]
    classes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for word in (self.name, *self.classes):
            if not word or not all(c.isascii() and (c.isalnum() or c in "-_") for c in word):
                raise SceneError(f"a layer's name and classes must be of letters, digits, - and _, got {word!r}")
        object.__setattr__(self, "marks", tuple(self.marks))


@dataclass(frozen=True, eq=False)
class Page:
    """A drawing.

    Parameters
    ----------
    width, height : float > 0
        In `unit`.
    unit : "mm" | "px"
    layers : tuple of Layer
        From below to above; no two have one name.
    title : str
        For the files that hold one.
    ground : colour, optional
        Of the paper: linear light with alpha. None: nothing is painted.
    """

    width: float
    height: float
    unit: str = "mm"
    layers: tuple[Layer, ...] = ()
    title: str = ""
    ground: Rgba | None = None

    def __post_init__(self) -> None:
        if self.unit not in UNITS:
            raise UnsupportedError(f"page.unit must be one of {', '.join(UNITS)}, got {self.unit!r}")
        if not all(math.isfinite(side) and side > 0.0 for side in (self.width, self.height)):
            raise SceneError(f"a page's sides must be positive, got {self.width} x {self.height}")
        names = [layer.name for layer in self.layers]
        if len(set(names)) < len(names):
            raise SceneError(f"no two layers of a page may have one name, got {', '.join(names)}")

    @property
    def millimetres(self) -> float:
        """Of one unit of the page."""
        return UNITS[self.unit]


class Run(NamedTuple):
    """Marks of one kind, one colour and one pen that are painted at once."""

    kind: type
    color: Rgba
    style: Pen | str | None
    marks: tuple[Mark, ...]


def runs(layer: Layer) -> Iterator[Run]:
    """A layer's marks, those together that are painted at once."""
    for (kind, color, style), marks in groupby(layer.marks, key=_look):
        yield Run(kind, color, style, tuple(marks))


def _look(mark: Mark) -> tuple[type, Rgba, Pen | str | None]:
    style = mark.pen if isinstance(mark, Trace) else mark.rule if isinstance(mark, Patch) else None
    return type(mark), mark.color, style


def advance(words: str, size: float) -> float:
    """How far a line of words of a size runs, in the size's unit.

    >>> 2.0 * advance("limner", 10.0) == advance("limner", 20.0)
    True
    """
    return measure(Text(words, _GAUGE)).lines[0].advance * size / _GAUGE


def page_image(page: Page, dpi: float = 96.0) -> Image:
    """Draw a page as a picture.

    Parameters
    ----------
    page : Page
    dpi : float > 0
        Dots per inch; 96 gives one pixel for each of a page in pixels.

    Returns
    -------
    Image
        Of as many pixels as cover the page; what of the last column and row the page does not reach is ground, too.
    """
    if not (math.isfinite(dpi) and dpi > 0.0):
        raise SceneError(f"dpi must be positive, got {dpi}")
    finer = dpi / 25.4 * page.millimetres
    sides = [max(1, math.ceil(side * finer - 1e-6)) for side in (page.width, page.height)]
    return paint_layers(Canvas(sides[0], sides[1], page.ground), page.layers, finer).image()


def paint_layers(canvas: Canvas, layers: Sequence[Layer], finer: float = 1.0) -> Canvas:
    """Paint layers over a canvas, on which the page's unit measures `finer` pixels."""
    for layer in layers:
        for run in runs(layer):
            _paint(canvas, run, finer)
    return canvas


def _paint(canvas: Canvas, run: Run, finer: float) -> None:
    if run.kind is Caption:
        for mark in run.marks:
            assert isinstance(mark, Caption)
            _write(canvas, mark, finer)
        return
    path, rule = Path(), "nonzero"
    for mark in run.marks:
        if isinstance(mark, Trace):
            path.polyline(_pixels(mark.points, finer), mark.closed)
        elif isinstance(mark, Patch):
            rule = mark.rule
            for ring in mark.rings:
                path.polyline(_pixels(ring, finer), closed=True)
        elif isinstance(mark, Dots):
            for (x, y), radius in zip(_pixels(mark.centers, finer), mark.radii * finer, strict=True):
                path.circle(float(x), float(y), float(radius))
    if isinstance(run.style, Pen):
        pen = run.style
        dashes = tuple(dash * finer for dash in pen.dashes)
        scaled = Pen(pen.width * finer, pen.cap, pen.join, pen.miter_limit, dashes, pen.dash_offset * finer)
        canvas.stroke(path, run.color, scaled)
    else:
        canvas.fill(path, run.color, rule)


def _pixels(points: ArrayLike, finer: float) -> Floats:
    """Places on the page as places on a canvas, where pixel centres are integers."""
    return np.asarray(points, dtype=np.float64) * finer - 0.5


def _write(canvas: Canvas, mark: Caption, finer: float) -> None:
    size, x, y = mark.size * finer, mark.x * finer - 0.5, mark.y * finer - 0.5
    if mark.align not in ALIGNS:
        raise UnsupportedError(f"align must be one of {', '.join(ALIGNS)}, got {mark.align!r}")
    if not mark.words.strip() or size < 0.5:
        return
    if not mark.upward:
        canvas.text(x, y, mark.words, mark.color, size, mark.align)
        return
    # Written level on a canvas of its own, whose quarter turn lies on whole pixels: the fractions are in where it is written.
    length, deep = math.ceil(advance(mark.words, size)) + 4, math.ceil(2.0 * size) + 4
    before = {"left": 2, "center": length // 2, "right": length - 2}[mark.align]
    left, top = math.floor(x) - deep // 2, math.floor(y) - (length - before)
    level = Canvas(length, deep).text(length - 1 - (y - top), x - left, mark.words, mark.color, size, mark.align)
    canvas.paste(Image(np.ascontiguousarray(np.rot90(level.image().pixels))), left, top)
