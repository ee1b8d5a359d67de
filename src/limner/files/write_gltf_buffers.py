"""Numbers into a glTF file: accessors over buffer views over one buffer (glTF 2.0, section 3.6).

    array  ->  accessor (count, type, bounds)  ->  buffer view (what it is for)  ->  the buffer

Arrays of the same numbers that are for the same purpose are stored once. Bytes are not copied until the file is written, and each array
begins at a multiple of four.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .accessors import MAX_IMPLIED_ZEROS

__all__ = ["Buffers", "Json"]

Json = dict[str, Any]
Purpose = Literal["vertices", "indices", "keys", "matrices", "instances", "sparse indices", "sparse values"]

_TARGETS: dict[str, int] = {"vertices": 34962, "indices": 34963}
_COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_ALIGNMENT = 4
# The greatest index of each width stands for "begin anew" where triangles are listed (3.7.2.1), so it is never used.
_MOST_IN_16_BITS = 0xFFFF


@dataclass
class _View:
    """A run of the buffer, in parts that each begin at a multiple of four."""

    target: int | None = None
    stride: int | None = None
    parts: list[memoryview] = field(default_factory=list)
    length: int = 0

    def append(self, data: memoryview) -> int:
        """Where the part begins."""
        start = self.length + -self.length % _ALIGNMENT
        self.parts.append(data)
        self.length = start + data.nbytes
        return start


class Buffers:
    """The accessors, buffer views and bytes of one file while it is put together."""

    def __init__(self) -> None:
        self.accessors: list[Json] = []
        self._views: list[_View] = []
        self._shared: dict[str, int] = {}
        self._known: dict[tuple[Any, ...], int] = {}
        self._n_zeros = 0

    def accessor(self, values: NDArray[Any], purpose: Purpose, *, bounds: bool = False, own: bool = False) -> int:
        """Store (count,) or (count, columns) numbers, in the type that they have, and return the number of the accessor.

        Parameters
        ----------
        values : 1, 2, 3, 4 or 16 columns of uint8, uint16, uint32 or float32
        purpose : str
            What is for vertices or their indices has a buffer view of its own; the rest shares one for each purpose.
        bounds : bool
            Say the least and the greatest of each column, as positions and times must.
        own : bool
            Make an accessor that nothing else has, though others may look at the same bytes.
        """
        rows = _plain(values)
        key = (purpose, rows.dtype.str, rows.shape, bounds, _digest(rows))
        if key not in self._known:
            view, offset = self._place(rows, purpose)
            made = _described(rows, bounds) | {"bufferView": view}
            self._known[key] = self._add(made | ({"byteOffset": offset} if offset else {}))
        elif own:
            return self._add(dict(self.accessors[self._known[key]]))
        return self._known[key]

    def indices(self, corners: NDArray[Any], n_vertices: int) -> int:
        """Store vertex indices, (count,), in as few bytes as they need."""
        narrow = n_vertices <= _MOST_IN_16_BITS
        return self.accessor(corners.reshape(-1).astype(np.uint16 if narrow else np.uint32), "indices")

    def offsets(self, values: NDArray[np.float32], *, bounds: bool = False) -> int:
        """Store (count, 3) float32 of which most rows may be zero: only the others, where that takes less than half the room."""
        kept = np.flatnonzero(values.view(np.uint32).any(axis=1))
        kept = kept if len(kept) else np.zeros(1, dtype=np.int64)
        width = np.uint8 if len(values) <= 1 << 8 else np.uint16 if len(values) <= 1 << 16 else np.uint32
        is_small = 2 * len(kept) * (np.dtype(width).itemsize + 12) < 12 * len(values)
        if not is_small or self._n_zeros + values.size > MAX_IMPLIED_ZEROS:
            return self.accessor(values, "vertices", bounds=bounds)
        self._n_zeros += values.size
        places, first = self._place(_plain(kept.astype(width)), "sparse indices")
        rows, second = self._place(_plain(values[kept]), "sparse values")
        component = _COMPONENTS[np.dtype(width).str[1:]]
        sparse = {
            "count": len(kept),
            "indices": {"bufferView": places, "byteOffset": first, "componentType": component},
            "values": {"bufferView": rows, "byteOffset": second},
        }
        return self._add(_described(_plain(values), bounds) | {"sparse": sparse})

    def picture(self, data: bytes) -> int:
        """Store an encoded picture and return the number of its buffer view."""
        self._views.append(_View())
        self._views[-1].append(memoryview(data))
        return len(self._views) - 1

    def views(self) -> list[Json]:
        """The buffer views, where `chunks` puts them."""
        found: list[Json] = []
        for view, start in zip(self._views, self._starts(), strict=False):
            made: Json = {"buffer": 0, "byteOffset": start, "byteLength": view.length}
            made |= {} if view.stride is None else {"byteStride": view.stride}
            found.append(made | ({} if view.target is None else {"target": view.target}))
        return found

    @property
    def length(self) -> int:
        """How many bytes there are."""
        return self._starts()[-1] if self._views else 0

    def chunks(self) -> Iterator[memoryview]:
        """The bytes, in order."""
        for view in self._views:
            for part in view.parts:
                yield part
                yield memoryview(bytes(-part.nbytes % _ALIGNMENT))

    def _starts(self) -> list[int]:
        starts = [0]
        for view in self._views:
            starts.append(starts[-1] + view.length + -view.length % _ALIGNMENT)
        return starts

    def _place(self, rows: NDArray[Any], purpose: Purpose) -> tuple[int, int]:
        """The buffer view that takes the bytes, and where they begin in it."""
        target = _TARGETS.get(purpose)
        if target is not None or purpose not in self._shared:
            # Where two accessors may look at the same vertices the specification wants to hear how long one is.
            self._views.append(_View(target, rows.strides[0] if purpose == "vertices" else None))
            self._shared[purpose] = len(self._views) - 1
        index = self._shared[purpose]
        return index, self._views[index].append(rows.data.cast("B"))

    def _add(self, accessor: Json) -> int:
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _plain(values: NDArray[Any]) -> NDArray[Any]:
    """In the byte order of the file, one row after the other."""
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))


def _digest(values: NDArray[Any]) -> bytes:
    return hashlib.blake2b(values.data.cast("B"), digest_size=16).digest()


def _described(values: NDArray[Any], bounds: bool) -> Json:
    columns = values.shape[1] if values.ndim == 2 else 1
    made: Json = {"componentType": _COMPONENTS[values.dtype.str[1:]], "count": len(values), "type": _TYPES[columns]}
    if bounds:
        rows = values.reshape(-1, columns)
        made |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
    return made
