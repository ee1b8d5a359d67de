"""How a mesh bends at its vertices: Gaussian, mean and principal curvature.

The curvature of a polyhedron sits in its vertices and edges. What a vertex holds is the *integral* over the ground around it; divided by
the area of that ground it approximates the curvature of the smooth surface that the mesh stands for.

    Gaussian: by how much the angles around the vertex miss a full turn          mean: how the area changes when the vertex moves

              2 pi - sum of angles                                              H n = 1/(4 A) sum of (cot a + cot b) (x_i - x_j)

**Source**: M. Meyer, M. Desbrun, P. Schröder and A. Barr, "Discrete Differential-Geometry Operators for Triangulated 2-Manifolds",
*Visualization and Mathematics III*, 2003.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..adjacency import Adjacency
from ..mesh import Mesh
from ..normals import Columns, inner, triangle_vectors, vertex_normals
from .measure import corner_angles
from .topology import adjacent

__all__ = ["PrincipalCurvatures", "angle_defects", "gaussian_curvature", "mean_curvature", "mixed_areas", "principal_curvatures"]

Floats = NDArray[np.float64]


class PrincipalCurvatures(NamedTuple):
    """The greatest and the least normal curvature at each vertex, 1/m: (n,) float64 each."""

    greatest: Floats
    least: Floats


def angle_defects(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """By how much the angles around each vertex miss a full turn: the Gaussian curvature, integrated.

    Returns
    -------
    (n,) float64
        Radians. On the boundary what they miss of half a turn, which is how the rim turns there; 0 where there is no triangle. They sum to
        2 pi times the Euler characteristic (Gauss-Bonnet) where no triangle is degenerate.

    **Source**: Meyer et al. (2003), section 4; with the geodesic curvature of the boundary.
    """
    found = adjacent(mesh if surface is None else surface)
    whole = np.asarray(found.triangle_edges[:, 0] >= 0)
    total = np.bincount(mesh.triangles[whole].reshape(-1), weights=corner_angles(mesh)[whole].reshape(-1), minlength=found.n_vertices)
    # Pi less for each boundary edge, half of it at each end; more where more than two triangles meet.
    missing = np.repeat(2.0 - found.edge_counts, 2)
    rims = np.bincount(found.edges.reshape(-1), weights=missing, minlength=found.n_vertices)
    return np.where(found.vertex_counts > 0, 2.0 * np.pi - 0.5 * np.pi * rims - total, 0.0)


def mixed_areas(mesh: Mesh) -> Floats:
    """The ground around each vertex, square metres: (n,) float64; all sum to the area of the mesh.

    A triangle without an obtuse angle is shared along its perpendicular bisectors; of an obtuse one half falls to the obtuse corner.

    **Source**: Meyer et al. (2003), section 3.3, "mixed Voronoi cells".
    """
    shape = _shape(mesh)
    products = shape.squares * shape.cotangents
    # Corner k is between the sides opposite to the other two corners.
    share = products[:, (1, 2, 0)] + products[:, (2, 0, 1)]
    halves = np.where(shape.obtuse, 0.5, 0.25) * shape.areas[:, None]
    ground = np.where(shape.obtuse.any(axis=1, keepdims=True), halves, share / 8.0)
    shares = np.bincount(mesh.triangles.reshape(-1), weights=ground.reshape(-1), minlength=len(mesh.positions))
    return np.asarray(shares, dtype=np.float64)


def gaussian_curvature(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """The Gaussian curvature at each vertex, 1/m²: (n,) float64; NaN on the boundary and where there is no ground.

    **Source**: Meyer et al. (2003), eq. 9.
    """
    found = adjacent(mesh if surface is None else surface)
    return _spread(angle_defects(mesh, found), mesh, found)


def mean_curvature(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """The mean curvature at each vertex, 1/m.

    Returns
    -------
    (n,) float64
        Half the sum of the principal curvatures: positive where the surface bends away from its front, as a sphere's; NaN on the boundary
        and where there is no ground.

    **Source**: Meyer et al. (2003), eq. 8; the sign is that of the mean curvature normal along the vertex normal.
    """
    found = adjacent(mesh if surface is None else surface)
    shape, n = _shape(mesh), len(mesh.positions)
    bent = np.zeros((n, 3))
    for corner, side in enumerate(shape.sides):
        i, j = mesh.triangles[:, (corner + 1) % 3], mesh.triangles[:, (corner + 2) % 3]
        for axis in range(3):
            pull = 0.25 * shape.cotangents[:, corner] * side[axis]
            bent[:, axis] += np.bincount(j, pull, n) - np.bincount(i, pull, n)
    outward = vertex_normals(mesh.positions, mesh.triangles)
    size = np.sqrt((bent * bent).sum(axis=1))
    return _spread(np.copysign(size, (bent * outward).sum(axis=1)), mesh, found)


def principal_curvatures(mesh: Mesh, surface: Adjacency | None = None) -> PrincipalCurvatures:
    """The greatest and the least curvature at each vertex, from mean and Gaussian curvature.

    **Source**: Meyer et al. (2003), section 5.1: ``k = H ± sqrt(H² - K)``, the root 0 where rounding makes it imaginary.
    """
    found = adjacent(mesh if surface is None else surface)
    mean, gaussian = mean_curvature(mesh, found), gaussian_curvature(mesh, found)
    apart = np.sqrt(np.maximum(mean * mean - gaussian, 0.0))
    return PrincipalCurvatures(mean + apart, mean - apart)


def _spread(integral: Floats, mesh: Mesh, found: Adjacency) -> Floats:
    """An integral over the ground of each vertex as a mean over it."""
    ground = mixed_areas(mesh)
    inside = ground > 0.0
    inside[found.edges[found.edge_counts != 2].reshape(-1)] = False
    return np.where(inside, integral / np.where(inside, ground, 1.0), np.nan)


class _Shape(NamedTuple):
    """Of each triangle: the sides opposite to its corners, as columns from the next corner to the one after; and at the corners (m, 3) the
    squared lengths of those sides, the cotangents (0 where there is no area), whether they are obtuse; its area (m,)."""

    sides: tuple[Columns, Columns, Columns]
    squares: Floats
    cotangents: Floats
    obtuse: NDArray[np.bool_]
    areas: Floats


def _shape(mesh: Mesh) -> _Shape:
    e, f, g, normal = triangle_vectors(mesh.positions.astype(np.float64), mesh.triangles)
    double_area = np.sqrt(inner(normal, normal))
    cosines = np.stack([-inner(e, g), -inner(f, e), -inner(g, f)], axis=1)
    usable = double_area > 0.0
    cotangents = cosines * np.where(usable, 1.0 / np.where(usable, double_area, 1.0), 0.0)[:, None]
    squares = np.stack([inner(f, f), inner(g, g), inner(e, e)], axis=1)
    return _Shape((f, g, e), squares, cotangents, np.asarray(cosines < 0.0), 0.5 * double_area)
