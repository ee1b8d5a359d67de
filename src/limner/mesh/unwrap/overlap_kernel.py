"""Whether rims in the plane cross themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..._jit import kernel

Floats = NDArray[np.float64]


@kernel
def _side(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> float:
    """Twice the signed area of a triangle."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@kernel
def crossings(segments, charts, ends, crossed):
    """Find for each chart two segments that cross, and put them into its row of `crossed`, which is -1 where there are none.

    `segments` are (x0, y0, x1, y1), sorted by chart, then by their least x; `ends` the vertices they run between: neighbours on a rim do
    not cross.
    """
    n = len(segments)
    for i in range(n):
        chart = charts[i]
        if crossed[chart, 0] >= 0:
            continue
        ax, ay, bx, by = segments[i, 0], segments[i, 1], segments[i, 2], segments[i, 3]
        right, low, high = max(ax, bx), min(ay, by), max(ay, by)
        for j in range(i + 1, n):
            if charts[j] != chart:
                break
            cx, cy, dx, dy = segments[j, 0], segments[j, 1], segments[j, 2], segments[j, 3]
            if min(cx, dx) > right:
                break
            if min(cy, dy) > high or max(cy, dy) < low:
                continue
            if ends[i, 0] == ends[j, 0] or ends[i, 0] == ends[j, 1] or ends[i, 1] == ends[j, 0] or ends[i, 1] == ends[j, 1]:
                continue
            c_side, d_side = _side(ax, ay, bx, by, cx, cy), _side(ax, ay, bx, by, dx, dy)
            a_side, b_side = _side(cx, cy, dx, dy, ax, ay), _side(cx, cy, dx, dy, bx, by)
            if (c_side >= 0.0) != (d_side >= 0.0) and (a_side >= 0.0) != (b_side >= 0.0):
                crossed[chart, 0], crossed[chart, 1] = i, j
                break
