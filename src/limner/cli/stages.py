"""`limner stages`: what each stage of the pipeline makes of a model, on one sheet, and in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from ..errors import LimnerError
from .bar import Bar
from .main import INTERRUPTED
from .model import open_model
from .render import chosen_camera
from .talk import Talk
from .values import Triple

__all__ = ["Order", "make_stages"]


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


def make_stages(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    if order.output is not None:
        from ..image.save import check_destination

        try:
            check_destination(order.output)
        except LimnerError as error:
            raise click.UsageError(str(error)) from error
    scene = open_model(order.model)
    talk.note(scene.notes)

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
    talk.warn(sheet.facts["warnings"])
    if not sheet.finished:
        talk.say("interrupted", "nothing was written")
        talk.code = INTERRUPTED
        return
    talk.note(sheet.facts["notes"])
    if order.output is not None:
        sheet.image.save(order.output)
    if order.as_json:
        import json

        click.echo(json.dumps({"model": order.model, "output": order.output, **sheet.facts}, sort_keys=True))
