"""Gradient noise: a random function of space that is smooth, the same everywhere, and has one size of features (FoCG 11.5.2).

At each point of the integer lattice stands a random gradient, and the function is zero. Between eight points it is the mean of their
planes, weighted by a curve with two derivatives that vanish at both ends, so that slopes and bends fit together.

**Source**: Perlin, *An image synthesizer*, 1985; *Improving noise*, 2002, whose curve and gradients (the middles of a cube's edges) these
are. His table of 256 random numbers, after which the noise repeats, is a hash here, so that it does not, and has a seed.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import floor
from ..kernel.lanes import any_of, int32, max, min, spread, to_int, where
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = ["MEAN_MAGNITUDE", "gradient_noise", "summed_octaves"]

f32, i64 = np.float32, np.int64
_SIX, _TEN, _FIFTEEN = f32(6.0), f32(10.0), f32(15.0)
_TWO, _THREE = f32(2.0), f32(3.0)
MEAN_MAGNITUDE = f32(0.2202)
"""The mean of |n| over space: what is left of a crease that is finer than a pixel."""

# Odd numbers below 2^31, so that products of an int32 fit an int64
_X, _Y, _Z, _SEED = i64(0x1B873593), i64(0x19D699A5), i64(0x27D4EB2F), i64(0x2C1B3C6D)
_MIX, _MIX_AGAIN = i64(0x21F0AAAD), i64(0x735A2D97)


@kernel
def _plane(h: np.int32, x: np.float32, y: np.float32, z: np.float32) -> np.float32:
    """The dot product of (x, y, z) with one of the twelve gradients (1, 1, 0), (-1, 1, 0) and so on; four occur twice."""
    # The bits of h are mixed as by `kernel.rng.mix`, in numbers that lanes have; the upper four choose.
    h = int32(int32(h ^ ((h >> 16) & 0xFFFF)) * _MIX)
    h = int32(int32(h ^ ((h >> 15) & 0x1FFFF)) * _MIX_AGAIN)
    g = (h >> 28) & 15
    along_x = g < 8
    first = where(along_x, x, y)
    second = where(g < 4, y, where((g == 12) | (g == 14), x, z))
    return where((g & 1) == 0, first, -first) + where((g & 2) == 0, second, -second)


@kernel
def _fade(t: np.float32) -> np.float32:
    """6 t^5 - 15 t^4 + 10 t^3"""
    return t * t * t * (t * (t * _SIX - _FIFTEEN) + _TEN)


@outlined
def gradient_noise(p: Vec3, seed: int) -> np.float32:
    """Perlin's noise at p, within [-1.04, 1.04]; 0 at every point of the lattice. `seed` is an int32.

    ``E n^2 = 16 A^2 B`` over space, with ``A = integral (1 - s(t))^2``, ``B = integral t^2 (1 - s(t))^2`` over [0, 1] and s the curve.
    """
    fx, fy, fz = floor(p.x), floor(p.y), floor(p.z)
    x, y, z = p.x - fx, p.y - fy, p.z - fz
    x1, y1, z1 = x - ONE, y - ONE, z - ONE
    hx0, hy0 = int32(to_int(fx) * _X), int32(to_int(fy) * _Y)
    hz0 = int32(int32(to_int(fz) * _Z) ^ int32(i64(seed) * _SEED))
    hx1, hy1 = int32(hx0 + _X), int32(hy0 + _Y)
    hz1 = int32(int32(int32(to_int(fz) * _Z) + _Z) ^ int32(i64(seed) * _SEED))
    u, v, w = _fade(x), _fade(y), _fade(z)
    n00, n10 = _plane(hx0 ^ hy0 ^ hz0, x, y, z), _plane(hx1 ^ hy0 ^ hz0, x1, y, z)
    n01, n11 = _plane(hx0 ^ hy1 ^ hz0, x, y1, z), _plane(hx1 ^ hy1 ^ hz0, x1, y1, z)
    m00, m10 = _plane(hx0 ^ hy0 ^ hz1, x, y, z1), _plane(hx1 ^ hy0 ^ hz1, x1, y, z1)
    m01, m11 = _plane(hx0 ^ hy1 ^ hz1, x, y1, z1), _plane(hx1 ^ hy1 ^ hz1, x1, y1, z1)
    near0, near1 = n00 + (n10 - n00) * u, n01 + (n11 - n01) * u
    far0, far1 = m00 + (m10 - m00) * u, m01 + (m11 - m01) * u
    near, far = near0 + (near1 - near0) * v, far0 + (far1 - far0) * v
    return near + (far - near) * w


@kernel
def summed_octaves(
    p: Vec3, width: np.float32, octaves: int, gain: np.float32, lacunarity: np.float32, seed: int, creased: bool
) -> np.float32:
    """``sum g^k n(l^k p)``, or, creased, ``sum g^k |n(l^k p)|``: fractional Brownian motion, and turbulence (FoCG 11.5.3).

    Octaves that a pixel `width` wide cannot show count with their mean.
    """
    total, frequency, height = spread(ZERO, p.x), ONE, ONE
    for k in range(octaves):
        # All of an octave is seen by pixels up to half a cell wide, nothing by those of a cell and more, and smoothly less between.
        t = min(max(_TWO - _TWO * (width * frequency), ZERO), ONE)
        weight = t * t * (_THREE - _TWO * t)
        mean = MEAN_MAGNITUDE if creased else ZERO
        value = spread(mean, p.x)
        if any_of(weight > ZERO):
            n = gradient_noise(p * frequency, seed + k)
            value = value + ((abs(n) if creased else n) - value) * weight
        total = total + value * height
        frequency, height = frequency * lacunarity, height * gain
    return total
