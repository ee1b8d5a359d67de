"""The work of `limner render`: look before it begins, make the picture, save what there is, tell about it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from .bar import Bar
from .destination import check_picture
from .main import INTERRUPTED
from .model import open_model, report_of_model, said_up
from .talk import Talk

if TYPE_CHECKING:
    from ..files.report import LoadReport
    from ..image.image import Image
    from ..scene.scene import Scene
    from .render import Order

__all__ = ["make_picture"]


def make_picture(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    if order.renderer == "lines":
        from .draw import draw_picture

        draw_picture(order, talk)
        return
    _check_output(order)
    started = time.perf_counter()
    report = report_of_model(order.model, scene=order.scene) if order.report else None
    scene, camera, key = order.shown(open_model(order.model, None, order.scene) if report is None else report.scene)
    if report is None:
        talk.note(scene.notes)
    else:
        for line in report.lines():
            talk.say("report", line)
    loaded = time.perf_counter()

    make, styled = _maker(order)
    with Bar(enabled=not talk.quiet) as bar:
        image = make(
            scene,
            camera=camera,
            threads=order.threads,
            aovs=order.aovs,
            denoise=order.denoise,
            on_progress=bar,
            **styled,
            **_budget(order),
            **order.settings(),
        )
    rendered = time.perf_counter()
    talk.warn(image.warnings)
    if not styled:
        image = _with_origin(image, order)
    if key is not None:
        from ..draw.color_bar import with_color_bar

        image = with_color_bar(image, key)
    image.save(order.output, view=order.view, exposure=order.exposure, color_space=order.color_space)
    saved = time.perf_counter()

    seconds = {"load": loaded - started, "render": rendered - loaded, "save": saved - rendered}
    talk.detail(", ".join(f"{step} {spent:.3f} s" for step, spent in seconds.items()))
    if order.time_limit is not None and image.finished:
        talk.say("samples", f"{image.recipe['samples']}; --samples {image.recipe['samples']} makes the same picture again")
    if not image.finished:
        talk.say("interrupted", f"the picture so far is in {order.output}")
        talk.code = INTERRUPTED
    if order.as_json:
        _tell(order, scene, image, seconds, report)


def _maker(order: Order) -> tuple[Callable[..., Image], dict[str, Any]]:
    """What makes the picture, and what it is told beside what every picture is told."""
    from ..render import render

    if order.style is None and not order.lines:
        return render, {}
    from ..produce.stylized import stylized

    return stylized, {"style": order.style, "lines": order.lines}


def _budget(order: Order) -> dict[str, Any]:
    """What `limner.render` is told of when to stop, and of what to keep meanwhile."""
    told: dict[str, Any] = {"noise": order.noise, "time_limit": order.time_limit}
    if order.snapshots is None and not order.resume:
        return told
    if order.output == "-":
        raise click.UsageError("--snapshots and --resume need a file to write to, got -o -")
    told |= {"checkpoint": f"{order.output}.checkpoint", "resume": order.resume}
    if order.snapshots is not None:
        told |= {"checkpoint_seconds": order.snapshots, "on_snapshot": lambda image: image.save(order.output)}
    return told


def _with_origin(image: Image, order: Order) -> Image:
    """Let the recipe say where the model is: `limner verify` needs no more."""
    from dataclasses import replace

    from ..image.recipe import Recipe
    from ..produce.again import origin

    if said_up() != "y" or order.scalars is not None or order.point_size is not None:
        return image  # a recipe does not say these: of what model the picture is has to be named then
    told = origin(
        order.model, order.output, environment=order.environment, ground=order.ground, background=order.background
    )
    recipe = image.recipe if isinstance(image.recipe, Recipe) else Recipe(image.recipe)
    return replace(image, recipe=recipe.with_values(**told))


def _check_output(order: Order) -> None:
    """Refuse an output that cannot be written before anything is computed for it."""
    check_picture(order.output, view=order.view, exposure=order.exposure, color_space=order.color_space)
    from ..image.save import keeps_aovs

    if order.aovs and not keeps_aovs(order.output):
        raise click.UsageError(f"--aov needs an output that can hold more than a picture (.exr), got {order.output}")
    if order.output == "-":
        import sys

        if sys.stdout.isatty():
            raise click.UsageError("-o - would write a PNG to the terminal; send it to a file or a pipe")


def _tell(order: Order, scene: Scene, image: Image, seconds: dict[str, float], report: LoadReport | None) -> None:
    import json

    told: dict[str, Any] = {
        "output": order.output,
        "width": image.width,
        "height": image.height,
        "finished": image.finished,
        "seconds": {step: round(spent, 6) for step, spent in seconds.items()},
        "aovs": sorted(image.aov),
        "id_names": {name: list(names) for name, names in image.id_names.items()},
        "notes": list(scene.notes),
        "warnings": list(image.warnings),
        "recipe": dict(image.recipe),
        **({} if report is None else {"report": report.as_dict()}),
    }
    click.echo(json.dumps(told, sort_keys=True))
