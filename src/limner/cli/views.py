"""`limner views`: a model from all sides on one sheet, and in facts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from ..errors import LimnerError
from .bar import Bar
from .main import INTERRUPTED
from .model import open_model
from .talk import Talk

__all__ = ["Order", "make_views"]


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


def make_views(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    if order.output is not None:
        from ..image.save import check_destination

        try:
            check_destination(order.output)
        except LimnerError as error:
            raise click.UsageError(str(error)) from error
    scene = open_model(order.model)
    talk.note(scene.notes)

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
    talk.warn(sheet.facts["warnings"])
    if not sheet.finished:
        talk.say("interrupted", "nothing was written")
        talk.code = INTERRUPTED
        return
    if order.output is not None:
        sheet.image.save(order.output)
    if order.as_json:
        import json

        click.echo(json.dumps({"model": order.model, "output": order.output, **sheet.facts}, sort_keys=True))
