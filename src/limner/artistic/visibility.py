"""What hides a line, exactly: how many surfaces lie in front of each of its parts (FoCG 10.3.1, 12.4).

On the picture a line is straight, a triangle is the part of a plane on the inner side of three straight lines, and whether the one lies
behind the other is the sign of a linear function. So a triangle hides *one* interval of a line, whose ends are quotients of areas; the
intervals of all triangles, laid over one another, say how many hide each part. The ends of the intervals of two triangles that share an
edge come from the same numbers and fall together to the bit: a surface hides without gaps.

                  triangle 1   triangle 2                 hidden by    0      1           0      1     0
      line  -----|============|===========|------                  |-----|===========|-----|======|-----|

A line never is hidden by the surface that it lies on: at an edge the area is exactly 0, at a corner the difference of depth is, and what
lies in front by no more than rounding moves things does not count.

The triangles meet the lines in the cells of a grid over the picture. The time is that of looking at every triangle once, and at each pair
of a triangle and a piece of line that lie over each other.

**Source**: L. G. Roberts, *Machine Perception of Three-Dimensional Solids*, 1963 (lines against surfaces, in intervals); A. Appel, "The
Notion of Quantitative Invisibility and the Machine Rendering of Solids", ACM 1967 (the number of surfaces in front).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from .segments import Segments
from .sight_lines import SightLines
from .surfaces import Surfaces

__all__ = ["Grid", "Parts", "Thrown", "grid_of", "hiding_triangles", "parts_of", "thrown"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_AT_ONCE = 1 << 18  # triangles between two looks at whether to go on
_LEAST_CELL, _MOST_CELL, _MOST_CELLS = 4.0, 16.0, 256  # pixels; along each side of the picture
_TINY = 1e-6  # pixels: parts that rounding leaves between intervals which fall together

_find_hidden = Door(
    "limner.artistic.visibility_kernel",
    "find_hidden",
    (
        Array(np.float64, 2), Array(np.int64, 1), Scalar(np.int64), Scalar(np.int64), Array(np.float64, 2), Array(np.int64, 2),
        Array(np.float64, 1), Array(np.int64, 1), Array(np.int64, 1), Array(np.float64, 2), Scalar(np.float64), Scalar(np.int64),
        Scalar(np.int64), Scalar(np.float64), Scalar(np.int64), Array(np.int64, 1), Array(np.float64, 2), Array(np.int64, 1),
    ),
    "what hides lines",
)  # fmt: skip


class Thrown(NamedTuple):
    """Segments on the picture.

    Attributes
    ----------
    segments : Segments
        Those that lie before the near plane at least in part, cut there.
    lines : (k, 2, 3) float64
        x, y and q of their ends.
    inside : (k, 2) float64
        From where to where along the line, 0 to 1 on the picture, it is in the picture.
    """

    segments: Segments
    lines: Floats
    inside: Floats


class Parts(NamedTuple):
    """Parts of lines, line after line and from start to end, without gaps: which line, from where to where (0 to 1), hidden by how many."""

    line: Indices
    span: Floats
    hidden_by: Indices


def thrown(segments: Segments, sight: SightLines) -> Thrown:
    """Throw segments on the picture, cut by the near plane, the far plane and the picture's edges."""
    depth = sight.depths(segments.ends)
    kept = np.asarray((depth > sight.near).any(axis=1) & (depth < sight.far).any(axis=1) & np.isfinite(depth).all(axis=1))
    segments, depth = segments.where(kept), depth[kept]
    ends = segments.ends.copy()
    for limit, sign in ((sight.near, -1.0), (sight.far, 1.0)):
        for end in (0, 1):
            rows = np.flatnonzero((depth[:, end] - limit) * sign > 0.0)
            ends[rows, end] = _between(ends[rows, end], ends[rows, 1 - end], depth[rows, end], depth[rows, 1 - end], limit)
            depth[rows, end] = limit
    segments = segments._replace(ends=ends)
    lines = sight.project(ends)
    inside = _in_picture(lines, sight.width, sight.height)
    kept = inside[:, 0] < inside[:, 1]
    return Thrown(segments.where(kept), lines[kept], inside[kept])


def _between(a: Floats, b: Floats, depth_a: Floats, depth_b: Floats, limit: float) -> Floats:
    """Where lines from a, beyond a limit of depth, to b reach it, (n, 3)."""
    return a + ((limit - depth_a) / (depth_b - depth_a))[:, None] * (b - a)


def _in_picture(lines: Floats, width: int, height: int) -> Floats:
    span = np.zeros((len(lines), 2))
    span[:, 1] = 1.0
    for axis, most in ((0, width), (1, height)):
        start, end = lines[:, 0, axis], lines[:, 1, axis]
        for f0, f1 in ((start, end), (most - start, most - end)):
            with np.errstate(divide="ignore", invalid="ignore"):
                t = f0 / (f0 - f1)
            span[:, 0] = np.where(f0 < 0.0, np.maximum(span[:, 0], t), span[:, 0])
            span[:, 1] = np.where(f1 < 0.0, np.minimum(span[:, 1], t), span[:, 1])
            span[:, 1] = np.where((f0 < 0.0) & (f1 < 0.0), -1.0, span[:, 1])
    return span


def hiding_triangles(surfaces: Surfaces, sight: SightLines) -> tuple[Floats, Indices]:
    """Triangles on the picture, cut by the near plane: (m, 9) float64 rows x, y, q of three corners, and (m,) which each is a part of."""
    depth = sight.depths(surfaces.points)
    behind = (depth < sight.near)[surfaces.triangles]
    whole = np.flatnonzero(~behind.any(axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):  # points behind the eye, which no whole triangle has
        corners = sight.project(surfaces.points)[surfaces.triangles[whole]].reshape(-1, 9)
    cut = np.flatnonzero(behind.any(axis=1) & ~behind.all(axis=1))
    if not len(cut):
        return corners, whole
    parts, source = [corners], [whole]
    for one_left in (True, False):
        rows = cut[(behind[cut].sum(axis=1) == 2) == one_left]
        # The corner that is alone on its side of the plane comes first.
        alone = (behind[rows] != one_left).argmax(axis=1)
        a, b, c = (surfaces.triangles[rows, (alone + k) % 3] for k in range(3))
        p, q, r = surfaces.points[a], surfaces.points[b], surfaces.points[c]
        if one_left:
            pieces = [(p, _between(q, p, depth[b], depth[a], sight.near), _between(r, p, depth[c], depth[a], sight.near))]
        else:
            on_b, on_c = (_between(p, far, depth[a], depth[k], sight.near) for far, k in ((q, b), (r, c)))
            pieces = [(on_b, q, r), (on_b, r, on_c)]
        for piece in pieces:
            parts.append(sight.project(np.stack(piece, axis=1)).reshape(-1, 9))
            source.append(rows)
    return np.ascontiguousarray(np.concatenate(parts)), np.concatenate(source)


class Grid(NamedTuple):
    """Pieces of lines in the cells of a grid: cell i has pieces start[i] to start[i + 1], (start, end, least q) of lines `line`."""

    start: Indices
    line: Indices
    pieces: Floats
    size: float
    columns: int
    rows: int


def parts_of(
    found: Thrown,
    triangles: Floats,
    source: Indices,
    sight: SightLines,
    on_progress: Callable[[float], object],
) -> Parts:
    """Cut lines where what hides them changes; `on_progress` hears which share of the triangles has been looked at, and may stop it."""
    grid = grid_of(found, sight.width, sight.height)
    lines = np.ascontiguousarray(found.lines.reshape(-1, 6))
    own, slack = np.ascontiguousarray(found.segments.triangles), np.ascontiguousarray(found.segments.slack)
    hidden_line, hidden, count = np.empty(1 << 16, dtype=np.int64), np.empty((1 << 16, 2)), np.zeros(1, dtype=np.int64)
    line_parts, span_parts = [], []
    for first in range(0, len(triangles), _AT_ONCE):
        last = min(first + _AT_ONCE, len(triangles))
        for _ in range(2):
            _find_hidden(
                triangles, source, first, last, lines, own, slack, grid.start, grid.line, grid.pieces, grid.size, grid.columns,
                grid.rows, sight.pixels, int(sight.perspective), hidden_line, hidden, count,
            )  # fmt: skip
            n = int(count[0])
            if n <= len(hidden):
                break
            hidden_line, hidden = np.empty(n, dtype=np.int64), np.empty((n, 2))
        line_parts.append(hidden_line[:n].copy())
        span_parts.append(hidden[:n].copy())
        on_progress(last / len(triangles))
    none = (np.zeros(0, dtype=np.int64), np.zeros((0, 2)))
    return _laid_over(found, np.concatenate(line_parts) if line_parts else none[0], np.concatenate(span_parts) if span_parts else none[1])


def grid_of(found: Thrown, width: int, height: int) -> Grid:
    """Sort pieces of lines into cells of a picture, which are about as large as the lines are long."""
    n = len(found.lines)
    start, way = found.lines[:, 0], found.lines[:, 1] - found.lines[:, 0]
    mean = float(np.hypot(way[:, 0], way[:, 1]).mean()) if n else 0.0
    size = max(_LEAST_CELL, max(width, height) / _MOST_CELLS, min(mean, _MOST_CELL))
    columns, rows = int(np.ceil(width / size)), int(np.ceil(height / size))
    at = start[:, None, :2] + found.inside[:, :, None] * way[:, None, :2]
    line_parts, t_parts = [np.repeat(np.arange(n), 2)], [found.inside.reshape(-1)]
    for axis in (0, 1):
        low, high = np.floor(at[:, :, axis].min(axis=1) / size), np.ceil(at[:, :, axis].max(axis=1) / size)
        crossed = np.maximum(high - low - 1.0, 0.0).astype(np.int64)
        line = np.repeat(np.arange(n), crossed)
        step = np.arange(len(line)) - np.repeat(np.cumsum(crossed) - crossed, crossed) + 1.0
        with np.errstate(divide="ignore", invalid="ignore"):
            t = ((low[line] + step) * size - start[line, axis]) / way[line, axis]
        inside = (t > found.inside[line, 0]) & (t < found.inside[line, 1])
        line_parts.append(line[inside])
        t_parts.append(t[inside])
    line, t = np.concatenate(line_parts), np.concatenate(t_parts)
    order = np.lexsort((t, line))
    line, t = line[order], t[order]
    kept = np.flatnonzero((line[1:] == line[:-1]) & (t[1:] > t[:-1]))
    line, lo, hi = line[kept], t[kept], t[kept + 1]
    middle = start[line, :2] + (0.5 * (lo + hi))[:, None] * way[line, :2]
    column = np.clip(np.floor(middle[:, 0] / size), 0, columns - 1).astype(np.int64)
    row = np.clip(np.floor(middle[:, 1] / size), 0, rows - 1).astype(np.int64)
    q = start[line, 2], way[line, 2]
    least = np.minimum(q[0] + lo * q[1], q[0] + hi * q[1])
    cell = row * columns + column
    order = np.argsort(cell, kind="stable")
    begins = np.searchsorted(cell[order], np.arange(columns * rows + 1))
    pieces = np.ascontiguousarray(np.stack([lo, hi, least], axis=1)[order])
    return Grid(begins.astype(np.int64), np.ascontiguousarray(line[order]), pieces, float(size), columns, rows)


def _laid_over(found: Thrown, line: Indices, span: Floats) -> Parts:
    """How many of some intervals lie over each part of the lines: `line` (n,) says of which line each interval in `span` (n, 2) is."""
    n = len(found.lines)
    every = np.arange(n)
    # What begins and ends a line is neither a beginning nor an end of an interval.
    lines = np.concatenate([every, every, line, line])
    t = np.concatenate([found.inside[:, 0], found.inside[:, 1], span[:, 0], span[:, 1]])
    change = np.concatenate([found.segments.hidden, -found.segments.hidden, np.ones(len(line), np.int64), -np.ones(len(line), np.int64)])
    order = np.lexsort((t, lines))
    lines, t, count = lines[order], t[order], np.cumsum(change[order])
    length = np.hypot(*(found.lines[:, 1, :2] - found.lines[:, 0, :2]).T)
    kept = np.flatnonzero((lines[1:] == lines[:-1]) & ((t[1:] - t[:-1]) * length[lines[:-1]] > _TINY))
    line, start, count = lines[kept], t[kept], count[kept]
    if not len(kept):
        return Parts(line, np.zeros((0, 2)), count)
    # Parts with one count become one, and what was too small to keep falls to the part before it.
    begins = np.ones(len(kept), dtype=bool)
    begins[1:] = (line[1:] != line[:-1]) | (count[1:] != count[:-1])
    line, start, count = line[begins], start[begins], count[begins]
    is_first, is_last = np.ones(len(line), dtype=bool), np.ones(len(line), dtype=bool)
    is_first[1:] = is_last[:-1] = line[1:] != line[:-1]
    end = np.append(start[1:], 0.0)
    return Parts(
        line,
        np.stack([np.where(is_first, found.inside[line, 0], start), np.where(is_last, found.inside[line, 1], end)], axis=1),
        count,
    )
