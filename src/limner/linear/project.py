"""From points to pixels and back, in the numbers that computer vision writes down (FoCG 7).

Whoever measures with pictures does not speak of view volumes but of a matrix K in pixels:

        | fx  0   cx |        x = fx X / Z + cx        (fx, fy) focal length in pixels
    K = | 0   fy  cy |        y = fy Y / Z + cy        (cx, cy) where the gaze meets the picture
        | 0   0   1  |

with X right, Y *down*, Z forward, and with pixels as arrays count them: x the column, y the row from the top, centres at integers.
A `Lens` says the same free of any picture size; the two functions that turn one into the other, and those that use K, stand here.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError

__all__ = ["Lens", "check_size", "intrinsics", "lens_from_intrinsics", "pixels_from_world", "world_from_pixels"]

Matrix = NDArray[np.float64]

_SKEW = 1e-9  # of the focal length: what rounding leaves where there is none


class Lens(NamedTuple):
    """What a camera shows, whatever the number of pixels.

    Attributes
    ----------
    half_height : float
        Half the picture's height, at distance 1 (perspective) or in metres (orthographic).
    pixel_aspect : float
        Width / height of a pixel.
    shift_x, shift_y : float
        Where the picture's middle lies, seen from the point that the gaze meets: right and up, in half widths and half heights.
    """

    half_height: float
    pixel_aspect: float = 1.0
    shift_x: float = 0.0
    shift_y: float = 0.0


def intrinsics(lens: Lens, width: int, height: int) -> Matrix:
    """Return K for a picture of the given size.

    Parameters
    ----------
    lens : Lens
    width, height : int >= 1
        Pixels.

    Returns
    -------
    (3, 3) float64

    Examples
    --------
    >>> intrinsics(Lens(0.5), 640, 480).tolist()
    [[480.0, 0.0, 319.5], [0.0, 480.0, 239.5], [0.0, 0.0, 1.0]]

    **Source**: Hartley and Zisserman, *Multiple View Geometry in Computer Vision*, 2nd edition, 2004, 6.1 (their 6.9, without skew).
    """
    check_size(width, height)
    fy = height / (2.0 * lens.half_height)
    cx = (width - 1) / 2.0 - lens.shift_x * width / 2.0
    cy = (height - 1) / 2.0 + lens.shift_y * height / 2.0
    return np.array([[fy / lens.pixel_aspect, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def lens_from_intrinsics(matrix: ArrayLike, width: int, height: int) -> Lens:
    """Read a K that belongs to pictures of the given size.

    Parameters
    ----------
    matrix : (3, 3) float
        K, with pixel centres at integers.
    width, height : int >= 1
        Pixels.

    Raises
    ------
    SceneError
        K has another shape, is not finite, has a focal length that is not positive, or a last row that is not 0 0 1.
    UnsupportedError
        K has skew.
    """
    check_size(width, height)
    fx, skew, cx, lower, fy, cy = _checked(matrix)[:2].ravel().tolist()
    if not (fx > 0.0 and fy > 0.0):
        raise SceneError(f"K must have positive focal lengths K[0, 0] and K[1, 1], got {fx} and {fy}")
    if lower != 0.0:
        raise SceneError(f"K must be upper triangular, got K[1, 0] = {lower}")
    if abs(skew) > _SKEW * fx:
        raise UnsupportedError(
            f"K with skew (K[0, 1] = {skew}) is not supported: set it to 0 where it is noise, or resample the pictures without it"
        )
    return Lens(height / (2.0 * fy), fy / fx, ((width - 1) / 2.0 - cx) * 2.0 / width, (cy - (height - 1) / 2.0) * 2.0 / height)


def _checked(given: ArrayLike) -> Matrix:
    try:
        matrix = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"K must be a 3x3 matrix of numbers, got {given!r}") from None
    if matrix.shape != (3, 3):
        raise SceneError(f"K must be a 3x3 matrix, got shape {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise SceneError("K must be finite")
    if matrix[2].tolist() != [0.0, 0.0, 1.0]:
        raise SceneError(f"K must have 0 0 1 as its last row, got {matrix[2].tolist()}")
    return matrix


def pixels_from_world(points: ArrayLike, camera_from_world: Matrix, K: Matrix, *, perspective: bool) -> tuple[Matrix, Matrix]:
    """Project points.

    Parameters
    ----------
    points : (..., 3) float
        World space.
    camera_from_world : (4, 4) float64
        To a camera that looks along -z, y up.
    K : (3, 3) float64
    perspective : bool
        False: parallel projection, without the division by the depth.

    Returns
    -------
    xy : (..., 2) float64
        Column, and row from the top; NaN where a perspective camera has the point beside or behind its eye.
    depth : (...) float64
        Along the gaze, negative behind the eye.

    **Source**: Hartley and Zisserman 2004, 6.1, with the axes of y and z turned: X = x, Y = -y, Z = -z.
    """
    given = _shaped(points, 3, "points")
    with np.errstate(invalid="ignore", over="ignore"):  # what is not finite, or meets the eye, is seen nowhere
        p = given @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
        depth = -p[..., 2]
        xy = p[..., :2] * (K[0, 0], -K[1, 1])
        if perspective:
            xy /= np.where(depth > 0.0, depth, math.nan)[..., None]
        return xy + K[:2, 2], depth


def world_from_pixels(xy: ArrayLike, depth: ArrayLike, world_from_camera: Matrix, K: Matrix, *, perspective: bool) -> Matrix:
    """Find the points that are seen in pixels: the inverse of `pixels_from_world`.

    Parameters
    ----------
    xy : (..., 2) float
    depth : (...) float
        Along the gaze; broadcast against `xy`.
    world_from_camera : (4, 4) float64
    K : (3, 3) float64
    perspective : bool

    Returns
    -------
    (..., 3) float64
        NaN where the depth is not finite: nothing was seen there.
    """
    at, far = _shaped(xy, 2, "xy"), np.asarray(depth, dtype=np.float64)
    try:
        far = np.broadcast_to(far, np.broadcast_shapes(far.shape, at.shape[:-1]))[..., None]
    except ValueError:
        raise SceneError(f"depth must have the shape of xy without its last axis, got {far.shape} for {at.shape}") from None
    with np.errstate(invalid="ignore", over="ignore"):
        far = np.where(np.isfinite(far), far, math.nan)
        p_camera = (at - K[:2, 2]) / (K[0, 0], -K[1, 1]) * (far if perspective else np.ones_like(far))
        p_camera = np.concatenate([p_camera, -far], axis=-1)
        return np.asarray(p_camera @ world_from_camera[:3, :3].T + world_from_camera[:3, 3])


def _shaped(given: Any, n: int, name: str) -> Matrix:
    try:
        array = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be numbers of shape (..., {n}), got {type(given).__name__}") from None
    if array.ndim == 0 or array.shape[-1] != n:
        raise SceneError(f"{name} must have shape (..., {n}), got {array.shape}")
    return array


def check_size(width: int, height: int) -> None:
    """Refuse what is no picture size."""
    for name, value in (("width", width), ("height", height)):
        if not isinstance(value, (int, np.integer)) or value < 1:
            raise SceneError(f"{name} must be an integer of at least 1, got {value!r}")
