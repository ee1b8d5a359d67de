"""The binary container of glTF (glTF 2.0, section 4): a header, a chunk of JSON, a chunk of bytes.

    "glTF" version length | length "JSON" {...} | length "BIN\\0" ...

**Source**: Khronos Group, *glTF 2.0 Specification*, 4.4. A chunk that ends early is taken as far as it goes: whatever of
the geometry lies in the part that arrived can still be drawn.
"""

from __future__ import annotations

import os
import struct
from typing import NamedTuple

from ..errors import FileFormatError, UnsupportedError
from .notes import Notes

__all__ = ["MAGIC", "Container", "read_container"]

MAGIC = b"glTF"
JSON_CHUNK = 0x4E4F534A
BINARY_CHUNK = 0x004E4942


class Container(NamedTuple):
    """The two chunks; `binary` is None where there is none."""

    json: memoryview
    binary: memoryview | None


def read_container(data: bytes, path: str | os.PathLike[str], notes: Notes) -> Container:
    """Take a GLB file apart without copying it.

    Raises FileFormatError, with the byte, for a wrong magic number or a JSON chunk that is missing or cut off, and
    UnsupportedError for other versions than 2.
    """
    if not data:
        raise FileFormatError("the file is empty", path)
    if data[:4] != MAGIC:
        raise FileFormatError(f'a GLB file must begin with "glTF", got {data[:4]!r}', path, "byte 0")
    if len(data) < 12:
        raise FileFormatError(f"the header of a GLB file has 12 bytes, the file ends after {len(data)}", path)
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise UnsupportedError(f"{os.fspath(path)}: GLB version {version} is not supported, only version 2 is")
    if length > len(data):
        notes.slip(f"the file is cut off: its header declares {length} bytes, there are {len(data)}")
    elif length < len(data):
        notes.add(f"{len(data) - length} bytes after the end of the GLB are ignored")
    return _read_chunks(memoryview(data)[: max(length, 12)], path, notes)


def _read_chunks(view: memoryview, path: str | os.PathLike[str], notes: Notes) -> Container:
    json_chunk: memoryview | None = None
    binary: memoryview | None = None
    position = 12
    while position + 8 <= len(view):
        length, kind = struct.unpack_from("<II", view, position)
        chunk = view[position + 8 : position + 8 + length]
        if json_chunk is None:
            if kind != JSON_CHUNK:
                raise FileFormatError("the first chunk of a GLB file must be JSON", path, f"byte {position + 4}")
            if len(chunk) < length:
                raise FileFormatError(
                    f"the JSON chunk is cut off: it declares {length} bytes, {len(chunk)} are left", path, f"byte {position}"
                )
            json_chunk = chunk
        elif kind == BINARY_CHUNK and binary is None:
            if len(chunk) < length:
                notes.slip(f"the binary chunk is cut off: it declares {length} bytes, {len(chunk)} are left")
            binary = chunk
        else:
            notes.add(f"a chunk of kind 0x{kind:08X} at byte {position} of the GLB is ignored")
        position += 8 + length
    if json_chunk is None:
        raise FileFormatError("the GLB file has no JSON chunk", path, "byte 12")
    return Container(json_chunk, binary)
