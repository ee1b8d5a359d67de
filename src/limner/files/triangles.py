"""What every reader asks of triangles that somebody else made."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["count_degenerate", "finite_rows"]


def finite_rows(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Return of each row, (n,), whether all its numbers are finite."""
    return np.asarray(np.isfinite(values).all(axis=1))


def count_degenerate(positions: NDArray[Any], triangles: NDArray[Any]) -> int:
    """Return how many triangles have no area."""
    a, b, c = (positions[triangles[:, corner]].astype(np.float64) for corner in range(3))
    e, f = b - a, c - a
    x = e[:, 1] * f[:, 2] - e[:, 2] * f[:, 1]
    y = e[:, 2] * f[:, 0] - e[:, 0] * f[:, 2]
    z = e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    return int(np.count_nonzero((x == 0.0) & (y == 0.0) & (z == 0.0)))
