"""What a matrix does, taken apart (FoCG 6.1.5, 6.1.6).

    eigen       A = R S R^T       symmetric A: a stretch along axes at right angles
    singular    A = U S V^T       any A: a rotation, a stretch along the axes, another rotation
    polar       A = Q P           any A: a stretch along axes at right angles, then the nearest rotation (or mirrored rotation)
    trs         M = T R S         affine M without shear: as glTF's nodes are kept
    shears      R = X Y X         a rotation of the plane as three shears (Paeth)

The factors multiply to the matrix again, whatever it is: singular, mirrored or zero. All take arrays of matrices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import quaternion, transform2d
from .affine import affine

__all__ = ["TRS", "Eigen", "Polar", "Singular", "eigen", "interpolate", "polar", "shears", "singular", "trs"]

Matrix = NDArray[np.float64]

_SHEAR = 1e-9  # cosine between axes: what rounding, or a file with ten digits, leaves of a right angle


class Eigen(NamedTuple):
    """``A = rotation @ diag(factors) @ rotation.T``; factors from the greatest down."""

    rotation: Matrix
    factors: Matrix


class Singular(NamedTuple):
    """``A = after @ diag(factors) @ before.T``; rotations both, the last factor negative where A mirrors."""

    after: Matrix
    factors: Matrix
    before: Matrix


class Polar(NamedTuple):
    """``A = rotation @ stretch``: orthogonal (determinant -1 where A mirrors), and symmetric without negative eigenvalues."""

    rotation: Matrix
    stretch: Matrix


class TRS(NamedTuple):
    """``compose_trs(translation, rotation, size)``: the rotation a unit quaternion (x, y, z, w); size[0] negative for a mirror."""

    translation: Matrix
    rotation: Matrix
    size: Matrix


def eigen(symmetric: ArrayLike) -> Eigen:
    """Find the axes along which a symmetric matrix stretches, and how much.

    Parameters
    ----------
    symmetric : (..., n, n) float
        Of each matrix, the lower triangle counts.

    Returns
    -------
    Eigen
        rotation : (..., n, n), factors : (..., n) float64

    **Source**: FoCG 6.1.6, symmetric eigenvalue decomposition.
    """
    factors, axes = np.linalg.eigh(np.asarray(symmetric, dtype=np.float64))
    return Eigen(_without_mirror(axes[..., ::-1]), np.asarray(factors[..., ::-1]))


def singular(matrix: ArrayLike) -> Singular:
    """Take a matrix apart into a rotation, a stretch along the axes, and a rotation.

    Parameters
    ----------
    matrix : (..., n, n) float

    Returns
    -------
    Singular
        after, before : (..., n, n), factors : (..., n) float64

    **Source**: FoCG 6.1.6, singular value decomposition; the mirror that it may leave in a rotation is moved to the least factor.
    """
    left, factors, right = np.linalg.svd(np.asarray(matrix, dtype=np.float64))
    after, before = _without_mirror(left), _without_mirror(np.swapaxes(right, -1, -2))
    mirrored = np.sign(np.linalg.det(left) * np.linalg.det(right))
    factors[..., -1] *= mirrored
    return Singular(after, factors, before)


def _without_mirror(axes: Matrix) -> Matrix:
    """Columns at right angles as a right-handed frame: the last is turned round where they are not."""
    axes = np.array(axes)
    axes[..., :, -1] *= np.sign(np.linalg.det(axes))[..., None]
    return axes


def polar(matrix: ArrayLike) -> Polar:
    """Take a matrix apart into a stretch and the rotation nearest to it.

    Parameters
    ----------
    matrix : (..., n, n) float
        Linear; of a 4x4 affine matrix, hand over ``M[:3, :3]``.

    Returns
    -------
    Polar
        rotation, stretch : (..., n, n) float64

    **Source**: Higham, *Computing the Polar Decomposition, with Applications*, SIAM Journal on Scientific and Statistical Computing
    7(4), 1986, 2: Q = U V^T and P = V S V^T from the singular values, which singular matrices have too.
    """
    left, factors, right = np.linalg.svd(np.asarray(matrix, dtype=np.float64))
    return Polar(left @ right, (np.swapaxes(right, -1, -2) * factors[..., None, :]) @ right)


def trs(matrix: ArrayLike) -> TRS:
    """Take an affine matrix apart into translation, rotation and scale along the axes.

    Parameters
    ----------
    matrix : (..., 4, 4) float

    Returns
    -------
    TRS
        translation, size : (..., 3); rotation : (..., 4) float64

    Raises
    ------
    SceneError
        The matrix has shear, which these three cannot say.

    Examples
    --------
    >>> trs(np.diag([2.0, 3.0, 4.0, 1.0])).size.tolist()
    [2.0, 3.0, 4.0]

    **Source**: FoCG 6.1.5; Shoemake and Duff, *Matrix Animation and Polar Decomposition*, Graphics Interface 1992.
    """
    given = np.asarray(matrix, dtype=np.float64)
    linear = given[..., :3, :3]
    size = np.linalg.norm(linear, axis=-2)
    axes = linear / np.where(size > 0.0, size, 1.0)[..., None, :]
    cosines = np.swapaxes(axes, -1, -2) @ axes * (1.0 - np.eye(3))
    off = float(np.max(np.abs(cosines), initial=0.0))
    if not off <= _SHEAR:
        raise SceneError(f"a matrix with shear is no translation, rotation and scale: its axes are off a right angle by {off:.2g}")
    # Axes of length zero are filled in so that the frame is complete; the nearest rotation takes the last rounding away.
    rotation = polar(axes).rotation
    mirrored = np.linalg.det(rotation) < 0.0
    sign = np.stack([np.where(mirrored, -1.0, 1.0), *np.ones((2, *mirrored.shape))], axis=-1)
    return TRS(given[..., :3, 3].copy(), quaternion.from_matrix(rotation * sign[..., None, :]), size * sign)


def interpolate(start: ArrayLike, end: ArrayLike, t: ArrayLike) -> Matrix:
    """Move from one affine transformation to another without a detour: rotations turn at constant speed, the rest goes straight.

    Parameters
    ----------
    start, end : (..., 4, 4) float
        Neither or both mirrored; shear is allowed.
    t : (...) float
        0: `start`, 1: `end`.

    Returns
    -------
    (..., 4, 4) float64

    **Source**: Shoemake and Duff 1992: polar factors, of which the rotations are interpolated as quaternions.
    """
    a, b = (np.asarray(matrix, dtype=np.float64) for matrix in (start, end))
    (turn_a, stretch_a), (turn_b, stretch_b) = polar(a[..., :3, :3]), polar(b[..., :3, :3])
    sign_a, sign_b = (np.where(np.linalg.det(turn) < 0.0, -1.0, 1.0)[..., None, None] for turn in (turn_a, turn_b))
    if not np.all(sign_a == sign_b):
        raise SceneError("a mirrored transformation cannot be reached from one that is not without flattening space on the way")
    turns = quaternion.slerp(quaternion.from_matrix(sign_a * turn_a), quaternion.from_matrix(sign_b * turn_b), t)
    share = np.asarray(t, dtype=np.float64)[..., None]
    stretch = sign_a * stretch_a + share[..., None] * (sign_b * stretch_b - sign_a * stretch_a)
    moved = a[..., :3, 3] + share * (b[..., :3, 3] - a[..., :3, 3])
    return affine(quaternion.to_matrix(turns) @ stretch, moved)


def shears(angle: ArrayLike) -> tuple[Matrix, Matrix, Matrix]:
    """Turn the plane by three shears, each of which only slides rows or columns of pixels.

    Parameters
    ----------
    angle : (...) float
        Radians; not half a turn, which the formula does not reach, and gentle only to a quarter turn.

    Returns
    -------
    three (..., 2, 2) float64
        Shears along x, y and x again: ``rotate(angle) = first @ second @ third``.

    **Source**: Paeth, *A Fast Algorithm for General Raster Rotation*, Graphics Interface 1986; FoCG 6.1.6.
    """
    phi = np.asarray(angle, dtype=np.float64)
    along_x = -np.tan(phi / 2.0)
    if not np.all(np.abs(along_x) < 1e9):
        raise SceneError("half a turn cannot be made of three shears")
    return transform2d.shear_x(along_x), transform2d.shear_y(np.sin(phi)), transform2d.shear_x(along_x)
