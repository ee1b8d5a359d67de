"""The options that every command has: how much it says."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from .talk import Talk

__all__ = ["voice"]


def voice(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that every command has; they set its `Talk`."""

    def put(name: str) -> Callable[[click.Context, click.Parameter, bool], None]:
        def callback(context: click.Context, _parameter: click.Parameter, value: bool) -> None:
            if value:
                setattr(context.find_object(Talk), name, True)

        return callback

    for name, text in (
        ("traceback", "On an error, show where in the program it arose."),
        ("verbose", "Say what takes time, too."),
        ("quiet", "Say nothing but errors."),
    ):
        option = click.option(f"--{name}", is_flag=True, expose_value=False, is_eager=True, callback=put(name), help=text)
        command = option(command)
    return command
