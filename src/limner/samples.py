"""Where in its pixel a renderer looks: the pattern that all pixels share (FoCG 8.3, 13.4.1).

The Hammersley points (i/n, radical inverse of i): each of n columns and each of n rows of the pixel holds one, so edges at any
slope get n grey levels from n samples. They lie on the rasteriser's subpixel grid, where coverage is exact; the tracers use the same
places, so that both see the same.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["GRID", "pixel_samples"]

GRID = 256


def pixel_samples(n: int) -> NDArray[np.int32]:
    """(n, 2) int32: sample places relative to the pixel's centre, in 1/256 pixel, within [-128, 127].

    **Source**: van der Corput 1935; Hammersley 1960. One sample stands in the centre.
    """
    index = np.arange(n)
    inverse = np.zeros(n)
    weight, rest = 0.5, index.copy()
    while rest.any():
        inverse += weight * (rest & 1)
        rest >>= 1
        weight *= 0.5
    x = (index + 0.5) / n - 0.5
    y = inverse + 0.5 / 2.0 ** max(0, int(np.ceil(np.log2(n)))) - 0.5
    places = np.floor(np.stack([x, y], axis=1) * GRID + 0.5).astype(np.int32)
    return np.ascontiguousarray(np.clip(places, -GRID // 2, GRID // 2 - 1))
