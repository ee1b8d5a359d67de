"""Triangle meshes of simple solids, for renderers that know triangles only (FoCG 12.1, 11.1).

Everything is counter-clockwise seen from outside, with exact normals and texture coordinates; +y is up. A vertex is shared by
all triangles around it; only its normal or texture coordinate is split, where the surface has an edge or the texture a seam.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .mesh import Mesh

__all__ = ["box", "plane_disk", "quad", "sphere", "uv_sphere"]


def uv_sphere(n_u: int, n_v: int, radius: float = 1.0) -> Mesh:
    """Make a sphere of n_u meridians and n_v bands between the poles +y and -y.

    Parameters
    ----------
    n_u : int >= 3
    n_v : int >= 2
    radius : float > 0

    Returns
    -------
    Mesh
        ``n_u (n_v - 1) + 2`` positions, each at the distance `radius` up to the rounding of float32, and ``2 n_u (n_v - 1)``
        triangles. Texture coordinates ``u = 1/2 + atan2(-z, x) / (2 pi)``, ``v = 1 - acos(y / r) / pi``: u runs
        counter-clockwise seen from above, with its seam at -x; v is 1 at the top. A pole has the u of its triangle's middle.

    Examples
    --------
    >>> uv_sphere(8, 4)
    Mesh('sphere', 26 positions, 48 triangles)

    **Source**: FoCG 11.1, turned from z up to y up: the book's (x, y, z) is our (x, -z, y).
    """
    if n_u < 3 or n_v < 2:
        raise SceneError(f"a sphere needs at least 3 meridians and 2 bands, got {n_u} and {n_v}")
    _check_length(radius, "sphere.radius")
    normals = _sphere_normals(n_u, n_v)
    triangles, uv_triangles = _sphere_triangles(n_u, n_v)
    return Mesh(
        positions=(radius * normals).astype(np.float32),
        triangles=triangles,
        normals=normals.astype(np.float32),
        uvs=_sphere_uvs(n_u, n_v).astype(np.float32),
        uv_triangles=uv_triangles,
        name="sphere",
    )


def sphere(radius: float = 1.0, n: int = 32) -> Mesh:
    """Make a sphere of n bands and 2 n meridians, whose quadrilaterals on the equator are square.

    Parameters
    ----------
    radius : float > 0
    n : int >= 2

    Returns
    -------
    Mesh
        See `uv_sphere`.
    """
    return uv_sphere(2 * n, n, radius)


def _sphere_normals(n_u: int, n_v: int) -> NDArray[np.float64]:
    u = np.arange(n_u) / n_u
    v = np.arange(1, n_v) / n_v
    polar, azimuth = math.pi * (1.0 - v)[:, None], 2.0 * math.pi * (u - 0.5)[None, :]
    x, minus_z = np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth)
    rings = np.stack([x, np.broadcast_to(np.cos(polar), x.shape), -minus_z], axis=-1).reshape(-1, 3)
    return np.concatenate([rings, [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]])


def _sphere_uvs(n_u: int, n_v: int) -> NDArray[np.float64]:
    rings = np.stack(np.meshgrid(np.arange(n_u + 1) / n_u, np.arange(1, n_v) / n_v), axis=-1).reshape(-1, 2)
    middles = (np.arange(n_u) + 0.5) / n_u
    bottom, top = np.stack([middles, np.zeros(n_u)], axis=1), np.stack([middles, np.ones(n_u)], axis=1)
    return np.concatenate([rings, bottom, top])


def _sphere_triangles(n_u: int, n_v: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Position and texture coordinate indices: rings from the bottom up, then the poles."""

    def assemble(row_length: int, bottom: NDArray[np.int64], top: NDArray[np.int64]) -> NDArray[np.int32]:
        column = np.arange(n_u)
        following = (column + 1) % row_length
        row = row_length * np.arange(n_v - 2)[:, None]
        a, b, c, d = row + column, row + following, row + row_length + following, row + row_length + column
        bands = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
        last = row_length * (n_v - 2)
        caps = [np.stack([bottom, following, column], axis=1), np.stack([top, last + column, last + following], axis=1)]
        return np.concatenate([caps[0], bands, caps[1]]).astype(np.int32)

    rings, one = n_u * (n_v - 1), np.ones(n_u, dtype=np.int64)
    uv_rings = (n_u + 1) * (n_v - 1)
    positions = assemble(n_u, rings * one, (rings + 1) * one)
    return positions, assemble(n_u + 1, uv_rings + np.arange(n_u), uv_rings + n_u + np.arange(n_u))


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
    edges = np.broadcast_to(np.asarray(size, dtype=np.float64), (3,))
    for edge in edges:
        _check_length(float(edge), "box.size")
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


def quad(corners: ArrayLike) -> Mesh:
    """Make a flat quadrilateral of two triangles.

    Parameters
    ----------
    corners : (4, 3) float
        Counter-clockwise seen from the front, in one plane, convex; they get the texture coordinates (0, 0), (1, 0), (1, 1) and
        (0, 1).

    Returns
    -------
    Mesh
        4 positions, 2 triangles, one normal.
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.shape != (4, 3):
        raise SceneError(f"a quadrilateral has corners of shape (4, 3), got {points.shape}")
    normal = np.cross(points[2] - points[0], points[3] - points[1])
    length = float(np.linalg.norm(normal))
    if not (math.isfinite(length) and length > 0.0):
        raise SceneError(f"a quadrilateral must have an area, got corners {points.tolist()}")
    split = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    return Mesh(
        positions=points.astype(np.float32),
        triangles=split,
        normals=(normal / length).astype(np.float32)[None],
        normal_triangles=np.zeros_like(split),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32),
        name="quad",
    )


def plane_disk(center: ArrayLike, inner_radius: float, outer_radius: float, n_segments: int = 32) -> Mesh:
    """Cover the infinite plane y = 0 around a foot point: rings of triangles whose radii double.

    A single huge triangle would leave float32 nothing for what is near the eye; here no triangle is much longer than its own
    distance from the foot point, so interpolation over it is as exact as its distance deserves.

    Parameters
    ----------
    center : (2,) float
        x and z of the foot point, below the eye.
    inner_radius, outer_radius : float, 0 < inner <= outer
        Metres: of the innermost ring, which is a fan around the foot point, and of the disk that is covered for certain.
    n_segments : int >= 3
        Sides of the ring.

    Returns
    -------
    Mesh
        ``1 + n_segments rings`` positions; normal +y; texture coordinates (x, -z), as of an infinite plane.

    Examples
    --------
    >>> plane_disk((0.0, 0.0), 1.0, 1000.0, 16)
    Mesh('plane', 177 positions, 336 triangles)
    """
    _check_length(inner_radius, "inner_radius")
    _check_length(outer_radius, "outer_radius")
    if not inner_radius <= outer_radius or n_segments < 3:
        raise SceneError(
            f"a disk needs inner_radius <= outer_radius and 3 segments, got {inner_radius}, {outer_radius} and {n_segments}"
        )
    # A polygon reaches less far in the middle of its sides than at its corners.
    reach = outer_radius / math.cos(math.pi / n_segments)
    n_rings = max(1, math.ceil(math.log2(reach / inner_radius) - 1e-9) + 1)
    radii = np.minimum(inner_radius * 2.0 ** np.arange(n_rings), reach)
    radii[-1] = reach
    angle = 2.0 * math.pi * np.arange(n_segments) / n_segments
    rings = radii[:, None, None] * np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    xz = np.concatenate([[[0.0, 0.0]], rings.reshape(-1, 2)]) + np.asarray(center, dtype=np.float64).reshape(2)
    column = np.arange(n_segments)
    following = (column + 1) % n_segments
    row = 1 + n_segments * np.arange(n_rings - 1)[:, None]
    a, b, c, d = row + column, row + n_segments + column, row + n_segments + following, row + following
    fan = np.stack([np.zeros_like(column), 1 + column, 1 + following], axis=1)
    triangles = np.concatenate([fan, np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)]).astype(np.int32)
    return Mesh(
        positions=np.stack([xz[:, 0], np.zeros(len(xz)), xz[:, 1]], axis=1).astype(np.float32),
        triangles=triangles,
        normals=np.array([[0.0, 1.0, 0.0]], dtype=np.float32),
        normal_triangles=np.zeros_like(triangles),
        uvs=np.stack([xz[:, 0], -xz[:, 1]], axis=1).astype(np.float32),
        name="plane",
    )


def _check_length(length: float, name: str) -> None:
    if not (math.isfinite(length) and length > 0.0):
        raise SceneError(f"{name} must be positive and finite, got {length}")
