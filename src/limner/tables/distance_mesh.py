"""Triangles of a field of distances: what the rasteriser draws of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..mesh.implicit.marching_cubes import marching_cubes
from ..mesh.mesh import Mesh
from ..mesh.reshape.trim import Surface
from ..scene.distance_field import DistanceField

__all__ = ["distance_mesh"]

_ROOM = 1e-3  # of an extent, by which the grid is larger than the box
# Of the faces +x, -x, +y, -y, +z, -z of a box: what u and v grow along, as rays have it (`limner.intersect.cuboid`)
_ALONG_U = np.array([[0, 0, -1], [0, 0, 1], [1, 0, 0], [1, 0, 0], [1, 0, 0], [-1, 0, 0]], dtype=np.float64)
_ALONG_V = np.array([[0, 1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1], [0, 1, 0], [0, 1, 0]], dtype=np.float64)


def distance_mesh(field: DistanceField, n: int) -> Mesh:
    """Find the triangles of a field.

    Parameters
    ----------
    field : DistanceField
    n : int >= 1
        Cubes along the longest edge of its box.

    Returns
    -------
    Mesh
        Its vertices on the surface, with the field's normals; texture coordinates as on the faces of its box, of each triangle those of
        the face to which it looks most.
    """
    low, high = field.bounds
    room = _ROOM * (high - low)
    surface = marching_cubes(field.expression.distance, np.array([low - room, high + room]), n)
    positions, triangles = surface.positions.astype(np.float64), surface.triangles.astype(np.int64)
    assert surface.normals is not None
    face = _faces(positions[triangles])
    # A vertex where triangles look to different faces has texture coordinates of each
    keys, corner_of = np.unique(triangles * 6 + face[:, None], return_inverse=True)
    vertex, face = np.divmod(keys, 6)
    share = (positions[vertex] - (low + high) / 2.0) / (high - low)
    u, v = 0.5 + (share * _ALONG_U[face]).sum(axis=1), 0.5 + (share * _ALONG_V[face]).sum(axis=1)
    corners = np.column_stack([positions[vertex], surface.normals[vertex], u, v])
    return Surface(corners, corner_of.reshape(-1, 3).astype(np.int64)).mesh()


def _faces(p: NDArray[np.float64]) -> NDArray[np.int64]:
    """(m,): the faces of a box to which triangles (m, 3, 3) look most."""
    across = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    axis = np.abs(across).argmax(axis=1)
    return np.asarray(2 * axis + (np.take_along_axis(across, axis[:, None], axis=1)[:, 0] < 0.0), dtype=np.int64)
