"""Developing: from a film's sums to pixels, as light or as a screen wants it. Eight pixels at once."""

from __future__ import annotations

import numpy as np

from ._jit import kernel
from .kernel.elementary import as_int
from .kernel.lanes import (
    all_of,
    any_of,
    at,
    count_set,
    f32x8,
    i32x8,
    int32,
    load8,
    mask_of,
    max,
    min,
    put,
    splat8,
    store8,
    store_rows,
    where,
)

__all__ = ["clear_tile", "develop_tile", "encode_tile"]

f32, i32 = np.float32, np.int32
_ZERO, _HALF, _ONE, _BYTE = f32(0.0), f32(0.5), f32(1.0), f32(255.0)
_LEAST = f32(2.0**-17)  # where the table of codes begins
_LEAST_BUCKET = i32((110 << 23) >> 12)
_BUCKET_BITS = i32(12)
_COUNTING = np.arange(8, dtype=np.int32)


@kernel
def clear_tile(sums, width, tile, first_column, first_row, columns, rows):
    """Take from a tile of the sums (height * width, 4) what a picture before has left."""
    black = splat8(_ZERO)
    for j in range(first_row, first_row + rows):
        start = j * width + first_column
        whole = columns - columns % 8
        for i in range(0, whole, 8):
            store_rows(sums, start + i, black, black, black, black)
        for i in range(whole, columns):
            for c in range(4):
                sums[start + i, c] = _ZERO


@kernel
def _developed(sums, place: i32x8, share: np.float32):
    """(r, g, b, alpha) of pixels: their sums over their number of samples, with straight alpha."""
    r, g, b = at(sums, (place, 0)) * share, at(sums, (place, 1)) * share, at(sums, (place, 2)) * share
    coverage = at(sums, (place, 3)) * share
    # A filter that sharpens overshoots at edges; there is no more coverage than all. NaN stays, to be found.
    alpha = where(coverage == coverage, min(max(_ZERO, coverage), _ONE), coverage)
    divisor = where((alpha > _ZERO) & (alpha < _ONE), alpha, _ONE)
    return r / divisor, g / divisor, b / divisor, alpha


@kernel
def _is_finite(r: f32x8, g: f32x8, b: f32x8, alpha: f32x8):
    total = (r - r) + (g - g) + (b - b) + (alpha - alpha)
    return total == _ZERO


@kernel
def develop_tile(sums, pixels, bad, width, share, tile, first_column, first_row, columns, rows):
    """Fill a tile of `pixels` (height * width * 4,), row 0 on top, from the sums (height * width, 4), row 0 at the bottom.

    `share` is one over the number of samples. bad[tile] becomes the number of pixels that are not finite and became black.
    """
    height, wrong = sums.shape[0] // width, 0
    for j in range(first_row, first_row + rows):
        start, out = j * width + first_column, 4 * ((height - 1 - j) * width + first_column)
        for i in range(0, columns, 8):
            column = min(load8(_COUNTING, 0) + i, columns - 1)
            r, g, b, alpha = _developed(sums, column + start, share)
            fine = _is_finite(r, g, b, alpha)
            if not all_of(fine):
                wrong += count_set(mask_of((fine ^ True) & (load8(_COUNTING, 0) < columns - i)))
            place = column * 4 + out
            put(pixels, place, where(fine, r, _ZERO))
            put(pixels, place + 1, where(fine, g, _ZERO))
            put(pixels, place + 2, where(fine, b, _ZERO))
            put(pixels, place + 3, where(fine, alpha, _ZERO))
    bad[tile] = wrong


@kernel
def _srgb_code(value: f32x8, codes, changes) -> i32x8:
    """The eight-bit code of linear light: by the leading bits of the float, and the exact place where the code changes."""
    held = min(max(_LEAST, value), _ONE)
    bucket = (as_int(held) >> _BUCKET_BITS) - _LEAST_BUCKET
    code = at(codes, bucket)
    changes_within = code > 255
    if any_of(changes_within):
        code = where(changes_within, code - 256 + where(held >= at(changes, bucket), 1, 0), code)
    return code


@kernel
def encode_tile(sums, codes, changes, encoded, bad, width, share, tile, first_column, first_row, columns, rows):
    """Fill a tile of `encoded` (height * width,), four bytes RGBA each, sRGB and straight alpha; else as `develop_tile`."""
    height, wrong = sums.shape[0] // width, 0
    for j in range(first_row, first_row + rows):
        start, out = j * width + first_column, (height - 1 - j) * width + first_column
        for i in range(0, columns, 8):
            column = min(load8(_COUNTING, 0) + i, columns - 1)
            r, g, b, alpha = _developed(sums, column + start, share)
            fine = _is_finite(r, g, b, alpha)
            if not all_of(fine):
                wrong += count_set(mask_of((fine ^ True) & (load8(_COUNTING, 0) < columns - i)))
            r, g, b, alpha = where(fine, r, _ZERO), where(fine, g, _ZERO), where(fine, b, _ZERO), where(fine, alpha, _ZERO)
            red, green, blue = _srgb_code(r, codes, changes), _srgb_code(g, codes, changes), _srgb_code(b, codes, changes)
            opacity = int32(min(max(alpha, _ZERO), _ONE) * _BYTE + _HALF)
            # The first byte in memory is the lowest, as everywhere where Numba compiles.
            word = red | (green << 8) | (blue << 16) | (opacity << 24)
            if i + 8 <= columns:
                store8(encoded, out + i, word)
            else:
                put(encoded, column + out, word)
    bad[tile] = wrong
