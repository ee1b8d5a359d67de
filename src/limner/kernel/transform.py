"""Points and vectors under an affine transformation (FoCG 6.3): the upper three rows of its matrix are all there is to know."""

from __future__ import annotations

from .._jit import kernel
from .vec import Vec3

__all__ = ["transform_point", "transform_vector"]


@kernel
def transform_point(m, p: Vec3) -> Vec3:
    """M p for a (3, 4) matrix: rotation, scale and translation."""
    return Vec3(
        m[0, 0] * p.x + m[0, 1] * p.y + m[0, 2] * p.z + m[0, 3],
        m[1, 0] * p.x + m[1, 1] * p.y + m[1, 2] * p.z + m[1, 3],
        m[2, 0] * p.x + m[2, 1] * p.y + m[2, 2] * p.z + m[2, 3],
    )


@kernel
def transform_vector(m, v: Vec3) -> Vec3:
    """M v for the linear part of a (3, 4) or (3, 3) matrix."""
    return Vec3(
        m[0, 0] * v.x + m[0, 1] * v.y + m[0, 2] * v.z,
        m[1, 0] * v.x + m[1, 1] * v.y + m[1, 2] * v.z,
        m[2, 0] * v.x + m[2, 1] * v.y + m[2, 2] * v.z,
    )
