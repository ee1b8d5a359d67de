"""Elementary functions in float32, made of + - * / and square root alone.

The C library's functions differ between machines in the last bit, and LLVM cannot vectorise calls to them. These are
polynomials after an exact reduction of the argument, branch-free, accurate to a few units in the last place over their range
(`tests/laws/test_elementary.py` measures them against float64), and the same bits on every machine,
compiled or not. Multiplication and addition are never fused. They take a number or eight (`lanes`).
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import MODE, kernel
from .lanes import f32x8, i32x8, int32, max, min, to_float, where

__all__ = [
    "HALF_PI", "INV_PI", "PI", "TWO_PI", "acos", "as_float", "as_int", "atan2", "cos", "cos_sin_of_octant", "exp2", "floor", "log2",
    "power", "safe_sqrt", "sin", "sqrt",
]  # fmt: skip

f32, i32 = np.float32, np.int32
PI = f32(math.pi)
TWO_PI = f32(2.0 * math.pi)
HALF_PI = f32(0.5 * math.pi)
INV_PI = f32(1.0 / math.pi)

if MODE == "compiled":
    from ._bits import as_float, as_int, floor, sqrt
else:
    from .lanes import _Lanes

    def sqrt(x: np.float32) -> np.float32:
        """The correctly rounded square root; NaN below zero."""
        return f32x8(np.sqrt(x.values)) if isinstance(x, _Lanes) else np.sqrt(f32(x))

    def floor(x: np.float32) -> np.float32:
        """The greatest integer not above x, as float32."""
        return f32x8(np.floor(x.values)) if isinstance(x, _Lanes) else np.floor(f32(x))

    def as_int(x: np.float32) -> np.int32:
        """The bits of a float32 as int32."""
        return i32x8(x.values.view(i32)) if isinstance(x, _Lanes) else f32(x).view(i32)

    def as_float(i: np.int32) -> np.float32:
        """The float32 of the given bits."""
        return f32x8(i.values.view(f32)) if isinstance(i, _Lanes) else i32(i).view(f32)


_ZERO, _HALF, _ONE, _TWO = f32(0.0), f32(0.5), f32(1.0), f32(2.0)


@kernel
def safe_sqrt(x: np.float32) -> np.float32:
    """The square root of max(x, 0): for what rounding pushed below zero."""
    return sqrt(max(_ZERO, x))


# 2^f = 1 + f (E1 + f (E2 + ...)) on [-1/2, 1/2]: the polynomial of least maximal relative error, 2e-9 before rounding.
_E1, _E2, _E3 = f32(0.6931472028549863), f32(0.2402264791385211), f32(0.05550332471371312)
_E4, _E5, _E6 = f32(0.009618437329378893), f32(0.001339887434358723), f32(0.0001535336975361082)
_BIAS, _MANTISSA_BITS, _I1, _I2 = i32(127), i32(23), i32(1), i32(2)


@kernel
def exp2(x: np.float32) -> np.float32:
    """2^x: the integer part goes into the exponent, the rest is a polynomial.

    0 below -126 and for NaN, infinity from 128 on. The exponent is applied in two halves, since 2^127.9 has the integer part
    128, which no single float32 exponent holds.
    """
    clamped = min(max(f32(-127.0), x), f32(128.0))
    n = floor(clamped + _HALF)
    f = clamped - n
    whole = int32(n)
    p = _ONE + f * (_E1 + f * (_E2 + f * (_E3 + f * (_E4 + f * (_E5 + f * _E6)))))
    low = int32(whole >> _I1)
    high = int32(whole - low)
    scaled = p * as_float(int32(int32(low + _BIAS) << _MANTISSA_BITS)) * as_float(int32(int32(high + _BIAS) << _MANTISSA_BITS))
    return where(x >= f32(-126.0), scaled, _ZERO)


# ln((1+s)/(1-s)) = 2 (s + s^3/3 + ...), scaled to base 2; |s| <= 0.1716 leaves 1e-9.
_L1, _L3, _L5 = f32(2.0 / math.log(2.0)), f32(2.0 / 3.0 / math.log(2.0)), f32(2.0 / 5.0 / math.log(2.0))
_L7, _L9 = f32(2.0 / 7.0 / math.log(2.0)), f32(2.0 / 9.0 / math.log(2.0))
_SQRT_HALF_BITS = i32(0x3F3504F3)
_LEAST_NORMAL = f32(2.0**-126)


@kernel
def log2(x: np.float32) -> np.float32:
    """log2 x: exponent plus the atanh series of the mantissa; -126 for what is below 2^-126, and for NaN; 128 for infinity."""
    bits = as_int(max(_LEAST_NORMAL, x))
    e = int32(int32(bits - _SQRT_HALF_BITS) >> _MANTISSA_BITS)
    m = as_float(int32(bits - int32(e << _MANTISSA_BITS)))
    s = (m - _ONE) / (m + _ONE)
    q = s * s
    return to_float(e) + s * (_L1 + q * (_L3 + q * (_L5 + q * (_L7 + q * _L9))))


@kernel
def power(x: np.float32, p: np.float32) -> np.float32:
    """x^p for x >= 0, as 2^(p log2 x); 0 for x <= 0 and NaN, but x^0 is 1."""
    y = exp2(p * log2(x))
    return where(p != _ZERO, where(x > _ZERO, y, _ZERO), _ONE)


# Cody-Waite: pi/2 in three pieces, the first two with trailing zeros, so that n * piece is exact for moderate n.
_TWO_OVER_PI = f32(2.0 / math.pi)
_PIO2_A, _PIO2_B, _PIO2_C = f32(1.5703125), f32(4.837512969970703125e-4), f32(7.549789948768648e-8)
_S3, _S5, _S7 = f32(-1.0 / 6.0), f32(1.0 / 120.0), f32(-1.0 / 5040.0)
_S9 = f32(1.0 / 362880.0)
_FARTHEST = f32(131072.0)
_C2, _C4, _C6, _C8 = f32(-0.5), f32(1.0 / 24.0), f32(-1.0 / 720.0), f32(1.0 / 40320.0)


@kernel
def _sin_quadrant(x: np.float32, shift: np.int32) -> np.float32:
    """sin(x + shift pi/2): reduce to [-pi/4, pi/4], then sine or cosine of the rest by its Taylor series."""
    x = where(abs(x) <= _FARTHEST, x, _ZERO)
    n = floor(x * _TWO_OVER_PI + _HALF)
    r = ((x - n * _PIO2_A) - n * _PIO2_B) - n * _PIO2_C
    quadrant = int32(int32(n) + shift)
    q = r * r
    s = r + r * q * (_S3 + q * (_S5 + q * (_S7 + q * _S9)))
    c = _ONE + q * (_C2 + q * (_C4 + q * (_C6 + q * _C8)))
    y = where((quadrant & _I1) == _I1, c, s)
    return where((quadrant & _I2) == _I2, -y, y)


@kernel
def sin(x: np.float32) -> np.float32:
    """sin x; absolute error below 2e-7 for |x| <= 10000; sin 0 for |x| > 131072 and for NaN."""
    return _sin_quadrant(x, i32(0))


@kernel
def cos(x: np.float32) -> np.float32:
    """cos x; absolute error below 2e-7 for |x| <= 10000; cos 0 for |x| > 131072 and for NaN."""
    return _sin_quadrant(x, i32(1))


@kernel
def cos_sin_of_octant(x: np.float32) -> tuple[np.float32, np.float32]:
    """(cos x, sin x) for |x| <= pi/4, by the series of `cos` and `sin` without their reduction."""
    q = x * x
    c = _ONE + q * (_C2 + q * (_C4 + q * (_C6 + q * _C8)))
    return c, x + x * q * (_S3 + q * (_S5 + q * (_S7 + q * _S9)))


# atan t = t + t q (A3 + q (A5 + ...)), q = t^2, on [-tan(pi/8), tan(pi/8)]: of least maximal relative error, 7e-10.
_TAN_PI_8 = f32(math.tan(math.pi / 8.0))
_A3, _A5, _A7 = f32(-0.33333315188661494), f32(0.1999847151816107), f32(-0.142435333894181)
_A9, _A11 = f32(0.1059381401537413), f32(-0.06078222028052892)
_QUARTER_PI = f32(0.25 * math.pi)


@kernel
def atan2(y: np.float32, x: np.float32) -> np.float32:
    """The angle of (x, y) in [-pi, pi] for finite x and y; 0 for the origin. Zeros count as positive."""
    ax, ay = abs(x), abs(y)
    large, small = max(ax, ay), min(ax, ay)
    apart = large > _ZERO
    t = where(apart, small / where(apart, large, _ONE), _ZERO)
    beyond = t > _TAN_PI_8
    r = where(beyond, (t - _ONE) / (t + _ONE), t)
    q = r * r
    a = r + r * q * (_A3 + q * (_A5 + q * (_A7 + q * (_A9 + q * _A11))))
    a = where(beyond, a + _QUARTER_PI, a)
    a = where(ay > ax, HALF_PI - a, a)
    a = where(x < _ZERO, PI - a, a)
    return where(y < _ZERO, -a, a)


@kernel
def acos(x: np.float32) -> np.float32:
    """The angle whose cosine is x, clamped to [-1, 1]: atan2(sqrt((1 - x)(1 + x)), x)."""
    c = min(max(x, -_ONE), _ONE)
    return atan2(safe_sqrt((_ONE - c) * (_ONE + c)), c)
