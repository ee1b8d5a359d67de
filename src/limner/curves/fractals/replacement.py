"""Curves by replacement: every leg of a polygon gives way to a small copy of a generator (FoCG 15.1: generative curves).

    ______     becomes    __/\\__     of which every leg becomes the like: Koch's curve, of dimension log 4 / log 3

The dragon is the paper strip that is folded in halves again and again; Hilbert's curve visits all cells of a grid, neighbours in
succession, and has a place for every number without drawing those before it.

**Source**: von Koch, 1904; Gardner, *Mathematical Magic Show*, 1977 (the dragon of Heighway); Hilbert, "Über die stetige Abbildung einer
Linie auf ein Flächenstück", 1891.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..control import control_points, degree_of

__all__ = ["KOCH", "dragon", "hilbert", "hilbert_cells", "koch", "replaced", "similarity_dimension", "snowflake"]

Floats = NDArray[np.float64]

KOCH = ((0.0, 0.0), (1.0 / 3.0, 0.0), (0.5, math.sqrt(3.0) / 6.0), (2.0 / 3.0, 0.0), (1.0, 0.0))
"""Koch's generator: from (0, 0) to (1, 0) with a tooth to the left."""

_MOST_POINTS = 1 << 24


def replaced(polygon: ArrayLike, generator: ArrayLike, times: int) -> Floats:
    """Replace every leg of a polygon by a generator, again and again.

    Parameters
    ----------
    polygon : (n, 2) float, n >= 2
    generator : (m + 1, 2) float, m >= 1
        From (0, 0) to (1, 0); it is turned and scaled to each leg.
    times : int >= 0

    Returns
    -------
    ((n - 1) m^times + 1, 2) float64
    """
    line, shape = control_points(polygon, 2, "polygon", 2), control_points(generator, 2, "generator", 2)
    if not (np.allclose(shape[0], 0.0) and np.allclose(shape[-1], (1.0, 0.0))):
        raise SceneError(f"a generator runs from (0, 0) to (1, 0), got from {shape[0].tolist()} to {shape[-1].tolist()}")
    _check_points((len(line) - 1) * (len(shape) - 1) ** degree_of(times) + 1)
    z, g = line @ (1.0, 1.0j), shape[:-1] @ (1.0, 1.0j)
    for _ in range(times):
        z = np.append((z[:-1, None] + np.diff(z)[:, None] * g).reshape(-1), z[-1])
    return np.ascontiguousarray(z).view(np.float64).reshape(-1, 2)


def _check_points(count: int) -> None:
    if count > _MOST_POINTS:
        raise SceneError(f"the curve would have {count:,} points; the most that is made is {_MOST_POINTS:,}")


def koch(times: int) -> Floats:
    """Koch's curve from (0, 0) to (1, 0), (4^times + 1, 2) float64; its length is (4/3)^times.

    >>> len(koch(3))
    65
    """
    return replaced([(0.0, 0.0), (1.0, 0.0)], KOCH, times)


def snowflake(times: int) -> Floats:
    """Koch's snowflake round a triangle of sides 1, closed: (3 4^times + 1, 2) float64, clockwise; teeth point outwards."""
    return replaced([(0.0, 0.0), (0.5, math.sqrt(0.75)), (1.0, 0.0), (0.0, 0.0)], KOCH, times)


def dragon(times: int) -> Floats:
    """Heighway's dragon from (0, 0) to (1, 0), (2^times + 1, 2) float64: a strip folded so often, every fold a right angle."""
    _check_points(2 ** degree_of(times) + 1)
    z = np.array([0.0, 1.0 + 0.0j])
    for _ in range(times):
        # The second half is the first, turned by a quarter about the end it is run back from
        z = np.concatenate([z, z[-1] + 1j * (z[-2::-1] - z[-1]) * -1.0])
    z = z / z[-1]
    return np.ascontiguousarray(z).view(np.float64).reshape(-1, 2)


def hilbert_cells(order: int, numbers: ArrayLike | None = None) -> NDArray[np.int64]:
    """Find the cells that Hilbert's curve visits in a grid of 2^order by 2^order.

    Parameters
    ----------
    order : int from 0 to 31
    numbers : (k,) int, optional
        Which cells, in the curve's order from 0; None: all 4^order.

    Returns
    -------
    (k, 2) int64
        Column and row; the first is (0, 0), the last (2^order - 1, 0), and the next is always a neighbour.

    Examples
    --------
    >>> hilbert_cells(1).tolist()
    [[0, 0], [0, 1], [1, 1], [1, 0]]

    **Source**: Warren, *Hacker's Delight*, 2nd ed., 2012, 16.
    """
    if not 0 <= degree_of(order) <= 31:
        raise SceneError(f"the order of Hilbert's curve must lie in [0, 31], got {order}")
    if numbers is None:
        _check_points(4**order)
    given = np.arange(4**order) if numbers is None else np.asarray(numbers)
    if given.dtype.kind not in "iu" or given.ndim != 1 or (given < 0).any() or (given >= 4**order).any():
        raise SceneError(f"cells of Hilbert's curve of order {order} are numbered from 0 to {4**order - 1}")
    left = given.astype(np.int64)
    x, y = np.zeros_like(left), np.zeros_like(left)
    for bit in range(order):
        right = (left >> 1) & 1
        up = (left ^ right) & 1
        side = 1 << bit
        # Within the lower quarters the curve runs mirrored on the diagonal
        turned, flipped = up == 0, right == 1
        x, y = np.where(turned & flipped, side - 1 - x, x), np.where(turned & flipped, side - 1 - y, y)
        x, y = np.where(turned, y, x), np.where(turned, x, y)
        x, y = x + side * right, y + side * up
        left >>= 2
    return np.stack([x, y], axis=1)


def hilbert(order: int) -> Floats:
    """Hilbert's curve through the middles of 2^order by 2^order cells of the unit square, (4^order, 2) float64."""
    return np.asarray((hilbert_cells(order) + 0.5) / 2.0**order, dtype=np.float64)


def similarity_dimension(scales: ArrayLike) -> float:
    """Find the dimension of what consists of copies of itself: the d with ``sum_k s_k^d = 1``.

    Parameters
    ----------
    scales : (n,) float in (0, 1), n >= 2
        How large each copy is.

    Examples
    --------
    >>> round(similarity_dimension([1 / 3] * 4), 6)
    1.26186

    **Source**: Moran, 1946; Falconer, *Fractal Geometry*, 3rd ed., 2014, 9.2.
    """
    s = np.asarray(scales, dtype=np.float64)
    if s.ndim != 1 or len(s) < 2 or not ((s > 0.0) & (s < 1.0)).all():
        raise SceneError(f"scales must be at least two numbers within (0, 1), got {np.asarray(scales).tolist()}")
    low, high = 0.0, math.log(len(s)) / -math.log(float(s.max())) + 1.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float((s**middle).sum()) > 1.0 else (low, middle)
    return 0.5 * (low + high)
