"""Many rays through a grid, a BSP or a plain tree of boxes: the loops behind `accel.batch_structures`."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO
from .bsp_walk import walk_bsp
from .every_hit_walk import each_hit_of_eight
from .grid_walk import walk_grid
from .listed_triangles import Found
from .near_ray import near_ray
from .volume_tree_walk import each_hit, walk_volume_tree

__all__ = ["cast_through_bsp", "cast_through_grid", "cast_through_volume_tree", "hits_along", "hits_along_eight"]

f32, f64 = np.float32, np.float64


@kernel
def _write(found: Found, ray, row: int, t, triangle, uv, visits, tally):
    """Row `row` of the results; `visits` may have no rows."""
    t[row], triangle[row], uv[0, row], uv[1, row] = f32(np.inf), -1, ZERO, ZERO
    if found.row >= 0:
        t[row], triangle[row] = f32((ray.start + f64(found.t)) / ray.length), found.row
        uv[0, row], uv[1, row] = found.u, found.v
    if visits.shape[0] > 0:
        visits[row, 0], visits[row, 1] = tally[0], tally[1]


@kernel
def _nothing() -> Found:
    return Found(ZERO, -1, ZERO, ZERO)


@kernel
def cast_through_grid(
    bounds, resolution, starts, items, corners, frame, origins, directions, t_max, any_hit, t, triangle, uv, visits, first, waiting, spans,
    tally,
):  # fmt: skip
    """Fill t, triangle, uv and visits from row `first` with what each ray (n, 3) meets within (0, t_max)."""
    grid = (bounds, resolution, starts, items, corners)
    for k in range(origins.shape[0]):
        tally[0], tally[1] = 0, 0
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        found = _nothing()
        if ray.sound and end > ZERO:
            found = walk_grid(grid, ray.o, ray.d, ZERO, end, any_hit != 0, tally)
        _write(found, ray, first + k, t, triangle, uv, visits, tally)


@kernel
def cast_through_bsp(
    bounds, nodes, items, corners, frame, origins, directions, t_max, any_hit, t, triangle, uv, visits, first, waiting, spans, tally
):
    """As `cast_through_grid`."""
    bsp = (bounds, nodes, items, corners)
    for k in range(origins.shape[0]):
        tally[0], tally[1] = 0, 0
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        found = _nothing()
        if ray.sound and end > ZERO:
            found = walk_bsp(bsp, ray.o, ray.d, ZERO, end, any_hit != 0, tally, waiting, spans)
        _write(found, ray, first + k, t, triangle, uv, visits, tally)


@kernel
def cast_through_volume_tree(
    bounds, nodes, items, corners, frame, origins, directions, t_max, any_hit, t, triangle, uv, visits, first, waiting, spans, tally
):
    """As `cast_through_grid`."""
    tree = (bounds, nodes, items, corners)
    for k in range(origins.shape[0]):
        tally[0], tally[1] = 0, 0
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        found = _nothing()
        if ray.sound and end > ZERO:
            found = walk_volume_tree(tree, ray.o, ray.d, ZERO, end, any_hit != 0, tally, waiting, spans)
        _write(found, ray, first + k, t, triangle, uv, visits, tally)


@kernel
def _scaled(t, ray, begin: int, n: int):
    """Make the t of the near ray those of the given one."""
    if t.shape[0] > 0:
        for i in range(begin, begin + n):
            t[i] = f32((ray.start + f64(t[i])) / ray.length)


@kernel
def hits_along(bounds, nodes, items, corners, frame, origins, directions, t_max, counts, starts, t, row, u, v, first, waiting):
    """All hits of each ray within (0, t_max): how many, and, where t has room, what they are, from starts[first + k] on."""
    tree = (bounds, nodes, items, corners)
    for k in range(origins.shape[0]):
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        begin, n = starts[first + k], 0
        if ray.sound and end > ZERO:
            n = each_hit(tree, ray.o, ray.d, ZERO, end, t, row, u, v, begin, waiting)
        counts[first + k] = n
        _scaled(t, ray, begin, n)


@kernel
def hits_along_eight(nodes, packs, tags, frame, origins, directions, t_max, counts, starts, t, row, u, v, first, waiting):
    """As `hits_along`; `row` are the numbers that the packs hold."""
    for k in range(origins.shape[0]):
        ray = near_ray(origins, directions, k, frame)
        end = f32(t_max[k] * ray.length - ray.start)
        begin, n = starts[first + k], 0
        if ray.sound and end > ZERO:
            n = each_hit_of_eight(nodes, packs, tags, ray.o, ray.d, ZERO, end, t, row, u, v, begin, waiting)
        counts[first + k] = n
        _scaled(t, ray, begin, n)
