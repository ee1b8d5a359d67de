"""`limner dataset`: a model from all around, with channels, masks and annotations, in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from .bar import Bar
from .main import INTERRUPTED
from .model import model_up, open_model
from .options import as_json, background, check_size, check_yfov, environment, orbit, renderer, samples, seed, size, threads
from .surroundings import surrounded
from .talk import Talk
from .values import WORDS, Background
from .voice import voice

if TYPE_CHECKING:
    from ..produce.dataset import Written

__all__ = ["dataset"]

_MAX_VIEWS = 1_000_000


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.dataset.write`."""

    model: str
    output: str
    views: int
    elevation: float
    azimuth: float
    yfov: float
    width: int
    height: int
    renderer: str
    samples: int | None
    seed: int
    aovs: tuple[str, ...]
    masks: str | None
    annotations: str
    environment: str | None
    background: Background | None
    resume: bool
    threads: int | None
    as_json: bool


@click.command(short_help="Make a data set: a model from all around, with depth, normals, masks, cameras.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="FOLDER", help="Is made where it is not there.")
@click.option("--views", type=click.IntRange(1, _MAX_VIEWS), default=36, show_default=True, help="In equal steps of a full turn.")
@orbit(0.0, "view", 40.0)
@size(640, 480)
@renderer()
@samples()
@seed()
@click.option("--aov", "aovs", type=WORDS, default="depth,normal,instance_id", show_default=True, help="To keep as arrays (.npz).")
@click.option("--masks", type=click.Choice(["instance", "material"]), help="Write PNGs of 16 bits: 0 for nothing, else 1 + id.")
@click.option(
    "--annotations", type=click.Choice(["instance", "material", "none"]), default="instance", show_default=True,
    help="Categories of annotations.json (COCO).",
)  # fmt: skip
@environment
@background
@click.option("--resume", is_flag=True, help="Go on with what is in the folder.")
@threads()
@as_json("Tell about the data set as JSON on standard output.")
@model_up
@voice
@click.pass_obj
def dataset(talk: Talk, /, **options: Any) -> None:
    """Make a data set of MODEL: pictures from all around, arrays, masks, and the cameras in OpenCV's and OpenGL's words.

    \b
        limner dataset model.glb -o views --views 72 --elevation 30
        limner dataset model.glb -o views --aov depth,position --masks material --background white

    Ctrl-C stops early; what is finished is a data set, and --resume goes on with it.
    """
    order = Order(**options)
    check_size(order.width, order.height)
    check_yfov(order.yfov)
    _make_dataset(order, talk)


def _make_dataset(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    from ..produce.dataset import orbit_cameras, write

    scene = surrounded(open_model(order.model), order.environment, order.background)
    talk.note(scene.notes)
    cameras = orbit_cameras(
        scene,
        order.views,
        elevation_degrees=order.elevation,
        azimuth_degrees=order.azimuth,
        yfov_degrees=order.yfov,
        aspect=order.width / order.height,
    )
    with Bar(enabled=not talk.quiet) as bar:
        written = write(
            scene,
            cameras,
            order.output,
            width=order.width,
            height=order.height,
            renderer=order.renderer,
            samples=order.samples,
            seed=order.seed,
            aovs=order.aovs,
            masks=order.masks,
            annotations=None if order.annotations == "none" else order.annotations,
            resume=order.resume,
            threads=order.threads,
            on_progress=bar,
        )
    talk.warn(written.warnings)
    if not written.finished:
        talk.say("interrupted", f"{written.n_views} of {order.views} views are in {order.output}; --resume goes on")
        talk.code = INTERRUPTED
    if order.as_json:
        _tell(order, written)


def _tell(order: Order, written: Written) -> None:
    import json

    told: dict[str, Any] = {
        "output": order.output,
        "views": written.n_views,
        "rendered": written.n_rendered,
        "finished": written.finished,
        "warnings": list(written.warnings),
    }
    click.echo(json.dumps(told, sort_keys=True))
