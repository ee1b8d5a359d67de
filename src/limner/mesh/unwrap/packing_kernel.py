"""Charts as texels, and the first place where they fit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..._jit import kernel

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_HALF = 0.51  # of a texel's side, and a little for rounding


@kernel
def cover(corners, grid):
    """Mark every texel of `grid`, (height, width), that a triangle of `corners`, (k, 3, 2) in texels, touches.

    A square and a triangle are apart where one of the square's two axes or of the triangle's three normals separates them.
    """
    height, width = grid.shape
    for t in range(len(corners)):
        ax, ay, bx, by, cx, cy = corners[t, 0, 0], corners[t, 0, 1], corners[t, 1, 0], corners[t, 1, 1], corners[t, 2, 0], corners[t, 2, 1]
        turn = 1.0 if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) >= 0.0 else -1.0
        i0, i1 = max(math.floor(min(ax, bx, cx)), 0), min(math.floor(max(ax, bx, cx)), width - 1)
        j0, j1 = max(math.floor(min(ay, by, cy)), 0), min(math.floor(max(ay, by, cy)), height - 1)
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                if grid[j, i] != 0:
                    continue
                x, y = i + 0.5, j + 0.5
                apart = False
                for e in range(3):
                    ex, ey = corners[t, e, 0], corners[t, e, 1]
                    dx, dy = corners[t, (e + 1) % 3, 0] - ex, corners[t, (e + 1) % 3, 1] - ey
                    # The corner of the square that is farthest inside
                    if turn * (dx * (y - ey) - dy * (x - ex)) + _HALF * (abs(dx) + abs(dy)) < 0.0:
                        apart = True
                        break
                if not apart:
                    grid[j, i] = 1


@kernel
def runs_of(grid, rows, starts, sizes, count):
    """List the runs of marked texels in the rows of `grid`."""
    height, width = grid.shape
    n = 0
    for j in range(height):
        i = 0
        while i < width:
            if grid[j, i] == 0:
                i += 1
                continue
            begin = i
            while i < width and grid[j, i] != 0:
                i += 1
            rows[n], starts[n], sizes[n] = j, begin, i - begin
            n += 1
    count[0] = n


@kernel
def find_place(next_taken, rows, starts, sizes, width, height, columns, limit, found):
    """Find the lowest place, of these the leftmost, where runs lie free; its top must stay at or below `limit`.

    `next_taken[j, i]` is the first taken texel of row j from column i on. A run that meets one says how far to the right the whole chart
    must go at least, so that few places are tried. `found` becomes x, y; y is -1 where there is none.
    """
    found[0], found[1] = 0, -1
    n = len(rows)
    for y in range(limit - height + 1):
        x = 0
        while x + width <= columns:
            further = 0
            for k in range(n):
                begin = x + starts[k]
                taken = next_taken[y + rows[k], begin]
                if taken < begin + sizes[k]:
                    further = taken + 1 - begin
                    break
            if further == 0:
                found[0], found[1] = x, y
                return
            x += further


@kernel
def take(taken, next_taken, rows, starts, sizes, x, y, height, margin):
    """Take the texels of runs placed at (x, y), and those up to `margin` away, along both axes."""
    n_rows, n_columns = taken.shape
    for k in range(len(rows)):
        begin, end = max(x + starts[k] - margin, 0), min(x + starts[k] + sizes[k] + margin, n_columns)
        for j in range(max(y + rows[k] - margin, 0), min(y + rows[k] + margin + 1, n_rows)):
            for i in range(begin, end):
                taken[j, i] = 1
    for j in range(max(y - margin, 0), min(y + height + margin, n_rows)):
        following = next_taken[j, n_columns]
        for i in range(n_columns - 1, -1, -1):
            if taken[j, i] != 0:
                following = i
            next_taken[j, i] = following
