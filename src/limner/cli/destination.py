"""Where a result goes, looked at before anything is computed for it: a folder that is not there, a format that nobody writes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import LimnerError, UnsupportedError

if TYPE_CHECKING:
    from ..draw.canvas import Canvas

__all__ = ["check_canvas", "check_picture", "put_canvas"]


def check_picture(output: str, **how: Any) -> None:
    """Refuse a picture that cannot be written; `how` it is to be is what `Image.save` is told."""
    from ..image.save import check_destination

    try:
        check_destination(output, **how)
    except LimnerError as error:
        raise click.UsageError(str(error)) from error


def check_canvas(output: str) -> bool:
    """Refuse a drawing that cannot be written; return whether it is to be SVG."""
    from ..image.save import check_destination

    as_svg = Path(output).suffix.lower() == ".svg"
    try:
        # The same questions of its folder as for any picture.
        check_destination(f"{output[:-4]}.png" if as_svg and not Path(output).is_dir() else output)
    except UnsupportedError as error:
        raise click.UsageError(f"{error}, or .svg") from error
    except LimnerError as error:
        raise click.UsageError(str(error)) from error
    return as_svg


def put_canvas(canvas: Canvas, output: str, as_svg: bool) -> None:
    """Write a drawing as vectors or as a picture."""
    if not as_svg:
        canvas.image().save(output)
        return
    from ..produce.folder import put

    put(Path(os.path.realpath(output)), canvas.svg().encode())
