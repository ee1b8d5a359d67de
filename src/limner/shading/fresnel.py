"""How much light a surface reflects at an angle (FoCG 13.1)."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import max, min
from ..kernel.vec import ONE, ZERO, Color

__all__ = ["schlick", "schlick_weight"]


@kernel
def schlick_weight(cos_theta: np.float32) -> np.float32:
    """(1 - cos theta)^5: the way from the reflectance at normal incidence to 1."""
    m = min(max(ONE - cos_theta, ZERO), ONE)
    m2 = m * m
    return m2 * m2 * m


@kernel
def schlick(f0: Color, cos_theta: np.float32) -> Color:
    """R = R0 + (1 - R0)(1 - cos theta)^5 (FoCG 13.1; Schlick 1994)."""
    w = schlick_weight(cos_theta)
    return f0 * (ONE - w) + Color(w, w, w)
