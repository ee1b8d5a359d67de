"""Reconstruction: from pixels, which are points, back to a picture that has a value everywhere (FoCG 3.2, 9.3).

A raster image is a table of numbers; the picture it stands for is a function of continuous (x, y). A filter says how: the value at a
place is the mean of the pixels around it, weighted by the filter centred there,

    I(x) = sum_i p_i f(x - i) / sum_i f(x - i)

and in the plane by the product of one filter in x and one in y. Dividing by the sum keeps a constant picture constant, whatever the
filter. Beyond its edges a picture goes on with its outermost pixels.

    name        radius   what it does
    box          1/2     the nearest pixel: steps
    tent         1       straight lines between pixels: continuous, with kinks
    gaussian     2       soft, never rings
    mitchell     2       smooth and sharp, rings little: the compromise for pictures
    lanczos3     3       sharpest; rings at edges
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError

__all__ = ["FILTERS", "Reconstruction", "Taps", "reconstruction", "sampled", "taps"]

Floats = NDArray[np.float64]

_SIGMA = 0.5  # of the Gaussian, in pixels
_POINTS_AT_ONCE = 1 << 16


class Reconstruction(NamedTuple):
    """A filter: its name, the distance beyond which it is zero (pixels), and its value at distances (...) float64."""

    name: str
    radius: float
    function: Callable[[Floats], Floats]


class Taps(NamedTuple):
    """For each of n places along one axis: the pixels that count there, and how much.

    pixels : (n, k) int64
        Held inside the picture: beyond an edge the outermost pixel counts.
    weights : (n, k) float64
        Rows sum to 1.
    """

    pixels: NDArray[np.int64]
    weights: Floats


def _box(x: Floats) -> Floats:
    # Half open, so that a place midway between two pixels belongs to one of them.
    return np.where((x >= -0.5) & (x < 0.5), 1.0, 0.0)


def _tent(x: Floats) -> Floats:
    return np.maximum(0.0, 1.0 - np.abs(x))


def _gaussian(x: Floats) -> Floats:
    value = np.exp(-(x * x) / (2.0 * _SIGMA**2)) - np.exp(-4.0 / (2.0 * _SIGMA**2))
    return np.maximum(value, 0.0)


def _mitchell(x: Floats) -> Floats:
    b = c = 1.0 / 3.0
    a = np.abs(x)
    near = (12.0 - 9.0 * b - 6.0 * c) * a**3 + (-18.0 + 12.0 * b + 6.0 * c) * a**2 + (6.0 - 2.0 * b)
    far = (-b - 6.0 * c) * a**3 + (6.0 * b + 30.0 * c) * a**2 + (-12.0 * b - 48.0 * c) * a + (8.0 * b + 24.0 * c)
    return np.where(a < 1.0, near, np.where(a < 2.0, far, 0.0)) / 6.0


def _lanczos3(x: Floats) -> Floats:
    return np.where(np.abs(x) < 3.0, np.sinc(x) * np.sinc(x / 3.0), 0.0)


FILTERS = {
    kind.name: kind
    for kind in (
        Reconstruction("box", 0.5, _box),
        Reconstruction("tent", 1.0, _tent),
        Reconstruction("gaussian", 2.0, _gaussian),
        Reconstruction("mitchell", 2.0, _mitchell),
        Reconstruction("lanczos3", 3.0, _lanczos3),
    )
}
"""By name. Each has the integral 1, or nearly (lanczos3: 0.997; gaussian: the constant is left to the division).

**Source**: FoCG 9.3 (box, tent, Gaussian); Mitchell and Netravali, *Reconstruction filters in computer graphics*, 1988, with
B = C = 1/3; Duchon, *Lanczos filtering in one and two dimensions*, 1979. The Gaussian (sigma 1/2) is lowered to reach 0 at its radius.
"""


def reconstruction(name: str) -> Reconstruction:
    """Return the filter of that name; UnsupportedError names them all."""
    if name not in FILTERS:
        raise UnsupportedError(f"filter must be one of {', '.join(FILTERS)}, got {name!r}")
    return FILTERS[name]


def taps(places: Floats, n_pixels: int, kind: Reconstruction, stretch: float = 1.0) -> Taps:
    """Say which pixels of a row of `n_pixels` make the value at each place, and with what weights.

    Parameters
    ----------
    places : (n,) float64
        Pixel centres are at integers; places outside count as the nearest edge of the outermost pixel's filter.
    n_pixels : int
    kind : Reconstruction
    stretch : float >= 1
        How much wider than a pixel the filter is: more than 1 where a picture shrinks, so that it does not alias.
    """
    radius = kind.radius * stretch
    held = np.clip(places, -radius - 1.0, n_pixels + radius)
    first = np.ceil(held - radius).astype(np.int64)
    near = first[:, None] + np.arange(int(np.floor(2.0 * radius)) + 1)
    weights = kind.function((held[:, None] - near) / stretch)
    totals = weights.sum(axis=1, keepdims=True)
    return Taps(np.clip(near, 0, n_pixels - 1), weights / totals)


def sampled(pixels: NDArray[np.float32], x: Floats, y: Floats, kind: Reconstruction) -> NDArray[np.float32]:
    """Look a picture up at places between its pixels.

    Parameters
    ----------
    pixels : (height, width, channels) float32
    x, y : (n,) float64
        Column, and row from the top; pixel centres are at integers.
    kind : Reconstruction

    Returns
    -------
    (n, channels) float32
    """
    height, width, channels = pixels.shape
    out = np.empty((len(x), channels), dtype=np.float32)
    for start in range(0, len(x), _POINTS_AT_ONCE):
        part = slice(start, start + _POINTS_AT_ONCE)
        across, down = taps(x[part], width, kind), taps(y[part], height, kind)
        sums = np.zeros((len(across.pixels), channels))
        for j in range(down.pixels.shape[1]):
            for i in range(across.pixels.shape[1]):
                weight = across.weights[:, i] * down.weights[:, j]
                sums += weight[:, None] * pixels[down.pixels[:, j], across.pixels[:, i]]
        out[part] = sums
    return out
