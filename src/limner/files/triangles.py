"""What every reader asks of triangles that somebody else made."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["count_degenerate", "finite_rows"]


_BLOCK = 1 << 14  # rows at a time that stay in the cache from one step to the next


def finite_rows(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Return of each row, (n,), whether all its numbers are finite."""
    # A sum is finite where nothing is at fault, which is nearly always, and one pass tells.
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(values.sum(dtype=np.float64)):
            return np.ones(len(values), dtype=bool)
    return np.asarray(np.isfinite(values).all(axis=1))


def count_degenerate(positions: NDArray[Any], triangles: NDArray[Any]) -> int:
    """Return how many triangles have no area."""
    return sum(_count(positions, triangles[start : start + _BLOCK]) for start in range(0, len(triangles), _BLOCK))


def _count(positions: NDArray[Any], triangles: NDArray[Any]) -> int:
    a, b, c = (positions.take(triangles[:, corner], axis=0).astype(np.float64).T for corner in range(3))
    e, f = b - a, c - a
    x = e[1] * f[2] - e[2] * f[1]
    y = e[2] * f[0] - e[0] * f[2]
    z = e[0] * f[1] - e[1] * f[0]
    return int(np.count_nonzero((x == 0.0) & (y == 0.0) & (z == 0.0)))
