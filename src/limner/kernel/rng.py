"""Random numbers without a state: a pure function of where they are used.

A generator that remembers makes a picture depend on who asked first: on threads, tiles, and the order of lights. Here a random
number is a hash of (seed, pixel, sample, dimension), so each can be computed alone, again, in any order, on any machine.

    lens = random_float(seed, i, j, sample, np.int64(2))

All arithmetic is modulo 2^32. Numba widens every uint32 operation to 64 bits, hence the `u32` around each.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

__all__ = ["combine", "float_from_word", "mix", "pixel_word", "random_float", "word"]

f32, u32, i64 = np.float32, np.uint32, np.int64
_M1, _M2 = u32(0x21F0AAAD), u32(0x735A2D97)
_S15, _S16, _S8 = u32(15), u32(16), u32(8)
# 2^32 over the golden ratio, so that zeros do not hash to zero.
_GOLDEN = u32(0x9E3779B9)
_LOW_WORD = i64(0xFFFFFFFF)
_ULP = f32(2.0**-24)


@kernel
def word(x: np.int64) -> np.uint32:
    """x modulo 2^32, also for negative x."""
    return u32(i64(x) & _LOW_WORD)


@kernel
def mix(x: np.uint32) -> np.uint32:
    """A bijection of 32 bits in which every input bit flips every output bit about half of the time.

    **Source**: the multiply-xorshift family of C. Wellons, "Prospecting for Hash Functions", 2018, with the constants
    16 21f0aaad 15 735a2d97 15 found later by the same search (measured bias 0.107).
    """
    a = u32(x ^ u32(x >> _S16))
    b = u32(a * _M1)
    c = u32(b ^ u32(b >> _S15))
    d = u32(c * _M2)
    return u32(d ^ u32(d >> _S15))


@kernel
def combine(state: np.uint32, x: np.int64) -> np.uint32:
    """Mix the integer x into a hash; a bijection in either argument modulo 2^32."""
    return mix(u32(u32(state ^ word(x)) + _GOLDEN))


@kernel
def pixel_word(seed: np.int64, i: np.int64, j: np.int64) -> np.uint32:
    """The hash of a picture's seed and a pixel: what all samples of the pixel share."""
    return combine(combine(combine(_GOLDEN, seed), i), j)


@kernel
def float_from_word(x: np.uint32) -> np.float32:
    """The upper 24 bits of x as a number in [0, 1): all multiples of 2^-24 are equally likely, and 1 is never reached."""
    return f32(u32(x >> _S8)) * _ULP


@kernel
def random_float(seed: np.int64, i: np.int64, j: np.int64, sample: np.int64, dimension: np.int64) -> np.float32:
    """The random number in [0, 1) of one dimension of one sample of pixel (i, j)."""
    return float_from_word(combine(combine(pixel_word(seed, i, j), sample), dimension))
