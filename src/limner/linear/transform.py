"""Transformation matrices (FoCG 6): 4x4 float64, column vectors, ``p' = M @ p``; named target_from_source."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "compose_trs", "frame_from_gaze", "normal_matrix", "rotate_x", "rotate_y", "rotate_z", "scale", "transform_normals",
    "transform_points", "transform_vectors", "translate",
]  # fmt: skip

Matrix = NDArray[np.float64]


def translate(x: float, y: float, z: float) -> Matrix:
    """Move by (x, y, z). **Source**: FoCG 6.3."""
    m = np.eye(4)
    m[:3, 3] = (x, y, z)
    return m


def scale(x: float, y: float | None = None, z: float | None = None) -> Matrix:
    """Scale along the axes; one number: alike in all. **Source**: FoCG 6.1.1, 6.2."""
    return np.diag([x, x if y is None else y, x if z is None else z, 1.0]).astype(np.float64)


def rotate_x(angle: float) -> Matrix:
    """Turn by `angle` radians about x, counter-clockwise seen from +x. **Source**: FoCG 6.2."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def rotate_y(angle: float) -> Matrix:
    """Turn by `angle` radians about y. **Source**: FoCG 6.2."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1.0]])


def rotate_z(angle: float) -> Matrix:
    """Turn by `angle` radians about z. **Source**: FoCG 6.2."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def compose_trs(translation: ArrayLike, rotation: ArrayLike, size: ArrayLike) -> Matrix:
    """Translation times rotation (unit quaternion x, y, z, w; normalised here) times scale, as glTF nodes have it.

    A quaternion of length zero turns nothing.
    """
    x, y, z, w = np.asarray(rotation, dtype=np.float64) / (np.linalg.norm(np.asarray(rotation, dtype=np.float64)) or 1.0)
    if x == y == z == w == 0.0:
        w = 1.0
    m = np.eye(4)
    m[:3, :3] = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    ) * np.asarray(size, dtype=np.float64)
    m[:3, 3] = translation
    return m


def frame_from_gaze(eye: ArrayLike, gaze: ArrayLike, up: ArrayLike) -> Matrix:
    """World from camera: w = -g/|g|, u = t x w / |t x w|, v = w x u, origin e. **Source**: FoCG 7.1.3."""
    g, t = np.asarray(gaze, dtype=np.float64), np.asarray(up, dtype=np.float64)
    w = -g / np.linalg.norm(g)
    u = np.cross(t, w)
    u /= np.linalg.norm(u)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = u, np.cross(w, u), w, eye
    return m


def normal_matrix(matrix: Matrix) -> Matrix:
    """(3, 3) matrix for normals: the cofactors of the linear part times the sign of its determinant.

    Proportional to the inverse transpose where there is one, and unlike it defined for singular matrices too: a plane
    flattened onto itself keeps its normal. **Source**: FoCG 6.2.2.
    """
    linear = np.asarray(matrix, dtype=np.float64)[:3, :3]
    a, b, c = linear.T
    cofactors = np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)]).T
    return -cofactors if np.dot(a, np.cross(b, c)) < 0.0 else cofactors


def transform_points(matrix: Matrix, points: ArrayLike) -> NDArray[Any]:
    """Apply an affine matrix to points of shape (..., 3): rotation, scale and translation."""
    return np.asarray(points, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def transform_vectors(matrix: Matrix, vectors: ArrayLike) -> NDArray[Any]:
    """Apply an affine matrix to vectors of shape (..., 3): no translation."""
    return np.asarray(vectors, dtype=np.float64) @ matrix[:3, :3].T


def transform_normals(matrix: Matrix, normals: ArrayLike) -> NDArray[Any]:
    """Apply the cofactor matrix to normals of shape (..., 3) and make them unit; a normal of length zero stays zero."""
    moved = np.asarray(normals, dtype=np.float64) @ normal_matrix(matrix).T
    length = np.linalg.norm(moved, axis=-1, keepdims=True)
    return moved / np.where(length > 0.0, length, 1.0)
