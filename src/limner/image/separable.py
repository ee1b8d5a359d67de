"""Filters that are a product of one in x and one in y, applied fast: a banded matrix for the rows, one for the columns.

A filtered row is a weighted sum of a few neighbouring rows, so filtering all rows is multiplying with a matrix that is zero away from
a band. Cut into blocks it is a few dozen small dense products, which is what processors are best at.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .reconstruct import Taps

__all__ = ["convolution_taps", "filtered"]

_BLOCK = 32  # rows made at once: the band's width is of this order


def filtered(planes: NDArray[np.floating], down: Taps | None, across: Taps | None) -> NDArray[np.float64]:
    """Filter a picture along both axes.

    Parameters
    ----------
    planes : (height, width, channels) float
    down, across : Taps, optional
        What makes each new row out of the rows, and each new column out of the columns; None: they stay.

    Returns
    -------
    (new height, new width, channels) float64
        In float64 the weights sum to 1 so nearly that, rounded to float32, what was constant is the same to the bit.
    """
    made = np.asarray(planes, dtype=np.float64)
    if down is not None:
        made = _rows(made, down)
    if across is not None:
        made = _rows(made.transpose(1, 0, 2), across).transpose(1, 0, 2)
    return made


def _rows(planes: NDArray[np.float64], taps: Taps) -> NDArray[np.float64]:
    height, width, channels = planes.shape
    rows = np.ascontiguousarray(planes).reshape(height, width * channels)
    n = len(taps.pixels)
    out = np.empty((n, width * channels))
    for start in range(0, n, _BLOCK):
        pixels, weights = taps.pixels[start : start + _BLOCK], taps.weights[start : start + _BLOCK]
        low, high = int(pixels.min()), int(pixels.max()) + 1
        band = np.zeros((len(pixels), high - low))
        np.add.at(band, (np.arange(len(pixels))[:, None], pixels - low), weights)
        np.matmul(band, rows[low:high], out=out[start : start + _BLOCK])
    return out.reshape(n, width, channels)


def convolution_taps(kernel: NDArray[np.float64], n_pixels: int) -> Taps:
    """Weights that convolve n pixels with a kernel (2 r + 1,) float64 that is centred; beyond the edges the outermost pixel goes on.

    The kernel is taken as it stands: its sum may be anything.
    """
    radius = len(kernel) // 2
    near = np.arange(n_pixels)[:, None] + np.arange(-radius, radius + 1)
    return Taps(np.clip(near, 0, n_pixels - 1), np.broadcast_to(kernel[::-1], near.shape))
