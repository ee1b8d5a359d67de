"""The graphics pipeline, stage by stage (FoCG 8):

    vertices ──► clip, snap, cull ──► bins ──► per tile: fill with depth ──► fragments ──► resolve

`_geometry` and `prepare` below are this line. Every stage runs on all threads over ranges of its input; results stand in the order of
the input, so the picture does not depend on how many there are.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..accel.layouts import ACCELERATOR_ARRAYS, STACK_SIZE, Accelerator
from ..film import ENCODING, not_encoded
from ..tables import layouts
from ..tables.build import View
from ..tables.layouts import LIGHTING_ARRAYS, SCENE_ARRAYS, Lighting, SceneTables
from ..tables.lighting import lighting as lighting_of
from ..tiles import Cancel, OnProgress, PerThread, Tile, run_all, tiles_of
from . import painter
from .bsp import BspTree
from .in_view import instances_in_view
from .layouts import (
    BACK_SIDE,
    BOTH_SIDES,
    CUT,
    FLOAT_ROWS,
    FRONT_SIDE,
    INT_ROWS,
    MAX_CLIPPED,
    PER_FRAGMENT,
    SCREEN_TRIANGLE,
    SUBPIXELS,
    WORDS,
)
from .memory import Memory
from .pyramid import pyramid_planes

__all__ = ["CULLINGS", "TILE_SIZE", "Shadows", "draw", "draw_channels", "prepare"]

TILE_SIZE = 64
CULLINGS = ("material", "back", "front", "none")
_CHUNK = 8192  # vertices or triangles that make a job worth a call
_I64 = Scalar(np.int64)
_AFTER_BACKGROUND = 16  # arguments of a tile's door: scratch, film, encoding, tile, samples

_TRANSFORM = Door(
    "limner.raster.vertex",
    "transform_vertices",
    (
        Array(layouts.MESH_RANGES, 1), Array(layouts.INSTANCE, 1), Array(np.float32, 2), Array(np.float32, 3), Scalar(np.float32),
        Array(np.int64, 2), _I64, _I64, Array(np.float32, 2), Array(np.int32, 1),
    ),
    "the vertex stage",
)  # fmt: skip

_ASSEMBLE = Door(
    "limner.raster.assemble",
    "assemble_triangles",
    (
        Array(layouts.INSTANCE, 1), Array(layouts.MESH_RANGES, 1), Array(np.float32, 2), Array(np.int32, 2), Array(np.int32, 1),
        Array(layouts.MATERIAL, 1), Array(layouts.CAMERA, 1), Array(np.float32, 3), Array(np.float32, 2), Array(np.int32, 1),
        Array(np.float64, 2), Array(np.int32, 2), _I64, _I64,
        Array(np.int64, 2), _I64, _I64, Array(np.float32, 2), Array(np.float32, 2), Array(np.float64, 2), Array(np.float64, 2),
        Array(np.int32, 1), Array(SCREEN_TRIANGLE, 1), Array(np.int32, 1), _I64, _I64, Array(np.int64, 1), _I64,
    ),
    "primitive assembly and clipping",
)  # fmt: skip

_COUNT = Door(
    "limner.raster.assemble",
    "count_bins",
    (
        Array(np.int32, 2), _I64, _I64, _I64, _I64, Array(np.int32, 1), Array(np.int32, 1), _I64, Array(np.int64, 2), _I64,
        Array(np.int32, 1),
    ),
    "binning",
)

_BIN = Door(
    "limner.raster.assemble",
    "bin_triangles",
    (Array(np.int32, 1), _I64, _I64, _I64, Array(np.int64, 2), _I64, Array(np.int32, 1)),
    "binning",
)

_DRAW = Door(
    "limner.raster.tile",
    "draw_tile",
    (
        *SCENE_ARRAYS, *LIGHTING_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 2), Array(np.int64, 1),
        Array(SCREEN_TRIANGLE, 1), Array(CUT, 1), Array(np.int32, 1), Array(np.int64, 1), Array(np.int32, 2), _I64, _I64, _I64, _I64,
        Array(np.int32, 2), Array(np.float32, 1), Array(np.float32, 1), Array(np.float32, 2), Array(np.int32, 2), Array(np.int32, 1),
        Array(np.float32, 2), *ENCODING, _I64, _I64, _I64, _I64, _I64, _I64, _I64,
    ),
    "the raster renderer",
)  # fmt: skip

_DRAW_SHADOWED = Door(
    "limner.raster.tile",
    "draw_shadowed_tile",
    (
        *_DRAW.signature[: -_AFTER_BACKGROUND], *ACCELERATOR_ARRAYS, Array(layouts.MEDIUM, 1), _I64, _I64, Array(np.int32, 1),
        Array(np.float64, 1), *_DRAW.signature[-_AFTER_BACKGROUND:],
    ),
    "the raster renderer with shadows",
)  # fmt: skip

_DRAW_LAYERED, _DRAW_LAYERED_SHADOWED = (
    Door(
        "limner.raster.tile",
        function,
        tuple(Array(layouts.LAYERED_MATERIAL, 1) if kind == Array(layouts.MATERIAL, 1) else kind for kind in door.signature),
        f"{door.what} and layered materials",
    )
    for function, door in (("draw_layered_tile", _DRAW), ("draw_layered_shadowed_tile", _DRAW_SHADOWED))
)

_DRAW_AOV = Door(
    "limner.raster.aov_tile",
    "draw_aov_tile",
    (
        *SCENE_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 2), Array(np.int64, 1), Array(SCREEN_TRIANGLE, 1), Array(CUT, 1),
        Array(np.int32, 1), Array(np.int64, 1), Array(np.float32, 2), Array(np.int32, 2), Array(np.float32, 3), Array(np.int32, 3),
        _I64, _I64, _I64, _I64, _I64,
    ),
    "the raster renderer's channels",
)  # fmt: skip


class Shadows(NamedTuple):
    """What shadow rays go through: the tree of the scene, its media (`tables.build.media_table`), and whether glass lets light by."""

    tree: Accelerator
    media: NDArray[np.void]
    tinted: bool


class Drawing:
    """A picture whose stages before the pixels are done: ``drawing(tile, first_sample, last_sample)`` adds to the film, from any thread.

    It returns False where there was nothing to draw.
    """

    def __init__(self, bound: Callable[..., Callable[..., None]], film: NDArray[np.float32], touched: list[bool], samples: int) -> None:
        self._bound, self._touched, self._samples = bound, touched, samples
        self._kernel = PerThread(lambda: bound(film.reshape(-1, 4), *not_encoded()))

    def __call__(self, tile: Tile, first_sample: int, last_sample: int) -> bool:
        if not self._touched[tile.number]:
            return False
        self._kernel.value(*tile, first_sample, last_sample)
        return True

    def to_bytes(self, room: int, *encoding: Any) -> Callable[[Tile], None]:
        """What draws all samples of a tile and encodes them (`Film.encoding_at_once`), with no film: a tile has `room` pixels at most."""
        kernel = PerThread(lambda: self._bound(np.empty((room, 4), dtype=np.float32), *encoding))

        def draw_tile(tile: Tile) -> None:
            if self._touched[tile.number]:
                kernel.value(*tile, 0, self._samples)

        return draw_tile


class Vertices(NamedTuple):
    """What the vertex stage leaves: (n, 4) float32 (x w, y w, depth, w), and where each instance's begin."""

    transformed: NDArray[np.float32]
    first_vertex: NDArray[np.int64]


class Bins(NamedTuple):
    """Screen triangles, the cuts that bound them, and which of them may touch a tile: binned[ranges[tile] : ranges[tile + 1]]."""

    screen: NDArray[np.void]
    cuts: NDArray[np.void]
    binned: NDArray[np.int32]
    ranges: NDArray[np.int64]


def draw(
    tables: SceneTables,
    view: View,
    sample_places: NDArray[np.int32],
    background: NDArray[np.float32],
    film: NDArray[np.float32],
    *,
    threads: int,
    tile_size: int = TILE_SIZE,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
) -> None:
    """Draw all samples of a scene without a sky; see `prepare`. Raises Cancelled; the film then holds the tiles that are done."""
    work = prepare(tables, lighting_of(tables, None), view, sample_places, background, film, threads=threads, tile_size=tile_size)
    tiles = tiles_of(film.shape[1], film.shape[0], tile_size)
    run_all(lambda tile: work(tile, 0, len(sample_places)), tiles, threads, on_progress, cancel)


def prepare(
    tables: SceneTables,
    lighting: Lighting,
    view: View,
    sample_places: NDArray[np.int32],
    background: NDArray[np.float32],
    film: NDArray[np.float32],
    *,
    threads: int,
    tile_size: int = TILE_SIZE,
    multisample: int = 0,
    frequency: int = PER_FRAGMENT,
    hidden_surfaces: str = "zbuffer",
    clipping: str = "homogeneous",
    tree: BspTree | None = None,
    on_note: Callable[[str], None] | None = None,
    culling: str = "material",
    sample_weights: NDArray[np.float32] | None = None,
    shadows: Shadows | None = None,
    memory: Memory | None = None,
) -> Drawing:
    """Run the stages before the pixels.

    Parameters
    ----------
    tables, lighting, view : SceneTables, Lighting, View
    sample_places : (n, 2) int32
        The samples of every pixel, relative to its centre, on the subpixel grid.
    background : (4,) float32
        Radiance and alpha of what lies behind everything, where no sky does.
    film : (height, width, 4) float32
        Premultiplied sums, row 0 at the bottom; the caller divides by the number of samples.
    multisample : int
        0: every sample is shaded; else samples come eight at a time, and what covers several is shaded once.
    frequency : PER_FRAGMENT | PER_VERTEX | PER_TRIANGLE
        Where the shading is computed.
    hidden_surfaces : "zbuffer" | "painter"
        Compare depths (FoCG 8.2.3), or draw from back to front (FoCG 8.2.2; see `painter`).
    clipping : "homogeneous" | "world"
        Clip after the projection (FoCG 8.1.5), or to the viewing pyramid before it (FoCG 8.1.4).
    tree : BspTree, optional
        Of the painter (`painter.build_tree`), if it is there already.
    on_note : callable, optional
        Takes what a person should know about the picture, in one line.
    culling : "material" | "back" | "front" | "none"
        Which triangles are left out: the backs of one-sided materials, all backs, all fronts, none.
    sample_weights : (n,) float32, optional
        What each sample counts (`limner.pixel_filter.filtered_samples`), their sum n; None: 1 each.
    shadows : Shadows, optional
        None: every light reaches everything.
    memory : Memory, optional
        Of a picture before this one, which is done.
    """
    height, width = film.shape[:2]
    memory = memory or Memory()
    reach = int(sample_places.min()), int(sample_places.max())
    vertices, bins = _geometry(
        tables, view, width, height, tile_size, threads, hidden_surfaces, clipping, tree, on_note, reach, culling, memory
    )  # fmt: skip
    words = _words(bins.screen)
    weights = np.ones(len(sample_places), dtype=np.float32) if sample_weights is None else sample_weights
    has_layers = bool(tables.materials["layers"].any())
    if has_layers:
        tables = tables._replace(materials=tables.materials.view(layouts.LAYERED_MATERIAL))
    has_blend = int((tables.materials["alpha_mode"] == layouts.BLEND).any())
    groups = len(tables.instances) * len(tables.materials) + 1

    def bound(*sums: Any) -> Callable[..., None]:
        room = tile_size * tile_size * (8 if multisample and not has_blend else 1)
        scratch = memory.of_thread((room, groups), lambda: _scratch(room, groups))
        door, rays = (_DRAW_LAYERED if has_layers else _DRAW), ()
        if shadows is not None:
            door, rays = (_DRAW_LAYERED_SHADOWED if has_layers else _DRAW_SHADOWED), _ray_arguments(shadows, tables)
        return door.bind(
            *tables, *lighting, view.camera, *vertices, *bins, words, has_blend, multisample, width, frequency, sample_places, weights,
            background, *rays, *scratch, *sums, for_one_thread=True,
        )  # fmt: skip

    shows_behind = bool(lighting.header[0]["sky_visible"]) or bool(background[3] != 0.0)
    # Plain numbers: a tile is asked in less time than NumPy takes to find one.
    touched = (shows_behind | (np.diff(bins.ranges) > 0)).tolist()
    return Drawing(bound, film, touched, len(sample_places))


def draw_channels(
    tables: SceneTables,
    view: View,
    values: NDArray[np.float32],
    ids: NDArray[np.int32],
    *,
    threads: int,
    tile_size: int = TILE_SIZE,
    hidden_surfaces: str = "zbuffer",
    clipping: str = "homogeneous",
    tree: BspTree | None = None,
    culling: str = "material",
) -> None:
    """Fill the channels beside the picture (`limner.aov`) from the sample in the centre of each pixel.

    Parameters
    ----------
    tables, view : SceneTables, View
        Without blended materials.
    values, ids : (height, width, 16) float32, (height, width, 3) int32
        As `limner.aov.empty_values` makes them; row 0 at the bottom.
    hidden_surfaces, clipping, tree, culling
        As in `prepare`.
    """
    height, width = ids.shape[:2]
    vertices, bins = _geometry(
        tables, view, width, height, tile_size, threads, hidden_surfaces, clipping, tree, samples=(0, 0), culling=culling
    )  # fmt: skip
    scratch = PerThread(lambda: _scratch(tile_size * tile_size)[:2])

    def draw_tile(tile: Tile) -> None:
        _DRAW_AOV(*tables, view.camera, *vertices, *bins, *scratch.value, values, ids, *tile)

    run_all(draw_tile, tiles_of(width, height, tile_size), threads)


def _geometry(
    tables: SceneTables,
    view: View,
    width: int,
    height: int,
    tile_size: int,
    threads: int,
    hidden_surfaces: str = "zbuffer",
    clipping: str = "homogeneous",
    tree: BspTree | None = None,
    on_note: Callable[[str], None] | None = None,
    samples: tuple[int, int] = (-SUBPIXELS // 2, SUBPIXELS // 2),
    culling: str = "material",
    memory: Memory | None = None,
) -> tuple[Vertices, Bins]:
    """The stages before the pixels: vertices, assembly and clipping, the painter's order where it is wanted, bins.

    Triangles that miss all samples are left out: `samples` is how far these lie to the left and right of their pixel's centre at most.
    """
    memory = memory or Memory()
    in_view = instances_in_view(tables, view, width, height, samples)
    vertices, snapped = _transform(tables, view, in_view, memory, threads)
    clip_planes = pyramid_planes(view.camera) if clipping == "world" else np.zeros((0, 4))
    grid = _Grid(width, height, tile_size, samples)
    chunks, screen, counted = _assemble(tables, view, in_view, vertices, snapped, clip_planes, culling, grid, memory, threads)
    cuts = np.zeros(0, dtype=CUT)
    if hidden_surfaces == "painter":
        whole = np.concatenate([np.zeros(0, dtype=SCREEN_TRIANGLE), *(screen[a:b] for a, b in chunks)])
        drawn, note = painter.order(tables, view.camera, tree)
        screen, cuts = painter.ranked(tables, view.camera, vertices, whole, drawn)
        chunks = [(a, min(a + _CHUNK, len(screen))) for a in range(0, len(screen), _CHUNK)]
        counted = _Counted(grid, len(chunks), len(screen), memory)
        run_all(lambda k: counted.add(screen, chunks[k], k), range(len(chunks)), threads)
        if note is not None and on_note is not None:
            on_note(note)
    return vertices, _bin(screen, cuts, chunks, counted, memory, threads)


def _counts(tables: SceneTables, what: str, in_view: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(n,) int64: how many vertices or triangles of each instance go through the pipeline."""
    if not len(in_view):
        return np.zeros(0, dtype=np.int64)
    return np.where(in_view, tables.meshes[what][tables.instances["mesh"]], 0).astype(np.int64)


def _jobs(counts: NDArray[np.int64], places: NDArray[np.int64], *, moves_on: bool) -> tuple[NDArray[np.int64], list[tuple[int, int]]]:
    """Ranges of every instance's vertices or triangles, and groups of them that are worth a call.

    Returns (n, 4) rows (instance, first, last, place) and [(first job, last job)]; `moves_on`: the place goes with the range.
    """
    rows: list[tuple[int, int, int, int]] = []
    groups: list[tuple[int, int]] = []
    first, weight = 0, 0
    for instance, n in enumerate(counts.tolist()):
        for start in range(0, n, _CHUNK):
            end = min(start + _CHUNK, n)
            rows.append((instance, start, end, int(places[instance]) + (start if moves_on else 0)))
            weight += end - start
            if weight >= _CHUNK:
                groups.append((first, len(rows)))
                first, weight = len(rows), 0
    if weight:
        groups.append((first, len(rows)))
    return np.array(rows, dtype=np.int64).reshape(-1, 4), groups


def _transform(
    tables: SceneTables, view: View, in_view: NDArray[np.bool_], memory: Memory, threads: int
) -> tuple[Vertices, NDArray[np.int32]]:
    """The vertices, and their places on the subpixel grid."""
    counts = _counts(tables, "n_positions", in_view)
    first_vertex = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    transformed = memory.array("vertices", (int(first_vertex[-1]), 4), np.float32)
    snapped = memory.array("snapped", 2 * len(transformed), np.int32)
    near = view.camera[0]["near"]
    jobs, groups = _jobs(counts, first_vertex, moves_on=True)
    run_all(
        lambda group: _TRANSFORM(
            tables.meshes, tables.instances, tables.positions, view.raster_from_object, near, jobs, *group, transformed, snapped
        ),
        groups,
        threads,
    )  # fmt: skip
    return Vertices(transformed, first_vertex), snapped


def _assemble(
    tables: SceneTables,
    view: View,
    in_view: NDArray[np.bool_],
    vertices: Vertices,
    snapped: NDArray[np.int32],
    clip_planes: NDArray[np.float64],
    culling: str,
    grid: _Grid,
    memory: Memory,
    threads: int,
) -> tuple[list[tuple[int, int]], NDArray[np.void], _Counted]:
    """Screen triangles in chunks with gaps between; clipping can make more of them than there were, and then it runs again."""
    jobs, groups = _jobs(_counts(tables, "n_triangles", in_view), vertices.first_vertex, moves_on=False)
    sizes = np.array([int((jobs[a:b, 2] - jobs[a:b, 1]).sum()) for a, b in groups], dtype=np.int64)
    counts = np.zeros(len(groups), dtype=np.int64)
    capacity = sizes + 64
    sides = np.select(
        [culling == "none", culling == "back", culling == "front"],
        [np.full_like(tables.materials["kind"], side) for side in (BOTH_SIDES, FRONT_SIDE, BACK_SIDE)],
        np.where(tables.materials["double_sided"] != 0, BOTH_SIDES, FRONT_SIDE),
    )
    sided = np.ascontiguousarray(np.stack([sides, tables.materials["alpha_mode"]], axis=1), dtype=np.int32)
    is_whole = np.zeros(len(groups), dtype=np.bool_)
    while True:
        places = np.concatenate([[0], np.cumsum(capacity)]).astype(np.int64)
        screen = memory.array("screen", int(places[-1]), SCREEN_TRIANGLE)
        counted = _Counted(grid, len(groups), len(screen), memory)

        def assemble(
            chunk: int, places: NDArray[np.int64] = places, screen: NDArray[np.void] = screen, counted: _Counted = counted
        ) -> None:
            polygon, scratch = (np.empty((MAX_CLIPPED, 4), dtype=np.float32) for _ in range(2))
            world, world_scratch = (np.empty((MAX_CLIPPED, 6)) for _ in range(2))  # position and barycentric coordinates
            _ASSEMBLE(
                tables.instances, tables.meshes, tables.positions, tables.triangles, tables.slots, tables.materials, view.camera,
                view.raster_from_object, vertices.transformed, snapped, clip_planes, sided, *grid.samples, jobs, *groups[chunk], polygon,
                scratch, world, world_scratch, np.zeros(16, dtype=np.int32), screen, screen.view(np.int32), int(places[chunk]),
                int(places[chunk + 1]), counts, chunk,
            )  # fmt: skip
            # While they are at hand: a chunk fits the second-level cache.
            is_whole[chunk] = counts[chunk] + 8 <= places[chunk + 1] - places[chunk]
            if is_whole[chunk]:
                counted.add(screen, (int(places[chunk]), int(places[chunk] + counts[chunk])), chunk)

        run_all(assemble, range(len(groups)), threads)
        if is_whole.all():
            return [(int(a), int(a + n)) for a, n in zip(places, counts, strict=False)], screen, counted
        capacity = np.maximum(capacity, counts + 8)


def _words(screen: NDArray[np.void]) -> NDArray[np.int32]:
    """The screen triangles as plain numbers, (n, WORDS)."""
    return screen.view(np.int32).reshape(len(screen), WORDS)


class _Grid:
    """The tiles of a picture, and how far from their pixel's centre the samples lie."""

    def __init__(self, width: int, height: int, tile_size: int, samples: tuple[int, int]) -> None:
        self.samples = samples
        self.columns, self.rows = -(-width // tile_size), -(-height // tile_size)
        self.column_of, self.row_of = (np.arange(size, dtype=np.int32) // tile_size for size in (width, height))


class _Counted:
    """How many triangles of each chunk each tile gets, and which tiles each triangle touches."""

    def __init__(self, grid: _Grid, n_chunks: int, n_triangles: int, memory: Memory) -> None:
        self.grid = grid
        self.counts = np.zeros((max(n_chunks, 1), grid.columns * grid.rows), dtype=np.int64)
        self.touched = memory.array("touched", 4 * n_triangles + 32, np.int32)

    def add(self, screen: NDArray[np.void], part: tuple[int, int], chunk: int) -> None:
        grid = self.grid
        _COUNT(_words(screen), *part, *grid.samples, grid.column_of, grid.row_of, grid.columns, self.counts, chunk, self.touched)


def _bin(
    screen: NDArray[np.void], cuts: NDArray[np.void], chunks: list[tuple[int, int]], counted: _Counted, memory: Memory, threads: int
) -> Bins:
    ranges = np.concatenate([[0], np.cumsum(counted.counts.sum(axis=0))]).astype(np.int64)
    places = np.ascontiguousarray(ranges[:-1] + np.cumsum(counted.counts, axis=0) - counted.counts)
    binned = memory.array("binned", int(ranges[-1]), np.int32)
    columns = counted.grid.columns
    run_all(lambda k: _BIN(counted.touched, *chunks[k], columns, places, k, binned), range(len(chunks)), threads)
    return Bins(screen, cuts, binned, ranges)


def _ray_arguments(shadows: Shadows, tables: SceneTables) -> tuple[Any, ...]:
    has_alpha = int((tables.materials["alpha_mode"] != layouts.OPAQUE).any())
    stack, no_ends = np.empty(STACK_SIZE, dtype=np.int32), np.empty(0, dtype=np.float64)
    return (*shadows.tree, shadows.media, int(shadows.tinted), has_alpha, stack, no_ends)


def _scratch(n: int, groups: int = 1) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.int32]]:
    """What a tile of n samples needs while it is drawn (`tile.draw_tile`); `groups`: pairs of instance and material at most."""
    room = n + 16
    table = np.empty(1 << (2 * min(room, groups)).bit_length(), dtype=np.int32)
    return np.zeros((FLOAT_ROWS, room), dtype=np.float32), np.zeros((INT_ROWS, room), dtype=np.int32), table
