"""The arrays of a scene: few numbers stand in the text, many in one .npz file beside it, each once.

The file's name holds a digest of what is in it: a text that is being replaced goes on naming the arrays it was written with, until the
new one stands in its place.

**Source**: NumPy Enhancement Proposal 1 (the .npy format); an .npz is a ZIP of these.
"""

from __future__ import annotations

import hashlib
import io
import math
import zipfile
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from .limits import Limits
from .notes import quoted

__all__ = ["INLINE", "ArrayReader", "ArrayWriter", "inline", "outline"]

INLINE = 64
"""How many numbers stand in the text at most."""

_KINDS = "biufc"
_EPOCH = (1980, 1, 1, 0, 0, 0)  # so that equal arrays make equal files


def inline(array: NDArray[Any], dtypes: tuple[np.dtype[Any], ...]) -> Any:
    """An array as plain values that say it to the bit; None where it is too large, or has none.

    Lists alone where the type follows from the field, which may hold `dtypes`.
    """
    if array.size > INLINE or array.dtype.kind == "c" or not array.dtype.isnative or array.dtype.itemsize not in (1, 4, 8):
        return None
    values = _shortest(array)
    if dtypes == (array.dtype,) and array.size:
        made = np.array(values).astype(array.dtype)
        return values if made.shape == array.shape and made.tobytes() == array.tobytes() else None
    said = {"dtype": array.dtype.name, "shape": list(array.shape), "values": np.array(values, dtype=object).reshape(-1).tolist()}
    return said if outline(said).tobytes() == array.tobytes() else None


def _shortest(array: NDArray[Any]) -> Any:
    """Nested lists, each float32 with as few digits as tell it from its neighbours."""
    if array.dtype != np.float32:
        return array.tolist()
    shortest = np.array([float(str(value)) for value in array.reshape(-1)], dtype=np.float64)
    return (shortest if (shortest.astype(np.float32) == array.reshape(-1)).all() else array).reshape(array.shape).tolist()


def outline(said: dict[str, Any]) -> NDArray[Any]:
    """The array that ``{dtype, shape, values}`` say; ValueError or OverflowError where they say none."""
    values = said.get("values") or []
    array = np.array(values, dtype=said.get("dtype")) if values else np.zeros(0, dtype=said.get("dtype"))
    if array.dtype.kind not in _KINDS:
        raise ValueError(f"numbers or flags are expected, got {array.dtype}")
    if array.dtype.kind in "iu" and not (array == np.array(values, dtype=object).reshape(array.shape)).all():
        raise ValueError(f"not all of them are {array.dtype}")
    shape = said.get("shape")
    return array if shape is None else array.reshape(shape)


class ArrayWriter:
    """Arrays for one file, by name; equal ones are kept once."""

    def __init__(self) -> None:
        self._arrays: dict[str, NDArray[Any]] = {}
        self._numbers: Counter[str] = Counter()
        self._by_content: dict[tuple[str, tuple[int, ...], bytes], str] = {}

    def __bool__(self) -> bool:
        return bool(self._arrays)

    def add(self, name: str, array: NDArray[Any]) -> str:
        """Keep an array, and return under which name."""
        array = np.ascontiguousarray(array).reshape(array.shape)
        flat: Any = array.reshape(-1).view(np.uint8)
        content = array.dtype.str, array.shape, hashlib.blake2b(flat, digest_size=16).digest()
        if content not in self._by_content:
            kept = name
            while kept in self._arrays:
                self._numbers[name] += 1
                kept = f"{name}-{self._numbers[name] + 1}"
            self._arrays[kept] = array
            self._by_content[content] = kept
        return self._by_content[content]

    def digest(self) -> str:
        """16 hexadecimal digits that say what is kept, and under which names."""
        state = hashlib.blake2b(digest_size=8)
        for (dtype, shape, content), name in self._by_content.items():
            state.update(repr((dtype, shape, name)).encode() + content)
        return state.hexdigest()

    def to_bytes(self) -> bytes:
        """An .npz file, the same for the same arrays."""
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, array in self._arrays.items():
                entry = zipfile.ZipInfo(f"{name}.npy", _EPOCH)
                entry.compress_type = zipfile.ZIP_DEFLATED
                with archive.open(entry, "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, array, version=(1, 0), allow_pickle=False)
        return stream.getvalue()


class ArrayReader:
    """The arrays of one .npz file, each read when it is asked for.

    Raises FileFormatError for what is no such file, or unpacks to more than `limits` allow; never unpickles.
    """

    def __init__(self, data: bytes, name: str, limits: Limits) -> None:
        self._name = name
        self._read: dict[str, NDArray[Any]] = {}
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(data))
            self._entries = {entry.filename.removesuffix(".npy"): entry for entry in self._archive.infolist()}
        except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
            raise FileFormatError(f"is no .npz file: {error}", name) from None
        unpacked = sum(entry.file_size for entry in self._entries.values())
        if unpacked > limits.max_file_bytes:
            raise FileFormatError(f"unpacks to {unpacked} bytes, more than {limits.max_file_bytes} (max_file_bytes)", name)

    @property
    def names(self) -> list[str]:
        """Of all arrays."""
        return list(self._entries)

    def get(self, name: str) -> NDArray[Any]:
        """One array; KeyError where there is none of that name."""
        entry = self._entries[name]
        if name not in self._read:
            try:
                self._read[name] = _array(self._archive.read(entry))
            except (zipfile.BadZipFile, ValueError, EOFError, OSError, RuntimeError, NotImplementedError, MemoryError) as error:
                raise FileFormatError(f"array {quoted(name)} cannot be read: {' '.join(str(error).split())}", self._name) from None
        return self._read[name]


def _array(data: bytes) -> NDArray[Any]:
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    if version not in ((1, 0), (2, 0)):
        raise ValueError(f"its format is of version {version[0]}.{version[1]}, not 1.0 or 2.0")
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, is_fortran, dtype = read_header(stream)
    if dtype.kind not in _KINDS:
        raise ValueError(f"it holds {dtype}, not numbers or flags")
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise ValueError(f"its size is not that of {shape} {dtype}")
    array: NDArray[Any] = np.frombuffer(data, dtype=dtype, offset=stream.tell())
    return array.reshape(shape[::-1]).T if is_fortran else array.reshape(shape)
