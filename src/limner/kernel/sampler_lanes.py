"""Sobol's points for eight who ask at once: the numbers of `limner.kernel.sampler`, bit for bit.

Lanes have signed integers, whose right shift drags the sign along; what it drags in is masked off. Sums and products modulo 2^32 are the
same of signed and of unsigned numbers.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from .lanes import f32x8, i32x8, to_float

__all__ = ["draw_1d_of_eight", "draw_2d_of_eight"]

f32, i32 = np.float32, np.int32


def _signed(word: int) -> np.int32:
    return np.uint32(word).astype(np.int32)


_ULP = f32(2.0**-24)
_M1, _M2, _GOLDEN = _signed(0x21F0AAAD), _signed(0x735A2D97), _signed(0x9E3779B9)
_LK1, _LK2, _LK3 = _signed(0x3D20ADEA), _signed(0x05526C56), _signed(0x53A22864)
_FIRST, _SECOND, _SHUFFLE = _signed(0x9E3779B1), _signed(0x85EBCA77), i32(2)
_ODD_1, _ODD_2, _ODD_4 = _signed(0x55555555), _signed(0x33333333), _signed(0x0F0F0F0F)
_ODD_8, _LOW_16, _LOW_17, _LOW_24 = _signed(0x00FF00FF), _signed(0x0000FFFF), _signed(0x0001FFFF), _signed(0x00FFFFFF)
_1, _2, _4, _8, _15, _16 = i32(1), i32(2), i32(4), i32(8), i32(15), i32(16)


@kernel
def _combined(state: i32x8, x: i32x8) -> i32x8:
    """`rng.combine`"""
    a = (state ^ x) + _GOLDEN
    a = (a ^ ((a >> _16) & _LOW_16)) * _M1
    a = (a ^ ((a >> _15) & _LOW_17)) * _M2
    return a ^ ((a >> _15) & _LOW_17)


@kernel
def _reversed(x: i32x8) -> i32x8:
    a = ((x >> _1) & _ODD_1) | ((x & _ODD_1) << _1)
    a = ((a >> _2) & _ODD_2) | ((a & _ODD_2) << _2)
    a = ((a >> _4) & _ODD_4) | ((a & _ODD_4) << _4)
    a = ((a >> _8) & _ODD_8) | ((a & _ODD_8) << _8)
    return ((a >> _16) & _LOW_16) | (a << _16)


@kernel
def _pascal(x: i32x8) -> i32x8:
    a = x ^ ((x >> _16) & _LOW_16)
    a = a ^ ((a >> _8) & _ODD_8)
    a = a ^ ((a >> _4) & _ODD_4)
    a = a ^ ((a >> _2) & _ODD_2)
    return a ^ ((a >> _1) & _ODD_1)


@kernel
def _scrambled(x: i32x8, key: i32x8) -> i32x8:
    a = (x ^ (x * _LK1)) + key
    a = a * (((key >> _16) & _LOW_16) | _1)
    a = a ^ (a * _LK2)
    return a ^ (a * _LK3)


@kernel
def _another(key: i32x8, odd: np.int32) -> i32x8:
    a = key * odd
    return a ^ ((a >> _16) & _LOW_16)


@kernel
def _shuffled(sample: i32x8, key: i32x8) -> i32x8:
    return _reversed(_scrambled(_reversed(sample), _combined(key, key * i32(0) + _SHUFFLE)))


@kernel
def _fraction(x: i32x8) -> f32x8:
    return to_float((_reversed(x) >> _8) & _LOW_24) * _ULP


@kernel
def draw_1d_of_eight(pixel: i32x8, sample: i32x8, dimension: i32x8) -> f32x8:
    """`draw_1d` of SOBOL, of eight samples of eight pixels, the words of which are `pixel`."""
    key = _combined(pixel, dimension)
    return _fraction(_scrambled(_shuffled(sample, key), _another(key, _FIRST)))


@kernel
def draw_2d_of_eight(pixel: i32x8, sample: i32x8, dimension: i32x8) -> tuple[f32x8, f32x8]:
    """`draw_2d` of SOBOL, likewise."""
    key = _combined(pixel, dimension)
    index = _shuffled(sample, key)
    return _fraction(_scrambled(index, _another(key, _FIRST))), _fraction(_scrambled(_pascal(index), _another(key, _SECOND)))
