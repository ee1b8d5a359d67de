"""How much of each pixel a shape covers, exactly, whatever its edges do to each other.

A shape is a set of straight edges that come back to where they started. Row by row of pixels, the edges that are there are cut where one
begins, ends, or crosses another; in such a slab they have an order from left to right, counting windings along it tells where the
shape's inside begins and ends, and the edges where it does are its true outline. The outline's pieces are added up as signed areas: a
piece adds, to all pixels on its right, the height that it spans, and to the pixels it passes through the part on its right. The running
sum along the row is the covered area of each pixel, without any sampling.

    edge        begins  y .-------.          slab: between two cuts all edges run from top to bottom
                         /  slab  |          and none crosses another
                      y' '--------'

**Source**: the signed areas are those of Levien's font-rs (2016) and FreeType's smooth rasteriser (Turner, 2000), which both take the
edges as they come: where two of them overlap in a pixel they add up what covers the same place twice. The cuts, as in Hobby,
*Practical segment intersection with finite precision output*, 1999, and the sweep of Bentley and Ottmann, 1979, come first here, so that
shapes that cross themselves, and strokes that are made of overlapping pieces, are exact too.
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel

f32 = np.float32

X_TOP, Y_TOP, Y_BOTTOM, SLOPE = 0, 1, 2, 3  # columns of an edge
OVER, MASK, MOSAIC = 0, 1, 2  # what a covered pixel becomes

_SAME = 1e-9  # pixels: edges nearer than this are at the same place
_CROSSINGS = 4096  # crossings in one slab times its edges that are worth finding one by one
_THIN = 16.0  # slabs a pixel where there are more
_LEAST_COVER = 1e-7

_A, _B, _C, _D, _MIDDLE = 0, 1, 2, 3, 4  # rows of `xs`: at the slab's top and bottom, at a cut's, and between


@kernel
def _add_column(row, touched, x, weight):
    """A vertical piece at x."""
    column = int(x)
    inside = x - column
    row[column] += weight * (1.0 - inside)
    row[column + 1] += weight * inside
    touched[0] = min(touched[0], column)
    touched[1] = max(touched[1], column)


@kernel
def _add_slanted(row, touched, low, high, weight):
    """A piece that goes from x = low to x = high, up or down."""
    first, last = int(low), int(high)
    if first == last:
        _add_column(row, touched, 0.5 * (low + high), weight)
        return
    per_x = weight / (high - low)
    x = low
    for column in range(first, last + 1):
        end = min(column + 1.0, high)
        share = per_x * (end - x)
        inside = 0.5 * (x + end) - column
        row[column] += share * (1.0 - inside)
        row[column + 1] += share * inside
        x = end
    touched[0] = min(touched[0], first)
    touched[1] = max(touched[1], last)


@kernel
def _add_piece(row, touched, x0, x1, weight, left, right):
    """A piece of the outline, held between left and right: what lies beyond moves to the bound, where it covers the same."""
    low, high = min(x0, x1), max(x0, x1)
    if high <= left:
        _add_column(row, touched, left, weight)
    elif low >= right:
        _add_column(row, touched, right, weight)
    elif low >= left and high <= right:
        _add_slanted(row, touched, low, high, weight)
    else:
        per_x = weight / (high - low)
        if low < left:
            _add_column(row, touched, left, per_x * (left - low))
            low = left
        if high > right:
            _add_column(row, touched, right, per_x * (high - right))
            high = right
        _add_slanted(row, touched, low, high, per_x * (high - low))


@kernel
def _is_inside(count: int, even_odd: int) -> bool:
    if even_odd == 1:
        return (count & 1) != 0
    return count != 0


@kernel
def _emit(active, n, winding, even_odd, xs, top, bottom, height, left, right, row, touched):
    """Add the outline's pieces of a slab whose edges are in order."""
    if height <= 0.0:
        return
    count = 0
    for i in range(n):
        before = _is_inside(count, even_odd)
        count += winding[active[i]]
        if _is_inside(count, even_odd) != before:
            weight = -height if before else height
            _add_piece(row, touched, xs[top, i], xs[bottom, i], weight, left, right)


@kernel
def _swap(active, xs, i):
    active[i], active[i + 1] = active[i + 1], active[i]
    for k in range(5):
        xs[k, i], xs[k, i + 1] = xs[k, i + 1], xs[k, i]


@kernel
def _sort(active, xs, n, first, second):
    """Order the edges by xs[first], those at the same place by xs[second]; they nearly are."""
    for i in range(1, n):
        j = i
        while j > 0:
            apart = xs[first, j] - xs[first, j - 1]
            if abs(apart) <= _SAME:
                apart = xs[second, j] - xs[second, j - 1]
            if apart >= 0.0:
                break
            _swap(active, xs, j - 1)
            j -= 1


@kernel
def _first_crossing(xs, n):
    """The neighbours that cross first in the slab, and after which part of it; -1 where none do."""
    part, at = 2.0, -1
    for i in range(n - 1):
        beyond = xs[_B, i] - xs[_B, i + 1]
        if beyond > _SAME:
            apart = max(0.0, xs[_A, i + 1] - xs[_A, i])
            if apart / (apart + beyond) < part:
                part, at = apart / (apart + beyond), i
    return part, at


@kernel
def _thin_slabs(active, n, winding, even_odd, xs, height, left, right, row, touched):
    """Where edges cross too often: slabs so thin that the order in their middle will do."""
    slabs = int(math.ceil(height * _THIN))
    for slab in range(slabs):
        start, end = slab / slabs, (slab + 1) / slabs
        for i in range(n):
            way = xs[_B, i] - xs[_A, i]
            xs[_C, i] = xs[_A, i] + start * way
            xs[_D, i] = xs[_A, i] + end * way
            xs[_MIDDLE, i] = 0.5 * (xs[_C, i] + xs[_D, i])
        _sort(active, xs, n, _MIDDLE, _D)
        _emit(active, n, winding, even_odd, xs, _C, _D, height / slabs, left, right, row, touched)


@kernel
def _slab(edges, active, n, winding, even_odd, xs, top, bottom, left, right, row, touched):
    """Add what lies between two heights at which edges begin or end: cut it where they cross."""
    for i in range(n):
        edge = active[i]
        xs[_A, i] = edges[edge, X_TOP] + (top - edges[edge, Y_TOP]) * edges[edge, SLOPE]
        xs[_B, i] = edges[edge, X_TOP] + (bottom - edges[edge, Y_TOP]) * edges[edge, SLOPE]
    _sort(active, xs, n, _A, _B)
    height = bottom - top
    worth = _CROSSINGS // n
    while True:
        part, at = _first_crossing(xs, n)
        if at < 0:
            _emit(active, n, winding, even_odd, xs, _A, _B, height, left, right, row, touched)
            return
        if worth == 0:
            _thin_slabs(active, n, winding, even_odd, xs, height, left, right, row, touched)
            return
        worth -= 1
        if part > 0.0:
            for i in range(n):
                xs[_C, i] = xs[_A, i] + part * (xs[_B, i] - xs[_A, i])
            _emit(active, n, winding, even_odd, xs, _A, _C, part * height, left, right, row, touched)
            height -= part * height
            for i in range(n):
                xs[_A, i] = xs[_C, i]
        _swap(active, xs, at)


@kernel
def _paint_row(row, touched, j, shape, paint, mode, target):
    """Turn the row's signed areas into coverage and paint it; leave the row cleared."""
    width = target.shape[1]
    total = 0.0
    alpha = f32(paint[shape, 3])
    for column in range(touched[0], touched[1] + 2):
        total += row[column]
        row[column] = 0.0
        cover = min(total, 1.0)
        if cover > _LEAST_COVER and column < width:
            part = f32(cover)
            if mode == OVER:
                keep = f32(1.0) - alpha * part
                for c in range(4):
                    target[j, column, c] = f32(paint[shape, c]) * part + target[j, column, c] * keep
            elif mode == MASK:
                target[j, column, 0] += part
            else:
                _add_tile(target, j, column, shape, paint, cover)


@kernel
def _add_tile(target, j, column, shape, paint, cover):
    """Add a gradient's colour at the pixel's centre, held within the range of its corners: c = c0 + cx x + cy y."""
    for c in range(4):
        value = paint[shape, c] + paint[shape, 4 + c] * column + paint[shape, 8 + c] * j
        value = min(max(value, paint[shape, 12 + c]), paint[shape, 16 + c])
        target[j, column, c] += f32(value * cover)
    target[j, column, 4] += f32(cover)


@kernel
def _enter(edges, following, end, active, n, y):
    """Take up the edges that begin at y or above and go on below it."""
    while following < end and edges[following, Y_TOP] <= y:
        if edges[following, Y_BOTTOM] > y:
            active[n] = following
            n += 1
        following += 1
    return following, n


@kernel
def _leave(edges, active, n, y):
    """Let go of the edges that end at y; the others keep their order."""
    kept = 0
    for i in range(n):
        if edges[active[i], Y_BOTTOM] > y:
            active[kept] = active[i]
            kept += 1
    return kept


@kernel
def _fill_row(edges, following, end, winding, even_odd, active, n, xs, y, y_end, left, right, row, touched):
    """Add all slabs of one row of pixels; returns where the edges stand below it."""
    while y < y_end:
        following, n = _enter(edges, following, end, active, n, y)
        bottom = y_end
        if following < end:
            bottom = min(bottom, edges[following, Y_TOP])
        for i in range(n):
            bottom = min(bottom, edges[active[i], Y_BOTTOM])
        if n > 0:
            _slab(edges, active, n, winding, even_odd, xs, y, bottom, left, right, row, touched)
        y = bottom
        n = _leave(edges, active, n, y)
    return following, n


@kernel
def fill_shapes(edges, winding, starts, bounds, even_odd, paint, mode, target, active, xs, row, touched):
    """Paint shapes, one after the other.

    `edges` stand in order of Y_TOP within each shape, in coordinates with the pixels' corners at integers; `bounds` is left, top, right,
    bottom inside the picture; `paint` has a premultiplied colour (4), for MOSAIC with derivatives and range (20), for each shape.
    """
    left, upper, right, lower = bounds[0], bounds[1], bounds[2], bounds[3]
    for shape in range(starts.shape[0] - 1):
        following, end = starts[shape], starts[shape + 1]
        n, y = 0, upper
        while n > 0 or following < end:
            if n == 0:
                y = max(y, edges[following, Y_TOP])
            if y >= lower:
                break
            j = int(y)
            y_end = min(j + 1.0, lower)
            touched[0], touched[1] = target.shape[1], -1
            following, n = _fill_row(
                edges, following, end, winding, even_odd, active, n, xs, y, y_end, left, right, row, touched
            )
            _paint_row(row, touched, j, shape, paint, mode, target)
            y = y_end
