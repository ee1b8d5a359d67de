"""The sky as rough mirrors see it, made beforehand (see `limner.shading.prefilter`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..tiles import run_all
from .layouts import BLURRED_HEIGHT, BLURRED_LEVELS, BLURRED_WIDTH
from .lighting import sky_directions

__all__ = ["blurred_sky"]

_ROWS_AT_ONCE = 4
_BLUR = Door(
    "limner.tables.sky_blur_kernel",
    "blur_sky",
    (Array(np.float32, 2), Array(np.float32, 2), Array(np.float32, 3), *[Scalar(np.int64)] * 3),
    "blurring the sky",
)


def blurred_sky(sky: NDArray[np.float32], threads: int) -> NDArray[np.float32]:
    """Blur a sky for each of a few roughnesses.

    Parameters
    ----------
    sky : (height, width, 3) float32
        Radiance, equirectangular, row 0 on top.
    threads : int

    Returns
    -------
    (BLURRED_LEVELS * BLURRED_HEIGHT, BLURRED_WIDTH, 3) float32
        Level k, of perceptual roughness (k + 1) / BLURRED_LEVELS, from row k BLURRED_HEIGHT on; row 0 of each at the bottom.
    """
    small = reduced(sky[::-1], 2 * BLURRED_HEIGHT, 2 * BLURRED_WIDTH)
    directions, solid_angles = sky_directions(*small.shape[:2])
    angles = np.broadcast_to(solid_angles, small.shape[:2])
    source = np.concatenate([small.reshape(-1, 3), angles.reshape(-1, 1)], axis=1).astype(np.float32)
    towards = np.ascontiguousarray(directions.reshape(-1, 3), dtype=np.float32)
    blurred = np.empty((BLURRED_LEVELS * BLURRED_HEIGHT, BLURRED_WIDTH, 3), dtype=np.float32)
    bands = [(level, row, row + _ROWS_AT_ONCE) for level in range(BLURRED_LEVELS) for row in range(0, BLURRED_HEIGHT, _ROWS_AT_ONCE)]
    run_all(lambda band: _BLUR(source, towards, blurred, *band), bands, threads)
    return blurred


def reduced(pixels: NDArray[np.float32], height: int, width: int) -> NDArray[np.float64]:
    """A picture of at most the given size, by the means of equal blocks."""
    step_y, step_x = max(1, pixels.shape[0] // height), max(1, pixels.shape[1] // width)
    rows, columns = pixels.shape[0] // step_y, pixels.shape[1] // step_x
    blocks = pixels[: rows * step_y, : columns * step_x].reshape(rows, step_y, columns, step_x, 3)
    return np.asarray(blocks.mean(axis=(1, 3), dtype=np.float64))
