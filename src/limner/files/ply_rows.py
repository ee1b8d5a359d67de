"""The rows of a PLY file: a header that says what is in a row, then rows, as text or as bytes.

    element vertex 8             8 rows of three floats           -> columns of numbers
    property float x …
    element face 6               6 rows of a count and so many    -> a ragged column: counts, and all values one after the other
    property list uchar int vertex_indices

What a header promises is compared with the bytes that are there before anything is made of it. Rows of one length are looked at where
they lie; where their lengths differ, each has to be found from the one before.

**Source**: Greg Turk, *The PLY Polygon File Format*, 1994.
"""

from __future__ import annotations

import os
import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from .limits import Limits
from .notes import quoted

__all__ = ["Element", "Header", "Property", "Ragged", "Rows", "read_header", "read_rows"]

_MAX_HEADER = 1 << 20
_ROWS_AT_ONCE = 1 << 16
_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
    "int64": "i8", "uint64": "u8",
}  # fmt: skip


class Property(NamedTuple):
    """A column: its name, the type of its numbers, and of a list the type of its count."""

    name: str
    kind: str
    count_kind: str = ""


class Element(NamedTuple):
    """A table: its name, how many rows, and what is in each."""

    name: str
    n_rows: int
    properties: tuple[Property, ...]


class Header(NamedTuple):
    """What a file says of itself; `order` is "" for text, else "<" or ">"."""

    order: str
    elements: tuple[Element, ...]
    comments: tuple[str, ...]
    length: int


class Ragged(NamedTuple):
    """Lists, one a row: (n,) counts, and all values one after the other."""

    counts: NDArray[np.int64]
    values: NDArray[Any]

    @property
    def starts(self) -> NDArray[np.int64]:
        """(n,) where each row begins in the values."""
        return np.cumsum(self.counts) - self.counts


class Rows(NamedTuple):
    """One element: columns of numbers and ragged columns by name."""

    columns: dict[str, NDArray[Any]]
    lists: dict[str, Ragged]


def read_header(data: bytes, path: str | os.PathLike[str]) -> Header:
    """Read the lines up to ``end_header``."""
    end = data.find(b"end_header", 0, _MAX_HEADER)
    if end < 0:
        raise FileFormatError("its header has no end: there is no line end_header", path)
    after = data.find(b"\n", end, end + 64)
    # Old files of one system end lines with a carriage return alone.
    length = after + 1 if after >= 0 else data.find(b"\r", end, end + 64) + 1
    length = length or len(data)
    lines = data[:end].decode("utf-8", "replace").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    order, elements, comments = None, [], []
    for number, line in enumerate(lines[1:], 2):
        words = line.split()
        keyword = words[0] if words else ""
        if keyword in ("comment", "obj_info"):
            comments.append(line.split(None, 1)[1] if len(words) > 1 else "")
        elif keyword == "format" and len(words) >= 2 and words[1] in _FORMATS:
            order = _FORMATS[words[1]]
        elif keyword == "element" and len(words) == 3 and words[2].isdecimal() and len(words[2]) < 19:
            elements.append(Element(words[1], int(words[2]), ()))
        elif keyword == "property" and elements and (made := _property(words)) is not None:
            if made.name in {known.name for known in elements[-1].properties}:
                raise FileFormatError(f"{quoted(made.name)} is declared twice", path, f"line {number}")
            elements[-1] = elements[-1]._replace(properties=(*elements[-1].properties, made))
        elif keyword:
            raise FileFormatError(f"this is no line of a PLY header: {quoted(line)}", path, f"line {number}")
    if order is None:
        raise FileFormatError(f"its header must say a format ({', '.join(_FORMATS)})", path)
    return Header(order, tuple(elements), tuple(comments), length)


def _property(words: list[str]) -> Property | None:
    if len(words) == 3 and words[1] in _TYPES:
        return Property(words[2], _TYPES[words[1]])
    if len(words) == 5 and words[1] == "list" and words[2] in _TYPES and _TYPES[words[2]][0] in "iu" and words[3] in _TYPES:
        return Property(words[4], _TYPES[words[3]], _TYPES[words[2]])
    return None


def read_rows(data: bytes, header: Header, wanted: tuple[str, ...], path: str | os.PathLike[str], limits: Limits) -> dict[str, Rows]:
    """Read the wanted elements.

    Parameters
    ----------
    data : bytes
        The whole file.
    header : Header
    wanted : tuple of str
        Names of elements; what stands behind the last of them is not looked at.

    Raises FileFormatError where there are fewer bytes or numbers than the header promises.
    """
    names = [element.name for element in header.elements]
    last = max((k for k, name in enumerate(names) if name in wanted), default=-1)
    most = max(limits.max_vertices, limits.max_triangles)
    source = _Text(data, header.length, path) if header.order == "" else _Bytes(data, header.length, header.order, path)
    found = {}
    for element in header.elements[: last + 1]:
        if element.n_rows > most:
            raise FileFormatError(f"declares {element.n_rows} rows of {quoted(element.name)}, the limit is {most}", path)
        if element.n_rows and not element.properties:
            raise FileFormatError(f"rows of {quoted(element.name)} have no properties", path)
        rows = source.rows(element)
        if element.name in wanted:
            found[element.name] = rows
    return found


class _Text:
    """Rows as text: all numbers of the file, one after the other; where a line ends does not matter."""

    def __init__(self, data: bytes, start: int, path: str | os.PathLike[str]) -> None:
        self._path = path
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self._numbers = np.fromstring(data[start:].decode("ascii"), dtype=np.float64, sep=" ")
        except (UnicodeDecodeError, DeprecationWarning, ValueError):
            raise FileFormatError("its rows hold something that is no number", path) from None
        self._at = 0

    def rows(self, element: Element) -> Rows:
        """The next rows."""
        if any(made.count_kind for made in element.properties):
            return self._rows_with_lists(element)
        n = len(element.properties)
        block = self._take(element, element.n_rows * n).reshape(element.n_rows, n)
        return Rows({made.name: _typed(block[:, k], made.kind) for k, made in enumerate(element.properties)}, {})

    def _take(self, element: Element, n: int) -> NDArray[np.float64]:
        if self._at + n > len(self._numbers):
            raise FileFormatError(f"is cut off in the rows of {quoted(element.name)}", self._path)
        self._at += n
        return self._numbers[self._at - n : self._at]

    def _rows_with_lists(self, element: Element) -> Rows:
        """Find the rows as bytes are found, a number being a unit long."""
        units = [made._replace(kind="f8", count_kind="f8" if made.count_kind else "") for made in element.properties]
        rest = self._numbers[self._at :]
        places = _same_length(rest, 0, element.n_rows, units, 1) or _each_length(rest, 0, element, units, 1, self._path)
        self._at += places.length
        return _gathered(rest, places, element, 1, "")


class _Bytes:
    """Rows as bytes, of one byte order."""

    def __init__(self, data: bytes, start: int, order: str, path: str | os.PathLike[str]) -> None:
        self._data, self._at, self._order, self._path = data, start, order, path

    def rows(self, element: Element) -> Rows:
        """The next rows."""
        if any(made.count_kind for made in element.properties):
            rest = np.frombuffer(self._data, dtype=np.uint8)[self._at :]
            kinds = list(element.properties)
            constant = self._rows_of_one_length(element)
            if constant is not None:
                return constant
            places = _each_length(rest, 0, element, kinds, 0, self._path, self._order)
            self._at += places.length
            return _gathered(rest, places, element, 0, self._order)
        dtype = np.dtype([(made.name, self._order + made.kind) for made in element.properties])
        table = self._table(element, dtype)
        if table is None:
            left = len(self._data) - self._at
            promised = f"declares {element.n_rows} rows of {quoted(element.name)}, {dtype.itemsize} bytes each"
            raise FileFormatError(f"is cut off: it {promised}, and {left} bytes are left", self._path)
        return Rows({made.name: table[made.name] for made in element.properties}, {})

    def _table(self, element: Element, dtype: np.dtype[Any]) -> NDArray[Any] | None:
        if element.n_rows * dtype.itemsize > len(self._data) - self._at:
            return None
        table = np.frombuffer(self._data, dtype=dtype, count=element.n_rows, offset=self._at)
        self._at += element.n_rows * dtype.itemsize
        return table

    def _rows_of_one_length(self, element: Element) -> Rows | None:
        """All rows at once, if each has lists as long as those of the first; else None."""
        start = self._at
        if not element.n_rows:
            return Rows({}, {made.name: Ragged(np.zeros(0, np.int64), np.zeros(0, made.kind)) for made in element.properties})
        fields: list[Any] = []
        at = start
        for made in element.properties:
            if made.count_kind:
                size = int(made.count_kind[1])
                n = int.from_bytes(self._data[at : at + size], "little" if self._order == "<" else "big", signed=made.count_kind[0] == "i")
                if not 0 <= n <= len(self._data):
                    return None
                fields += [(f"# {made.name}", self._order + made.count_kind), (made.name, self._order + made.kind, (n,))]
                at += size + n * int(made.kind[1])
            else:
                fields.append((made.name, self._order + made.kind))
                at += int(made.kind[1])
        table = self._table(element, np.dtype(fields))
        if table is None:
            return None
        columns, lists = {}, {}
        for made in element.properties:
            if not made.count_kind:
                columns[made.name] = table[made.name]
                continue
            counts, values = table[f"# {made.name}"], table[made.name]
            if not (counts == counts[0]).all():
                self._at = start
                return None
            lists[made.name] = Ragged(np.full(element.n_rows, counts[0], dtype=np.int64), values.reshape(-1))
        return Rows(columns, lists)


class _Places(NamedTuple):
    """Where the properties of each row begin, (n, k), how long lists are there, (n, k), and how long all rows are together."""

    begins: NDArray[np.int64]
    counts: NDArray[np.int64]
    length: int


def _same_length(numbers: NDArray[np.float64], start: int, count: int, kinds: list[Property], unit: int) -> _Places | None:
    """Where rows of text are, if each has lists as long as those of the first."""
    begins, counts, at = [], [], start
    for made in kinds:
        n = 0
        if made.count_kind:
            if at >= len(numbers) or not 0 <= numbers[at] <= len(numbers):
                return None
            n, at = int(numbers[at]), at + 1
        begins.append(at)
        counts.append(n)
        at += n if made.count_kind else unit
    if count * at > len(numbers):
        return None
    table = numbers[: count * at].reshape(count, at)
    for made, begin, n in zip(kinds, begins, counts, strict=True):
        if made.count_kind and not (table[:, begin - 1] == n).all():
            return None
    rows = at * np.arange(count)[:, None]
    return _Places(rows + np.array(begins), np.broadcast_to(np.array(counts), (count, len(kinds))), count * at)


def _each_length(
    data: NDArray[Any], start: int, element: Element, kinds: list[Property], unit: int, path: str | os.PathLike[str], order: str = "<"
) -> _Places:
    """Go from row to row; `unit` 0 means bytes."""
    end = len(data)
    raw = data.tolist() if unit else data.tobytes()
    begins = np.empty((element.n_rows, len(kinds)), dtype=np.int64) if element.n_rows <= end else None
    if begins is None:
        raise FileFormatError(f"is cut off in the rows of {quoted(element.name)}", path)
    counts = np.zeros_like(begins)
    sizes = [(unit or int(made.kind[1]), (unit or int(made.count_kind[1])) if made.count_kind else 0) for made in kinds]
    signed = [made.count_kind[:1] == "i" for made in kinds]
    byteorder = "little" if order == "<" else "big"
    at = start
    for row in range(element.n_rows):
        for k, (size, count_size) in enumerate(sizes):
            n = 1
            if count_size:
                if at + count_size > end:
                    n = -1
                elif unit:
                    n = int(raw[at]) if 0 <= raw[at] <= end else -1
                elif count_size == 1 and not signed[k]:
                    n = raw[at]
                else:
                    n = int.from_bytes(raw[at : at + count_size], byteorder, signed=signed[k])  # type: ignore[arg-type]
                counts[row, k] = n
                at += count_size
            begins[row, k] = at
            at += n * size
            if n < 0 or at > end:
                raise FileFormatError(f"is cut off or broken at row {row} of {quoted(element.name)}", path)
    return _Places(begins, counts, at - start)


def _gathered(data: NDArray[Any], places: _Places, element: Element, unit: int, order: str) -> Rows:
    """Fetch the values from where they begin, lists of one length at a time."""
    columns: dict[str, NDArray[Any]] = {}
    lists: dict[str, Ragged] = {}
    for k, made in enumerate(element.properties):
        size = unit or int(made.kind[1])
        begins = places.begins[:, k]
        if not made.count_kind:
            columns[made.name] = _fetched(data, begins, 1, size, made.kind, order).reshape(-1)
            continue
        counts = np.ascontiguousarray(places.counts[:, k])
        starts = np.cumsum(counts) - counts
        values = np.empty(int(counts.sum()), dtype=made.kind)
        for n in np.unique(counts).tolist():
            rows = np.flatnonzero(counts == n)
            values[starts[rows][:, None] + np.arange(n)] = _fetched(data, begins[rows], n, size, made.kind, order)
        lists[made.name] = Ragged(counts, values)
    return Rows(columns, lists)


def _fetched(data: NDArray[Any], begins: NDArray[np.int64], n: int, size: int, kind: str, order: str) -> NDArray[Any]:
    """(rows, n) values."""
    made = np.empty((len(begins), n), dtype=kind if data.dtype == np.uint8 else data.dtype)
    for first in range(0, len(begins) if n else 0, _ROWS_AT_ONCE):
        part = slice(first, first + _ROWS_AT_ONCE)
        block = data[begins[part, None] + np.arange(n * size)]
        made[part] = block.view(order + kind) if block.dtype == np.uint8 else block
    return made if data.dtype == np.uint8 else _typed(made, kind)


def _typed(numbers: NDArray[Any], kind: str) -> NDArray[Any]:
    """Numbers of text as what they were declared; integers that are too large stay as they are, to be refused by whoever uses them."""
    if kind[0] == "f" or not numbers.size:
        return numbers.astype(kind) if kind == "f4" and _fits(numbers) else numbers
    info = np.iinfo(kind)
    return numbers.astype(kind) if np.isfinite(numbers).all() and numbers.min() >= info.min and numbers.max() <= info.max else numbers


def _fits(numbers: NDArray[Any]) -> bool:
    with np.errstate(invalid="ignore"):
        return bool(np.nanmax(np.abs(numbers), initial=0.0) <= np.finfo(np.float32).max)
