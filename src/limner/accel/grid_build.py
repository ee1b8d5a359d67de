"""Kernels that list in every cell of a uniform grid the triangles that may lie in it."""

from __future__ import annotations

import numpy as np

from .._jit import kernel

__all__ = ["count_in_cells", "list_in_cells"]

f64 = np.float64
_HALF = f64(0.5)


@kernel
def _cell(place: np.float64, low: np.float64, size: np.float64, n: int) -> int:
    return min(max(int((place - low) / size), 0), n - 1)


@kernel
def _plane(corners, k: int):
    """The plane of a triangle: its normal, of any length, and the distance of the origin in its units."""
    ax, ay, az = f64(corners[k, 0]), f64(corners[k, 1]), f64(corners[k, 2])
    ux, uy, uz = f64(corners[k, 3]) - ax, f64(corners[k, 4]) - ay, f64(corners[k, 5]) - az
    vx, vy, vz = f64(corners[k, 6]) - ax, f64(corners[k, 7]) - ay, f64(corners[k, 8]) - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    return nx, ny, nz, nx * ax + ny * ay + nz * az


@kernel
def _range(boxes, k: int, axis: int, bounds, resolution):
    """The first and the last cell along an axis that a triangle's box lies in, and the size of a cell."""
    n = resolution[axis]
    low, size = bounds[0, axis], (bounds[1, axis] - bounds[0, axis]) / n
    return _cell(f64(boxes[k, axis]), low, size, n), _cell(f64(boxes[k, 3 + axis]), low, size, n), size


@kernel
def _each_cell(boxes, corners, bounds, resolution, starts, items, margin: np.float64, listing: bool):
    """Of every triangle, visit the cells of its box that its plane passes through: count it there, or list it."""
    for k in range(boxes.shape[0]):
        nx, ny, nz, offset = _plane(corners, k)
        x0, x1, sx = _range(boxes, k, 0, bounds, resolution)
        y0, y1, sy = _range(boxes, k, 1, bounds, resolution)
        z0, z1, sz = _range(boxes, k, 2, bounds, resolution)
        reach = abs(nx) * (_HALF * sx + margin) + abs(ny) * (_HALF * sy + margin) + abs(nz) * (_HALF * sz + margin)
        for z in range(z0, z1 + 1):
            height = nz * (bounds[0, 2] + (z + _HALF) * sz) - offset
            for y in range(y0, y1 + 1):
                depth = height + ny * (bounds[0, 1] + (y + _HALF) * sy)
                row = (z * resolution[1] + y) * resolution[0]
                for x in range(x0, x1 + 1):
                    if abs(depth + nx * (bounds[0, 0] + (x + _HALF) * sx)) <= reach:
                        if listing:
                            items[starts[row + x]] = k
                        starts[row + x] += 1


@kernel
def count_in_cells(boxes, corners, bounds, resolution, starts, items, margin):
    """Fill starts[c + 1] with the number of triangles that come before those of cell c + 1."""
    _each_cell(boxes, corners, bounds, resolution, starts, items, margin, False)
    total = 0
    for c in range(starts.shape[0]):
        total, starts[c] = total + starts[c], total


@kernel
def list_in_cells(boxes, corners, bounds, resolution, starts, items, margin):
    """Fill `items` from where each cell's begin; leaves in starts[c] where they end, and moves that back to where they began."""
    _each_cell(boxes, corners, bounds, resolution, starts, items, margin, True)
    for c in range(starts.shape[0] - 1, 0, -1):
        starts[c] = starts[c - 1]
    starts[0] = 0
