"""The average of a sky over the lobe of a rough mirror."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import PI, TWO_PI, cos, sin
from ..kernel.vec import ONE, ZERO, Vec3
from .layouts import BLURRED_HEIGHT, BLURRED_LEVELS, BLURRED_WIDTH

__all__ = ["blur_sky"]

f32 = np.float32
_HALF = f32(0.5)
_STEPS = f32(BLURRED_LEVELS)


@kernel
def _direction(i: int, j: int, width: int, height: int) -> Vec3:
    """The unit direction of a texel's centre, row 0 at the bottom, in the sky's own frame."""
    theta = PI * (ONE - (f32(j) + _HALF) / f32(height))
    phi = TWO_PI * ((f32(i) + _HALF) / f32(width) - _HALF)
    return Vec3(sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi))


@kernel
def blur_sky(sky, directions, blurred, level, first_row, last_row):
    """Fill rows first..last of a level: the mean of the sky, weighted by D(h) n.l with n = v = the texel's direction.

    sky (n, 4): radiance and solid angle of each direction of `directions` (n, 3). blurred (levels * height, width, 3).
    """
    roughness = f32(level + 1) / _STEPS
    alpha2 = roughness * roughness * roughness * roughness
    for j in range(first_row, last_row):
        for i in range(BLURRED_WIDTH):
            n = _direction(i, j, BLURRED_WIDTH, BLURRED_HEIGHT)
            r, g, b, total = ZERO, ZERO, ZERO, ZERO
            for k in range(sky.shape[0]):
                n_l = n.x * directions[k, 0] + n.y * directions[k, 1] + n.z * directions[k, 2]
                # (n.h)^2 = (1 + n.l) / 2
                d = (ONE + n_l) * _HALF * (alpha2 - ONE) + ONE
                weight = max(n_l, ZERO) * sky[k, 3] / (d * d)
                r += weight * sky[k, 0]
                g += weight * sky[k, 1]
                b += weight * sky[k, 2]
                total += weight
            row = level * BLURRED_HEIGHT + j
            blurred[row, i, 0], blurred[row, i, 1], blurred[row, i, 2] = r / total, g / total, b / total
