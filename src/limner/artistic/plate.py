"""From lines to a page: each line in the look of its class, each class in a layer of its own (FoCG 10.3.1).

    page = page_of(drawing_of(scene, width=800, height=600), "plain")           in pixels
    page = page_of(drawing, "technical", scale=0.5)                             in millimetres: 1:2

Layers are named after what is in them (``visible-crease``, ``hidden-silhouette``) and lie one over the other: areas below, then hidden
lines, then those that are seen, the thickest last.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..draw.dash import fitted
from ..draw.ink import Ink, Rgba, ink
from ..draw.page import UNITS, Layer, Mark, Page, Patch, Trace
from ..draw.stroke import Pen
from ..errors import SceneError, UnsupportedError
from .lines import KINDS, Drawing, FeatureLine
from .strokes import by_depth, swelling, wavering
from .style import LineLook, LineStyle, line_style

__all__ = ["Placing", "layers_of", "millimetres_per_pixel", "page_of", "placing"]

Floats = NDArray[np.float64]

_LEVELS = 6  # of depth, that lines are cut into
_THINNEST = 0.7  # of a line's width: what depth takes away at most
_FAINTEST = 0.75  # of a line's colour: what depth takes away at most, where its width is none


class Placing:
    """Where a picture lies on a page.

    Parameters
    ----------
    unit : "px" | "mm"
        The page's.
    finer : float
        The page's units in a pixel of the picture.
    x, y : float
        Where on the page the picture's upper left corner lies.
    """

    def __init__(self, unit: str = "px", finer: float = 1.0, x: float = 0.0, y: float = 0.0) -> None:
        self.unit, self.finer, self.offset = unit, finer, np.array([x, y])

    def points(self, picture: Floats) -> Floats:
        """Places of the picture as places of the page."""
        return picture * self.finer + self.offset

    def length(self, value: float, unit: str) -> float:
        """A length of a style in the page's unit."""
        return value if unit == self.unit else value * UNITS[unit] / UNITS[self.unit]


def page_of(
    drawing: Drawing,
    style: LineStyle | str = "plain",
    *,
    scale: float | None = None,
    unit_mm: float = 1000.0,
    background: Ink | None = "white",
    below: Sequence[Layer] = (),
    title: str = "",
) -> Page:
    """Lay a drawing on a page.

    Parameters
    ----------
    drawing : Drawing
    style : LineStyle or str
        One of `STYLES`.
    scale : float > 0, optional
        Millimetres on the page for each of the model: 0.5 is 1:2. Needs a parallel projection. None: the page is in pixels.
    unit_mm : float > 0
        Millimetres of one unit of the model: 1000 where it is in metres.
    background : colour, optional
        None: nothing.
    below : sequence of Layer
        Under the lines, in the page's unit.
    title : str
    """
    chosen, place = line_style(style), placing(drawing, scale, unit_mm)
    ground = None if background is None else ink(background, "background")
    layers = (*below, *layers_of([(drawing, place)], chosen, ground))
    return Page(drawing.width * place.finer, drawing.height * place.finer, place.unit, layers, title, ground)


def placing(drawing: Drawing, scale: float | None = None, unit_mm: float = 1000.0) -> Placing:
    """How the picture of a drawing lies on a page of its own, as in `page_of`."""
    return Placing() if scale is None else Placing("mm", millimetres_per_pixel(drawing, scale, unit_mm))


def millimetres_per_pixel(drawing: Drawing, scale: float, unit_mm: float) -> float:
    """What a pixel of a drawing measures on paper at a scale."""
    for name, value in (("scale", scale), ("unit_mm", unit_mm)):
        if not (math.isfinite(value) and value > 0.0):
            raise SceneError(f"{name} must be positive, got {value!r}")
    if drawing.pixels_per_metre is None:
        raise UnsupportedError("a drawing in perspective has no scale: leave scale out, or use an OrthographicCamera")
    return scale * unit_mm / drawing.pixels_per_metre


def layers_of(placed: Iterable[tuple[Drawing, Placing]], style: LineStyle, ground: Rgba | None = None) -> list[Layer]:
    """The layers of drawings on one page, those of all together.

    Parameters
    ----------
    placed : iterable of (Drawing, Placing)
    style : LineStyle
    ground : (r, g, b, a), optional
        What lines fade to; None: white.
    """
    marks: dict[tuple[bool, str], list[Mark]] = {}
    for drawing, place in placed:
        near, far = _depths(drawing)
        for line in drawing.lines:
            look = style.look(line.kind, line.hidden_by)
            if look is not None:
                drawn = _marks(line, look, style, place, near, far, ground or (1.0, 1.0, 1.0, 1.0))
                marks.setdefault((line.hidden_by > 0, line.kind), []).extend(drawn)
    return [
        Layer(f"{'hidden' if hidden else 'visible'}-{kind}", _grouped(marks[hidden, kind]), ("hidden" if hidden else "visible", kind))
        for hidden, kind in sorted(marks, key=lambda key: _order(key, style))
    ]


def _order(key: tuple[bool, str], style: LineStyle) -> tuple[bool, float, int]:
    hidden, kind = key
    look = style.look(kind, int(hidden))
    return not hidden, 0.0 if look is None else look.width, -KINDS.index(kind)


def _grouped(marks: list[Mark]) -> list[Mark]:
    """Marks of one look together, the widest first, so that what is painted at once is much."""
    return sorted(marks, key=lambda mark: (-mark.pen.width, mark.pen.dashes) if isinstance(mark, Trace) else (0.0, ()))


def _depths(drawing: Drawing) -> tuple[float, float]:
    """The nearest and farthest place of the lines of a drawing."""
    ends = [(float(line.depth.min()), float(line.depth.max())) for line in drawing.lines if len(line.depth)]
    return (min(low for low, _ in ends), max(high for _, high in ends)) if ends else (0.0, 0.0)


def _marks(
    line: FeatureLine, look: LineLook, style: LineStyle, place: Placing, near: float, far: float, ground: Rgba
) -> list[Mark]:
    """One line in its look: in pieces where it fades, as an area where its width changes."""
    color, spread = ink(look.color), max(far - near, 1e-300)
    if (style.taper or style.pressure) and not look.dashes:
        farness = (line.depth - near) / spread
        fade = _FAINTEST * style.depth_cue * float(farness.mean())
        return [_stroke(line, look, _faded(color, ground, fade), style, place, 1.0 - _THINNEST * style.depth_cue * farness)]
    if style.depth_cue == 0.0:
        return [_trace(line.picture, line.closed, look.width, look, color, style, place)]
    pieces = by_depth(line.picture, line.depth, near, far, _LEVELS)
    return [
        _trace(
            piece.points, line.closed and len(pieces) == 1, look.width * (1.0 - _THINNEST * style.depth_cue * piece.farness), look,
            _faded(color, ground, _FAINTEST * style.depth_cue * piece.farness), style, place,
        )
        for piece in pieces
    ]  # fmt: skip


def _by_hand(picture: Floats, style: LineStyle, place: Placing) -> tuple[Floats, float]:
    """The line on the page, as far from where it belongs as the style has it, and the length over which it strays."""
    wavelength = place.length(style.wavelength, style.unit)
    return wavering(place.points(picture), place.length(style.wobble, style.unit), wavelength, style.seed), wavelength


def _stroke(line: FeatureLine, look: LineLook, color: Rgba, style: LineStyle, place: Placing, widths: Floats) -> Patch:
    """A line whose width changes, as an area; `widths` are parts of the look's, at the line's points."""
    points, wavelength = _by_hand(line.picture, style, place)
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line.picture, axis=0).T))])
    ring = swelling(
        points, place.length(look.width, style.unit), taper=style.taper, pressure=style.pressure, wavelength=wavelength, seed=style.seed,
        closed=line.closed, profile=(run / max(float(run[-1]), 1e-300), widths),
    )  # fmt: skip
    return Patch((ring,), (*color[:3], color[3] * look.opacity))


def _trace(
    picture: Floats, closed: bool, width: float, look: LineLook, color: Rgba, style: LineStyle, place: Placing
) -> Trace:
    points, _ = _by_hand(picture, style, place)
    dashes = tuple(place.length(dash, style.unit) for dash in look.dashes)
    if dashes and not closed:
        dashes = fitted(dashes, float(np.hypot(*np.diff(points, axis=0).T).sum()))
    pen = Pen(place.length(width, style.unit), "butt" if dashes else "round", "round", dashes=dashes)
    return Trace(points[:-1] if closed else points, (*color[:3], color[3] * look.opacity), pen, closed)


def _faded(color: Rgba, ground: Rgba, share: float) -> Rgba:
    """A colour on its way to that of the paper: opaque, so that pieces that overlap at their ends show no joint."""
    r, g, b = (a + share * (c - a) for a, c in zip(color[:3], ground[:3], strict=True))
    return r, g, b, color[3]
