"""`limner curve`: curves and fractals as pictures or as SVG."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from .destination import check_canvas, put_canvas
from .options import as_json, check_size, seed, size
from .talk import Talk
from .voice import voice

if TYPE_CHECKING:
    from ..curves.curve import Spline
    from ..draw.canvas import Canvas
    from ..image.image import Image

__all__ = ["FRACTALS", "KINDS", "curve"]

KINDS = ("bezier", "bspline", "nurbs", "catmull-rom", "cardinal", "natural", "hermite", "polyline")
FRACTALS = (
    "koch", "snowflake", "dragon", "hilbert", "gosper", "sierpinski", "levy", "plant", "fern", "carpet", "coast", "mandelbrot", "julia",
)  # fmt: skip

_EXAMPLE = "0,0 1,3 3,3.5 4,-1 6,0 7,2"
_LEVELS = {"hilbert": 5, "dragon": 12, "levy": 11, "plant": 5, "sierpinski": 6, "gosper": 4, "coast": 9}
_POINTS = 400_000


@dataclass(frozen=True)
class Order:
    """What a command line asks for."""

    kind: str
    output: str
    points: str | None
    weights: str | None
    degree: int
    alpha: float
    tension: float
    closed: bool
    construction: float | None
    comb: bool
    marks: int | None
    level: int | None
    seed: int
    c: str
    bounds: str | None
    width: int
    height: int
    as_json: bool


@click.command(short_help="Draw a curve or a fractal: a picture or SVG.")
@click.argument("kind", type=click.Choice([*KINDS, *FRACTALS]), metavar="KIND")
@click.option("-o", "--output", required=True, metavar="OUT", help="The picture file, or .svg for vectors.")
@click.option("--points", metavar='"X,Y X,Y …"', help="Control points, or points to go through; hermite: points and tangents in turn.")
@click.option("--weights", metavar="W,W,…", help="One for each control point (bezier, nurbs).")
@click.option("--degree", type=click.IntRange(1, 30), default=3, show_default=True, help="Of bspline and nurbs.")
@click.option(
    "--alpha", type=click.FloatRange(0.0, 1.0), default=0.5, show_default=True,
    help="Of catmull-rom: 0 uniform, 0.5 centripetal, 1 chordal.",
)  # fmt: skip
@click.option("--tension", type=float, default=0.0, show_default=True, help="Of cardinal: 1 is the polygon.")
@click.option("--closed", is_flag=True, help="Back to the first point.")
@click.option("--construction", type=click.FloatRange(0.0, 1.0), metavar="U", help="Show how de Casteljau finds the point at U (bezier).")
@click.option("--comb", is_flag=True, help="Show the curvature as a comb.")
@click.option("--marks", type=click.IntRange(2, 10_000), metavar="N", help="Show dots at N equal distances, rings at N equal parameters.")
@click.option("--level", type=click.IntRange(0, 100_000), help="Of fractals: how often they grow; mandelbrot, julia: most steps.")
@seed()
@click.option("--c", default="-0.8,0.156", show_default=True, metavar="RE,IM", help="Of julia.")
@click.option("--bounds", metavar="L,B,R,T", help="What part of the plane mandelbrot and julia show.  [default: all]")
@size(800, 600)
@as_json("Tell length, bounds and joints of a curve as JSON on standard output.")
@voice
@click.pass_obj
def curve(talk: Talk, /, **options: Any) -> None:
    """Draw a curve of KIND (bezier, bspline, nurbs, catmull-rom, cardinal, natural, hermite, polyline) or a fractal (koch, snowflake,
    dragon, hilbert, gosper, sierpinski, levy, plant, fern, carpet, coast, mandelbrot, julia).

    \b
        limner curve bezier -o casteljau.svg --points "0,0 1,3 3,3 4,0" --construction 0.4
        limner curve natural -o comb.png --points "0,0 1,2 3,1 4,3" --comb
        limner curve mandelbrot -o seahorses.png --bounds=-0.76,0.08,-0.72,0.11 --level 1000
    """
    order = Order(**options)
    check_size(order.width, order.height)
    _draw_curve(order, talk)


def _draw_curve(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    as_svg = check_canvas(order.output)
    if order.kind in FRACTALS:
        made = _fractal(order)
    else:
        spline, control = _spline(order)
        made = _drawn(order, spline, control)
        if order.as_json:
            _tell(spline, talk)
    if not as_svg:
        _image(made).save(order.output)
        return
    from ..draw.canvas import Canvas

    if not isinstance(made, Canvas):
        raise click.UsageError(f"{order.kind} is made of pixels, not of lines: ask for .png")
    put_canvas(made, order.output, as_svg)


def _image(made: Canvas | Image) -> Image:
    from ..image.image import Image

    return made if isinstance(made, Image) else made.image()


def _numbers(text: str, columns: int | None, option: str) -> list[Any]:
    try:
        rows = [[float(number) for number in word.split(",")] for word in text.replace(";", " ").split()]
    except ValueError:
        raise click.UsageError(f"{option} takes numbers with commas between them, got {text!r}") from None
    if columns is None:
        return [number for row in rows for number in row]
    if not rows or any(len(row) != columns for row in rows):
        raise click.UsageError(f"{option} takes {columns} numbers with commas between them, got {text!r}")
    return rows


def _spline(order: Order) -> tuple[Spline, Any]:
    from ..curves import bspline, catmull_rom, hermite, natural, nurbs
    from ..curves.curve import Spline

    control = _numbers(order.points or _EXAMPLE, 2, "--points")
    if order.closed and order.kind in ("bezier", "nurbs", "hermite"):
        raise click.UsageError(f"--closed is for bspline, catmull-rom, cardinal, natural and polyline, not for {order.kind}")
    weights = None if order.weights is None else _numbers(order.weights, None, "--weights")
    if order.kind == "bezier":
        return Spline.bezier(control, weights), control
    if order.kind == "bspline":
        return (bspline.periodic(control, order.degree) if order.closed else bspline.spline(control, degree=order.degree)), control
    if order.kind == "nurbs":
        return nurbs.spline(control, weights or [1.0] * len(control), degree=order.degree), control
    if order.kind == "catmull-rom":
        return catmull_rom.catmull_rom(control, order.alpha, order.closed), None
    if order.kind == "cardinal":
        return catmull_rom.cardinal(control, order.tension, order.closed), None
    if order.kind == "natural":
        return (natural.closed(control) if order.closed else natural.natural(control)), None
    if order.kind == "hermite":
        # Points and tangents in turn
        if len(control) < 4 or len(control) % 2:
            raise click.UsageError(f"hermite takes points and tangents in turn, at least two of each, got {len(control)} pairs of numbers")
        return hermite.spline(control[::2], control[1::2]), None
    corners = [*control, control[0]] if order.closed else control
    return Spline.joined([[a, b] for a, b in itertools.pairwise(corners)]), None


def _drawn(order: Order, spline: Spline, control: Any) -> Canvas:
    from ..produce import curve_pictures

    size = {"width": order.width, "height": order.height}
    if order.construction is not None:
        if order.kind != "bezier" or order.weights is not None:
            raise click.UsageError("--construction draws de Casteljau's algorithm, for bezier without --weights")
        return curve_pictures.construction(control, order.construction, **size)
    if order.comb:
        return curve_pictures.comb(spline, **size)
    if order.marks is not None:
        return curve_pictures.evenly_marked(spline, order.marks, **size)
    return curve_pictures.drawing(spline, control, **size)


def _fractal(order: Order) -> Canvas | Image:
    from ..curves.fractals import displacement, escape, ifs, lsystem, replacement
    from ..produce import curve_pictures

    size = {"width": order.width, "height": order.height}
    level = order.level if order.level is not None else _LEVELS.get(order.kind, 5)
    if order.kind in ("mandelbrot", "julia"):
        steps = order.level or 300
        bounds = _bounds(order)
        if order.kind == "mandelbrot":
            return curve_pictures.escape_image(escape.mandelbrot(bounds, steps=steps, **size))
        ((real, imaginary),) = _numbers(order.c, 2, "--c")[:1]
        return curve_pictures.escape_image(escape.julia(complex(real, imaginary), bounds, steps=steps, **size))
    if order.kind in ("fern", "carpet"):
        return curve_pictures.scatter(ifs.NAMED[order.kind].points(_POINTS, order.seed), **size)
    if order.kind == "coast":
        corners = _numbers(order.points or "0,0 3,1 4,4 1,5 0,0", 2, "--points")
        return curve_pictures.line_drawing([displacement.displaced_line(corners, level, 0.75, order.seed)], **size)
    direct = {"koch": replacement.koch, "snowflake": replacement.snowflake, "dragon": replacement.dragon, "hilbert": replacement.hilbert}
    lines = [direct[order.kind](level)] if order.kind in direct else lsystem.NAMED[order.kind].lines(level)
    return curve_pictures.line_drawing(lines, **size)


def _bounds(order: Order) -> tuple[float, float, float, float]:
    """What is asked for, or what shows the whole set, in the picture's own shape."""
    if order.bounds is not None:
        left, bottom, right, top = _numbers(order.bounds, 4, "--bounds")[0]
        return left, bottom, right, top
    middle, extent = ((-0.75, 0.0), (3.0, 2.5)) if order.kind == "mandelbrot" else ((0.0, 0.0), (3.4, 2.6))
    scale = max(extent[0] / order.width, extent[1] / order.height)
    half = 0.5 * scale * order.width, 0.5 * scale * order.height
    return middle[0] - half[0], middle[1] - half[1], middle[0] + half[0], middle[1] + half[1]


def _tell(spline: Spline, talk: Talk) -> None:
    import json

    from ..curves.arc_length import length
    from ..curves.bounds import spline_box
    from ..curves.continuity import joints

    low, high = spline_box(spline)
    found = joints(spline)
    click.echo(
        json.dumps(
            {
                "pieces": len(spline.pieces),
                "degree": spline.degree,
                "rational": spline.rational,
                "length": length(spline),
                "bounds": [low.tolist(), high.tolist()],
                "joints": [{"parametric": joint.parametric, "geometric": joint.geometric, "report": joint.report()} for joint in found],
            },
            indent=2,
        )
    )
