"""Triangles on the picture, as they are looked up in a grid of square cells."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

Floats = NDArray[np.float64]
Six = tuple[float, float, float, float, float, float]


@kernel
def side(px: float, py: float, qx: float, qy: float, x: float, y: float) -> float:
    """Twice the area of p, q, (x, y): exactly the opposite for q, p, so that triangles with a common edge part the plane there."""
    if px < qx or (px == qx and py < qy):
        return (qx - px) * (y - py) - (qy - py) * (x - px)
    return -((px - qx) * (y - qy) - (py - qy) * (x - qx))


@kernel
def cell(x: float, size: float, count: int) -> int:
    return int(min(max(math.floor(x / size), 0.0), float(count - 1)))


@kernel
def box_of(triangles: Floats, k: int) -> tuple[float, float, float, float]:
    """(left, right, top, bottom) of triangle k, of rows (ax, ay, aq, bx, …)."""
    ax, ay, bx, by, cx, cy = triangles[k, 0], triangles[k, 1], triangles[k, 3], triangles[k, 4], triangles[k, 6], triangles[k, 7]
    return min(ax, min(bx, cx)), max(ax, max(bx, cx)), min(ay, min(by, cy)), max(ay, max(by, cy))


@kernel
def turned(triangles: Floats, k: int) -> tuple[Six, tuple[float, float, float], float]:
    """Triangle k the way round in which its inside is on the positive side of each edge: its corners, their q, twice its area."""
    ax, ay, aq = triangles[k, 0], triangles[k, 1], triangles[k, 2]
    bx, by, bq = triangles[k, 3], triangles[k, 4], triangles[k, 5]
    cx, cy, cq = triangles[k, 6], triangles[k, 7], triangles[k, 8]
    area = side(ax, ay, bx, by, cx, cy)
    if area < 0.0:
        return (ax, ay, cx, cy, bx, by), (aq, cq, bq), -area
    return (ax, ay, bx, by, cx, cy), (aq, bq, cq), area


@kernel
def slope_of(corners: Six, q: tuple[float, float, float], area: float) -> tuple[float, float]:
    """How q changes along x and along y of the picture; `area` is not zero."""
    ax, ay, bx, by, cx, cy = corners
    across = ((q[1] - q[0]) * (cy - ay) - (q[2] - q[0]) * (by - ay)) / area
    return across, ((q[2] - q[0]) * (bx - ax) - (q[1] - q[0]) * (cx - ax)) / area
