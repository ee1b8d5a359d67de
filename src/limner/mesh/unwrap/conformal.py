"""Least-squares conformal maps: charts laid flat so that angles change as little as may be.

A map to the plane, as a complex number z at each vertex, has a Dirichlet energy of at least its area, and just that where it is
conformal. The difference is a quadratic form of z, zero only where no angle changes; two vertices far apart are pinned, so that the
chart does not shrink to a point. The rim is free.

**Source**: Lévy, Petitjean, Ray and Maillot, *Least squares conformal maps for automatic texture atlas generation*, 2002; in the form
of Mullen, Tong, Alliez and Desbrun, *Spectral conformal parameterization*, 2008: E = 1/2 z* L z − area(z).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .pieces import Pieces
from .sparse import assembled, dirichlet, factorized

__all__ = ["conformal", "scaled_to_areas"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


def conformal(pieces: Pieces) -> Floats:
    """Lay charts flat with the least change of angles.

    Parameters
    ----------
    pieces : Pieces

    Returns
    -------
    (n, 2) float64
        Each chart as large as it is on the surface. Triangles may lie on their faces where a chart is far from developable.
    """
    n = pieces.n_vertices
    energy = dirichlet(pieces.surface, pieces.corners, n, pieces.triangles)
    # The area of a ring of points is the sum of Im(conj(z_i) z_j) / 2 over its edges.
    i, j = pieces.rim_corners, pieces.rim_next
    quarter = np.full(len(i), 0.5j)
    matrix = (energy + assembled(n, np.concatenate([i, j]), np.concatenate([j, i]), np.concatenate([quarter, -quarter]))).tocsc()
    pins, places = _pins(pieces)
    free = np.ones(n, dtype=bool)
    free[pins] = False
    inside = np.flatnonzero(free)
    z = np.zeros(n, dtype=np.complex128)
    z[pins] = places
    right = -(matrix[:, pins] @ places)[inside]
    if len(inside):
        z[inside] = factorized(matrix[inside][:, inside].tocsc()).solve(right)
    return scaled_to_areas(pieces, np.stack([z.real, z.imag], axis=1))


def _pins(pieces: Pieces) -> tuple[Indices, NDArray[np.complex128]]:
    """Two vertices of each rim, the farthest from its first and the farthest from that; and where they go."""
    first = pieces.rims.first[:-1]
    chart = np.repeat(np.arange(pieces.n_charts), np.diff(pieces.rims.first))
    points = pieces.positions[pieces.rim_corners]

    def farthest(origins: Indices) -> Indices:
        distances = np.linalg.norm(points - points[origins][chart], axis=1)
        order = np.lexsort((-distances, chart))
        return order[first]

    one = farthest(first)
    other = farthest(one)
    # Where all of a rim is one point, any other vertex will do.
    other = np.where(other == one, np.where(one == first, first + 1, first), other)
    lengths = np.maximum(np.linalg.norm(points[one] - points[other], axis=1), 1e-9)
    pins = pieces.rim_corners[np.concatenate([one, other])]
    return pins, np.concatenate([np.zeros(pieces.n_charts), lengths]).astype(np.complex128)


def scaled_to_areas(pieces: Pieces, flat: Floats) -> Floats:
    """Scale each chart about the origin to its area on the surface."""
    areas = np.abs(np.bincount(pieces.charts, pieces.signed_areas(flat), pieces.n_charts))
    scales = np.sqrt(pieces.chart_areas / np.maximum(areas, 1e-300))
    return flat * scales[pieces.chart_of][:, None]
