"""The five regular solids, and the box: flat faces, each with its own normal and the whole texture.

A solid is its corners and its faces; what is dual to it has a corner in each face's middle and a face round each corner, which is how
the dodecahedron comes out of the icosahedron.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..mesh import Mesh
from ..sizes import check_length, edge_lengths

__all__ = ["box", "cube", "dodecahedron", "icosahedron", "icosahedron_corners", "octahedron", "tetrahedron"]

Points = NDArray[np.float64]
Indices = NDArray[np.int64]

# The axes (u, v) of each face of a box, u x v = n: v is up on the walls; floor and ceiling have u along +x.
_BOX_FACES = (
    ((0, 0, -1), (0, 1, 0)),
    ((0, 0, 1), (0, 1, 0)),
    ((1, 0, 0), (0, 0, -1)),
    ((1, 0, 0), (0, 0, 1)),
    ((1, 0, 0), (0, 1, 0)),
    ((-1, 0, 0), (0, 1, 0)),
)


def box(size: ArrayLike = (1.0, 1.0, 1.0)) -> Mesh:
    """Make an axis-aligned box around the origin.

    Parameters
    ----------
    size : three floats > 0, or one for all
        Edge lengths, metres.

    Returns
    -------
    Mesh
        8 positions, 12 triangles, 6 normals: flat faces in the order +x, -x, +y, -y, +z, -z. Each face shows the whole texture,
        not mirrored: v up on the walls, u along +x on the faces +y and -y.
    """
    edges = edge_lengths(size, 3, "box.size")
    u, v = np.array(_BOX_FACES, dtype=np.int64).transpose(1, 0, 2)
    n = np.cross(u, v)
    signs = np.stack([n - u - v, n + u - v, n + u + v, n - u + v], axis=1)
    corners = (signs > 0) @ np.array([4, 2, 1])
    split = np.array([[0, 1, 2], [0, 2, 3]])
    positions = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * edges
    return Mesh(
        positions=positions.astype(np.float32),
        triangles=corners[:, split].reshape(12, 3).astype(np.int32),
        normals=n.astype(np.float32),
        normal_triangles=np.repeat(np.arange(6), 6).reshape(12, 3).astype(np.int32),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32),
        uv_triangles=np.tile(split, (6, 1)).astype(np.int32),
        name="box",
    )


def tetrahedron(radius: float = 1.0) -> Mesh:
    """Make a regular tetrahedron, its corners at the distance `radius` > 0 from the origin, one of them on +y."""
    third, side = -1.0 / 3.0, math.sqrt(8.0) / 3.0
    around = 2.0 * math.pi * np.arange(3) / 3.0
    ring = np.stack([side * np.cos(around), np.full(3, third), -side * np.sin(around)], axis=1)
    corners = np.concatenate([[[0.0, 1.0, 0.0]], ring])
    return _regular(corners, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]), radius, "tetrahedron")


def cube(radius: float = 1.0) -> Mesh:
    """Make a cube, its corners at the distance `radius` > 0 from the origin, its edges along the axes; see `box`."""
    check_length(radius, "cube.radius")
    return box(2.0 * radius / math.sqrt(3.0))


def octahedron(radius: float = 1.0) -> Mesh:
    """Make a regular octahedron, its corners on the axes at the distance `radius` > 0 from the origin."""
    corners = np.array([[1, 0, 0], [0, 0, -1], [-1, 0, 0], [0, 0, 1], [0, 1, 0], [0, -1, 0]], dtype=np.float64)
    k = np.arange(4)
    upper, lower = np.stack([np.full(4, 4), k, (k + 1) % 4], axis=1), np.stack([np.full(4, 5), (k + 1) % 4, k], axis=1)
    return _regular(corners, np.concatenate([upper, lower]), radius, "octahedron")


def dodecahedron(radius: float = 1.0) -> Mesh:
    """Make a regular dodecahedron, its corners at the distance `radius` > 0 from the origin, a face towards +y.

    A face is a fan of three triangles.
    """
    corners, triangles = icosahedron_corners()
    middles = corners[triangles].mean(axis=1)
    faces = np.array([_around(corners[k], middles, np.flatnonzero((triangles == k).any(axis=1))) for k in range(len(corners))])
    return _regular(middles / np.linalg.norm(middles, axis=1, keepdims=True), faces, radius, "dodecahedron")


def icosahedron(radius: float = 1.0) -> Mesh:
    """Make a regular icosahedron, its corners at the distance `radius` > 0 from the origin, one of them on +y."""
    return _regular(*icosahedron_corners(), radius, "icosahedron")


def icosahedron_corners() -> tuple[Points, Indices]:
    """Return the corners of the icosahedron in the unit sphere, poles +y and -y first and last: (12, 3) float64; faces (20, 3) int64."""
    # cos and sin of the polar angle of the upper ring: tan is 2
    height, reach = 1.0 / math.sqrt(5.0), 2.0 / math.sqrt(5.0)
    around = 2.0 * math.pi * np.arange(5) / 5.0
    upper = np.stack([reach * np.cos(around), np.full(5, height), -reach * np.sin(around)], axis=1)
    around += math.pi / 5.0
    lower = np.stack([reach * np.cos(around), np.full(5, -height), -reach * np.sin(around)], axis=1)
    corners = np.concatenate([[[0.0, 1.0, 0.0]], upper, lower, [[0.0, -1.0, 0.0]]])
    k = np.arange(5)
    a, b, c, d = 1 + k, 1 + (k + 1) % 5, 6 + k, 6 + (k + 1) % 5
    faces = [(np.zeros_like(k), a, b), (a, c, b), (b, c, d), (np.full(5, 11), d, c)]
    return corners, np.concatenate([np.stack(face, axis=1) for face in faces])


def _around(axis: Points, points: Points, chosen: Indices) -> Indices:
    """The chosen points in their order round an axis, counter-clockwise seen from outside."""
    arm = points[chosen[0]] - axis * (points[chosen[0]] @ axis)
    angle = np.arctan2(points[chosen] @ np.cross(axis, arm), points[chosen] @ arm)
    return chosen[np.argsort(angle)]


def _regular(corners: Points, faces: Indices, radius: float, name: str) -> Mesh:
    """A solid with corners at distance 1 and faces (m, k) of k corners each; a texture's inscribed polygon on every face."""
    check_length(radius, f"{name}.radius")
    m, k = faces.shape
    first = np.arange(1, k - 1)
    fan = np.stack([np.zeros_like(first), first, first + 1], axis=1)
    normals = corners[faces].mean(axis=1)
    angle = 2.0 * math.pi * np.arange(k) / k + math.pi * (0.5 if k % 2 else 0.25)
    return Mesh(
        positions=(radius * corners).astype(np.float32),
        triangles=faces[:, fan].reshape(-1, 3).astype(np.int32),
        normals=(normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        normal_triangles=np.repeat(np.arange(m), 3 * (k - 2)).reshape(-1, 3).astype(np.int32),
        uvs=(0.5 + 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1)).astype(np.float32),
        uv_triangles=np.tile(fan, (m, 1)).astype(np.int32),
        name=name,
    )
