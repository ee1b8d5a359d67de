"""`limner chart`: colour, drawn: gamuts, observers, lamps, test pictures for a screen."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import click

from ..errors import LimnerError, UnsupportedError
from .talk import Talk

__all__ = ["CHARTS", "Order", "draw_chart"]

CHARTS = ("chromaticity", "matching", "rgb-matching", "cones", "illuminants", "metamers", "metals", "checker", "banding", "gamma")
"""As in `limner.produce.charts`, which needs NumPy."""


@dataclass(frozen=True)
class Order:
    """What a command line asks for."""

    kind: str
    output: str | None
    gamuts: tuple[str, ...]
    plane: str
    points: str | None
    lights: tuple[str, ...]
    observer: str
    grey: float | None
    width: int
    height: int


def draw_chart(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    if order.output is not None:
        as_svg = Path(order.output).suffix.lower() == ".svg"
        _check_output(order.output, as_svg)
        _draw(order, order.output, as_svg)
    if order.grey is not None:
        click.echo(f"gamma {_gamma(order.grey):.2f}", err=order.output == "-")


def _gamma(grey: float) -> float:
    """Of the code (0 to 255) that looked as bright as the board."""
    from ..color.transfer import gamma_from_match

    if not 0.0 < grey < 255.0:
        raise click.UsageError(f"--grey is the code that matched, between 0 and 255, got {grey:g}")
    return float(gamma_from_match(grey / 255.0))


def _draw(order: Order, output: str, as_svg: bool) -> None:
    from ..produce.charts import chart

    canvas = chart(
        order.kind,
        width=order.width,
        height=order.height,
        gamuts=order.gamuts,
        plane=order.plane,
        points=_pairs(order.points),
        lights=[_light(word) for word in order.lights],
        observer=order.observer,
    )
    if not as_svg:
        canvas.image().save(output)
        return
    from ..produce.folder import put

    put(Path(os.path.realpath(output)), canvas.svg().encode())


def _light(word: str) -> str | float:
    """A name, or a temperature: 3200 or 3200K."""
    try:
        return float(word.removesuffix("K"))
    except ValueError:
        return word


def _pairs(text: str | None) -> list[tuple[float, float]]:
    try:
        rows = [[float(number) for number in word.split(",")] for word in (text or "").replace(";", " ").split()]
    except ValueError:
        rows = [[]]
    if any(len(row) != 2 for row in rows):
        raise click.UsageError(f"--points takes pairs of numbers with a comma between them, got {text!r}")
    return [(row[0], row[1]) for row in rows]


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
