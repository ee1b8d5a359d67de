"""`limner animate`: a model's animation as a clip or a folder of pictures."""

from __future__ import annotations

from dataclasses import dataclass

from .bar import Bar
from .clips import checked_kind, close, scene_of
from .talk import Talk
from .values import Background

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
    view: str
    exposure: float

    eye = target = up = yfov = None


def make_animation(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    kind = checked_kind(order)
    scene = scene_of(order, kind, talk)

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
            view=order.view,
            exposure=order.exposure,
            width=order.width,
            height=order.height,
            renderer=order.renderer,
            samples=order.samples,
            seed=order.seed,
            threads=order.threads,
            on_progress=bar,
        )
    close(order, clip, "", talk)


def chosen_animation(word: str | int | None) -> str | int | None:
    """An animation's number where the word is one, else its name."""
    return int(word) if isinstance(word, str) and word.isdecimal() else word
