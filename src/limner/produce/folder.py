"""The files of a data set: each whole or not there, and the same bytes for the same content."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, RenderError, SceneError

__all__ = ["check_folder", "json_bytes", "make_folders", "mask_png", "npz_bytes", "put"]

LISTING = "cameras.json"


def check_folder(folder: Path, plan: str, resume: bool) -> None:
    """Refuse a folder that cannot be written in, or that holds another data set; writes nothing.

    Parameters
    ----------
    folder : Path
        Need not be there.
    plan : str
        What the listing of a data set that is resumed must say.
    resume : bool
    """
    nearest = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    if not nearest.is_dir():
        raise RenderError(f"cannot write in {folder}: {nearest} is no folder")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise RenderError(f"cannot write in {folder}: no permission to write in {nearest}")
    listing = folder / LISTING
    if not listing.is_file():
        return
    if not resume:
        raise SceneError(f"{folder} holds a data set already: resume it, or choose another folder")
    try:
        found = json.loads(listing.read_bytes())["plan"]
    except (OSError, ValueError, KeyError, TypeError):
        raise FileFormatError("is not the list of a data set's cameras", listing) from None
    if found != plan:
        raise SceneError(f"{folder} was begun with other cameras, sizes, options or names: choose another folder")


def make_folders(folder: Path, names: Iterable[str]) -> None:
    """Make the folders that the given files stand in."""
    try:
        for name in names:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RenderError(f"cannot write in {folder}: {error.strerror or error}") from error


def put(place: Path, data: bytes) -> None:
    """Write a file whole or not at all: under another name first, then moved into its place."""
    part = place.with_name(f".{place.name}.{os.urandom(6).hex()}.part")
    try:
        part.write_bytes(data)
        os.replace(part, place)
    except OSError as error:
        raise RenderError(f"cannot write {place}: {error.strerror or error}") from error
    finally:  # an interrupt, too, must leave nothing behind
        with suppress(OSError):
            part.unlink(missing_ok=True)


def json_bytes(document: Mapping[str, Any]) -> bytes:
    """JSON in ASCII, keys sorted, a line for each thing that is listed; NumPy's numbers as numbers."""
    members = ",\n".join(f"{_line(key)}: {_lines(document[key])}" for key in sorted(document))
    return f"{{\n{members}\n}}\n".encode("ascii")


def _lines(value: Any) -> str:
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(_line(item) for item in value) + "\n]"
    return _line(value)


def _line(value: Any) -> str:
    return json.dumps(value, sort_keys=True, allow_nan=False, default=_plain)


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else repr(value)


def npz_bytes(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Compressed arrays by name. NumPy's archives have no dates, so the same arrays are the same bytes."""
    made = io.BytesIO()
    np.savez_compressed(made, **{name: arrays[name] for name in sorted(arrays)})  # type: ignore[arg-type]
    return made.getvalue()


def mask_png(ids: NDArray[np.int32]) -> bytes:
    """Ids as a gray PNG of 16 bits: 0 for nothing, else 1 + id."""
    from PIL import Image as Picture

    made = io.BytesIO()
    Picture.fromarray((ids + 1).astype(np.uint16)).save(made, "PNG")
    return made.getvalue()
