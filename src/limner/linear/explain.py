"""The way of a point to its pixel, and of a pixel to its ray, step by step (FoCG 7).

    >>> from limner.scene.camera import PerspectiveCamera
    >>> camera = PerspectiveCamera.look_at((0, 0, 5), (0, 0, 0), yfov_degrees=90, near=1, far=9)
    >>> print(point_to_pixel(camera, (1, 2, 0), 200, 100))
    world    (1, 2, 0)
    camera   (1, 2, -5)               M_cam: the inverse of the camera's frame (7.1.3)
    clip     (0.5, 2, -4, 5)          -M_per: perspective, w is the depth (7.3)
    ndc      (0.1, 0.4, -0.8)         / w: the homogeneous divide (7.2)
    raster   (109.5, 69.5, -0.8)      M_vp: pixels, rows from the bottom (7.1.1)
    pixel    (109.5, 29.5)            n_y - 1 - y: rows from the top, as arrays are indexed (7.1.1)

Each step holds its matrix, so that the whole chain can be checked: ``raster_from_world = M_vp @ -M_per @ M_cam``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .affine import transform_points
from .project import check_size
from .projection import (
    PinholeCamera,
    PlacedCamera,
    camera_from_world,
    clip_from_camera_orthographic,
    clip_from_camera_perspective,
    divided,
    inverse_projection,
    off_centre,
)  # fmt: skip
from .viewport import inverse_viewport, rows_from_top, viewport

__all__ = ["Step", "Steps", "pixel_to_ray", "point_to_pixel"]

Matrix = NDArray[np.float64]

_NEAR = 0.01  # where neither camera nor caller says; x and y do not depend on it


class Step(NamedTuple):
    """One stop on the way.

    Attributes
    ----------
    space : str
        "object", "world", "camera", "clip", "ndc", "raster" or "pixel"; "ray" for a direction in the world.
    matrix_name : str
        As the book writes it; empty where the way begins.
    matrix : (4, 4) float64 or None
        What led here from the step before; None where it was no matrix but the divide.
    coordinates : tuple of float
        NaN where a perspective camera sees nothing: beside or behind the eye.
    formula : str
        What happened, in words.
    section : str
        Of the book.
    """

    space: str
    matrix_name: str
    matrix: Matrix | None
    coordinates: tuple[float, ...]
    formula: str
    section: str


class Steps(list[Step]):
    """The steps in their order; printed, a table."""

    def at(self, space: str) -> tuple[float, ...]:
        """The coordinates in one space."""
        for step in self:
            if step.space == space:
                return step.coordinates
        raise SceneError(f"space must be one of {', '.join(step.space for step in self)}, got {space!r}")

    def __str__(self) -> str:
        written = [f"({', '.join(_written(value) for value in step.coordinates)})" for step in self]
        column = max(24, *(len(text) for text in written))
        lines = []
        for step, text in zip(self, written, strict=True):
            reason = f"{step.matrix_name}: {step.formula} ({step.section})" if step.matrix_name else step.formula
            lines.append(f"{step.space:8} {text:{column}} {reason}".rstrip())
        return "\n".join(lines)


def _written(value: float) -> str:
    return f"{value + 0.0:.6g}" if abs(value) > 1e-12 or math.isnan(value) else "0"


def point_to_pixel(
    camera: PlacedCamera,
    point: ArrayLike,
    width: int,
    height: int,
    *,
    near: float | None = None,
    far: float | None = None,
    world_from_object: ArrayLike | None = None,
) -> Steps:
    """Follow a point from where it is to where it is seen.

    Parameters
    ----------
    camera : PerspectiveCamera or OrthographicCamera
    point : (3,) float
        In the world, or in the object's space if `world_from_object` is given.
    width, height : int >= 1
        Of the picture, in pixels.
    near, far : float, optional
        Distances along the gaze; None: the camera's own, else 0.01 and infinity (parallel projection: 0 and twice the point's depth).
    world_from_object : (4, 4) float, optional
        Affine: where the object stands.

    Returns
    -------
    Steps
        object (if asked for), world, camera, clip, ndc, raster (rows from the bottom), pixel (column, and row from the top).

    **Source**: FoCG 7.1-7.3.
    """
    p = _triple(point)
    steps = Steps()
    if world_from_object is not None:
        place = np.asarray(world_from_object, dtype=np.float64)
        steps.append(Step("object", "", None, _tuple(p), "", "6"))
        p = transform_points(place, p)
        steps.append(Step("world", "M", place, _tuple(p), "where the object stands", "6.3"))
    else:
        steps.append(Step("world", "", None, _tuple(p), "", "6"))
    to_camera = camera_from_world(camera)
    p_camera = transform_points(to_camera, p)
    steps.append(Step("camera", "M_cam", to_camera, _tuple(p_camera), "the inverse of the camera's frame", "7.1.3"))
    projection = _projection(camera, width, height, near, far, -float(p_camera[2]))
    p_clip = projection @ np.append(p_camera, 1.0)
    pinhole = isinstance(camera, PinholeCamera)
    if pinhole:
        steps.append(Step("clip", "-M_per", projection, _tuple(p_clip), "perspective, w is the depth", "7.3"))
    else:
        steps.append(Step("clip", "M_orth", projection, _tuple(p_clip), "parallel projection, w is 1", "7.1.2"))
    p_ndc = divided(p_clip) if p_clip[3] > 0.0 else np.full(3, math.nan)
    steps.append(Step("ndc", "/ w", None, _tuple(p_ndc), "the homogeneous divide" if p_clip[3] > 0.0 else _UNSEEN, "7.2"))
    to_raster, flip = viewport(width, height), rows_from_top(height)
    p_raster = transform_points(to_raster, p_ndc)
    steps.append(Step("raster", "M_vp", to_raster, _tuple(p_raster), "pixels, rows from the bottom", "7.1.1"))
    p_pixel = transform_points(flip, p_raster)[:2]
    steps.append(Step("pixel", "n_y - 1 - y", flip, _tuple(p_pixel), "rows from the top, as arrays are indexed", "7.1.1"))
    return steps


_UNSEEN = "not divided: the point lies beside or behind the eye (w <= 0)"


def pixel_to_ray(camera: PlacedCamera, x: float, y: float, width: int, height: int, *, near: float | None = None) -> Steps:
    """Go the way back: from a place in the picture to all that is seen there.

    Parameters
    ----------
    camera : PerspectiveCamera or OrthographicCamera
    x, y : float
        Column, and row from the top; pixel centres are integers.
    width, height : int >= 1
        Of the picture, in pixels.
    near : float, optional
        Where on the ray the way back passes; None: the camera's own near plane, else 0.01 (parallel projection: 0).

    Returns
    -------
    Steps
        pixel, raster, ndc, clip, camera (on the near plane), world (the same point), ray (unit direction in the world, from the
        eye; for parallel projection from the point in the world).

    Examples
    --------
    >>> from limner.scene.camera import PerspectiveCamera
    >>> steps = pixel_to_ray(PerspectiveCamera(yfov_degrees=90), 49.5, -0.5, 100, 100)
    >>> [round(number, 6) for number in steps.at("ray")]
    [0.0, 0.707107, -0.707107]

    **Source**: FoCG 4.3, 6.4, 7.1-7.3.
    """
    projection = _projection(camera, width, height, near, None, 1.0)
    flip, from_raster, back, frame = rows_from_top(height), inverse_viewport(width, height), inverse_projection(projection), _frame(camera)
    p_pixel = np.array([float(x), float(y), 1.0])  # depth 1: on the near plane
    p_raster = transform_points(flip, p_pixel)
    p_ndc = transform_points(from_raster, p_raster)
    pinhole = isinstance(camera, PinholeCamera)
    unscaled = back @ np.append(p_ndc, 1.0)
    p_clip = np.append(p_ndc, 1.0) / unscaled[3]
    p_camera = (back @ p_clip)[:3]
    p_world = transform_points(frame, p_camera)
    direction = frame[:3, :3] @ (p_camera if pinhole else np.array([0.0, 0.0, -1.0]))
    name, section = ("-M_per^-1", "7.3") if pinhole else ("M_orth^-1", "7.1.2")
    start = "the eye" if pinhole else "the point in the world"
    return Steps(
        [
            Step("pixel", "", None, _tuple(p_pixel[:2]), "", "7.1.1"),
            Step("raster", "n_y - 1 - y", flip, _tuple(p_raster), "rows from the bottom; z = 1 is the near plane", "7.1.1"),
            Step("ndc", "M_vp^-1", from_raster, _tuple(p_ndc), "the canonical square", "7.1.1"),
            Step("clip", "* w", None, _tuple(p_clip), "the divide undone", "7.2"),
            Step("camera", name, back, _tuple(p_camera), "on the near plane", section),
            Step("world", "M_cam^-1", frame, _tuple(p_world), "the camera's frame", "7.1.3"),
            Step("ray", "d", None, _tuple(direction / np.linalg.norm(direction)), f"the direction from {start}", "4.3"),
        ]
    )


def _projection(camera: PlacedCamera, width: int, height: int, near: float | None, far: float | None, depth: float) -> Matrix:
    """The matrix of `clip_from_camera`, with planes where nobody has said any."""
    check_size(width, height)
    half_height, pixel_aspect, shift_x, shift_y = camera.lens()
    aspect = width / height * pixel_aspect
    near = getattr(camera, "near", None) if near is None else near
    far = getattr(camera, "far", None) if far is None else far
    if isinstance(camera, PinholeCamera):
        far = math.inf if far is None else far
        made = clip_from_camera_perspective(half_height, aspect, min(_NEAR, far / 2.0) if near is None else near, far)
    else:
        near = (0.0 if far is None else min(0.0, far - 1.0)) if near is None else near
        far = near + 2.0 * max(abs(depth), 1.0) if far is None else far
        made = clip_from_camera_orthographic(half_height, aspect, near, far)
    return off_centre(made, shift_x, shift_y)


def _frame(camera: PlacedCamera) -> Matrix:
    return np.asarray(camera.world_from_camera, dtype=np.float64)


def _triple(point: ArrayLike) -> Matrix:
    try:
        p = np.asarray(point, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"a point must be three numbers, got {point!r}") from None
    if p.shape != (3,) or not np.isfinite(p).all():
        raise SceneError(f"a point must be three finite numbers, got {p.tolist()}")
    return p


def _tuple(values: Matrix) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
