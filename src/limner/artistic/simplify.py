"""Lines with no more points than one can see: those are left out that lie on the line between their neighbours, to a part of a pixel.

Of a stretch between two points that stay, the point farthest from the straight line stays too, if it is far enough, and parts it. All
strokes are worked on at once, one round for each level of halving.

**Source**: D. Douglas and T. Peucker, "Algorithms for the Reduction of the Number of Points Required to Represent a Digitized Line or Its
Caricature", *The Canadian Cartographer* 10(2), 1973.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["points_that_show"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def points_that_show(points: Floats, count: NDArray[np.int64], tolerance: float) -> Flags:
    """Which points of lines stay.

    Parameters
    ----------
    points : (n, 2) float64
        Line after line; the last of a closed one is its first once more.
    count : (k,) int64
        How many points each line has, at least one.
    tolerance : float
        How far what is left out may lie from what is left, in the points' unit.

    Returns
    -------
    (n,) bool
        The first and the last of each line are among them.

    >>> points_that_show(np.array([[0.0, 0], [1, 0.05], [2, 0], [3, 1]]), np.array([4]), 0.1).tolist()
    [True, False, True, True]
    """
    kept = np.zeros(len(points), dtype=bool)
    last = np.cumsum(count) - 1
    kept[last], kept[last - count + 1] = True, True
    while len(points):
        stay = np.flatnonzero(kept)
        stretch = np.cumsum(kept) - 1
        start, end = stay[np.minimum(stretch, len(stay) - 1)], stay[np.minimum(stretch + 1, len(stay) - 1)]
        far = np.where(kept, 0.0, _distance(points, points[start], points[end]))
        most = np.maximum.reduceat(far, stay)
        added = np.flatnonzero((far == most[stretch]) & (far > tolerance))
        if not len(added):
            break
        # Of equally far points the first.
        kept[added[np.append(True, stretch[added][1:] != stretch[added][:-1])]] = True
    return kept


def _distance(points: Floats, a: Floats, b: Floats) -> Floats:
    """From points to the straight pieces a to b, (n,)."""
    way, to = b - a, points - a
    squared = (way * way).sum(axis=1)
    t = np.clip((to * way).sum(axis=1) / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(to - t[:, None] * way, axis=1))
