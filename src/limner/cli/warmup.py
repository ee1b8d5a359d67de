"""`limner warmup`: what pictures wait for the first time, done beforehand."""

from __future__ import annotations

import click

from .talk import Talk
from .voice import voice

__all__ = ["warmup"]


@click.command(short_help="Compile everything now instead of at the first picture.")
@voice
@click.pass_obj
def warmup(talk: Talk) -> None:
    """Compile the renderers for this machine now, so that the first picture does not wait for it."""
    from .._door import cache_folder, warm_up
    from ..tiles import thread_count

    fresh = warm_up(talk.detail, thread_count(None))
    click.echo((f"{fresh} compiled, " if fresh else "") + f"everything is ready in {cache_folder()}")
