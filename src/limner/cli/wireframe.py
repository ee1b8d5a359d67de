"""`limner wireframe`: a model as lines, as a picture or as SVG."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import click

from ..errors import LimnerError, UnsupportedError
from .bar import Bar
from .model import open_model
from .render import chosen_camera
from .talk import Talk
from .values import Background, Triple

__all__ = ["Order", "make_wireframe"]


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


def make_wireframe(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    as_svg = Path(order.output).suffix.lower() == ".svg"
    _check_output(order.output, as_svg)
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
    if as_svg:
        from ..produce.folder import put

        put(Path(os.path.realpath(order.output)), canvas.svg().encode())
    else:
        canvas.image().save(order.output)


def _check_output(output: str, as_svg: bool) -> None:
    """Refuse an output that cannot be written before anything is computed for it."""
    from ..image.save import check_destination

    try:
        # The same questions of its folder as for any picture.
        check_destination(f"{output[:-4]}.png" if as_svg and not Path(output).is_dir() else output)
    except UnsupportedError as error:
        raise click.UsageError(f"{error}, or .svg") from error
    except LimnerError as error:
        raise click.UsageError(str(error)) from error
