"""Whether a point lies in the solid that a mesh encloses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh

__all__ = ["Solid", "is_inside"]

Floats = NDArray[np.float64]

_MOST_TRIANGLES = 400_000
_DIRECTIONS = ((0.8017, 0.2673, 0.5345), (-0.3841, 0.8642, -0.3244), (0.1231, -0.4924, 0.8616))


class Solid(NamedTuple):
    """A mesh, its place, and the path of its node."""

    path: str
    mesh: Mesh
    world_from_object: Floats


def is_inside(solid: Solid, point: Floats) -> bool:
    """Whether rays from a point cross the mesh an odd number of times, in each of three directions: of an open surface some do not.

    **Source**: the Jordan curve theorem; the crossings by Möller and Trumbore, *Fast, minimum storage ray/triangle intersection*, 1997.
    """
    mesh = solid.mesh
    if not 4 <= len(mesh.triangles) <= _MOST_TRIANGLES or not abs(np.linalg.det(solid.world_from_object[:3, :3])) > 0.0:
        return False
    p = (np.linalg.inv(solid.world_from_object) @ np.append(point, 1.0))[:3]
    low, high = mesh.bounds
    if not ((p > low) & (p < high)).all():
        return False
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return all(_crossings(p, np.array(direction), a, b - a, c - a) % 2 == 1 for direction in _DIRECTIONS)


def _crossings(p: Floats, d: Floats, a: Floats, e1: Floats, e2: Floats) -> int:
    """How many triangles with the corner a and the edges e1 and e2 a ray meets."""
    h = np.cross(d, e2)
    determinant = (e1 * h).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = p - a
        u = (s * h).sum(axis=1) / determinant
        q = np.cross(s, e1)
        v = (q @ d) / determinant
        t = (e2 * q).sum(axis=1) / determinant
        return int(((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)).sum())
