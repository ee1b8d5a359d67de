"""Numbers out of a glTF file: buffers, buffer views, accessors (glTF 2.0, section 3.6).

    accessor (count, type, component type)  ->  buffer view (offset, length, stride)  ->  buffer (bytes)  ->  .bin, data:, GLB

Each arrow is an index and each number a promise of the file; all are checked against the bytes that are really there before
an array is made. Where the layout allows, the array is a view of the file's own bytes. A buffer view that is compressed
(EXT_meshopt_compression, KHR_meshopt_compression) is decompressed when it is first looked at.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError
from .document import Element
from .meshopt import MeshoptError, decode
from .notes import Notes
from .sources import Sources

__all__ = ["Accessors"]

COMPONENTS: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}

# An accessor without data stands for zeros, as many as it says. No real file has more than a few.
MAX_IMPLIED_ZEROS = 1 << 22
# Accessors may overlap, so that their sum may exceed the file; this many elements for each vertex that is allowed.
READS_PER_VERTEX = 8
MESHOPT = ("KHR_meshopt_compression", "EXT_meshopt_compression")


class _View(NamedTuple):
    data: memoryview
    stride: int
    element: Element


class Accessors:
    """The numbers of one glTF file, read when asked for, each accessor once.

    Parameters
    ----------
    root : Element
        The document.
    binary : memoryview, optional
        The binary chunk of a GLB file.
    """

    def __init__(self, root: Element, binary: memoryview | None, sources: Sources, notes: Notes) -> None:
        self._accessors = root.array("accessors")
        self._views = root.array("bufferViews")
        self._buffers = root.array("buffers")
        self._binary = binary
        self._sources = sources
        self._notes = notes
        self._read_buffers: dict[int, memoryview | LimnerError] = {}
        self._read_accessors: dict[int, NDArray[Any]] = {}
        self._supplied: dict[int, NDArray[Any] | FileFormatError] = {}
        self._decompressed: dict[int, memoryview | FileFormatError] = {}
        self._n_decompressed = 0
        self._n_zeros = 0
        self._n_elements = 0
        self._check_references()

    def _check_references(self) -> None:
        # Before anything is read: a file that reaches out of its folder is refused as a whole.
        for buffer in self._buffers:
            uri = buffer.value.get("uri") if isinstance(buffer.value, dict) else None
            if isinstance(uri, str) and uri[:5].lower() != "data:":
                self._sources.check(uri, f"{buffer.pointer}/uri")

    def __len__(self) -> int:
        return len(self._accessors)

    def read(self, reference: Element, *types: str) -> NDArray[Any]:
        """Return the accessor that `reference` (an index) names, as (count, columns) in the file's own component type.

        Raises FileFormatError where it is not one of the given `types` ("VEC3"), or is not what it says.
        """
        index = reference.index(len(self._accessors))
        accessor = self._accessors[index]
        kind = accessor.child("type").text()
        if kind not in types:
            raise accessor.error(f"must be {' or '.join(types)}, got {kind!r}", "type")
        if index in self._supplied:
            return _supplied(self._supplied[index], accessor, COLUMNS[kind])
        if index not in self._read_accessors:
            self._read_accessors[index] = self._read(accessor, COLUMNS[kind])
        return self._read_accessors[index]

    def supply(self, reference: Element, values: NDArray[Any] | FileFormatError) -> None:
        """Say what an accessor holds that has no bytes of its own, (count, columns), or why it cannot be had."""
        self._supplied[reference.index(len(self._accessors))] = values

    def floats(self, reference: Element, *types: str, normalize: bool = False) -> NDArray[np.float32]:
        """Return an accessor as (count, columns) float32; normalised integers, or all with `normalize`, as fractions.

        **Source**: glTF 2.0, 3.6.2.2 (normalised integers): f = c / 255, f = max(c / 127, -1), and so on.
        """
        values = self.read(reference, *types)
        if values.dtype.kind == "f":
            return values
        accessor = self._accessors[reference.index(len(self._accessors))]
        if normalize or accessor.get_flag("normalized", False):
            fractions = values.astype(np.float32) * np.float32(1.0 / np.iinfo(values.dtype).max)
            return np.maximum(fractions, np.float32(-1.0)) if values.dtype.kind == "i" else fractions
        return values.astype(np.float32)

    def is_normalized(self, reference: Element) -> bool:
        """Whether an accessor holds floats or declares its integers to be fractions."""
        accessor = self._accessors[reference.index(len(self._accessors))]
        return accessor.get_integer("componentType", 0) == 5126 or accessor.get_flag("normalized", False)

    def indices(self, reference: Element) -> NDArray[Any]:
        """Return a scalar accessor of unsigned integers as (count,)."""
        values = self.read(reference, "SCALAR")
        if values.dtype.kind != "u":
            accessor = self._accessors[reference.index(len(self._accessors))]
            raise accessor.error(f"indices must be unsigned integers, got {values.dtype}", "componentType")
        return values.reshape(-1)

    def count(self, reference: Element) -> int:
        """How many elements an accessor declares, or was supplied with; nothing is read."""
        supplied = self._supplied.get(reference.index(len(self._accessors)))
        if isinstance(supplied, np.ndarray):
            return len(supplied)
        return self._accessors[reference.index(len(self._accessors))].child("count").integer()

    def type_of(self, reference: Element) -> str:
        """What an accessor says that it holds, "SCALAR", "VEC3"; nothing is read, and nothing is found fault with."""
        try:
            return str(self._accessors[reference.index(len(self._accessors))].child("type").value)
        except LimnerError:
            return ""

    def has_data(self, reference: Element) -> bool:
        """Whether an accessor refers to bytes; compressed geometry does not."""
        accessor = self._accessors[reference.index(len(self._accessors))]
        return accessor.has("bufferView") or accessor.has("sparse")

    def view_bytes(self, reference: Element) -> memoryview:
        """Return the bytes of the buffer view that `reference` names."""
        return self._view(reference).data

    def _read(self, accessor: Element, columns: int) -> NDArray[Any]:
        dtype = _component_type(accessor)
        count = accessor.child("count").integer(1)
        self._n_elements += count
        if self._n_elements > READS_PER_VERTEX * self._sources.limits.max_vertices:
            raise accessor.error("exceeds the limits of vertices for one model (max_vertices)", "count")
        sparse = accessor.get("sparse")
        reference = accessor.get("bufferView")
        if reference is None:
            values = self._zeros(accessor, count, columns, dtype)
        else:
            offset = accessor.get_integer("byteOffset", 0)
            values = _elements(self._view(reference), offset, count, columns, dtype, accessor)
        return values if sparse is None else self._patch(values, sparse)

    def _zeros(self, accessor: Element, count: int, columns: int, dtype: np.dtype[Any]) -> NDArray[Any]:
        self._n_zeros += count * columns
        if self._n_zeros > MAX_IMPLIED_ZEROS:
            raise accessor.error("declares more elements without data than any file needs", "count")
        if not accessor.has("sparse"):
            self._notes.add("has no data and stands for zeros", accessor.pointer)
        return np.zeros((count, columns), dtype=dtype)

    def _patch(self, base: NDArray[Any], sparse: Element) -> NDArray[Any]:
        count = sparse.child("count").integer(1)
        places, replacements = sparse.child("indices"), sparse.child("values")
        index_type = _component_type(places)
        if index_type.kind != "u":
            raise places.error(f"sparse indices must be unsigned integers, got {index_type}", "componentType")
        where = self._view(places.child("bufferView"))
        rows = _elements(where, places.get_integer("byteOffset", 0), count, 1, index_type, places).reshape(-1)
        source = self._view(replacements.child("bufferView"))
        offset = replacements.get_integer("byteOffset", 0)
        values = _elements(source, offset, count, base.shape[1], base.dtype, replacements)
        if int(rows.max()) >= len(base):
            raise places.error(f"a sparse index must be below {len(base)}, got {int(rows.max())}")
        patched = base.copy()
        patched[rows] = values
        return patched

    def _view(self, reference: Element) -> _View:
        index = reference.index(len(self._views))
        view = self._views[index]
        stride = view.get_integer("byteStride", 0, 1)
        compressed = next((found for name in MESHOPT if (found := view.extension(name)) is not None), None)
        if compressed is None:
            return _View(self._part_of_buffer(view), stride, view)
        if index not in self._decompressed:
            try:
                self._decompressed[index] = self._decompress(compressed, view)
            except FileFormatError as error:
                self._decompressed[index] = error
        data = self._decompressed[index]
        if isinstance(data, FileFormatError):
            raise data
        return _View(data, stride, view)

    def _part_of_buffer(self, view: Element) -> memoryview:
        """The bytes that a buffer view, or what stands in for it where it is compressed, says that it has."""
        buffer_index = view.child("buffer").index(len(self._buffers))
        data = self._buffer(buffer_index)
        offset, length = view.get_integer("byteOffset", 0), view.child("byteLength").integer(1)
        if offset + length > len(data):
            raise view.error(f"needs {offset + length} bytes of {self._buffers[buffer_index].pointer}, which has {len(data)}")
        return data[offset : offset + length]

    def _decompress(self, compressed: Element, view: Element) -> memoryview:
        count, stride = compressed.child("count").integer(1), compressed.child("byteStride").integer(1)
        if count * stride != view.child("byteLength").integer(1):
            raise view.error(f"must be {count} elements of {stride} bytes, as it says where it is compressed", "byteLength")
        self._n_decompressed += count * stride
        if self._n_decompressed > self._sources.limits.max_file_bytes:
            raise compressed.error("exceeds, decompressed, the limit of bytes for one model (max_file_bytes)", "count")
        mode, filtering = compressed.child("mode").text(), compressed.get_text("filter", "NONE")
        try:
            return decode(self._part_of_buffer(compressed), count, stride, mode, filtering).data
        except MeshoptError as error:
            raise compressed.error(f"cannot be decompressed: it {error}") from None

    def _buffer(self, index: int) -> memoryview:
        if index not in self._read_buffers:
            try:
                self._read_buffers[index] = self._load_buffer(index)
            except LimnerError as error:
                self._read_buffers[index] = error
        found = self._read_buffers[index]
        if isinstance(found, LimnerError):
            raise found
        return found

    def _load_buffer(self, index: int) -> memoryview:
        buffer = self._buffers[index]
        declared = buffer.child("byteLength").integer(1)
        uri = buffer.get("uri")
        if uri is not None:
            data = memoryview(self._sources.read_uri(uri.text(), uri.pointer))
        elif index == 0 and self._binary is not None:
            data = self._binary
        else:
            raise buffer.error("has neither a uri nor a binary chunk")
        if len(data) < declared:
            self._notes.slip(f"is cut off: it declares {declared} bytes, there are {len(data)}", buffer.pointer)
        return data[:declared]


def _supplied(values: NDArray[Any] | FileFormatError, accessor: Element, columns: int) -> NDArray[Any]:
    if isinstance(values, FileFormatError):
        raise values
    if values.shape[1] != columns:
        raise accessor.error(f"must have {columns} numbers for each element, its compressed stream has {values.shape[1]}", "type")
    return values


def _component_type(element: Element) -> np.dtype[Any]:
    code = element.child("componentType").integer()
    if code not in COMPONENTS:
        raise element.error(f"must be one of {', '.join(map(str, COMPONENTS))}, got {code}", "componentType")
    return COMPONENTS[code]


def _elements(view: _View, offset: int, count: int, columns: int, dtype: np.dtype[Any], owner: Element) -> NDArray[Any]:
    """Look at `count` rows of `columns` numbers in a buffer view; a copy only where the bytes lie interleaved or unaligned."""
    size = columns * dtype.itemsize
    stride = view.stride or size
    if stride < size:
        raise view.element.error(f"must be at least {size}, the size of one element, got {stride}", "byteStride")
    needed = offset + (count - 1) * stride + size
    if needed > len(view.data):
        raise owner.error(f"needs {needed} bytes of {view.element.pointer}, which has {len(view.data)}")
    window = np.frombuffer(view.data, dtype=np.uint8)[offset:needed]
    if stride == size:
        rows = window.view(dtype).reshape(count, columns)
    else:
        strided: NDArray[np.uint8] = np.lib.stride_tricks.as_strided(window, (count, size), (stride, 1), writeable=False)
        rows = np.ascontiguousarray(strided).view(dtype).reshape(count, columns)
    return np.require(rows, dtype=dtype.newbyteorder("="), requirements=["C", "A"])
