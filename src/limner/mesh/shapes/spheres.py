"""Round solids about a point: spheres by meridians and by triangles, and the superquadrics between ball, box and diamond.

    uv_sphere     rings between two poles: the texture of a globe; small triangles near the poles
    icosphere     an icosahedron whose triangles are divided: nearly the same size everywhere
    superquadric  |x|^(2/e2) + |z|^(2/e2) to the power e2/e1, + |y|^(2/e1) = 1
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..sizes import check_count, check_length, check_triangles, edge_lengths
from .platonic import icosahedron_corners

__all__ = ["icosphere", "sphere", "superquadric", "uv_sphere"]

Points = NDArray[np.float64]


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
    check_length(radius, "sphere.radius")
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


def icosphere(radius: float = 1.0, levels: int = 3) -> Mesh:
    """Make a sphere of the triangles of an icosahedron, each divided into four as often as told.

    Parameters
    ----------
    radius : float > 0
    levels : int >= 0

    Returns
    -------
    Mesh
        ``10 4^levels + 2`` positions at the distance `radius`, ``20 4^levels`` triangles whose areas differ by less than a factor of 2;
        poles at +y and -y. Texture coordinates as of `uv_sphere`; at the seam u runs beyond 1, where textures repeat.

    Examples
    --------
    >>> icosphere(1.0, 2)
    Mesh('icosphere', 162 positions, 320 triangles)
    """
    check_length(radius, "icosphere.radius")
    levels = check_count(levels, 0, "icosphere.levels")
    check_triangles(20 * 4**levels, f"icosphere.levels = {levels}")
    normals, triangles = icosahedron_corners()
    for _ in range(levels):
        normals, triangles = _quartered(normals, triangles)
    uvs, uv_triangles = _globe_uvs(normals, triangles)
    return Mesh(
        positions=(radius * normals).astype(np.float32),
        triangles=triangles.astype(np.int32),
        normals=normals.astype(np.float32),
        uvs=uvs,
        uv_triangles=uv_triangles,
        name="icosphere",
    )


def _quartered(normals: Points, triangles: NDArray[np.int64]) -> tuple[Points, NDArray[np.int64]]:
    """Divide triangles of the unit sphere into four by the middles of their sides."""
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
    keys, side_of = np.unique(sides[:, 0] * len(normals) + sides[:, 1], return_inverse=True)
    middles = normals[keys // len(normals)] + normals[keys % len(normals)]
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    a, b, c = triangles.T
    ab, bc, ca = (len(normals) + side_of).reshape(-1, 3).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([normals, middles]), np.stack([np.stack(part, axis=1) for part in parts], axis=1).reshape(-1, 3)


def _globe_uvs(normals: Points, triangles: NDArray[np.int64]) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Longitude and latitude of the corners; none runs back over the seam, and a pole has the longitude of its triangle's middle."""
    x, y, z = np.moveaxis(normals[triangles], -1, 0)
    u, v = 0.5 + np.arctan2(-z, x) / (2.0 * math.pi), 1.0 - np.arccos(np.clip(y, -1.0, 1.0)) / math.pi
    pole = np.abs(y) > 1.0 - 1e-12
    u = np.where(pole, np.nan, u)
    u += (np.nanmax(u, axis=1, keepdims=True) - u > 0.5).astype(np.float64)
    u = np.where(pole, np.nanmean(u, axis=1, keepdims=True), u)
    distinct, corner_of = np.unique(np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32), axis=0, return_inverse=True)
    return distinct, corner_of.reshape(-1, 3).astype(np.int32)


def superquadric(size: ArrayLike = 2.0, north_south: float = 1.0, east_west: float = 1.0, n_u: int = 64, n_v: int = 32) -> Mesh:
    """Make a superellipsoid about the origin.

    Parameters
    ----------
    size : three floats > 0, or one for all
        Widths along x, y and z, metres.
    north_south, east_west : float in [0.05, 4]
        Barr's exponents e1, of the outline seen from the side, and e2, of the one seen from above: 1 is round, towards 0 square, 2 a
        diamond, above that pinched.
    n_u, n_v : int
        Meridians, at least 3, and bands, at least 2, of the sphere that it is pulled out of.

    Returns
    -------
    Mesh
        Its vertices lie on the surface, in the directions of the vertices of a `uv_sphere`, whose texture coordinates it has. Normals
        are those of the implicit form; on an edge or a tip, where there is none, that of its mirror planes.

    **Source**: Barr, "Superquadrics and Angle-Preserving Transformations", *IEEE Computer Graphics and Applications* 1(1), 1981: the
    inside-outside function and its gradient. By direction instead of by his angles, which crowd all vertices into the corners of what
    is nearly a box.
    """
    half = edge_lengths(size, 3, "superquadric.size") / 2.0
    for name, exponent in (("north_south", north_south), ("east_west", east_west)):
        if not 0.05 <= exponent <= 4.0:
            raise SceneError(f"superquadric.{name} must lie in [0.05, 4], got {exponent}")
    globe = uv_sphere(n_u, n_v)
    # Rounding of sines and cosines would decide on which side of a mirror plane a vertex lies.
    towards = _sphere_normals(n_u, n_v)
    towards = np.where(np.abs(towards) < 1e-15, 0.0, towards)
    points = towards * (_inside_outside(towards, north_south, east_west) ** (-north_south / 2.0))[:, None]
    return Mesh(
        positions=(points * half).astype(np.float32),
        triangles=globe.triangles,
        normals=_superquadric_normals(points, half, north_south, east_west).astype(np.float32),
        uvs=globe.uvs,
        uv_triangles=globe.uv_triangles,
        name="superquadric",
    )


def _inside_outside(p: Points, e1: float, e2: float) -> Points:
    """Barr's function, 1 on the surface of half widths 1; (k,)."""
    x, y, z = np.abs(p).T
    return (x ** (2.0 / e2) + z ** (2.0 / e2)) ** (e2 / e1) + y ** (2.0 / e1)


def _superquadric_normals(p: Points, half: Points, e1: float, e2: float) -> Points:
    """The unit gradient of the inside-outside function at points of the surface of half widths 1, for the given half widths."""
    magnitude = np.abs(p)
    around = magnitude[:, 0] ** (2.0 / e2) + magnitude[:, 2] ** (2.0 / e2)
    exponents = np.array([2.0 / e2 - 1.0, 2.0 / e1 - 1.0, 2.0 / e2 - 1.0])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        gradient = np.where(magnitude > 0.0, magnitude**exponents, 0.0) * np.sign(p) / half
        gradient[:, [0, 2]] *= np.where(around > 0.0, around ** (e2 / e1 - 1.0), 0.0)[:, None]
    gradient /= np.maximum(np.abs(gradient).max(axis=1, keepdims=True), 1e-300)
    lengths = np.linalg.norm(gradient, axis=1, keepdims=True)
    outwards = p / np.linalg.norm(p, axis=1, keepdims=True)
    return np.where(lengths > 0.5, gradient / np.maximum(lengths, 0.5), outwards)
