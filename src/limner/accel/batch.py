"""Many rays through one tree of triangles, on threads: what `limner.RayCaster` asks.

Rays come in float64 and are brought close to the mesh before they become float32, so that a mesh far from the origin, or a ray
from far away, loses no digits; a ray whose numbers are near the mesh already is used as it stands.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..tiles import PerThread, run_all
from .layouts import ACCELERATOR_ARRAYS, BLOCK, BLOCK_INTEGERS, BLOCK_NUMBERS, BLOCK_PLACES, STACKS, Accelerator

__all__ = ["any_hits", "nearest_hits", "refit", "visits_of"]

CHUNK = 8192  # rays of one piece of work: some milliseconds

_TREE = ACCELERATOR_ARRAYS[:3]
_SCRATCH = (Array(np.float32, 1), Array(np.int32, 1), Array(np.float64, 1), Array(np.int64, 1), Array(np.int32, 1))
_HITS = (Array(np.float32, 1), Array(np.int32, 1), Array(np.float32, 1), Array(np.float32, 1))


def _door(function: str, results: tuple[Array, ...], what: str, number: type) -> Door:
    """The door for rays of float64, or of float32, which are not converted first."""
    rays = Array(np.float64, 1), Array(number, 2), Array(number, 2), Array(np.float64, 1)
    return Door("limner.accel.batch_kernel", function, (*_TREE, *rays, *results, Scalar(np.int64), *_SCRATCH), what)


_INTERSECT = _door("intersect_batch", _HITS, "the ray caster", np.float64)
_INTERSECT_SINGLE = _door("intersect_batch_single", _HITS, "the ray caster for float32", np.float32)
_OCCLUDED = _door("occluded_batch", (Array(np.uint8, 1),), "the ray caster's shadows", np.float64)
_OCCLUDED_SINGLE = _door("occluded_batch_single", (Array(np.uint8, 1),), "the ray caster's shadows for float32", np.float32)

_VISITS = Door(
    "limner.accel.batch_kernel",
    "visits_batch",
    (
        *_TREE, Array(np.float64, 1), Array(np.float64, 2), Array(np.float64, 2), Array(np.float64, 1), Array(np.int32, 2),
        Scalar(np.int64), Scalar(np.int64), *_SCRATCH,
    ),
    "what the ray caster looks at",
)  # fmt: skip

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
    t, u, v = np.empty((3, n), dtype=np.float32)
    triangle = np.empty(n, dtype=np.int32)
    door = _INTERSECT_SINGLE if _are_single(origins, directions) else _INTERSECT
    _run(door, accelerator, frame, (origins, directions, t_max), (t, triangle, u, v), threads)
    return t, triangle, u, v


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
    door = _OCCLUDED_SINGLE if _are_single(origins, directions) else _OCCLUDED
    _run(door, accelerator, frame, (origins, directions, t_max), (dark,), threads)
    return dark.view(np.bool_)


def visits_of(
    accelerator: Accelerator,
    frame: NDArray[np.float64],
    origins: NDArray[Any],
    directions: NDArray[Any],
    t_max: NDArray[Any],
    threads: int,
    *,
    any_hit: bool,
) -> NDArray[np.int32]:
    """Count of every ray, (n, 2), how many nodes it meets, each with eight boxes, and how many triangles; arguments as of `nearest_hits`.

    Rays that go together are counted as if each went alone.
    """
    visits = np.zeros((len(origins), 2), dtype=np.int32)
    _run(_VISITS, accelerator, frame, (origins, directions, t_max), (visits,), threads, int(any_hit))
    return visits


def _are_single(origins: NDArray[Any], directions: NDArray[Any]) -> bool:
    return origins.dtype == np.float32 and directions.dtype == np.float32


def _run(
    door: Door,
    accelerator: Accelerator,
    frame: NDArray[np.float64],
    rays: tuple[NDArray[Any], ...],
    results: tuple[NDArray[Any], ...],
    threads: int,
    *choices: int,
) -> None:
    origins, directions, t_max = rays
    number = np.float32 if door in (_INTERSECT_SINGLE, _OCCLUDED_SINGLE) else np.float64
    if t_max.strides == (0,):
        t_max = t_max[:1]  # one for all

    scratch = PerThread(_scratch)

    def trace(first: int) -> None:
        piece = slice(first, first + CHUNK)
        o, d = (np.ascontiguousarray(part[piece], dtype=number) for part in (origins, directions))
        ends = np.ascontiguousarray(t_max[piece] if len(t_max) > 1 else t_max, dtype=np.float64)
        door(*accelerator[:3], frame, o, d, ends, *results, first, *choices, *scratch.value)

    door.open()
    run_all(trace, range(0, len(origins), CHUNK), threads)


def refit(accelerator: Accelerator, numbers: NDArray[np.int32], n_triangles: int, corners: NDArray[np.float32]) -> None:
    """Give the triangles of an accelerator other corners, (n, 9), in place; `numbers` (n,): as which of `n_triangles` they are known."""
    rows = np.zeros(n_triangles, dtype=np.int32)
    rows[numbers] = np.arange(len(numbers), dtype=np.int32)
    _REFIT(accelerator.nodes, accelerator.packs, accelerator.tags, rows, corners)


def _scratch() -> tuple[NDArray[Any], ...]:
    """A block of rays, and what waits while they are followed."""
    return (
        np.empty(BLOCK_NUMBERS, dtype=np.float32), np.empty(BLOCK_INTEGERS, dtype=np.int32), np.empty(BLOCK_PLACES),
        np.empty(4 * BLOCK, dtype=np.int64), np.empty(STACKS, dtype=np.int32),
    )  # fmt: skip
