"""Strata: n samples of which each gets a part of the unit square of its own, in an order of its own.

A pixel's n samples are dealt the cells of a grid of `columns` by n / columns. Which sample gets which cell is a random order, another
one for every pixel and every decision, so that a sample's place on the lens says nothing of its place in the pixel.

    REGULAR          centres of the cells            JITTERED         anywhere in the cell

    MULTI_JITTERED   of each cell, one of its subcells, so chosen that each of n thin columns and each of n thin rows holds one sample,
                     as rooks that do not threaten each other

n need not be a square: the grid is the squarest there is, and for a prime number of samples a single column.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from .rng import combine, float_from_word, mix

__all__ = ["halton", "permuted", "radical_inverse_3", "stratified_1d", "stratified_2d"]

f32, u32, i64 = np.float32, np.uint32, np.int64
_ONE, _HALF, _THIRD = f32(1.0), f32(0.5), f32(1.0 / 3.0)
_LAST = f32(1.0 - 2.0**-24)  # the greatest float32 below 1
_FEWEST_ROUNDS = 8
_STEP, _LOWEST = u32(0x9E3779B9), u32(1)
_JITTER_X, _JITTER_Y, _ROWS, _COLUMNS = i64(4), i64(5), i64(6), i64(7)


@kernel
def permuted(i: int, n: int, key: np.uint32) -> int:
    """Where i of 0..n-1 stands in a random order that `key` decides; n < 2^31.

    In every round each number has a partner, ``k - x`` modulo n with a random k, and the two change places, or not, by lot.

    **Source**: Hoang, Morris and Rogaway, "An enciphering scheme based on a card shuffle", CRYPTO 2012: the swap-or-not shuffle; their
    proof asks for about 6 log2 n rounds against an adversary, a sampler is content with fewer.
    """
    x, rounds = i64(i), i64(_FEWEST_ROUNDS)
    while (i64(1) << rounds - _FEWEST_ROUNDS) < n:
        rounds += i64(1)
    state = key
    for _ in range(rounds):
        state = mix(u32(state + _STEP))
        partner = (i64(state) % n) - x
        if partner < 0:
            partner += n
        if (mix(u32(u32(max(x, partner)) ^ state)) & _LOWEST) == _LOWEST:
            x = partner
    return x


@kernel
def _jitter(sample: int, key: np.uint32, axis: np.int64) -> np.float32:
    return float_from_word(combine(combine(key, axis), sample))


@kernel
def stratified_1d(sample: int, n: int, is_regular: bool, key: np.uint32) -> np.float32:
    """A number of the sample's own n-th of [0, 1): anywhere in it, or its middle."""
    cell = permuted(sample, n, key)
    return min((f32(cell) + (_HALF if is_regular else _jitter(sample, key, _JITTER_X))) / f32(n), _LAST)


@kernel
def stratified_2d(sample: int, n: int, columns: int, is_regular: bool, is_multi: bool, key: np.uint32) -> tuple[np.float32, np.float32]:
    """A point of the sample's own cell: anywhere in it, its middle, or in the subcell where its row and column cross.

    **Source**: Chiu, Shirley and Wang, "Multi-jittered sampling", Graphics Gems IV, 1994; that all cells of a column share one
    permutation of its thin columns is Kensler's (2013).
    """
    rows = n // columns
    cell = permuted(sample, n, key)
    column, row = cell % columns, cell // columns
    if is_regular:
        return (f32(column) + _HALF) / f32(columns), (f32(row) + _HALF) / f32(rows)
    x, y = _jitter(sample, key, _JITTER_X), _jitter(sample, key, _JITTER_Y)
    if is_multi:
        x = (f32(permuted(row, rows, combine(key, _ROWS))) + x) / f32(rows)
        y = (f32(permuted(column, columns, combine(key, _COLUMNS))) + y) / f32(columns)
    return min((f32(column) + x) / f32(columns), _LAST), min((f32(row) + y) / f32(rows), _LAST)


@kernel
def radical_inverse_3(index: int) -> np.float32:
    """The digits of an index in base 3, mirrored at the point: 5 = 12 -> 0.21 = 7/9."""
    value, scale, rest = f32(0.0), _ONE, index
    while rest > 0:
        scale = scale * _THIRD
        value = value + scale * f32(rest % 3)
        rest = rest // 3
    return value


@kernel
def _radical_inverse_2(index: int) -> np.float32:
    value, scale, rest = f32(0.0), _ONE, index
    while rest > 0:
        scale = scale * _HALF
        value = value + scale * f32(rest & 1)
        rest = rest >> 1
    return value


@kernel
def _moved(x: np.float32, shift: np.float32) -> np.float32:
    """x + shift, where what leaves [0, 1) comes in again on the other side."""
    y = x + shift
    return min(y - _ONE if y >= _ONE else y, _LAST)


@kernel
def halton(index: int, key: np.uint32) -> tuple[np.float32, np.float32]:
    """A point of Halton's sequence in bases 2 and 3, all moved by the same random vector (Halton 1960; Cranley and Patterson 1976)."""
    x = _moved(_radical_inverse_2(index), float_from_word(combine(key, _JITTER_X)))
    return x, _moved(radical_inverse_3(index), float_from_word(combine(key, _JITTER_Y)))
