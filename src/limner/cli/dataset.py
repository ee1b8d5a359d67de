"""`limner dataset`: a model from all around, with channels, masks and annotations, in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from .bar import Bar
from .main import INTERRUPTED
from .model import open_model
from .talk import Talk
from .values import Background

if TYPE_CHECKING:
    from ..produce.dataset import Written

__all__ = ["Order", "make_dataset"]


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


def make_dataset(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    from ..produce.dataset import orbit_cameras, write

    scene = open_model(order.model)
    if order.environment is not None:
        from ..scene.environment import Environment

        scene = scene.replace(environment=Environment(order.environment))
    if order.background is not None:
        scene = scene.replace(background=None if order.background == "transparent" else order.background)
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
