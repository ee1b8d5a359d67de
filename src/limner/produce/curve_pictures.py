"""Curves as drawings: themselves, how they are constructed, how they bend, and fractals (FoCG 15).

    construction(points, 0.4).image().save("casteljau.png")     de Casteljau's points at one parameter
    comb(curve).svg()                                           a tooth for the curvature at each step along the curve

Curves live in a plane with y up; a `Frame` puts them on a canvas, whose y points down, as large as it allows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.maps import mapped
from ..curves import bezier
from ..curves.arc_length import ArcLength
from ..curves.bounds import spline_box
from ..curves.control import control_points
from ..curves.curve import Curve, Spline
from ..curves.flatten import flattened
from ..curves.frames import curvature, tangents
from ..draw.canvas import Canvas
from ..draw.ink import Ink
from ..draw.path import Path
from ..draw.stroke import Pen
from ..errors import SceneError
from ..image.image import Image

__all__ = [
    "Frame", "bends", "comb", "construction", "drawing", "escape_image", "evenly_marked", "framing", "line_drawing", "path_of", "scatter",
]  # fmt: skip

Floats = NDArray[np.float64]

INK, LEG, TOOTH, POINT = "#1b2430", "#9aa4b2", "#3a78c2", "#c4402f"
_LEVELS = ("#9aa4b2", "#3a78c2", "#2f9e6e", "#d08a1d", "#8a4fbf", "#c4402f")
_TOLERANCE = 0.02  # pixels


class Frame(NamedTuple):
    """How a plane with y up lies on a canvas: pixels = origin + scale (x, -y)."""

    width: int
    height: int
    scale: float
    origin: Floats

    def pixels(self, points: ArrayLike) -> Floats:
        """(..., 2) float64: where points of the plane lie on the canvas."""
        return self.origin + self.scale * np.asarray(points, dtype=np.float64) * (1.0, -1.0)

    def spline(self, spline: Spline) -> Spline:
        """A spline on the canvas."""
        pieces = np.array(spline.pieces)
        weight = pieces[..., -1:] if spline.rational else 1.0
        pieces[..., :2] = self.origin * weight + self.scale * pieces[..., :2] * (1.0, -1.0)
        return Spline(spline.knots, pieces, spline.rational)


def framing(points: Sequence[ArrayLike], width: int = 800, height: int = 600, margin: float = 0.06) -> Frame:
    """Find the frame in which all points are seen as large as the canvas allows.

    Parameters
    ----------
    points : sequence of (n, 2) float
    width, height : int >= 1
    margin : float in [0, 0.5)
        Of the shorter side.
    """
    if width < 1 or height < 1:
        raise SceneError(f"a canvas must have at least one pixel, got {width} x {height}")
    everything = np.concatenate([np.asarray(part, dtype=np.float64).reshape(-1, 2) for part in points])
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = np.array([width, height]) - 2.0 * margin * min(width, height)
    extent = high - low
    scale = float((room / np.where(extent > 0.0, extent, 1e-300)).min()) if extent.any() else 1.0
    middle = np.array([width - 1, height - 1]) / 2.0
    return Frame(width, height, scale, middle - scale * 0.5 * (low + high) * (1.0, -1.0))


def path_of(curve: Curve, tolerance: float = _TOLERANCE) -> Path:
    """Turn a curve in the plane into a path for `Canvas` and SVG.

    Parameters
    ----------
    curve : Curve
        In the canvas's coordinates, see `Frame.spline`.
    tolerance : float > 0
        How far lines may be off, where there must be lines.

    Returns
    -------
    Path
        Splines up to degree 3 without weights stay Bézier curves; others become lines. It moves where pieces do not meet, and closes where
        the end is the start.
    """
    if not (isinstance(curve, Spline) and not curve.rational and curve.degree <= 3):
        points = flattened(curve, tolerance)
        _plane(points.shape[1])
        made = Path().move_to(*points[0]).lines_to(points[1:])
        return made.close() if len(points) > 2 and np.allclose(points[0], points[-1], atol=1e-9) else made
    _plane(curve.dimension)
    path, at, size = Path(), None, float(np.ptp(curve.pieces.reshape(-1, 2), axis=0).max())
    for piece in curve.pieces:
        cubic = bezier.elevate(piece, 3 - curve.degree)
        if at is None or np.abs(at - cubic[0]).max() > 1e-6 * size:
            path.move_to(*cubic[0])
        path.cubic_to(*cubic[1:].reshape(-1))
        at = cubic[-1]
    if len(path.subpaths) == 1 and np.abs(curve.pieces[0, 0] - curve.pieces[-1, -1]).max() <= 1e-9 * size:
        path.close()
    return path


def _plane(dimension: int) -> None:
    if dimension != 2:
        raise SceneError(f"only curves in the plane are drawn, got {dimension} coordinates")


def _box(curve: Curve) -> Floats:
    if isinstance(curve, Spline):
        _plane(curve.dimension)
        return np.array(spline_box(curve))
    points = curve.at(np.linspace(curve.knots[0], curve.knots[-1], 513))
    _plane(points.shape[1])
    return np.array([points.min(axis=0), points.max(axis=0)])


def _stroked(canvas: Canvas, frame: Frame, curve: Curve, color: Ink, pen: Pen) -> None:
    if isinstance(curve, Spline):
        canvas.stroke(path_of(frame.spline(curve)), color, pen)
    else:
        canvas.polyline(frame.pixels(flattened(curve, _TOLERANCE / frame.scale)), color, pen)


def drawing(
    curve: Curve, control: ArrayLike | None = None, width: int = 800, height: int = 600, line_width: float = 2.5,
    background: Ink | None = "white",
) -> Canvas:  # fmt: skip
    """Draw a curve, its knots as dots, and the polygon of its control points where it is given."""
    polygon = None if control is None else control_points(control, dimension=2)
    frame = framing([_box(curve)] if polygon is None else [_box(curve), polygon], width, height)
    canvas = Canvas(width, height, background)
    if polygon is not None:
        _legs(canvas, frame.pixels(polygon), LEG, 1.2)
    _stroked(canvas, frame, curve, INK, Pen(line_width, cap="round", join="round"))
    for x, y in frame.pixels(curve.at(curve.knots)):
        canvas.circle(x, y, 1.3 * line_width, fill=POINT)
    return canvas


def _legs(canvas: Canvas, points: Floats, color: Ink, pen: float) -> None:
    if len(points) > 1:
        canvas.polyline(points, color, Pen(pen, join="round"))
    for x, y in points:
        canvas.circle(x, y, 4.0, fill="white", stroke=color, pen=1.5)


def construction(points: ArrayLike, u: float, width: int = 800, height: int = 600, background: Ink | None = "white") -> Canvas:
    """Draw how de Casteljau finds the point of a Bézier curve at u: level by level, each in its colour.

    Parameters
    ----------
    points : (n + 1, 2) float
        Control points.
    u : float in [0, 1]
    width, height : int
    background : colour, optional
        None: transparent.

    Returns
    -------
    Canvas
        The part of the curve before u is thick, the rest thin.

    **Source**: FoCG 15.6.1, "The de Casteljau Algorithm".
    """
    if not 0.0 <= u <= 1.0:
        raise SceneError(f"u must lie in [0, 1], got {u}")
    control = control_points(points, 2, dimension=2)
    levels = bezier.construction(control, u)
    frame = framing([control], width, height)
    canvas = Canvas(width, height, background)
    for k, level in enumerate(levels[:-1]):
        _legs(canvas, frame.pixels(level), _LEVELS[min(k, len(_LEVELS) - 1)], 1.6)
    before, after = bezier.split(control, u)
    _stroked(canvas, frame, Spline.bezier(after), INK, Pen(1.2, cap="round"))
    _stroked(canvas, frame, Spline.bezier(before), INK, Pen(3.5, cap="round"))
    x, y = frame.pixels(levels[-1][0])
    canvas.circle(x, y, 6.0, fill=POINT)
    return canvas


def bends(curve: Curve, teeth: int = 160, scale: float = 1.0) -> tuple[Floats, Floats]:
    """Find the teeth of a curvature comb.

    Parameters
    ----------
    curve : Curve
        In the plane.
    teeth : int >= 2
        At equal steps of the parameter within each piece: at knots there are two, one for each side.
    scale : float
        The longest tooth is that part of the curve's extent.

    Returns
    -------
    feet, tips : (k, 2) float64
        Teeth stand on the outer side of the bend, their lengths in proportion to the curvature.
    """
    spans = list(zip(curve.knots[:-1], curve.knots[1:], strict=True))
    count = max(2, round(teeth / len(spans)) + 1)
    share = np.linspace(0.0, 1.0, count)
    # At the end of a piece the curvature of that piece is meant, not that of the next one
    share[-1] = 1.0 - 1e-9
    u = np.concatenate([a + (b - a) * share for a, b in spans])
    feet, bend, along = curve.at(u), curvature(curve, u), tangents(curve, u)
    greatest = float(np.abs(bend).max())
    extent = float(np.ptp(feet, axis=0).max())
    length = 0.25 * scale * extent / greatest if greatest > 1e-12 / max(extent, 1e-300) else 0.0
    return feet, feet - length * bend[:, None] * np.stack([-along[:, 1], along[:, 0]], axis=1)


def comb(
    curve: Curve, teeth: int = 160, scale: float = 1.0, width: int = 800, height: int = 600, background: Ink | None = "white"
) -> Canvas:
    """Draw a curve with its curvature comb: a step in it is a joint that is G1 and no more; see `bends`."""
    feet, tips = bends(curve, teeth, scale)
    frame = framing([_box(curve), tips], width, height)
    canvas = Canvas(width, height, background)
    canvas.segments(np.concatenate([frame.pixels(feet), frame.pixels(tips)], axis=1), TOOTH, 1.0)
    canvas.polyline(frame.pixels(tips), TOOTH, Pen(1.5, join="round"))
    _stroked(canvas, frame, curve, INK, Pen(2.5, cap="round", join="round"))
    for x, y in frame.pixels(curve.at(curve.knots)):
        canvas.circle(x, y, 3.2, fill=POINT)
    return canvas


def evenly_marked(curve: Curve, marks: int, width: int = 800, height: int = 600, background: Ink | None = "white") -> Canvas:
    """Draw a curve with marks at equal distances along it, as filled dots, and at equal steps of its parameter, as rings."""
    if marks < 2:
        raise SceneError(f"there must be at least 2 marks, got {marks}")
    frame = framing([_box(curve)], width, height)
    canvas = Canvas(width, height, background)
    _stroked(canvas, frame, curve, LEG, Pen(2.0, cap="round", join="round"))
    even = ArcLength(curve)
    for x, y in frame.pixels(curve.at(np.linspace(curve.knots[0], curve.knots[-1], marks))):
        canvas.circle(x, y, 6.0, stroke=TOOTH, pen=1.6)
    for x, y in frame.pixels(curve.at(even.parameter(np.linspace(0.0, even.length, marks)))):
        canvas.circle(x, y, 3.5, fill=POINT)
    return canvas


def line_drawing(
    lines: Sequence[Floats], width: int = 800, height: int = 600, line_width: float = 1.2, background: Ink | None = "white"
) -> Canvas:
    """Draw lines of points in the plane, such as a turtle's: blue at their beginning, red at their end."""
    if not lines:
        raise SceneError("there are no lines to draw")
    frame = framing(list(lines), width, height)
    canvas = Canvas(width, height, background)
    pixels = [frame.pixels(line) for line in lines]
    segments = np.concatenate([np.concatenate([line[:-1], line[1:]], axis=1) for line in pixels])
    share = np.linspace(0.0, 1.0, len(segments))[:, None]
    colors = (1.0 - share) * np.array([0.03, 0.12, 0.45]) + share * np.array([0.55, 0.05, 0.03])
    return canvas.segments(segments, colors, Pen(line_width, cap="round"))


def scatter(points: ArrayLike, width: int = 800, height: int = 600) -> Image:
    """Count points in pixels, and show the logarithm of the counts, dark on white."""
    made = np.asarray(points, dtype=np.float64)
    frame = framing([made], width, height)
    at = np.floor(frame.pixels(made) + 0.5).astype(np.int64)
    inside = ((at >= 0) & (at < (width, height))).all(axis=1)
    counts = np.bincount(at[inside, 1] * width + at[inside, 0], minlength=width * height).reshape(height, width)
    dark = np.log1p(counts) / max(np.log1p(float(np.quantile(counts[counts > 0], 0.99))), 1e-9)
    light = 1.0 - np.clip(dark, 0.0, 1.0)[..., None] * (1.0 - np.array([0.02, 0.10, 0.05]))
    return Image(np.concatenate([light, np.ones((height, width, 1))], axis=2).astype(np.float32))


def escape_image(counts: Floats, color_map: str = "viridis") -> Image:
    """Show escape times (height, width), such as the Mandelbrot set's, by the logarithm of the steps; the set itself is black."""
    left = np.isfinite(counts)
    shade = np.where(left, np.log1p(np.where(left, counts, 0.0)), 0.0)
    high = float(shade.max()) or 1.0
    color = np.where(left[..., None], mapped(shade, color_map, range=(0.0, high)), 0.0)
    return Image(np.concatenate([color, np.ones((*counts.shape, 1))], axis=2).astype(np.float32))
