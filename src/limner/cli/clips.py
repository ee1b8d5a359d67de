"""What `turntable` and `animate` share: looking before the work begins, the scene of a clip, and telling what became of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import click

from ..errors import LimnerError
from .main import INTERRUPTED
from .model import open_model
from .surroundings import surrounded
from .talk import Talk
from .values import Background

if TYPE_CHECKING:
    from ..produce.clip import Clip, ClipKind
    from ..scene.scene import Scene

__all__ = ["ClipOrder", "checked_kind", "close", "scene_of"]


class ClipOrder(Protocol):
    """What a command line says about a clip."""

    @property
    def model(self) -> str: ...
    @property
    def output(self) -> str: ...
    @property
    def fps(self) -> float: ...
    @property
    def quality(self) -> int | None: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def environment(self) -> str | None: ...
    @property
    def background(self) -> Background | None: ...
    @property
    def ground(self) -> bool: ...
    @property
    def as_json(self) -> bool: ...


def checked_kind(order: ClipOrder, n_pictures: int = 1) -> ClipKind:
    """The kind of clip that is asked for; wrong usage where it cannot be had."""
    from ..produce.clip import check_clip

    try:
        return check_clip(order.output, n_pictures=n_pictures, fps=order.fps, quality=order.quality)
    except LimnerError as error:
        raise click.UsageError(str(error)) from error


def scene_of(order: ClipOrder, kind: ClipKind, talk: Talk) -> Scene:
    """The model with the surroundings that the command line asks for."""
    scene = surrounded(open_model(order.model), order.environment, order.background, ground=order.ground)
    talk.note(scene.notes)
    if order.background == "transparent" and not kind.keeps_alpha:
        talk.warn([f"{kind.name} has no transparency: white is behind the model; .webp, .png and a folder have"])
    return scene


def close(order: ClipOrder, clip: Clip, planned: str, talk: Talk) -> None:
    """Tell what became of a clip; `planned` is how many pictures it was to have, as in " of 72"."""
    talk.warn(clip.warnings)
    if not clip.finished:
        left = f"{clip.n_pictures}{planned} pictures are in {order.output}" if clip.n_pictures else "nothing was written"
        talk.say("interrupted", left)
        talk.code = INTERRUPTED
    if order.as_json:
        import json

        told: dict[str, Any] = {
            "output": order.output,
            "frames": clip.n_pictures,
            "fps": clip.fps,
            "seconds": clip.n_pictures / clip.fps,
            "width": order.width,
            "height": order.height,
            "finished": clip.finished,
            "warnings": list(clip.warnings),
        }
        click.echo(json.dumps(told, sort_keys=True))
