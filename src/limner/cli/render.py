"""`limner render`: what may be said of a picture, and what does not go together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import click

from .model import model_up
from .options import as_json, background, check_size, environment, max_depth, report, samples, seed, sight, size, threads, weights
from .screen import screen
from .sight import check_camera
from .styles import LINE_STYLES, PICTURE_STYLES
from .talk import Talk
from .values import INTERVAL, WORDS, Background, Triple
from .voice import voice

__all__ = ["Order", "render"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.render`."""

    model: str
    output: str
    renderer: str
    width: int
    height: int
    samples: int | None
    seed: int
    max_depth: int
    sampler: str | None
    glossy: bool
    emitters: bool
    antialiasing: str
    shadows: bool | None
    shading: str
    hidden_surfaces: str
    clipping: str
    culling: str
    filter: str
    camera: str | None
    eye: Triple | None
    target: Triple | None
    up: Triple | None
    yfov: float | None
    aperture: float | None
    focus: float | None
    scene: str | None
    variant: str | None
    time: float | None
    animation: str | int | None
    shutter: tuple[float, float] | None
    aovs: tuple[str, ...]
    environment: str | None
    ground: bool
    scalars: str | None
    color_map: str
    scalar_range: tuple[float, float] | None
    point_size: float | None
    background: Background | None
    threads: int | None
    as_json: bool
    view: str = "standard"
    exposure: float = 0.0
    color_space: str = "srgb"
    denoise: str | None = None
    further: dict[str, Any] = field(default_factory=dict)
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
@samples()
@seed()
@click.option(
    "--antialiasing", type=click.Choice(["multisample", "supersample"]), default="multisample", show_default=True,
    help="Shade once what covers several samples of a pixel, or every sample (raster).",
)  # fmt: skip
@click.option("--shadows/--no-shadows", default=None, help="Whether lights can be hidden.  [default: not by raster]")
@click.option(
    "--shading", type=click.Choice(["fragment", "vertex", "flat"]), default="fragment", show_default=True,
    help="Where colours are computed (raster).",
)  # fmt: skip
@click.option(
    "--hidden-surfaces", type=click.Choice(["zbuffer", "painter"]), default="zbuffer", show_default=True,
    help="How what is in front is found (raster).",
)  # fmt: skip
@click.option(
    "--clipping", type=click.Choice(["homogeneous", "world"]), default="homogeneous", show_default=True,
    help="After the projection, or before it (raster).",
)  # fmt: skip
@click.option(
    "--culling", type=click.Choice(["material", "back", "front", "none"]), default="material", show_default=True,
    help="Which sides are left out (raster).",
)  # fmt: skip
@weights("box", "How the samples around a pixel are weighed (raster).")
@max_depth
@click.option(
    "--sampler", type=click.Choice(["regular", "random", "jittered", "multijittered", "halton", "sobol"]),
    help="How samples are spread (ray, path).  [default: the renderer's]",
)  # fmt: skip
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
@click.option("--glossy", is_flag=True, help="Follow what rough mirrors reflect by rays (ray; path does anyway).")
@click.option("--emitters", is_flag=True, help="Let surfaces that shine light others (ray; path does anyway).")
@sight
@click.option("--aperture", type=click.FloatRange(0.0), metavar="R", help="Radius of the lens (ray, path).  [default: the camera's]")
@click.option(
    "--focus", type=click.FloatRange(0.0, min_open=True), metavar="D",
    help="Distance at which things are sharp, along the gaze.  [default: that of the target]",
)  # fmt: skip
@click.option("--scene", metavar="NAME|INDEX", help="Which of several scenes of the file.  [default: the file's own choice]")
@click.option("--variant", metavar="NAME", help="Which of the model's variants.  [default: none]")
@click.option("--time", type=float, metavar="S", help="The moment of the animation, seconds.  [default: what no animation has moved]")
@click.option("--animation", metavar="NAME|INDEX|all", help="Which animation; all: all at once.  [default: the first]")
@click.option(
    "--shutter", type=INTERVAL, metavar="S,S", help="When the shutter opens and closes, seconds: what moves is blurred (ray, path).",
)  # fmt: skip
@click.option("--aov", "aovs", type=WORDS, default="", help="What to keep beside the picture (.exr): depth, normal, albedo, …")
@click.option(
    "--denoise", type=click.Choice(["filter", "oidn"]),
    help="Take the noise out (ray, path): our filter, or Open Image Denoise (extra denoise).  [default: it stays]",
)  # fmt: skip
@environment
@click.option("--ground", is_flag=True, help="Put a ground under the model that shows its shadow.")
@model_up
@click.option("--scalars", metavar="NAME", help="Colour by the numbers of that name (PLY properties, glTF _NAME), with a key.")
@click.option("--color-map", metavar="MAP", default="viridis", show_default=True, help="How numbers become colours: cividis, cool_warm, …")
@click.option("--scalar-range", type=INTERVAL, metavar="LOW,HIGH", help="What the ends of the map stand for.  [default: all there is]")
@click.option(
    "--point-size", type=click.FloatRange(0.0, min_open=True), metavar="R",
    help="Radius of the points of clouds.  [default: from their spacing]",
)  # fmt: skip
@background
@click.option("--transparent", is_flag=True, help="The same as --background transparent.")
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
    further = _settings_of_file(context, options)
    background = _one_background(options.pop("background"), options.pop("transparent"))
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


def _settings_of_file(context: click.Context, options: dict[str, Any]) -> dict[str, Any]:
    """Put the settings of a scene file, or of a Mitsuba scene, in the place of defaults; return those for which there is no option."""
    model = options["model"]
    if model.lower().endswith((".yaml", ".yml", ".limner")):
        from ..files.scene_file import settings_of
    elif model.lower().endswith(".xml"):
        from ..files.mitsuba import settings_of
    else:
        return {}
    further = {}
    for name, value in settings_of(model).items():
        if name not in options:
            further[name] = value
        elif context.get_parameter_source(name) is click.core.ParameterSource.DEFAULT:
            options[name] = value
    if options["renderer"] != "raster" and context.get_parameter_source("filter") is click.core.ParameterSource.DEFAULT:
        options["filter"] = "box"  # what a file says of another renderer's filter
    return further


def _one_background(background: Background | None, transparent: bool) -> Background | None:
    if transparent and background not in (None, "transparent"):
        raise click.UsageError("--transparent and --background say different things")
    return "transparent" if transparent else background
