"""One level of a mipmap or ripmap from a larger one."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..color.decode_table import SRGB_DECODE
from ..kernel.elementary import floor

f32 = np.float32
_HALF, _ONE = f32(0.5), f32(1.0)


@kernel
def _encode(value: np.float32) -> int:
    """The sRGB code nearest to a linear value: bisection of the decoding table."""
    low, high = 0, 255
    while high - low > 1:
        middle = (low + high) // 2
        if SRGB_DECODE[middle] <= value:
            low = middle
        else:
            high = middle
    return high if value - SRGB_DECODE[low] > SRGB_DECODE[high] - value else low


@kernel
def _nearest_even(value: np.float32) -> np.float32:
    """The nearest integer, of two the even one: halves always rounded up would brighten every level by 1/8 of a code."""
    above = floor(value + _HALF)
    return above - _ONE if above - value == _HALF and floor(above * _HALF) * f32(2.0) != above else above


@kernel
def reduce_level(texels, source, target, width, height, columns, rows, srgb):
    """Average `columns` by `rows` texels, each 1 or 2, of the level at `source` (width x height) into the level at `target`."""
    new_width, new_height = max(1, width // columns), max(1, height // rows)
    for j in range(new_height):
        j0, j1 = rows * j, min(rows * j + rows - 1, height - 1)
        for i in range(new_width):
            i0, i1 = columns * i, min(columns * i + columns - 1, width - 1)
            corner0, corner1 = source + 4 * (j0 * width + i0), source + 4 * (j0 * width + i1)
            corner2, corner3 = source + 4 * (j1 * width + i0), source + 4 * (j1 * width + i1)
            place = target + 4 * (j * new_width + i)
            a0, a1 = f32(texels[corner0 + 3]), f32(texels[corner1 + 3])
            a2, a3 = f32(texels[corner2 + 3]), f32(texels[corner3 + 3])
            alpha = (a0 + a1) + (a2 + a3)
            texels[place + 3] = np.uint8(_nearest_even(alpha * f32(0.25)))
            if alpha == f32(0.0):
                a0, a1, a2, a3, alpha = _ONE, _ONE, _ONE, _ONE, f32(4.0)
            for c in range(3):
                t0, t1, t2, t3 = texels[corner0 + c], texels[corner1 + c], texels[corner2 + c], texels[corner3 + c]
                if srgb != 0:
                    v0, v1, v2, v3 = SRGB_DECODE[t0], SRGB_DECODE[t1], SRGB_DECODE[t2], SRGB_DECODE[t3]
                    mean = ((a0 * v0 + a1 * v1) + (a2 * v2 + a3 * v3)) / alpha
                    texels[place + c] = np.uint8(_encode(mean))
                else:
                    total = (a0 * f32(t0) + a1 * f32(t1)) + (a2 * f32(t2) + a3 * f32(t3))
                    texels[place + c] = np.uint8(_nearest_even(total / alpha))
