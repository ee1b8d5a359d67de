"""Published tables, as they were printed: text files with their source on top, read once.

Each file of `data/` opens with lines of ``#`` that say what it holds, who published it and what was changed; then the names of the columns,
then the numbers with as many digits as the source has.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Table", "published", "read_rows"]

_FOLDER = Path(__file__).parent / "data"


class Table(NamedTuple):
    """Columns by name over wavelengths."""

    wavelengths: NDArray[np.float64]  # (n,), nm
    names: tuple[str, ...]  # of the other columns
    values: NDArray[np.float64]  # (n, columns)


def read_rows(name: str) -> list[list[str]]:
    """The rows of a file of `data/` as words, the names of its columns first; what explains it left out."""
    text = (_FOLDER / f"{name}.csv").read_text(encoding="utf-8")
    return [line.split(",") for line in text.splitlines() if not line.startswith("#")]


@cache
def published(name: str) -> Table:
    """A table over wavelengths, by the name of its file.

    >>> table = published("cie_1931_2")
    >>> table.names, table.wavelengths[[0, -1]].tolist()
    (('x', 'y', 'z'), [360.0, 830.0])
    """
    names, *rows = read_rows(name)
    numbers = np.array(rows, dtype=np.float64)
    wavelengths, values = np.ascontiguousarray(numbers[:, 0]), np.ascontiguousarray(numbers[:, 1:])
    wavelengths.flags.writeable = values.flags.writeable = False
    return Table(wavelengths, tuple(names[1:]), values)
