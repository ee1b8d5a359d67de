"""Many rays through a grid, a BSP or a plain tree of boxes, on threads: what `limner.RayCaster` asks of those that are not the tree of
eight children.

Rays are brought close to the mesh as in `accel.batch`. What each walk visits is counted, ray by ray, by whoever wants to know.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..tiles import run_all
from .bsp import BSP_NODE, DEEPEST, Bsp, build_bsp
from .grid import Grid, build_grid
from .layouts import STACK_SIZE, Accelerator
from .volume_tree import TREE_NODE, VolumeTree, build_volume_tree

__all__ = ["Cast", "Structure", "StructureKind", "build_structure", "cast", "every_hit"]

StructureKind = Literal["grid", "bsp", "volume_tree"]
Structure = Grid | Bsp | VolumeTree

_CHUNK = 4096  # rays of one piece of work: some milliseconds

f32, i32, f64, i64 = np.float32, np.int32, np.float64, np.int64
_RAYS = (Array(f64, 1), Array(f64, 2), Array(f64, 2), Array(f64, 1))
_RESULTS = (
    Scalar(i64), Array(f32, 1), Array(i32, 1), Array(f32, 2), Array(i32, 2), Scalar(i64), Array(i32, 1), Array(f64, 2), Array(i64, 1),
)  # fmt: skip
_GRID = (Array(f64, 2), Array(i64, 1), Array(i32, 1), Array(i32, 1), Array(f32, 2))
_BSP = (Array(f64, 2), Array(BSP_NODE, 1), Array(i32, 1), Array(f32, 2))
_TREE = (Array(f64, 2), Array(TREE_NODE, 1), Array(i32, 1), Array(f32, 2))
_KERNELS = "limner.accel.batch_structures_kernel"

_THROUGH_GRID = Door(_KERNELS, "cast_through_grid", (*_GRID, *_RAYS, *_RESULTS), "the ray caster's grid")
_THROUGH_BSP = Door(_KERNELS, "cast_through_bsp", (*_BSP, *_RAYS, *_RESULTS), "the ray caster's BSP")
_THROUGH_TREE = Door(_KERNELS, "cast_through_volume_tree", (*_TREE, *_RAYS, *_RESULTS), "the ray caster's tree of least volumes")
_HITS = (Array(i32, 1), Array(i64, 1), Array(f32, 1), Array(i32, 1), Array(f32, 1), Array(f32, 1), Scalar(i64), Array(i32, 1))
_ALONG = Door(_KERNELS, "hits_along", (*_TREE, *_RAYS, *_HITS), "all hits of the ray caster")
_EIGHT = (Array(i32, 1), Array(f32, 1), Array(i32, 1))
_ALONG_EIGHT = Door(_KERNELS, "hits_along_eight", (*_EIGHT, *_RAYS, *_HITS), "all hits of the ray caster's tree of eight")


class Cast(NamedTuple):
    """What rays met: t (n,) float32, row of the corners (n,) int32, u and v (n,) float32; visits (n, 2) int32, (0, 2) unless asked for."""

    t: NDArray[np.float32]
    row: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    visits: NDArray[np.int32]


def build_structure(corners: NDArray[np.float32], kind: StructureKind) -> Structure:
    """Build a structure over triangles (n, 9) float32, all finite."""
    if kind == "grid":
        return build_grid(corners)
    return build_bsp(corners) if kind == "bsp" else build_volume_tree(corners)


def cast(
    structure: Structure,
    frame: NDArray[np.float64],
    origins: NDArray[Any],
    directions: NDArray[Any],
    t_max: NDArray[Any],
    threads: int,
    *,
    any_hit: bool = False,
    counting: bool = False,
) -> Cast:
    """Find the nearest hit of every ray, or any.

    Parameters
    ----------
    structure : Grid | Bsp | VolumeTree
    frame : (8,) float64
        As of `accel.batch.nearest_hits`.
    origins, directions : (n, 3) numbers
    t_max : (n,) numbers
    threads : int
    any_hit : bool
        Stop at the first triangle that is found, which need not be the nearest.
    counting : bool
        Tell of each ray how many cells, nodes or boxes it visited, and how many triangles.
    """
    n = len(origins)
    t, row, uv = np.empty(n, dtype=f32), np.empty(n, dtype=i32), np.empty((2, n), dtype=f32)
    visits = np.zeros((n if counting else 0, 2), dtype=i32)
    door = _THROUGH_GRID if isinstance(structure, Grid) else _THROUGH_BSP if isinstance(structure, Bsp) else _THROUGH_TREE

    def trace(first: int) -> None:
        scratch = np.empty(DEEPEST + 2, dtype=i32), np.empty((DEEPEST + 2, 2)), np.zeros(2, dtype=i64)
        rays = _piece((origins, directions, t_max), first)
        door(*structure, frame, *rays, int(any_hit), t, row, uv, visits, first, *scratch)

    door.open()
    run_all(trace, range(0, n, _CHUNK), threads)
    return Cast(t, row, uv[0], uv[1], visits)


def every_hit(
    tree: VolumeTree | Accelerator,
    frame: NDArray[np.float64],
    origins: NDArray[Any],
    directions: NDArray[Any],
    t_max: NDArray[Any],
    threads: int,
) -> tuple[NDArray[np.int64], NDArray[np.float32], NDArray[np.int32], NDArray[np.float32], NDArray[np.float32]]:
    """Find all hits of every ray; arguments as of `cast`, but for the tree: one of least volumes, or of eight children, of triangles alone.

    Returns
    -------
    starts : (n + 1,) int64
        Ray k has the hits starts[k]..starts[k + 1].
    t : (m,) float32
        In order along each ray.
    row : (m,) int32
        Of the tree's corners, or the numbers that the packs hold; in order where t is equal.
    u, v : (m,) float32
    """
    n = len(origins)
    counts, starts = np.zeros(n, dtype=i32), np.zeros(n + 1, dtype=i64)

    # The same walk twice: first it counts, then there is room for what it finds.
    def trace(first: int) -> None:
        rays = _piece((origins, directions, t_max), first)
        door(*arrays, frame, *rays, counts, starts, *found, first, np.empty(STACK_SIZE, dtype=i32))

    door, arrays = (_ALONG_EIGHT, tuple(tree[:3])) if isinstance(tree, Accelerator) else (_ALONG, tuple(tree))
    door.open()
    found = _room_for_hits(0)
    run_all(trace, range(0, n, _CHUNK), threads)
    np.cumsum(counts, out=starts[1:])
    found = _room_for_hits(int(starts[-1]))
    if starts[-1]:
        run_all(trace, range(0, n, _CHUNK), threads)
    return (starts, *found)


def _room_for_hits(n: int) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float32], NDArray[np.float32]]:
    return np.empty(n, dtype=f32), np.empty(n, dtype=i32), np.empty(n, dtype=f32), np.empty(n, dtype=f32)


def _piece(rays: tuple[NDArray[Any], ...], first: int) -> list[NDArray[np.float64]]:
    """The rays of a piece as the kernels want them."""
    return [np.ascontiguousarray(part[first : first + _CHUNK], dtype=f64) for part in rays]
