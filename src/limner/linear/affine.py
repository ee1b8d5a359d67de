"""What holds of transformations in two, three or any number of dimensions (FoCG 6.1, 6.3).

    world_from_wheel = in_order(rotate_z(angle), translate(1.2, 0.3, 0.8))      first turn, then move
    points = transform_points(world_from_wheel, points)

A linear transformation of n dimensions is an (n, n) matrix, an affine one (n + 1, n + 1) in homogeneous coordinates; vectors are
columns, ``p' = M @ p``. Every function takes whole arrays of matrices, (..., n + 1, n + 1), and the leading axes of matrices, points
and parameters are broadcast against each other: k matrices move k points each its own; ``matrices[:, None]`` moves every point by
every matrix.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["about", "affine", "cross", "identity", "in_order", "transform_points", "transform_vectors", "window"]

Matrix = NDArray[np.float64]

# Points that are transformed at once: they and their images stay in the cache between the product and the move after it.
_BLOCK = 4096


def cross(a: ArrayLike, b: ArrayLike) -> Matrix:
    """(..., 3) float64: the cross product, as `numpy.cross` finds it, in a tenth of the time where the vectors are few (FoCG 2.4.4)."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    x = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    made = np.empty((*x.shape, 3))
    made[..., 0] = x
    made[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    made[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return made


def identity(size: int, leading: tuple[int, ...] = ()) -> Matrix:
    """(*leading, size, size) float64: matrices that change nothing, to be written to."""
    if not leading:
        return np.eye(size)
    return np.broadcast_to(np.eye(size), (*leading, size, size)).copy()


def affine(linear: ArrayLike, translation: ArrayLike = 0.0) -> Matrix:
    """Put a linear transformation and the move after it into one matrix.

    Parameters
    ----------
    linear : (..., n, n) float
    translation : (..., n) float

    Returns
    -------
    (..., n + 1, n + 1) float64

    Examples
    --------
    >>> affine([[0, -1], [1, 0]], (5, 6)).tolist()
    [[0.0, -1.0, 5.0], [1.0, 0.0, 6.0], [0.0, 0.0, 1.0]]

    **Source**: FoCG 6.3.
    """
    upper, moved = np.asarray(linear, dtype=np.float64), np.asarray(translation, dtype=np.float64)
    n = upper.shape[-1]
    made = identity(n + 1, np.broadcast_shapes(upper.shape[:-2], moved.shape[:-1]))
    made[..., :n, :n], made[..., :n, n] = upper, moved
    return made


def in_order(*steps: ArrayLike) -> Matrix:
    """Compose transformations in the order in which they happen: the last step's matrix stands leftmost in the product.

    Parameters
    ----------
    *steps : (..., n, n) float
        At least one; the first is applied first.

    Returns
    -------
    (..., n, n) float64

    **Source**: FoCG 6.1.5.
    """
    if not steps:
        raise SceneError("a composition needs at least one transformation")
    product = np.asarray(steps[0], dtype=np.float64)
    for step in steps[1:]:
        product = np.asarray(step, dtype=np.float64) @ product
    return product


def about(point: ArrayLike, matrix: ArrayLike) -> Matrix:
    """Let a transformation happen around a point instead of the origin: move the point there, transform, move it back.

    Parameters
    ----------
    point : (..., n) float
        Stays where it is, if the matrix leaves the origin where it is.
    matrix : (..., n + 1, n + 1) or (..., n, n) float
        Affine or linear.

    Returns
    -------
    (..., n + 1, n + 1) float64

    **Source**: FoCG 6.3.
    """
    centre, given = np.asarray(point, dtype=np.float64), np.asarray(matrix, dtype=np.float64)
    n = centre.shape[-1]
    moved = centre - _matvec(given[..., :n, :n], centre)
    return affine(given[..., :n, :n], moved if given.shape[-1] == n else given[..., :n, n] + moved)


def window(low: ArrayLike, high: ArrayLike, to_low: ArrayLike, to_high: ArrayLike) -> Matrix:
    """Take one box to another, side by side: move its low corner to the origin, scale, move the corner to its new place.

    Parameters
    ----------
    low, high : (..., n) float
        Opposite corners; along every axis they must differ.
    to_low, to_high : (..., n) float
        Where they go.

    Returns
    -------
    (..., n + 1, n + 1) float64

    Examples
    --------
    >>> transform_points(window((0, 0), (2, 4), (-1, -1), (1, 1)), (1, 1)).tolist()
    [0.0, -0.5]

    **Source**: FoCG 6.3, windowing transformations.
    """
    l, h, to_l, to_h = (np.asarray(corner, dtype=np.float64) for corner in (low, high, to_low, to_high))  # noqa: E741
    size = h - l
    if not np.all(size):
        raise SceneError(f"a window must have an extent along every axis, got corners {l.tolist()} and {h.tolist()}")
    n = size.shape[-1]
    linear = ((to_h - to_l) / size)[..., None] * np.eye(n)
    return affine(linear, (to_l * h - to_h * l) / size)


def transform_points(matrix: ArrayLike, points: ArrayLike) -> Matrix:
    """Apply an affine or linear matrix to points: rotation, scale, shear and translation.

    Parameters
    ----------
    matrix : (..., n + 1, n + 1) or (..., n, n) float
    points : (..., n) float

    Returns
    -------
    (..., n) float64

    **Source**: FoCG 6.3: the homogeneous coordinate of a point is 1.
    """
    m, p, n = _fitting(matrix, points)
    if m.shape[-1] == n:
        return _matvec(m, p)
    if m.ndim > 2:
        return _matvec(m[..., :n, :n], p) + m[..., :n, n]
    return _matvec(m[:n, :n], p, m[:n, n])


def transform_vectors(matrix: ArrayLike, vectors: ArrayLike) -> Matrix:
    """Apply an affine or linear matrix to vectors, as differences of points are: no translation.

    Parameters
    ----------
    matrix : (..., n + 1, n + 1) or (..., n, n) float
    vectors : (..., n) float

    Returns
    -------
    (..., n) float64

    **Source**: FoCG 6.3: the homogeneous coordinate of a vector is 0.
    """
    m, v, n = _fitting(matrix, vectors)
    return _matvec(m[..., :n, :n], v)


def _fitting(matrix: ArrayLike, values: ArrayLike) -> tuple[Matrix, Matrix, int]:
    m, v = np.asarray(matrix, dtype=np.float64), np.asarray(values, dtype=np.float64)
    n = v.shape[-1] if v.ndim else 0
    if m.ndim < 2 or m.shape[-2] != m.shape[-1] or m.shape[-1] not in (n, n + 1):
        raise SceneError(f"points of shape {v.shape} need matrices of shape (..., {n}, {n}) or (..., {n + 1}, {n + 1}), got {m.shape}")
    return m, v, n


def _matvec(linear: Matrix, vectors: Matrix, translation: Matrix | None = None) -> Matrix:
    """The product, and the move after it where one matrix moves everything."""
    if linear.ndim == 2:
        n = linear.shape[0]
        if vectors.size > _BLOCK * n:
            return _in_blocks(linear, vectors.reshape(-1, n), translation).reshape(vectors.shape)
        turned = vectors @ linear.T
        return turned if translation is None else turned + translation
    if linear.shape[-3] == 1 and vectors.ndim >= 2:
        return np.asarray(vectors @ np.swapaxes(linear[..., 0, :, :], -1, -2))
    return np.einsum("...ij,...j->...i", linear, vectors)


def _in_blocks(linear: Matrix, vectors: Matrix, translation: Matrix | None) -> Matrix:
    """Numbers of a block are added as one long row: a row of three at a time would cost more than the product."""
    made, transposed = np.empty_like(vectors, order="C"), np.ascontiguousarray(linear.T)
    added = None if translation is None else np.tile(translation, _BLOCK)
    for start in range(0, len(vectors), _BLOCK):
        block = made[start : start + _BLOCK]
        np.matmul(vectors[start : start + _BLOCK], transposed, out=block)
        if added is not None:
            row = block.reshape(-1)
            row += added[: row.size]
    return made
