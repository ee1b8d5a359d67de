"""Writing STL, as 3D printers read it: triangles and nothing else, 50 bytes each.

    80 bytes of anything, a count, then of each triangle its normal, its three corners and two bytes of zero

**Source**: 3D Systems, *Stereolithography Interface Specification*, 1989.
"""

from __future__ import annotations

from typing import IO
from warnings import warn

import numpy as np

from ..errors import LimnerWarning, SceneError
from ..mesh.mesh import Mesh
from ..mesh.normals import face_normals
from .world_parts import Part

__all__ = ["write_stl"]

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_AT_ONCE = 1 << 17


def write_stl(parts: list[Part], stream: IO[bytes]) -> None:
    """Write the triangles of all parts."""
    meshes = [part.geometry for part in parts if isinstance(part.geometry, Mesh)]
    if len(meshes) < len(parts):
        warn("points are left out: STL has triangles only", LimnerWarning, stacklevel=4)
    n_triangles = sum(len(mesh.triangles) for mesh in meshes)
    if not n_triangles:
        raise SceneError("there is nothing to save: STL needs triangles")
    # The first word must not be "solid", which begins the other kind.
    stream.write(b"binary STL".ljust(80, b" ") + np.uint32(n_triangles).astype("<u4").tobytes())
    for mesh in meshes:
        for start in range(0, len(mesh.triangles), _AT_ONCE):
            triangles = mesh.triangles[start : start + _AT_ONCE]
            records = np.zeros(len(triangles), dtype=_RECORD)
            records["corners"] = mesh.positions[triangles]
            records["normal"] = face_normals(mesh.positions, triangles)
            stream.write(records.tobytes())
