"""What kernels work with, as plain values that JSON can hold and people can read, to the bit.

A float32 becomes the shortest decimal number that is read as the same float32 again. Of eight lanes the last ones repeat each other where
there are fewer than eight of anything, so what repeats at the end is left out. Rows of tables become what the scene calls them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Names", "is_lanes", "plain", "shortest", "text_of"]


_MACHINERY = {"detail", "bulge", "reach", "bitangent_sign", "dodx", "dody", "dddx", "dddy", "tangent", "u1", "v1"}
"""Fields of records that serve the computation and say nothing to people."""


class Names:
    """What rows of tables are called.

    Parameters
    ----------
    tables : mapping of str to (array, names)
        The record arrays by what their rows are ("material"), and the names of these; a row beyond them has only its number.
    """

    def __init__(self, tables: Mapping[str, tuple[NDArray[np.void], Sequence[str]]]) -> None:
        self._tables = {kind: (array.ctypes.data, array.itemsize, len(array), tuple(names)) for kind, (array, names) in tables.items()}

    def of_row(self, kind: str, row: int) -> str:
        """``material 3 (gold)``"""
        names = self._tables[kind][3] if kind in self._tables else ()
        told = f" ({names[row]})" if 0 <= row < len(names) and names[row] else ""
        return f"{kind} {row}{told}"

    def of_record(self, record: np.void) -> str | None:
        """The name of a record that stands in one of the tables, by where it stands."""
        address = record.__array_interface__["data"][0]
        for kind, (start, size, n, _) in self._tables.items():
            if size and record.dtype.itemsize == size and 0 <= address - start < n * size:
                return self.of_row(kind, (address - start) // size)
        return None


def shortest(value: float | np.floating[Any]) -> float | str:
    """The shortest number that is read as the same float32 (or float64); a word where JSON has no number."""
    if not math.isfinite(value):
        return str(float(value))
    # Not str(): how it writes numbers can be set, and some libraries do.
    return float(np.format_float_scientific(value, unique=True)) if isinstance(value, np.floating) else float(value)


def plain(value: Any, names: Names | None = None) -> Any:
    """A value as JSON can hold it; None for bulk data."""
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return shortest(value)
    if is_lanes(value):
        return _trimmed([plain(lane) for lane in value.values])
    if isinstance(value, np.void):
        return names.of_record(value) if names is not None else None
    if hasattr(value, "_fields"):
        told = {name: plain(part, names) for name, part in zip(value._fields, value, strict=True) if name not in _MACHINERY}
        return {name: part for name, part in told.items() if part is not None}
    if isinstance(value, tuple):
        parts = [plain(part, names) for part in value]
        return parts if all(part is not None for part in parts) else None
    if hasattr(value, "fields"):
        return _vector([plain(getattr(value, name)) for name in value.fields])
    return None


def is_lanes(value: Any) -> bool:
    """Whether a value is eight at once (`limner.kernel.lanes`, which is not imported here: it would import the compiler)."""
    return hasattr(value, "element") and isinstance(getattr(value, "values", None), np.ndarray)


def _trimmed(lanes: list[Any]) -> Any:
    """Lanes without what repeats the last of them; one number where all are the same."""
    n = len(lanes)
    while n > 1 and lanes[n - 2] == lanes[-1]:
        n -= 1
    return lanes[0] if n == 1 else {"lanes": lanes[:n]}


def _vector(parts: list[Any]) -> Any:
    """Three numbers; of lanes, three numbers for each lane."""
    counts = [len(part["lanes"]) for part in parts if isinstance(part, dict)]
    if not counts:
        return parts
    n = max(counts)

    def lane(part: Any, k: int) -> Any:
        return part["lanes"][min(k, len(part["lanes"]) - 1)] if isinstance(part, dict) else part

    return {"lanes": [[lane(part, k) for part in parts] for k in range(n)]}


def text_of(value: Any) -> str:
    """A plain value as people write it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, list):
        return f"({', '.join(text_of(part) for part in value)})"
    if isinstance(value, dict):
        if set(value) == {"lanes"}:
            return " | ".join(text_of(part) for part in value["lanes"])
        return ", ".join(f"{name} {text_of(part)}" for name, part in value.items())
    return str(value)
