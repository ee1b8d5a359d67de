"""Where a camera stands, as others write it (FoCG 6.4, 7.1.3).

    limner, OpenGL, glTF, Blender   world from camera    x right, y up,   looks along -z
    OpenCV, COLMAP                  camera from world    x right, y down, looks along +z

Between the two lie an inversion and a half turn about x. Others also write rotations as quaternions, and poses with six digits: what
is nearly rigid is made rigid, what is not is refused.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .quaternion import from_matrix
from .transform import compose_trs

__all__ = ["quaternion_from_rotation", "rigid", "rotation_from_quaternion", "turned"]

Matrix = NDArray[np.float64]

_EXACT = 1e-12  # what rounding leaves of R^T R = 1
_NEARLY = 1e-4  # what six digits, or 32 bits, leave of it


def rigid(pose: ArrayLike, name: str) -> Matrix:
    """Return a pose as the (4, 4) float64 rigid transformation that it is meant to be.

    Parameters
    ----------
    pose : (4, 4) or (3, 4) float
        Rotation and translation. A rotation that is one up to 1e-4 becomes the nearest exact one.
    name : str
        For the message.

    Raises
    ------
    SceneError
        Wrong shape, not finite, mirrored, scaled or sheared.

    **Source**: Golub and Van Loan, *Matrix Computations*, 4th edition, 2013, 6.4.1: the nearest rotation is U V^T of the singular
    value decomposition.
    """
    try:
        given = np.array(pose, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be a 4x4 or 3x4 matrix of numbers, got {pose!r}") from None
    if given.shape not in ((4, 4), (3, 4)):
        raise SceneError(f"{name} must be a 4x4 or 3x4 matrix, got shape {given.shape}")
    if not np.isfinite(given).all():
        raise SceneError(f"{name} must be finite")
    if len(given) == 4 and not np.allclose(given[3], (0.0, 0.0, 0.0, 1.0), rtol=0.0, atol=_NEARLY):
        raise SceneError(f"{name} must have 0 0 0 1 as its last row, got {given[3].tolist()}")
    made = np.eye(4)
    made[:3, 3] = given[:3, 3]
    made[:3, :3] = _rotation(given[:3, :3], name)
    return made


def _rotation(axes: Matrix, name: str) -> Matrix:
    off = float(np.abs(axes.T @ axes - np.eye(3)).max())
    if not off <= _NEARLY:
        raise SceneError(f"{name} must be rigid, without scale or shear: its axes are off by {off:.2g}")
    if np.linalg.det(axes) < 0.0:
        raise SceneError(f"{name} must be a rotation, not a reflection: its determinant is -1; turn two axes, not one")
    if off <= _EXACT:
        return axes
    left, _, right = np.linalg.svd(axes)
    return np.asarray(left @ right)


def turned(world_from_camera: Matrix) -> Matrix:
    """Turn a camera's own axes by half a turn about its x: y up becomes y down, and -z forward z forward; its own inverse."""
    return world_from_camera * (1.0, -1.0, -1.0, 1.0)


def rotation_from_quaternion(wxyz: ArrayLike, name: str) -> Matrix:
    """(3, 3) rotation of a quaternion (w, x, y, z), Hamilton's; it need not have length 1, but must have one."""
    q = _numbers(wxyz, 4, name)
    if not np.linalg.norm(q) > 0.0:
        raise SceneError(f"{name} must not be zero")
    return compose_trs((0.0, 0.0, 0.0), (q[1], q[2], q[3], q[0]), (1.0, 1.0, 1.0))[:3, :3]


def quaternion_from_rotation(rotation: Matrix) -> Matrix:
    """(4,) unit quaternion (w, x, y, z) of a rotation, its first number that is not zero positive."""
    x, y, z, w = from_matrix(rotation)
    q = np.array([w, x, y, z])
    return np.asarray(q * np.sign(q[np.flatnonzero(q)[0]]))


def _numbers(given: ArrayLike, n: int, name: str) -> Matrix:
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be {n} numbers, got {given!r}") from None
    if values.shape != (n,) or not np.isfinite(values).all():
        raise SceneError(f"{name} must be {n} finite numbers, got {values.tolist()}")
    return values
