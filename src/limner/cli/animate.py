"""`limner animate`: a model's animation as a clip or a folder of pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from ..errors import LimnerError
from .bar import Bar
from .main import INTERRUPTED
from .model import open_model
from .talk import Talk
from .values import Background

if TYPE_CHECKING:
    from ..produce.clip import Clip

__all__ = ["Order", "make_animation"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.write_animation`."""

    model: str
    output: str
    animation: str | None
    fps: float
    start: float | None
    end: float | None
    shutter: float
    camera: str | None
    width: int
    height: int
    renderer: str
    samples: int | None
    seed: int
    environment: str | None
    ground: bool
    background: Background | None
    quality: int | None
    threads: int | None
    as_json: bool

    eye = target = up = yfov = None


def make_animation(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    from ..produce.clip import check_clip

    try:
        kind = check_clip(order.output, fps=order.fps, quality=order.quality)
    except LimnerError as error:
        raise click.UsageError(str(error)) from error
    scene = open_model(order.model)
    if order.environment is not None:
        from ..scene.environment import Environment

        scene = scene.replace(environment=Environment(order.environment))
    if order.background is not None:
        scene = scene.replace(background=None if order.background == "transparent" else order.background)
    if order.ground:
        scene = scene.with_ground()
    talk.note(scene.notes)
    if order.background == "transparent" and not kind.keeps_alpha:
        talk.warn([f"{kind.name} has no transparency: white is behind the model; .webp, .png and a folder have"])

    from ..produce.animate import write_animation
    from .render import chosen_camera

    with Bar(enabled=not talk.quiet) as bar:
        clip = write_animation(
            scene,
            order.output,
            animation=chosen_animation(order.animation),
            fps=order.fps,
            start=order.start,
            end=order.end,
            shutter=order.shutter,
            camera=chosen_camera(order, scene),
            quality=order.quality,
            width=order.width,
            height=order.height,
            renderer=order.renderer,
            samples=order.samples,
            seed=order.seed,
            threads=order.threads,
            on_progress=bar,
        )
    talk.warn(clip.warnings)
    if not clip.finished:
        left = f"{clip.n_pictures} pictures are in {order.output}" if clip.n_pictures else "nothing was written"
        talk.say("interrupted", left)
        talk.code = INTERRUPTED
    if order.as_json:
        _tell(order, clip)


def chosen_animation(word: str | int | None) -> str | int | None:
    """An animation's number where the word is one, else its name."""
    return int(word) if isinstance(word, str) and word.isdecimal() else word


def _tell(order: Order, clip: Clip) -> None:
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
