"""Lines that are seen in one place, of which one is enough.

Seen from the front, the far edges of a box stand exactly behind its near ones, and two boxes that touch have edges in common. Drawn twice,
a line is darker than its neighbours, and a dashed one is filled by the dashes of the other. The nearest is drawn: what hides it hides
those behind it. Where lines are divided differently, the parts that they have in common are told apart from those that they have not.

         ________|_____________      near                ________ _____________
            |_____________|______    far                                       ______
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from .segments import Segments, joined
from .sight_lines import SightLines
from .visibility import Thrown, grid_of, thrown

__all__ = ["without_doubles"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_GRID = 1e-4  # pixels
_TOGETHER = 0.01  # pixels between lines that are one
_SHIFT = np.array([0.3183, 0.2718, 0.0])  # pixels, so that no line at a whole number of them runs between two cells

_find_doubles = Door(
    "limner.artistic.doubles_kernel",
    "find_doubles",
    (
        Array(np.float64, 2), Array(np.int64, 1), Array(np.int64, 1), Array(np.int64, 1), Array(np.float64, 2), Scalar(np.float64),
        Array(np.int64, 1), Array(np.float64, 2), Array(np.int64, 1),
    ),
    "lines before lines",
)  # fmt: skip


def without_doubles(found: Thrown, sight: SightLines) -> Thrown:
    """Leave out what has a nearer line exactly before it, pieces and parts of pieces."""
    found = _without_copies(found)
    line, span = _covered(found, sight)
    if not len(line):
        return found
    row, t0, t1 = _bare(found, line, span)
    cut = np.zeros(len(found.lines), dtype=bool)
    cut[line] = True
    parts = found.segments.where(row)._replace(ends=_between(found, row, t0, t1, sight))
    return _joined(_where(found, ~cut), thrown(parts, sight))


def _without_copies(found: Thrown) -> Thrown:
    """Leave out pieces that have both ends, on the picture, in common with a nearer one."""
    ends = np.rint(found.lines[:, :, :2] / _GRID)
    turned = (ends[:, 0, 0] > ends[:, 1, 0]) | ((ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] > ends[:, 1, 1]))
    ends[turned] = ends[turned, ::-1]
    columns = ends.reshape(-1, 4).T
    nearness = found.lines[:, :, 2].sum(axis=1)
    # Those in one place side by side, the nearest first; of equally near ones the first stays first.
    order = np.lexsort((-nearness, *columns))
    same = np.zeros(len(order), dtype=bool)
    same[1:] = (columns[:, order][:, 1:] == columns[:, order][:, :-1]).all(axis=0)
    kept = np.ones(len(order), dtype=bool)
    kept[order[same]] = False
    return _where(found, kept)


def _covered(found: Thrown, sight: SightLines) -> tuple[Indices, Floats]:
    """Which lines have others before them, (n,), and from where to where, (n, 2)."""
    grid = grid_of(found._replace(lines=found.lines + _SHIFT), sight.width + 1, sight.height + 1)
    lines = np.ascontiguousarray(found.lines.reshape(-1, 6))
    room, count = 1 << 12, np.zeros(1, dtype=np.int64)
    for _ in range(2):
        line, span = np.empty(room, dtype=np.int64), np.empty((room, 2))
        _find_doubles(lines, found.segments.kind, grid.start, grid.line, grid.pieces, _TOGETHER, line, span, count)
        if count[0] <= room:
            break
        room = int(count[0])
    return line[: count[0]], span[: count[0]]


def _bare(found: Thrown, line: Indices, span: Floats) -> tuple[Indices, Floats, Floats]:
    """What is left of the lines that are covered in part: which, and from where to where."""
    order = np.lexsort((span[:, 0], line))
    line, span = line[order], span[order]
    first = np.append(True, line[1:] != line[:-1])
    # Up to where everything before an interval reaches, line by line: lines one after the other on one long axis.
    reach = np.maximum.accumulate(span[:, 1] + 2.0 * line) - 2.0 * line
    start = np.where(first, found.inside[line, 0], np.append(0.0, reach[:-1]))
    rows, firsts, ends = line, start, span[:, 0]
    last = np.append(first[1:], True)
    rows, firsts = np.concatenate([rows, line[last]]), np.concatenate([firsts, reach[last]])
    ends = np.concatenate([ends, found.inside[line[last], 1]])
    length = np.hypot(*(found.lines[rows, 1, :2] - found.lines[rows, 0, :2]).T)
    kept = np.flatnonzero((ends - firsts) * length > _TOGETHER)
    kept = kept[np.lexsort((firsts[kept], rows[kept]))]
    return rows[kept], firsts[kept], ends[kept]


def _between(found: Thrown, row: Indices, t0: Floats, t1: Floats, sight: SightLines) -> Floats:
    """(n, 2, 3): the places in the world of parts of lines; an end of the line is itself, to the bit."""
    ends = found.segments.ends[row]
    made = np.empty((len(row), 2, 3))
    for k, t in enumerate((t0, t1)):
        q0, q1 = found.lines[row, 0, 2], found.lines[row, 1, 2]
        # Even steps on the picture are no even steps in space (FoCG 11.3.1).
        s = t * q1 / (q0 + t * (q1 - q0)) if sight.perspective else t
        between = ends[:, 0] + s[:, None] * (ends[:, 1] - ends[:, 0])
        made[:, k] = np.where((t <= 0.0)[:, None], ends[:, 0], np.where((t >= 1.0)[:, None], ends[:, 1], between))
    return made


def _where(found: Thrown, chosen: NDArray[np.bool_]) -> Thrown:
    return Thrown(found.segments.where(chosen), found.lines[chosen], found.inside[chosen])


def _joined(one: Thrown, other: Thrown) -> Thrown:
    segments: Segments = joined([one.segments, other.segments])
    return Thrown(segments, np.concatenate([one.lines, other.lines]), np.concatenate([one.inside, other.inside]))
