"""Areas behind the lines: what is seen of each shape as closed outlines, hidden surfaces by the painter's rule (FoCG 8.2.2, 12.4).

    areas = areas_of(corners, owner)               corners: triangles on the picture from back to front
    areas[0].rings                                 the outline of the first, to be filled by the rule "nonzero"

Triangles of one shape that follow each other in the painter's order are one area. Turned alike, the sum of their borders is its outline:
an edge that two of them share is walked once each way and falls away. How often the outline winds round a place is therefore how many
of the triangles lie there, and the rule "nonzero" fills exactly what they cover: no pixels, no union of polygons, and no seams.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["Area", "areas_of", "clipped", "outlines"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Area(NamedTuple):
    """What is painted at once: rings (n, 2) float64 each, to be filled by the rule "nonzero", and whose it is."""

    owner: int
    rings: tuple[Floats, ...]


def areas_of(corners: Floats, owner: Indices) -> list[Area]:
    """Areas from back to front: each is painted over those before it.

    Parameters
    ----------
    corners : (n, 3, 2) float64
        Triangles on the picture, from back to front. Corners in one place must be equal to the bit.
    owner : (n,) int64
        Whose they are.
    """
    if corners.shape[1:] != (3, 2) or len(owner) != len(corners):
        raise SceneError(f"corners must be (n, 3, 2) with an owner each, got {corners.shape} and {len(owner)} owners")
    if not len(corners):
        return []
    bounds = np.concatenate([[0], np.flatnonzero(np.diff(owner)) + 1, [len(owner)]])
    found = []
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        rings = outlines(corners[first:last])
        if rings:
            found.append(Area(int(owner[first]), tuple(rings)))
    return found


def outlines(corners: Floats) -> list[Floats]:
    """The outline of triangles (n, 3, 2) that may overlap, as rings that wind round each place as often as triangles cover it."""
    a, b, c = corners.transpose(1, 0, 2)
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    turned = np.where((area < 0.0)[:, None, None], corners[:, ::-1], corners)[area != 0.0]
    points, index = np.unique(turned.reshape(-1, 2) + 0.0, axis=0, return_inverse=True)  # -0 is 0
    index = index.reshape(-1, 3)
    start, end = index.reshape(-1), np.roll(index, -1, axis=1).reshape(-1)
    size = max(len(points), 1)
    keys, both = np.unique(np.minimum(start, end) * size + np.maximum(start, end), return_inverse=True)
    # How often an edge is walked from its lower to its higher point, less how often it is walked back.
    net = np.bincount(both.reshape(-1), np.where(start < end, 1, -1), len(keys)).astype(np.int64)
    low, high = np.divmod(keys, size)
    repeat = np.abs(net)
    begin, finish = np.repeat(np.where(net > 0, low, high), repeat), np.repeat(np.where(net > 0, high, low), repeat)
    return [points[ring] for ring in _chained(begin, finish, len(points))]


def clipped(ring: Floats, low: tuple[float, float], high: tuple[float, float]) -> Floats:
    """A ring's part in a rectangle; how often it winds round each place in there stays.

    Where it leaves the rectangle it goes on along the border, so that parts of it may lie there, one over the other.

    **Source**: Sutherland and Hodgman, *Reentrant polygon clipping*, 1974.
    """
    for axis in range(2):
        for sign, bound in ((1.0, low[axis]), (-1.0, high[axis])):
            if not len(ring):
                return ring
            inside = sign * (ring[:, axis] - bound)
            after, following = np.roll(inside, -1), np.roll(ring, -1, axis=0)
            crosses = (inside >= 0.0) != (after >= 0.0)
            share = np.where(crosses, inside, 0.0) / np.where(crosses, inside - after, 1.0)
            crossing = ring + share[:, None] * (following - ring)
            crossing[:, axis] = bound
            both = np.stack([ring, crossing], axis=1).reshape(-1, 2)
            ring = both[np.stack([inside >= 0.0, crosses], axis=1).reshape(-1)]
    return ring


def _chained(begin: Indices, finish: Indices, n_points: int) -> list[Indices]:
    """Directed edges as rings; as many lead to a point as away from it, so that every walk ends where it began."""
    order = np.argsort(begin, kind="stable")
    first = np.searchsorted(begin[order], np.arange(n_points + 1))
    after, at, last = finish[order].tolist(), first[:-1].tolist(), first[1:].tolist()
    rings = []
    for point in range(n_points):
        while at[point] < last[point]:
            ring, here = [], point
            while True:
                ring.append(here)
                edge = at[here]
                at[here] += 1
                here = after[edge]
                if here == point:
                    break
            rings.append(np.array(ring))
    return rings
