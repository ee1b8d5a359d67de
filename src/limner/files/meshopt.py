"""Undoing meshopt compression: buffer views of vertices, triangles and other indices (EXT_ and KHR_meshopt_compression).

A stream is small because neighbours in it are alike: vertices are told by their differences, byte by byte, and a triangle mostly by
which recent edge it continues. How long a part is, is only known where it begins, so that a stream has to be walked through; but that
is all that has to be done one after the other:

    walk   ->  where each group of 16 differences lies, and how wide they are     a number for each group
    unpack ->  all groups of one width at once                                    arrays
    sum    ->  all elements at once: running sums of differences                  arrays

A stream is written by somebody else. Whatever its bytes are, the result is one of the size that was asked for, or a MeshoptError.

**Source**: Khronos Group, *KHR_meshopt_compression*, appendix A (its version 0 is *EXT_meshopt_compression*).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from .meshopt_filters import FILTERS

__all__ = ["MeshoptError", "decode", "decode_attributes", "decode_indices", "decode_triangles"]

Bytes = NDArray[np.uint8]
Words = NDArray[np.uint32]

_GROUP = 16
_BLOCK_BYTES = 8192
_MOST_IN_BLOCK = 256
_BATCH = 1 << 15  # groups that are unpacked together
_MARGIN = 512  # more than a data block can reach beyond the place that is checked
_ATTRIBUTES = {0xA0: 0, 0xA1: 1}
_TRIANGLES, _INDICES = 0xE1, 0xD1
# Of each control mode of version 1, then of version 0: how many bits a difference has, by the two bits of its group's header.
_WIDTHS = ((0, 1, 2, 4), (1, 2, 4, 8))
_WIDTHS_BEFORE = (0, 2, 4, 8)
_SIZES = {"OCTAHEDRAL": (4, 8), "QUATERNION": (8,), "COLOR": (4, 8)}
_ALL = 0xFFFFFFFF


class MeshoptError(LimnerError):
    """A stream that is none, or is cut off; the message says why, the caller where it stands."""


def decode(data: bytes | memoryview, count: int, stride: int, mode: str, filtering: str = "NONE") -> Bytes:
    """Return the bytes of a buffer view.

    Parameters
    ----------
    data : bytes
        The stream, neither more nor less.
    count, stride : int
        How many elements there are, of how many bytes.
    mode : "ATTRIBUTES" | "TRIANGLES" | "INDICES"
    filtering : "NONE" | "OCTAHEDRAL" | "QUATERNION" | "EXPONENTIAL" | "COLOR"
        What was done to attributes before.

    Returns
    -------
    (count * stride,) uint8

    Raises MeshoptError.
    """
    if mode == "ATTRIBUTES":
        rows = decode_attributes(data, count, stride)
        if filtering != "NONE":
            if filtering not in FILTERS:
                raise MeshoptError(f"must have the filter NONE, {', '.join(FILTERS)}, got {filtering[:40]!r}")
            if stride not in _SIZES.get(filtering, (stride,)):
                raise MeshoptError(f"must have elements of {' or '.join(map(str, _SIZES[filtering]))} bytes for {filtering}, got {stride}")
            rows = FILTERS[filtering](rows)
        return rows.reshape(-1)
    if mode not in ("TRIANGLES", "INDICES"):
        raise MeshoptError(f"must have the mode ATTRIBUTES, TRIANGLES or INDICES, got {mode[:40]!r}")
    if stride not in (2, 4):
        raise MeshoptError(f"must have indices of 2 or 4 bytes, got {stride}")
    if filtering != "NONE":
        raise MeshoptError(f"must have no filter for indices, got {filtering[:40]!r}")
    found = (decode_triangles if mode == "TRIANGLES" else decode_indices)(data, count)
    if stride == 4:
        return found.astype("<u4", copy=False).view(np.uint8)
    if len(found) and int(found.max()) > 0xFFFF:
        raise MeshoptError(f"must have indices up to 65535 in 2 bytes, got {int(found.max())}")
    return found.astype("<u2").view(np.uint8)


# --- attributes ---------------------------------------------------------------------------------------------------------------


def decode_attributes(data: bytes | memoryview, count: int, stride: int) -> Bytes:
    """Return `count` elements of `stride` bytes, as (count, stride) uint8."""
    if not (4 <= stride <= 256 and stride % 4 == 0):
        raise MeshoptError(f"must have elements of 4 to 256 bytes, a multiple of 4, got {stride}")
    data = bytes(data)
    if not data or data[0] not in _ATTRIBUTES:
        raise MeshoptError("does not begin as attributes do")
    version = _ATTRIBUTES[data[0]]
    tail = stride + version * (stride // 4)
    end = len(data) - max(tail, 24 if version else 32)
    if end < 1:
        raise MeshoptError(f"is cut off: {len(data)} bytes are fewer than its header and its end have")
    # Of a block whose differences are all 0, two bits are left, or the two bits of its groups.
    least = -(-count // _MOST_IN_BLOCK) * (stride // 4 if version else stride)
    if end - 1 < least:
        raise MeshoptError(f"is cut off: {count} elements cannot be in {len(data)} bytes")
    deltas = _Deltas(data, count, stride, version).read(end)
    base = np.frombuffer(data, np.uint8, stride, len(data) - tail)
    channels = data[len(data) - tail + stride :] if version else bytes(stride // 4)
    rows = np.empty((count, stride), dtype=np.uint8)
    for k, channel in enumerate(channels):
        part = slice(4 * k, 4 * k + 4)
        rows[:, part] = _summed(deltas[part, :count], base[part], channel)
    return rows


class _Deltas:
    """The differences of a stream of attributes while they are read: (stride, count, rounded up to 16) uint8."""

    def __init__(self, data: bytes, count: int, stride: int, version: int) -> None:
        self._data = data
        self._padded: Bytes = np.frombuffer(data + bytes(_MARGIN), dtype=np.uint8)
        self._count, self._stride, self._version = count, stride, version
        self._n_groups = -(-count // _GROUP)
        self._found: Bytes = np.zeros((stride * self._n_groups, _GROUP), dtype=np.uint8)
        self._lengths = {width: _packed_lengths(self._padded, width) for width in (1, 2, 4)}
        self._places: dict[int, list[int]] = {1: [], 2: [], 4: [], 8: []}
        self._rows: dict[int, list[int]] = {1: [], 2: [], 4: [], 8: []}

    def read(self, end: int) -> Bytes:
        """Walk through all blocks, from the first byte after the header to `end`."""
        place, first = 1, 0
        size = min((_BLOCK_BYTES // self._stride) & ~15, _MOST_IN_BLOCK)
        while first < self._count:
            place = self._block(place, first, min(size, self._count - first), end)
            first += size
            if sum(map(len, self._places.values())) > _BATCH:
                self._unpack()
        if place != end:
            raise MeshoptError(f"has {end - place} bytes too many")
        self._unpack()
        return self._found.reshape(self._stride, -1)

    def _block(self, place: int, first: int, n_elements: int, end: int) -> int:
        """Walk through a block of `n_elements` from `first` on; return where the next one lies."""
        controls = b""
        if self._version:
            controls = self._data[place : place + self._stride // 4]
            place += self._stride // 4
        for k in range(self._stride):
            if place > end:
                break
            control = controls[k // 4] >> (2 * (k % 4)) & 3 if controls else -1
            if control == 3:
                self._copy(place, k, first, n_elements)
                place += n_elements
            elif control != 2:
                widths = _WIDTHS[control] if controls else _WIDTHS_BEFORE
                place = self._groups(place, k * self._n_groups + first // _GROUP, -(-n_elements // _GROUP), widths)
        if place > end:
            raise MeshoptError("is cut off: its last differences are missing")
        return place

    def _copy(self, place: int, k: int, first: int, n_elements: int) -> None:
        column = self._found.reshape(self._stride, -1)[k]
        source = self._padded[place : place + n_elements]
        column[first : first + len(source)] = source

    def _groups(self, place: int, row: int, n_groups: int, widths: tuple[int, ...]) -> int:
        n_header = (n_groups + 3) // 4
        header = int.from_bytes(self._data[place : place + n_header], "little")
        place += n_header
        for k in range(n_groups):
            width = widths[header >> (2 * k) & 3]
            if width:
                self._places[width].append(place)
                self._rows[width].append(row + k)
                place += _GROUP if width == 8 else self._lengths[width][place]
        return place

    def _unpack(self) -> None:
        for width, places in self._places.items():
            if places:
                self._found[self._rows[width]] = _unpacked(self._padded, np.array(places), width)
                places.clear()
                self._rows[width].clear()


def _packed_lengths(data: Bytes, width: int) -> bytes:
    """How many bytes a group of 16 differences of `width` bits takes that begins at each byte: the packed ones, and one for each escape."""
    sentinel = (1 << width) - 1
    escapes = np.array([sum((byte >> k & sentinel) == sentinel for k in range(0, 8, width)) for byte in range(256)], dtype=np.uint8)
    found = escapes[data]
    n_packed = 2 * width
    total = np.zeros(len(data), dtype=np.uint8)
    for k in range(n_packed):
        total[: len(data) - k] += found[k:]
    return (total + np.uint8(n_packed)).tobytes()


def _unpacked(data: Bytes, places: NDArray[np.int64], width: int) -> Bytes:
    """Return the groups of 16 differences of `width` bits that begin at `places`, as (m, 16) uint8."""
    if width == 8:
        return data[places[:, None] + np.arange(_GROUP)]
    n_packed, sentinel = 2 * width, (1 << width) - 1
    packed = data[places[:, None] + np.arange(n_packed)]
    shifts = np.arange(0, 8, width) if width == 1 else np.arange(8 - width, -1, -width)
    values = (packed[:, :, None] >> shifts.astype(np.uint8) & np.uint8(sentinel)).reshape(-1, _GROUP)
    escaped = values == sentinel
    order = np.cumsum(escaped, axis=1)
    values[escaped] = data[(places[:, None] + n_packed - 1 + order)[escaped]]
    return values


def _summed(deltas: Bytes, base: Bytes, channel: int) -> Bytes:
    """Return 4 bytes of each element: running sums of differences from `base`; (4, count) gives (count, 4).

    **Source**: the draft of KHR_meshopt_compression turns the words of channel mode 2 to the left; what its encoder writes, and its decoder
    reads, is turned to the right, as here.
    """
    kind, turned = channel & 15, channel >> 4
    if kind > 2 or (turned and kind < 2):
        raise MeshoptError(f"must have channel modes 0 or 1, or 2 with a rotation, got {channel}")
    if kind == 2:
        words = np.ascontiguousarray(deltas.T).view("<u4").reshape(-1)
        words = words >> np.uint32(turned) | words << np.uint32((32 - turned) & 31) if turned else words
        if len(words):
            words[0] ^= base.view("<u4")[0]
        return np.bitwise_xor.accumulate(words).astype("<u4").view(np.uint8).reshape(-1, 4)
    dtype = np.dtype("u1") if kind == 0 else np.dtype("<u2")
    values = np.ascontiguousarray(deltas.T).view(dtype)
    signed = values >> dtype.type(1) ^ (dtype.type(0) - (values & dtype.type(1)))
    if len(signed):
        signed[0] += base.view(dtype)
    return np.cumsum(signed, axis=0, dtype=dtype).view(np.uint8)


# --- indices ------------------------------------------------------------------------------------------------------------------


def decode_triangles(data: bytes | memoryview, count: int) -> Words:
    """Return `count` corners of triangles, as (count,) uint32."""
    data = bytes(data)
    n_triangles, extra = divmod(count, 3)
    if extra:
        raise MeshoptError(f"must have corners of triangles by threes, got {count}")
    if not data or data[0] != _TRIANGLES:
        raise MeshoptError("does not begin as triangles do")
    if len(data) < 1 + n_triangles + 16:
        raise MeshoptError(f"is cut off: {n_triangles} triangles cannot be in {len(data)} bytes")
    corners = _Triangles(data[1 + n_triangles : -16], data[-16:]).read(data[1 : 1 + n_triangles])
    found = np.array(corners, dtype=np.int64)
    if len(found) and int(found.min()) < 0:
        raise MeshoptError("refers to an edge or a vertex that was not there")
    return found.astype(np.uint32)


class _Triangles:
    """Recent edges and vertices, in rings of 16, and what else is known of the triangles so far. What was never written is -1."""

    def __init__(self, extra: bytes, table: bytes) -> None:
        self._extra = extra
        self._table = table
        self._place = 0
        self._last = 0

    def read(self, codes: bytes) -> list[int]:
        """Return the corners of the triangles that `codes` stand for, one byte each."""
        edges, vertices = [(-1, -1)] * 16, [-1] * 16
        edge = vertex = following = 0  # the first two: where the next ones go
        corners: list[int] = []
        for code in codes:
            if code < 0xF0:
                a, b = edges[(edge - 1 - (code >> 4)) & 15]
                kind = code & 15
                if kind == 0:
                    c, following = following, (following + 1) & _ALL
                elif kind < 13:
                    c = vertices[(vertex - 1 - kind) & 15]
                else:
                    c = self._index() if kind == 15 else self._step(2 * kind - 27)
                if kind == 0 or kind >= 13:
                    vertices[vertex & 15] = c
                    vertex += 1
                edges[edge & 15], edges[(edge + 1) & 15] = (c, b), (a, c)
                edge += 2
            else:
                pair = self._byte() if code >= 0xFE else self._table[code & 15]
                if code >= 0xFE and pair == 0:
                    following = 0
                if code == 0xFF:
                    a = self._index()
                else:
                    a, following = following, (following + 1) & _ALL
                new = [a]
                others = []
                for which in (pair >> 4, pair & 15):
                    if which == 0:
                        other, following = following, (following + 1) & _ALL
                    elif which == 15:
                        other = self._index() if code >= 0xFE else -1
                    else:
                        other = vertices[(vertex - which) & 15]
                    others.append(other)
                    if which in (0, 15):
                        new.append(other)
                b, c = others
                edges[edge & 15], edges[(edge + 1) & 15], edges[(edge + 2) & 15] = (b, a), (c, b), (a, c)
                edge += 3
                for other in new:
                    vertices[vertex & 15] = other
                    vertex += 1
            corners += (a, b, c)
        if self._place != len(self._extra):
            raise MeshoptError(f"has {len(self._extra) - self._place} bytes too many")
        return corners

    def _byte(self) -> int:
        if self._place >= len(self._extra):
            raise MeshoptError("is cut off: its last indices are missing")
        self._place += 1
        return self._extra[self._place - 1]

    def _index(self) -> int:
        """An index that is told by its difference from the last that was."""
        value = 0
        for k in range(5):
            byte = self._byte()
            value |= (byte & 127) << (7 * k)
            if byte < 128:
                break
        else:
            raise MeshoptError("has a number of more than five bytes")
        value &= _ALL
        return self._step(~(value >> 1) if value & 1 else value >> 1)

    def _step(self, difference: int) -> int:
        self._last = (self._last + difference) & _ALL
        return self._last


def decode_indices(data: bytes | memoryview, count: int) -> Words:
    """Return `count` indices of any kind, as (count,) uint32.

    Each is told by its difference from one of two others, the last that were told by the same; so two running sums are all there is.
    """
    data = bytes(data)
    if not data or data[0] != _INDICES:
        raise MeshoptError("does not begin as indices do")
    if len(data) < 1 + count + 4:
        raise MeshoptError(f"is cut off: {count} indices cannot be in {len(data)} bytes")
    digits = np.frombuffer(data, np.uint8, len(data) - 5, 1)
    ends = np.flatnonzero(digits < 128)
    if len(ends) != count or (count and ends[-1] != len(digits) - 1) or (not count and len(digits)):
        raise MeshoptError(f"must hold {count} indices, got {len(ends)}")
    starts = np.concatenate([[0], ends[:-1] + 1]).astype(np.int64)[:count]
    lengths = ends + 1 - starts
    if count and int(lengths.max()) > 5:
        raise MeshoptError("has a number of more than five bytes")
    values = np.zeros(count, dtype=np.uint64)
    for k in range(5):
        there = lengths > k
        values[there] |= (digits[starts[there] + k].astype(np.uint64) & np.uint64(127)) << np.uint64(7 * k)
    words = (values & np.uint64(_ALL)).astype(np.int64)
    differences = words >> 2 ^ -(words >> 1 & 1)
    found = np.empty(count, dtype=np.uint32)
    for baseline in (0, 1):
        chosen = (words & 1) == baseline
        found[chosen] = (np.cumsum(differences[chosen]) & _ALL).astype(np.uint32)
    return found


