"""How much a metal reflects: Fresnel's equations with a complex index of refraction, eta - i k."""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import safe_sqrt, sqrt
from ..kernel.lanes import max, min
from ..kernel.vec import ONE, ZERO, Color

__all__ = ["conductor_reflectance", "metal_reflectance"]

f32 = np.float32
_HALF, _TWO = f32(0.5), f32(2.0)


@kernel
def metal_reflectance(eta: np.float32, k: np.float32, cosine: np.float32) -> np.float32:
    """The share of unpolarised light that is reflected, from air: (|r_s|^2 + |r_p|^2) / 2.

    With ``a^2 + b^2 = sqrt((eta^2 - k^2 - sin^2)^2 + 4 eta^2 k^2)`` and ``a^2 = (a^2 + b^2 + eta^2 - k^2 - sin^2) / 2``:
    ``R_s = (a^2 + b^2 - 2 a cos + cos^2) / (a^2 + b^2 + 2 a cos + cos^2)``,
    ``R_p = R_s (cos^2 (a^2 + b^2) - 2 a cos sin^2 + sin^4) / (cos^2 (a^2 + b^2) + 2 a cos sin^2 + sin^4)``.

    **Source**: Born and Wolf, *Principles of Optics*, 14.2; in this form Lazanyi and Szirmay-Kalos, *Fresnel term approximations for
    metals*, 2005.
    """
    c = min(max(cosine, ZERO), ONE)
    c2 = c * c
    s2 = ONE - c2
    t0 = eta * eta - k * k - s2
    sum2 = sqrt(t0 * t0 + f32(4.0) * eta * eta * k * k)
    a = safe_sqrt(_HALF * (sum2 + t0))
    across = _TWO * a * c
    r_s = (sum2 + c2 - across) / (sum2 + c2 + across)
    left, right = c2 * sum2 + s2 * s2, across * s2
    return _HALF * r_s * (ONE + (left - right) / (left + right))


@outlined
def conductor_reflectance(eta: Color, k: Color, cosine: np.float32) -> Color:
    """The same in three channels."""
    return Color(metal_reflectance(eta.r, k.r, cosine), metal_reflectance(eta.g, k.g, cosine), metal_reflectance(eta.b, k.b, cosine))
