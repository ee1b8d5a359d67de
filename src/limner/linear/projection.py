"""Projection and camera transformations: from the world to the canonical view volume (FoCG 7.1.2, 7.1.3, 7.3).

    clip_from_world = clip_from_camera @ camera_from_world

`orthographic` and `perspective` are the book's matrices with the book's signs: the camera looks along -z, so the near and far
planes stand at *negative* z, 0 > n > f, and M_per gives w = z < 0 for what is visible. The rest of limner takes positive
distances and ``clip_from_camera = -M_per``: the same picture, with w = -z > 0 for what is visible. In both, normalised depth is
+1 on the near and -1 on the far plane: greater is nearer.
"""

from __future__ import annotations

import math
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .project import Lens

__all__ = [
    "camera_from_world", "clip_from_camera", "clip_from_camera_orthographic", "clip_from_camera_perspective", "off_centre",
    "orthographic", "perspective",
]  # fmt: skip

Matrix = NDArray[np.float64]


class PlacedCamera(Protocol):
    """What a camera must tell: where it stands, the shape of its picture if it insists on one, and what its lens shows."""

    @property
    def world_from_camera(self) -> Matrix: ...
    @property
    def aspect(self) -> float | None: ...
    def lens(self) -> Lens: ...


@runtime_checkable
class PinholeCamera(Protocol):
    """A camera whose view widens with the distance; tells half its height at distance 1."""

    def half_height(self) -> float: ...


def orthographic(l: float, r: float, b: float, t: float, n: float, f: float) -> Matrix:  # noqa: E741 - the book's letters
    """Map the box [l, r] x [b, t] x [f, n] to [-1, 1]^3.

    Parameters
    ----------
    l, r, b, t : float
        Left, right, bottom and top of the view volume.
    n, f : float
        z of the near and the far plane; n > f, for the camera looks along -z.

    Returns
    -------
    (4, 4) float64
        M_orth.

    **Source**: FoCG 7.1.2.
    """
    _check_sides(l, r, b, t)
    if not n > f:
        raise SceneError(f"the near plane must stand before the far plane (n > f along z), got n = {n}, f = {f}")
    matrix = np.diag([2.0 / (r - l), 2.0 / (t - b), 2.0 / (n - f), 1.0])
    matrix[:3, 3] = -(r + l) / (r - l), -(t + b) / (t - b), -(n + f) / (n - f)
    return matrix


def perspective(l: float, r: float, b: float, t: float, n: float, f: float) -> Matrix:  # noqa: E741 - the book's letters
    """Map the truncated pyramid over [l, r] x [b, t] at z = n, which reaches to z = f, to [-1, 1]^3 after the divide.

    Parameters
    ----------
    l, r, b, t : float
        Sides of the view volume on the near plane.
    n, f : float
        z of the near and the far plane, both negative: 0 > n > f.

    Returns
    -------
    (4, 4) float64
        M_per; w = z, negative for what is visible.

    **Source**: FoCG 7.3.
    """
    _check_sides(l, r, b, t)
    if not 0.0 > n > f:
        raise SceneError(f"the book's near and far planes must satisfy 0 > n > f, got n = {n}, f = {f}")
    return np.array(
        [
            [2.0 * n / (r - l), 0.0, (l + r) / (l - r), 0.0],
            [0.0, 2.0 * n / (t - b), (b + t) / (b - t), 0.0],
            [0.0, 0.0, (f + n) / (n - f), 2.0 * f * n / (f - n)],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )


def _check_sides(left: float, right: float, bottom: float, top: float) -> None:
    if not (left != right and bottom != top and all(map(math.isfinite, (left, right, bottom, top)))):
        raise SceneError(f"a view volume must have width and height, got [{left}, {right}] x [{bottom}, {top}]")


def clip_from_camera_perspective(half_height: float, aspect: float, near: float, far: float = math.inf) -> Matrix:
    """Project a symmetric pyramid: -M_per for n = -near, f = -far.

    Parameters
    ----------
    half_height : float > 0
        Half the picture's height at distance 1: the tangent of half the vertical field of view.
    aspect : float > 0
        Width / height.
    near, far : float
        Distances along the gaze, 0 < near < far; far may be infinite, which is the limit of the matrix.

    Returns
    -------
    (4, 4) float64
        w = -z, the depth, positive for what is visible; z/w is +1 at `near` and -1 at `far`.

    Examples
    --------
    >>> x, y, z, w = clip_from_camera_perspective(0.5, 2.0, 1.0) @ [10.0, 5.0, -10.0, 1.0]
    >>> float(x / w), float(y / w), float(w)
    (1.0, 1.0, 10.0)

    **Source**: FoCG 7.3.
    """
    _check_view(half_height, aspect)
    if not 0.0 < near < far:
        raise SceneError(f"camera.near must be positive and less than camera.far, got near {near}, far {far}")
    # Divided through by far, so that the limit far -> inf is the same formula.
    ratio = near / far
    matrix = np.diag([1.0 / (aspect * half_height), 1.0 / half_height, (1.0 + ratio) / (1.0 - ratio), 0.0])
    matrix[2, 3], matrix[3, 2] = 2.0 * near / (1.0 - ratio), -1.0
    return matrix


def clip_from_camera_orthographic(half_height: float, aspect: float, near: float, far: float) -> Matrix:
    """Project a symmetric box: M_orth for n = -near, f = -far; w = 1.

    Parameters
    ----------
    half_height : float > 0
        Half of what the picture shows from bottom to top, metres.
    aspect : float > 0
        Width / height.
    near, far : float
        Distances along the gaze, near < far, both finite; `near` may lie behind the camera.

    Returns
    -------
    (4, 4) float64
        z is +1 at `near` and -1 at `far`.

    **Source**: FoCG 7.1.2.
    """
    _check_view(half_height, aspect)
    if not (near < far and math.isfinite(near) and math.isfinite(far)):
        raise SceneError(f"camera.near must be less than camera.far, both finite, got near {near}, far {far}")
    half_width = aspect * half_height
    return orthographic(-half_width, half_width, -half_height, half_height, -near, -far)


def _check_view(half_height: float, aspect: float) -> None:
    if not (0.0 < half_height < math.inf and 0.0 < aspect < math.inf):
        raise SceneError(f"a view must have a positive finite height and aspect, got {half_height} and {aspect}")


def off_centre(clip_from_camera: Matrix, shift_x: float, shift_y: float) -> Matrix:
    """Move the window over the picture plane: what stood at (shift_x, shift_y) of the canonical square comes to its middle.

    Parameters
    ----------
    clip_from_camera : (4, 4) float64
        A projection with a window around the gaze.
    shift_x, shift_y : float
        In half widths and half heights of the window.

    Returns
    -------
    (4, 4) float64
        The book's projections for l = (shift_x - 1) r_0, r = (shift_x + 1) r_0 and so on, r_0 being half the centred window.

    **Source**: FoCG 7.1.2, 7.3, whose windows may lie anywhere.
    """
    moved = clip_from_camera.copy()
    moved[0] -= shift_x * clip_from_camera[3]
    moved[1] -= shift_y * clip_from_camera[3]
    return moved


def clip_from_camera(camera: PlacedCamera, width: int, height: int, near: float, far: float) -> Matrix:
    """Project as a camera of the scene does.

    Parameters
    ----------
    camera : PerspectiveCamera or OrthographicCamera
        Its own `aspect` goes before that of the picture.
    width, height : int >= 1
        Pixels.
    near, far : float
        Distances along the gaze; the camera's own are for the caller to choose from.

    Returns
    -------
    (4, 4) float64

    **Source**: FoCG 7.1.2, 7.3.
    """
    if width < 1 or height < 1:
        raise SceneError(f"a picture must be at least 1 pixel wide and high, got {width} x {height}")
    half_height, pixel_aspect, shift_x, shift_y = camera.lens()
    aspect = width / height * pixel_aspect if camera.aspect is None else camera.aspect
    project = clip_from_camera_perspective if isinstance(camera, PinholeCamera) else clip_from_camera_orthographic
    return off_centre(project(half_height, aspect, near, far), shift_x, shift_y)


def camera_from_world(camera: PlacedCamera | ArrayLike) -> Matrix:
    """Invert the camera's frame.

    Parameters
    ----------
    camera : a camera, or its (4, 4) world_from_camera
        A rigid frame is inverted by its transpose, exactly; one with scale or shear by elimination.

    Returns
    -------
    (4, 4) float64
        M_cam.

    **Source**: FoCG 7.1.3: the inverse of the frame [u v w e], that is its rotation transposed after the move by -e.
    """
    frame = np.asarray(getattr(camera, "world_from_camera", camera), dtype=np.float64)
    axes = frame[:3, :3]
    if not np.allclose(axes.T @ axes, np.eye(3), rtol=0.0, atol=1e-12):
        return np.linalg.inv(frame).astype(np.float64)
    matrix = np.eye(4)
    matrix[:3, :3] = axes.T
    matrix[:3, 3] = -axes.T @ frame[:3, 3]
    return matrix
