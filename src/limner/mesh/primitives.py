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

__all__ = ["bilinear_patch", "box", "cone", "cylinder", "disk", "plane_disk", "quad", "sphere", "torus", "uv_sphere"]


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


# --- round about +y -------------------------------------------------------------------------------------------------------


def disk(radius: float = 1.0, n: int = 64) -> Mesh:
    """Make a disk of n triangles in y = 0, its front towards +y.

    Parameters
    ----------
    radius : float > 0
    n : int >= 3

    Returns
    -------
    Mesh
        The polygon inscribed in the circle; it shows the disk cut out of the texture, u = (1 + x/r) / 2 and v = (1 - z/r) / 2.
    """
    _check_length(radius, "disk.radius")
    return _revolved(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), n, [(radius, 0.0, 1.0)], "disk")


def cylinder(radius: float = 1.0, height: float = 2.0, n: int = 64, capped: bool = True) -> Mesh:
    """Make a cylinder about +y of n sides, from y = -height/2 to height/2; see `cone`."""
    _check_length(radius, "cylinder.radius")
    return _frustum(radius, radius, height, n, capped, "cylinder")


def cone(radius: float = 1.0, height: float = 2.0, top_radius: float = 0.0, n: int = 64, capped: bool = True) -> Mesh:
    """Make a cone, or a frustum of one, about +y of n sides, from y = -height/2 to height/2.

    Parameters
    ----------
    radius, top_radius : float >= 0
        At the bottom and at the top; not both 0.
    height : float > 0
    n : int >= 3
    capped : bool
        Closed by disks where the radius is not 0.

    Returns
    -------
    Mesh
        Its edges lie on the surface, and so do the normals of the cone, exact. u runs around as on a sphere, v up the side; a cap shows the
        disk cut out of the texture.
    """
    if not (radius >= 0.0 and top_radius >= 0.0 and radius + top_radius > 0.0):
        raise SceneError(f"cone.radius must not be negative, nor both of them 0, got {radius} and {top_radius}")
    return _frustum(radius, top_radius, height, n, capped, "cone")


def _frustum(bottom: float, top: float, height: float, n: int, capped: bool, name: str) -> Mesh:
    _check_length(height, f"{name}.height")
    profile = np.array([[bottom, -height / 2.0], [top, height / 2.0]])
    slope = np.array([height, bottom - top]) / math.hypot(height, bottom - top)
    caps = [(bottom, -height / 2.0, -1.0), (top, height / 2.0, 1.0)] if capped else []
    return _revolved(profile, np.array([slope, slope]), np.array([0.0, 1.0]), n, [cap for cap in caps if cap[0] > 0.0], name)


def torus(major_radius: float = 1.0, minor_radius: float = 0.25, n_u: int = 64, n_v: int = 32) -> Mesh:
    """Make a torus about +y: n_u sections of a tube of n_v sides.

    Parameters
    ----------
    major_radius : float > 0
        Of the circle in the middle of the tube.
    minor_radius : float > 0
        Of the tube.
    n_u, n_v : int >= 3

    Returns
    -------
    Mesh
        ``2 n_u n_v`` triangles; u runs around +y as on a sphere, v around the tube, 1/2 at its outermost.
    """
    _check_length(major_radius, "torus.major_radius")
    _check_length(minor_radius, "torus.minor_radius")
    v = np.arange(n_v + 1) / n_v
    angle = 2.0 * math.pi * (v - 0.5)
    normals = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    normals[-1] = normals[0]
    return _revolved(np.array([major_radius, 0.0]) + minor_radius * normals, normals, v, n_u, [], "torus", closed=True)


def _revolved(
    profile: NDArray[np.float64],
    normals: NDArray[np.float64],
    v: NDArray[np.float64],
    n: int,
    caps: list[tuple[float, float, float]],
    name: str,
    *,
    closed: bool = False,
) -> Mesh:
    """Turn a profile (k, 2) of (distance from the axis, y) about +y; `closed`: its last point is its first.

    Caps are (radius, y, 1 up or -1 down).
    """
    if n < 3:
        raise SceneError(f"a {name} needs at least 3 sides, got {n}")
    around = 2.0 * math.pi * (np.arange(n) / n - 0.5)
    ring = np.stack([np.cos(around), -np.sin(around)], axis=1)

    def turned(points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, z = np.broadcast_arrays(points[:, :1] * ring[:, 0], points[:, 1:], points[:, :1] * ring[:, 1])
        return np.stack([x, y, z], axis=-1).reshape(-1, 3)

    k = len(profile)
    distinct = k - 1 if closed else k
    positions, all_normals = [turned(profile[:distinct])], [turned(normals[:distinct])]
    uvs = [np.stack(np.broadcast_arrays(np.arange(n + 1) / n, v[:, None]), axis=-1).reshape(-1, 2)]
    column, row = np.arange(n), np.arange(max(k - 1, 0))[:, None]
    following, upper = (column + 1) % n, (row + 1) % max(distinct, 1)
    corners = [_bands(n * row + column, n * row + following, n * upper + following, n * upper + column)]
    uv_row, uv_upper = (n + 1) * row, (n + 1) * (row + 1)
    uv_corners = [_bands(uv_row + column, uv_row + column + 1, uv_upper + column + 1, uv_upper + column)]
    normal_corners = list(corners)
    n_positions, n_normals, n_uvs = n * distinct, n * distinct, (n + 1) * k
    for radius, y, up in caps:
        rim = np.concatenate([radius * ring, [[0.0, 0.0]]])
        positions.append(np.stack([rim[:, 0], np.full(n + 1, y), rim[:, 1]], axis=1))
        all_normals.append(np.array([[0.0, up, 0.0]]))
        uvs.append(0.5 + rim * (0.5 / radius, -0.5 * up / radius))
        fan = np.stack([np.full(n, n), column, following] if up > 0.0 else [np.full(n, n), following, column], axis=1)
        corners.append(n_positions + fan)
        uv_corners.append(n_uvs + fan)
        normal_corners.append(np.full((n, 3), n_normals))
        n_positions, n_normals, n_uvs = n_positions + n + 1, n_normals + 1, n_uvs + n + 1
    # A rim belongs to the side and to the cap, and all sides meet in an apex: one position each.
    points, place_of = np.unique((np.concatenate(positions) + 0.0).astype(np.float32), axis=0, return_inverse=True)
    triangles = place_of.reshape(-1)[np.concatenate(corners)]
    kept = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return Mesh(
        positions=points,
        triangles=triangles[kept].astype(np.int32),
        normals=np.concatenate(all_normals).astype(np.float32),
        normal_triangles=np.concatenate(normal_corners)[kept].astype(np.int32),
        uvs=np.concatenate(uvs).astype(np.float32),
        uv_triangles=np.concatenate(uv_corners)[kept].astype(np.int32),
        name=name,
    )


def _bands(a: NDArray[np.int64], b: NDArray[np.int64], c: NDArray[np.int64], d: NDArray[np.int64]) -> NDArray[np.int64]:
    """(m, 3): both halves of quadrilaterals a b c d."""
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def bilinear_patch(corners: ArrayLike, n: int = 32) -> Mesh:
    """Make a bilinear patch of n x n quadrilaterals, which are flat only where it is.

    Parameters
    ----------
    corners : (4, 3) float
        p00, p10, p11, p01, counter-clockwise seen from the front; p(u, v) = (1-u)(1-v) p00 + u (1-v) p10 + u v p11 + (1-u) v p01.
    n : int >= 1

    Returns
    -------
    Mesh
        Positions, normals and (u, v) on a grid, row by row.
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.shape != (4, 3):
        raise SceneError(f"a bilinear patch has corners of shape (4, 3), got {points.shape}")
    if n < 1:
        raise SceneError(f"a bilinear patch needs at least 1 quadrilateral a side, got {n}")
    p00, p10, p11, p01 = points
    v, u = (axis.reshape(-1, 1) for axis in np.mgrid[0 : n + 1, 0 : n + 1] / n)
    along_u, along_v = (1.0 - v) * (p10 - p00) + v * (p11 - p01), (1.0 - u) * (p01 - p00) + u * (p11 - p10)
    normals = np.cross(along_u, along_v)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # Where two corners meet there is no normal: that of the diagonals.
    normals = np.where(lengths > 0.0, normals, np.cross(p11 - p00, p01 - p10))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    row, column = (n + 1) * np.arange(n)[:, None], np.arange(n)
    return Mesh(
        positions=((1.0 - v) * ((1.0 - u) * p00 + u * p10) + v * (u * p11 + (1.0 - u) * p01)).astype(np.float32),
        triangles=_bands(row + column, row + column + 1, row + column + n + 2, row + column + n + 1).astype(np.int32),
        normals=normals.astype(np.float32),
        uvs=np.concatenate([u, v], axis=1).astype(np.float32),
        name="bilinear patch",
    )


def _check_length(length: float, name: str) -> None:
    if not (math.isfinite(length) and length > 0.0):
        raise SceneError(f"{name} must be positive and finite, got {length}")
