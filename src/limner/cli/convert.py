"""`limner convert`: a picture in another format, of another size, with other bits, or as a printer's dots; or a model in another format."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .destination import check_picture
from .model import model_up, open_model
from .options import MAX_SIDE, seed, weights
from .screen import screen
from .talk import Talk
from .voice import voice

if TYPE_CHECKING:
    from ..image.image import Image

__all__ = ["MODELS", "convert"]

MODELS = (".glb", ".gltf", ".yaml", ".yml", ".limner", ".obj", ".ply", ".stl")
"""What models are saved as."""


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: as it is."""

    source: str
    output: str
    width: int | None
    height: int | None
    filter: str
    bits: int | None
    dither: str | None
    seed: int
    dpi: float | None
    halftone: float | None
    angle: float
    shape: str
    view: str = "standard"
    exposure: float = 0.0


@click.command(short_help="Write a picture in another format, size or number of bits, or as a printer's dots.")
@click.argument("source", metavar="PICTURE")
@click.argument("output", metavar="OUT")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), help="Columns.  [default: as --height has it]")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), help="Rows.  [default: as --width has it]")
@weights("mitchell", "How pixels are made of others.")
@click.option("--bits", type=click.Choice([1, 8, 16, 32]), help="Of each channel: PNG 1, 8, 16; EXR 16, 32.")
@click.option(
    "--dither", type=click.Choice(["ordered", "blue_noise", "random", "floyd_steinberg"]), help="How rounding is spread.",
)  # fmt: skip
@seed("For --dither.")
@click.option("--dpi", type=click.FloatRange(0.0, min_open=True), help="Pixels per inch on paper.")
@click.option(
    "--halftone", type=click.FloatRange(0.0, min_open=True), metavar="LPI", help="Screen it for a printer of --dpi: lines per inch.",
)  # fmt: skip
@click.option("--angle", type=float, default=45.0, show_default=True, help="Of the screen, degrees.")
@click.option("--shape", type=click.Choice(["round", "diamond", "line"]), default="round", show_default=True, help="Of the screen's dots.")
@screen
@model_up
@voice
@click.pass_obj
def convert(talk: Talk, /, **options: Any) -> None:
    """Write PICTURE to OUT, whose extension says the format; - is a PNG on standard output.

    \b
        limner convert render.exr small.png --width 640
        limner convert photo.jpg print.png --width 2400 --dpi 600 --halftone 75
        limner convert chair.glb chair.stl

    Where OUT is .obj, .ply or .stl, PICTURE is a model, and is written as it stands in the world.
    """

    _convert(Order(**options), talk)


def _convert(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    if Path(order.output).suffix.lower() in MODELS:
        _convert_model(order, talk)
        return
    check_picture(order.output, view=order.view, exposure=order.exposure)
    from dataclasses import replace

    from ..files.open_image import open_image
    from ..image.save import keeps_aovs
    from ..produce.again import moved

    image = open_image(order.source)
    image = replace(image, recipe=moved(image.recipe, order.source, order.output))
    beside = sorted(image.aov)
    if order.width is not None or order.height is not None:
        image = image.resized(*_size(order, image), order.filter)
    bits, view, exposure = order.bits, order.view, order.exposure
    if order.halftone is not None:
        image, view, exposure = _screened(order, image.viewed(view, exposure)), "standard", 0.0
        bits = bits or (1 if order.output.lower().endswith(".png") or order.output == "-" else None)
    if beside and not (image.aov and keeps_aovs(order.output)):
        talk.say("note", f"what lies beside the picture is left out: {', '.join(beside)}")
    image.save(order.output, bits=bits, dither=order.dither, dpi=order.dpi, seed=order.seed, view=view, exposure=exposure)
    dpi = order.dpi or image.dpi
    if dpi is not None:
        width, height = image.print_size(dpi)
        talk.detail(f"{image.width} x {image.height} pixels, on paper {width:.1f} x {height:.1f} mm at {dpi:g} dpi")


def _convert_model(order: Order, talk: Talk) -> None:
    """Save a model in another format; but for glTF, what is in it stands in the world."""
    beside = [name for name in ("width", "height", "bits", "dither", "dpi", "halftone") if getattr(order, name) is not None]
    if beside:
        raise click.UsageError(f"--{beside[0]} is for pictures, but {order.output} is a model")
    from ..files.save_mesh import save_model

    scene = open_model(order.source)
    talk.note(scene.notes)
    talk.note(save_model(scene, order.output))


def _size(order: Order, image: Image) -> tuple[int, int]:
    """Width and height; the one that is not given keeps the picture's shape."""
    if order.width is not None and order.height is not None:
        return order.width, order.height
    if order.width is not None:
        return order.width, max(1, round(image.height * order.width / image.width))
    assert order.height is not None
    return max(1, round(image.width * order.height / image.height)), order.height


def _screened(order: Order, image: Image) -> Image:
    dpi = order.dpi or image.dpi
    if dpi is None:
        raise click.UsageError("--halftone needs the printer's --dpi; the picture does not say it")
    return image.halftoned(dpi, order.halftone or 75.0, order.angle, order.shape)
