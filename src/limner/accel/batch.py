"""Many rays through one tree of triangles, on threads: what `limner.RayCaster` asks.

Rays come in float64 and are brought close to the mesh before they become float32, so that a mesh far from the origin, or a ray
from far away, loses no digits; a ray whose numbers are near the mesh already is used as it stands.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..tiles import run_all
from .layouts import ACCELERATOR_ARRAYS, BLOCK, BLOCK_INTEGERS, BLOCK_NUMBERS, BLOCK_PLACES, WAITING, Accelerator

__all__ = ["any_hits", "nearest_hits", "refit"]

CHUNK = 8192  # rays of one piece of work: some milliseconds

_TREE = ACCELERATOR_ARRAYS[:3]
_RAYS = (Array(np.float64, 1), Array(np.float64, 2), Array(np.float64, 2), Array(np.float64, 1))
_SCRATCH = (Array(np.float32, 1), Array(np.int32, 1), Array(np.float64, 1), Array(np.int64, 1), Array(np.int32, 1))

_INTERSECT = Door(
    "limner.accel.batch_kernel",
    "intersect_batch",
    (
        *_TREE, *_RAYS, Array(np.float32, 1), Array(np.int32, 1), Array(np.float32, 2), Scalar(np.int64), *_SCRATCH,
    ),
    "the ray caster",
)  # fmt: skip

_OCCLUDED = Door(
    "limner.accel.batch_kernel",
    "occluded_batch",
    (*_TREE, *_RAYS, Array(np.uint8, 1), Scalar(np.int64), *_SCRATCH),
    "the ray caster's shadows",
)

_REFIT = Door(
    "limner.accel.refit_kernel",
    "refit",
    (Array(np.int32, 1), Array(np.float32, 1), Array(np.int32, 1), Array(np.int32, 1), Array(np.float32, 2)),
    "another pose for the ray caster",
)


def nearest_hits(
    accelerator: Accelerator,
    frame: NDArray[np.float64],
    origins: NDArray[Any],
    directions: NDArray[Any],
    t_max: NDArray[Any],
    threads: int,
) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float32], NDArray[np.float32]]:
    """Find the nearest hit of every ray.

    Parameters
    ----------
    accelerator : Accelerator
        Of triangles alone.
    frame : (8,) float64
        Shift and scale that take given points to the accelerator's (``(p - shift) * scale``); centre and radius of a sphere
        that holds its triangles.
    origins, directions : (n, 3) numbers
    t_max : (n,) numbers

    Returns
    -------
    t : (n,) float32
        inf: a miss.
    triangle : (n,) int32
        -1: a miss.
    u, v : (n,) float32
    """
    n = len(origins)
    t, triangle, uv = np.empty(n, dtype=np.float32), np.empty(n, dtype=np.int32), np.empty((2, n), dtype=np.float32)
    _run(_INTERSECT, accelerator, frame, (origins, directions, t_max), (t, triangle, uv), threads)
    return t, triangle, uv[0], uv[1]


def any_hits(
    accelerator: Accelerator,
    frame: NDArray[np.float64],
    origins: NDArray[Any],
    directions: NDArray[Any],
    t_max: NDArray[Any],
    threads: int,
) -> NDArray[np.bool_]:
    """Tell of every ray, (n,), whether it hits anything; arguments as of `nearest_hits`."""
    dark = np.empty(len(origins), dtype=np.uint8)
    _run(_OCCLUDED, accelerator, frame, (origins, directions, t_max), (dark,), threads)
    return dark.view(np.bool_)


def _run(
    door: Door,
    accelerator: Accelerator,
    frame: NDArray[np.float64],
    rays: tuple[NDArray[Any], ...],
    results: tuple[NDArray[Any], ...],
    threads: int,
) -> None:
    def trace(first: int) -> None:
        piece = [np.ascontiguousarray(part[first : first + CHUNK], dtype=np.float64) for part in rays]
        door(*accelerator[:3], frame, *piece, *results, first, *_scratch())

    door.open()
    run_all(trace, range(0, len(rays[0]), CHUNK), threads)


def refit(accelerator: Accelerator, numbers: NDArray[np.int32], n_triangles: int, corners: NDArray[np.float32]) -> None:
    """Give the triangles of an accelerator other corners, (n, 9), in place; `numbers` (n,): as which of `n_triangles` they are known."""
    rows = np.zeros(n_triangles, dtype=np.int32)
    rows[numbers] = np.arange(len(numbers), dtype=np.int32)
    _REFIT(accelerator.nodes, accelerator.packs, accelerator.tags, rows, corners)


def _scratch() -> tuple[NDArray[Any], ...]:
    """A block of rays, and what waits while they are followed."""
    return (
        np.empty(BLOCK_NUMBERS, dtype=np.float32), np.empty(BLOCK_INTEGERS, dtype=np.int32), np.empty(BLOCK_PLACES),
        np.empty(4 * BLOCK, dtype=np.int64), np.empty(2 * BLOCK * WAITING, dtype=np.int32),
    )  # fmt: skip
