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
    lane,
    load8,
    load_rows,
    mask_of,
    max,
    min,
    put,
    splat8,
    splat8_int,
    store8,
    store_rows,
    where,
)

__all__ = ["clear_rows", "clear_tile", "develop_tile", "encode_rows", "encode_tile"]

f32, i32 = np.float32, np.int32
_NOT_A_NUMBER = f32(np.nan)
_ZERO, _HALF, _ONE, _BYTE = f32(0.0), f32(0.5), f32(1.0), f32(255.0)
_LEAST = f32(2.0**-17)  # where the table of codes begins
_LEAST_BUCKET = i32((110 << 23) >> 12)
_BUCKET_BITS = i32(12)
_COUNTING = np.arange(8, dtype=np.int32)


@kernel
def clear_rows(sums, first: int, stride: int, columns: int, rows: int):
    """Make a part of the sums (n, 4) zero that begins in row `first` of them and has a row of pixels every `stride`."""
    black = splat8(_ZERO)
    for j in range(rows):
        start = first + j * stride
        whole = columns - columns % 8
        for i in range(0, whole, 8):
            store_rows(sums, start + i, black, black, black, black)
        for i in range(whole, columns):
            for c in range(4):
                sums[start + i, c] = _ZERO


@kernel
def clear_tile(sums, width, tile, first_column, first_row, columns, rows):
    """Take from a tile of the sums (height * width, 4) what a picture before has left."""
    clear_rows(sums, first_row * width + first_column, width, columns, rows)


@kernel
def _developed(r: f32x8, g: f32x8, b: f32x8, coverage: f32x8, share: np.float32):
    """(r, g, b, alpha) of pixels: their sums over their number of samples, with straight alpha."""
    r, g, b, coverage = r * share, g * share, b * share, coverage * share
    # A filter that sharpens overshoots at edges; there is no more coverage than all. NaN stays, to be found.
    alpha = where(coverage == coverage, min(max(_ZERO, coverage), _ONE), coverage)
    divisor = where((alpha > _ZERO) & (alpha < _ONE), alpha, _ONE)
    return r / divisor, g / divisor, b / divisor, alpha


@kernel
def _sums_at(sums, place: i32x8):
    return at(sums, (place, 0)), at(sums, (place, 1)), at(sums, (place, 2)), at(sums, (place, 3))


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
            r, g, b, coverage = _sums_at(sums, column + start)
            r, g, b, alpha = _developed(r, g, b, coverage, share)
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
def _encoded(r: f32x8, g: f32x8, b: f32x8, coverage: f32x8, codes, changes, share: np.float32):
    """(RGBA, which are finite) of eight pixels by their sums: four bytes each, the first one lowest, as everywhere where Numba compiles."""
    r, g, b, alpha = _developed(r, g, b, coverage, share)
    fine = _is_finite(r, g, b, alpha)
    r, g, b, alpha = where(fine, r, _ZERO), where(fine, g, _ZERO), where(fine, b, _ZERO), where(fine, alpha, _ZERO)
    red, green, blue = _srgb_code(r, codes, changes), _srgb_code(g, codes, changes), _srgb_code(b, codes, changes)
    opacity = int32(min(max(alpha, _ZERO), _ONE) * _BYTE + _HALF)
    return red | (green << 8) | (blue << 16) | (opacity << 24), fine


@kernel
def encode_rows(sums, first: int, stride: int, codes, changes, encoded, out: int, width: int, share: np.float32, columns: int, rows: int):
    """Encode a part of the sums (n, 4), which begins in row `first` of them and has a row of pixels every `stride`.

    Its lowest row of pixels goes to encoded[out : out + columns], the one above it to where it is `width` less. Returns how many pixels are
    not finite; they become black.
    """
    wrong = 0
    counting = load8(_COUNTING, 0)
    # Most pictures are even in many places: what is as the pixel before it need not be found again.
    last_r, last_g, last_b, last_coverage, last_code = _ZERO, _ZERO, _ZERO, _ZERO, i32(0)
    for j in range(rows):
        start, place = first + j * stride, out - j * width
        for i in range(0, columns, 8):
            if i + 8 <= columns:
                r, g, b, coverage = load_rows(sums, start + i)
                if all_of((r == last_r) & (g == last_g) & (b == last_b) & (coverage == last_coverage)):
                    store8(encoded, place + i, splat8_int(last_code))
                    continue
                code, fine = _encoded(r, g, b, coverage, codes, changes, share)
                store8(encoded, place + i, code)
                last_r, last_g, last_b, last_coverage, last_code = lane(r, 7), lane(g, 7), lane(b, 7), lane(coverage, 7), lane(code, 7)
            else:
                column = min(counting + i, columns - 1)
                r, g, b, coverage = _sums_at(sums, column + start)
                code, fine = _encoded(r, g, b, coverage, codes, changes, share)
                put(encoded, column + place, code)
            if not all_of(fine):
                wrong += count_set(mask_of((fine ^ True) & (counting < columns - i)))
                last_r = _NOT_A_NUMBER  # which nothing is like: each of them counts
    return wrong


@kernel
def encode_tile(sums, codes, changes, encoded, bad, width, share, tile, first_column, first_row, columns, rows):
    """Fill a tile of `encoded` (height * width,), four bytes RGBA each, sRGB and straight alpha; else as `develop_tile`."""
    first, out = first_row * width + first_column, (sums.shape[0] // width - 1 - first_row) * width + first_column
    bad[tile] = encode_rows(sums, first, width, codes, changes, encoded, out, width, share, columns, rows)
