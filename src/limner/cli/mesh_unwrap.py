"""`limner mesh unwrap`: texture coordinates for the meshes of a model. Reading a command line imports no NumPy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .destination import check_canvas, put_canvas
from .model import model_up, open_model
from .options import as_json
from .talk import Talk, flattened
from .voice import voice

if TYPE_CHECKING:
    from ..mesh.mesh import Mesh

__all__ = ["unwrap"]

_METHODS = ["balanced", "isometric", "conformal", "tutte"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for."""

    model: str
    output: str | None
    method: str
    distortion: float | None
    resolution: int
    margin: int
    report: bool
    as_json: bool
    chart: str | None
    show: str


@click.command(short_help="Give the meshes of a model texture coordinates.")
@click.argument("model")
@click.option("-o", "--output", metavar="OUT", help="The model to write; its extension says the format.")
@click.option(
    "--method", type=click.Choice(_METHODS), default="balanced", show_default=True,
    help="What is kept: angles before areas, both alike, angles alone, or only who is next to whom (on disks).",
)  # fmt: skip
@click.option(
    "--distortion", type=click.FloatRange(0.0, min_open=True), metavar="D",
    help="How much charts may be distorted: less makes more charts.",
)  # fmt: skip
@click.option(
    "--resolution", type=click.IntRange(16, 16384), default=1024, show_default=True, help="Texels along a side of the texture it is for.",
)  # fmt: skip
@click.option("--margin", type=click.IntRange(0), default=2, show_default=True, help="Texels between any two charts.")
@click.option("--report", is_flag=True, help="Tell how much is distorted, how well the square is filled.")
@as_json("The same as JSON.")
@click.option("--chart", metavar="PICTURE", help="Draw the charts, too (.png, .svg, …); of several meshes each gets a number.")
@click.option(
    "--show", type=click.Choice(["conformal", "area", "stretch"]), default="conformal", show_default=True,
    help="What the colours of --chart tell.",
)  # fmt: skip
@model_up
@voice
@click.pass_obj
def unwrap(talk: Talk, /, **options: Any) -> None:
    """Cut the meshes of MODEL into charts, lay them flat with little distortion, and pack them into the unit square, each mesh into one of
    its own. No triangle is turned over, and nothing overlaps.

    \b
        limner mesh unwrap bunny.obj -o unwrapped.obj --report
        limner mesh unwrap part.stl -o part.obj --margin 8 --resolution 2048 --chart charts.svg
    """
    order = Order(**options)
    if order.output is None and order.chart is None and not order.report and not order.as_json:
        raise click.UsageError("nothing to do: ask for --output, --chart, --report or --json")
    _unwrap(order, talk)


def _unwrap(order: Order, talk: Talk) -> None:
    from ..errors import SceneError
    from ..scene.meshes import meshes_of, with_meshes

    if order.chart is not None:
        check_canvas(order.chart)
    scene = open_model(order.model)
    found = meshes_of(scene)
    if not found:
        raise SceneError(f"{order.model} has no meshes")
    path_of = {id(mesh): path for path, mesh in found.items()}
    made: dict[str, Mesh] = {}

    def change(mesh: Mesh) -> Mesh:
        from ..mesh.unwrap.unwrap import uv_unwrap

        chosen = {} if order.distortion is None else {"distortion": order.distortion}
        made[path_of[id(mesh)]] = unwrapped = uv_unwrap(
            mesh, method=order.method, resolution=order.resolution, margin=order.margin, **chosen
        )
        return unwrapped

    changed = with_meshes(scene, change)
    if order.output is not None:
        from ..files.save_mesh import save_model

        save_model(changed, order.output)
    if order.chart is not None:
        for name, mesh in zip(_chart_names(order.chart, len(made)), made.values(), strict=True):
            _draw(mesh, name, order)
    _report(order, made, talk)
    talk.note(scene.notes)


def _report(order: Order, made: dict[str, Mesh], talk: Talk) -> None:
    if not order.as_json and (not order.report or talk.quiet):
        return
    from ..mesh.unwrap.distortion import unwrap_report

    reports = {path: unwrap_report(mesh) for path, mesh in made.items()}
    if order.as_json:
        import json

        told = {"model": order.model, "meshes": {path: report.document() for path, report in reports.items()}}
        click.echo(json.dumps(told, sort_keys=True, allow_nan=False))
        return
    for path, report in reports.items():
        click.echo(flattened(path))
        for line in str(report).splitlines():
            click.echo(f"  {line}")


def _chart_names(chart: str, count: int) -> list[str]:
    if count == 1:
        return [chart]
    place = Path(chart)
    return [str(place.with_name(f"{place.stem}-{k}{place.suffix}")) for k in range(count)]


def _draw(mesh: Mesh, name: str, order: Order) -> None:
    from ..produce.uv_chart import uv_chart

    canvas = uv_chart(mesh, show=order.show, size=max(order.resolution, 64))
    put_canvas(canvas, name, Path(name).suffix.lower() == ".svg")
