"""`limner views`: a model from all sides on one sheet, and in facts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from .bar import Bar
from .model import model_up
from .options import as_json, check_outlets, renderer, samples, threads
from .sheets import close, model_of
from .talk import Talk
from .voice import voice

__all__ = ["views"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.views`."""

    model: str
    output: str | None
    size: int
    projection: str
    renderer: str
    samples: int | None
    own_lights: bool
    threads: int | None
    as_json: bool


@click.command(short_help="Show a model from all sides on one sheet, with axes, measures and facts.")
@click.argument("model")
@click.option("-o", "--output", metavar="OUT", help="The picture file; may be left out with --json.")
@click.option("--size", type=click.IntRange(128, 2048), default=320, show_default=True, help="Side of each view, pixels.")
@click.option(
    "--projection", type=click.Choice(["orthographic", "perspective"]), default="orthographic", show_default=True,
    help="Of the views along the axes: parallel and at one scale, or each from the nearest eye.",
)  # fmt: skip
@renderer()
@samples()
@click.option("--own-lights", is_flag=True, help="Light it with its own lights instead of one beside the camera.")
@threads()
@as_json("Tell the facts as JSON on standard output.")
@model_up
@voice
@click.pass_obj
def views(talk: Talk, /, **options: Any) -> None:
    """Show MODEL from the front, right, back, left, top, bottom and a corner: one sheet with axes, measures and facts.

    \b
        limner views model.glb -o sheet.png
        limner views model.glb -o sheet.png --json        bounds, counts, materials, what is seen in each view, warnings
    """
    order = Order(**options)
    check_outlets(order.output, order.as_json)
    _make_views(order, talk)


def _make_views(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    scene = model_of(order, talk)

    from ..produce.views import views

    with Bar(enabled=not talk.quiet) as bar:
        sheet = views(
            scene,
            size=order.size,
            projection=order.projection,
            renderer=order.renderer,
            samples=order.samples,
            own_lights=order.own_lights,
            title=Path(order.model).name,
            threads=order.threads,
            on_progress=bar,
        )
    close(order, sheet, talk)
