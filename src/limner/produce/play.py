"""Many pictures of one Renderer, one after the other, and the clip that they become: what `turntable` and `animate` share."""

from __future__ import annotations

import gc
import os
import threading
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from ..image.image import Image
from ..progress import Meter, OnProgress, Progress
from ..scene.camera import Camera
from ..scene.scene import Scene
from .clip import Clip, ClipKind, write_clip

if TYPE_CHECKING:
    from ..render import Renderer

__all__ = ["before_paper", "played", "written"]

_ENCODING = 0.1  # of the work


def played(
    renderer: Renderer,
    n: int,
    prepare: Callable[[int], Camera | None],
    what: str,
    on_progress: OnProgress | None,
    cancel: threading.Event | None,
) -> Iterator[Image]:
    """Yield `n` pictures, up to the first that was stopped; `prepare` makes the renderer ready for one and says by which camera."""
    meter = Meter(on_progress, what)
    meter.report(0.0)
    with renderer:
        for index in range(n):

            def report(progress: Progress, index: int = index) -> None:
                meter.report(min((index + progress.done) / n, 1.0 - 1e-9))

            image = renderer.render(prepare(index), on_progress=report, cancel=cancel)
            yield image
            if not image.finished:
                return
            # What a picture was made with can refer to itself; the collector counts objects, not the megabytes in them.
            del image
            gc.collect(0)
    meter.report(1.0)


def before_paper(scene: Scene, kind: ClipKind, view: str, exposure: float) -> Scene:
    """The scene before white, where it has no background and the clip no transparency; a white that a view would bend is none."""
    if scene.background is None and not kind.keeps_alpha and view == "standard" and exposure == 0.0:
        return scene.replace(background=(1.0, 1.0, 1.0))
    return scene


def written(
    pictures: Callable[[OnProgress], Iterator[Image]],
    path: str | os.PathLike[str],
    what: str,
    on_progress: OnProgress | None,
    *,
    fps: float,
    quality: int | None,
    view: str,
    exposure: float,
) -> Clip:
    """Write the pictures, which tell how far they are, as a clip."""
    meter = Meter(on_progress, what)

    def rendering(progress: Progress) -> None:
        meter.report((1.0 - _ENCODING) * progress.done)

    clip = write_clip(pictures(rendering), path, fps=fps, quality=quality, view=view, exposure=exposure)
    if clip.finished:
        meter.report(1.0)
    return clip
