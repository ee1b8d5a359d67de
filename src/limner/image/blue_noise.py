"""A table of thresholds without pattern and without clumps: blue noise, by void and cluster.

Dithering with it turns the rounding error into noise of high frequency, where the eye sees least. Every rank's points are spread as
evenly as those before allow: the next one goes into the largest void, which is where a Gaussian round every point adds up to least.
The square wraps round, so copies of it lie side by side without a seam.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["SIDE", "blue_noise"]

SIDE = 64
_SIGMA = 1.5  # pixels; Ulichney's choice
_FIRST = SIDE * SIDE // 10  # points of the pattern that all begins with
_SEED = 1993

Grid = NDArray[np.float64]


@cache
def blue_noise() -> NDArray[np.int64]:
    """Return the ranks 0 .. 4095, (64, 64) int64, each once; made on the first call, in about a tenth of a second.

    **Source**: Ulichney, *The void-and-cluster method for dither array generation*, 1993. His third phase, which looks for clusters
    of what is still empty, is left out: with a Gaussian that wraps round they are the voids of what is filled.
    """
    bump = _bump()
    points = _spread(bump)
    field = _field(points, bump)
    ranks = np.empty((SIDE, SIDE), dtype=np.int64)
    shrinking, left = points.copy(), field.copy()
    for rank in range(int(points.sum()) - 1, -1, -1):
        place = _cluster(shrinking, left)
        _change(shrinking, left, bump, place, present=False)
        ranks[place] = rank
    for rank in range(int(points.sum()), SIDE * SIDE):
        place = _void(points, field)
        _change(points, field, bump, place, present=True)
        ranks[place] = rank
    ranks.flags.writeable = False
    return ranks


def _spread(bump: Grid) -> NDArray[np.bool_]:
    """Take points at random, then move the most crowded into the largest void until it would come back."""
    points = np.zeros((SIDE, SIDE), dtype=bool)
    points.reshape(-1)[np.random.default_rng(_SEED).choice(SIDE * SIDE, _FIRST, replace=False)] = True
    field = _field(points, bump)
    while True:
        crowded = _cluster(points, field)
        _change(points, field, bump, crowded, present=False)
        empty = _void(points, field)
        _change(points, field, bump, empty, present=True)
        if empty == crowded:
            return points


def _bump() -> Grid:
    """(128, 128): a Gaussian on the torus, twice in each direction, so that every shift of it is a window."""
    distance = np.minimum(np.arange(SIDE), SIDE - np.arange(SIDE)).astype(np.float64)
    along = np.exp(-(distance**2) / (2.0 * _SIGMA**2))
    return np.tile(np.outer(along, along), (2, 2))


def _field(points: NDArray[np.bool_], bump: Grid) -> Grid:
    field = np.zeros((SIDE, SIDE))
    for row, column in np.argwhere(points).tolist():
        field += bump[SIDE - row : 2 * SIDE - row, SIDE - column : 2 * SIDE - column]
    return field


def _change(points: NDArray[np.bool_], field: Grid, bump: Grid, place: tuple[int, int], *, present: bool) -> None:
    row, column = place
    points[place] = present
    around = bump[SIDE - row : 2 * SIDE - row, SIDE - column : 2 * SIDE - column]
    if present:
        field += around
    else:
        field -= around


def _cluster(points: NDArray[np.bool_], field: Grid) -> tuple[int, int]:
    return divmod(int(np.argmax(np.where(points, field, -np.inf))), SIDE)


def _void(points: NDArray[np.bool_], field: Grid) -> tuple[int, int]:
    return divmod(int(np.argmin(np.where(points, np.inf, field))), SIDE)
