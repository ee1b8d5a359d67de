"""The options of commands whose pictures go to a screen: by which view, and how bright."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

__all__ = ["VIEWS", "screen"]

VIEWS = ("none", "standard", "reinhard", "reinhard_extended", "hable", "aces", "narkowicz", "agx", "pbr_neutral")
"""As in `limner.color.views`, which needs NumPy."""


def screen(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--view` and `--exposure`."""
    command = click.option(
        "--exposure", type=click.FloatRange(-64.0, 64.0), default=0.0, show_default=True, metavar="STOPS",
        help="Stops by which the light is made brighter.",
    )(command)  # fmt: skip
    return click.option(
        "--view", type=click.Choice(VIEWS), default="standard", show_default=True, help="How light becomes what a screen shows.",
    )(command)  # fmt: skip
