"""How much of each pixel a shape covers, exactly, whatever its edges do to each other.

A shape is a set of straight edges that come back to where they started. Row by row of pixels, the edges that are there are cut
where one begins, ends, or crosses another; in such a slab they have an order from left to right, counting windings along it
tells where the shape's inside begins and ends, and the edges where it does are its true outline. The outline's pieces are added
up as signed areas: a piece adds, to all pixels on its right, the height that it spans, and to the pixels it passes through the
part on its right. The running sum along the row is the covered area of each pixel, without any sampling.

    edge        begins  y .-------.          slab: between two cuts all edges run from top to bottom
                         /  slab  |          and none crosses another
                      y' '--------'

**Source**: the signed areas are those of Levien's font-rs (2016) and FreeType's smooth rasteriser (Turner, 2000), which both
take the edges as they come: where two of them overlap in a pixel they add up what covers the same place twice. The cuts, as in
Hobby, *Practical segment intersection with finite precision output*, 1999, and the sweep of Bentley and Ottmann, 1979, come
first here, so that shapes that cross themselves, and strokes that are made of overlapping pieces, are exact too.
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel

f32 = np.float32

X_TOP, Y_TOP, Y_BOTTOM, SLOPE = 0, 1, 2, 3  # columns of an edge
OVER, MASK, MOSAIC = 0, 1, 2  # what a covered pixel becomes

_SAME = 1e-9  # pixels: edges nearer than this are at the same place
_CROWD = 400  # edges in a row of pixels beyond which it is sampled
_CROSSINGS = 4096  # crossings in one slab, times its edges, that are worth finding one by one
_THIN = 16.0  # slabs a pixel where rows are sampled
_LEAST_COVER = 1e-7

_A, _B, _C, _D = 0, 1, 2, 3  # rows of `xs`: where the edges are at a slab's top and bottom, and at those of a part of it


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
    xs[_A, i], xs[_A, i + 1] = xs[_A, i + 1], xs[_A, i]
    xs[_B, i], xs[_B, i + 1] = xs[_B, i + 1], xs[_B, i]


@kernel
def _sort(active, xs, n):
    """Order the edges by where they are at the top, those at the same place by the bottom; they nearly are in order."""
    for i in range(1, n):
        j = i
        while j > 0:
            apart = xs[_A, j] - xs[_A, j - 1]
            if abs(apart) <= _SAME:
                apart = xs[_B, j] - xs[_B, j - 1]
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
def _locate(edges, active, n, xs, where, y):
    """Write to xs[where] where the edges are at the height y."""
    for i in range(n):
        edge = active[i]
        xs[where, i] = edges[edge, X_TOP] + (y - edges[edge, Y_TOP]) * edges[edge, SLOPE]


@kernel
def _sampled(edges, following, end, winding, even_odd, active, n, xs, y, y_end, left, right, row, touched):
    """Where edges are too many: slabs so thin that the edges in their middle, in their order there, will do."""
    slabs = math.ceil((y_end - y) * _THIN)
    height = (y_end - y) / slabs
    for slab in range(slabs):
        top, bottom = y + slab * height, y + (slab + 1) * height
        middle = 0.5 * (top + bottom)
        following, n = _enter(edges, following, end, active, n, middle)
        n = _leave(edges, active, n, middle)
        _locate(edges, active, n, xs, _A, middle)
        _locate(edges, active, n, xs, _B, bottom)
        _sort(active, xs, n)
        _locate(edges, active, n, xs, _C, top)
        _emit(active, n, winding, even_odd, xs, _C, _B, height, left, right, row, touched)
    return following, n


@kernel
def _slab(edges, active, n, winding, even_odd, xs, top, bottom, left, right, row, touched):
    """Add what lies between two heights at which edges begin or end: cut it where they cross."""
    _locate(edges, active, n, xs, _A, top)
    _locate(edges, active, n, xs, _B, bottom)
    _sort(active, xs, n)
    worth = _CROSSINGS // n
    while True:
        part, at = _first_crossing(xs, n)
        if at < 0:
            _emit(active, n, winding, even_odd, xs, _A, _B, bottom - top, left, right, row, touched)
            return
        if worth == 0:
            _sampled(edges, 0, 0, winding, even_odd, active, n, xs, top, bottom, left, right, row, touched)
            return
        worth -= 1
        if part > 0.0:
            height = part * (bottom - top)
            for i in range(n):
                xs[_C, i] = xs[_A, i] + part * (xs[_B, i] - xs[_A, i])
            _emit(active, n, winding, even_odd, xs, _A, _C, height, left, right, row, touched)
            top += height
            for i in range(n):
                xs[_A, i] = xs[_C, i]
        _swap(active, xs, at)


@kernel
def _paint_row(row, touched, j, shape, paint, mode, target):
    """Turn the row's signed areas into coverage and paint it; leave the row cleared."""
    width = target.shape[1]
    total = 0.0
    r, g, b, a = f32(paint[shape, 0]), f32(paint[shape, 1]), f32(paint[shape, 2]), f32(paint[shape, 3])
    for column in range(touched[0], touched[1] + 2):
        total += row[column]
        row[column] = 0.0
        cover = min(total, 1.0)
        if cover > _LEAST_COVER and column < width:
            part = f32(cover)
            if mode == OVER:
                keep = f32(1.0) - a * part
                target[j, column, 0] = r * part + target[j, column, 0] * keep
                target[j, column, 1] = g * part + target[j, column, 1] * keep
                target[j, column, 2] = b * part + target[j, column, 2] * keep
                target[j, column, 3] = a * part + target[j, column, 3] * keep
            elif mode == MASK:
                target[j, column, 0] += part
            else:
                _add_tile(target, j, column, shape, paint, cover)
    touched[0], touched[1] = width, -1


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
def _next_event(edges, following, end, active, n, limit):
    """The height, at most `limit`, at which the next edge begins or ends."""
    event = limit
    if following < end:
        event = min(event, edges[following, Y_TOP])
    for i in range(n):
        event = min(event, edges[active[i], Y_BOTTOM])
    return event


@kernel
def _fill_row(edges, following, end, winding, even_odd, active, n, xs, y, y_end, left, right, row, touched):
    """Add all slabs of one row of pixels; returns where the edges stand below it."""
    entering = following
    while entering < end and edges[entering, Y_TOP] < y_end:
        entering += 1
    if n + entering - following > _CROWD:
        following, n = _sampled(
            edges, following, end, winding, even_odd, active, n, xs, y, y_end, left, right, row, touched
        )
        y = y_end
    while y < y_end:
        following, n = _enter(edges, following, end, active, n, y)
        bottom = _next_event(edges, following, end, active, n, y_end)
        if n > 0:
            _slab(edges, active, n, winding, even_odd, xs, y, bottom, left, right, row, touched)
        y = bottom
        n = _leave(edges, active, n, y)
    return following, _leave(edges, active, n, y_end)


@kernel
def _steady_rows(edges, following, end, active, n, xs, y, lower):
    """How many whole rows of pixels from y on have the same edges in the same order; puts these in order."""
    rows = int(_next_event(edges, following, end, active, n, lower) - y)
    if rows < 2 or n > _CROWD:
        return 0
    _locate(edges, active, n, xs, _A, y)
    _locate(edges, active, n, xs, _B, y + rows)
    _sort(active, xs, n)
    part, at = _first_crossing(xs, n)
    return rows if at < 0 else int(part * rows)


@kernel
def fill_shapes(edges, winding, starts, shapes, bounds, even_odd, paint, mode, target, active, xs, row, touched):
    """Paint some shapes, one after the other.

    `edges` stand in order of Y_TOP within each shape, in coordinates with the pixels' corners at integers; `bounds` is left,
    top, right, bottom inside the picture; `paint` has a premultiplied colour (4), for MOSAIC with derivatives and range (20),
    for each shape.
    """
    left, upper, right, lower = bounds[0], bounds[1], bounds[2], bounds[3]
    touched[0], touched[1] = target.shape[1], -1
    for number in range(shapes.shape[0]):
        shape = shapes[number]
        following, end = starts[shape], starts[shape + 1]
        n, y = 0, upper
        while n > 0 or following < end:
            if n == 0:
                y = max(y, edges[following, Y_TOP])
            if y >= lower:
                break
            j = int(y)
            following, n = _enter(edges, following, end, active, n, y)
            steady = 0
            if y == j and n > 0:
                steady = _steady_rows(edges, following, end, active, n, xs, y, lower)
            for _ in range(steady):
                _locate(edges, active, n, xs, _C, float(j))
                _locate(edges, active, n, xs, _D, j + 1.0)
                _emit(active, n, winding, even_odd, xs, _C, _D, 1.0, left, right, row, touched)
                _paint_row(row, touched, j, shape, paint, mode, target)
                j += 1
            y = max(y, float(j))
            if steady == 0:
                y_end = min(j + 1.0, lower)
                following, n = _fill_row(
                    edges, following, end, winding, even_odd, active, n, xs, y, y_end, left, right, row, touched
                )
                _paint_row(row, touched, j, shape, paint, mode, target)
                y = y_end
            n = _leave(edges, active, n, y)
