"""The doors of the ray tracers: Whitted's (`ray`), the path tracer (`path`), and the channels beside the picture."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..accel import bvh
from ..accel.layouts import ACCELERATOR_ARRAYS, STACK_SIZE, Accelerator
from ..tables import layouts
from ..tables.build import View
from ..tables.layouts import LIGHTING_ARRAYS, SCENE_ARRAYS, Lighting, SceneTables
from ..tables.lighting import lighting as lighting_of
from ..tiles import Cancel, OnProgress, PerThread, Tile, run_all, tiles_of

__all__ = ["draw", "draw_channels", "prepare", "prepare_paths"]

MAX_PENDING = 32  # rays of one tree that wait
_I64 = Scalar(np.int64)

_TRACE = Door(
    "limner.raytrace.tile",
    "trace_tile",
    (
        *SCENE_ARRAYS, *ACCELERATOR_ARRAYS, *LIGHTING_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 3), Array(np.int32, 2),
        Array(np.float32, 1),
        _I64, _I64, _I64, Array(np.float32, 2), Array(np.int32, 1), Array(np.float32, 3), _I64, _I64, _I64, _I64, _I64, _I64, _I64,
    ),
    "the ray renderer",
)  # fmt: skip

_TRACE_PATH = Door(
    "limner.raytrace.path_tile",
    "trace_path_tile",
    (
        *SCENE_ARRAYS, *ACCELERATOR_ARRAYS, *LIGHTING_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 3), Array(np.float32, 1),
        _I64, _I64, _I64, Array(np.int32, 1), Array(np.float32, 3), _I64, _I64, _I64, _I64, _I64, _I64, _I64,
    ),
    "the path renderer",
)  # fmt: skip

_TRACE_AOV = Door(
    "limner.raytrace.aov_tile",
    "trace_aov_tile",
    (
        *SCENE_ARRAYS, *ACCELERATOR_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 3), Array(np.int32, 1), Array(np.float32, 3),
        Array(np.int32, 3), _I64, _I64, _I64, _I64, _I64,
    ),
    "the ray renderer's channels",
)  # fmt: skip


class _Scratch(threading.local):
    """Rays and nodes that wait, once for each thread."""

    def __init__(self) -> None:
        self.arrays = (np.empty((MAX_PENDING, 10), dtype=np.float32), np.empty(STACK_SIZE, dtype=np.int32))


def draw(
    tables: SceneTables,
    view: View,
    sample_places: NDArray[np.int32],
    background: NDArray[np.float32],
    film: NDArray[np.float32],
    *,
    max_depth: int,
    shadows: bool,
    threads: int,
    tile_size: int,
    accelerator: bvh.Kind = "bvh",
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
) -> None:
    """Trace all samples of a scene without a sky; see `prepare`. Raises Cancelled; the film then holds the tiles that are done."""
    tree, lighting = bvh.build(tables, accelerator), lighting_of(tables, None)
    work = prepare(tables, tree, lighting, view, sample_places, background, film, max_depth=max_depth, shadows=shadows)
    run_all(
        lambda tile: work(tile, 0, len(sample_places)),
        tiles_of(film.shape[1], film.shape[0], tile_size),
        threads,
        on_progress,
        cancel,
    )


def prepare(
    tables: SceneTables,
    tree: Accelerator,
    lighting: Lighting,
    view: View,
    sample_places: NDArray[np.int32],
    background: NDArray[np.float32],
    film: NDArray[np.float32],
    *,
    max_depth: int,
    shadows: bool,
) -> Callable[[Tile, int, int], None]:
    """Make ready to trace by Whitted's algorithm. What comes back traces a range of the samples of a tile, from any thread.

    Parameters
    ----------
    tables, tree, lighting, view : SceneTables, Accelerator, Lighting, View
    sample_places : (n, 2) int32
        The samples of every pixel, relative to its centre, in 1/256 pixel.
    background : (4,) float32
        Radiance and alpha of what lies behind everything, where no sky does.
    film : (height, width, 4) float32
        Premultiplied sums, row 0 at the bottom; the caller divides by the number of samples.
    max_depth : int
        How often a ray is reflected at most.
    shadows : bool
    """
    has_alpha = _has_alpha(tables)

    def bound() -> Callable[..., None]:
        scratch = _Scratch().arrays
        return _TRACE.bind(
            *tables, *tree, *lighting, *view, sample_places, background, has_alpha, int(shadows), max_depth, *scratch, film
        )

    kernel = PerThread(bound)
    return lambda tile, first_sample, last_sample: kernel.value(*tile, first_sample, last_sample)


def prepare_paths(
    tables: SceneTables,
    tree: Accelerator,
    lighting: Lighting,
    view: View,
    background: NDArray[np.float32],
    film: NDArray[np.float32],
    *,
    max_depth: int,
    seed: int,
) -> Callable[[Tile, int, int], None]:
    """Make ready to trace paths; as `prepare`. `max_depth` is how often light is scattered at most."""
    has_alpha = _has_alpha(tables)

    def bound() -> Callable[..., None]:
        stack = _Scratch().arrays[1]
        return _TRACE_PATH.bind(*tables, *tree, *lighting, *view, background, has_alpha, max_depth, seed, stack, film)

    kernel = PerThread(bound)
    return lambda tile, first_sample, last_sample: kernel.value(*tile, first_sample, last_sample)


def _has_alpha(tables: SceneTables) -> int:
    return int((tables.materials["alpha_mode"] != layouts.OPAQUE).any())


def draw_channels(
    tables: SceneTables,
    view: View,
    values: NDArray[np.float32],
    ids: NDArray[np.int32],
    *,
    threads: int,
    tile_size: int,
    accelerator: bvh.Kind = "bvh",
) -> None:
    """Fill the channels beside the picture (`limner.aov`) from one ray through the centre of each pixel.

    Parameters
    ----------
    tables, view : SceneTables, View
        Without blended materials.
    values, ids : (height, width, 16) float32, (height, width, 3) int32
        As `limner.aov.empty_values` makes them; row 0 at the bottom.
    """
    height, width = ids.shape[:2]
    tree = bvh.build(tables, accelerator)
    scratch = _Scratch()
    run_all(
        lambda tile: _TRACE_AOV(*tables, *tree, *view, scratch.arrays[1], values, ids, *tile),
        tiles_of(width, height, tile_size),
        threads,
    )
