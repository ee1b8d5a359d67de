"""The rough matte lobe: many small Lambert facets that shadow each other.

Seen with the light in one's back, a rough matte ball is as bright at its edge as in its middle, as the full moon is.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import INV_PI, acos, safe_sqrt
from ..kernel.lanes import max, min, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot

__all__ = ["eval_oren_nayar", "rough_matte_sent_on"]

f32 = np.float32
_HALF, _LEAST, _THIRD, _GRAZING = f32(0.5), f32(1e-4), f32(1.0 / 3.0), f32(1e-3)


@kernel
def _fall_off(sigma: np.float32):
    """(A, B) of the formula below."""
    squared = sigma * sigma
    return ONE - _HALF * squared / (squared + f32(0.33)), f32(0.45) * squared / (squared + f32(0.09))


@kernel
def eval_oren_nayar(kd: Color, sigma: np.float32, n: Vec3, l: Vec3, v: Vec3) -> Color:  # noqa: E741 - the book's letter
    """kd/pi n.l (A + B max(0, cos phi) sin alpha tan beta), with A = 1 - s^2 / 2 (s^2 + 0.33), B = 0.45 s^2 / (s^2 + 0.09).

    **Source**: Oren and Nayar, *Generalization of Lambert's reflectance model*, SIGGRAPH 1994, eq. 30.
    """
    a, b = _fall_off(sigma)
    n_l, n_v = max(dot(n, l), ZERO), max(dot(n, v), ZERO)
    # cos phi sin theta_l sin theta_v, over the cosine of the smaller angle
    aside = max(dot(l, v) - n_l * n_v, ZERO) / max(max(n_l, n_v), _LEAST)
    return kd * (INV_PI * n_l * (a + b * where(n_l > ZERO, aside, ZERO)))


@outlined
def rough_matte_sent_on(sigma: np.float32, n_v: np.float32) -> np.float32:
    """The share of an even sky that a white rough surface sends towards the eye.

    The integral of the above over all lights, s and c the sine and cosine of the eye's angle t:
    ``A + (B / pi) (s (t - s c) + 2/3 (s / c) (1 - s^3))``.
    """
    a, b = _fall_off(sigma)
    c = min(max(n_v, _GRAZING), ONE)
    s = safe_sqrt(ONE - c * c)
    return a + b * INV_PI * (s * (acos(c) - s * c) + (_THIRD + _THIRD) * (s / c) * (ONE - s * s * s))
