"""The text of an OBJ file as arrays: its lines, its numbers, its faces as they are written.

Python is too slow to look at a million lines one after the other, so the text is an array of bytes: NumPy finds the lines
and their words, lines of one kind and shape are cut out together and parsed in one call. Where that call fails, or a line
has a shape of its own, the same lines go through a slow and careful path, which knows what is wrong with which line.
"""

from __future__ import annotations

import os
import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from .notes import Notes, quoted

__all__ = ["KINDS", "Events", "Faces", "Text", "read_faces", "read_table"]

# A group of fewer lines than this is not worth a bulk call.
MIN_BULK = 8

NEWLINE, SPACE, SLASH, HASH = 10, 32, 47, 35
KINDS = {b"v": 1, b"vt": 2, b"vn": 3, b"f": 4}
# How the corner of a face is written: slashes + 4 * double slashes -> which of (position, uv, normal) it gives.
SHAPES = {0: (0,), 1: (0, 1), 2: (0, 1, 2), 6: (0, 2)}

Bytes = NDArray[np.uint8]
Integers = NDArray[np.int64]
Reals = NDArray[np.float64]

_CONTROLS_AS_BLANKS = bytes(max(code, SPACE) for code in range(256))
"""What separates words when they are counted also does when they are split."""


class Text:
    """The file as bytes, and where its lines and words are.

    `kind` says of each line whether it is v, vt, vn, f (1 to 4) or anything else (0); of the former the keyword is blanked, so
    that only numbers are left of them.
    """

    def __init__(self, data: bytes, path: str | os.PathLike[str]) -> None:
        if b"\0" in data:
            raise FileFormatError("is no OBJ text: it has zero bytes", path, f"byte {data.index(0)}")
        self.path = path
        self.raw = data
        self.bytes = _prepared(data)
        self.line_ends = np.flatnonzero(self.bytes == NEWLINE)
        self.line_starts = np.concatenate([[0], self.line_ends[:-1] + 1])
        _blank_comments(self.bytes)
        ink = self.bytes > SPACE
        begins = ink.copy()
        begins[1:] &= ~ink[:-1]
        self.word_starts = np.flatnonzero(begins)
        n_words = np.add.reduceat(begins, self.line_starts, dtype=np.int64)
        self.first_word = np.cumsum(n_words) - n_words
        self.kind = self._kinds(n_words)
        self.n_numbers = n_words - 1

    def _kinds(self, n_words: Integers) -> NDArray[np.uint8]:
        kind = np.zeros(len(n_words), dtype=np.uint8)
        filled = np.flatnonzero(n_words > 0)
        at = self.word_starts[self.first_word[filled]]
        last = len(self.bytes) - 1
        one, two, three = (self.bytes[np.minimum(at + step, last)] for step in range(3))
        for keyword, code in KINDS.items():
            if len(keyword) == 1:
                match = (one == keyword[0]) & (two <= SPACE)
            else:
                match = (one == keyword[0]) & (two == keyword[1]) & (three <= SPACE)
                self.bytes[at[match] + 1] = SPACE
            kind[filled[match]] = code
            self.bytes[at[match]] = SPACE
        self.others = filled[(kind[filled] == 0) & (one != HASH)]
        return kind

    def line(self, index: int) -> bytes:
        """The text of a line, without the keyword where it is v, vt, vn or f."""
        return self.bytes[self.line_starts[index] : self.line_ends[index]].tobytes().translate(_CONTROLS_AS_BLANKS).strip()

    def number_of(self, index: int) -> int:
        """The number of a line as editors count, from 1, continued lines included."""
        return 1 + self.raw.count(b"\n", 0, int(self.line_starts[index]))

    def cut(self, lines: Integers) -> bytes:
        """The text of many lines, in order."""
        first, last = int(lines[0]), int(lines[-1])
        if last - first + 1 == len(lines):
            return self.bytes[self.line_starts[first] : self.line_ends[last] + 1].tobytes()
        starts = self.line_starts[lines]
        lengths = self.line_ends[lines] + 1 - starts
        offsets = np.cumsum(lengths) - lengths
        return self.bytes[np.arange(int(lengths.sum())) + np.repeat(starts - offsets, lengths)].tobytes()


def _prepared(data: bytes) -> Bytes:
    """Return a writable copy that ends in a newline; marks, continuations and foreign newlines become blanks and newlines."""
    if data.startswith(b"\xef\xbb\xbf"):
        data = b"   " + data[3:]
    if b"\\" in data:
        data = data.replace(b"\\\r\n", b"   ").replace(b"\\\n", b"  ")
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    return np.frombuffer(bytearray(data if data.endswith(b"\n") else data + b"\n"), dtype=np.uint8)


def _blank_comments(text: Bytes) -> None:
    """Blank what follows a # within a line of numbers; names may hold one."""
    hashes = np.flatnonzero(text == HASH)
    if not len(hashes):
        return
    inside = hashes[(hashes > 0) & np.isin(text[np.maximum(hashes - 1, 0)], (SPACE, 9))]
    content = text.tobytes() if len(inside) else b""
    end = 0
    for at in inside.tolist():
        if at < end:
            continue
        start = content.rfind(b"\n", 0, at) + 1
        end = content.find(b"\n", at)
        if content[start:at].lstrip()[:1] in (b"v", b"f"):
            text[at:end] = SPACE


def _numbers(text: bytes, n_expected: int, dtype: type) -> NDArray[Any] | None:
    """Parse numbers between white space; None where there are others than expected."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            parsed: NDArray[Any] = np.fromstring(text, dtype=dtype, sep=" ")
    except (ValueError, DeprecationWarning, OverflowError):
        return None
    return parsed if len(parsed) == n_expected else None


def read_table(text: Text, kind: bytes, columns: int) -> tuple[Reals, Integers]:
    """Return the numbers of all lines of a kind, (n, columns) float64, and how many each line has.

    What is missing is NaN, as is a line that cannot be read: it keeps its number, and only what refers to it is lost.
    """
    lines = np.flatnonzero(text.kind == KINDS[kind])
    counts = text.n_numbers[lines]
    values = np.full((len(lines), columns), np.nan)
    for count in np.unique(counts).tolist():
        rows = np.flatnonzero(counts == count)
        used = min(count, columns)
        if not used:
            continue
        parsed = _numbers(text.cut(lines[rows]), len(rows) * count, np.float64) if len(rows) >= MIN_BULK else None
        if parsed is not None:
            values[rows, :used] = parsed.reshape(len(rows), count)[:, :used]
        else:
            for row in rows.tolist():
                values[row, :used] = _floats(text.line(int(lines[row])).split()[:used])
    return values, counts


def _floats(words: list[bytes]) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        return [float("nan")] * len(words)


class Faces(NamedTuple):
    """Faces of one number of corners: their lines, (n,), and (position, uv, normal) as written, (n, k, 3), 0 for none."""

    lines: Integers
    corners: Integers


def read_faces(text: Text) -> tuple[list[Faces], list[int]]:
    """Return all faces, grouped, and the lines that are none."""
    lines = np.flatnonzero(text.kind == KINDS[b"f"])
    counts = text.n_numbers[lines]
    groups: list[Faces] = []
    odd: list[Integers] = [lines[counts < 3]]
    shapes = _corner_shapes(text)
    for count in np.unique(counts[counts >= 3]).tolist():
        rows = lines[counts == count]
        if len(rows) < MIN_BULK:
            odd.append(rows)
            continue
        if shapes is None:
            shape_of = np.zeros(len(rows), dtype=np.int64)
        else:
            written = shapes[text.first_word[rows][:, None] + np.arange(1, count + 1)]
            shape_of = np.where((written == written[:, :1]).all(axis=1), written[:, 0], -1)
        for shape in np.unique(shape_of).tolist():
            alike = rows[shape_of == shape]
            bulk = _bulk_faces(text, alike, count, SHAPES[shape]) if shape in SHAPES and len(alike) >= MIN_BULK else None
            if bulk is None:
                odd.append(alike)
            else:
                groups.append(bulk)
    careful, bad = _careful_faces(text, np.sort(np.concatenate(odd)).tolist())
    return groups + careful, bad


def _corner_shapes(text: Text) -> Integers | None:
    """Return of each word its slashes plus four times its double slashes; None where the file has no slash."""
    slashes = text.bytes == SLASH
    if not slashes.any():
        return None
    doubles = np.zeros_like(slashes)
    doubles[:-1] = slashes[:-1] & slashes[1:]
    single = np.add.reduceat(slashes, text.word_starts, dtype=np.int64)
    return single + 4 * np.add.reduceat(doubles, text.word_starts, dtype=np.int64)


def _bulk_faces(text: Text, lines: Integers, count: int, places: tuple[int, ...]) -> Faces | None:
    written = text.cut(lines)
    parsed = _numbers(written.replace(b"/", b" "), len(lines) * count * len(places), np.int64)
    if parsed is None or b"/ " in written or b"/\n" in written or b" /" in written:
        return None
    corners = np.zeros((len(lines), count, 3), dtype=np.int64)
    corners[:, :, list(places)] = parsed.reshape(len(lines), count, len(places))
    return Faces(lines, corners)


def _careful_faces(text: Text, lines: list[int]) -> tuple[list[Faces], list[int]]:
    """Read faces one by one."""
    found: dict[int, tuple[list[int], list[list[tuple[int, int, int]]]]] = {}
    bad: list[int] = []
    for line in lines:
        try:
            corners = [_corner(word) for word in text.line(line).split()]
        except ValueError:
            corners = []
        if len(corners) < 3:
            bad.append(line)
            continue
        group = found.setdefault(len(corners), ([], []))
        group[0].append(line)
        group[1].append(corners)
    return [Faces(np.array(rows, dtype=np.int64), np.array(corners, dtype=np.int64)) for rows, corners in found.values()], bad


def _corner(word: bytes) -> tuple[int, int, int]:
    parts = [int(part) if part else 0 for part in word.split(b"/")]
    if not parts[0] or len(parts) > 3 or max(map(abs, parts)) > 2**40:
        raise ValueError
    return parts[0], parts[1] if len(parts) > 1 else 0, parts[2] if len(parts) > 2 else 0


class _Named(NamedTuple):
    """Lines that give a name to all that follows."""

    lines: list[int]
    names: list[str]


class Events:
    """The lines that are not only numbers: names, materials, smoothing; and polylines, which are few."""

    def __init__(self, text: Text, notes: Notes) -> None:
        self.libraries: list[str] = []
        self.objects = _Named([], [])
        self.groups = _Named([], [])
        self.material_lines: list[int] = []
        self.material_names: list[str] = []
        self._smoothing_lines: list[int] = []
        self._smoothing: list[int] = []
        self.polyline_lines: list[int] = []
        self.polylines: list[list[int]] = []
        unread: dict[str, int] = {}
        for line in text.others.tolist():
            keyword, _, rest = text.line(line).replace(b"\t", b" ").partition(b" ")
            name = rest.strip().decode("utf-8", errors="replace")
            match keyword.lower():
                case b"usemtl":
                    self.material_lines.append(line)
                    self.material_names.append(name)
                case b"mtllib":
                    self.libraries.append(name)
                case b"l":
                    self.polyline_lines.append(line)
                    self.polylines.append(_places(rest))
                case b"o":
                    _put_name(self.objects, line, name)
                case b"g":
                    _put_name(self.groups, line, name)
                case b"s":
                    self._smoothing_lines.append(line)
                    self._smoothing.append(int(name) if name.isdecimal() and len(name) < 10 else 0)
                case other:
                    unread.setdefault(other[:20].decode("utf-8", errors="replace"), line)
        self.libraries = list(dict.fromkeys(self.libraries))
        for keyword_text, line in list(unread.items())[:20]:
            notes.add(f"{quoted(keyword_text)} lines are ignored", f"line {text.number_of(line)}")

    def smoothing_of(self, lines: Integers) -> Integers:
        """Return the smoothing group of each line: 0 off, -1 where the file does not say."""
        return np.array([*self._smoothing, -1])[np.searchsorted(self._smoothing_lines, lines, side="right") - 1]


def _places(words: bytes) -> list[int]:
    """The positions that a polyline names, as written; 0, which is none, where one cannot be read."""
    try:
        return [_corner(word)[0] for word in words.split()]
    except ValueError:
        return [0, 0]


def _put_name(named: _Named, line: int, name: str) -> None:
    named.lines.append(line)
    named.names.append(name)
