"""The vertex stage: object space to homogeneous raster coordinates."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import Vec3
from ..shading.surface import to_raster

__all__ = ["transform_vertices"]

f32 = np.float32


@kernel
def transform_vertices(meshes, instances, positions, raster_from_object, jobs, first_job, last_job, vertices):
    """Fill `vertices` (n, 4) with (x w, y w, depth, w). A job is (instance, first, last, place): a range of its mesh's vertices."""
    for k in range(first_job, last_job):
        instance, place = jobs[k, 0], jobs[k, 3]
        start = meshes[instances[instance]["mesh"]]["position"]
        for i in range(jobs[k, 1], jobs[k, 2]):
            row = start + i
            x, y, depth, w = to_raster(raster_from_object, instance, Vec3(positions[row, 0], positions[row, 1], positions[row, 2]))
            out = place + i - jobs[k, 1]
            vertices[out, 0], vertices[out, 1], vertices[out, 2], vertices[out, 3] = x, y, depth, w
