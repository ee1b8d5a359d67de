"""Motion: where something is at every time, for pictures whose shutter stays open for a while (FoCG 13.4.5).

    wheel = Node("wheel", place, shapes=(rim,), motion=Motion.turn((0, 0, 1), 90))
    limner.render(scene, renderer="ray", shutter=(0.0, 1.0), samples=64)

A motion is a list of poses at times. Between two of them the rotation turns at constant speed about one axis (slerp), so that a wheel
that turns stays round; scale and shear go straight from one to the other, and so does the place of the origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ..linear import transform
from ..linear.decompose import interpolate
from ._values import finite, numbers, triple
from .track import Track

__all__ = ["KeyedMotion", "Motion"]

_LARGEST_TURN = 90.0  # degrees between two poses: slerp goes the short way round, and half a turn has none


@dataclass(frozen=True, eq=False)
class Motion:
    """Poses at times.

    Parameters
    ----------
    times : (k,) floats, growing
        In whatever unit the shutter is said; before the first and after the last, nothing moves.
    poses : (k, 4, 4) float64
        Affine, column vectors, in the space of the node or camera that moves: the identity is where it stands without a motion.
    """

    times: NDArray[np.float64]
    poses: NDArray[np.float64]

    def __post_init__(self) -> None:
        times, poses = numbers(self.times, "motion.times"), numbers(self.poses, "motion.poses")
        if times.ndim != 1 or not len(times):
            raise SceneError(f"motion.times must be a list of times, got shape {times.shape}")
        if poses.shape != (len(times), 4, 4):
            raise SceneError(f"motion.poses must have shape ({len(times)}, 4, 4), one pose for each time, got {poses.shape}")
        if not (np.diff(times) > 0.0).all():
            raise SceneError(f"motion.times must grow, got {times.tolist()}")
        if not np.allclose(poses[:, 3], (0.0, 0.0, 0.0, 1.0), atol=1e-9):
            raise SceneError("motion.poses must be affine: their last rows must be 0 0 0 1")
        signs = np.sign(np.linalg.det(poses[:, :3, :3]))
        if not (signs == signs[0]).all() or signs[0] == 0.0:
            raise SceneError("motion.poses must not flatten space, nor mirror it on the way")
        for name, value in (("times", times), ("poses", poses)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @classmethod
    def shift(cls, by: Any, start: float = 0.0, end: float = 1.0) -> Motion:
        """Move along a vector from time `start` to time `end`.

        >>> Motion.shift((2, 0, 0)).at(0.25)[:3, 3].tolist()
        [0.5, 0.0, 0.0]
        """
        return cls(np.array(_span(start, end)), np.stack([np.eye(4), transform.translate(*triple(by, "by"))]))

    @classmethod
    def turn(cls, axis: Any, degrees: float, start: float = 0.0, end: float = 1.0) -> Motion:
        """Turn about an axis through the origin, counter-clockwise seen from its tip, any number of times.

        >>> Motion.turn((0, 0, 1), 720).at(0.0625)[:2, 0].round(3).tolist()
        [0.707, 0.707]
        """
        direction, angle = np.array(triple(axis, "axis")), finite(degrees, "degrees")
        if not direction.any():
            raise SceneError("axis must not be zero")
        steps = max(1, int(np.ceil(abs(angle) / _LARGEST_TURN)))
        shares = np.arange(steps + 1) / steps
        first, last = _span(start, end)
        return cls(first + shares * (last - first), transform.rotate(direction, np.radians(angle) * shares))

    def at(self, time: ArrayLike) -> NDArray[np.float64]:
        """The pose at a time, (4, 4), or at many, (..., 4, 4); float64."""
        t = np.clip(np.asarray(time, dtype=np.float64), self.times[0], self.times[-1])
        if len(self.times) == 1:
            return np.broadcast_to(self.poses[0], (*t.shape, 4, 4)).copy()
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        share = (t - self.times[k]) / (self.times[k + 1] - self.times[k])
        return interpolate(self.poses[k], self.poses[k + 1], share)


@dataclass(frozen=True, eq=False)
class KeyedMotion:
    """A translation, a rotation and a scale, each with keys of its own, as animations of glTF have them.

    Parameters
    ----------
    translation, scale : Track of three numbers
    rotation : Track that rotates

    At a time t the pose is ``T(t) R(t) S(t)``; a scale may pass through zero.
    """

    translation: Track
    rotation: Track
    scale: Track

    def __post_init__(self) -> None:
        for name, width in (("translation", 3), ("rotation", 4), ("scale", 3)):
            track = getattr(self, name)
            if not isinstance(track, Track) or track.width != width or track.rotates != (name == "rotation"):
                expected = "a Track that rotates" if name == "rotation" else "a Track of three numbers"
                raise SceneError(f"motion.{name} must be {expected}, got {type(track).__name__}")

    def at(self, time: ArrayLike) -> NDArray[np.float64]:
        """The pose at a time, (4, 4), or at many, (..., 4, 4); float64."""
        return transform.compose_trs(self.translation.at(time), self.rotation.at(time), self.scale.at(time))


def _span(start: Any, end: Any) -> tuple[float, float]:
    first, last = finite(start, "start"), finite(end, "end")
    if not first < last:
        raise SceneError(f"a motion must end after it starts, got {first} to {last}")
    return first, last
