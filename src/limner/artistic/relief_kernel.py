"""Which points of the picture have a surface of their own just before or behind them, cell by cell of a grid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel
from .triangle_kernel import box_of, cell, side, slope_of, turned

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
        left, right, top, bottom = box_of(triangles, k)
        if right < 0.0 or bottom < 0.0 or left > size * columns or top > size * rows:
            continue
        corners, (aq, bq, cq), area = turned(triangles, k)
        if area == 0.0:
            continue
        ax, ay, bx, by, cx, cy = corners
        slope_x, slope_y = slope_of(corners, (aq, bq, cq), area)
        slope = slope_x * slope_x + slope_y * slope_y
        for row in range(cell(top, size, rows), cell(bottom, size, rows) + 1):
            for column in range(cell(left, size, columns), cell(right, size, columns) + 1):
                here = row * columns + column
                for p in range(cell_start[here], cell_start[here + 1]):
                    n = cell_point[p]
                    x, y, q = points[n, 0], points[n, 1], points[n, 2]
                    if beside[n] != 0 or point_group[n] != group[source[k]] or x < left or x > right or y < top or y > bottom:
                        continue
                    if side(ax, ay, bx, by, x, y) < 0.0 or side(bx, by, cx, cy, x, y) < 0.0 or side(cx, cy, ax, ay, x, y) < 0.0:
                        continue
                    apart = abs(aq + slope_x * (x - ax) + slope_y * (y - ay) - q)
                    if apart < reach * (math.sqrt(q * q / (scale * scale) + slope) if perspective == 1 else math.sqrt(1.0 + slope)):
                        beside[n] = 1
