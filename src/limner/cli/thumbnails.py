"""`limner thumbnails`: a picture of every model in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from ..errors import LimnerError
from .bar import Bar
from .main import FAILED, INTERRUPTED
from .model import said_up
from .talk import Talk, flattened
from .values import Background

if TYPE_CHECKING:
    from ..produce.thumbnails import Batch

__all__ = ["Order", "make_thumbnails"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.thumbnails`."""

    folder: str
    output: str
    size: int
    recursive: bool
    update: bool
    sheet: str | None
    renderer: str
    samples: int | None
    background: Background | None
    threads: int | None
    as_json: bool
    view: str
    exposure: float


def make_thumbnails(order: Order, talk: Talk) -> None:
    """Fulfil `order`: code 1 where a model failed, 130 where it was interrupted."""
    if order.background == "environment":
        raise click.UsageError("--background environment makes no sense here: models bring their own surroundings or none")
    if order.sheet is not None:
        from ..image.save import check_destination

        try:
            check_destination(order.sheet)
        except LimnerError as error:
            raise click.UsageError(str(error)) from error

    from ..produce.thumbnails import index_sheet, thumbnails

    with Bar(enabled=not talk.quiet) as bar:
        batch = thumbnails(
            order.folder,
            order.output,
            size=order.size,
            recursive=order.recursive,
            update=order.update,
            up=said_up(),
            renderer=order.renderer,
            samples=order.samples,
            view=order.view,
            exposure=order.exposure,
            background=None if order.background == "transparent" else order.background,
            threads=order.threads,
            on_progress=bar,
        )
    for item in batch.items:
        if item.error:
            click.echo(f"limner: error: {flattened(f'{item.source}: {item.error}')}", err=True)  # --quiet is about all else
        elif item.warning:
            talk.say("warning", f"{item.source}: {item.warning}")
    if order.sheet is not None and batch.items:
        index_sheet(batch).save(order.sheet)
    talk.say("note", f"{batch.count('made')} made, {batch.count('kept')} kept, {batch.count('failed')} failed")
    if batch.count("failed"):
        talk.code = FAILED
    if not batch.finished:
        talk.say("interrupted", f"{order.output} holds what was finished; --update goes on with it")
        talk.code = INTERRUPTED
    if order.as_json:
        _tell(order, batch)


def _tell(order: Order, batch: Batch) -> None:
    import json

    told: dict[str, Any] = {
        "folder": order.folder,
        "output": order.output,
        "sheet": order.sheet,
        "finished": batch.finished,
        "made": batch.count("made"),
        "kept": batch.count("kept"),
        "failed": batch.count("failed"),
        "items": [
            {
                "source": str(item.source),
                "path": str(item.path) if item.status != "failed" else None,
                "status": item.status,
                "error": item.error or None,
                "warning": item.warning or None,
                "seconds": round(item.seconds, 3),
            }
            for item in batch.items
        ],
    }
    click.echo(json.dumps(told, sort_keys=True))
