"""The viewport transformation: from the canonical square to pixels (FoCG 7.1.1).

    raster_from_ndc = viewport(n_x, n_y)
    pixel_from_raster = rows_from_top(n_y)

Pixel (i, j) counts columns from the left and rows from the *bottom*, its centre has integer coordinates, and the picture covers
[-0.5, n_x - 0.5] x [-0.5, n_y - 0.5]. Where pictures meet arrays, rows are counted from the top: `rows_from_top` turns one into the
other, and back.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["crop", "inverse_viewport", "rows_from_top", "viewport"]

Matrix = NDArray[np.float64]


def viewport(n_x: int, n_y: int, left: int = 0, bottom: int = 0) -> Matrix:
    """Map [-1, 1]^2 to [-0.5, n_x - 0.5] x [-0.5, n_y - 0.5]; z stays.

    Parameters
    ----------
    n_x, n_y : int >= 1
        Width and height in pixels.
    left, bottom : int
        The first pixel, of a viewport that is a part of a picture.

    Returns
    -------
    (4, 4) float64
        M_vp.

    Examples
    --------
    >>> (viewport(640, 480) @ [-1, 1, 0, 1]).tolist()
    [-0.5, 479.5, 0.0, 1.0]

    **Source**: FoCG 7.1.1.
    """
    _check_size(n_x, n_y)
    matrix = np.diag([n_x / 2.0, n_y / 2.0, 1.0, 1.0])
    matrix[:2, 3] = left + (n_x - 1) / 2.0, bottom + (n_y - 1) / 2.0
    return matrix


def inverse_viewport(n_x: int, n_y: int, left: int = 0, bottom: int = 0) -> Matrix:
    """(4, 4) float64: from pixels back to [-1, 1]^2, M_vp^-1 by its structure. **Source**: FoCG 6.4, 7.1.1."""
    _check_size(n_x, n_y)
    matrix = np.diag([2.0 / n_x, 2.0 / n_y, 1.0, 1.0])
    matrix[:2, 3] = -(2 * left + n_x - 1) / n_x, -(2 * bottom + n_y - 1) / n_y
    return matrix


def rows_from_top(n_y: int) -> Matrix:
    """(4, 4) float64: count rows from the top instead of the bottom, y' = n_y - 1 - y; its own inverse."""
    _check_size(1, n_y)
    matrix = np.diag([1.0, -1.0, 1.0, 1.0])
    matrix[1, 3] = n_y - 1.0
    return matrix


def crop(n_x: int, n_y: int, left: int, bottom: int, crop_x: int, crop_y: int) -> Matrix:
    """Make a rectangle of a picture a picture of its own: ``clip_of_part = crop(...) @ clip_of_whole``.

    Parameters
    ----------
    n_x, n_y : int >= 1
        The whole picture, in pixels.
    left, bottom : int
        The first pixel of the rectangle; it may lie outside the whole, to show more.
    crop_x, crop_y : int >= 1
        The rectangle's width and height in pixels, which the part is drawn with.

    Returns
    -------
    (4, 4) float64
        For clip space, any w. Then ``viewport(crop_x, crop_y)`` gives what ``viewport(n_x, n_y)`` gave of the whole, less
        (left, bottom): pixels of the part are pixels of the whole, exactly.

    Examples
    --------
    The right upper quarter of 640 x 480 pixels, in its own canonical square:

    >>> (crop(640, 480, 320, 240, 320, 240) @ [0.5, 0.5, 0, 1]).tolist()
    [0.0, 0.0, 0.0, 1.0]

    **Source**: FoCG 7.1.1; the windowing transformation of 6.3 from the rectangle to the canonical square.
    """
    _check_size(n_x, n_y)
    _check_size(crop_x, crop_y)
    matrix = np.diag([n_x / crop_x, n_y / crop_y, 1.0, 1.0])
    matrix[:2, 3] = (n_x - 2 * left - crop_x) / crop_x, (n_y - 2 * bottom - crop_y) / crop_y
    return matrix


def _check_size(n_x: int, n_y: int) -> None:
    if n_x < 1 or n_y < 1:
        raise SceneError(f"a picture must be at least 1 pixel wide and high, got {n_x} x {n_y}")
