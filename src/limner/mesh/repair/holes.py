"""Closing holes: a loop of edges in space becomes triangles.

Of all ways to cut the loop's polygon, the one with the least area is taken: for a flat loop, concave or not, that covers just what it
encloses. The best way to cut off the corners i … j is the best of all triangles on the side i-j with the best for what lies on both of
its other sides, so that all are found by going from short runs to long ones.

            i .-------. j           best(i, j) = least over k of  best(i, k) + best(k, j) + area(i, k, j)
             / \\     / \\
            .   \\   /   .
             \\   \\ /   /
              '---k---'

**Source**: G. Barequet and M. Sharir, "Filling gaps in the boundary of a polyhedron", *Computer Aided Geometric Design* 12(2), 1995,
section 4; triangles without area, and diagonals that are edges already, are avoided where that can be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..polygons import triangulate

__all__ = ["MAX_LEAST_AREA", "triangulate_loop"]

# The least area takes cubic time; longer loops are cut like nearly flat polygons.
MAX_LEAST_AREA = 256
_FLAT = 1e-6  # of a triangle's longest side squared: less area is none

Floats = NDArray[np.float64]


def triangulate_loop(points: Floats, taken: NDArray[np.bool_] | None = None) -> NDArray[np.int64]:
    """Cut a closed loop in space into triangles.

    Parameters
    ----------
    points : (k, 3) float64, k >= 3
        In order.
    taken : (k, k) bool, optional
        Symmetric: which pairs of corners must not be joined by a diagonal.

    Returns
    -------
    (k - 2, 3) int64
        Corners by their number in the loop, turning as it does.

    >>> triangulate_loop(np.array([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]])).tolist()
    [[0, 2, 3], [0, 1, 2]]
    """
    k = len(points)
    if k > MAX_LEAST_AREA:
        return triangulate(points[None], max_clipped=None)[0][0]
    squares = ((points[:, None] - points[None]) ** 2).sum(axis=2)
    # Worse than any area: a triangle without one, and more so a diagonal that is taken.
    dear = float(squares.max(initial=0.0)) * k + np.finfo(np.float64).tiny
    toll = np.zeros((k, k)) if taken is None else np.where(taken, dear * k, 0.0)
    ring = np.arange(k)
    toll[ring, (ring + 1) % k] = toll[(ring + 1) % k, ring] = 0.0
    cost, middle = np.zeros((k, k)), np.zeros((k, k), dtype=np.int64)
    for span in range(2, k):
        i = np.arange(k - span)[:, None]
        between, j = i + np.arange(1, span), i + span
        edge, other = points[between] - points[i], points[j] - points[i]
        area = 0.5 * np.linalg.norm(np.cross(edge, other), axis=2)
        longest = np.maximum(np.maximum(squares[i, between], squares[between, j]), squares[i, j])
        total = cost[i, between] + cost[between, j] + np.where(area > _FLAT * longest, area, dear)
        best = total.argmin(axis=1)
        rows = np.arange(k - span)
        middle[rows, rows + span] = between[rows, best]
        cost[rows, rows + span] = total[rows, best] + toll[rows, rows + span]
    return _gathered(middle)


def _gathered(middle: NDArray[np.int64]) -> NDArray[np.int64]:
    """Walk down from the whole loop; `middle[i, j]` is the third corner on the side i-j."""
    triangles, runs = [], [(0, len(middle) - 1)]
    while runs:
        i, j = runs.pop()
        if j - i < 2:
            continue
        k = int(middle[i, j])
        triangles.append((i, k, j))
        runs += [(i, k), (k, j)]
    return np.array(triangles, dtype=np.int64)
