"""The microfacet lobe of a surface that is rougher in one direction than in the other: brushed metal.

The distribution of normals is stretched: width `along` in the direction of the tangent t, `across` at right angles to it. With both
alike it is the lobe of `microfacet`.

**Source**: Heitz, *Understanding the masking-shadowing function*, 2014, eqs. 85 and 99; KHR_materials_anisotropy. Drawn as
in Heitz, *Sampling the GGX distribution of visible normals*, JCGT 7(4), 2018.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import INV_PI, safe_sqrt, sqrt
from ..kernel.frame import Frame
from ..kernel.lanes import max
from ..kernel.vec import ONE, ZERO, Vec3, cross, normalize
from ..kernel.warp import warp_disk

__all__ = ["anisotropic_ggx", "frame_along", "pdf_anisotropic", "sample_anisotropic"]

f32 = np.float32
_HALF = f32(0.5)


@kernel
def _distribution(along: np.float32, across: np.float32, h: Vec3) -> np.float32:
    """D = 1 / (pi a_t a_b ((t.h / a_t)^2 + (b.h / a_b)^2 + (n.h)^2)^2), h in the surface's frame."""
    x, y = h.x / along, h.y / across
    d = x * x + y * y + h.z * h.z
    return INV_PI / (along * across * d * d)


@kernel
def _stretched(along: np.float32, across: np.float32, v: Vec3) -> np.float32:
    """|(a_t t.v, a_b b.v, n.v)|"""
    x, y = along * v.x, across * v.y
    return sqrt(x * x + y * y + v.z * v.z)


@kernel
def anisotropic_ggx(along: np.float32, across: np.float32, l: Vec3, v: Vec3, h: Vec3) -> np.float32:  # noqa: E741 - the book's letter
    """V D with V = G / (4 n.l n.v); all directions in the surface's frame, l and v above it."""
    v_smith = _HALF / (l.z * _stretched(along, across, v) + v.z * _stretched(along, across, l))
    return v_smith * _distribution(along, across, h)


@kernel
def pdf_anisotropic(along: np.float32, across: np.float32, v: Vec3, h: Vec3) -> np.float32:
    """G1(v) D(h) / (4 n.v): the density of the direction that a visible normal h reflects v to."""
    if v.z <= ZERO or h.z <= ZERO:
        return ZERO
    return _HALF * _distribution(along, across, h) / (v.z + _stretched(along, across, v))


@kernel
def sample_anisotropic(along: np.float32, across: np.float32, v: Vec3, u: np.float32, w: np.float32) -> Vec3:
    """A microfacet normal as it is seen from v, both in the surface's frame (Heitz 2018, listing 1)."""
    s = normalize(Vec3(along * v.x, across * v.y, v.z))
    squared = s.x * s.x + s.y * s.y
    t1 = Vec3(-s.y, s.x, ZERO) * (ONE / sqrt(squared)) if squared > ZERO else Vec3(ONE, ZERO, ZERO)
    t2 = cross(s, t1)
    x, y = warp_disk(u, w)
    middle = _HALF * (ONE + s.z)
    y = (ONE - middle) * safe_sqrt(ONE - x * x) + middle * y
    h = t1 * x + t2 * y + s * safe_sqrt(ONE - x * x - y * y)
    return normalize(Vec3(along * h.x, across * h.y, max(h.z, ZERO)))


@kernel
def frame_along(tangent: Vec3, n: Vec3) -> Frame:
    """The frame of a surface whose tangent, unit and at right angles to n, is known."""
    return Frame(tangent, cross(n, tangent), n)
