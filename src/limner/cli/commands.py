"""The commands and their options. Reading a command line imports neither NumPy nor Numba; the work does."""

from __future__ import annotations

from typing import Any

import click

from .. import __version__
from .chart import CHARTS
from .curve import FRACTALS, KINDS
from .doctor import doctor
from .draw import KINDS as LINE_KINDS
from .draw import LINE_STYLES, PICTURE_STYLES
from .explain import explain
from .mesh import mesh
from .model import model_up as _model_up
from .schema import schema
from .screen import screen as _screen
from .talk import Talk
from .values import BACKGROUND, INTERVAL, TRIPLE, WORDS, Background, Triple
from .voice import voice as _voice

__all__ = ["limner"]

MAX_SIDE = 32768
MAX_PIXELS = 1 << 26
MAX_SAMPLES = 1 << 20
MAX_SEED = (1 << 31) - 1
MAX_VIEWS = 1_000_000

_SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 120}


@click.group(context_settings=_SETTINGS)
@click.version_option(__version__, prog_name="limner", message="%(prog)s %(version)s")
def limner() -> None:
    """Pictures from three-dimensional models: no GPU, no display, no system graphics library.

    MODEL is a file (.glb, .gltf, .obj, …) or a built-in scene: teapot, cornell.
    """


limner.add_command(doctor)
limner.add_command(explain)
limner.add_command(mesh)
limner.add_command(schema)


@limner.command(short_help="Make a picture of a model.")
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
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=800, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=600, show_default=True, help="Rows.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Samples in each pixel.  [default: the renderer's]")
@click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="What random numbers begin with.")
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
@click.option(
    "--filter", type=click.Choice(["box", "tent", "gaussian", "mitchell", "lanczos3"]), default="box", show_default=True,
    help="How the samples around a pixel are weighed (raster).",
)  # fmt: skip
@click.option("--max-depth", type=click.IntRange(0, 1000), default=8, show_default=True, help="How often light is reflected at most.")
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
@click.option("--camera", metavar="NAME|INDEX|frame", help="A camera of the model, by name or number from 0; frame: one that shows all.")
@click.option("--eye", type=TRIPLE, help="Where the eye stands, instead of a camera of the model.")
@click.option("--target", type=TRIPLE, help="What it looks at.  [default: the middle of the model]")
@click.option("--up", type=TRIPLE, help="What is held upright.  [default: 0,1,0]")
@click.option("--yfov", type=float, metavar="DEG", help="The full vertical field of view, degrees.  [default: 40]")
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
@click.option("--environment", metavar="FILE", help="A sky to light the scene with (.hdr, .exr), equirectangular.")
@click.option("--ground", is_flag=True, help="Put a ground under the model that shows its shadow.")
@click.option("--model-up", type=click.Choice(["y", "z"]), default="y", show_default=True, help="Which axis of the model's file points up.")
@click.option("--scalars", metavar="NAME", help="Colour by the numbers of that name (PLY properties, glTF _NAME), with a key.")
@click.option("--color-map", metavar="MAP", default="viridis", show_default=True, help="How numbers become colours: cividis, cool_warm, …")
@click.option("--scalar-range", type=INTERVAL, metavar="LOW,HIGH", help="What the ends of the map stand for.  [default: all there is]")
@click.option(
    "--point-size", type=click.FloatRange(0.0, min_open=True), metavar="R",
    help="Radius of the points of clouds.  [default: from their spacing]",
)  # fmt: skip
@click.option("--background", type=BACKGROUND, help="environment, transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).")
@click.option("--transparent", is_flag=True, help="The same as --background transparent.")
@click.option(
    "--color-space", default="srgb", show_default=True, metavar="SPACE", help="Whose numbers are written: display_p3, rec2020, acescg, …",
)  # fmt: skip
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--report", is_flag=True, help="Tell what of the file was read, approximated, ignored, replaced or repaired.")
@click.option("--json", "as_json", is_flag=True, help="Tell about the picture as JSON on standard output.")
@_screen
@_voice
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
    from .render import Order, make_picture

    talk = context.find_object(Talk)
    assert talk is not None
    further = _settings_of_file(context, options)
    background = _one_background(options.pop("background"), options.pop("transparent"))
    order = Order(background=background, further=further, **options)
    _check_size(order.width, order.height)
    _check_camera(order.camera, order.eye, order.target, order.up, order.yfov)
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


@limner.command(short_help="Tell what is in a model, and what is wrong with it.")
@click.argument("model")
@click.option("--report", is_flag=True, help="Tell what of the file was read, approximated, ignored, replaced or repaired.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@_model_up
@_voice
@click.pass_obj
def info(talk: Talk, model: str, report: bool, as_json: bool) -> None:
    """Tell what is in MODEL, and what is wrong with it."""
    from .info import tell

    tell(model, as_json, talk, report)


@limner.command(short_help="Make a data set: a model from all around, with depth, normals, masks, cameras.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="FOLDER", help="Is made where it is not there.")
@click.option("--views", type=click.IntRange(1, MAX_VIEWS), default=36, show_default=True, help="In equal steps of a full turn.")
@click.option("--elevation", type=click.FloatRange(-90.0, 90.0), default=20.0, show_default=True, help="Above the horizon, degrees.")
@click.option("--azimuth", type=float, default=0.0, show_default=True, help="Of the first view, from +z to +x, degrees.")
@click.option("--yfov", type=float, default=40.0, show_default=True, help="The full vertical field of view, degrees.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=640, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=480, show_default=True, help="Rows.")
@click.option("--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="How to see.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Samples in each pixel.  [default: the renderer's]")
@click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="What random numbers begin with.")
@click.option("--aov", "aovs", type=WORDS, default="depth,normal,instance_id", show_default=True, help="To keep as arrays (.npz).")
@click.option("--masks", type=click.Choice(["instance", "material"]), help="Write PNGs of 16 bits: 0 for nothing, else 1 + id.")
@click.option(
    "--annotations", type=click.Choice(["instance", "material", "none"]), default="instance", show_default=True,
    help="Categories of annotations.json (COCO).",
)  # fmt: skip
@click.option("--environment", metavar="FILE", help="A sky to light the scene with (.hdr, .exr), equirectangular.")
@click.option("--background", type=BACKGROUND, help="environment, transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).")
@click.option("--resume", is_flag=True, help="Go on with what is in the folder.")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell about the data set as JSON on standard output.")
@_model_up
@_voice
@click.pass_obj
def dataset(talk: Talk, /, **options: Any) -> None:
    """Make a data set of MODEL: pictures from all around, arrays, masks, and the cameras in OpenCV's and OpenGL's words.

    \b
        limner dataset model.glb -o views --views 72 --elevation 30
        limner dataset model.glb -o views --aov depth,position --masks material --background white

    Ctrl-C stops early; what is finished is a data set, and --resume goes on with it.
    """
    from .dataset import Order, make_dataset

    order = Order(**options)
    _check_size(order.width, order.height)
    if not 0.0 < order.yfov < 180.0:
        raise click.UsageError(f"--yfov must lie between 0 and 180 degrees, got {order.yfov:g}")
    make_dataset(order, talk)


@limner.command(short_help="Tell how different two pictures are.")
@click.argument("reference", metavar="A")
@click.argument("test", metavar="B")
@click.option("-o", "--output", metavar="OUT", help="A picture of where they differ.")
@click.option("--picture", type=click.Choice(["flip", "absolute"]), default="flip", show_default=True, help="What OUT shows.")
@click.option("--gain", type=click.FloatRange(0.0, min_open=True), default=10.0, show_default=True, help="Of --picture absolute.")
@click.option(
    "--metric", type=click.Choice(["rmse", "rel_mse", "psnr", "ssim", "flip"]), default="flip", show_default=True,
    help="What --fail-above and --fail-below look at.",
)  # fmt: skip
@click.option("--fail-above", type=float, metavar="X", help="Differ, for rmse, rel_mse and flip, means above X.")
@click.option("--fail-below", type=float, metavar="X", help="Differ, for psnr and ssim, means below X.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@_voice
@click.pass_obj
def compare(talk: Talk, /, **options: Any) -> None:
    """Tell how different the pictures A (the reference) and B are.

    The code is 0 where they are alike, 1 where they differ: in any bit, or beyond the threshold where there is one.

    \b
        limner compare before.png after.png -o difference.png
        limner compare reference.exr noisy.exr --metric rmse --fail-above 0.02
    """
    from .compare import Order
    from .compare import compare as run

    run(Order(**options), talk)


@limner.command(short_help="Make a picture again from its recipe; do the bits agree?")
@click.argument("picture")
@click.option("--model", metavar="MODEL", help="What it is a picture of, where its recipe does not say or it has moved.")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@_voice
@click.pass_obj
def verify(talk: Talk, picture: str, model: str | None, threads: int | None, as_json: bool) -> None:
    """Make PICTURE again from the recipe in it, and say whether the bits agree: code 0 if so, 1 if not.

    \b
        limner verify teapot.png
        limner verify old.exr --model ../models/car.glb
    """
    from .verify import verify as run

    run(picture, model, threads, as_json, talk)


@limner.command(short_help="Write a picture in another format, size or number of bits, or as a printer's dots.")
@click.argument("source", metavar="PICTURE")
@click.argument("output", metavar="OUT")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), help="Columns.  [default: as --height has it]")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), help="Rows.  [default: as --width has it]")
@click.option(
    "--filter", type=click.Choice(["box", "tent", "gaussian", "mitchell", "lanczos3"]), default="mitchell", show_default=True,
    help="How pixels are made of others.",
)  # fmt: skip
@click.option("--bits", type=click.Choice([1, 8, 16, 32]), help="Of each channel: PNG 1, 8, 16; EXR 16, 32.")
@click.option(
    "--dither", type=click.Choice(["ordered", "blue_noise", "random", "floyd_steinberg"]), help="How rounding is spread.",
)  # fmt: skip
@click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="For --dither.")
@click.option("--dpi", type=click.FloatRange(0.0, min_open=True), help="Pixels per inch on paper.")
@click.option(
    "--halftone", type=click.FloatRange(0.0, min_open=True), metavar="LPI", help="Screen it for a printer of --dpi: lines per inch.",
)  # fmt: skip
@click.option("--angle", type=float, default=45.0, show_default=True, help="Of the screen, degrees.")
@click.option("--shape", type=click.Choice(["round", "diamond", "line"]), default="round", show_default=True, help="Of the screen's dots.")
@_screen
@_model_up
@_voice
@click.pass_obj
def convert(talk: Talk, /, **options: Any) -> None:
    """Write PICTURE to OUT, whose extension says the format; - is a PNG on standard output.

    \b
        limner convert render.exr small.png --width 640
        limner convert photo.jpg print.png --width 2400 --dpi 600 --halftone 75
        limner convert chair.glb chair.stl

    Where OUT is .obj, .ply or .stl, PICTURE is a model, and is written as it stands in the world.
    """
    from .convert import Order
    from .convert import convert as run

    run(Order(**options), talk)


@limner.command(short_help="Turn a model once round: GIF, WebP, animated PNG, MP4 or a folder of pictures.")
@click.argument("model")
@click.option(
    "-o", "--output", required=True, metavar="CLIP",
    help=".gif, .webp, .png (animated), .mp4 (needs the extra video), or a folder for PNGs.",
)  # fmt: skip
@click.option("--frames", type=click.IntRange(1, 100_000), default=72, show_default=True, help="Pictures in a full turn.")
@click.option("--fps", type=float, default=20.0, show_default=True, help="Pictures a second; at most 50 in a GIF.")
@click.option("--elevation", type=click.FloatRange(-90.0, 90.0), default=20.0, show_default=True, help="Above the horizon, degrees.")
@click.option("--azimuth", type=float, default=30.0, show_default=True, help="Of the first picture, from +z to +x, degrees.")
@click.option("--yfov", type=float, default=30.0, show_default=True, help="The full vertical field of view, degrees.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=640, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=480, show_default=True, help="Rows.")
@click.option("--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="How to see.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Samples in each pixel.  [default: the renderer's]")
@click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="What random numbers begin with.")
@click.option(
    "--lights", type=click.Choice(["auto", "camera", "world"]), default="auto", show_default=True,
    help="auto: default light goes with the camera, the model's own stays; camera: all goes, as if the model turned; world: all stays.",
)  # fmt: skip
@click.option("--environment", metavar="FILE", help="A sky to light the scene with (.hdr, .exr), equirectangular.")
@click.option("--ground", is_flag=True, help="Put a ground under the model that shows its shadow (ray, path).")
@click.option("--background", type=BACKGROUND, help="environment, transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).")
@click.option("--quality", type=click.IntRange(1, 100), help="Of WebP and MP4.  [default: WebP without loss, MP4 as good as it looks]")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell about the clip as JSON on standard output.")
@_screen
@_model_up
@_voice
@click.pass_obj
def turntable(talk: Talk, /, **options: Any) -> None:
    """Turn MODEL once round before the camera.

    \b
        limner turntable model.glb -o clip.gif
        limner turntable model.glb -o clip.webp --frames 120 --fps 30 --quality 85
        limner turntable model.glb -o frames --width 1920 --height 1080 --renderer path

    The clip has no seam. Ctrl-C leaves no half a file; in a folder, the pictures so far.
    """
    from .turntable import Order, make_turntable

    order = Order(**options)
    _check_size(order.width, order.height)
    _check_yfov(order.yfov)
    make_turntable(order, talk)


@limner.command(short_help="Play a model's animation: GIF, WebP, animated PNG, MP4 or a folder of pictures.")
@click.argument("model")
@click.option(
    "-o", "--output", required=True, metavar="CLIP",
    help=".gif, .webp, .png (animated), .mp4 (needs the extra video), or a folder for PNGs.",
)  # fmt: skip
@click.option("--animation", metavar="NAME|INDEX|all", help="Which animation; all: all at once.  [default: the first]")
@click.option("--fps", type=float, default=24.0, show_default=True, help="Pictures a second; at most 50 in a GIF.")
@click.option("--start", type=float, metavar="S", help="Where to begin, seconds.  [default: the animation's start]")
@click.option("--end", type=float, metavar="S", help="Where to end.  [default: the animation's end]")
@click.option(
    "--shutter", type=click.FloatRange(0.0, 1.0), default=0.0, show_default=True,
    help="How much of a picture's time the shutter is open (ray, path): what moves is blurred.",
)  # fmt: skip
@click.option("--camera", metavar="NAME|INDEX|frame", help="A camera of the model; frame: one that shows what is there at rest.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=640, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=480, show_default=True, help="Rows.")
@click.option("--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="How to see.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Samples in each pixel.  [default: the renderer's]")
@click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="What random numbers begin with.")
@click.option("--environment", metavar="FILE", help="A sky to light the scene with (.hdr, .exr), equirectangular.")
@click.option("--ground", is_flag=True, help="Put a ground under the model that shows its shadow (ray, path).")
@click.option("--background", type=BACKGROUND, help="environment, transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).")
@click.option("--quality", type=click.IntRange(1, 100), help="Of WebP and MP4.  [default: WebP without loss, MP4 as good as it looks]")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell about the clip as JSON on standard output.")
@_screen
@_model_up
@_voice
@click.pass_obj
def animate(talk: Talk, /, **options: Any) -> None:
    """Play the animation of MODEL.

    \b
        limner animate fox.glb -o walk.webp --animation Walk
        limner animate robot.glb -o robot.mp4 --fps 30 --renderer path --samples 64 --shutter 0.5

    `limner info` tells which animations there are. Ctrl-C leaves no half a file; in a folder, the pictures so far.
    """
    from .animate import Order, make_animation

    order = Order(**options)
    _check_size(order.width, order.height)
    make_animation(order, talk)


@limner.command(short_help="Show a model from all sides on one sheet, with axes, measures and facts.")
@click.argument("model")
@click.option("-o", "--output", metavar="OUT", help="The picture file; may be left out with --json.")
@click.option("--size", type=click.IntRange(128, 2048), default=320, show_default=True, help="Side of each view, pixels.")
@click.option(
    "--projection", type=click.Choice(["orthographic", "perspective"]), default="orthographic", show_default=True,
    help="Of the views along the axes: parallel and at one scale, or each from the nearest eye.",
)  # fmt: skip
@click.option("--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="How to see.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Samples in each pixel.  [default: the renderer's]")
@click.option("--own-lights", is_flag=True, help="Light it with its own lights instead of one beside the camera.")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell the facts as JSON on standard output.")
@_model_up
@_voice
@click.pass_obj
def views(talk: Talk, /, **options: Any) -> None:
    """Show MODEL from the front, right, back, left, top, bottom and a corner: one sheet with axes, measures and facts.

    \b
        limner views model.glb -o sheet.png
        limner views model.glb -o sheet.png --json        bounds, counts, materials, what is seen in each view, warnings
    """
    from .views import Order, make_views

    order = Order(**options)
    if order.output is None and not order.as_json:
        raise click.UsageError("nothing was asked for: give -o, --json or both")
    if order.output == "-" and order.as_json:
        raise click.UsageError("--json and -o - both want standard output")
    make_views(order, talk)


@limner.command(short_help="Show what each stage of the graphics pipeline makes of a model, on one sheet.")
@click.argument("model")
@click.option("-o", "--output", metavar="OUT", help="The picture file; may be left out with --json.")
@click.option("--width", type=click.IntRange(320, 1600), default=400, show_default=True, help="Of each panel, pixels.")
@click.option("--height", type=click.IntRange(160, 1600), help="Of each panel.  [default: three quarters of the width]")
@click.option("--samples", type=click.IntRange(2, 64), default=16, show_default=True, help="In each pixel of the finished picture.")
@click.option("--camera", metavar="NAME|INDEX", help="A camera of the model, by name or number from 0.  [default: one that shows all]")
@click.option("--eye", type=TRIPLE, help="Where the eye stands, instead of a camera of the model.")
@click.option("--target", type=TRIPLE, help="What it looks at.  [default: the middle of the model]")
@click.option("--up", type=TRIPLE, help="What is held upright.  [default: 0,1,0]")
@click.option("--yfov", type=float, metavar="DEG", help="The full vertical field of view, degrees.  [default: 40]")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell the numbers as JSON on standard output.")
@_model_up
@_voice
@click.pass_obj
def stages(talk: Talk, /, **options: Any) -> None:
    """Show what each stage of the graphics pipeline makes of MODEL: lines, clipping, coverage, depth, shading, texture, antialiasing.

    \b
        limner stages model.glb -o stages.png
        limner stages teapot -o stages.png --json         vertices, triangles, fragments, pixels, overdraw, mipmap levels
    """
    from .stages import Order, make_stages

    height = options.pop("height") or round(0.75 * options["width"])
    order = Order(height=height, **options)
    if order.output is None and not order.as_json:
        raise click.UsageError("nothing was asked for: give -o, --json or both")
    if order.output == "-" and order.as_json:
        raise click.UsageError("--json and -o - both want standard output")
    _check_camera(order.camera, order.eye, order.target, order.up, order.yfov)
    make_stages(order, talk)


@limner.command(short_help="Draw a model's outlines and creases, or a technical sheet: SVG, PDF, DXF, a picture.")
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
@click.option("--kinds", type=WORDS, help=f"Which lines, of: {', '.join(LINE_KINDS)}.")
@click.option(
    "--crease", type=click.FloatRange(0.0, 180.0), default=30.0, show_default=True, metavar="DEG",
    help="By how much a surface turns at a crease, degrees.",
)  # fmt: skip
@click.option("--tone", type=click.Choice(["hatching", "stippling"]), help="Show light and shade by strokes or dots.")
@click.option("--fill", is_flag=True, help="Fill what is seen of each shape with its colour, as areas under the lines.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=800, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=600, show_default=True, help="Rows.")
@click.option("--camera", metavar="NAME|INDEX|frame", help="A camera of the model, by name or number from 0; frame: one that shows all.")
@click.option("--eye", type=TRIPLE, help="Where the eye stands, instead of a camera of the model.")
@click.option("--target", type=TRIPLE, help="What it looks at.  [default: the middle of the model]")
@click.option("--up", type=TRIPLE, help="What is held upright.  [default: 0,1,0]")
@click.option("--yfov", type=float, metavar="DEG", help="The full vertical field of view, degrees.  [default: 40]")
@click.option("--background", type=BACKGROUND, default="white", show_default=True, help="transparent, white, gray, #RRGGBB or R,G,B.")
@click.option("--dpi", type=click.FloatRange(1.0, 4800.0), help="Of a picture.  [default: 150 of a sheet, else 96]")
@click.option("--model-up", type=click.Choice(["y", "z"]), default="y", show_default=True, help="Which axis of the model points up.")
@click.option("--threads", type=click.IntRange(1, 1024), help="Of --tone and --fill.  [default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell about the drawing as JSON on standard output.")
@_voice
@click.pass_obj
def draw(talk: Talk, /, **options: Any) -> None:
    """Draw the lines of MODEL: outlines, creases, borders, and where shapes meet.

    \b
        limner draw part.glb -o part.svg
        limner draw part.glb -o part.png --style sketch --tone hatching
        limner draw part.stl -o sheet.pdf --views front,top,right,iso --unit mm --dimensions         a technical drawing
        limner draw part.stl -o sheet.dxf --views front,right --projection third --paper A2 --scale 1:2
    """
    from .draw import Order, make_drawing

    order = Order(**options)
    if order.background == "environment":
        raise click.UsageError("--background environment makes no sense here: transparent, a name, #RRGGBB or R,G,B")
    if order.views is not None and (order.tone is not None or order.fill or order.camera is not None or order.eye is not None):
        raise click.UsageError("a sheet has cameras of its own and lines only: --views excludes --tone, --fill, --camera and --eye")
    _check_size(order.width, order.height)
    _check_camera(order.camera, order.eye, order.target, order.up, order.yfov)
    make_drawing(order, talk)


@limner.command(short_help="Draw a model as lines, hidden ones left out: a picture or SVG.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="OUT", help="A picture file or .svg; - is a PNG on standard output.")
@click.option("--edges", type=click.Choice(["all", "features"]), default="all", show_default=True, help="All, or outlines and creases.")
@click.option(
    "--crease", type=click.FloatRange(0.0, 180.0), default=30.0, show_default=True, metavar="DEG",
    help="With --edges features: by how much a surface turns at a crease, degrees.",
)  # fmt: skip
@click.option("--color", default="black", show_default=True, metavar="COLOR", help="Of the lines: black, white, #RRGGBB or #RRGGBBAA.")
@click.option("--line-width", type=click.FloatRange(0.0, 1000.0, min_open=True), default=1.0, show_default=True, help="Pixels.")
@click.option("--hidden", metavar="COLOR", help="Draw the hidden lines, too, thinner and in this colour, such as #c8ccd2.")
@click.option("--shaded", is_flag=True, help="Draw the lines over the shaded model.")
@click.option("--background", type=BACKGROUND, default="white", show_default=True, help="transparent, white, gray, #RRGGBB or R,G,B.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=800, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=600, show_default=True, help="Rows.")
@click.option("--camera", metavar="NAME|INDEX|frame", help="A camera of the model, by name or number from 0; frame: one that shows all.")
@click.option("--eye", type=TRIPLE, help="Where the eye stands, instead of a camera of the model.")
@click.option("--target", type=TRIPLE, help="What it looks at.  [default: the middle of the model]")
@click.option("--up", type=TRIPLE, help="What is held upright.  [default: 0,1,0]")
@click.option("--yfov", type=float, metavar="DEG", help="The full vertical field of view, degrees.  [default: 40]")
@click.option("--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="Of --shaded.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Of --shaded.  [default: the renderer's]")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@_model_up
@_voice
@click.pass_obj
def wireframe(talk: Talk, /, **options: Any) -> None:
    """Draw MODEL as lines. What surfaces hide is left out, unless --hidden says how to draw it.

    \b
        limner wireframe part.glb -o part.png
        limner wireframe part.stl -o part.svg --edges features --hidden "#c8ccd2"       a technical drawing
        limner wireframe part.glb -o mesh.png --shaded --color "#00000080"              lines over the shaded model
    """
    from .wireframe import Order, make_wireframe

    order = Order(**options)
    if order.background == "environment":
        raise click.UsageError("--background environment makes no sense here: transparent, a name, #RRGGBB or R,G,B")
    _check_size(order.width, order.height)
    _check_camera(order.camera, order.eye, order.target, order.up, order.yfov)
    make_wireframe(order, talk)


@limner.command(short_help="Draw a curve or a fractal: a picture or SVG.")
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
@click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="What random numbers begin with.")
@click.option("--c", default="-0.8,0.156", show_default=True, metavar="RE,IM", help="Of julia.")
@click.option("--bounds", metavar="L,B,R,T", help="What part of the plane mandelbrot and julia show.  [default: all]")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), default=800, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), default=600, show_default=True, help="Rows.")
@click.option("--json", "as_json", is_flag=True, help="Tell length, bounds and joints of a curve as JSON on standard output.")
@_voice
@click.pass_obj
def curve(talk: Talk, /, **options: Any) -> None:
    """Draw a curve of KIND (bezier, bspline, nurbs, catmull-rom, cardinal, natural, hermite, polyline) or a fractal (koch, snowflake,
    dragon, hilbert, gosper, sierpinski, levy, plant, fern, carpet, coast, mandelbrot, julia).

    \b
        limner curve bezier -o casteljau.svg --points "0,0 1,3 3,3 4,0" --construction 0.4
        limner curve natural -o comb.png --points "0,0 1,2 3,1 4,3" --comb
        limner curve mandelbrot -o seahorses.png --bounds=-0.76,0.08,-0.72,0.11 --level 1000
    """
    from .curve import Order, draw_curve

    order = Order(**options)
    _check_size(order.width, order.height)
    draw_curve(order, talk)


@limner.command(short_help="Draw a chart of colour: gamuts, observers, lamps, a screen's gamma.")
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
@click.option("--width", type=click.IntRange(200, MAX_SIDE), default=960, show_default=True, help="Columns.")
@click.option("--height", type=click.IntRange(200, MAX_SIDE), default=720, show_default=True, help="Rows.")
@_voice
@click.pass_obj
def chart(talk: Talk, /, **options: Any) -> None:
    """Draw a chart of KIND: chromaticity, matching, rgb-matching, cones, illuminants, metamers, metals, checker, banding, gamma.

    \b
        limner chart chromaticity -o gamuts.svg --gamuts srgb,rec2020,acescg --plane uv
        limner chart illuminants -o lamps.png --lights A,D65,3200
        limner chart gamma -o gamma.png          look at it pixel by pixel, from afar; then
        limner chart gamma --grey 186            gamma 2.20
    """
    from .chart import Order, draw_chart

    order = Order(**options)
    if order.grey is not None and order.kind != "gamma":
        raise click.UsageError("--grey is the answer to the chart gamma")
    if order.output is None and order.grey is None:
        raise click.UsageError("nothing was asked for: give -o" + (", --grey or both" if order.kind == "gamma" else ""))
    _check_size(order.width, order.height)
    draw_chart(order, talk)


@limner.command(short_help="Make a picture of every model in a folder.")
@click.argument("folder")
@click.option("-o", "--output", required=True, metavar="FOLDER", help="For the pictures; is made where it is not there.")
@click.option("--size", type=click.IntRange(16, 4096), default=256, show_default=True, help="Width and height, pixels.")
@click.option("--recursive", is_flag=True, help="Look into sub-folders, too.")
@click.option("--update", is_flag=True, help="Keep pictures that are newer than their models.")
@click.option("--sheet", metavar="OUT", help="Put all of them on one contact sheet, too.")
@click.option("--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="How to see.")
@click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help="Samples in each pixel.  [default: the renderer's]")
@click.option("--background", type=BACKGROUND, help="transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).")
@click.option("--threads", type=click.IntRange(1, 1024), help="[default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Tell what became of each model as JSON on standard output.")
@_screen
@_model_up
@_voice
@click.pass_obj
def thumbnails(talk: Talk, /, **options: Any) -> None:
    """Make a picture of every model in FOLDER. One that fails is told of and does not stop the rest; the exit code is then 1.

    \b
        limner thumbnails models -o thumbs --recursive --update
        limner thumbnails models -o thumbs --size 512 --sheet index.png
    """
    from .thumbnails import Order, make_thumbnails

    make_thumbnails(Order(**options), talk)


@limner.command(short_help="Compile everything now instead of at the first picture.")
@_voice
@click.pass_obj
def warmup(talk: Talk) -> None:
    """Compile the renderers for this machine now, so that the first picture does not wait for it."""
    from .._door import cache_folder, warm_up
    from ..tiles import thread_count

    fresh = warm_up(talk.detail, thread_count(None))
    click.echo((f"{fresh} compiled, " if fresh else "") + f"everything is ready in {cache_folder()}")


def _one_background(background: Background | None, transparent: bool) -> Background | None:
    if transparent and background not in (None, "transparent"):
        raise click.UsageError("--transparent and --background say different things")
    return "transparent" if transparent else background


def _check_size(width: int, height: int) -> None:
    if width * height > MAX_PIXELS:
        raise click.UsageError(f"a picture must not exceed {MAX_PIXELS} pixels, got {width} x {height}")


def _check_camera(camera: str | None, eye: Triple | None, target: Triple | None, up: Triple | None, yfov: float | None) -> None:
    if camera is not None and eye is not None:
        raise click.UsageError("--camera and --eye exclude each other")
    for name, value in (("--target", target), ("--up", up), ("--yfov", yfov)):
        if value is not None and eye is None:
            raise click.UsageError(f"{name} needs --eye")
    if yfov is not None and not 0.0 < yfov < 180.0:
        raise click.UsageError(f"--yfov must lie between 0 and 180 degrees, got {yfov:g}")


def _check_yfov(yfov: float) -> None:
    if not 0.0 < yfov < 180.0:
        raise click.UsageError(f"--yfov must lie between 0 and 180 degrees, got {yfov:g}")
