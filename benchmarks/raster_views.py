"""The eyes, the light and the encoding that all renderers of the raster benchmark share.

It is read in the peers' environments, too, which have NumPy but no limner: what either needs is imported where it is used.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from raster_job import TOWARDS_LIGHT, UP, YFOV_DEGREES, Job


def camera_from_world(job: Job, view: int) -> NDArray[Any]:
    return np.linalg.inv(world_from_frame(np.array(job.eyes[view]), np.array(job.target)))


def world_from_frame(eye: NDArray[Any], target: NDArray[Any]) -> NDArray[Any]:
    """(4, 4): world from what looks along its -z, +y up."""
    w = (eye - target) / np.linalg.norm(eye - target)
    u = np.cross(UP, w)
    u /= np.linalg.norm(u)
    return np.vstack([np.column_stack([u, np.cross(w, u), w, eye]), [0.0, 0.0, 0.0, 1.0]])


def light_frame() -> NDArray[Any]:
    return world_from_frame(np.array(TOWARDS_LIGHT), np.zeros(3))


def clip_from_camera(job: Job) -> NDArray[Any]:
    """(4, 4): OpenGL's clip space from the camera."""
    y = 1.0 / math.tan(math.radians(YFOV_DEGREES) / 2.0)
    near, far = job.near, job.far
    depth = [0.0, 0.0, -(far + near) / (far - near), -2.0 * far * near / (far - near)]
    return np.array([[y * job.height / job.width, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], depth, [0.0, 0.0, -1.0, 0.0]])


def encoded(linear: NDArray[Any]) -> NDArray[Any]:
    """(..., 3 or 4): sRGB of linear light; alpha as it is."""
    values = np.clip(linear, 0.0, 1.0)
    rgb = values[..., :3]
    values[..., :3] = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * np.maximum(rgb, 0.0031308) ** (1.0 / 2.4) - 0.055)
    return values
