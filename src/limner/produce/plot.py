"""Axes: numbers on a canvas, with a grid, ticks at round numbers and names.

    plot = Plot(Canvas(800, 500, PAPER), (380.0, 780.0), (0.0, 2.0), "wavelength, nm", "amount")
    plot.line(x, y, "#c4402f", 2.5)

x runs to the right and y up. What is drawn through a plot is cut at its frame.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..draw.canvas import Canvas
from ..draw.color_bar import round_ticks
from ..draw.ink import Ink
from ..draw.stroke import Pen
from ..errors import SceneError

__all__ = ["FAINT", "INK", "PAPER", "Plot", "text_size"]

Floats = NDArray[np.float64]
Range = tuple[float, float]

PAPER, INK, FAINT, GRID = "#fbfaf7", "#1b2430", "#6b7684", "#e2e4e8"
_LEAST_SIDE = 200


def text_size(width: int, height: int) -> float:
    """Size of the words of a chart, so that they are read at any size of it; SceneError where a chart would have no room."""
    if min(width, height) < _LEAST_SIDE:
        raise SceneError(f"a chart must be at least {_LEAST_SIDE} pixels wide and high, got {width} x {height}")
    return max(min(width, height) * 0.026, 9.0)


class Plot:
    """A frame with axes.

    Parameters
    ----------
    canvas : Canvas
    x_range, y_range : (low, high)
    x_name, y_name : str
        What stands along the axes; empty: nothing.
    title : str
    is_square : bool
        Whether a step along x is as long as one along y.
    foot : float
        Pixels left free below.
    strip : float
        Sizes of the text left free between the axis and its numbers.
    """

    def __init__(
        self, canvas: Canvas, x_range: Range, y_range: Range, x_name: str = "", y_name: str = "", title: str = "",
        is_square: bool = False, foot: float = 0.0, strip: float = 0.0,
    ) -> None:  # fmt: skip
        self.canvas, self.x_range, self.y_range = canvas, x_range, y_range
        self.text = text_size(canvas.width, canvas.height)
        left, right = 3.6 * self.text, canvas.width - 1.4 * self.text
        top, bottom = (3.4 if title else 1.4) * self.text, canvas.height - ((3.6 if x_name else 2.2) + strip) * self.text - foot
        self._strip = strip
        if is_square:
            scale = min((right - left) / (x_range[1] - x_range[0]), (bottom - top) / (y_range[1] - y_range[0]))
            spare = (right - left) - scale * (x_range[1] - x_range[0])
            left, right = left + 0.5 * spare, right - 0.5 * spare
            spare = (bottom - top) - scale * (y_range[1] - y_range[0])
            top, bottom = top + 0.5 * spare, bottom - 0.5 * spare
        self.left, self.right, self.top, self.bottom = left, right, top, bottom
        self._draw_axes(x_name, y_name, title)

    def at(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(..., 2) float64: where numbers lie on the canvas."""
        across = (np.asarray(x, dtype=np.float64) - self.x_range[0]) / (self.x_range[1] - self.x_range[0])
        up = (np.asarray(y, dtype=np.float64) - self.y_range[0]) / (self.y_range[1] - self.y_range[0])
        across, up = np.broadcast_arrays(across, up)
        return np.stack([self.left + across * (self.right - self.left), self.bottom - up * (self.bottom - self.top)], axis=-1)

    def line(self, x: ArrayLike, y: ArrayLike, color: Ink, pen: Pen | float = 2.0, closed: bool = False) -> None:
        """Draw lines through points."""
        made = pen if isinstance(pen, Pen) else Pen(pen, cap="round", join="round")
        with self.canvas.clipped(self.left, self.top, self.right - self.left, self.bottom - self.top):
            self.canvas.polyline(self.at(x, y), color, made, closed)

    def outline(self, points: ArrayLike, color: Ink, pen: Pen | float = 2.0, closed: bool = True) -> None:
        """Draw lines through points, (n, 2)."""
        x, y = np.asarray(points, dtype=np.float64).T
        self.line(x, y, color, pen, closed)

    def place(self, point: ArrayLike) -> tuple[float, float]:
        """Where one point, (2,), lies on the canvas."""
        x, y = np.asarray(point, dtype=np.float64).tolist()
        across, down = self.at(x, y).tolist()
        return across, down

    def label(self, x: float, y: float, words: str, color: Ink = INK, align: str = "left", size: float = 1.0) -> None:
        """Write beside a point."""
        place = self.at(x, y)
        self.canvas.text(float(place[0]), float(place[1]), words, color, size=size * self.text, align=align, baseline="middle")

    def legend(self, entries: Sequence[tuple[str, Ink, Pen]], x: float, y: float) -> None:
        """Say what lines mean: a piece of each and its name, from the place (x, y) of the canvas downwards."""
        for row, (words, color, pen) in enumerate(entries):
            height = y + 1.5 * row * self.text
            self.canvas.line(x, height, x + 2.0 * self.text, height, color, pen)
            self.canvas.text(x + 2.6 * self.text, height, words, INK, size=self.text, baseline="middle")

    def _draw_axes(self, x_name: str, y_name: str, title: str) -> None:
        canvas, text = self.canvas, self.text
        thin = Pen(max(text / 16.0, 0.6))
        for value, words in round_ticks(*self.x_range):
            x = float(self.at(value, self.y_range[0])[0])
            canvas.line(x, self.top, x, self.bottom, GRID, thin)
            canvas.text(x, self.bottom + (0.5 + self._strip) * text, words, FAINT, size=0.9 * text, align="center", baseline="top")
        for value, words in round_ticks(*self.y_range):
            y = float(self.at(self.x_range[0], value)[1])
            canvas.line(self.left, y, self.right, y, GRID, thin)
            canvas.text(self.left - 0.5 * text, y, words, FAINT, size=0.9 * text, align="right", baseline="middle")
        canvas.line(self.left, self.bottom, self.right, self.bottom, FAINT, thin)
        if x_name:
            canvas.text(self.right, self.bottom + (1.9 + self._strip) * text, x_name, FAINT, size=0.9 * text, align="right", baseline="top")
        if y_name:
            canvas.text(self.left - 0.5 * text, self.top - 0.5 * text, y_name, FAINT, size=0.9 * text, baseline="bottom")
        if title:
            canvas.text(canvas.width / 2.0, self.top - 2.8 * text, title, INK, size=1.25 * text, align="center", baseline="top")
