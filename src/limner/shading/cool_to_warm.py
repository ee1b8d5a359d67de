"""Cool-to-warm shading (FoCG 10.3.2): the form of a surface told by colour in place of brightness."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, Color, Vec3, dot

__all__ = ["cool_to_warm"]

_HALF = np.float32(0.5)


@kernel
def cool_to_warm(cool: Color, warm: Color, n: Vec3, l: Vec3) -> Color:  # noqa: E741 - the book's letter
    """k_w c_w + (1 - k_w) c_c with k_w = (1 + n.l) / 2 (Gooch, Gooch, Shirley and Cohen 1998, eq. 1)."""
    k_w = (ONE + dot(n, l)) * _HALF
    return warm * k_w + cool * (ONE - k_w)
