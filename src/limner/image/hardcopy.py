"""Pictures on paper (FoCG 3.1.2): how large, and how a printer that only has ink and no ink shows grey.

A printer's resolution is dots per inch. Between black and white it has nothing, so it prints dots of ink on a grid that is too fine to be
seen, and makes them larger where the picture is darker: a screen of so many lines per inch. The cells of the grid are a handful of
printer dots wide; the more, the more greys, and the coarser the picture.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError

__all__ = ["MM_PER_INCH", "SHAPES", "checked_dpi", "grey_levels", "halftoned", "print_size"]

MM_PER_INCH = 25.4
_FINE = 512  # samples of a cell, for its share of ink at every threshold

Floats = NDArray[np.float64]


def checked_dpi(dpi: float, name: str = "dpi") -> float:
    """Return `dpi` as a float; SceneError where it is no positive number."""
    if isinstance(dpi, bool) or not isinstance(dpi, (int, float, np.integer, np.floating)) or not 0.0 < dpi < 1e7:
        raise SceneError(f"{name} must be a positive number, got {dpi!r}")
    return float(dpi)


def print_size(width: int, height: int, dpi: float) -> tuple[float, float]:
    """Return how wide and how high, in millimetres, a picture of so many pixels is printed at `dpi` pixels per inch.

    >>> print_size(600, 300, 300)
    (50.8, 25.4)
    """
    return width / checked_dpi(dpi) * MM_PER_INCH, height / checked_dpi(dpi) * MM_PER_INCH


def grey_levels(dpi: float, lines_per_inch: float) -> int:
    """Return how many greys a screen can show: its cell of (dpi / lpi)^2 printer dots, each with ink or without.

    >>> grey_levels(600, 75), grey_levels(2400, 150)
    (65, 257)
    """
    return int((checked_dpi(dpi) / checked_dpi(lines_per_inch, "lines_per_inch")) ** 2 + 1e-9) + 1


def halftoned(
    tone: NDArray[np.floating], dpi: float, lines_per_inch: float = 75.0, angle_degrees: float = 45.0, shape: str = "round"
) -> NDArray[np.bool_]:
    """Screen a picture: clustered dots whose area is the tone.

    Parameters
    ----------
    tone : (height, width) float
        Reflectance, 0 black to 1 white, linear: dots too small to be seen mix as light does. One value for each dot of the printer.
    dpi : float > 0
        Of the printer.
    lines_per_inch : float > 0, at most dpi / 2
    angle_degrees : float
        Of the screen's lines, counter-clockwise; 45 is seen least.
    shape : "round" | "diamond" | "line"
        Round dots grow to a checkerboard at one half, and are round holes beyond; diamonds are pointed; a line grows wider.

    Returns
    -------
    (height, width) bool
        True: paper; False: ink.

    **Source**: FoCG 3.1.2; Adobe, *PostScript Language Reference*, 3rd edition, 7.4 (spot functions). The spot functions are turned into
    their own distribution, so that the share of ink is 1 - tone for every tone.
    """
    dots, lines = checked_dpi(dpi), checked_dpi(lines_per_inch, "lines_per_inch")
    if lines > dots / 2.0:
        raise SceneError(f"lines_per_inch must be at most half the printer's dpi ({dots:g}), got {lines:g}")
    if not math.isfinite(angle_degrees):
        raise SceneError(f"angle_degrees must be finite, got {angle_degrees!r}")
    if shape not in SHAPES:
        raise UnsupportedError(f"shape must be one of {', '.join(SHAPES)}, got {shape!r}")
    height, width = tone.shape
    angle = math.radians(angle_degrees)
    x, y = np.arange(width) * (lines / dots), -np.arange(height)[:, None] * (lines / dots)
    u = x * math.cos(angle) + y * math.sin(angle)
    v = y * math.cos(angle) - x * math.sin(angle)
    spots, shares = _distribution(shape)
    threshold = np.interp(SHAPES[shape](u, v), spots, shares)
    return np.asarray(tone) > threshold


def _round(u: Floats, v: Floats) -> Floats:
    return np.cos(2.0 * np.pi * u) + np.cos(2.0 * np.pi * v)


def _diamond(u: Floats, v: Floats) -> Floats:
    a, b = 2.0 * np.abs(u - np.floor(u) - 0.5), 2.0 * np.abs(v - np.floor(v) - 0.5)
    return a + 0.9 * b  # not quite even, so that corners do not meet all at once


def _line(u: Floats, v: Floats) -> Floats:
    return np.cos(2.0 * np.pi * v) + 0.0 * u


SHAPES: dict[str, Callable[[Floats, Floats], Floats]] = {"round": _round, "diamond": _diamond, "line": _line}
"""Spot functions of the place in a cell, of period 1 in u and v: where it is greatest, ink comes first."""


@cache
def _distribution(shape: str) -> tuple[Floats, Floats]:
    """Values of a spot function, rising, and the share of the cell that lies below each."""
    grid = (np.arange(_FINE) + 0.5) / _FINE
    spots = np.sort(SHAPES[shape](grid[None, :], grid[:, None]), axis=None)
    spots = spots[:: _FINE // 2]
    return spots, (np.arange(len(spots)) * (_FINE // 2) + 0.5) / (_FINE * _FINE)
