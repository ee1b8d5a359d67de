"""Which triangles meet, by a tree over them, and in which line."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_PARALLEL = 1e-6  # sine of the angle between planes that meet nowhere in particular


@kernel
def _share(triangles: Indices, i: int, j: int) -> bool:
    for a in range(3):
        for b in range(3):
            if triangles[i, a] == triangles[j, b]:
                return True
    return False


@kernel
def _height(points: Floats, p: int, o: int, nx: float, ny: float, nz: float) -> float:
    return (points[p, 0] - points[o, 0]) * nx + (points[p, 1] - points[o, 1]) * ny + (points[p, 2] - points[o, 2]) * nz


@kernel
def _normal(points: Floats, a: int, b: int, c: int) -> tuple[float, float, float]:
    ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@kernel
def _crossing(points: Floats, p: int, q: int, dp: float, dq: float, axis: int) -> float:
    """A coordinate of the point between two, at these heights over a plane, that lies in it: the same bits from p to q and from q to p."""
    if p > q:
        p, q, dp, dq = q, p, dq, dp
    return float(points[p, axis] + dp / (dp - dq) * (points[q, axis] - points[p, axis]))


@kernel
def _cut(points: Floats, triangles: Indices, i: int, j: int, slack: float, made: Floats) -> bool:
    """Put the two points where the sides of triangle i pass through the plane of j into `made`, (2, 3); False: they do not.

    What lies in the plane, but for rounding, counts as above it: a surface that only touches another from above does not meet it, and one
    that passes through it at its very corners does so once.
    """
    a, b, c = triangles[j, 0], triangles[j, 1], triangles[j, 2]
    nx, ny, nz = _normal(points, a, b, c)
    least = -slack * math.sqrt(nx * nx + ny * ny + nz * nz)
    n = 0
    for k in range(3):
        p, q = triangles[i, k], triangles[i, (k + 1) % 3]
        dp, dq = _height(points, p, a, nx, ny, nz), _height(points, q, a, nx, ny, nz)
        if (dp < least) == (dq < least):
            continue
        if dp >= least:
            dp = max(dp, 0.0)
        if dq >= least:
            dq = max(dq, 0.0)
        for axis in range(3):
            made[n, axis] = _crossing(points, p, q, dp, dq, axis)
        n += 1
    return n == 2


@kernel
def _common(points: Floats, triangles: Indices, i: int, j: int, slack: float, made: Floats) -> bool:
    """Put the ends of the line in which two triangles meet into `made`, (6, 3), its last two rows; False: they do not."""
    ax, ay, az = _normal(points, triangles[i, 0], triangles[i, 1], triangles[i, 2])
    bx, by, bz = _normal(points, triangles[j, 0], triangles[j, 1], triangles[j, 2])
    lx, ly, lz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    if lx * lx + ly * ly + lz * lz <= _PARALLEL**2 * (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz):
        return False
    if not _cut(points, triangles, i, j, slack, made[0:2]) or not _cut(points, triangles, j, i, slack, made[2:4]):
        return False
    # Along the line, by its greatest coordinate, both stand between two of the four points.
    axis = 0
    if abs(ly) > abs(lx) and abs(ly) >= abs(lz):
        axis = 1
    elif abs(lz) > abs(lx):
        axis = 2
    first = 0 if made[0, axis] <= made[1, axis] else 1
    second = 2 if made[2, axis] <= made[3, axis] else 3
    low = first if made[first, axis] >= made[second, axis] else second
    end, other = 1 - first, 5 - second
    high = end if made[end, axis] <= made[other, axis] else other
    if made[low, axis] >= made[high, axis]:
        return False
    for k in range(3):
        made[4, k], made[5, k] = made[low, k], made[high, k]
    return True


@kernel
def find_meetings(
    points: Floats,
    triangles: Indices,
    boxes: Floats,
    slack: float,
    first: int,
    last: int,
    stack: Indices,
    scratch: Floats,
    pairs: Indices,
    ends: Floats,
    count: Indices,
) -> None:
    """List the triangles that meet, and in which lines.

    `boxes` are the nodes of a full binary tree: 1 is the root, the children of k are 2 k and 2 k + 1, its leaves are the `triangles` in
    order, of which `first` to `last` are looked at, each with those after it. `count` becomes how many meet, which may be more than there
    was room for in `pairs` and `ends`.
    """
    n = 0
    leaves = boxes.shape[0] // 2
    for i in range(first, last):
        box = boxes[leaves + i]
        stack[0] = 1
        depth = 1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            other = boxes[node]
            if (
                other[0] > box[3] or other[1] > box[4] or other[2] > box[5]
                or other[3] < box[0] or other[4] < box[1] or other[5] < box[2]
            ):  # fmt: skip
                continue
            # The last leaf under a node, to look at every pair once.
            end = node
            while end < leaves:
                end = 2 * end + 1
            if end - leaves <= i:
                continue
            if node < leaves:
                stack[depth], stack[depth + 1] = 2 * node, 2 * node + 1
                depth += 2
                continue
            j = node - leaves
            if _share(triangles, i, j) or not _common(points, triangles, i, j, slack, scratch):
                continue
            if n < pairs.shape[0]:
                pairs[n, 0], pairs[n, 1] = i, j
                for k in range(3):
                    ends[n, 0, k], ends[n, 1, k] = scratch[4, k], scratch[5, k]
            n += 1
    count[0] = n
