"""The colours of a film a few hundred nanometres thick: soap, oil on water, tempered steel.

Light that is reflected below the film comes late by ``2 n d cos theta``, and waves that come late by whole wavelengths add up, others
cancel. The sum over all the times light goes up and down in the film (Airy) is a Fourier series in the phase,

    R(phase) = C_0 + sum over m of 2 C_m cos(m phase),        C_m = (R_s - T_121) r_123^m,

so that its average over the wavelengths that an eye's channel sees needs nothing but the Fourier transform of that channel's
sensitivity. Two terms are enough.

**Source**: Belcour and Barla, *A practical extension to microfacet theory for the modeling of varying iridescence*, SIGGRAPH 2017, eqs. 3
to 10, with the sensitivities they fit, and Schlick's reflectance at both interfaces, as KHR_materials_iridescence has it.
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import PI, TWO_PI, cos, exp2, safe_sqrt, sqrt
from ..kernel.lanes import max, min, where
from ..kernel.vec import ONE, ZERO, Color
from .fresnel import schlick_weight

__all__ = ["film_reflectance"]

f32 = np.float32
_TWO = f32(2.0)
_NANOMETRE = f32(1e-9)
_THINNEST = f32(30.0)  # a thinner film fades into none

# Gaussians in wave number: weight, mean and variance for X, Y, Z, and the second one of X, over the sum of Y.
_SUM = 1.0685e-7
_VARIANCE = tuple(f32(v * math.log2(math.e)) for v in (4.3278e9, 9.3046e9, 6.6121e9, 4.5282e9))
_MEAN = tuple(f32(m) for m in (1.6810e6, 1.7953e6, 2.2084e6, 2.2399e6))
_WEIGHT = tuple(
    f32(w * math.sqrt(2.0 * math.pi * v) / _SUM)
    for w, v in ((5.4856e-13, 4.3278e9), (4.4201e-13, 9.3046e9), (5.2481e-13, 6.6121e9), (9.7470e-14, 4.5282e9))
)


@kernel
def _wave(k: int, phase: np.float32, shift: np.float32) -> np.float32:
    """One of the Gaussians, transformed: at a phase per wave number, with a shift."""
    return _WEIGHT[k] * cos(_MEAN[k] * phase + shift) * exp2(-_VARIANCE[k] * phase * phase)


@kernel
def _sensed(phase: np.float32, shift_r: np.float32, shift_g: np.float32, shift_b: np.float32) -> Color:
    """What an eye sees of cos(phase wave number + shift), in linear Rec. 709."""
    x = _wave(0, phase, shift_r) + _wave(3, phase, shift_r)
    y, z = _wave(1, phase, shift_g), _wave(2, phase, shift_b)
    return Color(
        f32(3.2404542) * x - f32(1.5371385) * y - f32(0.4985314) * z,
        f32(-0.9692660) * x + f32(1.8760108) * y + f32(0.0415560) * z,
        f32(0.0556434) * x - f32(0.2040259) * y + f32(1.0572252) * z,
    )


@kernel
def _below(f0: np.float32, film: np.float32, weight: np.float32):
    """(R_23, its phase) where the film meets a base that reflects f0 in air."""
    root = sqrt(min(max(f0, ZERO), f32(0.9999)) + f32(1e-4))
    base = (ONE + root) / max(ONE - root, f32(1e-4))
    ratio = (base - film) / (base + film)
    r = ratio * ratio
    return r + (ONE - r) * weight, where(base < film, PI, ZERO)


@kernel
def _term(r12: np.float32, t121: np.float32, r23: np.float32):
    """(C_0, C_1, r_123) of one channel."""
    r123 = min(max(r12 * r23, f32(1e-5)), f32(0.9999))
    back = t121 * t121 * r23 / (ONE - r123)
    root = sqrt(r123)
    return r12 + back, (back - t121) * root, root


@outlined
def film_reflectance(f0: Color, ior: np.float32, thickness: np.float32, cosine: np.float32) -> Color:
    """The reflectance of a film of index `ior`, `thickness` nanometres thick, in air, over a base that reflects f0 by itself."""
    t = min(max(thickness / _THINNEST, ZERO), ONE)
    eta = ONE + (ior - ONE) * (t * t * (f32(3.0) - _TWO * t))
    c = min(max(cosine, ZERO), ONE)
    cos_film = safe_sqrt(ONE - (ONE - c * c) / (eta * eta))
    ratio = (eta - ONE) / (eta + ONE)
    r0 = ratio * ratio
    r12 = r0 + (ONE - r0) * schlick_weight(c)
    t121 = ONE - r12
    inner = schlick_weight(cos_film)
    red, red_shift = _below(f0.r, eta, inner)
    green, green_shift = _below(f0.g, eta, inner)
    blue, blue_shift = _below(f0.b, eta, inner)
    phase = TWO_PI * _NANOMETRE * _TWO * eta * thickness * cos_film
    mean_r, c_r, root_r = _term(r12, t121, red)
    mean_g, c_g, root_g = _term(r12, t121, green)
    mean_b, c_b, root_b = _term(r12, t121, blue)
    # Reflected from below at the film's own upper side, a wave is turned over.
    first = _sensed(phase, PI + red_shift, PI + green_shift, PI + blue_shift)
    second = _sensed(_TWO * phase, _TWO * red_shift, _TWO * green_shift, _TWO * blue_shift)
    return Color(
        min(max(mean_r + _TWO * c_r * (first.r + root_r * second.r), ZERO), ONE),
        min(max(mean_g + _TWO * c_g * (first.g + root_g * second.g), ZERO), ONE),
        min(max(mean_b + _TWO * c_b * (first.b + root_b * second.b), ZERO), ONE),
    )
