"""`limner schema`: what may stand in a scene file, for editors."""

from __future__ import annotations

import click

from .voice import voice

__all__ = ["schema"]


@click.command(short_help="Show what may stand in a scene file, as JSON Schema.")
@voice
def schema() -> None:
    """Write the JSON Schema of limner's scene files to standard output.

    \b
        limner schema > limner.schema.json

    Editors complete and check a scene.yaml that begins with

    \b
        # yaml-language-server: $schema=limner.schema.json
    """
    import json

    from ..files.scene_file import schema as scene_schema

    click.echo(json.dumps(scene_schema(), indent=2))
