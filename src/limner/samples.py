"""Where in its pixel a renderer looks: the pattern that all pixels share (FoCG 8.3, 13.4.1).

The first points of Sobol's two-dimensional sequence: of a power of two of them, each column and each row of so many of the pixel holds
one, so edges at any slope get as many grey levels; and however few have been taken, they are spread over the whole pixel. They lie on
the rasteriser's subpixel grid, where coverage is exact; the tracers use the same places, so that both see the same.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["GRID", "pixel_samples"]

GRID = 256
_BITS = 24


@functools.lru_cache(maxsize=64)
def pixel_samples(n: int) -> NDArray[np.int32]:
    """(n, 2) int32: sample places relative to the pixel's centre, in 1/256 pixel, within [-128, 127].

    **Source**: Sobol' 1967; the direction numbers of the second dimension are the rows of Pascal's triangle modulo 2. One sample
    stands in the centre.
    """
    index = np.arange(n, dtype=np.int64)
    x, y = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    direction = 1 << (_BITS - 1)
    for k in range(_BITS):
        bit = (index >> k) & 1
        x ^= bit << (_BITS - 1 - k)
        y ^= bit * direction
        direction ^= direction >> 1
    # Half a cell of the finest grid that the points fill, so that their mean is the centre.
    half = 0.5 / 2.0 ** max(0, math.ceil(math.log2(n)))
    steps = np.floor((np.stack([x, y], axis=1) / 2.0**_BITS + (half - 0.5)) * GRID + 0.5).astype(np.int32)
    places = np.ascontiguousarray(np.clip(steps, -GRID // 2, GRID // 2 - 1))
    places.flags.writeable = False  # every picture shares it
    return places
