"""Keys over time: a number, a vector or a rotation that changes (FoCG 16.2; glTF 2.0, 3.11 and appendix C).

    size = Track((0.0, 1.0), ((1.0, 1.0, 1.0), (2.0, 2.0, 2.0)))
    size.at(0.25)                              # [1.25, 1.25, 1.25]

Between two keys a value stands still ("step"), goes straight ("linear") or along a cubic Hermite curve ("cubic"); a rotation turns by
slerp, at constant speed and the short way round. Before the first key and after the last, nothing changes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ..linear import quaternion
from ._values import numbers

__all__ = ["Interpolation", "Track"]

Interpolation = Literal["step", "linear", "cubic"]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Track:
    """Values at times.

    Parameters
    ----------
    times : (k,) floats, growing
        Seconds.
    values : (k,) or (k, n) floats; "cubic": (k, 3, n)
        At each key; of a cubic one the tangent it comes in with, the value, and the tangent it leaves with, tangents per second.
    interpolation : "step" | "linear" | "cubic"
    rotates : bool
        The values are quaternions (x, y, z, w): linear is slerp, and cubic is made unit.

    Raises SceneError where times do not grow, shapes do not fit, or a number is not finite.
    """

    times: Floats
    values: Floats
    interpolation: Interpolation = "linear"
    rotates: bool = False

    def __post_init__(self) -> None:
        if self.interpolation not in get_args(Interpolation):
            raise SceneError(f'track.interpolation must be "step", "linear" or "cubic", got {self.interpolation!r}')
        times, values = numbers(self.times, "track.times"), numbers(self.values, "track.values")
        if times.ndim != 1 or not len(times):
            raise SceneError(f"track.times must be a list of times, got shape {times.shape}")
        if not (np.diff(times) > 0.0).all():
            late = int(np.flatnonzero(np.diff(times) <= 0.0)[0])
            raise SceneError(f"track.times must grow, got {times[late]:g} and {times[late + 1]:g} at keys {late} and {late + 1}")
        if values.ndim == 1 and self.interpolation != "cubic":
            values = values[:, None]
        expected = (len(times), 3) if self.interpolation == "cubic" else (len(times),)
        if values.ndim != len(expected) + 1 or values.shape[:-1] != expected:
            wanted = ", ".join(map(str, expected))
            raise SceneError(f"track.values must have shape ({wanted}, n), one entry for each time, got {values.shape}")
        if self.rotates and values.shape[-1] != 4:
            raise SceneError(f"a track that rotates must have quaternions (x, y, z, w), got {values.shape[-1]} numbers a key")
        for name, array in (("times", times), ("values", values)):
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @classmethod
    def constant(cls, value: Any, *, rotates: bool = False) -> Track:
        """What does not change."""
        return cls(np.zeros(1), np.atleast_1d(np.asarray(value, dtype=np.float64))[None], rotates=rotates)

    @property
    def width(self) -> int:
        """How many numbers a value has."""
        return self.values.shape[-1]

    @property
    def is_constant(self) -> bool:
        """Whether there is one key only."""
        return len(self.times) == 1

    def at(self, time: ArrayLike) -> Floats:
        """The value at a time, (n,), or at many, (..., n).

        **Source**: glTF 2.0, appendix C: ``v = (2t^3 - 3t^2 + 1) v_k + t_d (t^3 - 2t^2 + t) b_k + (3t^2 - 2t^3) v_(k+1) +
        t_d (t^3 - t^2) a_(k+1)`` with the time t_d between the keys, b leaving and a coming in.
        """
        t = np.clip(np.asarray(time, dtype=np.float64), self.times[0], self.times[-1])
        keys = self.values[:, 1] if self.interpolation == "cubic" else self.values
        if self.is_constant:
            only = quaternion.normalized(keys[0]) if self.rotates else keys[0]
            return np.broadcast_to(only, (*t.shape, self.width)).copy()
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        lasts = self.times[k + 1] - self.times[k]
        share = (t - self.times[k]) / lasts
        if self.interpolation == "step":
            value = keys[np.where(share < 1.0, k, k + 1)]
        elif self.interpolation == "linear":
            if self.rotates:
                return quaternion.slerp(keys[k], keys[k + 1], share)
            # Exact at both keys, also where the two are of very different size.
            value = np.where(share[..., None] < 1.0, keys[k] + share[..., None] * (keys[k + 1] - keys[k]), keys[k + 1])
        else:
            value = self._hermite(k, share[..., None], lasts[..., None])
        return quaternion.normalized(value) if self.rotates else value

    def _hermite(self, k: NDArray[np.intp], t: Floats, lasts: Floats) -> Floats:
        start, leaving = self.values[k, 1], self.values[k, 2]
        arriving, end = self.values[k + 1, 0], self.values[k + 1, 1]
        t2, t3 = t * t, t * t * t
        return (
            (2.0 * t3 - 3.0 * t2 + 1.0) * start + lasts * (t3 - 2.0 * t2 + t) * leaving
            + (3.0 * t2 - 2.0 * t3) * end + lasts * (t3 - t2) * arriving
        )  # fmt: skip

