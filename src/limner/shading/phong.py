"""Highlights (FoCG 4.5.2, 10.2): Blinn's ``ks (n.h)^p I`` and Phong's ``c_p (r.e)^p I``, with the book's intensity I = E/pi."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import INV_PI, power
from ..kernel.lanes import max, where
from ..kernel.vec import ZERO, Color, Vec3, dot, normalize, reflect

__all__ = ["eval_blinn_phong", "eval_phong"]


@kernel
def eval_blinn_phong(ks: Color, p: np.float32, n: Vec3, l: Vec3, v: Vec3) -> Color:  # noqa: E741 - the book's letter
    """ks/pi max(0, n.h)^p with h = (v + l)/|v + l|.

    Black where the light stands behind the surface: the book leaves that to the shadow ray, which a rasteriser has not.
    """
    h = normalize(v + l)
    highlight = power(max(ZERO, dot(n, h)), p)
    return ks * (where(dot(n, l) > ZERO, INV_PI * highlight, ZERO))


@kernel
def eval_phong(cp: Color, p: np.float32, n: Vec3, l: Vec3, e: Vec3) -> Color:  # noqa: E741 - the book's letter
    """c_p/pi max(0, r.e)^p with r the reflection of the light over the normal (FoCG 10.2.1); black where the light stands behind."""
    r = reflect(-l, n)
    highlight = power(max(ZERO, dot(r, e)), p)
    return cp * (where(dot(n, l) > ZERO, INV_PI * highlight, ZERO))
