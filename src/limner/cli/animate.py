"""`limner animate`: a model's animation as a clip or a folder of pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from .bar import Bar
from .clips import checked_kind, close, scene_of
from .model import model_up, numbered
from .options import (
    as_json,
    background,
    camera,
    check_size,
    clip_output,
    environment,
    ground,
    quality,
    renderer,
    samples,
    seed,
    size,
    threads,
)
from .screen import screen
from .sight import chosen_camera
from .talk import Talk
from .values import Background
from .voice import voice

__all__ = ["animate"]


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


@click.command(short_help="Play a model's animation: GIF, WebP, animated PNG, MP4 or a folder of pictures.")
@click.argument("model")
@clip_output
@click.option("--animation", metavar="NAME|INDEX|all", help="Which animation; all: all at once.  [default: the first]")
@click.option("--fps", type=float, default=24.0, show_default=True, help="Pictures a second; at most 50 in a GIF.")
@click.option("--start", type=float, metavar="S", help="Where to begin, seconds.  [default: the animation's start]")
@click.option("--end", type=float, metavar="S", help="Where to end.  [default: the animation's end]")
@click.option(
    "--shutter", type=click.FloatRange(0.0, 1.0), default=0.0, show_default=True,
    help="How much of a picture's time the shutter is open (ray, path): what moves is blurred.",
)  # fmt: skip
@camera("A camera of the model; frame: one that shows what is there at rest.")
@size(640, 480)
@renderer()
@samples()
@seed()
@environment
@ground
@background
@quality
@threads()
@as_json("Tell about the clip as JSON on standard output.")
@screen
@model_up
@voice
@click.pass_obj
def animate(talk: Talk, /, **options: Any) -> None:
    """Play the animation of MODEL.

    \b
        limner animate fox.glb -o walk.webp --animation Walk
        limner animate robot.glb -o robot.mp4 --fps 30 --renderer path --samples 64 --shutter 0.5

    `limner info` tells which animations there are. Ctrl-C leaves no half a file; in a folder, the pictures so far.
    """
    order = Order(**options)
    check_size(order.width, order.height)
    _make_animation(order, talk)


def _make_animation(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    kind = checked_kind(order)
    scene = scene_of(order, kind, talk)

    from ..produce.animate import write_animation

    with Bar(enabled=not talk.quiet) as bar:
        clip = write_animation(
            scene,
            order.output,
            animation=numbered(order.animation),
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
