"""Which parts of lines on the picture lie behind which triangles, cell by cell of a grid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel
from .triangle_kernel import box_of, cell, side, slope_of, turned

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def _aside(px: float, py: float, qx: float, qy: float) -> float:
    """On which side of p, q a line lies that runs along it, were it moved a little to the right and less downwards."""
    dy, dx = qy - py, qx - px
    return -dy if dy != 0.0 else dx


@kernel
def _cut(lo: float, hi: float, f0: float, f1: float) -> tuple[float, float]:
    """Of lo..hi the part where f, which goes evenly from f0 at 0 to f1 at 1, is positive; lo > hi: there is none."""
    if f0 <= 0.0 and f1 <= 0.0:
        return 1.0, 0.0
    if f0 < 0.0:
        return max(lo, f0 / (f0 - f1)), hi
    if f1 < 0.0:
        return lo, min(hi, f0 / (f0 - f1))
    return lo, hi


@kernel
def find_hidden(
    triangles: Floats,
    source: Indices,
    first: int,
    last: int,
    lines: Floats,
    own: Indices,
    slack: Floats,
    cell_start: Indices,
    piece_line: Indices,
    pieces: Floats,
    size: float,
    columns: int,
    rows: int,
    scale: float,
    perspective: int,
    hidden_line: Indices,
    hidden: Floats,
    count: Indices,
) -> None:
    """List what hides what.

    `triangles` are rows (ax, ay, aq, bx, …) on the picture, `source` their numbers, of which `first` to `last` are looked at; `lines` rows
    (x0, y0, q0, x1, y1, q1), `own` two triangles of each that do not hide it, `slack` how far in metres others must lie in front. In the
    grid's cells, of `size` pixels, stand `pieces` of lines, (start, end, least q). A line `hidden_line[n]` is hidden by one triangle from
    hidden[n, 0] to hidden[n, 1]. `count` becomes how many there are, which may be more than there was room for.
    """
    n = 0
    room = hidden.shape[0]
    for k in range(first, last):
        left, right, top, bottom = box_of(triangles, k)
        if right < 0.0 or bottom < 0.0 or left > size * columns or top > size * rows:
            continue
        corners, (aq, bq, cq), area = turned(triangles, k)
        if area == 0.0:
            continue
        ax, ay, bx, by, cx, cy = corners
        nearest = max(aq, max(bq, cq))
        slope_x, slope_y = slope_of(corners, (aq, bq, cq), area)
        slope = slope_x * slope_x + slope_y * slope_y
        for row in range(cell(top, size, rows), cell(bottom, size, rows) + 1):
            for column in range(cell(left, size, columns), cell(right, size, columns) + 1):
                here = row * columns + column
                for p in range(cell_start[here], cell_start[here + 1]):
                    line = piece_line[p]
                    if pieces[p, 2] >= nearest or source[k] == own[line, 0] or source[k] == own[line, 1]:
                        continue
                    x0, y0, q0 = lines[line, 0], lines[line, 1], lines[line, 2]
                    x1, y1, q1 = lines[line, 3], lines[line, 4], lines[line, 5]
                    lo, hi = pieces[p, 0], pieces[p, 1]
                    c0, c1 = side(ax, ay, bx, by, x0, y0), side(ax, ay, bx, by, x1, y1)
                    if c0 == 0.0 and c1 == 0.0:
                        if _aside(ax, ay, bx, by) <= 0.0:
                            continue
                    else:
                        lo, hi = _cut(lo, hi, c0, c1)
                        if lo >= hi:
                            continue
                    a0, a1 = side(bx, by, cx, cy, x0, y0), side(bx, by, cx, cy, x1, y1)
                    if a0 == 0.0 and a1 == 0.0:
                        if _aside(bx, by, cx, cy) <= 0.0:
                            continue
                    else:
                        lo, hi = _cut(lo, hi, a0, a1)
                        if lo >= hi:
                            continue
                    b0, b1 = side(cx, cy, ax, ay, x0, y0), side(cx, cy, ax, ay, x1, y1)
                    if b0 == 0.0 and b1 == 0.0:
                        if _aside(cx, cy, ax, ay) <= 0.0:
                            continue
                    else:
                        lo, hi = _cut(lo, hi, b0, b1)
                        if lo >= hi:
                            continue
                    g0 = (a0 * (aq - q0) + b0 * (bq - q0) + c0 * (cq - q0)) / area
                    g1 = (a1 * (aq - q1) + b1 * (bq - q1) + c1 * (cq - q1)) / area
                    # Metres across the surface, not along the line of sight: what is seen at a glancing angle is no farther away.
                    middle = q0 + 0.5 * (lo + hi) * (q1 - q0)
                    if perspective == 1:
                        needed = slack[line] * scale * middle * math.sqrt(middle * middle / (scale * scale) + slope)
                    else:
                        needed = slack[line] * scale * math.sqrt(1.0 + slope)
                    lo, hi = _cut(lo, hi, g0 - needed, g1 - needed)
                    if lo >= hi:
                        continue
                    if n < room:
                        hidden_line[n] = line
                        hidden[n, 0], hidden[n, 1] = lo, hi
                    n += 1
    count[0] = n
