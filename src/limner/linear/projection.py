"""Projection and camera transformations: from the world to the canonical view volume (FoCG 7.1.2, 7.1.3, 7.3).

    clip_from_world = clip_from_camera @ camera_from_world

`orthographic` and `perspective` are the book's matrices with the book's signs: the camera looks along -z, so the near and far
planes stand at *negative* z, 0 > n > f, and M_per gives w = z < 0 for what is visible. The rest of limner takes positive
distances and ``clip_from_camera = -M_per``: the same picture, with w = -z > 0 for what is visible. In both, normalised depth is
+1 on the near and -1 on the far plane: greater is nearer. `depth_range` turns that into what others expect.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .inverse import inverse_rigid
from .project import Lens

__all__ = [
    "Window", "cabinet", "camera_from_world", "cavalier", "clip_from_camera", "clip_from_camera_orthographic",
    "clip_from_camera_perspective", "depth_range", "divided", "frustum_from_fov", "inverse_projection", "oblique", "off_centre",
    "orthographic", "perspective", "resized",
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


class Window(NamedTuple):
    """The sides of a view volume on its near plane (perspective) or anywhere (parallel): the book's l, r, b, t."""

    left: float
    right: float
    bottom: float
    top: float


def frustum_from_fov(yfov: float, aspect: float, n: float) -> Window:
    """Find the sides of a pyramid around the gaze from its field of view.

    Parameters
    ----------
    yfov : float in (0, pi)
        The full vertical angle, radians.
    aspect : float > 0
        Width / height: n_x / n_y for square pixels.
    n : float < 0
        z of the near plane.

    Returns
    -------
    Window
        For ``perspective(*window, n, f)``.

    Examples
    --------
    >>> [round(side, 12) for side in frustum_from_fov(math.radians(90), 1.5, -2.0)]
    [-3.0, 3.0, -2.0, 2.0]

    **Source**: FoCG 7.5: tan(yfov / 2) = t / |n|, l = -r, b = -t, n_x / n_y = r / t.
    """
    if not 0.0 < yfov < math.pi:
        raise SceneError(f"a field of view must lie between 0 and pi radians, got {yfov}")
    if not n < 0.0:
        raise SceneError(f"the book's near plane must stand at negative z, got n = {n}")
    top = math.tan(yfov / 2.0) * -n
    _check_view(top, aspect)
    return Window(-aspect * top, aspect * top, -top, top)


def resized(window: Window, width: int, height: int) -> Window:
    """Fit a window to a picture of another shape: what it shows from bottom to top stays, and pixels become square.

    Parameters
    ----------
    window : Window
        Of any kind; the side where it lies off the gaze stays in proportion.
    width, height : int >= 1
        The picture's new size in pixels.

    Returns
    -------
    Window
        Its left and right moved towards or away from the middle between them.

    **Source**: FoCG 7.5, n_x / n_y = r / t, which keeps the vertical field of view.
    """
    if width < 1 or height < 1:
        raise SceneError(f"a picture must be at least 1 pixel wide and high, got {width} x {height}")
    _check_sides(*window)
    middle_share = (window.left + window.right) / (window.right - window.left)
    half_width = (window.top - window.bottom) / 2.0 * width / height
    middle = middle_share * half_width
    return Window(middle - half_width, middle + half_width, window.bottom, window.top)


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


def oblique(angle: float, foreshortening: float = 1.0) -> Matrix:
    """Lean parallel projection over: lines that run away from the viewer are drawn slanting, and what faces the viewer keeps its shape.

    Parameters
    ----------
    angle : float
        Radians; where such lines point in the picture, counter-clockwise from the right.
    foreshortening : float
        The length in the picture of one unit along them.

    Returns
    -------
    (4, 4) float64
        A shear of camera space, for ``orthographic(...) @ oblique(...)``; points with z = 0 stay.

    Examples
    --------
    >>> (cavalier(0.0) @ [0, 0, -2, 1]).tolist()
    [2.0, 0.0, -2.0, 1.0]

    **Source**: FoCG 7.1.2 after 6.2: shear-z applied to x and y; Carlbom and Paciorek, *Planar Geometric Projections and Viewing
    Transformations*, ACM Computing Surveys 10(4), 1978, 3.2.
    """
    matrix = np.eye(4)
    matrix[0, 2], matrix[1, 2] = -foreshortening * math.cos(angle), -foreshortening * math.sin(angle)
    return matrix


def cavalier(angle: float = math.radians(45.0)) -> Matrix:
    """(4, 4) float64: oblique projection in true lengths. **Source**: Carlbom and Paciorek 1978, 3.2."""
    return oblique(angle, 1.0)


def cabinet(angle: float = math.radians(45.0)) -> Matrix:
    """(4, 4) float64: oblique projection at half lengths, as furniture is drawn. **Source**: Carlbom and Paciorek 1978, 3.2."""
    return oblique(angle, 0.5)


def depth_range(at_near: float, at_far: float) -> Matrix:
    """Say normalised depth as others do: ``depth_range(...) @ clip_from_camera``.

    Parameters
    ----------
    at_near, at_far : float
        OpenGL: -1, 1; Direct3D and Vulkan: 0, 1; reversed depth: 1, 0, which with `far` infinite is near / depth, and which
        floating-point numbers hold about equally well at every distance; the book and limner: 1, -1.

    Returns
    -------
    (4, 4) float64
        For clip space with w > 0.

    Examples
    --------
    >>> clip = depth_range(1, 0) @ clip_from_camera_perspective(1.0, 1.0, near=0.5) @ [0, 0, -10.0, 1]
    >>> float(clip[2] / clip[3])
    0.05

    **Source**: FoCG 7.3, the windowing transformation of 6.3 along z; Reed, *Depth Precision Visualized*, 2015, for the reversed one.
    """
    matrix = np.eye(4)
    matrix[2, 2], matrix[2, 3] = (at_near - at_far) / 2.0, (at_near + at_far) / 2.0
    return matrix


def inverse_projection(clip_from_camera: ArrayLike) -> Matrix:
    """Invert a projection by its structure: z and w are found from each other, x and y from them.

    Parameters
    ----------
    clip_from_camera : (4, 4) float
        Any product of this page's projections, parallel or perspective, leaning or off centre, near or infinite far plane.

    Returns
    -------
    (4, 4) float64
        camera_from_clip.

    **Source**: FoCG 6.4, 7.3.
    """
    m = np.asarray(clip_from_camera, dtype=np.float64)
    (a, _, c, p), (_, b, d, q), (_, _, e, g), (_, _, h, k) = m.tolist()
    determinant = e * k - g * h
    if m[:, :2].tolist() != [[a, 0.0], [0.0, b], [0.0, 0.0], [0.0, 0.0]] or a * b * determinant == 0.0:
        raise SceneError("a projection must scale x and y apart from each other, and not flatten depth, to be inverted")
    back = np.zeros((4, 4))
    back[2, 2:] = k / determinant, -g / determinant
    back[3, 2:] = -h / determinant, e / determinant
    back[0] = -(c * back[2] + p * back[3]) / a
    back[1] = -(d * back[2] + q * back[3]) / b
    back[0, 0], back[1, 1] = 1.0 / a, 1.0 / b
    return back


def divided(homogeneous: ArrayLike) -> Matrix:
    """Divide homogeneous points by their last number.

    Parameters
    ----------
    homogeneous : (..., n + 1) float

    Returns
    -------
    (..., n) float64
        NaN where that number is 0: such points are directions.

    **Source**: FoCG 7.2.
    """
    given = np.asarray(homogeneous, dtype=np.float64)
    w = given[..., -1:]
    return given[..., :-1] / np.where(w == 0.0, math.nan, w)


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
    return inverse_rigid(frame)
