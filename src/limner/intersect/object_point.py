"""A point of a shape's surface, in the shape's own space: what shading has to know of it.

Texture coordinates come with their gradients, so that how they change from pixel to pixel follows from how the point moves in its
tangent plane: du = gradient_u . dp.

Where a shape is round about +y, u = 1/2 + atan2(-z, x) / 2 pi as for the sphere (FoCG 11.1, turned to y up): it runs
counter-clockwise seen from above, with its seam at -x.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import TWO_PI, atan2, sqrt
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = ["ObjectPoint", "around", "around_gradient", "around_tangent", "axis_distance", "cap_at"]

f32 = np.float32
_HALF = f32(0.5)


class ObjectPoint(NamedTuple):
    """A point of a surface, in object space.

    p: put back onto the surface, which rounding left. n: unit, outwards. tangent: along u, at right angles to n; not unit. Seen from
    outside, v grows to the left of u: (n x tangent) . gradient_v >= 0; on a quadric, it may be to the right.
    """

    p: Vec3
    n: Vec3
    tangent: Vec3
    u: np.float32
    v: np.float32
    gradient_u: Vec3
    gradient_v: Vec3


@kernel
def axis_distance(p: Vec3) -> np.float32:
    """sqrt(x^2 + z^2), without overflow or loss for what is very large or very small."""
    greatest = max(abs(p.x), abs(p.z))
    if not greatest > ZERO:
        return ZERO
    x, z = p.x / greatest, p.z / greatest
    return greatest * sqrt(x * x + z * z)


@kernel
def around(p: Vec3) -> np.float32:
    """u = 1/2 + atan2(-z, x) / 2 pi"""
    return _HALF + atan2(-p.z, p.x) / TWO_PI


@kernel
def around_gradient(p: Vec3, distance: np.float32) -> Vec3:
    """The gradient (z, 0, -x) / (2 pi (x^2 + z^2)) of `around`; none on the axis. `distance`: from the axis."""
    if not distance > ZERO:
        return Vec3(ZERO, ZERO, ZERO)
    return Vec3(p.z / distance, ZERO, -p.x / distance) / (TWO_PI * distance)


@kernel
def around_tangent(p: Vec3, distance: np.float32) -> Vec3:
    """The unit vector along which `around` grows; on the axis +x."""
    if not distance > ZERO:
        return Vec3(ONE, ZERO, ZERO)
    return Vec3(p.z / distance, ZERO, -p.x / distance)


@kernel
def cap_at(p: Vec3, y: np.float32, radius: np.float32, up: np.float32) -> ObjectPoint:
    """The point of a disk about +y at height y that looks up (1) or down (-1).

    u = (1 + x/r) / 2 and v = (1 - up z/r) / 2: the disk cut out of the texture; seen from its front it is not mirrored.
    """
    half = _HALF / radius if radius > ZERO else ZERO
    return ObjectPoint(
        Vec3(p.x, y, p.z), Vec3(ZERO, up, ZERO), Vec3(ONE, ZERO, ZERO), _HALF + p.x * half, _HALF - up * p.z * half,
        Vec3(half, ZERO, ZERO), Vec3(ZERO, ZERO, -up * half),
    )  # fmt: skip
