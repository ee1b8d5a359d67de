"""What kernels ask of an instance whose hits they look up eight at a time: rows of plain numbers, since lanes read no records."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import layouts
from .layouts import SceneTables

__all__ = ["COLOR", "FIRST_POSITION", "FIRST_TRIANGLE", "IS_PLAIN", "WORLD_FROM_NORMAL", "WORLD_FROM_OBJECT", "facets_of"]

# Columns: of the numbers
WORLD_FROM_OBJECT, WORLD_FROM_NORMAL, COLOR = 0, 12, 21
_N_NUMBERS = 24
# of the places
FIRST_POSITION, FIRST_TRIANGLE, IS_PLAIN = 0, 1, 2
_N_PLACES = 4


def facets_of(tables: SceneTables) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """(instances, 24) float32: matrices and the material's colour; (instances, 4) int32: where its mesh begins, and whether it is plain.

    Plain are meshes without normals, vertex colours and several materials, of a matte material that does not shine.
    """
    instances, meshes, materials = tables.instances, tables.meshes, tables.materials
    n = len(instances)
    numbers, places = np.zeros((n, _N_NUMBERS), dtype=np.float32), np.zeros((n, _N_PLACES), dtype=np.int32)
    numbers[:, WORLD_FROM_OBJECT:WORLD_FROM_NORMAL] = instances["world_from_object"].reshape(n, 12)
    numbers[:, WORLD_FROM_NORMAL:COLOR] = instances["world_from_normal"].reshape(n, 9)
    has_mesh = np.flatnonzero(instances["mesh"] >= 0)
    if len(has_mesh):
        mesh, material = meshes[instances["mesh"][has_mesh]], materials[instances["material"][has_mesh]]
        numbers[has_mesh, COLOR:] = material["color"]
        places[has_mesh, FIRST_POSITION], places[has_mesh, FIRST_TRIANGLE] = mesh["position"], mesh["triangle"]
        is_bare = (mesh["normal"] < 0) & (mesh["color"] < 0) & (mesh["slot"] < 0)
        is_dark = (material["kind"] == layouts.LAMBERT) & ~(material["emission"] > 0.0).any(axis=1)
        places[has_mesh, IS_PLAIN] = is_bare & is_dark
    return numbers, places
