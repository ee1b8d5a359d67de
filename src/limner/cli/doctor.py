"""`limner doctor`: why is the picture black, empty, faceted, inside out?"""

from __future__ import annotations

from typing import Any

import click

from .model import model_up, open_model
from .options import as_json, environment, renderer, samples
from .surroundings import surrounded
from .talk import Talk, flattened
from .voice import voice

__all__ = ["doctor"]


@click.command(short_help="Tell why a picture is black, empty, dark, noisy, faceted or inside out, and what to do.")
@click.argument("model")
@renderer("By which it is to be seen.")
@samples("Measure the noise that so many samples leave (path).")
@environment
@click.option("--no-picture", is_flag=True, help="Look at the description only: draw nothing.")
@as_json()
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

    scene = open_model(options["model"])
    scene = surrounded(scene, options["environment"])
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
