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

__all__ = ["about", "affine", "identity", "in_order", "transform_points", "transform_vectors", "window"]

Matrix = NDArray[np.float64]

# Points that are transformed at once: their block and its image stay in the cache between the product and the translation.
_BLOCK = 4096


def identity(size: int, leading: tuple[int, ...] = ()) -> Matrix:
    """(*leading, size, size) float64: matrices that change nothing, to be written to."""
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
    p, m = np.asarray(points, dtype=np.float64), np.asarray(matrix, dtype=np.float64)
    n = p.shape[-1]
    if m.shape[-1] == n:
        return _matvec(m, p)
    if m.ndim > 2:
        return _matvec(m[..., :n, :n], p) + m[..., :n, n]
    if p.size <= _BLOCK * n:
        return p @ m[:n, :n].T + m[:n, n]
    return _moved_in_blocks(m[:n, :n], m[:n, n], p.reshape(-1, n)).reshape(p.shape)


def _moved_in_blocks(linear: Matrix, translation: Matrix, points: Matrix) -> Matrix:
    """Numbers of a block are added as one long row: a row of three at a time would cost more than the product."""
    moved, turned = np.empty_like(points), np.ascontiguousarray(linear.T)
    added = np.tile(translation, _BLOCK)
    for start in range(0, len(points), _BLOCK):
        block = moved[start : start + _BLOCK]
        np.matmul(points[start : start + _BLOCK], turned, out=block)
        row = block.reshape(-1)
        row += added[: row.size]
    return moved


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
    v, m = np.asarray(vectors, dtype=np.float64), np.asarray(matrix, dtype=np.float64)
    n = v.shape[-1]
    return _matvec(m[..., :n, :n], v)


def _matvec(linear: Matrix, vectors: Matrix) -> Matrix:
    if linear.ndim == 2:
        return vectors @ linear.T
    if linear.shape[-3] == 1 and vectors.ndim >= 2:
        return np.asarray(vectors @ np.swapaxes(linear[..., 0, :, :], -1, -2))
    return np.einsum("...ij,...j->...i", linear, vectors)
