"""What `views` and `stages` share: a sheet that is saved, told as JSON, or both."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import click

from .destination import check_picture
from .main import INTERRUPTED
from .model import open_model
from .talk import Talk

if TYPE_CHECKING:
    from ..image.image import Image
    from ..scene.scene import Scene

__all__ = ["Sheet", "SheetOrder", "close", "model_of"]


class SheetOrder(Protocol):
    """What a command line says about a sheet."""

    @property
    def model(self) -> str: ...
    @property
    def output(self) -> str | None: ...
    @property
    def as_json(self) -> bool: ...


class Sheet(Protocol):
    """What was made."""

    @property
    def image(self) -> Image: ...
    @property
    def facts(self) -> dict[str, Any]: ...
    @property
    def finished(self) -> bool: ...


def model_of(order: SheetOrder, talk: Talk) -> Scene:
    """The model that is to be shown, read once it is sure that the sheet can be written."""
    if order.output is not None:
        check_picture(order.output)
    scene = open_model(order.model)
    talk.note(scene.notes)
    return scene


def close(order: SheetOrder, sheet: Sheet, talk: Talk) -> None:
    """Save a sheet and tell about it."""
    talk.warn(sheet.facts["warnings"])
    if not sheet.finished:
        talk.say("interrupted", "nothing was written")
        talk.code = INTERRUPTED
        return
    talk.note(sheet.facts.get("notes", ()))
    if order.output is not None:
        sheet.image.save(order.output)
    if order.as_json:
        import json

        click.echo(json.dumps({"model": order.model, "output": order.output, **sheet.facts}, sort_keys=True))
