"""Hidden lines so close to others that they would only be dirt.

A wall that is seen edge-on has its silhouette twice, at its near and at its far end, and a round edge has one that is hidden just inside
the one that is seen. Dashes that run beside a line, nearer than the pen can keep apart, tell nothing. So of lines of one shape that run
along each other the more important is drawn: what is seen before what is hidden, and of what is hidden the long before the short. What is
seen stays, for it may be seen by itself from a little to the side.

**Source**: ISO 128-20:1996, 4.4 (lines that run beside each other are at least 0.7 mm apart, or drawn as one).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["beside_others"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_FREE = 2.8  # pixels that are left free beside a line
_ALONG = 0.8  # cosine between lines that run along each other


def beside_others(ends: Floats, hidden: Flags, instance: Indices, run: Indices, length: Floats) -> Flags:
    """Which straight parts of hidden lines, (n,) bool, run for more than half of their way beside something more important of their shape.

    Parameters
    ----------
    ends : (n, 2, 2) float64
        Pixels.
    hidden : (n,) bool
    instance : (n,) int64
        Of which shape each is.
    run : (n,) int64
        Parts of one number are one line, none of which is more important than another.
    length : (n,) float64
        Of each part, pixels.
    """
    total = np.bincount(run, length)
    # Of two parts of equally important lines those of the first stay.
    order = np.lexsort((np.arange(len(total)), -total, np.bincount(run, hidden) > 0))
    rank = np.empty(len(total), dtype=np.int64)
    rank[order] = np.arange(len(total))
    count = np.maximum(1, np.ceil(length)).astype(np.int64)
    part = np.repeat(np.arange(len(length)), count)
    share = (np.arange(len(part)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[part]
    way = ends[:, 1] - ends[:, 0]
    at = ends[part, 0] + share[:, None] * way[part]
    way = way / np.maximum(length, 1e-300)[:, None]
    near = _near(at, way[part], rank[run[part]], instance[part], hidden[part])
    return np.asarray(np.bincount(part, near, len(length)) > 0.5 * count)


def _near(at: Floats, way: Floats, rank: Indices, instance: Indices, asked: Flags) -> Flags:
    """Which samples of lines, (n,), of those asked for, are near to one of a lesser rank that goes their way."""
    reach = int(np.ceil(_FREE))
    cell = np.floor(at).astype(np.int64)
    cell -= cell.min(axis=0) - reach
    width, height = (cell.max(axis=0) + reach + 1).tolist()
    place = cell[:, 1] * width + cell[:, 0]
    # In a cell the sample of the least rank stands for all.
    first = np.full(width * height, -1, dtype=np.int64)
    order = np.argsort(-rank, kind="stable")
    first[place[order]] = order
    made, rows = np.zeros(len(at), dtype=bool), np.flatnonzero(asked)
    for down in range(-reach, reach + 1):
        for across in range(-reach, reach + 1):
            row = rows[~made[rows]]
            other = first[place[row] + down * width + across]
            row, other = row[other >= 0], other[other >= 0]
            apart = at[other] - at[row]
            made[row] = (
                (rank[other] < rank[row]) & (instance[other] == instance[row])
                & (np.abs((way[other] * way[row]).sum(axis=1)) > _ALONG) & ((apart * apart).sum(axis=1) < _FREE ** 2)
            )  # fmt: skip
    return made
