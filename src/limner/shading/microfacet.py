"""The rough mirror lobe of glTF 2.0: GGX microfacets, height-correlated Smith shadowing, Schlick's Fresnel.

**Source**: Walter et al., *Microfacet models for refraction through rough surfaces*, 2007, eq. 33; Heitz, *Understanding the
masking-shadowing function*, 2014, eq. 99; glTF 2.0 specification, appendix B.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import INV_PI, sqrt
from ..kernel.lanes import max, min, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, normalize
from .fresnel import schlick

__all__ = ["ggx_distribution", "eval_ggx", "smith_visibility"]  # noqa: RUF022 - the order of the formula

f32 = np.float32
_HALF = f32(0.5)
_LEAST_ALPHA, _GRAZING = f32(1e-3), f32(1e-4)


@kernel
def ggx_distribution(alpha2: np.float32, n_h: np.float32) -> np.float32:
    """D = a^2 / (pi ((n.h)^2 (a^2 - 1) + 1)^2)."""
    d = n_h * n_h * (alpha2 - ONE) + ONE
    return alpha2 * INV_PI / (d * d)


@kernel
def smith_visibility(alpha2: np.float32, n_l: np.float32, n_v: np.float32) -> np.float32:
    """V = G / (4 n.l n.v) = 0.5 / (n.l sqrt((n.v)^2 (1 - a^2) + a^2) + n.v sqrt((n.l)^2 (1 - a^2) + a^2))."""
    towards_eye = n_l * sqrt(n_v * n_v * (ONE - alpha2) + alpha2)
    towards_light = n_v * sqrt(n_l * n_l * (ONE - alpha2) + alpha2)
    return _HALF / (towards_eye + towards_light)


@kernel
def eval_ggx(f0: Color, alpha: np.float32, n: Vec3, l: Vec3, v: Vec3) -> Color:  # noqa: E741 - the book's letter
    """F V D max(0, n.l): what irradiance facing l is multiplied by."""
    facing, n_v = dot(n, l), max(dot(n, v), _GRAZING)
    n_l = where(facing > ZERO, facing, ONE)
    h = normalize(v + l)
    a = max(alpha, _LEAST_ALPHA)
    alpha2 = a * a
    d = ggx_distribution(alpha2, min(max(dot(n, h), ZERO), ONE))
    reflected = smith_visibility(alpha2, n_l, n_v) * d * n_l
    return schlick(f0, dot(v, h)) * where(facing > ZERO, reflected, ZERO)
