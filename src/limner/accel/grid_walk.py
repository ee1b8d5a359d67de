"""The walk of a ray through a uniform grid (FoCG 12.3.3): cell after cell, in the order in which the ray meets them.

**Source**: Amanatides and Woo, *A fast voxel traversal algorithm for ray tracing*, 1987. The step is taken in float64, so that a ray is in
the cell in which it thinks it is, even after a thousand of them.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..intersect.triangle import turned_ray
from ..kernel.vec import Vec3
from .listed_triangles import Found, nearest_listed, nothing_before, slack_of, span_within

__all__ = ["walk_grid"]

f64 = np.float64
_NONE = f64(0.0)
_NEVER = f64(np.inf)


@kernel
def _along(low: np.float64, high: np.float64, n: int, o: np.float64, d: np.float64, t: np.float64):
    """Along one axis: the cell at t, the step to the next (1, -1; 0: none), when the ray gets there, and how long it is in each."""
    size = (high - low) / n
    cell = min(max(int((o + t * d - low) / size), 0), n - 1)
    if d == _NONE:
        return cell, 0, _NEVER, _NEVER
    if d > _NONE:
        return cell, 1, (low + (cell + 1) * size - o) / d, size / d
    return cell, -1, (low + cell * size - o) / d, -size / d


@kernel
def walk_grid(grid, o: Vec3, d: Vec3, t_min: np.float32, t_max: np.float32, any_hit: bool, tally) -> Found:
    """The nearest triangle in (t_min, t_max), or any; t_min >= 0. tally[0] counts cells, tally[1] triangles.

    A triangle that is met outside the cell which lists it is kept, and not yet believed: the walk goes on until it has passed there.
    """
    bounds, resolution, starts, items, corners = grid
    ray = turned_ray(o, d)
    best = nothing_before(t_max)
    slack = slack_of(bounds, ray)
    ox, oy, oz, dx, dy, dz = f64(o.x), f64(o.y), f64(o.z), f64(d.x), f64(d.y), f64(d.z)
    t, end = span_within(bounds, (ox, oy, oz), (dx, dy, dz), f64(t_min - slack), f64(t_max + slack))
    if not t <= end:
        return best
    nx, ny, nz = resolution[0], resolution[1], resolution[2]
    x, step_x, next_x, width_x = _along(bounds[0, 0], bounds[1, 0], nx, ox, dx, t)
    y, step_y, next_y, width_y = _along(bounds[0, 1], bounds[1, 1], ny, oy, dy, t)
    z, step_z, next_z, width_z = _along(bounds[0, 2], bounds[1, 2], nz, oz, dz, t)
    while x >= 0 and x < nx and y >= 0 and y < ny and z >= 0 and z < nz:
        tally[0] += 1
        cell = (z * ny + y) * nx + x
        best = nearest_listed(items, np.int64(starts[cell]), np.int64(starts[cell + 1]), corners, ray, t_min, t_max, best, tally)
        if any_hit and best.row >= 0:
            return best
        leave = min(min(next_x, next_y), next_z)
        if best.t + slack < leave:
            return best
        if next_x == leave:
            x, next_x = x + step_x, next_x + width_x
        elif next_y == leave:
            y, next_y = y + step_y, next_y + width_y
        else:
            z, next_z = z + step_z, next_z + width_z
    return best
