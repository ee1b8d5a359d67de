"""Quadrilaterals between rows of points, cut into triangles.

    d ___ c
     |  /|         a b c  and  a c d, so that a pair of triangles 2i, 2i + 1 can be told to be one quadrilateral again
     | / |
    a ___ b
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["grid_triangles", "halved"]

Indices = NDArray[np.int64]


def halved(a: Indices, b: Indices, c: Indices, d: Indices) -> Indices:
    """(2 m, 3) int64: both halves of quadrilaterals a b c d, one after the other."""
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def grid_triangles(rows: int, columns: int) -> Indices:
    """(2 (rows - 1) (columns - 1), 3) int64: a grid of points, row by row, the next row to the left of the way along one."""
    row, column = columns * np.arange(rows - 1)[:, None], np.arange(columns - 1)
    return halved(row + column, row + column + 1, row + columns + column + 1, row + columns + column)
