"""Samples for any reconstruction filter: where they lie around a pixel, and what each counts (FoCG 8.3, 9.3)."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from .image.reconstruct import reconstruction
from .samples import GRID, pixel_samples

__all__ = ["filtered_samples"]


@functools.lru_cache(maxsize=64)
def filtered_samples(n: int, filter_name: str) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Sample places as far as a reconstruction filter reaches, and what each counts.

    A pixel is the mean of the picture around it, weighted by the filter (FoCG 8.3, 9.3; `limner.image.reconstruct`): the same points,
    spread over the filter's whole square, with its value there as their weight.

    Parameters
    ----------
    n : int
    filter_name : str
        As in `limner.image.reconstruct.FILTERS`; "box" is `pixel_samples` with equal weights.

    Returns
    -------
    places : (n, 2) int32
        Relative to the pixel's centre, in 1/256 pixel.
    weights : (n,) float32
        Their sum is n; negative in the lobes of filters that sharpen.
    """
    places = pixel_samples(n)
    if filter_name == "box" or n == 1:
        return places, np.ones(n, dtype=np.float32)
    found = reconstruction(filter_name)
    places = np.floor((places + 0.5) * (2.0 * found.radius)).astype(np.int32)
    weights = np.prod(found.function(places / GRID), axis=1)
    return places, (weights * (n / weights.sum())).astype(np.float32)
