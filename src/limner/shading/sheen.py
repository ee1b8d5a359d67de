"""The lobe of fibres that stand up from a surface: velvet, dust, peach skin.

Fibres have no facets that look up, so the half vectors of what they reflect lie low: ``D = (2 + 1/a) sin^(1/a) / 2 pi``. What lies below
gets what they leave, by how much an even sky they send on in all, which is tabulated (`sheen_table`).

**Source**: Estevez and Kulla, *Production friendly microfacet sheen BRDF*, SIGGRAPH 2017 course notes, 2 to 4; KHR_materials_sheen.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import INV_PI, exp2, power, safe_sqrt
from ..kernel.lanes import at, max, min, to_float, to_int, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, lerp, normalize
from .sheen_table import SENT_ON

__all__ = ["charlie_distribution", "eval_sheen", "sheen_sent_on", "sheen_visibility"]

f32 = np.float32
_HALF, _TWO, _FOUR = f32(0.5), f32(2.0), f32(4.0)
_LEAST_ALPHA, _GRAZING = f32(0.005), f32(1e-4)
_LOG2_E = f32(1.4426950408889634)
_LAST, _NODES = f32(15.0), 16


@kernel
def charlie_distribution(alpha: np.float32, n_h: np.float32) -> np.float32:
    """D = (2 + 1/a) sin^(1/a) / 2 pi (eq. 2)."""
    inverse = ONE / alpha
    return (_TWO + inverse) * power(safe_sqrt(ONE - n_h * n_h), inverse) * (_HALF * INV_PI)


@kernel
def _fitted(x: np.float32, t: np.float32) -> np.float32:
    """L(x) = a / (1 + b x^c) + d x + e, between the fits for a = 0 and a = 1 (table 1)."""
    a, b = lerp(f32(21.5473), f32(25.3245), t), lerp(f32(3.82987), f32(3.32435), t)
    c, d, e = lerp(f32(0.19823), f32(0.16801), t), lerp(f32(-1.97760), f32(-1.27393), t), lerp(f32(-4.32054), f32(-4.85967), t)
    return a / (ONE + b * power(x, c)) + d * x + e


@kernel
def _hidden(cosine: np.float32, t: np.float32) -> np.float32:
    """Lambda: exp L(cos) up to 60 degrees from the side, exp(2 L(1/2) - L(1 - cos)) above (eq. 3)."""
    low = cosine < _HALF
    inner = _fitted(where(low, cosine, ONE - cosine), t)
    return exp2(where(low, inner, _TWO * _fitted(_HALF, t) - inner) * _LOG2_E)


@kernel
def sheen_visibility(alpha: np.float32, n_l: np.float32, n_v: np.float32) -> np.float32:
    """V = 1 / ((1 + L(v) + L(l)) 4 n.l n.v)."""
    t = (ONE - alpha) * (ONE - alpha)
    return ONE / ((ONE + _hidden(n_v, t) + _hidden(n_l, t)) * _FOUR * n_l * n_v)


@outlined
def eval_sheen(color: Color, alpha: np.float32, n: Vec3, l: Vec3, v: Vec3) -> Color:  # noqa: E741 - the book's letter
    """c D V max(0, n.l): what irradiance facing l is multiplied by."""
    facing, n_v = dot(n, l), min(max(dot(n, v), _GRAZING), ONE)
    n_l = where(facing > _GRAZING, min(facing, ONE), ONE)
    a = max(alpha, _LEAST_ALPHA)
    d = charlie_distribution(a, min(max(dot(n, normalize(v + l)), ZERO), ONE))
    return color * where(facing > _GRAZING, d * sheen_visibility(a, n_l, n_v) * n_l, ZERO)


@outlined
def sheen_sent_on(alpha: np.float32, n_v: np.float32) -> np.float32:
    """The share of an even sky that white fibres send towards the eye."""
    x, y = safe_sqrt(min(max(alpha, ZERO), ONE)) * _LAST, min(max(n_v, ZERO), ONE) * _LAST
    i, j = min(to_int(x), _NODES - 2), min(to_int(y), _NODES - 2)
    a, b = x - to_float(i), y - to_float(j)
    low = at(SENT_ON, (i, j)) * (ONE - b) + at(SENT_ON, (i, j + 1)) * b
    high = at(SENT_ON, (i + 1, j)) * (ONE - b) + at(SENT_ON, (i + 1, j + 1)) * b
    return low * (ONE - a) + high * a
