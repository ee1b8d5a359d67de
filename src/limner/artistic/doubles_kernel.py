"""Which parts of lines on the picture have another line exactly before them, cell by cell of a grid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def _is_before(q: float, other_q: float, kind: int, other_kind: int, row: int, other_row: int) -> int:
    """Whether the other is the one to keep: the nearer; of equally near ones the one of the lower kind, then the first."""
    slack = 1e-9 * (abs(q) + abs(other_q))
    if abs(other_q - q) > slack:
        return 1 if other_q > q else 0
    if other_kind != kind:
        return 1 if other_kind < kind else 0
    return 1 if other_row < row else 0


@kernel
def find_doubles(
    lines: Floats,
    kind: Indices,
    cell_start: Indices,
    piece_line: Indices,
    pieces: Floats,
    tolerance: float,
    covered_line: Indices,
    covered: Floats,
    count: Indices,
) -> None:
    """List what lies exactly behind what.

    `lines` are rows (x0, y0, q0, x1, y1, q1), `kind` (k,) their kinds, lower ones first; in the grid's cells stand `pieces` of lines,
    (start, end, least q). A line `covered_line[n]` has another within `tolerance` pixels before it from covered[n, 0] to covered[n, 1].
    `count` becomes how many such parts there are, which may be more than there was room for.
    """
    n = 0
    room = covered.shape[0]
    for cell in range(cell_start.shape[0] - 1):
        for p in range(cell_start[cell], cell_start[cell + 1]):
            i = piece_line[p]
            x, y, dx, dy = lines[i, 0], lines[i, 1], lines[i, 3] - lines[i, 0], lines[i, 4] - lines[i, 1]
            squared = dx * dx + dy * dy
            if squared == 0.0:
                continue
            limit = tolerance * math.sqrt(squared)
            for o in range(cell_start[cell], cell_start[cell + 1]):
                j = piece_line[o]
                if i == j:
                    continue
                u0, v0 = lines[j, 0] - x, lines[j, 1] - y
                u1, v1 = lines[j, 3] - x, lines[j, 4] - y
                if abs(dx * v0 - dy * u0) > limit or abs(dx * v1 - dy * u1) > limit:
                    continue
                t0, t1 = (dx * u0 + dy * v0) / squared, (dx * u1 + dy * v1) / squared
                # Lines that only follow each other have no part in common but for rounding.
                if (min(max(t0, t1), 1.0) - max(min(t0, t1), 0.0)) * squared <= limit:
                    continue
                lo, hi = max(min(t0, t1), pieces[p, 0]), min(max(t0, t1), pieces[p, 1])
                if lo >= hi:
                    continue
                middle = 0.5 * (lo + hi)
                q = lines[i, 2] + middle * (lines[i, 5] - lines[i, 2])
                other_q = lines[j, 2] + (middle - t0) / (t1 - t0) * (lines[j, 5] - lines[j, 2])
                if _is_before(q, other_q, kind[i], kind[j], i, j) == 0:
                    continue
                if n < room:
                    covered_line[n] = i
                    covered[n, 0], covered[n, 1] = lo, hi
                n += 1
    count[0] = n
