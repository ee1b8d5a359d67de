"""`limner verify`: make a picture again from its own recipe, and say whether the bits agree."""

from __future__ import annotations

import math

import click

from .bar import Bar
from .options import as_json, threads
from .talk import Talk, flattened
from .voice import voice

__all__ = ["verify"]

_DIFFERENT = 1


@click.command(short_help="Make a picture again from its recipe; do the bits agree?")
@click.argument("picture")
@click.option("--model", metavar="MODEL", help="What it is a picture of, where its recipe does not say or it has moved.")
@threads()
@as_json()
@voice
@click.pass_obj
def verify(talk: Talk, picture: str, model: str | None, threads: int | None, as_json: bool) -> None:
    """Make PICTURE again from the recipe in it, and say whether the bits agree: code 0 if so, 1 if not.

    \b
        limner verify teapot.png
        limner verify old.exr --model ../models/car.glb
    """

    _verify(picture, model, threads, as_json, talk)


def _verify(picture: str, model: str | None, threads: int | None, as_json: bool, talk: Talk) -> None:
    """Render again, compare, tell; the code is 1 where a bit differs."""
    from ..produce.again import verify as verified

    with Bar(enabled=not talk.quiet) as bar:
        found = verified(picture, model, threads=threads, on_progress=bar)
    if as_json:
        import json

        furthest = found.max_difference if math.isfinite(found.max_difference) else None
        told = {**found._asdict(), "picture": picture, "reasons": list(found.reasons), "max_difference": furthest}
        click.echo(json.dumps(told, sort_keys=True))
    elif not talk.quiet:
        if found.agrees:
            click.echo(flattened(f"{picture}: the same to the bit"))
        else:
            how_far = f", by up to {found.max_difference:.3g}" if math.isfinite(found.max_difference) else ""
            click.echo(flattened(f"{picture}: {found.n_different} pixels differ{how_far}"))
    for reason in found.reasons:
        talk.say("note", reason)
    if not found.agrees:
        talk.code = _DIFFERENT
