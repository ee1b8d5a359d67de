"""`limner turntable`: a model turned once round, as a clip or a folder of pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from .bar import Bar
from .clips import checked_kind, close, scene_of
from .model import model_up
from .options import (
    as_json,
    background,
    check_size,
    check_yfov,
    clip_output,
    environment,
    ground,
    orbit,
    quality,
    renderer,
    samples,
    seed,
    size,
    threads,
)
from .screen import screen
from .talk import Talk
from .values import Background
from .voice import voice

__all__ = ["turntable"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.write_turntable`."""

    model: str
    output: str
    frames: int
    fps: float
    elevation: float
    azimuth: float
    yfov: float
    width: int
    height: int
    renderer: str
    samples: int | None
    seed: int
    lights: str
    environment: str | None
    ground: bool
    background: Background | None
    quality: int | None
    threads: int | None
    as_json: bool
    view: str
    exposure: float


@click.command(short_help="Turn a model once round: GIF, WebP, animated PNG, MP4 or a folder of pictures.")
@click.argument("model")
@clip_output
@click.option("--frames", type=click.IntRange(1, 100_000), default=72, show_default=True, help="Pictures in a full turn.")
@click.option("--fps", type=float, default=20.0, show_default=True, help="Pictures a second; at most 50 in a GIF.")
@orbit(30.0, "picture", 30.0)
@size(640, 480)
@renderer()
@samples()
@seed()
@click.option(
    "--lights", type=click.Choice(["auto", "camera", "world"]), default="auto", show_default=True,
    help="auto: default light goes with the camera, the model's own stays; camera: all goes, as if the model turned; world: all stays.",
)  # fmt: skip
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
def turntable(talk: Talk, /, **options: Any) -> None:
    """Turn MODEL once round before the camera.

    \b
        limner turntable model.glb -o clip.gif
        limner turntable model.glb -o clip.webp --frames 120 --fps 30 --quality 85
        limner turntable model.glb -o frames --width 1920 --height 1080 --renderer path

    The clip has no seam. Ctrl-C leaves no half a file; in a folder, the pictures so far.
    """
    order = Order(**options)
    check_size(order.width, order.height)
    check_yfov(order.yfov)
    _make_turntable(order, talk)


def _make_turntable(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    kind = checked_kind(order, order.frames)
    scene = scene_of(order, kind, talk)

    from ..produce.turntable import write_turntable

    with Bar(enabled=not talk.quiet) as bar:
        clip = write_turntable(
            scene,
            order.output,
            order.frames,
            fps=order.fps,
            quality=order.quality,
            view=order.view,
            exposure=order.exposure,
            elevation_degrees=order.elevation,
            azimuth_degrees=order.azimuth,
            yfov_degrees=order.yfov,
            width=order.width,
            height=order.height,
            renderer=order.renderer,
            samples=order.samples,
            seed=order.seed,
            lights=order.lights,
            threads=order.threads,
            on_progress=bar,
        )
    close(order, clip, f" of {order.frames}", talk)
