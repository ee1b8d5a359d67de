"""Sine, cosine and logarithm in float64, the same bits compiled or not: differences of fields need more digits than float32 has."""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel

__all__ = ["logarithm", "sine_and_cosine"]

f64 = np.float64
_NONE, _HALF, _ONE, _TWO, _FOUR = f64(0.0), f64(0.5), f64(1.0), f64(2.0), f64(4.0)

_TWO_OVER_PI = f64(2.0 / math.pi)
# pi/2 in two parts; the first has 33 bits, so that its products with whole numbers up to a million are exact.
_QUARTER_HIGH = f64(math.floor(math.pi / 2.0 * 2.0**32) / 2.0**32)
_QUARTER_LOW = f64((math.pi / 2.0 - float(_QUARTER_HIGH)) + 6.123233995736766e-17)
_S3, _S5, _S7, _S9, _S11, _S13, _S15 = (f64((-1.0) ** k / math.factorial(2 * k + 1)) for k in range(1, 8))
_C2, _C4, _C6, _C8, _C10, _C12, _C14, _C16 = (f64((-1.0) ** k / math.factorial(2 * k)) for k in range(1, 9))

_LN2, _ROOT_HALF, _ROOT_TWO = f64(math.log(2.0)), f64(math.sqrt(0.5)), f64(math.sqrt(2.0))
_MANY, _FEW = f64(65536.0), f64(2.0**-16)
_BITS = f64(16.0)
_L3, _L5, _L7, _L9, _L11, _L13, _L15, _L17, _L19 = (f64(1.0 / k) for k in range(3, 20, 2))


@kernel
def sine_and_cosine(x: np.float64) -> tuple[np.float64, np.float64]:
    """sin x and cos x: the quadrant, and Taylor's series for the rest; to 1e-15 for |x| up to a million."""
    n = np.floor(x * _TWO_OVER_PI + _HALF)
    r = (x - n * _QUARTER_HIGH) - n * _QUARTER_LOW
    q = r * r
    s = r + r * q * (_S3 + q * (_S5 + q * (_S7 + q * (_S9 + q * (_S11 + q * (_S13 + q * _S15))))))
    c = _ONE + q * (_C2 + q * (_C4 + q * (_C6 + q * (_C8 + q * (_C10 + q * (_C12 + q * (_C14 + q * _C16)))))))
    quadrant = n - _FOUR * np.floor(n / _FOUR)
    if quadrant == _NONE:
        return s, c
    if quadrant == _ONE:
        return c, -s
    if quadrant == _TWO:
        return -s, -c
    return -c, s


@kernel
def logarithm(x: np.float64) -> np.float64:
    """ln x of a positive number: powers of two taken off, then ``2 artanh((m - 1) / (m + 1))`` as a series; to 1e-15."""
    exponent = _NONE
    while x > _MANY:
        x = x * _FEW
        exponent = exponent + _BITS
    while x < _FEW:
        x = x * _MANY
        exponent = exponent - _BITS
    while x > _ROOT_TWO:
        x = x * _HALF
        exponent = exponent + _ONE
    while x < _ROOT_HALF:
        x = x * _TWO
        exponent = exponent - _ONE
    s = (x - _ONE) / (x + _ONE)
    q = s * s
    series = q * (_L3 + q * (_L5 + q * (_L7 + q * (_L9 + q * (_L11 + q * (_L13 + q * (_L15 + q * (_L17 + q * _L19))))))))
    return exponent * _LN2 + _TWO * s * (_ONE + series)
