"""Cameras (FoCG 7): where the eye stands, what it sees, and how that is thrown on the picture.

A camera looks along its own -z with +y up; `world_from_camera` places it. Both kinds hold what a person says; the matrices
follow in `limner.linear`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..linear import transform
from ._values import finite, matrix4, positive, triple

__all__ = ["Camera", "OrthographicCamera", "PerspectiveCamera"]


def _look_at(eye: Any, target: Any, up: Any) -> NDArray[np.float64]:
    e = np.array(triple(eye, "camera.eye"))
    g = np.array(triple(target, "camera.target")) - e
    t = np.array(triple(up, "camera.up"))
    if not np.linalg.norm(g) > 0.0:
        raise SceneError(f"camera.eye and camera.target must differ, both are {tuple(e.tolist())}")
    if not np.linalg.norm(np.cross(t, g)) > 1e-9 * np.linalg.norm(t) * np.linalg.norm(g):
        raise SceneError(f"camera.up must not be zero or along the gaze, got up {tuple(t.tolist())}, gaze {tuple(g.tolist())}")
    return transform.frame_from_gaze(e, g, t)


def _check(camera: Camera) -> None:
    matrix = matrix4(camera.world_from_camera, "camera.world_from_camera")
    if not abs(np.linalg.det(matrix[:3, :3])) > 0.0:
        raise SceneError("camera.world_from_camera must not be singular", camera.name)
    object.__setattr__(camera, "world_from_camera", matrix)
    if camera.near is not None:
        object.__setattr__(camera, "near", positive(camera.near, "camera.near"))
    if camera.far is not None:
        object.__setattr__(camera, "far", positive(camera.far, "camera.far"))
    if camera.near is not None and camera.far is not None and not camera.near < camera.far:
        raise SceneError(f"camera.near must be less than camera.far, got {camera.near} and {camera.far}", camera.name)


def _identity() -> NDArray[np.float64]:
    return np.eye(4)


@dataclass(frozen=True, eq=False)
class PerspectiveCamera:
    """A pinhole camera.

    Parameters
    ----------
    world_from_camera : (4, 4) float64
    yfov_degrees : float in (0, 180)
        The full vertical field of view.
    near, far : float > 0, optional
        Distances along the gaze; None: from the scene's bounds.
    aspect : float > 0, optional
        Width / height; None: that of the picture.
    """

    world_from_camera: NDArray[np.float64] = field(default_factory=_identity)
    yfov_degrees: float = 40.0
    near: float | None = None
    far: float | None = None
    aspect: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)
        yfov = finite(self.yfov_degrees, "camera.yfov_degrees")
        if not 0.0 < yfov < 180.0:
            raise SceneError(f"camera.yfov_degrees must lie between 0 and 180, got {yfov}", self.name)
        if self.aspect is not None:
            object.__setattr__(self, "aspect", positive(self.aspect, "camera.aspect"))

    @classmethod
    def look_at(cls, eye: Any, target: Any, up: Any = (0.0, 1.0, 0.0), **fields: Any) -> PerspectiveCamera:
        """Stand at `eye`, look at `target`, hold `up` upright: the book's frame w = -g/|g|, u = t x w / |t x w|, v = w x u."""
        return cls(world_from_camera=_look_at(eye, target, up), **fields)

    def half_height(self) -> float:
        """tan(yfov / 2): half the picture's height at distance 1."""
        return math.tan(math.radians(self.yfov_degrees) / 2.0)


@dataclass(frozen=True, eq=False)
class OrthographicCamera:
    """Parallel projection along -z.

    Parameters
    ----------
    world_from_camera : (4, 4) float64
    height : float > 0
        What the picture shows from bottom to top, metres.
    near, far : float > 0, optional
    aspect : float > 0, optional
        Width / height; None: that of the picture.
    """

    world_from_camera: NDArray[np.float64] = field(default_factory=_identity)
    height: float = 2.0
    near: float | None = None
    far: float | None = None
    aspect: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)
        object.__setattr__(self, "height", positive(self.height, "camera.height"))
        if self.aspect is not None:
            object.__setattr__(self, "aspect", positive(self.aspect, "camera.aspect"))

    @classmethod
    def look_at(cls, eye: Any, target: Any, up: Any = (0.0, 1.0, 0.0), **fields: Any) -> OrthographicCamera:
        """Stand at `eye`, look at `target`, hold `up` upright."""
        return cls(world_from_camera=_look_at(eye, target, up), **fields)


Camera: TypeAlias = PerspectiveCamera | OrthographicCamera
