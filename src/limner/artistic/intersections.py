"""Lines in which surfaces pass through each other, or through themselves.

Two triangles meet in the part of the line common to their planes that lies in both. Which ones may meet is asked of a tree of boxes: the
triangles in the order of a curve that fills space, two and two and two together.

**Source**: T. Möller, "A Fast Triangle-Triangle Intersection Test", *Journal of Graphics Tools* 2(2), 1997; G. M. Morton, "A Computer
Oriented Geodetic Data Base", 1966 (the curve).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..mesh.components import component_labels
from .segments import ROUNDING, Segments, joined
from .surfaces import Surfaces

__all__ = ["intersection_segments"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_AT_ONCE = 1 << 16  # triangles between two looks at whether to go on
_STACK = 128
_BITS = 20  # of each coordinate along the curve

_find_meetings = Door(
    "limner.artistic.intersections_kernel",
    "find_meetings",
    (
        Array(np.float64, 2), Array(np.int64, 2), Array(np.float64, 2), Scalar(np.float64), Scalar(np.int64), Scalar(np.int64),
        Array(np.int64, 1), Array(np.float64, 2), Array(np.int64, 2), Array(np.float64, 3), Array(np.int64, 1),
    ),
    "where surfaces meet",
)  # fmt: skip


def intersection_segments(surfaces: Surfaces, kind: int, on_progress: Callable[[float], object]) -> Segments:
    """The lines in which triangles meet that share no corner; `on_progress` hears which share has been looked at, and may stop it."""
    n = len(surfaces.triangles)
    if n < 2:
        return joined([])
    corners = surfaces.points[surfaces.triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    order = np.argsort(_along_curve((low + high) / 2.0), kind="stable")
    boxes = _tree(low[order], high[order])
    triangles = np.ascontiguousarray(surfaces.triangles[order])
    slack = ROUNDING * surfaces.extent
    room, count = 1 << 12, np.zeros(1, dtype=np.int64)
    stack, scratch = np.empty(_STACK, dtype=np.int64), np.empty((6, 3))
    pair_parts, end_parts = [], []
    for first in range(0, n, _AT_ONCE):
        last = min(first + _AT_ONCE, n)
        for _ in range(2):
            pairs, ends = np.empty((room, 2), dtype=np.int64), np.empty((room, 2, 3))
            _find_meetings(surfaces.points, triangles, boxes, slack, first, last, stack, scratch, pairs, ends, count)
            if count[0] <= room:
                break
            room = int(count[0])
        pair_parts.append(order[pairs[: count[0]]])
        end_parts.append(ends[: count[0]].copy())
        on_progress(last / n)
    pairs, ends = np.sort(np.concatenate(pair_parts), axis=1), np.concatenate(end_parts)
    # An exact shape does not run through itself, whatever rounding does to the triangles around its poles.
    apart = ~(surfaces.exact[pairs[:, 0]] & (surfaces.instance[pairs[:, 0]] == surfaces.instance[pairs[:, 1]]))
    pairs, ends = pairs[apart], ends[apart]
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    pairs, ends = pairs[order], _snapped(ends[order], slack)
    kept = (ends[:, 0] != ends[:, 1]).any(axis=1)
    pairs, ends = pairs[kept], ends[kept]
    m = len(pairs)
    return Segments(
        np.full(m, kind), ends, pairs, np.full(m, slack), np.zeros(m, dtype=np.int64), surfaces.instance[pairs[:, 0]],
        np.zeros(m, dtype=bool), pairs[:, 0].astype(np.int64),
    )  # fmt: skip


def _snapped(ends: Floats, slack: float) -> Floats:
    """Ends, (k, 2, 3), those within `slack` of each other made one: where an edge meets an edge, rounding decides which pair of triangles
    has the point."""
    points = ends.reshape(-1, 3)
    if not len(points):
        return ends
    pairs = []
    for shift in np.ndindex(2, 2, 2):
        cell = np.floor((points - points.min(axis=0)) / (2.0 * slack) + 0.5 * np.array(shift))
        order = np.lexsort(cell.T)
        same = (cell[order][1:] == cell[order][:-1]).all(axis=1)
        pairs.append(np.stack([order[:-1][same], order[1:][same]]))
    first, second = np.concatenate(pairs, axis=1)
    return np.asarray(points[component_labels(len(points), first, second)].reshape(ends.shape))


def _along_curve(middles: Floats) -> Indices:
    """Where points lie along a curve that fills space, (n,)."""
    low, size = middles.min(axis=0), np.ptp(middles, axis=0).max()
    cells = ((middles - low) * ((2**_BITS - 1) / (size if size > 0.0 else 1.0))).astype(np.uint64)
    made = np.zeros(len(cells), dtype=np.uint64)
    for axis in range(3):
        x = cells[:, axis]
        # Two zeros between all bits.
        for shift, mask in (
            (32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F), (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249),
        ):  # fmt: skip
            x = (x | (x << np.uint64(shift))) & np.uint64(mask)
        made |= x << np.uint64(axis)
    return made.astype(np.int64)


def _tree(low: Floats, high: Floats) -> Floats:
    """(2 l, 6) float64: boxes over boxes, the given ones from row l on; what fills up to a power of two is empty."""
    leaves = 1 << max((len(low) - 1).bit_length(), 0)
    boxes = np.empty((2 * leaves, 6))
    boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
    boxes[leaves : leaves + len(low), :3], boxes[leaves : leaves + len(low), 3:] = low, high
    row = leaves
    while row > 1:
        below = boxes[row : 2 * row]
        row //= 2
        np.minimum(below[0::2, :3], below[1::2, :3], out=boxes[row : 2 * row, :3])
        np.maximum(below[0::2, 3:], below[1::2, 3:], out=boxes[row : 2 * row, 3:])
    return boxes
