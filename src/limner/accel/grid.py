"""A uniform grid (FoCG 12.3.3): space is divided, each part of it belongs to exactly one cell, a triangle to all cells it touches.

Built in no time, and walked without a stack. It knows but one size: a teapot in a stadium falls into one cell of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from .margins import boxes_of, margin_of, whole_of

__all__ = ["Grid", "build_grid"]

_CELLS_PER_TRIANGLE = 4.0
_FINEST = 1024  # cells along an axis
_MOST_ITEMS = 48  # a triangle, on average: beyond, cells are made larger
_FLAT = 1.0 / 512.0  # of the longest side: no side counts as shorter

_SIGNATURE = (
    Array(np.float32, 2), Array(np.float32, 2), Array(np.float64, 2), Array(np.int64, 1), Array(np.int32, 1), Array(np.int32, 1),
    Scalar(np.float64),
)  # fmt: skip
_COUNT = Door("limner.accel.grid_build", "count_in_cells", _SIGNATURE, "counting in the cells of a grid")
_LIST = Door("limner.accel.grid_build", "list_in_cells", _SIGNATURE, "listing in the cells of a grid")


class Grid(NamedTuple):
    """A uniform grid over triangles.

    Attributes
    ----------
    bounds : (2, 3) float64
        Low and high corner.
    resolution : (3,) int64
        Cells along x, y and z.
    starts : (n_cells + 1,) int32
        Cell (x, y, z) is number ``(z * ny + y) * nx + x``; it lists ``items[starts[c]:starts[c + 1]]``.
    items : (k,) int32
        Rows of `corners`.
    corners : (n, 9) float32
    """

    bounds: NDArray[np.float64]
    resolution: NDArray[np.int64]
    starts: NDArray[np.int32]
    items: NDArray[np.int32]
    corners: NDArray[np.float32]


def build_grid(corners: NDArray[np.float32]) -> Grid:
    """List the triangles (n, 9) float32, all finite, in the cells of a grid.

    There are about four cells to a triangle, as near to cubes as whole numbers allow; fewer where large triangles would fill the memory.

    **Source**: the number of cells is that of Cleary and Wyvill, *Analysis of an algorithm for fast ray tracing using uniform space
    subdivision*, 1988, with the density of Ize, Shirley and Parker, *Grid creation strategies for efficient ray tracing*, 2007.
    """
    boxes = boxes_of(corners)
    bounds = whole_of(boxes)
    n = len(boxes)
    if n == 0:
        return Grid(bounds, np.ones(3, dtype=np.int64), np.zeros(2, dtype=np.int32), np.zeros(0, dtype=np.int32), corners)
    sides = bounds[1] - bounds[0]
    sides = np.maximum(sides, sides.max() * _FLAT)
    density = np.cbrt(_CELLS_PER_TRIANGLE * n / sides.prod())
    resolution = _whole_cells(sides * density)
    while resolution.max() > 1 and _cells_of_boxes(boxes, bounds, resolution) > _MOST_ITEMS * n:
        density *= 0.8
        resolution = _whole_cells(sides * density)
    starts = np.zeros(int(resolution.prod()) + 1, dtype=np.int32)
    margin = margin_of(corners)
    _COUNT(boxes, corners, bounds, resolution, starts, np.zeros(0, dtype=np.int32), margin)
    items = np.empty(int(starts[-1]), dtype=np.int32)
    _LIST(boxes, corners, bounds, resolution, starts, items, margin)
    return Grid(bounds, resolution, starts, items, corners)


def _whole_cells(cells: NDArray[np.float64]) -> NDArray[np.int64]:
    return np.clip(np.rint(cells), 1, _FINEST).astype(np.int64)


def _cells_of_boxes(boxes: NDArray[np.float32], bounds: NDArray[np.float64], resolution: NDArray[np.int64]) -> float:
    """About how many cells the boxes lie in, all together."""
    sizes = (boxes[:, 3:].astype(np.float64) - boxes[:, :3]) * (resolution / (bounds[1] - bounds[0]))
    return float((sizes + 1.0).prod(axis=1).sum())
