"""What a long picture leaves on the disk now and then, so that a process that is killed has not worked in vain.

A checkpoint holds the film's sums between two passes and how many samples are in them. Samples are a pure function of the picture's seed
and place, and all of a pixel are added in their order, so the picture that is gone on with has the bits of one that never stopped. The file
is written under another name and moved into place: there is always a whole one.
"""

from __future__ import annotations

import os
import zipfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import FileFormatError, RenderError

__all__ = ["State", "read_checkpoint", "write_checkpoint"]


class State(NamedTuple):
    """A picture between two passes.

    Attributes
    ----------
    samples : int
        That every part of the film has which is not settled.
    sums : (height, width, 4) float32
    taken : (n,) int64
        Samples of each part.
    half : (height, width, 3) float32
        The sums when noise was last looked at.
    settled : (n,) bool
        Parts that need no more samples.
    """

    samples: int
    sums: NDArray[np.float32]
    taken: NDArray[np.int64]
    half: NDArray[np.float32]
    settled: NDArray[np.bool_]


def write_checkpoint(path: str | os.PathLike[str], key: str, state: State) -> None:
    """Write a state, whole or not at all; `key` says of which picture it is."""
    target = Path(path)
    part = target.with_name(f".{target.name[:100]}.part")
    try:
        with part.open("wb") as file:
            np.savez(
                file, key=np.array(key), samples=np.array(state.samples), sums=state.sums, taken=state.taken, half=state.half,
                settled=state.settled,
            )  # fmt: skip
        os.replace(part, target)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise RenderError(f"cannot write the checkpoint {os.fspath(path)}: {error.strerror or error}") from None


def read_checkpoint(path: str | os.PathLike[str], key: str) -> State | None:
    """The state that was written last, or None where there is no file.

    Raises FileFormatError where the file is no checkpoint, and RenderError where it is of another picture.
    """
    name = os.fspath(path)
    try:
        with Path(path).open("rb") as file, np.load(file) as held:
            found, fields = str(held["key"]), {field: held[field] for field in State._fields}
    except FileNotFoundError:
        return None
    except OSError as error:
        raise RenderError(f"cannot read the checkpoint {name}: {error.strerror or error}") from None
    except (KeyError, ValueError, EOFError, zipfile.BadZipFile):
        raise FileFormatError("is no checkpoint of a picture", path) from None
    if found != key:
        raise RenderError(f"cannot go on from {name}: it is of another picture; give the same scene, camera and settings, or remove it")
    return State(int(fields.pop("samples")), **fields)
