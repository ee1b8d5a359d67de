"""Lines of whole pixels: the midpoint algorithm (FoCG 8.1.1).

A line from (x0, y0) to (x1, y1) is a "reasonable" set of pixels: connected, thin, and as near to the true line as pixels can
be. Where it is wider than high it has one pixel in each column, the one whose centre is nearest; where it is higher than wide,
one in each row. Going from one column to the next there are two candidates, and the midpoint between them decides: is it below
the line or above it? The implicit equation of the line tells, and it need not be evaluated anew, only added to.

    line_pixels(0, 0, 7, 3)

        x   0 1 2 3 4 5 6 7
    y 0     # #
      1         # #
      2             # #
      3                 # #
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._door import Array, Door
from ..errors import SceneError

__all__ = ["SUBPIXELS", "draw_pixel_lines", "line_pixels", "snapped"]

SUBPIXELS = 256
"""Ends of lines lie on a grid of so many places a pixel."""

_GREATEST = float(1 << 20)  # pixels: with 1/256 of them, products of two differences stay below 2^62

_walk = Door(
    "limner.draw.midpoint_kernel",
    "walk_line",
    (Array(np.int64, 1), Array(np.int64, 1), Array(np.int64, 2), Array(np.int64, 1)),
    "lines of pixels",
)
_draw = Door(
    "limner.draw.midpoint_kernel",
    "draw_lines",
    (Array(np.int64, 2), Array(np.int64, 1), Array(np.float32, 2), Array(np.float32, 3)),
    "lines of pixels, painted",
)


def snapped(lines: ArrayLike) -> NDArray[np.int64]:
    """Bring the ends of lines, (n, 4) float pixels, to the nearest 1/256 pixel: (n, 4) int64 in these units."""
    try:
        given = np.asarray(lines, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"lines must be numbers x0, y0, x1, y1, got {type(lines).__name__}") from None
    if given.ndim != 2 or given.shape[1] != 4:
        raise SceneError(f"lines must have shape (n, 4): x0, y0, x1, y1, got {given.shape}")
    if not (np.abs(given) <= _GREATEST).all():
        raise SceneError(f"ends of lines must be finite and within {_GREATEST:.0f} pixels of the picture's corner")
    return np.ascontiguousarray(np.rint(given * SUBPIXELS), dtype=np.int64)


def line_pixels(
    x0: float, y0: float, x1: float, y1: float, clip: tuple[int, int, int, int] | None = None
) -> NDArray[np.int64]:
    """Find the pixels of a line.

    Parameters
    ----------
    x0, y0, x1, y1 : float
        Ends, in pixels with centres at integers; brought to the nearest 1/256 pixel. y may point up or down.
    clip : (left, top, right, bottom), optional
        Only the pixels with left <= x < right and top <= y < bottom. They are the very pixels that the whole line has there,
        and what lies outside is not walked.

    Returns
    -------
    (n, 2) int64
        x, y of each pixel, from the end with the smaller x (or y, where the line is higher than wide) on. Both directions give
        the same pixels: where the line passes midway between two, the one with the smaller coordinate is taken. The first and
        last are the pixels nearest to the ends. A line of no length is one pixel.

    >>> line_pixels(0, 0, 7, 3)[:, 1].tolist()
    [0, 0, 1, 1, 2, 2, 3, 3]

    **Source**: FoCG 8.1.1; Pitteway, *Algorithm for drawing ellipses or hyperbolae with a digital plotter*, 1967; Van Aken and
    Novak, *Curve-drawing algorithms for raster displays*, 1985. For all slopes, for ends between pixels, and with the decision
    number started in the first visible column.
    """
    line = snapped([[x0, y0, x1, y1]])[0]
    if clip is None:
        low = np.minimum(line[:2], line[2:]) // SUBPIXELS - 1
        high = np.maximum(line[:2], line[2:]) // SUBPIXELS + 3
        box = np.concatenate([low, high])
    else:
        box = np.array(clip, dtype=np.int64)
        if box.shape != (4,) or (np.abs(box) > _GREATEST).any():
            raise SceneError(f"clip must be four whole numbers left, top, right, bottom, got {clip!r}")
    along = int(max(abs(line[2] - line[0]), abs(line[3] - line[1]))) // SUBPIXELS + 2
    out = np.empty((min(along, max(0, int((box[2:] - box[:2]).max()))), 2), dtype=np.int64)
    count = np.zeros(1, dtype=np.int64)
    _walk(line, box, out, count)
    return out[: int(count[0])]


def draw_pixel_lines(
    lines: ArrayLike, colors: NDArray[np.float32], box: tuple[int, int, int, int], target: NDArray[np.float32]
) -> None:
    """Paint lines of whole pixels over a picture.

    Parameters
    ----------
    lines : (n, 4) float
        x0, y0, x1, y1.
    colors : (n, 4) float32
        Premultiplied.
    box : (left, top, right, bottom)
        Whole pixels inside the picture.
    target : (height, width, 4) float32
        Premultiplied; painted in the lines' order.
    """
    _draw(snapped(lines), np.array(box, dtype=np.int64), np.ascontiguousarray(colors), target)
