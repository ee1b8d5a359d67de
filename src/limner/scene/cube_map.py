"""A cube map as a sky: six square pictures of everything around become one picture by longitude and latitude (FoCG 11.4.5).

A side of the cube is a pinhole picture with a right angle of view, so a direction finds its place by one division:

             up                  each side as seen from the centre;
    left   front   right   back  front is -z, right is +x, up is +y
            down

Each texel of the sky is the mean of the sides' radiance over its own solid angle, by some directions spread evenly over it: as much light
comes from the sky as from the cube.

**Source**: Greene, *Environment mapping and other applications of world projections*, 1986.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["side_of_direction", "sides_of", "sky_from_cube"]

_SAMPLES = 4  # along each side of a texel of the sky
# Of each side: where it looks, what is to its right, what is above
_LOOKS = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1)], dtype=np.float64)
_RIGHT = np.array([(0, 0, 1), (0, 0, -1), (1, 0, 0), (1, 0, 0), (1, 0, 0), (-1, 0, 0)], dtype=np.float64)
_ABOVE = np.array([(0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (0, 1, 0), (0, 1, 0)], dtype=np.float64)
# Of a cross: (row, column) of right, left, up, down, front, back
_WIDE = ((1, 2), (1, 0), (0, 1), (2, 1), (1, 1), (1, 3))
_TALL = ((1, 2), (1, 0), (0, 1), (2, 1), (1, 1), (3, 1))


def sides_of(pictures: Any) -> NDArray[np.float32]:
    """(6, n, n, 3) float32: right, left, up, down, front, back, of six pictures, a strip or a cross."""
    expected = "environment: a cube map must be six (n, n, 3) float pictures, a strip or a cross of them"
    try:
        given = np.asarray(pictures)
    except ValueError:
        raise SceneError(f"{expected}, got pictures of different sizes") from None
    if given.dtype.kind != "f" or given.shape[-1:] != (3,) or 0 in given.shape:
        raise SceneError(f"{expected}, got {given.shape} {given.dtype}")
    if given.ndim == 4 and given.shape[0] == 6 and given.shape[1] == given.shape[2]:
        return given.astype(np.float32)
    if given.ndim == 3:
        height, width = given.shape[:2]
        if height == 6 * width:
            return given.reshape(6, width, width, 3).astype(np.float32)
        if width == 6 * height:
            return np.stack(np.split(given, 6, axis=1)).astype(np.float32)
        for rows, columns, places in ((3, 4, _WIDE), (4, 3, _TALL)):
            if height * columns == width * rows and height % rows == 0:
                n = height // rows
                sides = np.stack([given[r * n : (r + 1) * n, c * n : (c + 1) * n] for r, c in places]).astype(np.float32)
                if places is _TALL:
                    sides[5] = sides[5, ::-1, ::-1]
                return sides
    raise SceneError(f"{expected}, got {given.shape}")


def side_of_direction(directions: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Which side directions (..., 3) of any length meet, and where: from the left edge and from the top edge, in [0, 1].

    >>> side, x, y = side_of_direction(np.array([[1.0, 0.0, 0.0], [0.5, 1.0, -1.0]]))
    >>> side.tolist(), x.tolist(), y.tolist()
    ([0, 2], [0.5, 0.75], [0.5, 1.0])
    """
    side = np.argmax(directions @ _LOOKS.T, axis=-1)
    depth = (directions * _LOOKS[side]).sum(axis=-1)
    x = (directions * _RIGHT[side]).sum(axis=-1) / depth
    y = (directions * _ABOVE[side]).sum(axis=-1) / depth
    return side, np.clip(0.5 + 0.5 * x, 0.0, 1.0), np.clip(0.5 - 0.5 * y, 0.0, 1.0)


def sky_from_cube(pictures: Any, height: int | None = None) -> NDArray[np.float32]:
    """(height, 2 height, 3) float32, row 0 on top, of the pictures that `Environment.from_cube` takes."""
    sides = sides_of(pictures)
    n = sides.shape[1]
    height = 2 * n if height is None else height
    if isinstance(height, bool) or not isinstance(height, int) or not 1 <= height <= 16384:
        raise SceneError(f"environment: the height of a sky must be an integer from 1 to 16384, got {height!r}")
    sky = np.empty((height, 2 * height, 3), dtype=np.float32)
    phi = 2.0 * np.pi * ((np.arange(2 * height * _SAMPLES) + 0.5) / (2 * height * _SAMPLES) - 0.5)
    for row in range(height):
        # Evenly in the cosine, so that every direction stands for the same solid angle.
        top, bottom = np.cos(np.pi * row / height), np.cos(np.pi * (row + 1) / height)
        cosine = top + (bottom - top) * (np.arange(_SAMPLES)[:, None] + 0.5) / _SAMPLES
        sine = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
        directions = np.stack([sine * np.cos(phi), np.broadcast_to(cosine, (_SAMPLES, len(phi))), sine * np.sin(phi)], axis=-1)
        side, x, y = side_of_direction(directions)
        seen = sides[side, np.minimum((y * n).astype(np.int64), n - 1), np.minimum((x * n).astype(np.int64), n - 1)]
        sky[row] = seen.reshape(_SAMPLES, 2 * height, _SAMPLES, 3).mean(axis=(0, 2), dtype=np.float64)
    return sky
