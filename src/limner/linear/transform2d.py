"""Transformation matrices in two dimensions (FoCG 6.1, 6.3).

    corners = transform_points(rotate(math.radians(30)) @ shear_x(0.5), corners)              2x2: linear
    corners = transform_points(translate(3, 1) @ affine(rotate(0.5)), corners)                3x3: affine, homogeneous coordinates

The linear ones are the book's 2x2 matrices; `affine` puts one into a 3x3 matrix, where it meets translations. Numbers may be arrays:
``rotate(angles)`` with (k,) angles is (k, 2, 2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .affine import about, affine, identity, in_order, transform_points, transform_vectors, window

__all__ = [
    "about", "affine", "in_order", "normal_matrix", "reflect", "reflect_x", "reflect_y", "rotate", "rotate_about", "scale", "shear_x",
    "shear_y", "transform_normals", "transform_points", "transform_vectors", "translate", "window",
]  # fmt: skip

Matrix = NDArray[np.float64]


def scale(x: ArrayLike, y: ArrayLike | None = None) -> Matrix:
    """(..., 2, 2): scale along the axes; one number: alike in both; a negative one reflects. **Source**: FoCG 6.1.1."""
    x, y = np.broadcast_arrays(x, x if y is None else y)
    m = identity(2, x.shape)
    m[..., 0, 0], m[..., 1, 1] = x, y
    return m


def shear_x(s: ArrayLike) -> Matrix:
    """(..., 2, 2): push along x by s for each unit of y; vertical lines lean by atan(s). **Source**: FoCG 6.1.2."""
    m = identity(2, np.shape(s))
    m[..., 0, 1] = s
    return m


def shear_y(s: ArrayLike) -> Matrix:
    """(..., 2, 2): push along y by s for each unit of x; level lines rise by atan(s). **Source**: FoCG 6.1.2."""
    m = identity(2, np.shape(s))
    m[..., 1, 0] = s
    return m


def rotate(angle: ArrayLike) -> Matrix:
    """(..., 2, 2): turn by `angle` radians, counter-clockwise. **Source**: FoCG 6.1.3."""
    c, s = np.cos(angle), np.sin(angle)
    m = identity(2, np.shape(angle))
    m[..., 0, 0], m[..., 0, 1], m[..., 1, 0], m[..., 1, 1] = c, -s, s, c
    return m


def reflect_x() -> Matrix:
    """(2, 2): reflect across the x-axis, which negates y. **Source**: FoCG 6.1.4."""
    return scale(1.0, -1.0)


def reflect_y() -> Matrix:
    """(2, 2): reflect across the y-axis, which negates x. **Source**: FoCG 6.1.4."""
    return scale(-1.0, 1.0)


def reflect(direction: ArrayLike) -> Matrix:
    """Reflect across the line through the origin along `direction`: 2 d d^T - I.

    Parameters
    ----------
    direction : (..., 2) float
        Of any length but zero.

    Returns
    -------
    (..., 2, 2) float64
        Its own inverse.

    **Source**: FoCG 6.1.4, with the axis turned: rotate(a) reflect-x rotate(-a).
    """
    d = np.asarray(direction, dtype=np.float64)
    length = np.linalg.norm(d, axis=-1, keepdims=True)
    if not np.all(length > 0.0):
        raise SceneError(f"the axis of a mirror must have a direction, got {d.tolist()}")
    d = d / length
    return np.asarray(2.0 * d[..., :, None] * d[..., None, :] - np.eye(2))


def translate(x: ArrayLike, y: ArrayLike) -> Matrix:
    """(..., 3, 3): move by (x, y). **Source**: FoCG 6.3."""
    x, y = np.broadcast_arrays(x, y)
    m = identity(3, x.shape)
    m[..., 0, 2], m[..., 1, 2] = x, y
    return m


def rotate_about(point: ArrayLike, angle: ArrayLike) -> Matrix:
    """(..., 3, 3): turn about a point. **Source**: FoCG 6.3."""
    return about(point, rotate(angle))


def normal_matrix(matrix: ArrayLike) -> Matrix:
    """(..., 2, 2): the cofactors of the linear part times the sign of its determinant, for normals of curves.

    **Source**: FoCG 6.2.2, in two dimensions.
    """
    m = np.asarray(matrix, dtype=np.float64)
    a, b, c, d = m[..., 0, 0], m[..., 0, 1], m[..., 1, 0], m[..., 1, 1]
    cofactors = np.stack([np.stack([d, -c], axis=-1), np.stack([-b, a], axis=-1)], axis=-2)
    return np.where((a * d - b * c)[..., None, None] < 0.0, -cofactors, cofactors)


def transform_normals(matrix: ArrayLike, normals: ArrayLike) -> Matrix:
    """Apply the cofactor matrix to normals, (..., 2), and make them unit; what has no length stays zero. **Source**: FoCG 6.2.2."""
    moved = transform_vectors(normal_matrix(matrix), normals)
    length = np.linalg.norm(moved, axis=-1, keepdims=True)
    return np.asarray(moved / np.where(length > 0.0, length, 1.0))
