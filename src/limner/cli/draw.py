"""`limner draw`, and `limner render --renderer lines`: lines on a page or a sheet of paper, as vectors or as a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import click

from ..errors import LimnerError
from .bar import Bar
from .model import model_up, numbered, open_model
from .options import as_json, check_paper, check_size, crease, paper, sight, size, threads
from .sight import Sight, check_camera, chosen_camera
from .styles import LINE_STYLES
from .talk import Talk
from .values import WORDS, Background, Triple
from .voice import voice

if TYPE_CHECKING:
    from ..produce.drawing import Plate
    from ..scene.scene import Scene

__all__ = ["KINDS", "PictureOrder", "draw", "draw_picture"]

KINDS = ("silhouette", "smooth_silhouette", "crease", "boundary", "material", "uv_seam", "intersection", "suggestive_contour")


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.drawing` or `limner.technical_sheet`."""

    model: str
    output: str
    views: tuple[str, ...] | None
    projection: str
    paper: str
    scale: str | None
    unit: str
    dimensions: bool
    title: str | None
    date: str
    style: str | None
    kinds: tuple[str, ...] | None
    crease: float
    tone: str | None
    fill: bool
    width: int
    height: int
    camera: str | None
    eye: Triple | None
    target: Triple | None
    up: Triple | None
    yfov: float | None
    background: Background
    dpi: float | None
    threads: int | None
    scene: str | None
    variant: str | None
    time: float | None
    animation: str | None
    as_json: bool


class PictureOrder(Sight, Protocol):
    """What `limner render` says of a picture of lines."""

    @property
    def output(self) -> str: ...
    @property
    def style(self) -> str | None: ...
    @property
    def scene(self) -> str | None: ...
    @property
    def variant(self) -> str | None: ...
    @property
    def time(self) -> float | None: ...
    @property
    def animation(self) -> str | int | None: ...
    @property
    def background(self) -> Background | None: ...
    @property
    def as_json(self) -> bool: ...


@click.command(short_help="Draw a model's outlines and creases, or a technical sheet: SVG, PDF, DXF, a picture.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="OUT", help="An .svg, .pdf or .dxf for vectors, or a picture file.")
@click.option("--views", type=WORDS, help="Make a sheet of: front, back, left, right, top, bottom, iso, iso-left.")
@click.option("--projection", type=click.Choice(["first", "third"]), default="first", show_default=True, help="Angle.")
@click.option("--paper", metavar="SIZE", default="A3", show_default=True, help="Of a sheet: A4 to A0, A4-portrait, A3-portrait.")
@click.option("--scale", metavar="1:N", help="1:2, 5:1, …  [default: of a sheet the largest that fits]")
@click.option("--unit", type=click.Choice(["m", "cm", "mm", "in"]), default="m", show_default=True, help="Of the model's coordinates.")
@click.option("--dimensions", is_flag=True, help="Measure the box round the model, on a sheet.")
@click.option("--title", help="[default: the model's file]")
@click.option("--date", default="", help="In the title block, as it is to stand there.")
@click.option("--style", type=click.Choice(LINE_STYLES), help="[default: technical on a sheet, else plain]")
@click.option("--kinds", type=WORDS, help=f"Which lines, of: {', '.join(KINDS)}.")
@crease("By how much a surface turns at a crease, degrees.")
@click.option("--tone", type=click.Choice(["hatching", "stippling"]), help="Show light and shade by strokes or dots.")
@click.option("--fill", is_flag=True, help="Fill what is seen of each shape with its colour, as areas under the lines.")
@size(800, 600)
@sight
@paper
@click.option("--dpi", type=click.FloatRange(1.0, 4800.0), help="Of a picture.  [default: 150 of a sheet, else 96]")
@click.option("--scene", metavar="NAME|INDEX", help="Which of several scenes of the file.  [default: the file's own choice]")
@click.option("--variant", metavar="NAME", help="Which of the model's variants.  [default: none]")
@click.option("--time", type=float, metavar="S", help="The moment of the animation, seconds.  [default: what no animation has moved]")
@click.option("--animation", metavar="NAME|INDEX|all", help="Which animation; all: all at once.  [default: the first]")
@model_up
@threads("Of --tone and --fill.  [default: all cores]")
@as_json("Tell about the drawing as JSON on standard output.")
@voice
@click.pass_obj
def draw(talk: Talk, /, **options: Any) -> None:
    """Draw the lines of MODEL: outlines, creases, borders, and where shapes meet.

    \b
        limner draw part.glb -o part.svg
        limner draw part.glb -o part.png --style sketch --tone hatching
        limner draw part.stl -o sheet.pdf --views front,top,right,iso --unit mm --dimensions         a technical drawing
        limner draw part.stl -o sheet.dxf --views front,right --projection third --paper A2 --scale 1:2
    """
    order = Order(**options)
    check_paper(order.background)
    if order.views is not None and (order.tone is not None or order.fill or order.camera is not None or order.eye is not None):
        raise click.UsageError("a sheet has cameras of its own and lines only: --views excludes --tone, --fill, --camera and --eye")
    check_size(order.width, order.height)
    check_camera(order)
    _make_drawing(order, talk)


def _make_drawing(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    check_output(order.output)
    scene = _opened(order, talk)
    wanted: dict[str, Any] = {"crease_degrees": order.crease}
    if order.kinds is not None:
        wanted["kinds"] = order.kinds
    if order.style is not None:
        wanted["style"] = order.style
    with Bar(enabled=not talk.quiet) as bar:
        if order.views is not None:
            from ..produce.draw_sheet import technical_sheet

            plate = technical_sheet(
                scene, views=order.views, projection=order.projection, paper=order.paper, scale=order.scale, unit=order.unit,
                dimensions=order.dimensions, title=_title(order), date=order.date, on_progress=bar, **wanted,
            )  # fmt: skip
        else:
            from ..produce.draw_sheet import SHEET_UNITS
            from ..produce.drawing import drawing
            from ..produce.sheet_layout import read_scale

            plate = drawing(
                scene, width=order.width, height=order.height, camera=chosen_camera(order, scene),
                scale=None if order.scale is None else read_scale(order.scale), unit_mm=SHEET_UNITS[order.unit], tone=order.tone,
                fill=order.fill, background=_paper(order.background), title=_title(order), threads=order.threads, on_progress=bar, **wanted,
            )  # fmt: skip
    _finish(order.model, order.output, plate, order.as_json, talk, order.dpi)


def draw_picture(order: PictureOrder, talk: Talk) -> None:
    """Fulfil what `limner render --renderer lines` asks for."""
    check_output(order.output)
    scene = _opened(order, talk)
    from ..produce.drawing import drawing

    with Bar(enabled=not talk.quiet) as bar:
        plate = drawing(
            scene, width=order.width, height=order.height, camera=chosen_camera(order, scene), style=order.style or "plain",
            background=_paper("white" if order.background is None else order.background), on_progress=bar,
        )  # fmt: skip
    _finish(order.model, order.output, plate, order.as_json, talk)


def _opened(order: Order | PictureOrder, talk: Talk) -> Scene:
    """The model at the moment that is asked for."""
    scene = open_model(order.model, scene=order.scene)
    if order.variant is not None:
        from ..scene.variants import with_variant

        scene = with_variant(scene, order.variant)
    if order.time is not None or order.animation is not None:
        from ..scene.pose import at

        scene = at(scene, order.time or 0.0, numbered(order.animation))
    talk.note(scene.notes)
    return scene


def check_output(output: str) -> None:
    """Refuse an output that cannot be written before anything is computed for it."""
    from ..produce.drawing import check_plate

    try:
        check_plate(output)
    except LimnerError as error:
        raise click.UsageError(str(error)) from error


def _paper(background: Background) -> Background | None:
    """The paper's colour; None: there is none."""
    return None if background == "transparent" else background


def _title(order: Order) -> str:
    from pathlib import Path

    return Path(order.model).name if order.title is None else order.title


def _finish(model: str, output: str, plate: Plate, as_json: bool, talk: Talk, dpi: float | None = None) -> None:
    """Save what was drawn, and tell about it."""
    if not plate.facts["lines"]:
        talk.warn(["nothing of the model is in the picture: there are no lines"])
    plate.save(output, dpi=dpi)
    if as_json:
        import json

        click.echo(json.dumps({"model": model, "output": output, **plate.facts}, sort_keys=True))
