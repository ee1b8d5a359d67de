"""From a scene to pictures: the one door.

    image = limner.render("model.glb", width=800, height=600, renderer="ray")

    with limner.Renderer(scene, width=1280, height=720) as renderer:
        for camera in cameras:
            frame = renderer.render(camera)

What a scene lacks (a camera, light) is added and said; then the scene is flattened to tables, and a renderer exposes a film. A Renderer
keeps what did not change from one picture to the next.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import threading
import warnings as python_warnings
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from .accel import bvh
from .accel.layouts import Accelerator
from .aov import CHANNELS, FEATURES, LIGHT, PASSES, Moments, channels, empty_values, features_of, samples_of, with_solid_blends
from .budget import BLOCK, Budget, Spending
from .color.views import checked_exposure, checked_view
from .errors import LimnerWarning, RenderError, SceneError, UnsupportedError
from .film import Film
from .image.denoise import GUIDES, checked_denoiser, denoised
from .image.image import Image
from .image.recipe import Recipe
from .image.reconstruct import FILTERS
from .kernel.sampler_kinds import SAMPLERS, SOBOL
from .pixel_filter import filtered_samples
from .progress import Meter, OnProgress
from .raster import pipeline
from .raster.layouts import PER_FRAGMENT, PER_TRIANGLE, PER_VERTEX
from .raster.memory import Memory
from .raster.pipeline import CULLINGS
from .raytrace import driver
from .raytrace.light_passes import group_names, lit_by
from .samples import pixel_samples
from .scene.camera import Camera
from .scene.environment import Environment
from .scene.framing import with_defaults
from .scene.lamp import lights_in_solids, with_lamps
from .scene.material import Dielectric, Material
from .scene.pose import animated, at, posed
from .scene.scene import Scene
from .tables.build import Built, View, flatten, media_table, names, view
from .tables.layouts import Instants, Lighting
from .tables.lighting import lighting
from .tables.motion import instants
from .tables.sky_blur import blurred_sky
from .tiles import Cancelled, Tile, is_whole, run_all, thread_count

__all__ = ["AOVS", "MAX_PIXELS", "MAX_SIDE", "RENDERERS", "Frame", "Renderer", "render"]

RENDERERS = ("raster", "ray", "path")
AOVS = (*CHANNELS, *FEATURES, *LIGHT, *PASSES)
MAX_SIDE = 32768
MAX_PIXELS = 1 << 26
MAX_SAMPLES = 1 << 20
_MOST_SAMPLES = {"noise": 4096, "time": 1 << 16}
_DEFAULT_SAMPLES = {"raster": 8, "ray": 8, "path": 64}
_TILE_SIZE = {"raster": pipeline.TILE_SIZE, "ray": 32, "path": 32}
_SAMPLES_AT_ONCE = {"raster": 8, "ray": 8, "path": 4}
_LEAST_PASSES = 16  # where variance is asked for
_FEATURE_SAMPLES = 16

_FREQUENCIES = {"fragment": PER_FRAGMENT, "vertex": PER_VERTEX, "flat": PER_TRIANGLE}
_BLANK = "nothing of the scene is in the picture: the camera looks past it, or stands behind single-sided surfaces"

Work = Callable[[Tile, int, int], object]


def render(
    scene: Any,
    *,
    width: int = 800,
    height: int = 600,
    renderer: str = "raster",
    samples: int | None = None,
    seed: int = 0,
    camera: Camera | None = None,
    max_depth: int = 8,
    shadows: bool | None = None,
    sampler: str | None = None,
    glossy: bool = False,
    emitters: bool = False,
    tinted_shadows: bool | None = None,
    shutter: tuple[float, float] | None = None,
    time: float | None = None,
    animation: str | int | None = None,
    antialiasing: str = "multisample",
    shading: str = "fragment",
    hidden_surfaces: str = "zbuffer",
    clipping: str = "homogeneous",
    culling: str = "material",
    filter: str = "box",
    threads: int | None = None,
    tile_size: int | None = None,
    aovs: Iterable[str] = (),
    denoise: str | None = None,
    default_lights: bool = True,
    noise: float | None = None,
    time_limit: float | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    checkpoint_seconds: float = 60.0,
    resume: bool = False,
    on_snapshot: Callable[[Image], object] | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Image:
    """Make a picture of a scene.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        A path is loaded; "teapot" and "cornell" are built in.
    width, height : int
        Pixels, 1 to 32768 each.
    renderer : "raster" | "ray" | "path" | "lines"
        The graphics pipeline, without reflections; ray tracing with both; or path tracing, with all light that surfaces
        send to each other. Or the outlines and creases alone, black on the background or on white, for which only the picture's size,
        camera and moment count; `limner.drawing` has their styles and vectors.
    samples : int, optional
        Points of every pixel that are looked at; None: 8, or 64 paths.
    seed : int
        For what is drawn by lot; the same seed, the same picture.
    camera : Camera, optional
        In place of the scene's own.
    max_depth : int >= 0
        How often a ray is reflected and refracted (`ray`) or light scattered (`path`) at most.
    shadows : bool, optional
        Whether lights can be hidden (`ray`, `raster`); None: by `ray` they can, by `raster` not, which is faster.
    sampler : "regular" | "random" | "jittered" | "multijittered" | "halton" | "sobol", optional
        Where every pixel's samples look, and how all that is drawn by lot is spread over them: the lens, the time, points of lights,
        reflections (`ray`, `path`). "regular" and the jittered ones divide a pixel into as many cells as there are samples, so square
        numbers suit them. None: a pattern that all pixels share (`raster`, `ray`), and "sobol" for all else.
    glossy : bool
        Whether the rough mirrors of metallic-roughness materials are followed by rays (`ray`), so that they reflect what stands around
        them; otherwise they reflect lights and the blurred sky.
    emitters : bool
        Whether surfaces that shine light others (`ray`). In `path` they do, and area lights do in both.
    tinted_shadows : bool, optional
        Whether light goes straight through glass and water, dimmed and coloured, to what lies behind; otherwise it is stopped there, and
        `path` finds what they focus, by chance. None: in `ray`, where nothing else lights what lies behind, but not in `path`.
    shutter : (float, float), optional
        When it opens and closes: what has a motion is blurred (`ray`, `path`), and so are nodes that an animation moves; meshes that it
        bends are as they are when it opens. None: a picture of one moment.
    time : float, optional
        The moment of the scene's animation that is shown, in seconds. None: of what no animation has moved; motions are at time 0.
    animation : str | int, optional
        The animation that `time` or `shutter` is a time of, by name or number; None: the first; "all": all at once.
    antialiasing : "multisample" | "supersample"
        Whether what covers several samples of a pixel is shaded once, in the middle of them, or every sample for itself (`raster`).
        Edges are the same; supersampling is smoother where shading changes within a pixel, has the very colours of `ray`, and takes as
        many times longer to shade as there are samples.
    shading : "fragment" | "vertex" | "flat"
        Where colours are computed (`raster`): at every fragment, from interpolated normals; at the vertices, and interpolated (Gouraud);
        or once for each triangle, with its own normal.
    hidden_surfaces : "zbuffer" | "painter"
        How `raster` finds what is in front: by a depth for every sample, or by drawing from back to front, in the order of a tree of
        planes that splits what overlaps in a cycle (up to 10,000 triangles; beyond, by their centroids, which a message says).
    clipping : "homogeneous" | "world"
        Whether `raster` clips after the projection, or before it against the planes of the viewing pyramid.
    culling : "material" | "back" | "front" | "none"
        Which triangles `raster` leaves out: the backs of one-sided materials; all backs; all fronts, to look inside; or none.
    filter : "box" | "tent" | "gaussian" | "mitchell" | "lanczos3"
        How the samples around a pixel are weighed (`raster`): alike, within the pixel; or by a wider filter, which wants more samples.
        See `limner.image.reconstruct`.
    threads : int, optional
        None: all cores. The picture does not depend on it, nor on `tile_size`.
    aovs : iterable of str
        What to keep beside the picture, of `AOVS`: from one ray or sample through the centre of each pixel; what is told to denoisers,
        as means over the pixel, and variance and samples of its light (`ray`, `path`); "direct" (light that was scattered at most once)
        and "indirect" (the rest), and "light_groups", a channel ``light_NAME`` for each light, shining material, and the sky (`path`; each
        costs its tracing again).
    denoise : "filter" | "oidn", optional
        How noise is taken out of the finished picture (`ray`, `path`): by our own filter, or by Intel's Open Image Denoise (extra
        ``denoise``); see `limner.image.denoise`. None: not at all.
    default_lights : bool
        Whether a scene without any light gets some.
    noise : float, optional
        Go on in every part of the picture until the error that is left is this share of its brightness, 0.02 for example (`path`);
        `samples` are then the most, 4096 where they are not given. See `limner.budget`.
    time_limit : float, optional
        Stop after so many seconds (`path`). How many samples were taken by then is `image.recipe["samples"]`, and so many of them make the
        same picture again; `samples` are the most, 65536 where they are not given.
    checkpoint : path, optional
        A file in which the sums are kept every `checkpoint_seconds`, in case the process is killed (`path`); it goes when the picture is
        done, and stays where time was up.
    checkpoint_seconds : float
    resume : bool
        Whether to go on from the checkpoint, if it is there; the picture has the bits of one that was never stopped.
    on_snapshot : callable, optional
        Takes the picture so far every `checkpoint_seconds` (`path`).
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
    if renderer == "lines":
        return _lines(scene, width, height, camera, _checked_moment(None, time, animation), on_progress, cancel)
    with Renderer(
        scene, width=width, height=height, renderer=renderer, samples=samples, seed=seed, max_depth=max_depth, shadows=shadows,
        sampler=sampler, glossy=glossy, emitters=emitters, tinted_shadows=tinted_shadows, shutter=shutter,
        time=time, animation=animation, antialiasing=antialiasing, shading=shading, hidden_surfaces=hidden_surfaces, clipping=clipping,
        culling=culling, filter=filter, threads=threads, tile_size=tile_size, aovs=aovs, denoise=denoise,
        default_lights=default_lights,
        noise=noise, time_limit=time_limit, checkpoint=checkpoint, checkpoint_seconds=checkpoint_seconds, resume=resume,
        on_snapshot=on_snapshot,
    ) as once:  # fmt: skip
        image = once.render(camera, on_progress=on_progress, cancel=cancel)
    for slip in once.slips:
        python_warnings.warn(slip, LimnerWarning, stacklevel=2)
    return image


def _lines(
    scene: Any, width: int, height: int, camera: Camera | None, moment: tuple[float | None, str | int | None] | None,
    on_progress: OnProgress | None, cancel: threading.Event | None,
) -> Image:  # fmt: skip
    """The picture of a drawing."""
    from .artistic.picture import line_picture

    _check(width, height, "raster", None, 0, 0, None)
    shown = _as_scene(scene)
    if moment is not None:
        shown = at(shown, moment[0] or 0.0, moment[1])
    return line_picture(shown, camera, width=int(width), height=int(height), on_progress=on_progress, cancel=cancel)


class Frame(NamedTuple):
    """A picture that is being made."""

    scene: Scene
    camera: Camera
    built: Built
    view: View
    film: Film
    memory: Memory
    work: Work
    messages: tuple[str, ...]
    stage: driver.Stage | None
    moments: Moments | None


class Renderer:
    """Makes many pictures of one scene; meshes, textures and the tree over them are kept while they stay the same.

    Parameters
    ----------
    scene, width, height, renderer, samples, seed, max_depth, shadows, sampler, glossy, emitters, tinted_shadows, shutter, time, animation,
    antialiasing, shading, hidden_surfaces, clipping, culling, filter, threads, tile_size, aovs, denoise, default_lights, noise, time_limit,
    checkpoint, checkpoint_seconds, resume, on_snapshot
        As in `render`; `refine` takes no notice of the last six.

    Every picture is the one that `render` would make, to the bit. A Renderer belongs to one thread at a time; several may work side by
    side. It can be pickled; what it keeps stays behind.

    Attributes
    ----------
    scene : Scene
        Assign another, such as ``renderer.scene.replace(...)``, to go on with it.
    slips : tuple of str
        What was wrong with the last picture.
    """

    def __init__(
        self,
        scene: Any,
        *,
        width: int = 800,
        height: int = 600,
        renderer: str = "raster",
        samples: int | None = None,
        seed: int = 0,
        max_depth: int = 8,
        shadows: bool | None = None,
        sampler: str | None = None,
        glossy: bool = False,
        emitters: bool = False,
        tinted_shadows: bool | None = None,
        shutter: tuple[float, float] | None = None,
        time: float | None = None,
        animation: str | int | None = None,
        antialiasing: str = "multisample",
        shading: str = "fragment",
        hidden_surfaces: str = "zbuffer",
        clipping: str = "homogeneous",
        culling: str = "material",
        filter: str = "box",
        threads: int | None = None,
        tile_size: int | None = None,
        aovs: Iterable[str] = (),
        denoise: str | None = None,
        default_lights: bool = True,
        noise: float | None = None,
        time_limit: float | None = None,
        checkpoint: str | os.PathLike[str] | None = None,
        checkpoint_seconds: float = 60.0,
        resume: bool = False,
        on_snapshot: Callable[[Image], object] | None = None,
    ) -> None:
        _check(width, height, renderer, samples, seed, max_depth, tile_size)
        self._width, self._height, self._renderer = int(width), int(height), renderer
        self._budget = _checked_budget(renderer, sampler, noise, time_limit, checkpoint, checkpoint_seconds, resume, on_snapshot)
        self._on_snapshot = on_snapshot
        most = _MOST_SAMPLES["noise" if noise is not None else "time"] if self._is_open else _DEFAULT_SAMPLES[renderer]
        self._samples = most if samples is None else int(samples)
        self._seed, self._max_depth, self._shadows = int(seed), int(max_depth), renderer != "raster" if shadows is None else bool(shadows)
        if antialiasing not in ("supersample", "multisample"):
            raise UnsupportedError(f'antialiasing must be "supersample" or "multisample", got {antialiasing!r}')
        self._multisample = _SAMPLES_AT_ONCE["raster"] if antialiasing == "multisample" and renderer == "raster" else 0
        if shading not in _FREQUENCIES:
            raise UnsupportedError(f"shading must be one of {', '.join(_FREQUENCIES)}, got {shading!r}")
        if hidden_surfaces not in ("zbuffer", "painter"):
            raise UnsupportedError(f'hidden_surfaces must be "zbuffer" or "painter", got {hidden_surfaces!r}')
        if clipping not in ("homogeneous", "world"):
            raise UnsupportedError(f'clipping must be "homogeneous" or "world", got {clipping!r}')
        self._sampler, self._shutter = _checked_sampler(sampler, renderer), _checked_shutter(shutter, renderer, time)
        self._moment = _checked_moment(shutter, time, animation)
        self._glossy, self._emitters = bool(glossy), bool(emitters)
        self._tinted_shadows = renderer == "ray" if tinted_shadows is None else bool(tinted_shadows)
        if culling not in CULLINGS:
            raise UnsupportedError(f"culling must be one of {', '.join(CULLINGS)}, got {culling!r}")
        if filter not in FILTERS:
            raise UnsupportedError(f"filter must be one of {', '.join(FILTERS)}, got {filter!r}")
        if filter != "box" and renderer != "raster":
            raise UnsupportedError(f'the {renderer} renderer has the filter "box" only, got {filter!r}; renderer="raster" has all')
        self._shading, self._hidden_surfaces, self._clipping = shading, hidden_surfaces, clipping
        self._culling, self._filter = culling, filter
        self._threads = thread_count(threads)
        self._tile_size = _TILE_SIZE[renderer] if tile_size is None else int(tile_size)
        if noise is not None:
            self._tile_size = BLOCK  # what is decided block by block must not depend on tiles
        self._aovs, self._denoise = _wanted_aovs(aovs), _checked_denoiser(denoise, renderer)
        _check_beside(self._aovs, renderer, self._samples)
        self._default_lights = bool(default_lights)
        self.slips: tuple[str, ...] = ()
        self.scene = _as_scene(scene)
        self.close()

    def close(self) -> None:
        """Let go of what is kept."""
        self._built: Built | None = None
        self._spare: tuple[Film, Memory] | None = None
        self._tree: tuple[Built, Accelerator] | None = None
        self._stopped: tuple[Scene, Scene] | None = None
        self._sky: tuple[Environment | None, NDArray[np.float32] | None, NDArray[np.float32] | None] = (None, None, None)

    def show(
        self, *, time: float | None = None, shutter: tuple[float, float] | None = None, animation: str | int | None = None
    ) -> None:
        """Go on with another moment of the scene; the parameters are those of `render`."""
        self._shutter = _checked_shutter(shutter, self._renderer, time)
        self._moment = _checked_moment(shutter, time, animation)
        self._stopped = None

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_built": None, "_spare": None, "_tree": None, "_stopped": None, "_sky": (None, None, None)}

    @overload
    def render(
        self,
        camera: Camera | None = None,
        *,
        output: Literal["image"] = "image",
        on_progress: OnProgress | None = None,
        cancel: threading.Event | None = None,
    ) -> Image: ...

    @overload
    def render(
        self,
        camera: Camera | None = None,
        *,
        output: Literal["uint8"],
        view: str = "standard",
        exposure: float = 0.0,
        on_progress: OnProgress | None = None,
        cancel: threading.Event | None = None,
    ) -> NDArray[np.uint8]: ...

    def render(
        self,
        camera: Camera | None = None,
        *,
        output: str = "image",
        view: str = "standard",
        exposure: float = 0.0,
        on_progress: OnProgress | None = None,
        cancel: threading.Event | None = None,
    ) -> Image | NDArray[np.uint8]:
        """Make a picture.

        Parameters
        ----------
        camera : Camera, optional
            In place of the scene's own.
        output : "image" | "uint8"
            An Image, or (height, width, 4) uint8 as a screen wants it.
        view, exposure
            As for `Image.to_uint8`; an Image takes them when it is saved.
        on_progress, cancel
            As in `limner.render`.
        """
        if output not in ("image", "uint8"):
            raise UnsupportedError(f'output must be "image" or "uint8", got {output!r}')
        at_once = _SAMPLES_AT_ONCE[self._renderer]
        ends = [*range(at_once, self._samples, at_once), self._samples]
        is_standard = checked_view(view) == "standard" and checked_exposure(exposure) == 0.0
        if output == "image" and not is_standard:
            raise UnsupportedError('an Image holds light as it is: give view and exposure to its save, or ask for output="uint8"')
        encode = output == "uint8" and self._denoise is None and is_standard
        if self._budget is not None:
            made = self._within_budget(self._budget, camera, on_progress, cancel, encode=encode)
            return made.to_uint8(view, exposure) if output == "uint8" and isinstance(made, Image) else made
        with contextlib.closing(self._pictures(camera, ends, on_progress, cancel, every=False, encode=encode)) as pictures:
            made = next(pictures)
        return made.to_uint8(view, exposure) if output == "uint8" and not encode else made

    @property
    def _is_open(self) -> bool:
        """Whether something else than the number of samples ends a picture."""
        return self._budget is not None and (self._budget.noise is not None or self._budget.seconds is not None)

    def _within_budget(
        self, budget: Budget, camera: Camera | None, on_progress: OnProgress | None, cancel: threading.Event | None, *, encode: bool
    ) -> Image | NDArray[np.uint8]:
        """Expose a film until the budget is spent."""
        _check_listeners(on_progress, cancel)
        meter = Meter(on_progress, "render")
        meter.report(0.0)
        self._spare = None  # a film is gone on with here, not begun
        frame = self._prepared(camera)
        film = frame.film
        spending, finished = Spending(film, frame.work, self._samples, budget, self._key_of(frame)), True

        def snapshot() -> None:
            assert self._on_snapshot is not None
            self._on_snapshot(self._image(frame, film.developed(self._threads)[0], {}, finished=False))

        try:
            on_kept = None if self._on_snapshot is None else snapshot
            if frame.moments is not None:
                frame.moments.begin()  # after what a checkpoint has restored
            spending.passes(self._step(frame), self._threads, meter.report, cancel, on_kept)
            extra = {} if encode else self._channels(frame)
        except (Cancelled, KeyboardInterrupt):
            finished, extra = False, {}
        if encode:
            encoded, self.slips = film.encoded(self._threads)
            return encoded
        pixels, self.slips = film.developed(self._threads)
        # Where noise decides, many were allowed, and only time can have made them fewer.
        image = self._image(frame, pixels, extra, finished=finished, samples=self._reached(spending, finished))
        return self._cleaned(image) if finished and self._denoise is not None else image

    def _reached(self, spending: Spending, finished: bool) -> int | None:
        """How many samples have to be asked for to make the same picture again, if any number does."""
        return (spending.reached if spending.is_out_of_time else self._samples) if finished else None

    def _key_of(self, frame: Frame) -> str:
        """Of which picture a checkpoint is; how many samples it will have at last is not told by the samplers that do not care."""
        if self._budget is None or self._budget.checkpoint is None:
            return ""
        told = dict(self._recipe(frame, 0, finished=True))
        samples = 0 if self._sampler in (None, "sobol", "random") else self._samples
        return json.dumps({**told, "samples": samples, "tile_size": self._tile_size}, sort_keys=True)

    def refine(
        self, camera: Camera | None = None, *, on_progress: OnProgress | None = None, cancel: threading.Event | None = None
    ) -> Iterator[Image]:
        """Yield better and better pictures: of 1 sample, 2, 4, and so on (multisamples: of 8, 16, …); the last is what `render` returns.

        Leave the loop whenever a picture is good enough.
        """
        # Multisamples come in whole groups, or the last picture would not be the one that `render` makes.
        least = max(1, self._multisample)
        ends = [1 << k for k in range(self._samples.bit_length()) if least <= 1 << k < self._samples]
        return self._pictures(camera, [*ends, self._samples], on_progress, cancel, every=True, encode=False)

    @property
    def samples(self) -> int:
        """How many points of every pixel are looked at."""
        return self._samples

    def prepared(self, camera: Camera | None = None) -> Frame:
        """A picture that is ready to be exposed: for those who ask what becomes of one pixel (`limner.explain`)."""
        return self._prepared(camera)

    def _pictures(
        self,
        camera: Camera | None,
        ends: list[int],
        on_progress: OnProgress | None,
        cancel: threading.Event | None,
        *,
        every: bool,
        encode: bool,
    ) -> Generator[Any, None, None]:
        """Expose a film up to each of `ends` samples; yield the picture after each, or after the last."""
        _check_listeners(on_progress, cancel)
        meter = Meter(on_progress, "render")
        meter.report(0.0)
        try:
            frame = self._prepared(camera)
        except MemoryError:
            raise RenderError(f"there is not enough memory for a picture of {self._width} x {self._height}") from None
        film = frame.film
        first = 0
        for last in ends:
            is_wanted = every or last == ends[-1]
            pixels, develop, bad = film.encoding() if encode else film.developing()
            try:
                self._expose(frame, first, last, meter, cancel, develop if is_wanted else None)
                extra = self._channels(frame) if last == ends[-1] and not encode else {}
            except (Cancelled, KeyboardInterrupt):
                pixels, self.slips = film.encoded(self._threads) if encode else film.developed(self._threads)
                yield pixels if encode else self._image(frame, pixels, {}, finished=False)
                return
            if is_wanted:
                self.slips = film.slips(bad)
                picture = pixels if encode else self._image(frame, pixels, extra, finished=True)
                if last == ends[-1]:
                    if isinstance(picture, Image) and self._denoise is not None:
                        picture = self._cleaned(picture)
                    self._spare = film, frame.memory
                yield picture
            first = last

    def _expose(
        self,
        frame: Frame,
        first: int,
        last: int,
        meter: Meter,
        cancel: threading.Event | None,
        develop: Callable[[Tile], None] | None,
    ) -> None:
        """Add samples first..last to every tile, a few at a time, so that a stop is soon heard; then develop it, while it is at hand."""
        step = self._step(frame)
        for start in range(first, last, step):
            end = min(start + step, last)

            def expose(tile: Tile, start: int = start, end: int = end) -> None:
                frame.film.expose(tile, frame.work, start, end)
                if develop is not None and end == last:
                    develop(tile)

            def report(part: float, start: int = start, end: int = end) -> None:
                meter.report((start + part * (end - start)) / self._samples)

            run_all(expose, frame.film.tiles, self._threads, report, cancel)

    def _step(self, frame: Frame) -> int:
        """Samples of a pass: few enough for a stop to be soon heard, and for what a variance is made of."""
        step = _SAMPLES_AT_ONCE[self._renderer]
        return step if frame.moments is None else max(1, min(step, self._samples // _LEAST_PASSES))

    def _prepared(self, camera: Camera | None) -> Frame:
        if camera is not None and not isinstance(camera, Camera):
            raise SceneError(f"camera must be a PerspectiveCamera or an OrthographicCamera, got {type(camera).__name__}")
        given = self._scene_of_the_moment()
        given = given if camera is None else given.replace(camera=camera)
        scene, messages = with_defaults(given, self._width / self._height, lights=self._default_lights)
        assert scene.camera is not None
        is_raster, opening = self._renderer == "raster", self._shutter[0]
        messages = (*messages, *lights_in_solids(scene))
        scene = with_lamps(scene, opening)
        assert scene.camera is not None
        built = flatten(scene, scene.camera, self._width, self._height, self._built, tessellate=is_raster, time=opening)
        self._built = built
        messages = (*messages, *built.notes)
        seen = view(scene, built.tables, scene.camera, self._width, self._height, opening)
        (film, memory), self._spare = self._spare or (Film(self._width, self._height, self._tile_size), Memory()), None
        moved = None if is_raster else instants(scene, built.tables, scene.camera, self._width, self._height, self._shutter)
        light, background = self._lighting(scene, built, None if moved is None else moved.moving), _background(scene)
        notes: list[str] = []
        work: Work
        stage: driver.Stage | None = None
        if moved is None:
            notes.extend(_left_out(scene))
            places, weights = filtered_samples(self._samples, self._filter)
            shadows = pipeline.Shadows(self._tree_of(built), media_table(scene), self._tinted_shadows) if self._shadows else None
            work = pipeline.prepare(
                built.tables, light, seen, places, background, film.sums, sample_weights=weights, culling=self._culling,
                threads=self._threads, tile_size=self._tile_size, multisample=self._multisample, frequency=_FREQUENCIES[self._shading],
                hidden_surfaces=self._hidden_surfaces, clipping=self._clipping, on_note=notes.append, shadows=shadows, memory=memory,
            )  # fmt: skip
        else:
            stage = driver.Stage(built.tables, self._accelerator(built, moved), light, seen, media_table(scene), moved, background)
            prepare = driver.prepare if self._renderer == "ray" else driver.prepare_paths
            work = prepare(stage, self._settings(), film.sums)
        moments = Moments(film.sums, len(film.tiles)) if "variance" in self._beside() else None
        film.on_exposed = None if moments is None else moments.add
        return Frame(scene, scene.camera, built, seen, film, memory, work, (*messages, *notes), stage, moments)

    def _beside(self) -> tuple[str, ...]:
        """The channels that are asked for, and those that a denoiser needs."""
        needed = GUIDES if self._denoise is not None else ()
        return (*self._aovs, *(name for name in needed if name not in self._aovs and (name != "variance" or self._samples > 1)))

    def _cleaned(self, image: Image) -> Image:
        """The picture without noise, and without what was beside it for that alone."""
        assert self._denoise is not None
        made = denoised(image, self._denoise, threads=self._threads)
        return replace(made, aov={name: values for name, values in made.aov.items() if name in self._aovs or name.startswith("light_")})

    def _scene_of_the_moment(self) -> Scene:
        """The scene with its animation at the time of the picture, and its meshes bent; the same object while nothing changes."""
        if self._stopped is None or self._stopped[0] is not self.scene:
            opening = self._shutter[0]
            scene = self.scene
            if self._moment is not None:
                time, animation = self._moment
                scene = at(scene, time, animation) if time is not None else animated(scene, animation, opening)
            self._stopped = self.scene, posed(scene, opening)
        return self._stopped[1]

    def _settings(self) -> driver.Settings:
        shares_pattern = self._sampler is None and self._renderer == "ray"
        return driver.Settings(
            self._samples, pixel_samples(self._samples) if shares_pattern else None,
            SOBOL if self._sampler is None else SAMPLERS[self._sampler], self._seed, self._max_depth, self._shadows, self._tinted_shadows,
            self._glossy, self._emitters,
        )  # fmt: skip

    def _accelerator(self, built: Built, moved: Instants) -> Accelerator:
        """The tree over the scene; the last one while nothing in it has moved."""
        return bvh.build(built.tables, instants=moved) if len(moved.moving) else self._tree_of(built)

    def _tree_of(self, built: Built) -> Accelerator:
        if self._tree is None or not _same_primitives(self._tree[0], built):
            self._tree = built, bvh.build(built.tables)
        return self._tree[1]

    def _lighting(self, scene: Scene, built: Built, moving: NDArray[np.int32] | None) -> Lighting:
        environment = scene.environment
        if environment is None:
            return lighting(built.tables, None, moving=moving)
        if self._sky[0] is not environment:
            pixels = _sky_pixels(environment)
            # A path tracer asks the sky itself.
            blurred = None if self._renderer == "path" else blurred_sky(pixels, self._threads)
            self._sky = environment, pixels, blurred
        visible = scene.background == "environment"
        return lighting(built.tables, self._sky[1], environment.intensity, environment.rotation_degrees, visible, self._sky[2], moving)

    def _channels(self, frame: Frame) -> dict[str, NDArray[Any]]:
        beside = self._beside()
        return {
            **self._centre_channels(frame), **self._features(frame, beside), **self._light_channels(frame, beside), **self._passes(frame)
        }  # fmt: skip

    def _passes(self, frame: Frame) -> dict[str, NDArray[Any]]:
        """The picture's light in parts, as straight colour."""
        made: dict[str, NDArray[Any]] = {}
        wanted, stage = set(self._aovs) & set(PASSES), frame.stage
        if not wanted or stage is None:
            return made
        settings = self._settings()
        if wanted & {"direct", "indirect"}:
            whole, _ = frame.film.developed(self._threads)
            direct = self._part(frame.film, stage, settings._replace(max_depth=min(settings.max_depth, 1)))
            made |= {"direct": direct, "indirect": whole[..., :3] - direct}
        if "light_groups" in wanted:
            for name in group_names(stage, frame.scene):
                made[f"light_{name}"] = self._part(frame.film, lit_by(stage, frame.scene, name), settings)
        return {name: values for name, values in made.items() if name in wanted or name.startswith("light_")}

    def _part(self, whole: Film, stage: driver.Stage, settings: driver.Settings) -> NDArray[np.float32]:
        """(height, width, 3) float32: the picture of a stage by the samples that the whole picture has taken."""
        film = Film(self._width, self._height, self._tile_size)
        work = driver.prepare_paths(stage, settings, film.sums)
        run_all(lambda tile: film.expose(tile, work, 0, int(whole.taken[tile.number])), film.tiles, self._threads)
        return np.ascontiguousarray(film.developed(self._threads)[0][..., :3])

    def _features(self, frame: Frame, beside: tuple[str, ...]) -> dict[str, NDArray[Any]]:
        """What denoisers are told."""
        if frame.stage is None or not set(FEATURES) & set(beside):
            return {}
        values = np.zeros((self._height, self._width, 7), dtype=np.float32)
        places = pixel_samples(min(self._samples, _FEATURE_SAMPLES))
        driver.draw_features(frame.stage, values, places, self._seed, threads=self._threads, tile_size=self._tile_size)
        return {name: channel for name, channel in features_of(values).items() if name in beside}

    def _light_channels(self, frame: Frame, beside: tuple[str, ...]) -> dict[str, NDArray[Any]]:
        """How sure the picture is of itself."""
        made: dict[str, NDArray[Any]] = {}
        if frame.moments is not None:
            made["variance"] = frame.moments.variance(frame.film.taken)
        if "samples" in beside:
            made["samples"] = samples_of(frame.film.tiles, frame.film.taken)
        return made

    def _centre_channels(self, frame: Frame) -> dict[str, NDArray[Any]]:
        if not set(self._aovs) & set(CHANNELS):
            return {}
        values, ids = empty_values(self._width, self._height)
        tables = with_solid_blends(frame.built.tables)
        if self._renderer == "raster":
            pipeline.draw_channels(
                tables, frame.view, values, ids, threads=self._threads, tile_size=self._tile_size,
                hidden_surfaces=self._hidden_surfaces, clipping=self._clipping, culling=self._culling,
            )  # fmt: skip
        else:
            driver.draw_channels(tables, frame.view, values, ids, threads=self._threads, tile_size=self._tile_size)
        return channels(self._aovs, values, ids)

    def _image(
        self, frame: Frame, pixels: NDArray[Any], extra: dict[str, NDArray[Any]], *, finished: bool, samples: int | None = None
    ) -> Image:
        id_names = {name: ids for name, ids in names(frame.scene).items() if name in extra}
        recipe = self._recipe(frame, int(frame.film.taken.min()) if samples is None else samples, finished=finished)
        blank = finished and bool(frame.scene.shapes()) and not pixels[..., 3].any()
        messages = (*frame.messages, *self.slips, *((_BLANK,) if blank else ()))
        return Image(pixels, extra, id_names, recipe, messages, finished)

    def _recipe(self, frame: Frame, samples: int, *, finished: bool) -> Recipe:
        from . import __version__

        values: dict[str, Any] = {
            "limner": __version__,
            "renderer": self._renderer,
            "width": self._width,
            "height": self._height,
            "samples": samples,
            "seed": self._seed,
            "max_depth": self._max_depth,
            "shadows": self._shadows,
            "sampler": self._sampler,
            "glossy": self._glossy,
            "emitters": self._emitters,
            "tinted_shadows": self._tinted_shadows,
            "shutter": list(self._shutter),
            "time": None if self._moment is None else self._moment[0],
            "animation": None if self._moment is None else self._moment[1],
            "antialiasing": "multisample" if self._multisample else "supersample",
            "shading": self._shading,
            "hidden_surfaces": self._hidden_surfaces,
            "clipping": self._clipping,
            "culling": self._culling,
            "filter": self._filter,
            "denoise": self._denoise,
            "default_lights": self._default_lights,
            "camera": _plain(frame.camera),
        }
        if self._budget is not None and self._budget.noise is not None:
            values["noise"] = self._budget.noise
        if not finished:
            values["finished"] = False
        scene = frame.scene
        return Recipe(values, {"scene": lambda: _digest(scene)})


def _digest(scene: Scene) -> str:
    """What a recipe says about the scene; the camera stands beside it."""
    from .scene.digest import scene_digest

    return scene_digest(scene.replace(camera=None))


def _check(width: int, height: int, renderer: str, samples: int | None, seed: int, max_depth: int, tile_size: int | None) -> None:
    for name, value in (("width", width), ("height", height)):
        if not is_whole(value) or not 1 <= value <= MAX_SIDE:
            raise SceneError(f"{name} must be an integer from 1 to {MAX_SIDE}, got {value!r}")
    if width * height > MAX_PIXELS:
        raise SceneError(f"a picture must not have more than {MAX_PIXELS} pixels, got {width} x {height}")
    if renderer not in RENDERERS:
        raise UnsupportedError(f"renderer must be one of {', '.join(RENDERERS)} (or lines, in limner.render), got {renderer!r}")
    if samples is not None and (not is_whole(samples) or not 1 <= samples <= MAX_SAMPLES):
        raise SceneError(f"samples must be an integer from 1 to {MAX_SAMPLES}, got {samples!r}")
    if not is_whole(seed) or not 0 <= seed < 1 << 63:
        raise SceneError(f"seed must be an integer from 0 to 2^63 - 1, got {seed!r}")
    if not is_whole(max_depth) or not 0 <= max_depth <= 1000:
        raise SceneError(f"max_depth must be an integer from 0 to 1000, got {max_depth!r}")
    if tile_size is not None and (not is_whole(tile_size) or not 8 <= tile_size <= 1024):
        raise SceneError(f"tile_size must be an integer from 8 to 1024, got {tile_size!r}")


def _check_listeners(on_progress: OnProgress | None, cancel: threading.Event | None) -> None:
    if on_progress is not None and not callable(on_progress):
        raise SceneError(f"on_progress must be a function of a Progress, got {type(on_progress).__name__}")
    if cancel is not None and not callable(getattr(cancel, "is_set", None)):
        raise SceneError(f"cancel must be a threading.Event, got {type(cancel).__name__}")


def _checked_budget(
    renderer: str, sampler: str | None, noise: float | None, time_limit: float | None, checkpoint: str | os.PathLike[str] | None,
    checkpoint_seconds: float, resume: bool, on_snapshot: object,
) -> Budget | None:  # fmt: skip
    """What ends a picture beside its number of samples; None: nothing."""
    if noise is None and time_limit is None and checkpoint is None and on_snapshot is None:
        if resume:
            raise SceneError("resume needs the checkpoint to go on from")
        return None
    if renderer != "path":
        raise UnsupportedError(f'noise, time_limit, checkpoint and on_snapshot are for renderer="path", got {renderer!r}')
    for name, value in (("noise", noise), ("time_limit", time_limit), ("checkpoint_seconds", checkpoint_seconds)):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if value is not None and not (is_number and math.isfinite(value) and value > 0):
            raise SceneError(f"{name} must be a positive number, got {value!r}")
    if (noise is not None or time_limit is not None) and sampler not in (None, "sobol", "random"):
        raise UnsupportedError(f'the sampler {sampler!r} must know the number of samples beforehand; "sobol" need not')
    if checkpoint is not None and not isinstance(checkpoint, (str, os.PathLike)):
        raise SceneError(f"checkpoint must be a path, got {checkpoint!r}")
    if on_snapshot is not None and not callable(on_snapshot):
        raise SceneError(f"on_snapshot must be a function of an Image, got {type(on_snapshot).__name__}")
    return Budget(noise, time_limit, checkpoint, float(checkpoint_seconds), bool(resume))


def _checked_sampler(sampler: str | None, renderer: str) -> str | None:
    if sampler is None:
        return None
    if sampler not in SAMPLERS:
        raise UnsupportedError(f"sampler must be one of {', '.join(SAMPLERS)}, got {sampler!r}")
    if renderer == "raster":
        raise UnsupportedError(f"raster has one pattern of samples for all pixels; ray and path can have the sampler {sampler!r}")
    return sampler


def _checked_moment(
    shutter: tuple[float, float] | None, time: float | None, animation: str | int | None
) -> tuple[float | None, str | int | None] | None:
    """The time and the animation to show, no time where it is the shutter's; None where no animation is asked for."""
    if time is not None:
        if shutter is not None:
            raise UnsupportedError("a picture is of one time, or of a shutter's; give time or shutter, not both")
        try:
            number = float(time)
        except (TypeError, ValueError):
            raise SceneError(f"time must be a number of seconds, got {time!r}") from None
        if not math.isfinite(number):
            raise SceneError(f"time must be finite, got {number}")
        return number, animation
    if shutter is not None:
        return None, animation
    return None if animation is None else (0.0, animation)


def _checked_shutter(shutter: tuple[float, float] | None, renderer: str, time: float | None) -> tuple[float, float]:
    if shutter is None or time is not None:
        return 0.0, 0.0
    try:
        opens, closes = (float(time) for time in shutter)
    except (TypeError, ValueError):
        raise SceneError(f"shutter must be two times, as in (0.0, 1.0), got {shutter!r}") from None
    if not (math.isfinite(opens) and math.isfinite(closes) and opens <= closes):
        raise SceneError(f"the shutter must not close before it opens, got {opens} and {closes}")
    if opens < closes and renderer == "raster":
        raise UnsupportedError("raster sees one time only; ray and path can leave the shutter open")
    return opens, closes


def _lets_light_through(material: Material) -> bool:
    transmission = getattr(material, "transmission", None)
    return isinstance(material, Dielectric) or (transmission is not None and transmission.factor > 0.0)


def _left_out(scene: Scene) -> list[str]:
    """What the rasteriser does not show of a scene, a sentence each."""
    said = []
    if any(_lets_light_through(material) for _, shape in scene.shapes() for material in shape.materials):
        said.append("raster cannot bend light: glass is drawn as a veil; ray and path follow light through it")
    if scene.fog is not None:
        said.append("raster has no fog; ray and path have")
    if getattr(scene.camera, "aperture_radius", None):
        said.append("raster sees through a pinhole; ray and path through the camera's lens")
    return said


def _plain(value: Any) -> Any:
    """A camera or what it holds as plain values, as a recipe can keep them."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return {key: _plain(held) for key, held in vars(value).items()} if hasattr(value, "__dict__") else value


def _wanted_aovs(aovs: Iterable[str]) -> tuple[str, ...]:
    if isinstance(aovs, str) or not isinstance(aovs, Iterable):
        raise UnsupportedError(f'aovs must be names, as in ("depth", "normal"), got {aovs!r}')
    wanted = tuple(dict.fromkeys(aovs))
    for name in wanted:
        if name not in AOVS:
            raise UnsupportedError(f"aov must be one of {', '.join(AOVS)}, got {name!r}")
    return wanted


def _checked_denoiser(denoise: str | None, renderer: str) -> str | None:
    if denoise is None:
        return None
    if renderer == "raster":
        raise UnsupportedError("raster makes no noise to take out; ray and path can have denoise")
    return checked_denoiser(denoise)


def _check_beside(aovs: tuple[str, ...], renderer: str, samples: int) -> None:
    """Refuse channels that a renderer does not have."""
    beyond = [name for name in aovs if name in FEATURES or name in LIGHT]
    if beyond and renderer == "raster":
        raise UnsupportedError(f"raster has no channel {beyond[0]}; ray and path have")
    parts = [name for name in aovs if name in PASSES]
    if parts and renderer != "path":
        raise UnsupportedError(f"{renderer} has no channel {parts[0]}; path has")
    if "variance" in beyond and samples < 2:
        raise SceneError(f"the channel variance needs 2 samples or more, got {samples}")


def _as_scene(thing: Any) -> Scene:
    if isinstance(thing, Scene):
        return thing
    from .files.interop import as_scene

    return as_scene(thing)


def _background(scene: Scene) -> NDArray[np.float32]:
    if scene.background is None or isinstance(scene.background, str):
        return np.zeros(4, dtype=np.float32)
    return np.array([*scene.background, 1.0], dtype=np.float32)


def _sky_pixels(environment: Environment) -> NDArray[np.float32]:
    """(height, width, 3) float32 radiance of an environment, read if it is a file."""
    source = environment.source
    if isinstance(source, str):
        from .files.radiance import read_radiance

        return read_radiance(source)
    if isinstance(source, tuple):
        return np.broadcast_to(np.array(source, dtype=np.float32), (16, 32, 3))
    return np.asarray(source, dtype=np.float32)


def _same_primitives(before: Built, now: Built) -> bool:
    """Whether a tree over one scene serves the other: the same meshes in the same places, their sides and alphas alike."""
    a, b = before.tables, now.tables
    if len(before.meshes) != len(now.meshes) or any(x is not y for x, y in zip(before.meshes, now.meshes, strict=True)):
        return False
    same_places = a.instances.tobytes() == b.instances.tobytes()
    fields = ["double_sided", "alpha_mode"]
    return same_places and len(a.materials) == len(b.materials) and (a.materials[fields] == b.materials[fields]).all()
