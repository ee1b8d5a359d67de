"""The rough matte lobe: many small Lambert facets that shadow each other.

Seen with the light in one's back, a rough matte ball is as bright at its edge as in its middle, as the full moon is.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import INV_PI
from ..kernel.lanes import max, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot

__all__ = ["eval_oren_nayar"]

f32 = np.float32
_HALF, _LEAST = f32(0.5), f32(1e-4)


@kernel
def eval_oren_nayar(kd: Color, sigma: np.float32, n: Vec3, l: Vec3, v: Vec3) -> Color:  # noqa: E741 - the book's letter
    """kd/pi n.l (A + B max(0, cos phi) sin alpha tan beta), with A = 1 - s^2 / 2 (s^2 + 0.33), B = 0.45 s^2 / (s^2 + 0.09).

    **Source**: Oren and Nayar, *Generalization of Lambert's reflectance model*, SIGGRAPH 1994, eq. 30.
    """
    squared = sigma * sigma
    a, b = ONE - _HALF * squared / (squared + f32(0.33)), f32(0.45) * squared / (squared + f32(0.09))
    n_l, n_v = max(dot(n, l), ZERO), max(dot(n, v), ZERO)
    # cos phi sin theta_l sin theta_v, over the cosine of the smaller angle
    aside = max(dot(l, v) - n_l * n_v, ZERO) / max(max(n_l, n_v), _LEAST)
    return kd * (INV_PI * n_l * (a + b * where(n_l > ZERO, aside, ZERO)))
