"""Which points of the picture have a surface of their own just before or behind them, cell by cell of a grid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel
from .visibility_kernel import _cell, _side

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def find_beside(
    triangles: Floats,
    source: Indices,
    first: int,
    last: int,
    group: Indices,
    points: Floats,
    point_group: Indices,
    cell_start: Indices,
    cell_point: Indices,
    size: float,
    columns: int,
    rows: int,
    scale: float,
    perspective: int,
    reach: float,
    beside: Indices,
) -> None:
    """Mark what is `beside` a surface.

    `triangles` are rows (ax, ay, aq, bx, …) on the picture, `source` their numbers and `group` what each of those hangs together with, of
    which `first` to `last` are looked at; `points` rows (x, y, q), of which those of the triangle's own group count. `reach` is in pixels,
    across the surface. In the grid's cells, of `size` pixels, stand the points.
    """
    for k in range(first, last):
        ax, ay, aq = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        bx, by, bq = triangles[k, 3], triangles[k, 4], triangles[k, 5]
        cx, cy, cq = triangles[k, 6], triangles[k, 7], triangles[k, 8]
        left, right = min(ax, min(bx, cx)), max(ax, max(bx, cx))
        top, bottom = min(ay, min(by, cy)), max(ay, max(by, cy))
        if right < 0.0 or bottom < 0.0 or left > size * columns or top > size * rows:
            continue
        area = _side(ax, ay, bx, by, cx, cy)
        if area == 0.0:
            continue
        if area < 0.0:
            bx, by, bq, cx, cy, cq = cx, cy, cq, bx, by, bq
            area = -area
        slope_x = ((bq - aq) * (cy - ay) - (cq - aq) * (by - ay)) / area
        slope_y = ((cq - aq) * (bx - ax) - (bq - aq) * (cx - ax)) / area
        slope = slope_x * slope_x + slope_y * slope_y
        for row in range(_cell(top, size, rows), _cell(bottom, size, rows) + 1):
            for column in range(_cell(left, size, columns), _cell(right, size, columns) + 1):
                cell = row * columns + column
                for p in range(cell_start[cell], cell_start[cell + 1]):
                    n = cell_point[p]
                    x, y, q = points[n, 0], points[n, 1], points[n, 2]
                    if beside[n] != 0 or point_group[n] != group[source[k]] or x < left or x > right or y < top or y > bottom:
                        continue
                    if _side(ax, ay, bx, by, x, y) < 0.0 or _side(bx, by, cx, cy, x, y) < 0.0 or _side(cx, cy, ax, ay, x, y) < 0.0:
                        continue
                    apart = abs(aq + slope_x * (x - ax) + slope_y * (y - ay) - q)
                    if apart < reach * (math.sqrt(q * q / (scale * scale) + slope) if perspective == 1 else math.sqrt(1.0 + slope)):
                        beside[n] = 1
