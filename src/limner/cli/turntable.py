"""`limner turntable`: a model turned once round, as a clip or a folder of pictures."""

from __future__ import annotations

from dataclasses import dataclass

from .bar import Bar
from .clips import checked_kind, close, scene_of
from .talk import Talk
from .values import Background

__all__ = ["Order", "make_turntable"]


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.write_turntable`."""

    model: str
    output: str
    frames: int
    fps: float
    elevation: float
    azimuth: float
    yfov: float
    width: int
    height: int
    renderer: str
    samples: int | None
    seed: int
    lights: str
    environment: str | None
    ground: bool
    background: Background | None
    quality: int | None
    threads: int | None
    as_json: bool
    view: str
    exposure: float


def make_turntable(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    kind = checked_kind(order, order.frames)
    scene = scene_of(order, kind, talk)

    from ..produce.turntable import write_turntable

    with Bar(enabled=not talk.quiet) as bar:
        clip = write_turntable(
            scene,
            order.output,
            order.frames,
            fps=order.fps,
            quality=order.quality,
            view=order.view,
            exposure=order.exposure,
            elevation_degrees=order.elevation,
            azimuth_degrees=order.azimuth,
            yfov_degrees=order.yfov,
            width=order.width,
            height=order.height,
            renderer=order.renderer,
            samples=order.samples,
            seed=order.seed,
            lights=order.lights,
            threads=order.threads,
            on_progress=bar,
        )
    close(order, clip, f" of {order.frames}", talk)
