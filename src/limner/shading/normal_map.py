"""Normals from a picture (FoCG 11.4; glTF 2.0, 3.9.3)."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import where
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, normalize
from .surface import SurfacePoint

__all__ = ["mapped_normal"]

f32 = np.float32
_TWO = f32(2.0)


@kernel
def mapped_normal(c: Color, scale: np.float32, point: SurfacePoint) -> Vec3:
    """The shading normal bent by what a normal map shows: t x + b y + n z, with b = sign (n x t)."""
    n = point.ns
    t = point.tangent - n * dot(n, point.tangent)
    has_direction = dot(t, t) > ZERO
    t = normalize(t)
    b = cross(n, t) * point.bitangent_sign
    mapped = normalize(t * ((_TWO * c.r - ONE) * scale) + b * ((_TWO * c.g - ONE) * scale) + n * (_TWO * c.b - ONE))
    return where(has_direction & (dot(mapped, mapped) > ZERO), mapped, n)
