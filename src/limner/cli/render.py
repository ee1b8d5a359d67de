"""`limner render`: what may be said of a picture, and what does not go together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from .asked import Asked, deciding, one_background, settings_of_file
from .model import model_up
from .options import as_json, check_size, report, size, threads
from .screen import screen
from .sight import check_camera
from .styles import LINE_STYLES, PICTURE_STYLES
from .talk import Talk
from .values import WORDS
from .voice import voice

__all__ = ["Order", "render"]


@dataclass(frozen=True, kw_only=True)
class Order(Asked):
    """What a command line asks for; None: the default of `limner.render`."""

    output: str
    aovs: tuple[str, ...]
    threads: int | None
    as_json: bool
    view: str = "standard"
    exposure: float = 0.0
    color_space: str = "srgb"
    denoise: str | None = None
    report: bool = False
    style: str | None = None
    lines: bool = False
    noise: float | None = None
    time_limit: float | None = None
    snapshots: float | None = None
    resume: bool = False


@click.command(short_help="Make a picture of a model.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="OUT", help="The picture file; - is standard output.")
@click.option(
    "--renderer", type=click.Choice(["raster", "ray", "path", "lines"]), default="raster", show_default=True,
    help="How to see; lines: a drawing, to .svg, .pdf or .dxf, too.",
)  # fmt: skip
@click.option(
    "--style", type=click.Choice(list(dict.fromkeys([*PICTURE_STYLES, *LINE_STYLES]))),
    help="Explain rather than imitate: gooch, toon, xray (raster, ray); plain, technical, sketch, xray, chalk (lines).",
)  # fmt: skip
@click.option("--lines", is_flag=True, help="Draw outlines and creases over the picture (raster, ray, path).")
@size(800, 600)
@deciding
@click.option("--noise", type=click.FloatRange(min=0.0, min_open=True), help="Go on until the error is this part of the light (path).")
@click.option(
    "--time-limit", type=click.FloatRange(min=0.0, min_open=True), metavar="SECONDS",
    help="Stop after so long, and tell how many samples that were (path).",
)  # fmt: skip
@click.option(
    "--snapshots", type=click.FloatRange(min=0.0, min_open=True), metavar="SECONDS",
    help="Save the picture so far so often, and beside it what --resume needs (path).",
)  # fmt: skip
@click.option("--resume", is_flag=True, help="Go on from what --snapshots left of a picture that was killed or out of time (path).")
@click.option("--aov", "aovs", type=WORDS, default="", help="What to keep beside the picture (.exr): depth, normal, albedo, …")
@click.option(
    "--denoise", type=click.Choice(["filter", "oidn"]),
    help="Take the noise out (ray, path): our filter, or Open Image Denoise (extra denoise).  [default: it stays]",
)  # fmt: skip
@model_up
@click.option(
    "--color-space", default="srgb", show_default=True, metavar="SPACE", help="Whose numbers are written: display_p3, rec2020, acescg, …",
)  # fmt: skip
@threads()
@report
@as_json("Tell about the picture as JSON on standard output.")
@screen
@voice
@click.pass_context
def render(context: click.Context, /, **options: Any) -> None:
    """Make a picture of MODEL.

    \b
        limner render teapot -o teapot.png
        limner render model.glb -o model.exr --aov depth,normal --width 1920 --height 1080
        limner render model.glb -o view.png --eye 3,2,4 --target 0,1,0 --yfov 35 --background white
        limner render teapot -o blurred.png --renderer ray --samples 64 --aperture 0.1 --focus 5
        limner render model.glb -o lines.svg --renderer lines --style technical
        limner render model.glb -o tinted.png --style gooch --lines

    What a scene file, or one of Mitsuba, says about its picture counts unless the command line says otherwise. Ctrl-C stops early and
    saves the picture so far.
    """
    from .picture import make_picture

    talk = context.find_object(Talk)
    assert talk is not None
    further = settings_of_file(context, options)
    background = one_background(options)
    order = Order(background=background, further=further, **options)
    check_size(order.width, order.height)
    check_camera(order)
    if order.output == "-" and order.as_json:
        raise click.UsageError("--json and -o - both want standard output")
    _check_style(order.renderer, order.style)
    if order.renderer == "lines" and (order.aovs or order.lines):
        raise click.UsageError(f"--renderer lines draws lines and nothing else: leave out {'--aov' if order.aovs else '--lines'}")
    make_picture(order, talk)


def _check_style(renderer: str, style: str | None) -> None:
    known = LINE_STYLES if renderer == "lines" else PICTURE_STYLES
    if style is not None and style not in known:
        raise click.UsageError(f"--style {style} is not one of --renderer {renderer}, which has {', '.join(known)}")
