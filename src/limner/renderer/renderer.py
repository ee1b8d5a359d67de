"""Many pictures of one scene.

    with limner.Renderer(scene, width=1280, height=720) as renderer:
        for camera in cameras:
            frame = renderer.render(camera)

A film is exposed a few samples at a time, so that progress is told, a stop is soon heard, and there is always a picture so far.
"""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import NDArray

from ..budget import Budget, Spending
from ..color.views import checked_exposure, checked_view
from ..errors import RenderError, SceneError, UnsupportedError
from ..image.denoise import denoised
from ..image.image import Image
from ..progress import Meter, OnProgress
from ..raster.pipeline import Drawing
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..tables.build import names
from ..tiles import Cancelled, Tile, run_all
from .account import key_of, recipe_of
from .beside import channels_beside
from .choices import chosen
from .frame import Frame
from .prepare import Kept

__all__ = ["Renderer", "as_scene", "check_listeners"]

_BLANK = "nothing of the scene is in the picture: the camera looks past it, or stands behind single-sided surfaces"


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
        self._choices = chosen(
            width=width, height=height, renderer=renderer, samples=samples, seed=seed, max_depth=max_depth, shadows=shadows,
            sampler=sampler, glossy=glossy, emitters=emitters, tinted_shadows=tinted_shadows, shutter=shutter, time=time,
            animation=animation, antialiasing=antialiasing, shading=shading, hidden_surfaces=hidden_surfaces, clipping=clipping,
            culling=culling, filter=filter, threads=threads, tile_size=tile_size, aovs=aovs, denoise=denoise,
            default_lights=default_lights, noise=noise, time_limit=time_limit, checkpoint=checkpoint,
            checkpoint_seconds=checkpoint_seconds, resume=resume, on_snapshot=on_snapshot,
        )  # fmt: skip
        self._on_snapshot = on_snapshot
        self.slips: tuple[str, ...] = ()
        self.scene = as_scene(scene)
        self.close()

    def close(self) -> None:
        """Let go of what is kept."""
        self._kept = Kept()

    def show(
        self, *, time: float | None = None, shutter: tuple[float, float] | None = None, animation: str | int | None = None
    ) -> None:
        """Go on with another moment of the scene; the parameters are those of `render`."""
        self._choices = self._choices.showing(shutter, time, animation)
        self._kept.forget_moment()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_kept": Kept()}

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
        at_once = self._choices.at_once
        ends = [*range(at_once, self._choices.samples, at_once), self._choices.samples]
        is_standard = checked_view(view) == "standard" and checked_exposure(exposure) == 0.0
        if output == "image" and not is_standard:
            raise UnsupportedError('an Image holds light as it is: give view and exposure to its save, or ask for output="uint8"')
        encode = output == "uint8" and self._choices.denoise is None and is_standard
        if self._choices.budget is not None:
            made = self._within_budget(self._choices.budget, camera, on_progress, cancel, encode=encode)
            return made.to_uint8(view, exposure) if output == "uint8" and isinstance(made, Image) else made
        with contextlib.closing(self._pictures(camera, ends, on_progress, cancel, every=False, encode=encode)) as pictures:
            made = next(pictures)
        return made.to_uint8(view, exposure) if output == "uint8" and not encode else made

    def _within_budget(
        self, budget: Budget, camera: Camera | None, on_progress: OnProgress | None, cancel: threading.Event | None, *, encode: bool
    ) -> Image | NDArray[np.uint8]:
        """Expose a film until the budget is spent."""
        check_listeners(on_progress, cancel)
        meter = Meter(on_progress, "render")
        meter.report(0.0)
        self._kept.spare = None  # a film is gone on with here, not begun
        frame = self.prepared(camera)
        film = frame.film
        spending, finished = Spending(film, frame.work, self._choices.samples, budget, key_of(self._choices, frame)), True

        def snapshot() -> None:
            assert self._on_snapshot is not None
            self._on_snapshot(self._image(frame, film.developed(self._choices.threads)[0], {}, finished=False))

        try:
            on_kept = None if self._on_snapshot is None else snapshot
            if frame.moments is not None:
                frame.moments.begin()  # after what a checkpoint has restored
            spending.passes(self._choices.step, self._choices.threads, meter.report, cancel, on_kept)
            extra = {} if encode else channels_beside(self._choices, frame)
        except (Cancelled, KeyboardInterrupt):
            finished, extra = False, {}
        if encode:
            encoded, self.slips = film.encoded(self._choices.threads)
            return encoded
        pixels, self.slips = film.developed(self._choices.threads)
        # Where noise decides, many were allowed, and only time can have made them fewer.
        image = self._image(frame, pixels, extra, finished=finished, samples=self._reached(spending, finished))
        return self._cleaned(image) if finished and self._choices.denoise is not None else image

    def _reached(self, spending: Spending, finished: bool) -> int | None:
        """How many samples have to be asked for to make the same picture again, if any number does."""
        return (spending.reached if spending.is_out_of_time else self._choices.samples) if finished else None

    def refine(
        self, camera: Camera | None = None, *, on_progress: OnProgress | None = None, cancel: threading.Event | None = None
    ) -> Iterator[Image]:
        """Yield better and better pictures: of 1 sample, 2, 4, and so on (multisamples: of 8, 16, …); the last is what `render` returns.

        Leave the loop whenever a picture is good enough.
        """
        # Multisamples come in whole groups, or the last picture would not be the one that `render` makes.
        least = max(1, self._choices.multisample)
        ends = [1 << k for k in range(self._choices.samples.bit_length()) if least <= 1 << k < self._choices.samples]
        return self._pictures(camera, [*ends, self._choices.samples], on_progress, cancel, every=True, encode=False)

    @property
    def samples(self) -> int:
        """How many points of every pixel are looked at."""
        return self._choices.samples

    def prepared(self, camera: Camera | None = None) -> Frame:
        """A picture that is ready to be exposed: for those who ask what becomes of one pixel (`limner.explain`)."""
        return self._kept.frame(self._choices, self.scene, camera)

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
        check_listeners(on_progress, cancel)
        meter = Meter(on_progress, "render")
        meter.report(0.0)
        try:
            frame = self.prepared(camera)
        except MemoryError:
            raise RenderError(f"there is not enough memory for a picture of {self._choices.width} x {self._choices.height}") from None
        film = frame.film
        if encode and len(ends) == 1 and isinstance(frame.work, Drawing) and frame.moments is None:
            encoded = self._encoded_at_once(frame, frame.work, meter, cancel)
            if encoded is not None:
                self._kept.spare = film, frame.memory
                yield encoded
                return
        first = 0
        for last in ends:
            is_wanted = every or last == ends[-1]
            pixels, develop, bad = film.encoding() if encode else film.developing()
            try:
                self._expose(frame, first, last, meter, cancel, develop if is_wanted else None)
                extra = channels_beside(self._choices, frame) if last == ends[-1] and not encode else {}
            except (Cancelled, KeyboardInterrupt):
                pixels, self.slips = film.encoded(self._choices.threads) if encode else film.developed(self._choices.threads)
                yield pixels if encode else self._image(frame, pixels, {}, finished=False)
                return
            if is_wanted:
                self.slips = film.slips(bad)
                picture = pixels if encode else self._image(frame, pixels, extra, finished=True)
                if last == ends[-1]:
                    if isinstance(picture, Image) and self._choices.denoise is not None:
                        picture = self._cleaned(picture)
                    self._kept.spare = film, frame.memory
                yield picture
            first = last

    def _encoded_at_once(
        self, frame: Frame, drawing: Drawing, meter: Meter, cancel: threading.Event | None
    ) -> NDArray[np.uint8] | None:
        """The picture without a film: each tile is bytes before the next begins. None where the film is needed to tell what is wrong."""
        pixels, bad, encoding = frame.film.encoding_at_once(self._choices.samples)
        self.slips = ()
        with contextlib.suppress(Cancelled, KeyboardInterrupt):
            draw = drawing.to_bytes(self._choices.tile_size**2, *encoding)
            run_all(draw, frame.film.tiles, self._choices.threads, meter.report, cancel)
        return None if bad.any() else pixels

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
        step = self._choices.step
        for start in range(first, last, step):
            end = min(start + step, last)

            def expose(tile: Tile, start: int = start, end: int = end) -> None:
                frame.film.expose(tile, frame.work, start, end)
                if develop is not None and end == last:
                    develop(tile)

            def report(part: float, start: int = start, end: int = end) -> None:
                meter.report((start + part * (end - start)) / self._choices.samples)

            run_all(expose, frame.film.tiles, self._choices.threads, report, cancel)

    def _cleaned(self, image: Image) -> Image:
        """The picture without noise, and without what was beside it for that alone."""
        choices = self._choices
        assert choices.denoise is not None
        made = denoised(image, choices.denoise, threads=choices.threads)
        return replace(made, aov={name: values for name, values in made.aov.items() if name in choices.aovs or name.startswith("light_")})

    def _image(
        self, frame: Frame, pixels: NDArray[Any], extra: dict[str, NDArray[Any]], *, finished: bool, samples: int | None = None
    ) -> Image:
        id_names = {name: ids for name, ids in names(frame.scene).items() if name in extra}
        recipe = recipe_of(self._choices, frame, int(frame.film.taken.min()) if samples is None else samples, finished=finished)
        blank = finished and bool(frame.scene.shapes()) and not pixels[..., 3].any()
        messages = (*frame.messages, *self.slips, *((_BLANK,) if blank else ()))
        return Image(pixels, extra, id_names, recipe, messages, finished)


def check_listeners(on_progress: OnProgress | None, cancel: threading.Event | None) -> None:
    if on_progress is not None and not callable(on_progress):
        raise SceneError(f"on_progress must be a function of a Progress, got {type(on_progress).__name__}")
    if cancel is not None and not callable(getattr(cancel, "is_set", None)):
        raise SceneError(f"cancel must be a threading.Event, got {type(cancel).__name__}")


def as_scene(thing: Any) -> Scene:
    if isinstance(thing, Scene):
        return thing
    from ..files.interop import as_scene as read

    return read(thing)
