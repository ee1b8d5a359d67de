"""The doors of the ray tracers: Whitted's (`ray`), the path tracer (`path`), the channels beside the picture, what denoisers are told."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar, Signature, is_witnessed
from .._jit import MODE
from ..accel import bvh
from ..accel.layouts import ACCELERATOR_ARRAYS, ENDS_SHAPE, STACK_SIZE, Accelerator
from ..kernel.sampler_kinds import SOBOL, columns_of
from ..tables import layouts
from ..tables.build import View
from ..tables.facets import facets_of
from ..tables.layouts import INSTANTS_ARRAYS, LIGHTING_ARRAYS, SCENE_ARRAYS, Instants, Lighting, SceneTables
from ..tiles import PerThread, Tile, run_all, tiles_of
from .eight import BLOCK, STATE_SIZE, WORDS_SIZE

__all__ = ["Settings", "Stage", "draw_channels", "draw_features", "prepare", "prepare_paths"]

MAX_PENDING = 64  # rays of one tree that wait
_I64 = Scalar(np.int64)
_ENDS, _NO_ENDS = Array(np.float64, 2), Array(np.float64, 1)


class _Doors:
    """A door for scenes of triangles, spheres and planes, one that knows all exact shapes and triangles that move, and one that knows
    materials with layers, too: these take longer to compile, and only scenes that have some wait for them.
    """

    def __init__(self, module: str, function: str, signature: Signature, what: str) -> None:
        self._usual = Door(module, function, tuple(_NO_ENDS if kind == _ENDS else kind for kind in signature), what)
        self._exact = Door(module, f"{function}_exact", signature, f"{what} with exact shapes")
        if Array(layouts.MEDIUM, 1) in signature:  # where light is asked for
            layered = tuple(Array(layouts.LAYERED_MATERIAL, 1) if kind == Array(layouts.MATERIAL, 1) else kind for kind in signature)
            self._layered = Door(module, f"{function}_layered", layered, f"{what} with layered materials")

    def serving(self, needs_exact: bool, needs_layers: bool = False) -> Door:
        """The door for a scene."""
        if needs_layers:
            return self._layered
        return self._exact if needs_exact else self._usual


_PICTURE = (
    *SCENE_ARRAYS, *ACCELERATOR_ARRAYS, *LIGHTING_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 3), Array(layouts.MEDIUM, 1),
    *INSTANTS_ARRAYS,
)  # fmt: skip
_TILE = (Array(np.int32, 1), _ENDS, Array(np.float32, 3), _I64, _I64, _I64, _I64, _I64, _I64, _I64)

_TRACE = _Doors(
    "limner.raytrace.tile",
    "trace_tile",
    (
        *_PICTURE, Array(np.int32, 2), Array(np.float32, 1), Array(np.int64, 1), Array(np.float32, 2), Array(np.int64, 2), *_TILE,
    ),
    "the ray renderer",
)  # fmt: skip

_PATH_SIGNATURE = (*_PICTURE, Array(np.float32, 1), Array(np.int64, 1), *_TILE)
_TRACE_PATH = _Doors("limner.raytrace.path_tile", "trace_path_tile", _PATH_SIGNATURE, "the path renderer")
_TRACE_MATTE = Door(
    "limner.raytrace.matte_tile",
    "trace_matte_tile",
    (
        *(Array(layouts.MATTE_MATERIAL, 1) if kind == Array(layouts.MATERIAL, 1) else kind for kind in _PICTURE),
        Array(np.float32, 1), Array(np.int64, 1), Array(np.int32, 1), _NO_ENDS, Array(np.float32, 2), Array(np.int32, 2),
        Array(np.float32, 1), Array(np.int32, 1), Array(np.float32, 1), Array(np.float32, 2), Array(np.float32, 3), *_TILE[3:],
    ),
    "the path renderer of matte scenes",
)  # fmt: skip

_TRACE_AOV = _Doors(
    "limner.raytrace.aov_tile",
    "trace_aov_tile",
    (
        *SCENE_ARRAYS, *ACCELERATOR_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 3), Array(np.int32, 1), _ENDS,
        Array(np.float32, 3), Array(np.int32, 3), _I64, _I64, _I64, _I64, _I64,
    ),
    "the ray renderer's channels",
)  # fmt: skip


_TRACE_FEATURES = _Doors(
    "limner.raytrace.features_tile",
    "feature_tile",
    (
        *SCENE_ARRAYS, *ACCELERATOR_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 3), *INSTANTS_ARRAYS, Array(np.int32, 2), _I64,
        Array(np.int32, 1), _ENDS, Array(np.float32, 3), _I64, _I64, _I64, _I64, _I64,
    ),
    "what denoisers are told",
)  # fmt: skip


class _Scratch(threading.local):
    """Rays and nodes that wait, and where a ray is inside the leaves of a combination; once for each thread."""

    def __init__(self, needs_exact: bool) -> None:
        ends = np.empty(ENDS_SHAPE if needs_exact else (0,), dtype=np.float64)
        self.pending = np.empty((MAX_PENDING, 10), dtype=np.float32)
        self.waiting = np.empty((MAX_PENDING, 4), dtype=np.int64)
        self.walk = np.empty(STACK_SIZE, dtype=np.int32), ends


class Settings(NamedTuple):
    """How to trace.

    Attributes
    ----------
    samples : int
        Of each pixel, in all.
    sample_places : (n, 2) int32, optional
        The samples of every pixel, relative to its centre, in 1/256 pixel; None: every pixel draws its own.
    sampler : int
        Where `sample_places` do not say, and for all other decisions: a kind of `limner.samples.SAMPLERS`.
    seed : int
    max_depth : int
        How often a ray is reflected and refracted at most, or light scattered.
    shadows : bool
        Whether lights can be hidden (Whitted's algorithm only).
    tinted_shadows : bool
        Whether light goes straight through dielectrics.
    glossy : bool
        Whether rough mirrors are followed by rays (Whitted's algorithm only).
    emitters : bool
        Whether shining surfaces light others (Whitted's algorithm only).
    """

    samples: int
    sample_places: NDArray[np.int32] | None = None
    sampler: int = SOBOL
    seed: int = 0
    max_depth: int = 8
    shadows: bool = True
    tinted_shadows: bool = True
    glossy: bool = False
    emitters: bool = False


class Stage(NamedTuple):
    """What is to be traced.

    Attributes
    ----------
    tables, tree, lighting, view : SceneTables, Accelerator, Lighting, View
    media : (n,) MEDIUM
        As `limner.tables.build.media_table` makes them.
    instants : Instants
        Of what moves; the tree must have been built with them.
    background : (4,) float32
        Radiance and alpha of what lies behind everything, where no sky does.
    """

    tables: SceneTables
    tree: Accelerator
    lighting: Lighting
    view: View
    media: NDArray[np.void]
    instants: Instants
    background: NDArray[np.float32]

    def needs_layers(self) -> bool:
        """Whether a material has a coat, a film, an inside …"""
        return bool(self.tables.materials["layers"].any())

    def needs_exact(self) -> bool:
        """Whether there are other exact shapes than spheres, planes and boxes, or triangles that move; or a door that meets them."""
        return _has_exact_shapes(self.tables) or len(self.instants.moving) > 0 or self.needs_layers()

    def is_matte(self) -> bool:
        """Whether there is nothing but opaque matte surfaces without textures, in clear air, that stand still."""
        tables, materials = self.tables, self.tables.materials
        is_matte = (materials["kind"] == layouts.LAMBERT).all() and (materials["alpha_mode"] == layouts.OPAQUE).all()
        is_clear = len(self.media) == 1 and not self.media[0]["attenuation"].any() and not len(tables.textures)
        return bool(is_matte and is_clear) and not len(self.instants.cameras) and not self.needs_exact()

    def arguments(self, materials: np.dtype[np.void] | None = None) -> tuple[Any, ...]:
        """The first arguments of a door, for one thread: what moves is moved in copies; `materials`: as what a door takes their rows."""
        tables, view = self.tables, self.view
        if len(self.instants.cameras):
            tables, view = tables._replace(instances=tables.instances.copy()), view._replace(camera=view.camera.copy())
        if self.needs_layers():
            tables = tables._replace(materials=tables.materials.view(layouts.LAYERED_MATERIAL))
        if materials is not None:
            tables = tables._replace(materials=tables.materials.view(materials))
        return (*tables, *self.tree, *self.lighting, *view, self.media, *self.instants)


def prepare(stage: Stage, settings: Settings, film: NDArray[np.float32]) -> Callable[[Tile, int, int], None]:
    """Make ready to trace by Whitted's algorithm. What comes back traces a range of the samples of a tile, from any thread.

    Parameters
    ----------
    stage : Stage
    settings : Settings
    film : (height, width, 4) float32
        Premultiplied sums, row 0 at the bottom; the caller divides by the number of samples.
    """
    places = _NO_PLACES if settings.sample_places is None else settings.sample_places
    rules = _rules(stage, settings)

    def bound() -> Callable[..., None]:
        scratch = _Scratch(stage.needs_exact())
        return _TRACE.serving(stage.needs_exact(), stage.needs_layers()).bind(
            *stage.arguments(), places, stage.background, rules, scratch.pending, scratch.waiting, *scratch.walk, film
        )

    kernel = PerThread(bound)
    return lambda tile, first_sample, last_sample: kernel.value(*tile, first_sample, last_sample)


def prepare_paths(stage: Stage, settings: Settings, film: NDArray[np.float32]) -> Callable[[Tile, int, int], None]:
    """Make ready to trace paths; as `prepare`."""
    rules = _rules(stage, settings)

    def bound() -> Callable[..., None]:
        # Uncompiled, eight at once are no faster, and a story of a path is one of one path.
        if stage.is_matte() and MODE == "compiled" and not is_witnessed():
            return _TRACE_MATTE.bind(
                *stage.arguments(layouts.MATTE_MATERIAL), stage.background, rules, *_Scratch(needs_exact=False).walk,
                *facets_of(stage.tables), stage.lighting.emitters.view(np.float32), np.full(WORDS_SIZE, -1, dtype=np.int32),
                np.zeros(STATE_SIZE, dtype=np.float32), np.empty((BLOCK, 4), dtype=np.float32), film,
            )  # fmt: skip
        return _TRACE_PATH.serving(stage.needs_exact(), stage.needs_layers()).bind(
            *stage.arguments(), stage.background, rules, *_Scratch(stage.needs_exact()).walk, film
        )

    kernel = PerThread(bound)
    return lambda tile, first_sample, last_sample: kernel.value(*tile, first_sample, last_sample)


_NO_PLACES = np.zeros((0, 2), dtype=np.int32)


def _rules(stage: Stage, settings: Settings) -> NDArray[np.int64]:
    """(10,) int64, in the order of `limner.raytrace.rules.Rules`."""
    numbers = (
        (stage.tables.materials["alpha_mode"] != layouts.OPAQUE).any(), settings.shadows, settings.max_depth, settings.tinted_shadows,
        settings.glossy, settings.emitters and len(stage.lighting.emitters) > 0, settings.sampler, settings.seed, settings.samples,
        columns_of(settings.samples),
    )  # fmt: skip
    return np.array(numbers, dtype=np.int64)


def _has_exact_shapes(tables: SceneTables) -> bool:
    """Whether there are any but spheres, planes and boxes."""
    return bool((tables.instances["kind"] >= layouts.DISK).any())


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
    needs_exact = _has_exact_shapes(tables)
    scratch, door = _Scratch(needs_exact), _TRACE_AOV.serving(needs_exact)
    run_all(
        lambda tile: door(*tables, *tree, *view, *scratch.walk, values, ids, *tile),
        tiles_of(width, height, tile_size),
        threads,
    )


def draw_features(
    stage: Stage, features: NDArray[np.float32], places: NDArray[np.int32], seed: int, *, threads: int, tile_size: int
) -> None:
    """Fill what a denoiser is told (`limner.raytrace.features_tile`).

    Parameters
    ----------
    stage : Stage
    features : (height, width, 7) float32
        Row 0 at the bottom.
    places : (n, 2) int32
        The rays of every pixel, relative to its centre, in 1/256 pixel.
    seed : int
        For lens and time.
    """
    height, width = features.shape[:2]
    needs_exact = stage.needs_exact()

    def bound() -> Callable[..., None]:
        tables, view = stage.tables, stage.view
        if len(stage.instants.cameras):  # what moves is moved in copies
            tables, view = tables._replace(instances=tables.instances.copy()), view._replace(camera=view.camera.copy())
        scratch = _Scratch(needs_exact)
        return _TRACE_FEATURES.serving(needs_exact).bind(
            *tables, *stage.tree, *view, *stage.instants, places, seed, *scratch.walk, features
        )

    kernel = PerThread(bound)
    run_all(lambda tile: kernel.value(*tile), tiles_of(width, height, tile_size), threads)
