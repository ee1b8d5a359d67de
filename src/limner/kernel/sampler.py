"""Samplers: where in the unit square to look next (FoCG 13.4).

Random points clump and leave holes, and the noise of a picture falls only as 1/sqrt(n). The points of a (0, 2)-sequence do not:
of the first 2^m, every rectangle of area 2^-m in the unit square (every *elementary interval*: 1 x 2^-m, 1/2 x 2^(1-m), ...)
holds exactly one. Owen's scrambling keeps that, makes the points random, and the noise of smooth integrands falls as n^-1.5.

    sampler = Sampler(SOBOL, pixel_word(seed, i, j), sample, n, columns)
    x, y = draw_2d(sampler, dimension)

| kind | what of n samples is certain |
|---|---|
| MIDPOINT | all stand in the middle |
| RANDOM | nothing |
| REGULAR | they are the centres of the cells of a grid |
| JITTERED | every cell has one, anywhere in it (Cook 1986) |
| MULTI_JITTERED | and so has each of n columns, and of n rows (`limner.kernel.strata`) |
| HALTON | base 2 along x, base 3 along y, moved at random |
| SOBOL | every elementary interval has one, for n a power of two; Owen-scrambled |

`dimension` numbers the decisions of a path, not the coordinates: 0 the place in the pixel, 1 the place on the lens, and so on.
Each has its own scrambled and shuffled copy of the pattern (padding), so that decisions are independent of one another. Each
is stratified within itself: over any first 2^m samples of a pixel (SOBOL), over all n (the others).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from .rng import combine, float_from_word, pixel_word, word
from .sampler_kinds import HALTON, JITTERED, MIDPOINT, MULTI_JITTERED, RANDOM, REGULAR, SOBOL
from .strata import halton, permuted, stratified_1d, stratified_2d

__all__ = [
    "HALTON", "JITTERED", "MIDPOINT", "MULTI_JITTERED", "RANDOM", "REGULAR", "SOBOL", "Sampler", "draw_1d", "draw_2d", "reverse_bits",
    "sample_1d", "sample_2d", "scramble_reversed", "sobol_2d",
]  # fmt: skip

f32, u32, i64 = np.float32, np.uint32, np.int64

_HALF = f32(0.5)
_ONE_BIT, _TWO_BITS, _FOUR_BITS = u32(1), u32(2), u32(4)
_EIGHT_BITS, _SIXTEEN_BITS = u32(8), u32(16)
_ODD_1, _ODD_2, _ODD_4 = u32(0x55555555), u32(0x33333333), u32(0x0F0F0F0F)
_ODD_8, _LOW_16 = u32(0x00FF00FF), u32(0x0000FFFF)
_LK1, _LK2, _LK3 = u32(0x3D20ADEA), u32(0x05526C56), u32(0x53A22864)
_SHUFFLE, _SCATTER = i64(2), i64(3)
_FIRST, _SECOND = u32(0x9E3779B1), u32(0x85EBCA77)


class Sampler(NamedTuple):
    """Who asks: one sample of a pixel."""

    kind: int
    pixel: np.uint32  # the hash of seed and pixel
    sample: int
    n: int  # how many samples the pixel gets in all
    columns: int  # of the grid into which n samples divide it


@kernel
def reverse_bits(x: np.uint32) -> np.uint32:
    """The 32 bits of x in reverse order: swap neighbours, pairs, nibbles, bytes, halves."""
    a = u32(u32(u32(x >> _ONE_BIT) & _ODD_1) | u32(u32(x & _ODD_1) << _ONE_BIT))
    b = u32(u32(u32(a >> _TWO_BITS) & _ODD_2) | u32(u32(a & _ODD_2) << _TWO_BITS))
    c = u32(u32(u32(b >> _FOUR_BITS) & _ODD_4) | u32(u32(b & _ODD_4) << _FOUR_BITS))
    d = u32(u32(u32(c >> _EIGHT_BITS) & _ODD_8) | u32(u32(c & _ODD_8) << _EIGHT_BITS))
    return u32(u32(d >> _SIXTEEN_BITS) | u32(d << _SIXTEEN_BITS))


@kernel
def _pascal(x: np.uint32) -> np.uint32:
    """Multiply the bits of x by Pascal's triangle modulo 2.

    C(c, r) is odd exactly where the binary digits of r are among those of c (Lucas), so bit r of the product is the xor of all
    bits of x at supersets of r: five steps, one for each binary digit of a position.
    """
    a = u32(x ^ u32(u32(x >> _SIXTEEN_BITS) & _LOW_16))
    b = u32(a ^ u32(u32(a >> _EIGHT_BITS) & _ODD_8))
    c = u32(b ^ u32(u32(b >> _FOUR_BITS) & _ODD_4))
    d = u32(c ^ u32(u32(c >> _TWO_BITS) & _ODD_2))
    return u32(d ^ u32(u32(d >> _ONE_BIT) & _ODD_1))


@kernel
def sobol_2d(index: np.uint32) -> tuple[np.uint32, np.uint32]:
    """The first two dimensions of Sobol's sequence, as 32-bit fractions.

    Dimension one is the radical inverse; the direction numbers of dimension two (polynomial x + 1) are Pascal's triangle.

    **Source**: S. Joe and F. Kuo, "Constructing Sobol' sequences with better two-dimensional projections", 2008, dimensions 1
    and 2 of new-joe-kuo-6.21201; the matrix of dimension two is applied bit-parallel instead of column by column.
    """
    return reverse_bits(index), reverse_bits(_pascal(index))


@kernel
def scramble_reversed(x: np.uint32, key: np.uint32) -> np.uint32:
    """Owen's nested uniform scrambling of a fraction whose bits are reversed: a bit is flipped by a hash of those below it.

    **Source**: S. Laine and T. Karras, "Stratified sampling for stochastic transparency", 2011; constants of N. Vegdahl,
    "Building a better LK hash", 2021.
    """
    a = u32(x ^ u32(x * _LK1))
    b = u32(a + key)
    c = u32(b * u32(u32(key >> _SIXTEEN_BITS) | _ONE_BIT))
    d = u32(c ^ u32(c * _LK2))
    return u32(d ^ u32(d * _LK3))


@kernel
def _another(key: np.uint32, odd: np.uint32) -> np.uint32:
    """Another key of the same decision. A product's lowest bit is the key's own, and flips half of the square: higher bits have to help."""
    a = u32(key * odd)
    return u32(a ^ u32(a >> _SIXTEEN_BITS))


@kernel
def _shuffled_index(sample: np.int64, key: np.uint32) -> np.uint32:
    """The sample's place in the shuffled sequence: aligned blocks of 2^m samples stay together, in a random order.

    **Source**: B. Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020, section 5.
    """
    return reverse_bits(scramble_reversed(reverse_bits(word(sample)), combine(key, _SHUFFLE)))


@outlined
def _draw_1d_otherwise(sampler: Sampler, dimension: int, key: np.uint32) -> np.float32:
    if sampler.kind == RANDOM:
        return float_from_word(combine(combine(sampler.pixel, sampler.sample), dimension))
    if sampler.kind == HALTON:
        return halton(permuted(sampler.sample, sampler.n, key), key)[0]
    if sampler.kind == MIDPOINT or sampler.kind > HALTON:
        return _HALF
    return stratified_1d(sampler.sample, sampler.n, sampler.kind == REGULAR, key)


@kernel
def draw_1d(sampler: Sampler, dimension: int) -> np.float32:
    """The number in [0, 1) of decision `dimension`; 1/2 for MIDPOINT and unknown kinds."""
    key = combine(sampler.pixel, dimension)
    if sampler.kind != SOBOL:
        return _draw_1d_otherwise(sampler, dimension, key)
    index = _shuffled_index(sampler.sample, key)
    return float_from_word(reverse_bits(scramble_reversed(index, _another(key, _FIRST))))


@outlined
def _draw_2d_otherwise(sampler: Sampler, dimension: int, key: np.uint32) -> tuple[np.float32, np.float32]:
    if sampler.kind == RANDOM:
        key = combine(combine(sampler.pixel, sampler.sample), dimension)
        return float_from_word(key), float_from_word(combine(key, _SCATTER))
    if sampler.kind == HALTON:
        # The first decision keeps the sequence's order: few samples of many are then spread well, too.
        return halton(sampler.sample if dimension == 0 else permuted(sampler.sample, sampler.n, key), key)
    if sampler.kind == MIDPOINT or sampler.kind > HALTON:
        return _HALF, _HALF
    is_multi = sampler.kind == MULTI_JITTERED
    return stratified_2d(sampler.sample, sampler.n, sampler.columns, sampler.kind == REGULAR, is_multi, key)


@kernel
def draw_2d(sampler: Sampler, dimension: int) -> tuple[np.float32, np.float32]:
    """The point in [0, 1)^2 of decision `dimension`; the middle for MIDPOINT and unknown kinds.

    **Source**: of SOBOL: B. Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020; padded by pairs instead of fours. Scrambling
    works on reversed fractions, so the two reversals of a coordinate cancel and one is left.
    """
    key = combine(sampler.pixel, dimension)
    if sampler.kind != SOBOL:
        return _draw_2d_otherwise(sampler, dimension, key)
    index = _shuffled_index(sampler.sample, key)
    x = float_from_word(reverse_bits(scramble_reversed(index, _another(key, _FIRST))))
    y = float_from_word(reverse_bits(scramble_reversed(_pascal(index), _another(key, _SECOND))))
    return x, y


@kernel
def sample_1d(kind: int, seed: np.int64, i: np.int64, j: np.int64, sample: np.int64, dimension: np.int64) -> np.float32:
    """`draw_1d` of pixel (i, j), for the kinds that need not know how many samples there will be."""
    return draw_1d(Sampler(kind, pixel_word(seed, i, j), sample, 1, 1), dimension)


@kernel
def sample_2d(
    kind: int, seed: np.int64, i: np.int64, j: np.int64, sample: np.int64, dimension: np.int64
) -> tuple[np.float32, np.float32]:
    """`draw_2d` of pixel (i, j), for the kinds that need not know how many samples there will be."""
    return draw_2d(Sampler(kind, pixel_word(seed, i, j), sample, 1, 1), dimension)
