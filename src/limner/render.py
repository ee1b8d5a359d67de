"""From a scene to a picture: the one door.

    image = limner.render("model.glb", width=800, height=600, renderer="ray")

What a scene lacks (a camera, light) is added and said; then the scene is flattened to tables, and a renderer fills a film.
"""

from __future__ import annotations

import os
import threading
import warnings as python_warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .aov import CHANNELS, channels, empty_values, with_solid_blends
from .errors import LimnerWarning, RenderError, SceneError, UnsupportedError
from .image.image import Image
from .progress import Meter, OnProgress
from .raster import pipeline
from .raytrace import driver as ray_driver
from .samples import pixel_samples
from .scene.camera import Camera
from .scene.framing import with_defaults
from .scene.scene import Scene
from .tables.build import build, names, view
from .tiles import Cancelled, thread_count

if TYPE_CHECKING:
    from .tables.build import View
    from .tables.layouts import SceneTables

__all__ = ["AOVS", "MAX_PIXELS", "MAX_SIDE", "RENDERERS", "render"]

RENDERERS = ("raster", "ray")
AOVS = CHANNELS
MAX_SIDE = 32768
MAX_PIXELS = 1 << 28
MAX_SAMPLES = 1 << 16
_DEFAULT_SAMPLES = {"raster": 8, "ray": 8}


def render(
    scene: Scene | str | os.PathLike[str],
    *,
    width: int = 800,
    height: int = 600,
    renderer: str = "raster",
    samples: int | None = None,
    seed: int = 0,
    camera: Camera | None = None,
    max_depth: int = 8,
    shadows: bool = True,
    threads: int | None = None,
    tile_size: int = pipeline.TILE_SIZE,
    aovs: Iterable[str] = (),
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Image:
    """Make a picture of a scene.

    Parameters
    ----------
    scene : Scene or path
        A path is loaded; "teapot" and "cornell" are built in.
    width, height : int
        Pixels, 1 to 32768 each.
    renderer : "raster" | "ray"
        The graphics pipeline, without shadows and reflections; or ray tracing with both.
    samples : int, optional
        Points of every pixel that are looked at; None: 8.
    seed : int
        For what is drawn by lot; the same seed, the same picture.
    camera : Camera, optional
        In place of the scene's own.
    max_depth : int >= 0
        How often a ray is reflected at most (`ray`).
    shadows : bool
        Whether lights can be hidden (`ray`).
    threads : int, optional
        None: all cores. The picture does not depend on it, nor on `tile_size`.
    aovs : iterable of str
        What to keep beside the picture, of `AOVS`: from one ray or sample through the centre of each pixel.
    on_progress : callable, optional
        Takes a `Progress` now and then.
    cancel : threading.Event, optional
        Set it to stop; the image so far comes back, `finished` False. So does a KeyboardInterrupt.

    Returns
    -------
    Image

    Raises
    ------
    SceneError, UnsupportedError, FileFormatError
        Before anything is drawn.
    """
    _check(width, height, renderer, samples, max_depth, tile_size)
    wanted = _wanted_aovs(aovs)
    n_threads = thread_count(threads)
    if not isinstance(scene, Scene):
        scene = _opened(scene)
    if camera is not None:
        scene = scene.replace(camera=camera)
    scene, messages = with_defaults(scene, width / height)
    assert scene.camera is not None
    tables = build(scene, scene.camera, width, height)
    seen = view(scene, tables, scene.camera, width, height)
    n = _DEFAULT_SAMPLES[renderer] if samples is None else samples
    film = np.zeros((height, width, 4), dtype=np.float32)
    background = _background(scene)
    meter = Meter(on_progress, "render")
    meter.report(0.0)
    finished = True
    try:
        if renderer == "raster":
            pipeline.draw(
                tables, seen, pixel_samples(n), background, film,
                threads=n_threads, tile_size=tile_size, on_progress=meter.report, cancel=cancel,
            )  # fmt: skip
        else:
            ray_driver.draw(
                tables, seen, pixel_samples(n), background, film, max_depth=max_depth, shadows=shadows,
                threads=n_threads, tile_size=tile_size, on_progress=meter.report, cancel=cancel,
            )  # fmt: skip
        extra = _aov_pass(wanted, renderer, tables, seen, n_threads, tile_size)
    except (Cancelled, KeyboardInterrupt):
        finished, extra = False, {}
    except MemoryError:
        raise RenderError(f"there is not enough memory for a picture of {width} x {height}") from None
    pixels, slips = _developed(film, n)
    recipe = _recipe(width, height, renderer, n, seed, max_depth, scene.camera)
    id_names = {name: ids for name, ids in names(scene).items() if name in extra}
    for slip in slips:
        python_warnings.warn(slip, LimnerWarning, stacklevel=2)
    return Image(pixels, extra, id_names, recipe, (*messages, *slips), finished)


def _check(width: int, height: int, renderer: str, samples: int | None, max_depth: int, tile_size: int) -> None:
    for name, value in (("width", width), ("height", height)):
        if not isinstance(value, (int, np.integer)) or not 1 <= value <= MAX_SIDE:
            raise SceneError(f"{name} must be an integer from 1 to {MAX_SIDE}, got {value!r}")
    if width * height > MAX_PIXELS:
        raise SceneError(f"a picture must not have more than {MAX_PIXELS} pixels, got {width} x {height}")
    if renderer not in RENDERERS:
        raise UnsupportedError(f"renderer must be one of {', '.join(RENDERERS)}, got {renderer!r}")
    if samples is not None and (not isinstance(samples, (int, np.integer)) or not 1 <= samples <= MAX_SAMPLES):
        raise SceneError(f"samples must be an integer from 1 to {MAX_SAMPLES}, got {samples!r}")
    if not 0 <= max_depth <= 1000:
        raise SceneError(f"max_depth must lie between 0 and 1000, got {max_depth!r}")
    if not 8 <= tile_size <= 1024:
        raise SceneError(f"tile_size must lie between 8 and 1024, got {tile_size!r}")


def _wanted_aovs(aovs: Iterable[str]) -> tuple[str, ...]:
    wanted = tuple(dict.fromkeys(aovs))
    for name in wanted:
        if name not in AOVS:
            raise UnsupportedError(f"aov must be one of {', '.join(AOVS)}, got {name!r}")
    return wanted


def _opened(path: str | os.PathLike[str]) -> Scene:
    from .files.load import load
    from .scene.library import BUILTINS, builtin

    return builtin(str(path)) if str(path) in BUILTINS else load(path)


def _background(scene: Scene) -> NDArray[np.float32]:
    if scene.background is None:
        return np.zeros(4, dtype=np.float32)
    return np.array([*scene.background, 1.0], dtype=np.float32)


def _aov_pass(
    wanted: tuple[str, ...], renderer: str, tables: SceneTables, seen: View, threads: int, tile_size: int
) -> dict[str, NDArray[Any]]:
    if not wanted:
        return {}
    values, ids = empty_values(int(seen.camera["width"][0]), int(seen.camera["height"][0]))
    draw_channels = pipeline.draw_channels if renderer == "raster" else ray_driver.draw_channels
    draw_channels(with_solid_blends(tables), seen, values, ids, threads=threads, tile_size=tile_size)
    return channels(wanted, values, ids)


def _developed(film: NDArray[np.float32], n: int) -> tuple[NDArray[np.float32], list[str]]:
    """The film's sums as straight-alpha pixels, row 0 on top; and what is wrong with them."""
    pixels = film[::-1] * np.float32(1.0 / n)
    alpha = pixels[..., 3:]
    partial = (alpha > 0.0) & (alpha < 1.0)
    if partial.any():
        np.divide(pixels[..., :3], alpha, out=pixels[..., :3], where=partial)
    bad = ~np.isfinite(pixels).all(axis=2)
    slips = []
    if bad.any():
        y, x = (int(k) for k in np.argwhere(bad)[0])
        slips.append(f"{int(bad.sum())} pixels are not finite and were made black, the first at x = {x}, y = {y}")
        pixels[bad] = 0.0
    return pixels, slips


def _recipe(width: int, height: int, renderer: str, samples: int, seed: int, max_depth: int, camera: Camera) -> dict[str, Any]:
    from . import __version__

    return {
        "limner": __version__,
        "renderer": renderer,
        "width": width,
        "height": height,
        "samples": samples,
        "seed": seed,
        "max_depth": max_depth,
        "camera": {
            key: np.asarray(value).tolist() if isinstance(value, np.ndarray) else value for key, value in vars(camera).items()
        },
    }
