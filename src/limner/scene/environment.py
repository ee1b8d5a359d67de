"""Light from all around: a picture of everything that surrounds a scene, infinitely far away.

    scene = scene.replace(environment=limner.Environment("garden.hdr", rotation_degrees=90))
    scene = scene.replace(environment=limner.Environment((0.4, 0.5, 0.7)), background="environment")

The picture is equirectangular: the column is the direction's longitude, the row its angle from +y,

    u = 1/2 + atan2(z, x) / 2 pi        v = arccos(y) / pi        (u from the left edge, v from the top edge)

so that the middle of the picture lies towards +x, three quarters of the way to the right towards +z, both edges towards -x, and the
top row at +y. Seen from inside with +y up it is not mirrored. The texel in column i and row j of (h, w) has its centre at
u = (i + 1/2) / w, v = (j + 1/2) / h.

A file is named here and read where it is needed (`limner.files.radiance`): a description stays small.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ._values import Triple, finite, triple

__all__ = ["Environment", "direction_from_uv", "uv_from_direction"]


@dataclass(frozen=True, eq=False)
class Environment:
    """What surrounds a scene: it gives light, and is seen behind everything where `scene.background` is "environment".

    Parameters
    ----------
    source : path, (height, width, 3) float array_like, or three floats
        A file (.hdr, .exr, .pfm: radiance; other pictures are decoded from sRGB); radiance >= 0, linear, Rec. 709, row 0 on *top*;
        or the same radiance from everywhere.
    intensity : float >= 0
        Factor on the radiance.
    rotation_degrees : float
        Turns the surroundings about +y, counter-clockwise seen from above: by 90, what was towards +x is towards -z.

    Raises SceneError, naming the field and, in a picture, the place.
    """

    source: str | NDArray[np.float32] | Triple
    intensity: float = 1.0
    rotation_degrees: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "source", _checked_source(self.source))
        intensity = finite(self.intensity, "environment.intensity")
        if intensity < 0.0:
            raise SceneError(f"environment.intensity must not be negative, got {intensity:g}")
        object.__setattr__(self, "intensity", intensity)
        object.__setattr__(self, "rotation_degrees", finite(self.rotation_degrees, "environment.rotation_degrees"))

    @classmethod
    def from_cube(cls, pictures: Any, *, height: int | None = None, intensity: float = 1.0, rotation_degrees: float = 0.0) -> Environment:
        """Make surroundings of a cube map: six square pictures, as a camera at the centre sees them, none mirrored.

        Parameters
        ----------
        pictures : six (n, n, 3) float array_like, or one that holds them
            Linear radiance, row 0 on top: right (+x), left (-x), up (+y), down (-y), front (-z), back (+z), the order of OpenGL's files;
            up and down join the upper and the lower edge of the front. Or one picture: a strip of the six, side by side or from top to
            bottom; or a cross, four wide with the row left, front, right, back, or three wide with the back, upside down, at its foot.
        height : int, optional
            Of the sky that it becomes, twice as wide. None: 2 n, where texels at the horizon are as fine as the middles of the sides.
        intensity, rotation_degrees : float
            As for any environment.
        """
        from .cube_map import sky_from_cube

        return cls(sky_from_cube(pictures, height), intensity, rotation_degrees)

    @property
    def is_constant(self) -> bool:
        """Whether the same radiance comes from everywhere."""
        return isinstance(self.source, tuple)

    def __repr__(self) -> str:
        source = f"{self.source.shape[1]} x {self.source.shape[0]}" if isinstance(self.source, np.ndarray) else repr(self.source)
        return f"Environment({source}, intensity={self.intensity:g}, rotation_degrees={self.rotation_degrees:g})"


def uv_from_direction(directions: ArrayLike, rotation_degrees: float = 0.0) -> NDArray[np.float64]:
    """Return where in an environment's picture directions look.

    Parameters
    ----------
    directions : (..., 3) floats
        World space, any length but zero.
    rotation_degrees : float
        Of the environment.

    Returns
    -------
    (..., 2) float64
        u in [0, 1) from the left edge, v in [0, 1] from the top edge. Straight up and down, u is as for (0, 0, 1) or its like:
        whatever atan2 gives for zeros.

    >>> uv_from_direction([[1, 0, 0], [0, 0, 1], [0, 1, 0]]).tolist()
    [[0.5, 0.5], [0.75, 0.5], [0.5, 0.0]]
    >>> uv_from_direction([0, 0, -1], rotation_degrees=90).tolist()
    [0.5, 0.5]
    """
    d = np.asarray(directions, dtype=np.float64)
    turns = 0.5 + np.arctan2(d[..., 2], d[..., 0]) / (2.0 * np.pi) + rotation_degrees / 360.0
    # Not arccos(y): it loses half the digits near the poles.
    v = np.arctan2(np.hypot(d[..., 0], d[..., 2]), d[..., 1]) / np.pi
    return np.stack([turns - np.floor(turns), v], axis=-1)


def direction_from_uv(uv: ArrayLike, rotation_degrees: float = 0.0) -> NDArray[np.float64]:
    """Return the unit directions, (..., 3) float64, that look at places (..., 2) of an environment's picture.

    >>> direction_from_uv([0.25, 0.5]).round(12).tolist()
    [0.0, 0.0, -1.0]
    """
    places = np.asarray(uv, dtype=np.float64)
    phi = 2.0 * np.pi * (places[..., 0] - 0.5 - rotation_degrees / 360.0)
    theta = np.pi * places[..., 1]
    return np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)


def _checked_source(source: Any) -> str | NDArray[np.float32] | Triple:
    if isinstance(source, (str, os.PathLike)):
        path = os.fspath(source)
        if not isinstance(path, str) or not path or "\0" in path:
            raise SceneError(f"environment.source must name a file, got {path!r}")
        return path
    try:
        given = np.asarray(source)
    except ValueError:
        raise SceneError("environment.source must be an array of numbers, got rows of different lengths") from None
    if given.ndim < 2:
        return triple(source, "environment.source", minimum=0.0)
    return _checked_picture(given)


def _checked_picture(given: NDArray[Any]) -> NDArray[np.float32]:
    if given.ndim != 3 or given.shape[2] != 3 or 0 in given.shape:
        alpha = "; leave the alpha out" if given.ndim == 3 and given.shape[2] == 4 else ""
        raise SceneError(f"environment.source must be a picture of shape (height, width, 3), got {given.shape}{alpha}")
    if given.dtype.kind != "f":
        raise SceneError(f"environment.source must be linear radiance in floats, got {given.dtype}")
    with np.errstate(over="ignore"):
        made = np.array(given, dtype=np.float32, order="C")
    bad = ~((made >= 0.0) & (made < np.inf)).all(axis=2)
    if bad.any():
        row, column = (int(k) for k in np.argwhere(bad)[0])
        values = ", ".join(f"{value:g}" for value in given[row, column])
        raise SceneError(f"environment.source must be finite and not negative, got ({values}) at row {row}, column {column}")
    made.flags.writeable = False
    return made
