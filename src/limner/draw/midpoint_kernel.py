"""The midpoint algorithm in whole numbers (FoCG 8.1.1).

Coordinates are in units of 1/256 pixel, so that every product below is exact in 64 bits. A line that is wider than high is
walked column by column; one that is higher than wide is the same line with x and y exchanged.

In column x the pixel's row is the one nearest to the line: y = ceil(y_line(x) - 1/2), ties going to the smaller y. With

    D = 2 S dx,    N(x) = 2 (Y0 dx + dy (S x - X0)) - S dx,    y = ceil(N / D)

the number kept from column to column is d = N - D y, which is -2 times the book's implicit f(x, y + 1/2), scaled. It lies in
(-D, 0]. A step to the right adds 2 S dy; a positive d says that the line passes above the midpoint between this row and the
next, so the next is drawn. The line that falls is the same with the other sign.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

f32 = np.float32
SUBPIXELS = 256
_S = SUBPIXELS
_HALF = SUBPIXELS // 2


@kernel
def nearest_pixel(coordinate: int) -> int:
    """The pixel whose centre is nearest to a coordinate in 1/256; ties go to the smaller."""
    return -((_HALF - coordinate) // _S)


@kernel
def _ceil_division(n: int, d: int) -> int:
    """ceil(n / d) for d > 0."""
    return -((-n) // d)


@kernel
def _span(x0: int, y0: int, x1: int, y1: int, low_x: int, low_y: int, high_x: int, high_y: int) -> tuple[int, int]:
    """First and last column whose pixel lies in low <= pixel < high, for x0 <= x1 and |slope| <= 1; empty: last < first.

    The rows are solved for, not walked: y(x) >= low means N(x) > D (low - 1), and y(x) <= high - 1 means N(x) <= D (high - 1).
    """
    first, last = max(nearest_pixel(x0), low_x), min(nearest_pixel(x1), high_x - 1)
    dx, dy = x1 - x0, y1 - y0
    if dx == 0:
        row = nearest_pixel(y0)
        return (first, last) if low_y <= row and row < high_y else (0, -1)
    d = 2 * _S * dx
    at_zero = 2 * (y0 * dx - dy * x0) - _S * dx
    step = 2 * _S * dy
    above, below = d * (low_y - 1) - at_zero, d * (high_y - 1) - at_zero  # step x > above, step x <= below
    if step > 0:
        first = max(first, above // step + 1)
        last = min(last, below // step)
    elif step < 0:
        first = max(first, _ceil_division(-below, -step))
        last = min(last, _ceil_division(-above, -step) - 1)
    elif above >= 0 or below < 0:
        last = first - 1
    return first, last


@kernel
def _start(x0: int, y0: int, x1: int, y1: int, column: int) -> tuple[int, int]:
    """The row of a column's pixel, and the decision number d there."""
    dx, dy = x1 - x0, y1 - y0
    if dx == 0:
        return nearest_pixel(y0), 0
    d = 2 * _S * dx
    n = 2 * (y0 * dx + dy * (_S * column - x0)) - _S * dx
    row = _ceil_division(n, d)
    return row, n - d * row


@kernel
def _oriented(line: np.ndarray) -> tuple[int, int, int, int, int]:
    """Ends so that the first coordinate is the longer way and rises, and whether x and y were exchanged."""
    x0, y0, x1, y1 = line[0], line[1], line[2], line[3]
    steep = 0
    if abs(y1 - y0) > abs(x1 - x0):
        x0, y0, x1, y1 = y0, x0, y1, x1
        steep = 1
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    return x0, y0, x1, y1, steep


@kernel
def _column_range(x0: int, y0: int, x1: int, y1: int, steep: int, box: np.ndarray) -> tuple[int, int]:
    if steep == 1:
        return _span(x0, y0, x1, y1, box[1], box[0], box[3], box[2])
    return _span(x0, y0, x1, y1, box[0], box[1], box[2], box[3])


@kernel
def walk_line(line, box, out, count):
    """Write the pixels (x, y) of one line inside the box to `out`, and their number to count[0]; `line` in 1/256 pixel."""
    x0, y0, x1, y1, steep = _oriented(line)
    first, last = _column_range(x0, y0, x1, y1, steep, box)
    row, decision = _start(x0, y0, x1, y1, first)
    rise, whole = 2 * _S * (y1 - y0), 2 * _S * (x1 - x0)
    n = 0
    for column in range(first, last + 1):
        out[n, steep] = column
        out[n, 1 - steep] = row
        n += 1
        decision += rise
        if decision > 0:
            row += 1
            decision -= whole
        elif decision <= -whole:
            row -= 1
            decision += whole
    count[0] = n


@kernel
def draw_lines(lines, box, colors, target):
    """Paint lines over the picture, each pixel of a line once; premultiplied colours."""
    for k in range(lines.shape[0]):
        x0, y0, x1, y1, steep = _oriented(lines[k])
        first, last = _column_range(x0, y0, x1, y1, steep, box)
        row, decision = _start(x0, y0, x1, y1, first)
        rise, whole = 2 * _S * (y1 - y0), 2 * _S * (x1 - x0)
        keep = f32(1.0) - colors[k, 3]
        for column in range(first, last + 1):
            i, j = column, row
            if steep == 1:
                i, j = row, column
            for c in range(4):
                target[j, i, c] = colors[k, c] + target[j, i, c] * keep
            decision += rise
            if decision > 0:
                row += 1
                decision -= whole
            elif decision <= -whole:
                row -= 1
                decision += whole
