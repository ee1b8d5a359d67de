"""`limner stages`: what each stage of the pipeline makes of a model, on one sheet, and in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from .bar import Bar
from .model import model_up
from .options import as_json, camera, check_outlets, place, threads
from .sheets import close, model_of
from .sight import check_camera, chosen_camera
from .talk import Talk
from .values import Triple
from .voice import voice

__all__ = ["stages"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for."""

    model: str
    output: str | None
    width: int
    height: int
    samples: int
    camera: str | None
    eye: Triple | None
    target: Triple | None
    up: Triple | None
    yfov: float | None
    threads: int | None
    as_json: bool


@click.command(short_help="Show what each stage of the graphics pipeline makes of a model, on one sheet.")
@click.argument("model")
@click.option("-o", "--output", metavar="OUT", help="The picture file; may be left out with --json.")
@click.option("--width", type=click.IntRange(320, 1600), default=400, show_default=True, help="Of each panel, pixels.")
@click.option("--height", type=click.IntRange(160, 1600), help="Of each panel.  [default: three quarters of the width]")
@click.option("--samples", type=click.IntRange(2, 64), default=16, show_default=True, help="In each pixel of the finished picture.")
@camera("A camera of the model, by name or number from 0.  [default: one that shows all]", "NAME|INDEX")
@place
@threads()
@as_json("Tell the numbers as JSON on standard output.")
@model_up
@voice
@click.pass_obj
def stages(talk: Talk, /, **options: Any) -> None:
    """Show what each stage of the graphics pipeline makes of MODEL: lines, clipping, coverage, depth, shading, texture, antialiasing.

    \b
        limner stages model.glb -o stages.png
        limner stages teapot -o stages.png --json         vertices, triangles, fragments, pixels, overdraw, mipmap levels
    """
    height = options.pop("height") or round(0.75 * options["width"])
    order = Order(height=height, **options)
    check_outlets(order.output, order.as_json)
    check_camera(order)
    _make_stages(order, talk)


def _make_stages(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    scene = model_of(order, talk)

    from ..produce.stages import stages

    with Bar(enabled=not talk.quiet) as bar:
        sheet = stages(
            scene,
            width=order.width,
            height=order.height,
            camera=chosen_camera(order, scene),
            samples=order.samples,
            title=Path(order.model).name,
            threads=order.threads,
            on_progress=bar,
        )
    close(order, sheet, talk)
