"""`limner explain`: why does this pixel look like that?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from .asked import Asked, deciding, one_background, settings_of_file
from .model import model_up, open_model
from .options import check_size, renderer, size
from .sight import check_camera
from .styles import PICTURE_STYLES
from .talk import Talk
from .voice import voice

if TYPE_CHECKING:
    from ..scene.scene import Scene

__all__ = ["explain"]

_OF_WHOLE_PICTURES = {
    "aovs": "", "noise": "as many samples are told of as --samples says", "time_limit": "as many samples are told of as --samples says",
    "denoise": "told is the light of the pixel before its noise is taken out",
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class _Order(Asked):
    """What a command line asks to be told."""

    pixel: tuple[int, int]
    output: str | None
    sample: int | str | None
    levels: int | None
    style: str | None


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
@click.option(
    "--style", type=click.Choice([style for style in PICTURE_STYLES if style != "toon"]),
    help="Explain rather than imitate (raster, ray), as in the picture.",
)  # fmt: skip
@size(800, 600)
@click.option("--sample", type=_SampleType(), metavar="N|all", help="Which sample is told of.  [default: raster all, else a typical one]")
@click.option("--levels", type=click.IntRange(0, 1000), metavar="N", help="How deep the tree is shown as text.  [default: to its leaves]")
@deciding
@model_up
@voice
@click.pass_context
def explain(context: click.Context, /, **options: Any) -> None:
    """Tell how a pixel of a picture of MODEL came about, as a tree: every step, with numbers, formulas and their sources.

    \b
        limner explain teapot --pixel 400,300
        limner explain teapot --pixel 400,300 --renderer ray -o pixel.html
        limner explain model.glb --pixel 12,40 --width 320 --height 240 --renderer path --sample 3 --levels 4

    The options are those of `limner render` with which the picture was made, and what a scene file says about its picture counts.
    """
    talk = context.find_object(Talk)
    assert talk is not None
    further = settings_of_file(context, options)
    for name in [name for name in _OF_WHOLE_PICTURES if further.pop(name, None) is not None]:
        talk.note([_OF_WHOLE_PICTURES[name]] if _OF_WHOLE_PICTURES[name] else [])
    background = one_background(options)
    order = _Order(background=background, further=further, **options)
    _check(order)
    from ..explain.explain import explain as tell

    scene, camera, _ = order.shown(open_model(order.model, None, order.scene))
    talk.note(scene.notes)
    settings = order.settings()
    if order.style is not None:
        scene, settings = _styled(scene, settings, order.style)
    told = tell(scene, *order.pixel, camera=camera, sample=order.sample, **settings)
    if not told.is_exact:
        talk.warn(["the traced kernels found other bits than the picture has"])
    if order.output is None:
        click.echo(told.text(order.levels))
    else:
        told.save(order.output)


def _styled(scene: Scene, settings: dict[str, Any], style: str) -> tuple[Scene, dict[str, Any]]:
    """The scene in a style, and what is left to be told of it: as pictures in a style, it is one of the moment first."""
    from ..produce.stylized import with_style
    from ..scene.pose import at

    if settings["time"] is not None or settings["animation"] is not None:
        scene = at(scene, settings["time"] or 0.0, settings["animation"])
        settings = {**settings, "time": None, "animation": None}
    return with_style(scene, style), settings


def _check(order: _Order) -> None:
    """Say what cannot be before a model is read."""
    check_size(order.width, order.height)
    check_camera(order)
    x, y = order.pixel
    if not (0 <= x < order.width and 0 <= y < order.height):
        raise click.UsageError(f"--pixel {x},{y} is not in a picture of {order.width} x {order.height}")
    if order.output is not None and not order.output.lower().endswith((".html", ".json", ".txt")):
        raise click.UsageError(f"-o must end in .html, .json or .txt, got {order.output!r}")
