"""How much light a surface reflects at an angle (FoCG 13.1)."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Color

__all__ = ["schlick"]


@kernel
def schlick(f0: Color, cos_theta: np.float32) -> Color:
    """R = R0 + (1 - R0)(1 - cos theta)^5 (FoCG 13.1; Schlick 1994)."""
    m = min(max(ONE - cos_theta, ZERO), ONE)
    m2 = m * m
    w = m2 * m2 * m
    return f0 * (ONE - w) + Color(w, w, w)
