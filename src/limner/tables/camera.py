"""The camera as kernels read it: a ray for every raster point, and homogeneous raster coordinates for every vertex.

Both ways lead to the same pixel: the ray through raster point (x, y) is ``corner + x dx + y dy`` with one unit of depth per unit of
t, and a vertex p goes to ``(x w, y w, depth, w)`` with w its depth (perspective) or 1 (orthographic).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..linear.projection import camera_from_world, clip_from_camera_orthographic, clip_from_camera_perspective, off_centre
from ..linear.viewport import viewport
from ..scene.camera import Camera, PerspectiveCamera
from . import layouts

__all__ = ["camera_record", "near_and_far", "raster_from_world"]


def near_and_far(camera: Camera, bounds: NDArray[np.float64]) -> tuple[float, float]:
    """The camera's planes, or planes that cut nothing off.

    The z-buffer holds near/depth as float32, which is as fine near the horizon as before the eye, so the near plane may stand
    as close as it likes.
    """
    eye = np.asarray(camera.world_from_camera)[:3, 3]
    low, high = bounds
    bounded = bool(np.isfinite(bounds).all())
    reach = float(np.linalg.norm(np.maximum(np.abs(low - eye), np.abs(high - eye)))) if bounded else 1.0
    if isinstance(camera, PerspectiveCamera):
        far = camera.far if camera.far is not None else math.inf
        near = camera.near if camera.near is not None else min(max(1e-6 * reach, 1e-12), far / 2.0)
        return near, far
    nearest = camera.near if camera.near is not None else 0.0
    far = camera.far if camera.far is not None else max(2.0 * reach, 2.0 * nearest, 1e-3)
    near = camera.near if camera.near is not None else -far
    return near, far


def camera_record(camera: Camera, width: int, height: int, near: float, far: float) -> NDArray[np.void]:
    """A CAMERA array of length 1."""
    frame = np.asarray(camera.world_from_camera, dtype=np.float64)
    u, v, w, e = frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3]
    perspective = isinstance(camera, PerspectiveCamera)
    half_height, pixel_aspect, shift_x, shift_y = camera.lens()
    half_width = half_height * width / height * pixel_aspect
    dx, dy = u * (2.0 * half_width / width), v * (2.0 * half_height / height)
    centre = -w if perspective else np.zeros(3)
    made = np.zeros(1, dtype=layouts.CAMERA)
    row = made[0]
    row["position"], row["gaze"] = e, -w / np.linalg.norm(w)
    left, below = (width - 1 - shift_x * width) / 2.0, (height - 1 - shift_y * height) / 2.0
    row["corner"] = centre - dx * left - dy * below
    row["dx"], row["dy"] = dx, dy
    row["near"], row["far"] = near, far
    row["kind"] = layouts.PERSPECTIVE if perspective else layouts.ORTHOGRAPHIC
    row["width"], row["height"] = width, height
    if isinstance(camera, PerspectiveCamera) and camera.aperture_radius:
        row["aperture_radius"], row["focus_distance"] = camera.aperture_radius, camera.focus_distance
        row["blades"] = camera.blades or 0
    return made


def raster_from_world(camera: Camera, width: int, height: int, near: float, far: float) -> NDArray[np.float64]:
    """(4, 4) float64 to (x w, y w, depth, w): the book's viewport times projection times camera, with plain depth in row 2."""
    half_height, pixel_aspect, shift_x, shift_y = camera.lens()
    aspect = width / height * pixel_aspect
    project = clip_from_camera_perspective if isinstance(camera, PerspectiveCamera) else clip_from_camera_orthographic
    projection = off_centre(project(half_height, aspect, near, far), shift_x, shift_y)
    to_camera = camera_from_world(camera)
    matrix = viewport(width, height) @ projection @ to_camera
    matrix[2] = -to_camera[2]
    return np.asarray(matrix)
