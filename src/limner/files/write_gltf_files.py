"""Several files that belong together, written so that there is never half of them.

Each is written under another name beside its place; only when all are whole are they moved into place, the one that names the others
last.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from ..errors import RenderError

__all__ = ["File", "check_place", "put_whole"]

Bytes = bytes | memoryview


class File(NamedTuple):
    """A file that is to be: where, and what gives its bytes."""

    path: Path
    chunks: Callable[[], Iterable[Bytes]]


def check_place(path: Path) -> None:
    """Refuse a place where no file can be, before any work is done for it; RenderError."""
    if path.is_dir():
        raise RenderError(f"cannot write {path}: it is a folder")
    folder = Path(os.path.realpath(path)).parent
    if not folder.is_dir():
        raise RenderError(f"cannot write {path}: there is no folder {path.parent}")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RenderError(f"cannot write {path}: no permission to write in {path.parent}")


def put_whole(files: list[File]) -> None:
    """Write all files or none.

    Raises RenderError where one cannot be written; what was there before is still there.
    """
    parts: list[tuple[Path, Path]] = []
    blamed = files[-1].path
    try:
        for file in files:
            blamed = file.path
            parts.append(_part_of(file.path))
            _write(file, *parts[-1])
        for file, (part, place) in zip(files, parts, strict=True):
            blamed = file.path
            os.replace(part, place)
    except OSError as error:
        raise RenderError(f"cannot write {blamed}: {error.strerror or error}") from error
    finally:
        # What was moved is no longer there; what an interrupt left behind must not stay.
        for part, _ in parts:
            with suppress(OSError):
                part.unlink(missing_ok=True)


def _part_of(path: Path) -> tuple[Path, Path]:
    """Where a file is written first, and where it goes; through a link, to what that names."""
    place = Path(os.path.realpath(path))
    return place.with_name(f".{place.name[:100]}.{os.urandom(6).hex()}.part"), place


def _write(file: File, part: Path, place: Path) -> None:
    with open(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666), "wb") as stream:
        if place.is_file():
            part.chmod(stat.S_IMODE(place.stat().st_mode))
        for chunk in file.chunks():
            stream.write(chunk)
