"""Options that several commands have, each declared once.

    @click.command()
    @click.argument("model")
    @size(640, 480)
    @sight
    def draw(...): ...

An option is a decorator with its own name; `sight`, `place` and `size` are several, which are in the help in the order that they have here.
What can be said of a command line as a whole (two options that exclude each other) is checked here, too, before any work begins.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from .values import BACKGROUND, TRIPLE, Background

__all__ = [
    "MAX_PIXELS", "MAX_SAMPLES", "MAX_SEED", "MAX_SIDE", "RENDERERS", "as_json", "background", "camera", "check_outlets", "check_paper",
    "check_size", "check_yfov", "clip_output", "crease", "environment", "ground", "max_depth", "orbit", "paper", "place",
    "quality", "renderer", "report", "samples", "seed", "sight", "size", "threads", "together", "weights",
]  # fmt: skip

MAX_SIDE = 32768
MAX_PIXELS = 1 << 26
MAX_SAMPLES = 1 << 20
MAX_SEED = (1 << 31) - 1
RENDERERS = ("raster", "ray", "path")
FILTERS = ("box", "tent", "gaussian", "mitchell", "lanczos3")

Command = Callable[..., Any]
Option = Callable[[Command], Command]


def together(*options: Option) -> Option:
    """Several options as one, in the order in which the help shows them."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


# --- how a picture is made ------------------------------------------------------------------------------------------------


def size(width: int, height: int, least: int = 1) -> Option:
    """`--width` and `--height`, with their defaults."""
    sides = click.IntRange(least, MAX_SIDE)
    return together(
        click.option("--width", type=sides, default=width, show_default=True, help="Columns."),
        click.option("--height", type=sides, default=height, show_default=True, help="Rows."),
    )


def renderer(text: str = "How to see.") -> Option:
    """`--renderer`: one of those that shade."""
    return click.option("--renderer", type=click.Choice(RENDERERS), default="raster", show_default=True, help=text)


def samples(text: str = "Samples in each pixel.  [default: the renderer's]") -> Option:
    """`--samples`; None: as many as the renderer thinks fit."""
    return click.option("--samples", type=click.IntRange(1, MAX_SAMPLES), help=text)


def seed(text: str = "What random numbers begin with.") -> Option:
    """`--seed`."""
    return click.option("--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help=text)


def weights(default: str, text: str) -> Option:
    """`--filter`: how what lies around a pixel is weighed."""
    return click.option("--filter", type=click.Choice(FILTERS), default=default, show_default=True, help=text)


def threads(text: str = "[default: all cores]") -> Option:
    """`--threads`."""
    return click.option("--threads", type=click.IntRange(1, 1024), help=text)


max_depth = click.option(
    "--max-depth", type=click.IntRange(0, 1000), default=8, show_default=True, help="How often light is reflected at most.",
)  # fmt: skip

# --- where the eye is -----------------------------------------------------------------------------------------------------


def camera(text: str, names: str = "NAME|INDEX|frame") -> Option:
    """`--camera`: one of the model's."""
    return click.option("--camera", metavar=names, help=text)


place = together(
    click.option("--eye", type=TRIPLE, help="Where the eye stands, instead of a camera of the model."),
    click.option("--target", type=TRIPLE, help="What it looks at.  [default: the middle of the model]"),
    click.option("--up", type=TRIPLE, help="What is held upright.  [default: 0,1,0]"),
    click.option("--yfov", type=float, metavar="DEG", help="The full vertical field of view, degrees.  [default: 40]"),
)
sight = together(camera("A camera of the model, by name or number from 0; frame: one that shows all."), place)


def orbit(azimuth: float, of_which: str, yfov: float) -> Option:
    """`--elevation`, `--azimuth` and `--yfov` of an eye that goes round the model; the azimuth is that `of_which` picture."""
    half_turn = click.FloatRange(-90.0, 90.0)
    return together(
        click.option("--elevation", type=half_turn, default=20.0, show_default=True, help="Above the horizon, degrees."),
        click.option("--azimuth", type=float, default=azimuth, show_default=True, help=f"Of the first {of_which}, from +z to +x, degrees."),
        click.option("--yfov", type=float, default=yfov, show_default=True, help="The full vertical field of view, degrees."),
    )


# --- the model and what is round it ----------------------------------------------------------------------------------------------

environment = click.option("--environment", metavar="FILE", help="A sky to light the scene with (.hdr, .exr), equirectangular.")
ground = click.option("--ground", is_flag=True, help="Put a ground under the model that shows its shadow (ray, path).")
background = click.option(
    "--background", type=BACKGROUND, help="environment, transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light).",
)  # fmt: skip
paper = click.option(
    "--background", type=BACKGROUND, default="white", show_default=True, help="transparent, white, gray, #RRGGBB or R,G,B.",
)  # fmt: skip

# --- lines ----------------------------------------------------------------------------------------------------------------


def crease(text: str) -> Option:
    """`--crease`: from which angle on an edge is one."""
    return click.option("--crease", type=click.FloatRange(0.0, 180.0), default=30.0, show_default=True, metavar="DEG", help=text)


# --- what comes out -------------------------------------------------------------------------------------------------------

clip_output = click.option(
    "-o", "--output", required=True, metavar="CLIP",
    help=".gif, .webp, .png (animated), .mp4 (needs the extra video), or a folder for PNGs.",
)  # fmt: skip
quality = click.option(
    "--quality", type=click.IntRange(1, 100), help="Of WebP and MP4.  [default: WebP without loss, MP4 as good as it looks]",
)  # fmt: skip
report = click.option("--report", is_flag=True, help="Tell what of the file was read, approximated, ignored, replaced or repaired.")


def as_json(text: str = "As JSON.") -> Option:
    """`--json`."""
    return click.option("--json", "as_json", is_flag=True, help=text)


# --- what does not go together --------------------------------------------------------------------------------------------


def check_size(width: int, height: int) -> None:
    """Refuse more pixels than a picture can have."""
    if width * height > MAX_PIXELS:
        raise click.UsageError(f"a picture must not exceed {MAX_PIXELS} pixels, got {width} x {height}")


def check_yfov(yfov: float) -> None:
    """Refuse a field of view that no plane can show."""
    if not 0.0 < yfov < 180.0:
        raise click.UsageError(f"--yfov must lie between 0 and 180 degrees, got {yfov:g}")


def check_outlets(output: str | None, as_json: bool) -> None:
    """Refuse work of which nothing would be seen, or of which two results would be mixed on standard output."""
    if output is None and not as_json:
        raise click.UsageError("nothing was asked for: give -o, --json or both")
    if output == "-" and as_json:
        raise click.UsageError("--json and -o - both want standard output")


def check_paper(background: Background | None) -> None:
    """Refuse an environment as the background of lines on paper."""
    if background == "environment":
        raise click.UsageError("--background environment makes no sense here: transparent, a name, #RRGGBB or R,G,B")
