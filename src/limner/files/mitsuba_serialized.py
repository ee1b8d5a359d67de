"""Meshes as Mitsuba itself stores them: several in one file, each a compressed stream, and where they begin at the end.

    0x041C  version | zlib( flags  [name]  n_vertices  n_triangles  positions  [normals]  [uvs]  [colours]  indices ) … | offsets  count

All little-endian. Of what a stream declares, the counts are compared with the limits before anything is unpacked.

**Source**: the Mitsuba 3 documentation, *Serialized mesh loader*.
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh
from .limits import Limits

__all__ = ["read_serialized"]

_MAGIC = 0x041C
_HAS_NORMALS, _HAS_UVS, _HAS_COLORS, _DOUBLE = 0x0001, 0x0002, 0x0008, 0x2000


def read_serialized(data: bytes, index: int, limits: Limits) -> Mesh:
    """Read one mesh of a .serialized file.

    Parameters
    ----------
    data : bytes
    index : int
        Which mesh, from 0.
    limits : Limits

    Raises ValueError, which says what is wrong, for what is no such file.
    """
    version = _header(data, 0)
    begin, end = _extent(data, index, version)
    stream = _Stream(data[begin + 4 : end])
    (flags,) = stream.numbers("<I", 4)
    name = stream.text() if version >= 4 else ""
    n_vertices, n_triangles = stream.numbers("<QQ", 16)
    if n_vertices > limits.max_vertices or n_triangles > limits.max_triangles:
        raise ValueError(f"has {n_vertices} vertices and {n_triangles} triangles, more than the limits allow (max_vertices, max_triangles)")
    dtype = np.dtype("<f8" if flags & _DOUBLE else "<f4")

    def rows(columns: int) -> NDArray[np.float32]:
        with np.errstate(over="ignore"):
            return stream.array(dtype, n_vertices * columns).reshape(-1, columns).astype(np.float32)

    positions = rows(3)
    normals = rows(3) if flags & _HAS_NORMALS else None
    uvs = rows(2) if flags & _HAS_UVS else None
    colors = rows(3) if flags & _HAS_COLORS else None
    indices = stream.array(np.dtype("<u8" if n_vertices > 0xFFFFFFFF else "<u4"), n_triangles * 3).reshape(-1, 3)
    if indices.size and int(indices.max()) >= n_vertices:
        raise ValueError(f"refers to vertex {int(indices.max())} of {n_vertices}")
    if not np.isfinite(positions).all():
        raise ValueError("has positions that are not finite")
    return Mesh(positions, indices.astype(np.int32), normals=normals, uvs=uvs, colors=colors, name=name)


def _header(data: bytes, at: int) -> int:
    """The version; 3 or 4."""
    if len(data) < at + 4:
        raise ValueError("is cut off")
    magic, version = struct.unpack_from("<HH", data, at)
    if magic != _MAGIC or version not in (3, 4):
        raise ValueError("is no serialized mesh of version 3 or 4")
    return int(version)


def _extent(data: bytes, index: int, version: int) -> tuple[int, int]:
    """Where the mesh begins, and where the next one or the list of beginnings does."""
    (count,) = struct.unpack("<I", data[-4:])
    width = 8 if version >= 4 else 4
    table = len(data) - 4 - count * width
    if not 0 < count <= len(data) // width or table < 4:
        raise ValueError("is cut off: it has no list of its meshes")
    if not 0 <= index < count:
        raise ValueError(f"has {count} meshes; there is none of index {index}")
    begins = [*np.frombuffer(data, dtype=f"<u{width}", count=count, offset=table).tolist(), table]
    begin, end = int(begins[index]), int(begins[index + 1])
    if not 0 <= begin < end <= table:
        raise ValueError("says that a mesh lies outside the file")
    _header(data, begin)
    return begin, end


class _Stream:
    """What a compressed stream holds, unpacked as far as it is asked for."""

    def __init__(self, packed: bytes) -> None:
        self._unpacker = zlib.decompressobj()
        self._packed = packed
        self._ready = b""

    def take(self, n_bytes: int) -> bytes:
        while len(self._ready) < n_bytes:
            try:
                more = self._unpacker.decompress(self._packed, n_bytes - len(self._ready))
            except zlib.error:
                raise ValueError("is no sound compressed stream") from None
            self._packed = self._unpacker.unconsumed_tail
            if not more:
                raise ValueError("is cut off: it declares more than it holds")
            self._ready += more
        taken, self._ready = self._ready[:n_bytes], self._ready[n_bytes:]
        return taken

    def numbers(self, layout: str, n_bytes: int) -> tuple[int, ...]:
        return struct.unpack(layout, self.take(n_bytes))

    def text(self) -> str:
        letters = bytearray()
        while (letter := self.take(1)) != b"\0":
            letters += letter
            if len(letters) > 1000:
                raise ValueError("has a name of more than 1000 letters")
        return letters.decode("utf-8", "replace")

    def array(self, dtype: np.dtype, count: int) -> NDArray:  # type: ignore[type-arg]
        return np.frombuffer(self.take(count * dtype.itemsize), dtype=dtype)
