"""`limner doctor`: why is the picture black, empty, faceted, inside out?"""

from __future__ import annotations

from typing import Any

import click

from .model import model_up
from .talk import Talk, flattened
from .voice import voice

__all__ = ["doctor"]

_MAX_SAMPLES = 1 << 20


@click.command(short_help="Tell why a picture is black, empty, dark, noisy, faceted or inside out, and what to do.")
@click.argument("model")
@click.option(
    "--renderer", type=click.Choice(["raster", "ray", "path"]), default="raster", show_default=True, help="By which it is to be seen.",
)  # fmt: skip
@click.option("--samples", type=click.IntRange(1, _MAX_SAMPLES), help="Measure the noise that so many samples leave (path).")
@click.option("--environment", metavar="FILE", help="A sky to light the scene with (.hdr, .exr), equirectangular.")
@click.option("--no-picture", is_flag=True, help="Look at the description only: draw nothing.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@model_up
@voice
@click.pass_obj
def doctor(talk: Talk, /, **options: Any) -> None:
    """Tell what is wrong with MODEL: what, where, why it matters, and what to do.

    \b
        limner doctor model.glb
        limner doctor room.yaml --renderer path --samples 64
        limner doctor scan.ply --json

    The exit code is 0 whatever is found.
    """
    from ..explain.doctor import doctor as examine
    from .model import open_model

    scene = open_model(options["model"])
    if options["environment"] is not None:
        from ..scene.environment import Environment

        scene = scene.replace(environment=Environment(options["environment"]))
    found = examine(scene, renderer=options["renderer"], samples=options["samples"], picture=not options["no_picture"])
    if options["as_json"]:
        import json

        click.echo(json.dumps({"model": options["model"], **found.as_dict()}, sort_keys=True))
        return
    click.echo(flattened(options["model"]))
    if found.is_sound:
        click.echo("  nothing is wrong")
    for finding in found.findings:
        place = f" ({finding.where})" if finding.where else ""
        click.echo(f"  {flattened(finding.what + place)}")
        click.echo(f"      why: {flattened(finding.why)}")
        click.echo(f"      do:  {flattened(finding.do)}")
