"""`limner chart`: colour, drawn: gamuts, observers, lamps, test pictures for a screen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from .destination import check_canvas, put_canvas
from .options import check_size, size
from .talk import Talk
from .values import WORDS
from .voice import voice

__all__ = ["CHARTS", "chart"]

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


@click.command(short_help="Draw a chart of colour: gamuts, observers, lamps, a screen's gamma.")
@click.argument("kind", type=click.Choice(CHARTS), metavar="KIND")
@click.option("-o", "--output", metavar="OUT", help="The picture file, or .svg for vectors; may be left out with --grey.")
@click.option("--gamuts", type=WORDS, default="srgb,display_p3,rec2020", show_default=True, help="Spaces to draw (chromaticity).")
@click.option("--plane", type=click.Choice(["xy", "uv"]), default="xy", show_default=True, help="CIE 1931 or 1976 (chromaticity).")
@click.option("--points", metavar='"X,Y X,Y …"', help="Colours to mark, by x and y (chromaticity).")
@click.option(
    "--lights", type=WORDS, default="A,C,D50,D65,E", show_default=True, help="Names, or kelvin as in 3200 (illuminants).",
)  # fmt: skip
@click.option(
    "--observer", type=click.Choice(["cie_1931_2", "cie_1964_10"]), default="cie_1931_2", show_default=True,
    help="2 or 10 degrees (chromaticity, matching).",
)  # fmt: skip
@click.option("--grey", type=float, metavar="CODE", help="The code, 0 to 255, that was as bright as the board: tells gamma (gamma).")
@size(960, 720, least=200)
@voice
@click.pass_obj
def chart(talk: Talk, /, **options: Any) -> None:
    """Draw a chart of KIND: chromaticity, matching, rgb-matching, cones, illuminants, metamers, metals, checker, banding, gamma.

    \b
        limner chart chromaticity -o gamuts.svg --gamuts srgb,rec2020,acescg --plane uv
        limner chart illuminants -o lamps.png --lights A,D65,3200
        limner chart gamma -o gamma.png          look at it pixel by pixel, from afar; then
        limner chart gamma --grey 186            gamma 2.20
    """
    order = Order(**options)
    if order.grey is not None and order.kind != "gamma":
        raise click.UsageError("--grey is the answer to the chart gamma")
    if order.output is None and order.grey is None:
        raise click.UsageError("nothing was asked for: give -o" + (", --grey or both" if order.kind == "gamma" else ""))
    check_size(order.width, order.height)
    _draw_chart(order, talk)


def _draw_chart(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    if order.output is not None:
        as_svg = check_canvas(order.output)
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
    put_canvas(canvas, output, as_svg)


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
