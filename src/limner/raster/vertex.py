"""The vertex stage: from object space to homogeneous raster coordinates, and to the subpixel grid (FoCG 7, 8). Eight vertices at once."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import floor
from ..kernel.lanes import at, int32, lane, load8, min, put, store_rows, where
from ..kernel.vec import Vec3
from ..shading.surface import to_raster
from .clip import inside_all
from .layouts import SUBPIXELS, UNSNAPPED

__all__ = ["snap", "transform_vertices"]

f32 = np.float32
_HALF, _GRID = f32(0.5), f32(SUBPIXELS)
_COUNTING = np.arange(8, dtype=np.int32)


@kernel
def snap(numerator: np.float32, w: np.float32) -> np.int32:
    """The homogeneous divide, rounded to the subpixel grid."""
    return int32(floor(numerator / w * _GRID + _HALF))


@kernel
def transform_vertices(meshes, instances, positions, raster_from_object, near, jobs, first_job, last_job, vertices, snapped):
    """Fill `vertices` (n, 4) with (x w, y w, depth, w) and `snapped` (2 n,) with x and y on the subpixel grid.

    A job is (instance, first, last, place): a range of its mesh's vertices. Where a vertex has to be clipped, its x is UNSNAPPED.
    """
    counting = load8(_COUNTING, 0)
    for k in range(first_job, last_job):
        instance, place = jobs[k, 0], jobs[k, 3]
        start = np.int64(meshes[instances[instance]["mesh"]]["position"])
        last = jobs[k, 2] - 1
        for i in range(jobs[k, 1], jobs[k, 2], 8):
            step = min(counting, last - i)
            row = step + (start + i)
            p = Vec3(at(positions, (row, 0)), at(positions, (row, 1)), at(positions, (row, 2)))
            x, y, depth, w = to_raster(raster_from_object, instance, p)
            out = place + i - jobs[k, 1]
            if last - i >= 7:
                store_rows(vertices, out, x, y, depth, w)
            else:
                for s in range(last - i + 1):
                    vertices[out + s, 0], vertices[out + s, 1] = lane(x, s), lane(y, s)
                    vertices[out + s, 2], vertices[out + s, 3] = lane(depth, s), lane(w, s)
            fits = inside_all((x, y, depth, w), near)
            divisor = where(fits, w, f32(1.0))
            put(snapped, (step + out) * 2, where(fits, snap(where(fits, x, f32(0.0)), divisor), UNSNAPPED))
            put(snapped, (step + out) * 2 + 1, snap(where(fits, y, f32(0.0)), divisor))
