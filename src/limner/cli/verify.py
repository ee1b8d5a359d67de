"""`limner verify`: make a picture again from its own recipe, and say whether the bits agree."""

from __future__ import annotations

import math

import click

from .bar import Bar
from .talk import Talk, flattened

__all__ = ["verify"]

_DIFFERENT = 1


def verify(picture: str, model: str | None, threads: int | None, as_json: bool, talk: Talk) -> None:
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
