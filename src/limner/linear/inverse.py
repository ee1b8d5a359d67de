"""Inverses that the structure of a transformation gives away (FoCG 6.4).

A general inverse costs an elimination and its rounding. Who knows what a matrix is need not pay: a scale is inverted by reciprocals,
a rotation by its transpose, a move by its opposite, and products by the inverses in reversed order.

    (A B)^-1 = B^-1 A^-1

All functions take (..., n + 1, n + 1) float matrices in homogeneous coordinates and return as many, float64.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .affine import affine

__all__ = ["inverse_affine", "inverse_rigid", "inverse_rotation", "inverse_scale", "inverse_shear", "inverse_translation"]

Matrix = NDArray[np.float64]


def inverse_scale(matrix: ArrayLike) -> Matrix:
    """Invert a scale along the axes: one over each factor. **Source**: FoCG 6.4.

    Raises
    ------
    SceneError
        A factor is 0: what was flattened cannot be raised again.
    """
    given = np.asarray(matrix, dtype=np.float64)
    factors = np.diagonal(given, axis1=-2, axis2=-1)
    if not np.all(factors):
        raise SceneError("a scale by 0 has no inverse")
    return np.asarray(np.eye(given.shape[-1]) * (1.0 / factors)[..., None])


def inverse_rotation(matrix: ArrayLike) -> Matrix:
    """Invert a rotation or reflection through the origin: its transpose, exactly. **Source**: FoCG 6.4."""
    return np.swapaxes(np.array(matrix, dtype=np.float64), -1, -2)


def inverse_translation(matrix: ArrayLike) -> Matrix:
    """Invert a move: the opposite one, exactly. **Source**: FoCG 6.4."""
    made = np.array(matrix, dtype=np.float64)
    made[..., :-1, -1] *= -1.0
    return made


def inverse_shear(matrix: ArrayLike) -> Matrix:
    """Invert a shear I + d n^T, d at right angles to n: it is I - d n^T, exactly. **Source**: FoCG 6.1.2, 6.4."""
    given = np.asarray(matrix, dtype=np.float64)
    return np.asarray(2.0 * np.eye(given.shape[-1]) - given)


def inverse_rigid(matrix: ArrayLike) -> Matrix:
    """Invert a rotation with a move after it: the transpose, after the opposite move. **Source**: FoCG 6.4, 7.1.3."""
    given = np.asarray(matrix, dtype=np.float64)
    back = np.swapaxes(given[..., :-1, :-1], -1, -2)
    return affine(back, -(back @ given[..., :-1, -1:])[..., 0])


def inverse_affine(matrix: ArrayLike) -> Matrix:
    """Invert any affine transformation by elimination in its linear part alone; the last row stays exact. **Source**: FoCG 6.4.

    Raises
    ------
    SceneError
        The matrix flattens space, so that there is no inverse.
    """
    given = np.asarray(matrix, dtype=np.float64)
    try:
        back = np.linalg.inv(given[..., :-1, :-1])
    except np.linalg.LinAlgError:
        raise SceneError("a transformation that flattens space (its determinant is 0) has no inverse") from None
    return affine(back, -(back @ given[..., :-1, -1:])[..., 0])
