"""`limner wireframe`: a model as lines, as a picture or as SVG."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from .bar import Bar
from .destination import check_canvas, put_canvas
from .model import model_up, open_model
from .options import check_paper, check_size, crease, paper, renderer, samples, sight, size, threads
from .sight import check_camera, chosen_camera
from .talk import Talk
from .values import Background, Triple
from .voice import voice

__all__ = ["wireframe"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.wireframe`."""

    model: str
    output: str
    width: int
    height: int
    camera: str | None
    eye: Triple | None
    target: Triple | None
    up: Triple | None
    yfov: float | None
    edges: str
    crease: float
    color: str
    line_width: float
    hidden: str | None
    background: Background
    shaded: bool
    renderer: str
    samples: int | None
    threads: int | None


@click.command(short_help="Draw a model as lines, hidden ones left out: a picture or SVG.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="OUT", help="A picture file or .svg; - is a PNG on standard output.")
@click.option("--edges", type=click.Choice(["all", "features"]), default="all", show_default=True, help="All, or outlines and creases.")
@crease("With --edges features: by how much a surface turns at a crease, degrees.")
@click.option("--color", default="black", show_default=True, metavar="COLOR", help="Of the lines: black, white, #RRGGBB or #RRGGBBAA.")
@click.option("--line-width", type=click.FloatRange(0.0, 1000.0, min_open=True), default=1.0, show_default=True, help="Pixels.")
@click.option("--hidden", metavar="COLOR", help="Draw the hidden lines, too, thinner and in this colour, such as #c8ccd2.")
@click.option("--shaded", is_flag=True, help="Draw the lines over the shaded model.")
@paper
@size(800, 600)
@sight
@renderer("Of --shaded.")
@samples("Of --shaded.  [default: the renderer's]")
@threads()
@model_up
@voice
@click.pass_obj
def wireframe(talk: Talk, /, **options: Any) -> None:
    """Draw MODEL as lines. What surfaces hide is left out, unless --hidden says how to draw it.

    \b
        limner wireframe part.glb -o part.png
        limner wireframe part.stl -o part.svg --edges features --hidden "#c8ccd2"       a technical drawing
        limner wireframe part.glb -o mesh.png --shaded --color "#00000080"              lines over the shaded model
    """
    order = Order(**options)
    check_paper(order.background)
    check_size(order.width, order.height)
    check_camera(order)
    _make_wireframe(order, talk)


def _make_wireframe(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    as_svg = check_canvas(order.output)
    scene = open_model(order.model)
    talk.note(scene.notes)

    from ..produce.wireframe import wireframe

    with Bar(enabled=not talk.quiet) as bar:
        canvas = wireframe(
            scene,
            width=order.width,
            height=order.height,
            camera=chosen_camera(order, scene),
            edges=order.edges,
            crease_degrees=order.crease,
            color=order.color,
            line_width=order.line_width,
            hidden=order.hidden,
            background=None if order.background == "transparent" else order.background,
            shaded=order.shaded,
            renderer=order.renderer,
            samples=order.samples,
            threads=order.threads,
            on_progress=bar,
        )
    put_canvas(canvas, order.output, as_svg)
