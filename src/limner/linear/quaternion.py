"""Rotations as quaternions: four numbers that compose, interpolate and stay rotations (FoCG 6.2.1 by another way; 16.2.2).

    q = from_axis_angle((0, 1, 0), math.radians(90))
    halfway = slerp(p, q, 0.5)
    matrix = to_matrix(halfway)

A quaternion is (x, y, z, w), Hamilton's, as glTF and SciPy write it: ``w = cos(angle / 2)``, ``(x, y, z) = axis sin(angle / 2)``.
Where a rotation is asked for, its length does not matter: q, -q and 2 q turn alike, and one of length zero turns nothing. All
functions take arrays, (..., 4), and broadcast leading axes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = [
    "angle_between", "axis_and_angle", "between", "conjugate", "from_axis_angle", "from_matrix", "multiply", "nlerp", "normalized",
    "rotate", "slerp", "to_matrix",
]  # fmt: skip

Floats = NDArray[np.float64]

_ROUNDING = 1e-20  # of a unit vector's last digit, what is left after taking it away twice


def normalized(quaternion: ArrayLike) -> Floats:
    """Make quaternions unit; one of length zero becomes (0, 0, 0, 1), which turns nothing."""
    q = np.asarray(quaternion, dtype=np.float64)
    length = np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(length > 0.0, q / np.where(length > 0.0, length, 1.0), (0.0, 0.0, 0.0, 1.0))


def conjugate(quaternion: ArrayLike) -> Floats:
    """The rotation back: the axis turned round. For unit quaternions the inverse."""
    return np.asarray(quaternion, dtype=np.float64) * (-1.0, -1.0, -1.0, 1.0)


def multiply(second: ArrayLike, first: ArrayLike) -> Floats:
    """Hamilton's product: the rotation by `first`, then by `second`, in the order of matrices.

    **Source**: Shoemake, *Animating Rotation with Quaternion Curves*, SIGGRAPH 1985, I.
    """
    p, q = np.asarray(second, dtype=np.float64), np.asarray(first, dtype=np.float64)
    r, s, v, w = p[..., :3], q[..., :3], p[..., 3:], q[..., 3:]
    axes = v * s + w * r + np.cross(r, s)
    scalar = v * w - np.sum(r * s, axis=-1, keepdims=True)
    return np.concatenate([axes, scalar], axis=-1)


def from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Floats:
    """Turn by `angle` radians about `axis`, counter-clockwise for whom the axis points at.

    Parameters
    ----------
    axis : (..., 3) float
        Of any length but zero.
    angle : (...) float

    Returns
    -------
    (..., 4) float64
        Unit.
    """
    a, half = np.asarray(axis, dtype=np.float64), np.asarray(angle, dtype=np.float64)[..., None] / 2.0
    length = np.linalg.norm(a, axis=-1, keepdims=True)
    if not np.all(length > 0.0):
        raise SceneError("the axis of a rotation must have a direction, got one of length zero")
    turned = a / length * np.sin(half)
    return np.concatenate([turned, np.broadcast_to(np.cos(half), (*turned.shape[:-1], 1))], axis=-1)


def axis_and_angle(quaternion: ArrayLike) -> tuple[Floats, Floats]:
    """Tell about what, and how far, a quaternion turns.

    Returns
    -------
    axis : (..., 3) float64
        Unit; +x where nothing turns.
    angle : (...) float64
        Radians in [0, pi].
    """
    q = normalized(quaternion)
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1)
    at_rest = sine[..., None] == 0.0
    axis = np.where(at_rest, (1.0, 0.0, 0.0), q[..., :3] / np.where(at_rest, 1.0, sine[..., None]))
    return axis, 2.0 * np.arctan2(sine, q[..., 3])


def to_matrix(quaternion: ArrayLike) -> Floats:
    """(..., 3, 3) float64: the rotation matrix.

    **Source**: Shoemake 1985, I.
    """
    x, y, z, w = np.moveaxis(normalized(quaternion), -1, 0)
    made = np.empty((*x.shape, 3, 3))
    made[..., 0, 0], made[..., 0, 1], made[..., 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    made[..., 1, 0], made[..., 1, 1], made[..., 1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    made[..., 2, 0], made[..., 2, 1], made[..., 2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    return made


def from_matrix(matrix: ArrayLike) -> Floats:
    """Find the quaternion of rotation matrices.

    Parameters
    ----------
    matrix : (..., 3, 3) or (..., 4, 4) float
        Of the latter, the linear part, which must be a rotation (see `limner.linear.decompose` for what is not).

    Returns
    -------
    (..., 4) float64
        Unit, w >= 0.

    **Source**: Shepperd, *Quaternion from Rotation Matrix*, Journal of Guidance and Control 1(3), 1978: divide by the greatest of
    the four numbers, which is at least 1/2.
    """
    m = np.asarray(matrix, dtype=np.float64)
    (a, b, c), (d, e, f), (g, h, i) = ([m[..., row, column] for column in range(3)] for row in range(3))
    # Four times the quaternion times its own numbers: rows for x, y, z, w.
    rows = (
        (1.0 + a - e - i, b + d, c + g, h - f),
        (b + d, 1.0 - a + e - i, f + h, c - g),
        (c + g, f + h, 1.0 - a - e + i, d - b),
        (h - f, c - g, d - b, 1.0 + a + e + i),
    )
    squares = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    greatest = np.argmax(np.diagonal(squares, axis1=-2, axis2=-1), axis=-1)
    q = normalized(np.take_along_axis(squares, greatest[..., None, None], axis=-2)[..., 0, :])
    return np.where(q[..., 3:] < 0.0, -q, q)


def rotate(quaternion: ArrayLike, vectors: ArrayLike) -> Floats:
    """Turn vectors: q v q*, without the matrix.

    Parameters
    ----------
    quaternion : (..., 4) float
    vectors : (..., 3) float

    Returns
    -------
    (..., 3) float64
    """
    q, v = normalized(quaternion), np.asarray(vectors, dtype=np.float64)
    r, w = q[..., :3], q[..., 3:]
    return np.asarray(v + 2.0 * np.cross(r, np.cross(r, v) + w * v))


def between(start: ArrayLike, end: ArrayLike) -> Floats:
    """The smallest rotation that takes one direction to another.

    Parameters
    ----------
    start, end : (..., 3) float
        Of any length but zero. Opposite ones are joined by a half turn about some axis at right angles.

    Returns
    -------
    (..., 4) float64
        Unit, w >= 0.
    """
    a, b = _unit(start), _unit(end)
    # cos and sin of half the angle, in which nothing cancels, and the direction at right angles to a in which b lies.
    cosine, sine = np.linalg.norm(a + b, axis=-1, keepdims=True) / 2.0, np.linalg.norm(a - b, axis=-1, keepdims=True) / 2.0
    aside = _across(_across(a + b, a), a)
    length = np.linalg.norm(aside, axis=-1, keepdims=True)
    least = np.eye(3)[np.argmin(np.abs(a), axis=-1)]
    lies_aside = length > _ROUNDING
    axis = np.where(lies_aside, np.cross(a, aside / np.where(lies_aside, length, 1.0)), _unit(np.cross(a, least)))
    return normalized(np.concatenate([axis * sine, cosine], axis=-1))


def _across(v: Floats, a: Floats) -> Floats:
    """The part of v at right angles to the unit vector a."""
    return np.asarray(v - np.sum(v * a, axis=-1, keepdims=True) * a)


def angle_between(start: ArrayLike, end: ArrayLike) -> Floats:
    """(...) float64: radians in [0, pi] by which one rotation must be turned to be another; exact for near ones too.

    **Source**: Kahan, *How Futile are Mindless Assessments of Roundoff in Floating-Point Computation?*, 2006, 12 (angles by atan2).
    """
    p, q = _facing(start, end)
    return 2.0 * _arc(p, q)


def slerp(start: ArrayLike, end: ArrayLike, t: ArrayLike) -> Floats:
    """Turn from one rotation to another at constant speed, the shorter way round.

    Parameters
    ----------
    start, end : (..., 4) float
    t : (...) float
        0: `start`, 1: `end`; beyond them, the turning goes on.

    Returns
    -------
    (..., 4) float64
        Unit. With t = 1 it may be -`end`, which turns alike.

    **Source**: Shoemake 1985, II: ``(p sin((1 - t) a) + q sin(t a)) / sin a``. Written with sin(x) / x, which has no gap at a = 0.
    """
    p, q = _facing(start, end)
    arc, share = _arc(p, q)[..., None] / np.pi, np.asarray(t, dtype=np.float64)[..., None]
    from_start, from_end = (1.0 - share) * np.sinc((1.0 - share) * arc), share * np.sinc(share * arc)
    return normalized(from_start * p + from_end * q)


def nlerp(start: ArrayLike, end: ArrayLike, t: ArrayLike) -> Floats:
    """Turn along the same shorter way, by the straight line made unit.

    Cheaper than `slerp`, and the same at both ends and in the middle; between them it lags and leads, for a half turn by up to 8.15
    degrees, for small turns by nothing.

    Parameters
    ----------
    start, end : (..., 4) float
    t : (...) float

    Returns
    -------
    (..., 4) float64
    """
    p, q = _facing(start, end)
    share = np.asarray(t, dtype=np.float64)[..., None]
    return normalized((1.0 - share) * p + share * q)


def _facing(start: ArrayLike, end: ArrayLike) -> tuple[Floats, Floats]:
    """Both unit, and of q and -q the one on the side of p."""
    p, q = normalized(start), normalized(end)
    return p, np.where(np.sum(p * q, axis=-1, keepdims=True) < 0.0, -q, q)


def _arc(p: Floats, q: Floats) -> Floats:
    """The angle between unit quaternions as vectors: half of what they turn apart."""
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(p - q, axis=-1), np.linalg.norm(p + q, axis=-1)))


def _unit(vectors: ArrayLike) -> Floats:
    v = np.asarray(vectors, dtype=np.float64)
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    if not np.all(length > 0.0):
        raise SceneError("a direction must not have length zero")
    return np.asarray(v / length)
