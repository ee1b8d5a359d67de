"""Developing: from a film's sums to pixels, as light or as a screen wants it."""

from __future__ import annotations

import numpy as np

from ._jit import kernel
from .kernel.elementary import as_int

__all__ = ["develop_rows", "encode_rows"]

f32 = np.float32
_ZERO, _HALF, _ONE, _BYTE = f32(0.0), f32(0.5), f32(1.0), f32(255.0)
_LEAST = f32(2.0**-17)  # where the table of codes begins
_LEAST_BUCKET = (110 << 23) >> 12
_BUCKET_BITS = 12


@kernel
def _developed(sums, j: int, i: int, share: np.float32):
    """(r, g, b, alpha) of a pixel: its sums over its number of samples, with straight alpha."""
    r, g, b, alpha = sums[j, i, 0] * share, sums[j, i, 1] * share, sums[j, i, 2] * share, sums[j, i, 3] * share
    if alpha > _ZERO and alpha < _ONE:
        return r / alpha, g / alpha, b / alpha, alpha
    return r, g, b, alpha


@kernel
def _is_finite(r: np.float32, g: np.float32, b: np.float32, alpha: np.float32) -> bool:
    total = (r - r) + (g - g) + (b - b) + (alpha - alpha)
    return total == _ZERO


@kernel
def develop_rows(sums, shares, tile_size, tile_columns, first_row, last_row, pixels, bad):
    """Fill `pixels` (height, width, 4), row 0 on top, from rows first..last of the sums, row 0 at the bottom.

    `shares` (tiles) is one over the number of samples of each. bad[j] counts the pixels of a row that are not finite and became black.
    """
    height, width = sums.shape[0], sums.shape[1]
    for j in range(first_row, last_row):
        for i in range(width):
            share = shares[(j // tile_size) * tile_columns + i // tile_size]
            r, g, b, alpha = _developed(sums, j, i, share)
            if not _is_finite(r, g, b, alpha):
                bad[j] += 1
                r, g, b, alpha = _ZERO, _ZERO, _ZERO, _ZERO
            row = height - 1 - j
            pixels[row, i, 0], pixels[row, i, 1], pixels[row, i, 2], pixels[row, i, 3] = r, g, b, alpha


@kernel
def _srgb_code(value: np.float32, codes, changes) -> int:
    """The eight-bit code of linear light: by the leading bits of the float, and the exact place where the code changes."""
    held = min(value if value > _LEAST else _LEAST, _ONE)
    bucket = (np.int64(as_int(held)) >> _BUCKET_BITS) - _LEAST_BUCKET
    code = np.int64(codes[bucket])
    if code > 255:
        code = code - 256 + (1 if held >= changes[bucket] else 0)
    return code


@kernel
def encode_rows(sums, shares, tile_size, tile_columns, first_row, last_row, codes, changes, encoded, bad):
    """Fill `encoded` (height, width, 4) uint8, sRGB and straight alpha; else as `develop_rows`."""
    height, width = sums.shape[0], sums.shape[1]
    for j in range(first_row, last_row):
        for i in range(width):
            share = shares[(j // tile_size) * tile_columns + i // tile_size]
            r, g, b, alpha = _developed(sums, j, i, share)
            if not _is_finite(r, g, b, alpha):
                bad[j] += 1
                r, g, b, alpha = _ZERO, _ZERO, _ZERO, _ZERO
            row = height - 1 - j
            encoded[row, i, 0] = np.uint8(_srgb_code(r, codes, changes))
            encoded[row, i, 1] = np.uint8(_srgb_code(g, codes, changes))
            encoded[row, i, 2] = np.uint8(_srgb_code(b, codes, changes))
            encoded[row, i, 3] = np.uint8(min(max(alpha, _ZERO), _ONE) * _BYTE + _HALF)
