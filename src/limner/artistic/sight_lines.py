"""From the world to the picture, along the lines of sight (FoCG 7): x to the right and y down from the top left corner, in pixels.

Behind both projections stands one number q that is linear along straight lines of the *picture*, and greater where it is nearer: 1/depth
in perspective, and with parallel lines of sight the depth itself, in pixels, turned round. With it, what hides what is a question of
linear functions.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linear.projection import camera_from_world
from ..scene.camera import Camera, PerspectiveCamera

__all__ = ["SightLines", "sight_lines"]

Floats = NDArray[np.float64]

_NEAR = 1e-6  # of the farthest depth, where a perspective camera has no near plane of its own


class SightLines(NamedTuple):
    """A camera and the size of its picture.

    Attributes
    ----------
    matrix : (4, 4) float64
        Camera from world.
    eye, back : (3,) float64
        World: where it stands, and the direction against its gaze.
    K : (3, 3) float64
        To pixels from the picture's corner.
    perspective : bool
    near, far : float
        Depths between which lines are drawn; -inf, inf: all.
    width, height : int
    """

    matrix: Floats
    eye: Floats
    back: Floats
    K: Floats
    perspective: bool
    near: float
    far: float
    width: int
    height: int

    @property
    def pixels(self) -> float:
        """Pixels per metre, at distance 1 (perspective) or anywhere (parallel)."""
        return float(max(self.K[0, 0], self.K[1, 1]))

    def towards(self, points: Floats) -> Floats:
        """Vectors from points of the world, (n, 3), to the eye, of any length."""
        return self.eye - points if self.perspective else np.broadcast_to(self.back, points.shape)

    def depths(self, points: Floats) -> Floats:
        """-z in the camera's space."""
        m = self.matrix
        # Term by term, and not as a product of matrices, whose rounding depends on how many points there are.
        return -(points[..., 0] * m[2, 0] + points[..., 1] * m[2, 1] + points[..., 2] * m[2, 2] + m[2, 3])

    def pixel_at(self, points: Floats) -> Floats:
        """What a pixel measures at points, (n, 3), across the gaze, metres."""
        if not self.perspective:
            return np.full(points.shape[:-1], 1.0 / self.pixels)
        return np.asarray(np.maximum(self.depths(points), max(self.near, 1e-300)) / self.pixels)

    def project(self, points: Floats) -> Floats:
        """(..., 3) float64: x, y and q of points that lie before the near plane; equal points get equal bits."""
        m, x, y, z = self.matrix, points[..., 0], points[..., 1], points[..., 2]
        depth = self.depths(points)
        across = (x * m[0, 0] + y * m[0, 1] + z * m[0, 2] + m[0, 3]) * self.K[0, 0]
        down = (x * m[1, 0] + y * m[1, 1] + z * m[1, 2] + m[1, 3]) * -self.K[1, 1]
        if not self.perspective:
            return np.stack([across + self.K[0, 2], down + self.K[1, 2], depth * -self.pixels], axis=-1)
        q = 1.0 / depth
        return np.stack([across * q + self.K[0, 2], down * q + self.K[1, 2], q], axis=-1)

    def depth_of(self, q: Floats) -> Floats:
        """Depths, metres, of values of q."""
        return 1.0 / q if self.perspective else q / -self.pixels


def sight_lines(camera: Camera, width: int, height: int, points: Floats) -> SightLines:
    """Read a camera that stands still; `points`, (n, 3), are all that it may see."""
    matrix = camera_from_world(camera)
    perspective = isinstance(camera, PerspectiveCamera)
    place = np.asarray(camera.world_from_camera, dtype=np.float64)
    K = camera.intrinsics(width, height)  # noqa: N806 - as it is known
    K[:2, 2] += 0.5
    made = SightLines(matrix, place[:3, 3], place[:3, 2] / np.linalg.norm(place[:3, 2]), K, perspective, -math.inf, math.inf, width, height)
    near = -math.inf if camera.near is None else camera.near
    if perspective and camera.near is None:
        near = max(_NEAR * float(made.depths(points).max(initial=0.0)), 1e-30)
    return made._replace(near=near, far=math.inf if camera.far is None else camera.far)
