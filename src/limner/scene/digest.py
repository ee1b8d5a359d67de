"""A short word for a whole scene, so that two can be told apart without keeping either.

Everything that may change a pixel goes in: geometry, materials, texels, lights, places, what lies behind. Names and notes stay out.
The same scene has the same digest in every process and on every machine; a scene with one bit changed has another.
"""

from __future__ import annotations

import dataclasses
import enum
import hashlib
import os
import struct
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh
from .environment import Environment
from .node import Node
from .scene import Scene
from .texture import Texels

__all__ = ["scene_digest"]

_SIZE = 16  # bytes
_SILENT = ("name", "notes")  # fields that change no pixel

_kept: WeakKeyDictionary[Mesh | Texels, bytes] = WeakKeyDictionary()
"""What large things hash to. They are never changed, and are shared by the pictures of a series."""


def scene_digest(scene: Scene) -> str:
    """Return 32 hexadecimal digits that say what is in a scene.

    Parameters
    ----------
    scene : Scene
        An environment that is a file counts with what the file holds, not with its name.

    >>> one, other = Scene(background=(0.0, 0.0, 0.0)), Scene(background=(0.0, 0.0, 1.0))
    >>> scene_digest(one) == scene_digest(one.replace(name="again")), scene_digest(one) == scene_digest(other)
    (True, False)

    **Source**: BLAKE2b, RFC 7693.
    """
    digester = _Digester()
    state = hashlib.blake2b(digest_size=_SIZE)
    # In preorder with the number of children: the tree, without recursion into its depth.
    for placed in scene.root.walk():
        state.update(digester.of(placed.node, without=("children",)) + struct.pack("<q", len(placed.node.children)))
    state.update(digester.of(scene, without=("root",)))
    return state.hexdigest()


class _Digester:
    """Hashes plain values, arrays, and dataclasses of them; what is met twice is hashed once."""

    def __init__(self) -> None:
        self._met: dict[int, tuple[Any, bytes]] = {}

    def of(self, value: Any, without: tuple[str, ...] = ()) -> bytes:
        """The digest of a value of any kind that a description may hold."""
        if isinstance(value, (Mesh, Texels)):
            if value not in _kept:
                _kept[value] = self._of_fields(value, without)
            return _kept[value]
        if not dataclasses.is_dataclass(value):
            return _hashed(*self._plain(value))
        if id(value) not in self._met or isinstance(value, (Node, Scene)):
            self._met[id(value)] = value, self._of_fields(value, without)
        return self._met[id(value)][1]

    def _of_fields(self, value: Any, without: tuple[str, ...]) -> bytes:
        """Fields that are None count as if they were not there: one more that nobody sets changes nothing."""
        parts = [type(value).__name__.encode()]
        for field in sorted(dataclasses.fields(value), key=lambda field: field.name):
            held = getattr(value, field.name)
            if field.name in _SILENT or field.name in without or held is None:
                continue
            if isinstance(value, Environment) and field.name == "source" and isinstance(held, str):
                held = _file_digest(held)
            parts += [field.name.encode(), self.of(held)]
        return _hashed("object", b"\0".join(parts))

    def _plain(self, value: Any) -> tuple[str, bytes | NDArray[np.uint8]]:
        """A word for the kind of a value, and its bytes."""
        if isinstance(value, np.ndarray):
            array = np.ascontiguousarray(value)
            little = array.astype(array.dtype.newbyteorder("<"), copy=False)
            return f"array {little.dtype.str} {value.shape}", little.reshape(-1).view(np.uint8)
        if isinstance(value, (bool, np.bool_)):
            return "bool", bytes([bool(value)])
        if isinstance(value, (int, np.integer)):
            return "int", str(int(value)).encode()
        if isinstance(value, (float, np.floating)):
            return "float", struct.pack("<d", float(value))
        if isinstance(value, enum.Enum):
            return "enum", f"{type(value).__name__}.{value.name}".encode()
        if isinstance(value, (str, os.PathLike)):
            return "text", os.fspath(value).encode("utf-8", "surrogatepass")
        if isinstance(value, bytes):
            return "bytes", value
        if isinstance(value, (tuple, list)):
            return "row", b"".join(self.of(part) for part in value)
        if isinstance(value, dict):
            return "map", b"".join(sorted(self.of(key) + self.of(held) for key, held in value.items()))
        # Of a function, or what else a description may hold, the name is all that is the same in every process.
        kind = value if callable(value) else type(value)
        return "named", f"{getattr(kind, '__module__', '')}.{getattr(kind, '__qualname__', '')}".encode()


def _hashed(kind: str, data: bytes | NDArray[np.uint8]) -> bytes:
    state = hashlib.blake2b(kind.encode() + b"\0", digest_size=_SIZE)
    state.update(memoryview(data))  # type: ignore[arg-type]
    return state.digest()


def _file_digest(path: str) -> bytes | str:
    """What a file holds; its name where it cannot be read."""
    try:
        return _hashed("file", Path(path).read_bytes())
    except OSError:
        return path
