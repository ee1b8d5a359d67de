"""The commands by name. Each stands in a file of its own, which is imported when it is called for, and reads its line without NumPy."""

from __future__ import annotations

import importlib

import click

from .. import __version__

__all__ = ["COMMANDS", "limner"]

COMMANDS = (
    "animate", "chart", "compare", "convert", "curve", "dataset", "doctor", "draw", "explain", "info", "mesh", "render", "schema", "stages",
    "thumbnails", "turntable", "verify", "views", "warmup", "wireframe",
)  # fmt: skip

_SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 120}


class _Commands(click.Group):
    """Finds a command in the module of its name: one line of a shell pays for one command."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(importlib.import_module(f".{cmd_name}", __package__), cmd_name)
        return command


@click.group(cls=_Commands, context_settings=_SETTINGS)
@click.version_option(__version__, prog_name="limner", message="%(prog)s %(version)s")
def limner() -> None:
    """Pictures from three-dimensional models: no GPU, no display, no system graphics library.

    MODEL is a file (.glb, .gltf, .obj, …) or a built-in scene: teapot, cornell.
    """
