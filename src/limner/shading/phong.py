"""The highlight of Blinn and Phong (FoCG 4.5.2, 10.2): ``ks (n.h)^p I`` with the book's intensity I = E/pi."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import INV_PI, power
from ..kernel.vec import ZERO, Color, Vec3, dot, normalize

__all__ = ["eval_blinn_phong"]


@kernel
def eval_blinn_phong(ks: Color, p: np.float32, n: Vec3, l: Vec3, v: Vec3) -> Color:  # noqa: E741 - the book's letter
    """ks/pi max(0, n.h)^p with h = (v + l)/|v + l|.

    Black where the light stands behind the surface: the book leaves that to the shadow ray, which a rasteriser has not.
    """
    h = normalize(v + l)
    highlight = power(max(ZERO, dot(n, h)), p)
    return ks * (INV_PI * highlight if dot(n, l) > ZERO else ZERO)
