"""`limner thumbnails`: a picture of every model in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from .bar import Bar
from .destination import check_picture
from .main import FAILED, INTERRUPTED
from .model import model_up, said_up
from .options import as_json, renderer, samples, threads
from .screen import screen
from .talk import Talk, flattened
from .values import BACKGROUND, Background
from .voice import voice

if TYPE_CHECKING:
    from ..produce.thumbnails import Batch

__all__ = ["thumbnails"]


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


@click.command(short_help="Make a picture of every model in a folder.")
@click.argument("folder")
@click.option("-o", "--output", required=True, metavar="FOLDER", help="For the pictures; is made where it is not there.")
@click.option("--size", type=click.IntRange(16, 4096), default=256, show_default=True, help="Width and height, pixels.")
@click.option("--recursive", is_flag=True, help="Look into sub-folders, too.")
@click.option("--update", is_flag=True, help="Keep pictures that are newer than their models.")
@click.option("--sheet", metavar="OUT", help="Put all of them on one contact sheet, too.")
@renderer()
@samples()
@click.option("--background", type=BACKGROUND, help="transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).")
@threads()
@as_json("Tell what became of each model as JSON on standard output.")
@screen
@model_up
@voice
@click.pass_obj
def thumbnails(talk: Talk, /, **options: Any) -> None:
    """Make a picture of every model in FOLDER. One that fails is told of and does not stop the rest; the exit code is then 1.

    \b
        limner thumbnails models -o thumbs --recursive --update
        limner thumbnails models -o thumbs --size 512 --sheet index.png
    """

    _make_thumbnails(Order(**options), talk)


def _make_thumbnails(order: Order, talk: Talk) -> None:
    """Fulfil `order`: code 1 where a model failed, 130 where it was interrupted."""
    if order.background == "environment":
        raise click.UsageError("--background environment makes no sense here: models bring their own surroundings or none")
    if order.sheet is not None:
        check_picture(order.sheet)

    from ..produce.thumbnails import index_sheet, thumbnails

    with Bar(enabled=not talk.quiet) as bar:
        batch = thumbnails(
            order.folder,
            order.output,
            size=order.size,
            recursive=order.recursive,
            update=order.update,
            renderer=order.renderer,
            samples=order.samples,
            view=order.view,
            exposure=order.exposure,
            up=said_up(),
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
