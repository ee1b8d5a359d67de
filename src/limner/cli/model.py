"""MODEL, as a command line names it: a built-in scene or a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import SceneError

if TYPE_CHECKING:
    from ..files.report import LoadReport
    from ..scene.scene import Scene

__all__ = ["model_up", "numbered", "open_model", "report_of_model", "said_up"]

_SAID = "limner.model_up"


def model_up(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option that says which axis of a model's file points up; `open_model` heeds it wherever it is not told otherwise."""

    def keep(context: click.Context, _parameter: click.Parameter, value: str) -> None:
        context.meta[_SAID] = value

    return click.option(
        "--model-up", type=click.Choice(["y", "z"]), default="y", show_default=True, expose_value=False, callback=keep,
        help="Which axis of the model's file points up.",
    )(command)  # fmt: skip


def said_up() -> str:
    """Which axis the command line says points up."""
    context = click.get_current_context(silent=True)
    return "y" if context is None else str(context.meta.get(_SAID, "y"))


def open_model(name: str, up: str | None = None, scene: str | None = None) -> Scene:
    """Return the built-in scene of that name, or read the file, whose `up` points up; ``./teapot`` is a file.

    `up` None: what `--model-up` says.

    `scene`: which of several in the file, by name or number.
    """
    built_in = _built_in(name)
    if built_in is not None:
        return built_in
    from ..files.load import load

    return load(name, up=up or said_up(), scene=numbered(scene))


def report_of_model(name: str, up: str | None = None, scene: str | None = None) -> LoadReport:
    """Open a model as `open_model` does, and tell what became of it; a built-in scene is there as it is."""
    from ..files.report import load_report, report_of

    built_in = _built_in(name)
    if built_in is None:
        return load_report(name, up=up or said_up(), scene=numbered(scene))
    from ..files.notes import Notes

    return report_of(built_in, Notes(), name, "built-in")


def numbered(word: str | int | None) -> str | int | None:
    """The number that a word is, else the name."""
    return int(word) if isinstance(word, str) and word.isdecimal() else word


def _built_in(name: str) -> Scene | None:
    """The built-in scene of that name; None: it must be a file, and there is one."""
    from ..scene.library import BUILTINS, builtin

    if name in BUILTINS:
        return builtin(name)
    if not Path(name).exists():
        raise SceneError(f"there is no file {name!r}, and no built-in scene of that name ({', '.join(sorted(BUILTINS))})")
    return None
