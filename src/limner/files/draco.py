"""Geometry that is compressed with Draco (KHR_draco_mesh_compression), through its own library.

`DracoPy` wraps it; it is imported when a file needs it.
"""

from __future__ import annotations

import importlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError, UnsupportedError

__all__ = ["DracoError", "DracoMesh", "decode"]

_HELP = 'is compressed with KHR_draco_mesh_compression; pip install "limner[draco]" reads it, `gltf-transform copy` unpacks it'


class DracoError(LimnerError):
    """A stream that cannot be decoded; the message says why, the caller where it stands."""


class DracoMesh(NamedTuple):
    """What a stream holds.

    Attributes
    ----------
    attributes : dict of (n, columns) arrays
        By their number in the stream; of whatever type they were compressed from.
    triangles : (m, 3) uint32
    """

    attributes: dict[int, NDArray[Any]]
    triangles: NDArray[np.uint32]


def decode(data: bytes | memoryview, where: str) -> DracoMesh:
    """Decode a stream.

    Parameters
    ----------
    data : bytes
    where : str
        What is compressed, for the error.

    Raises DracoError for what is no triangle mesh, UnsupportedError where the library is missing.
    """
    try:
        library = importlib.import_module("DracoPy")
    except ImportError:
        raise UnsupportedError(f"{where} {_HELP}") from None
    try:
        mesh = library.decode(bytes(data))
        found = {int(part["unique_id"]): np.atleast_2d(np.asarray(part["data"]).T).T for part in mesh.attributes}
        faces = np.asarray(mesh.faces)
    except Exception as error:  # a decoder on a foreign stream may raise anything
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise DracoError(f"is no readable Draco mesh: {reason}") from None
    n_vertices = {len(values) for values in found.values()}
    if len(n_vertices) != 1 or faces.ndim != 2 or faces.shape[1] != 3:
        raise DracoError("holds no triangles")
    if faces.size and not (int(faces.min()) >= 0 and int(faces.max()) < n_vertices.pop()):
        raise DracoError("has triangles that refer to vertices that it does not have")
    return DracoMesh(found, np.ascontiguousarray(faces, dtype=np.uint32))
