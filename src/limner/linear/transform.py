"""Transformation matrices in three dimensions (FoCG 6.2, 6.3): 4x4 float64, column vectors, ``p' = M @ p``.

    world_from_wheel = translate(1.2, 0.3, 0.8) @ rotate_z(angle) @ scale(0.3)
    positions = transform_points(world_from_wheel, positions)
    normals = transform_normals(world_from_wheel, normals)

Matrices are named target_from_source, and neighbours in a product match. Numbers may be arrays: ``rotate_y(angles)`` with (k,) angles
is (k, 4, 4), one matrix for each. Points, vectors and normals each have their own function, for each is transformed otherwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import quaternion
from .affine import about, affine, cross, identity, in_order, transform_points, transform_vectors, window

__all__ = [
    "about", "affine", "basis", "compose_trs", "frame_from_gaze", "in_order", "mirror", "normal_matrix", "reflect", "rotate",
    "rotate_about", "rotate_x", "rotate_y", "rotate_z", "scale", "shear", "shear_x", "shear_y", "shear_z", "transform_normals",
    "transform_points", "transform_vectors", "translate", "window",
]  # fmt: skip

Matrix = NDArray[np.float64]


def translate(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Matrix:
    """Move by (x, y, z). **Source**: FoCG 6.3."""
    x, y, z = np.broadcast_arrays(x, y, z)
    m = identity(4, x.shape)
    m[..., 0, 3], m[..., 1, 3], m[..., 2, 3] = x, y, z
    return m


def scale(x: ArrayLike, y: ArrayLike | None = None, z: ArrayLike | None = None) -> Matrix:
    """Scale along the axes; one number: alike in all; a negative one reflects. **Source**: FoCG 6.1.1, 6.1.4, 6.2."""
    x, y, z = np.broadcast_arrays(x, x if y is None else y, x if z is None else z)
    m = identity(4, x.shape)
    m[..., 0, 0], m[..., 1, 1], m[..., 2, 2] = x, y, z
    return m


def shear_x(y: ArrayLike, z: ArrayLike) -> Matrix:
    """Push along x by `y` for each unit of y and `z` for each unit of z. **Source**: FoCG 6.2, shear-x(d_y, d_z)."""
    y, z = np.broadcast_arrays(y, z)
    m = identity(4, y.shape)
    m[..., 0, 1], m[..., 0, 2] = y, z
    return m


def shear_y(x: ArrayLike, z: ArrayLike) -> Matrix:
    """Push along y by `x` for each unit of x and `z` for each unit of z. **Source**: FoCG 6.2."""
    x, z = np.broadcast_arrays(x, z)
    m = identity(4, x.shape)
    m[..., 1, 0], m[..., 1, 2] = x, z
    return m


def shear_z(x: ArrayLike, y: ArrayLike) -> Matrix:
    """Push along z by `x` for each unit of x and `y` for each unit of y. **Source**: FoCG 6.2."""
    x, y = np.broadcast_arrays(x, y)
    m = identity(4, x.shape)
    m[..., 2, 0], m[..., 2, 1] = x, y
    return m


def shear(push: ArrayLike, normal: ArrayLike) -> Matrix:
    """Slide planes over each other: I + d n^T, d being the part of `push` that lies in them.

    Parameters
    ----------
    push : (..., 3) float
        How far the plane at distance 1 from the origin slides. What of it points out of the plane is left out.
    normal : (..., 3) float
        Of the planes; any length but zero.

    Returns
    -------
    (..., 4, 4) float64

    **Source**: FoCG 6.1.2, 6.2, for any direction.
    """
    n = _unit(normal, "the normal of a shear")
    d = np.asarray(push, dtype=np.float64)
    d = d - np.sum(d * n, axis=-1, keepdims=True) * n
    return affine(np.eye(3) + d[..., :, None] * n[..., None, :])


def rotate_x(angle: ArrayLike) -> Matrix:
    """Turn by `angle` radians about x, counter-clockwise seen from +x. **Source**: FoCG 6.2."""
    return _turn(angle, 1, 2)


def rotate_y(angle: ArrayLike) -> Matrix:
    """Turn by `angle` radians about y, counter-clockwise seen from +y. **Source**: FoCG 6.2."""
    return _turn(angle, 2, 0)


def rotate_z(angle: ArrayLike) -> Matrix:
    """Turn by `angle` radians about z, counter-clockwise seen from +z. **Source**: FoCG 6.2."""
    return _turn(angle, 0, 1)


def _turn(angle: ArrayLike, first: int, second: int) -> Matrix:
    """The rotation of 6.1.3 in the plane of two axes."""
    c, s = np.cos(angle), np.sin(angle)
    m = identity(4, np.shape(angle))
    m[..., first, first], m[..., first, second], m[..., second, first], m[..., second, second] = c, -s, s, c
    return m


def basis(w: ArrayLike) -> Matrix:
    """Find axes u and v at right angles to w and each other.

    Parameters
    ----------
    w : (..., 3) float
        Of any length but zero.

    Returns
    -------
    (..., 3, 3) float64
        Columns u, v and w / |w|: a rotation, R_uvw transposed, which takes z to w.

    **Source**: FoCG 2.4.6: t is w with its number of least magnitude made 1, u = t x w / |t x w|, v = w x u.
    """
    axis = _unit(w, "an axis")
    t = np.where(np.arange(3) == np.argmin(np.abs(axis), axis=-1)[..., None], 1.0, axis)
    u = np.cross(t, axis)
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    return np.stack([u, np.cross(axis, u), axis], axis=-1)


def rotate(axis: ArrayLike, angle: ArrayLike) -> Matrix:
    """Turn about any axis through the origin: take it to z, turn about z, and take it back.

    Parameters
    ----------
    axis : (..., 3) float
        Of any length but zero.
    angle : (...) float
        Radians, counter-clockwise for whom the axis points at.

    Returns
    -------
    (..., 4, 4) float64
        The same as of the quaternion `limner.linear.quaternion.from_axis_angle`.

    Examples
    --------
    >>> transform_vectors(rotate((1, 1, 1), np.radians(120)), (1, 0, 0)).round(12).tolist()
    [0.0, 1.0, 0.0]

    **Source**: FoCG 6.2.1: R_uvw^T rotate-z(angle) R_uvw.
    """
    from_uvw = basis(axis)
    return affine(from_uvw @ rotate_z(angle)[..., :3, :3] @ np.swapaxes(from_uvw, -1, -2))


def rotate_about(point: ArrayLike, axis: ArrayLike, angle: ArrayLike) -> Matrix:
    """Turn about the line through `point` along `axis`. **Source**: FoCG 6.2.1, 6.3."""
    return about(point, rotate(axis, angle))


def reflect(normal: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)) -> Matrix:
    """Reflect across a plane: I - 2 n n^T around one of its points.

    Parameters
    ----------
    normal : (..., 3) float
        Of any length but zero. (1, 0, 0) is the reflection across the yz plane, which negates x.
    point : (..., 3) float
        Any point of the plane.

    Returns
    -------
    (..., 4, 4) float64
        Its own inverse.

    **Source**: FoCG 6.1.4, 6.2 for the planes of the axes; Householder, *Unitary Triangularization of a Nonsymmetric Matrix*,
    Journal of the ACM 5(4), 1958, for any.
    """
    n = _unit(normal, "the normal of a mirror")
    return about(point, np.eye(3) - 2.0 * n[..., :, None] * n[..., None, :])


def mirror(axis: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)) -> Matrix:
    """Reflect across a line: 2 a a^T - I around one of its points. In space that is half a turn about it.

    Parameters
    ----------
    axis : (..., 3) float
        Of any length but zero.
    point : (..., 3) float
        Any point of the line.

    Returns
    -------
    (..., 4, 4) float64
        Its own inverse.

    **Source**: FoCG 6.1.4, 6.2.
    """
    a = _unit(axis, "the axis of a mirror")
    return about(point, 2.0 * a[..., :, None] * a[..., None, :] - np.eye(3))


def compose_trs(translation: ArrayLike, rotation: ArrayLike, size: ArrayLike) -> Matrix:
    """Translation times rotation times scale, as glTF nodes have it.

    Parameters
    ----------
    translation : (..., 3) float
    rotation : (..., 4) float
        Quaternion (x, y, z, w); normalised here, and one of length zero turns nothing.
    size : (..., 3) float
        Along the axes before the rotation.

    Returns
    -------
    (..., 4, 4) float64

    **Source**: FoCG 6.1.5; glTF 2.0, 3.5.3.
    """
    return affine(quaternion.to_matrix(rotation) * np.asarray(size, dtype=np.float64)[..., None, :], translation)


def frame_from_gaze(eye: ArrayLike, gaze: ArrayLike, up: ArrayLike) -> Matrix:
    """Stand a camera up: world from camera, w = -g/|g|, u = t x w / |t x w|, v = w x u, origin e.

    Parameters
    ----------
    eye, gaze, up : (..., 3) float
        `gaze` and `up` must not be zero, nor along each other.

    Returns
    -------
    (..., 4, 4) float64

    **Source**: FoCG 7.1.3.
    """
    g, t = np.asarray(gaze, dtype=np.float64), np.asarray(up, dtype=np.float64)
    w = -g / np.linalg.norm(g, axis=-1, keepdims=True)
    u = cross(t, w)
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    return affine(np.stack(np.broadcast_arrays(u, cross(w, u), w), axis=-1), eye)


def normal_matrix(matrix: ArrayLike) -> Matrix:
    """Find the matrix for normals: the cofactors of the linear part times the sign of its determinant.

    Parameters
    ----------
    matrix : (..., 4, 4) or (..., 3, 3) float

    Returns
    -------
    (..., 3, 3) float64
        Proportional to the inverse transpose where there is one, and unlike it defined for singular matrices too: a plane flattened
        onto itself keeps its normal.

    **Source**: FoCG 6.2.2.
    """
    linear = np.asarray(matrix, dtype=np.float64)[..., :3, :3]
    a, b, c = linear[..., 0], linear[..., 1], linear[..., 2]
    cofactors = np.stack([cross(b, c), cross(c, a), cross(a, b)], axis=-1)
    determinant = np.sum(a * cofactors[..., :, 0], axis=-1)
    return np.where(determinant[..., None, None] < 0.0, -cofactors, cofactors)


def transform_normals(matrix: ArrayLike, normals: ArrayLike) -> Matrix:
    """Apply the cofactor matrix to normals and make them unit.

    Parameters
    ----------
    matrix : (..., 4, 4) or (..., 3, 3) float
    normals : (..., 3) float

    Returns
    -------
    (..., 3) float64
        A normal of length zero stays zero, and so becomes one whose plane is flattened to a line or a point.

    **Source**: FoCG 6.2.2.
    """
    linear = np.asarray(matrix, dtype=np.float64)[..., :3, :3]
    moved = transform_vectors(normal_matrix(_near_one(linear, (-2, -1))), _near_one(normals, (-1,)))
    length = np.linalg.norm(moved, axis=-1, keepdims=True)
    return np.asarray(moved / np.where(length > 0.0, length, 1.0))


def _near_one(values: ArrayLike, axes: tuple[int, ...]) -> Matrix:
    """The same numbers times a power of two, exactly: products of three very small or very great ones would vanish or overflow."""
    given = np.asarray(values, dtype=np.float64)
    _, exponent = np.frexp(np.max(np.abs(given), axis=axes, keepdims=True))
    return np.ldexp(given, -exponent)


def _unit(vectors: ArrayLike, name: str) -> Matrix:
    v = _near_one(vectors, (-1,))
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    if not np.all(length > 0.0):
        raise SceneError(f"{name} must have a direction, got {np.asarray(vectors).tolist()}")
    return np.asarray(v / length)
