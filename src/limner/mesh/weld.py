"""Rows that are equal, found: where a surface was split into vertices of its own at a seam, this is what joins it again.

    index, first = welded(mesh.positions)       # mesh.positions[first][index] == mesh.positions
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["welded"]

_HALF = np.uint64(32)


def welded(*values: NDArray[np.float32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Number rows so that equal ones have one number.

    Parameters
    ----------
    *values : (n, k) float32
        Side by side they are the rows. Numbers are compared by their bits, but 0 and -0 are equal.

    Returns
    -------
    index : (n,) int64
        The number of each row.
    first : (m,) int64
        The first row of each number.

    Examples
    --------
    >>> rows = np.array([[1, 2], [3, 4], [1, 2]], dtype=np.float32)
    >>> [part.tolist() for part in welded(rows)]
    [[0, 1, 0], [0, 1]]
    """
    n = len(values[0])
    # + 0.0 turns -0.0 into 0.0.
    columns = [np.ascontiguousarray(v.T, dtype=np.float32) + np.float32(0.0) for v in values]
    keys = np.zeros(n, dtype=np.uint64)
    # Sorting one 64-bit key per column is many times faster than comparing rows.
    for column in np.concatenate(columns).view(np.uint32):
        _, index = np.unique((keys << _HALF) | column, return_inverse=True)
        keys = index.reshape(-1).astype(np.uint64)
    _, first, found = np.unique(keys, return_index=True, return_inverse=True)
    return found.reshape(-1).astype(np.int64), first.astype(np.int64)
