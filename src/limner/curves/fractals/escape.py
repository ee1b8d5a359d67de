"""The Mandelbrot set and the Julia sets: points that stay near under ``z -> z^2 + c``.

Whoever is farther from 0 than 2 (and than |c|) never comes back. How many steps it takes to get there, smoothed to a real number, is
what pictures of these sets show; points that have not left in time are taken for the set.

**Source**: Mandelbrot, 1980; Peitgen and Saupe (eds.), *The Science of Fractal Images*, 1988, 4.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..control import degree_of

__all__ = ["grid", "julia", "mandelbrot"]

Floats = NDArray[np.float64]
Bounds = tuple[float, float, float, float]

_FAR = 256.0  # where the smoothed count does not depend on the radius any more
_MOST_POINTS = 1 << 26


def grid(bounds: Bounds, width: int, height: int) -> NDArray[np.complex128]:
    """The middles of width by height pixels over (left, bottom, right, top), (height, width) complex128, row 0 on top."""
    left, bottom, right, top = (float(value) for value in bounds)
    if not (np.isfinite([left, bottom, right, top]).all() and left < right and bottom < top):
        raise SceneError(f"bounds must be (left, bottom, right, top) with left < right and bottom < top, got {bounds}")
    if degree_of(width, 1) * degree_of(height, 1) > _MOST_POINTS:
        raise SceneError(f"{width} by {height} points are more than {_MOST_POINTS:,}")
    x = left + (right - left) * (np.arange(width) + 0.5) / width
    y = top - (top - bottom) * (np.arange(height) + 0.5) / height
    return np.asarray(x + 1j * y[:, None])


def mandelbrot(bounds: Bounds = (-2.25, -1.25, 0.75, 1.25), width: int = 600, height: int = 500, steps: int = 200) -> Floats:
    """Count how many steps from 0 each c takes to escape.

    Parameters
    ----------
    bounds : (left, bottom, right, top)
    width, height : int >= 1
    steps : int >= 1
        After so many a point that is still near is taken for one of the set.

    Returns
    -------
    (height, width) float64
        Row 0 on top; smooth from point to point, inf in the set.

    Examples
    --------
    >>> mandelbrot((-0.1, -0.1, 0.1, 0.1), 2, 2, 50).tolist()
    [[inf, inf], [inf, inf]]
    """
    c = grid(bounds, width, height)
    # The heart and the disk to its left are known to stay, and would take all the time
    q = np.abs(c - 0.25)
    inside = (c.real < q - 2.0 * q * q + 0.25) | (np.abs(c + 1.0) < 0.25)
    return _escape(np.zeros_like(c), c, steps, ~inside)


def julia(c: complex, bounds: Bounds = (-1.6, -1.2, 1.6, 1.2), width: int = 640, height: int = 480, steps: int = 200) -> Floats:
    """Count how many steps each z takes to escape under ``z -> z^2 + c``; as `mandelbrot`.

    Parameters
    ----------
    c : complex
    bounds : (left, bottom, right, top)
    width, height : int >= 1
    steps : int >= 1
    """
    if not (math.isfinite(complex(c).real) and math.isfinite(complex(c).imag)):
        raise SceneError(f"c must be finite, got {c}")
    z = grid(bounds, width, height)
    return _escape(z, np.full_like(z, c), steps, np.ones(z.shape, dtype=bool))


def _escape(z: NDArray[np.complex128], c: NDArray[np.complex128], steps: int, asked: NDArray[np.bool_]) -> Floats:
    degree_of(steps, 1)
    counts = np.full(z.size, np.inf)
    row = np.flatnonzero(asked.reshape(-1))
    z, c = z.reshape(-1)[row], c.reshape(-1)[row]
    far = np.maximum(_FAR, np.abs(c) + 2.0)
    for step in range(steps + 1):
        size = np.abs(z)
        gone = size > far
        if gone.any():
            # With every step the logarithm doubles: what it is beyond the border is the fraction
            counts[row[gone]] = np.maximum(0.0, step - np.log2(np.log(size[gone]) / np.log(far[gone])))
            keep = ~gone
            row, z, c, far = row[keep], z[keep], c[keep], far[keep]
        if not len(row):
            break
        z = z * z + c
    return counts.reshape(asked.shape)
