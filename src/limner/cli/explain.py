"""`limner explain`: why does this pixel look like that?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from .model import model_up, open_model
from .options import MAX_SIDE, environment, max_depth, renderer, samples, seed, sight
from .sight import check_camera, chosen_camera
from .surroundings import surrounded
from .talk import Talk
from .values import Triple
from .voice import voice

__all__ = ["explain"]


@dataclass(frozen=True)
class _Order:
    """What the command line says about the camera; see `cli.sight.Sight`."""

    model: str
    width: int
    height: int
    camera: str | None
    eye: Triple | None
    target: Triple | None
    up: Triple | None
    yfov: float | None


class _PixelType(click.ParamType[tuple[int, int]]):
    name = "x,y"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        if isinstance(value, tuple):
            return value
        try:
            x, y = (int(part) for part in str(value).split(","))
        except ValueError:
            self.fail(f"expected a column and a row X,Y, counted from 0 at the top left, got {value!r}", param, ctx)
        return x, y


class _SampleType(click.ParamType["int | str"]):
    name = "n"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int | str:
        if value == "all":
            return "all"
        try:
            return int(value)
        except ValueError:
            self.fail(f'expected a number or "all", got {value!r}', param, ctx)


@click.command(short_help="Tell how a pixel came about: every step, with numbers, formulas and their sources.")
@click.argument("model")
@click.option("--pixel", type=_PixelType(), required=True, metavar="X,Y", help="Column and row, from 0 at the top left.")
@click.option("-o", "--output", metavar="FILE", help=".html (with pictures), .json or .txt.  [default: text on standard output]")
@renderer()
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=800, show_default=True, help="Columns of the picture.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=600, show_default=True, help="Rows of the picture.")
@samples()
@click.option("--sample", type=_SampleType(), metavar="N|all", help="Which of them is told of.  [default: raster all, else a typical one]")
@seed()
@max_depth
@sight
@environment
@click.option("--levels", type=click.IntRange(0, 1000), metavar="N", help="How deep the tree is shown as text.  [default: to its leaves]")
@model_up
@voice
@click.pass_obj
def explain(talk: Talk, /, **options: Any) -> None:
    """Tell how a pixel of a picture of MODEL came about, as a tree: every step, with numbers, formulas and their sources.

    \b
        limner explain teapot --pixel 400,300
        limner explain teapot --pixel 400,300 --renderer ray -o pixel.html
        limner explain model.glb --pixel 12,40 --width 320 --height 240 --renderer path --sample 3 --levels 4

    The options are those of `limner render` with which the picture was made.
    """
    order = _Order(**{name: options[name] for name in _Order.__dataclass_fields__})
    _check(options)
    check_camera(order)
    from ..explain.explain import explain as tell

    scene = open_model(options["model"])
    talk.note(scene.notes)
    scene = surrounded(scene, options["environment"])
    asked = {name: options[name] for name in ("renderer", "width", "height", "samples", "seed", "max_depth")}
    x, y = options["pixel"]
    told = tell(scene, x, y, camera=chosen_camera(order, scene), sample=options["sample"], **asked)
    if not told.is_exact:
        talk.warn(["the traced kernels found other bits than the picture has"])
    if options["output"] is None:
        click.echo(told.text(options["levels"]))
    else:
        told.save(options["output"])


def _check(options: dict[str, Any]) -> None:
    """Say what cannot be before a model is read."""
    x, y = options["pixel"]
    if not (0 <= x < options["width"] and 0 <= y < options["height"]):
        raise click.UsageError(f"--pixel {x},{y} is not in a picture of {options['width']} x {options['height']}")
    output = options["output"]
    if output is not None and not output.lower().endswith((".html", ".json", ".txt")):
        raise click.UsageError(f"-o must end in .html, .json or .txt, got {output!r}")
