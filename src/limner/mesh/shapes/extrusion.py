"""Solids between two copies of a flat outline: letters, profiles, plates with holes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..sizes import check_length
from .bands import halved
from .outlines import oriented_outlines, triangulated
from .profile import creased_profile

__all__ = ["extrusion"]

Points = NDArray[np.float64]


def extrusion(
    outline: ArrayLike, depth: float = 1.0, holes: Sequence[ArrayLike] = (), capped: bool = True, crease_degrees: float = 30.0
) -> Mesh:
    """Sweep an outline in x and y along z.

    Parameters
    ----------
    outline : (k, 2) float, k >= 3
        A simple polygon in either sense of turning, convex or not.
    depth : float > 0
        The solid reaches from z = -depth/2 to depth/2.
    holes : sequence of (k, 2) float
        Simple polygons inside the outline, apart from each other.
    capped : bool
        Closed at the front and at the back.
    crease_degrees : float in [0, 180]
        Where the outline bends by more, the walls have an edge; elsewhere they are smooth.

    Returns
    -------
    Mesh
        Twice the outlines' corners as positions. On a wall u runs around its outline by length and v from back to front; front and
        back show the box around the outline as the texture, unmirrored.

    Examples
    --------
    >>> extrusion([(0, 0), (3, 0), (3, 3), (0, 3)], 1.0, holes=[[(1, 1), (2, 1), (2, 2), (1, 2)]])
    Mesh('extrusion', 16 positions, 32 triangles)
    """
    check_length(depth, "extrusion.depth")
    if not 0.0 <= crease_degrees <= 180.0:
        raise SceneError(f"extrusion.crease_degrees must lie in [0, 180], got {crease_degrees}")
    rings = oriented_outlines(outline, holes, "extrusion")
    corners = np.concatenate(rings)
    n = len(corners)
    walls = _Walls(n)
    for ring in rings:
        walls.add(ring, math.radians(crease_degrees))
    triangles, normal_triangles, uv_triangles = list(walls.triangles), list(walls.normal_triangles), list(walls.uv_triangles)
    normals, uvs = np.concatenate(walls.normals), np.concatenate(walls.uvs)
    if capped:
        front = triangulated(rings)
        triangles += [n + front, front[:, ::-1]]
        normal_triangles += [np.full_like(front, len(normals)), np.full_like(front, len(normals) + 1)]
        uv_triangles += [len(uvs) + front, len(uvs) + n + front[:, ::-1]]
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        shown = (corners - low) / size
        normals = np.concatenate([normals, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
        uvs = np.concatenate([uvs, shown, shown * (-1.0, 1.0) + (1.0, 0.0)])
    positions = np.concatenate([np.insert(corners, 2, z, axis=1) for z in (-depth / 2.0, depth / 2.0)])
    return Mesh(
        positions=positions.astype(np.float32),
        triangles=np.concatenate(triangles).astype(np.int32),
        normals=normals.astype(np.float32),
        normal_triangles=np.concatenate(normal_triangles).astype(np.int32),
        uvs=uvs.astype(np.float32),
        uv_triangles=np.concatenate(uv_triangles).astype(np.int32),
        name="extrusion",
    )


class _Walls:
    """The walls of rings of corners, which stand at z = 0 and, n rows later, at z = 1."""

    def __init__(self, n: int) -> None:
        self.n, self.first, self.n_normals, self.n_uvs = n, 0, 0, 0
        self.triangles: list[NDArray[np.int64]] = []
        self.normal_triangles: list[NDArray[np.int64]] = []
        self.uv_triangles: list[NDArray[np.int64]] = []
        self.normals: list[Points] = []
        self.uvs: list[Points] = []

    def add(self, ring: Points, crease: float) -> None:
        """The wall over one ring."""
        k = len(ring)
        _, normals, arc = creased_profile(np.concatenate([ring, ring[:1]]), True, crease)
        here = np.arange(k)
        following = (here + 1) % k
        start, end = 2 * here + 1, 2 * here + 2  # of an edge, among the points given twice
        back, front = self.first + here, self.first + self.n + here
        self.triangles.append(halved(back, self.first + following, self.first + self.n + following, front))
        self.normal_triangles.append(self.n_normals + halved(start, end, end, start))
        upper = len(arc)
        self.uv_triangles.append(self.n_uvs + halved(start, end, upper + end, upper + start))
        self.normals.append(np.insert(normals, 2, 0.0, axis=1))
        u = arc / arc[-1]
        self.uvs += [np.stack([u, np.full_like(u, v)], axis=1) for v in (0.0, 1.0)]
        self.first, self.n_normals, self.n_uvs = self.first + k, self.n_normals + len(normals), self.n_uvs + 2 * len(arc)
