"""Surfaces that are round about +y: a profile, turned.

    y |   *--.          a profile of (distance from the axis, y), from the bottom up with the outside to its right;
      |       \\         every edge of it sweeps a band, and where it bends sharply each side keeps its own normals
      |       |
      |  *---'
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..sizes import check_count, check_length, check_triangles, finite_points
from .bands import halved
from .profile import creased_profile

__all__ = ["capsule", "cone", "cylinder", "disk", "revolution", "torus"]

Points = NDArray[np.float64]


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
    check_length(radius, "disk.radius")
    return _revolved(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), n, [(radius, 0.0, 1.0)], "disk")


def cylinder(radius: float = 1.0, height: float = 2.0, n: int = 64, capped: bool = True) -> Mesh:
    """Make a cylinder about +y of n sides, from y = -height/2 to height/2; see `cone`."""
    check_length(radius, "cylinder.radius")
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
    check_length(height, f"{name}.height")
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
    check_length(major_radius, "torus.major_radius")
    check_length(minor_radius, "torus.minor_radius")
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
    n = check_count(n, 3, f"{name}.n")
    check_triangles(2 * n * (len(profile) + 1), f"{name}.n = {n}")
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
    corners = [halved(n * row + column, n * row + following, n * upper + following, n * upper + column)]
    uv_row, uv_upper = (n + 1) * row, (n + 1) * (row + 1)
    uv_corners = [halved(uv_row + column, uv_row + column + 1, uv_upper + column + 1, uv_upper + column)]
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


def capsule(radius: float = 0.5, length: float = 1.0, n: int = 64, n_cap: int = 16) -> Mesh:
    """Make a cylinder about +y with half a ball on either end.

    Parameters
    ----------
    radius : float > 0
    length : float > 0
        Between the middles of the balls: the capsule is ``length + 2 radius`` high.
    n : int >= 3
        Sides.
    n_cap : int >= 1
        Bands of each half ball.

    Returns
    -------
    Mesh
        Vertices on the surface, with its exact normals; u runs around as on a sphere, v along the profile by its length.
    """
    check_length(radius, "capsule.radius")
    check_length(length, "capsule.length")
    n_cap = check_count(n_cap, 1, "capsule.n_cap")
    angle = 0.5 * math.pi * np.arange(n_cap + 1) / n_cap
    upper = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    upper[-1] = (0.0, 1.0)
    normals = np.concatenate([upper[::-1] * (1.0, -1.0), upper])
    profile = radius * normals + np.repeat([[0.0, -length / 2.0], [0.0, length / 2.0]], n_cap + 1, axis=0)
    arc = np.concatenate([radius * angle, radius * (angle + 0.5 * math.pi) + length])
    return _revolved(profile, normals, arc / arc[-1], n, [], "capsule")


def revolution(profile: ArrayLike, n: int = 64, capped: bool = False, crease_degrees: float = 30.0) -> Mesh:
    """Turn a profile about +y.

    Parameters
    ----------
    profile : (k, 2) float, k >= 2
        Points (distance from the axis >= 0, y) that are joined by edges, which must not cross. If the last is the first, the surface
        is a ring. What encloses a solid (a ring, a profile from the axis to the axis, a capped one) may run either way; of another the
        front is on the right of the way along it, which is outside where it runs up.
    n : int >= 3
        Sides.
    capped : bool
        Closed by disks at ends that are not on the axis.
    crease_degrees : float in [0, 180]
        Where the profile bends by more, the surface has an edge; elsewhere it is smooth.

    Returns
    -------
    Mesh
        u runs around as on a sphere, v along the profile by its length; a cap shows the disk cut out of the texture.

    Examples
    --------
    >>> revolution([(0.0, 0.0), (1.0, 1.0), (0.0, 2.0)], 8)
    Mesh('revolution', 10 positions, 16 triangles)
    """
    if not 0.0 <= crease_degrees <= 180.0:
        raise SceneError(f"revolution.crease_degrees must lie in [0, 180], got {crease_degrees}")
    points = finite_points(profile, 2, 2, "revolution.profile")
    if points[:, 0].min() < 0.0:
        raise SceneError(f"revolution.profile must not cross the axis, got the distance {points[:, 0].min()} from it")
    points = points[np.concatenate([[True], (np.diff(points, axis=0) != 0.0).any(axis=1)])]
    if len(points) < 2 or not points[:, 0].any():
        raise SceneError("revolution.profile must be a line with a length, away from the axis")
    ring = len(points) > 3 and bool((points[0] == points[-1]).all())
    is_solid = ring or capped or not points[[0, -1], 0].any()
    if is_solid and _turns_clockwise(points):
        points = points[::-1]
    bottom, top = points[0], points[-1]
    caps = [(float(r), float(y), up) for (r, y), up in ((bottom, -1.0), (top, 1.0)) if capped and not ring and r > 0.0]
    spread, normals, arc = creased_profile(points, ring, math.radians(crease_degrees))
    return _revolved(spread, normals, arc / arc[-1], n, caps, "revolution", closed=ring)


def _turns_clockwise(profile: Points) -> bool:
    """Whether a profile, closed along the axis, has its inside on the right."""
    r, y = np.concatenate([profile, [[0.0, profile[-1, 1]], [0.0, profile[0, 1]]]]).T
    return bool((r * np.roll(y, -1) - np.roll(r, -1) * y).sum() < 0.0)
