"""Cut charts as one system: all of them are flattened at once, and no one's number enters another's.

The matrix of a surface in charts falls into blocks, one for each chart; a factorisation takes them one by one all by itself. What is
decided chart by chart (scales, steps, whether to go on) is an array with one number for each, so that nothing loops over charts.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .gluing import Rims
from .surface import Surface

__all__ = ["Pieces"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Pieces:
    """Charts to flatten.

    Parameters
    ----------
    surface : Surface
    triangles : (k,) int64
        Those of the charts; every chart is whole.
    corners : (k, 3) int64
        Chart vertices, from 0, all used.
    charts : (k,) int64
        From 0, all used.
    rims : Rims
        Of these charts, in their order.

    Attributes
    ----------
    n_charts, n_vertices : int
    chart_of : (n,) int64
        The chart of each chart vertex.
    """

    def __init__(self, surface: Surface, triangles: Indices, corners: Indices, charts: Indices, rims: Rims) -> None:
        self.surface, self.triangles = surface, triangles
        self.corners, self.charts = np.ascontiguousarray(corners), np.ascontiguousarray(charts)
        self.n_charts = int(charts.max()) + 1 if len(charts) else 0
        self.n_vertices = int(corners.max()) + 1 if len(corners) else 0
        self.chart_of: Indices = np.zeros(self.n_vertices, dtype=np.int64)
        self.chart_of[corners.reshape(-1)] = np.repeat(charts, 3)
        self.rims = rims

    @classmethod
    def of(cls, gluing: Any) -> Pieces:
        """The charts of a `Gluing`."""
        charts = gluing.charts()
        rims = gluing.rims()
        order = np.argsort(charts[rims.half_edges[rims.first[:-1]] // 3], kind="stable")
        everything = np.arange(gluing.surface.n_triangles)
        return cls(gluing.surface, everything, gluing.corners(), charts, _chosen_rims(rims, order))

    def only(self, wanted: Indices) -> tuple[Pieces, Indices]:
        """Some of the charts, by ascending number, as pieces of their own; and which vertices, (k,) int64, those have here."""
        inside = np.isin(self.charts, wanted)
        vertices, corners = np.unique(self.corners[inside], return_inverse=True)
        charts = np.searchsorted(wanted, self.charts[inside])
        made = Pieces(self.surface, self.triangles[inside], corners.reshape(-1, 3), charts, _chosen_rims(self.rims, wanted))
        return made, vertices

    @cached_property
    def shapes(self) -> Floats:
        """(k, 3) float64: see `Surface.shapes`."""
        return self.surface.shapes[self.triangles]

    @cached_property
    def areas(self) -> Floats:
        """(k,) float64: of the shapes; positive."""
        return 0.5 * self.shapes[:, 0] * self.shapes[:, 2]

    @cached_property
    def chart_areas(self) -> Floats:
        """(charts,) float64."""
        return np.bincount(self.charts, self.areas, self.n_charts).astype(np.float64)

    @cached_property
    def rim_corners(self) -> Indices:
        """(r,) int64: the chart vertex at which each half-edge of the rims starts."""
        place = np.full(self.surface.n_triangles, -1, dtype=np.int64)
        place[self.triangles] = np.arange(len(self.triangles))
        h = self.rims.half_edges
        return self.corners[place[h // 3], h % 3]

    @cached_property
    def rim_next(self) -> Indices:
        """(r,) int64: the chart vertex at which it ends."""
        after = np.arange(1, len(self.rim_corners) + 1)
        after[self.rims.first[1:] - 1] = self.rims.first[:-1]
        return self.rim_corners[after]

    @cached_property
    def positions(self) -> Floats:
        """(n, 3) float64: of the chart vertices, on the surface."""
        made = np.empty((self.n_vertices, 3))
        made[self.corners.reshape(-1)] = self.surface.points[self.surface.triangles[self.triangles].reshape(-1)]
        return made

    def chart_sums(self, per_vertex: Floats) -> Floats:
        """(charts,) float64: the sum of a number for each vertex."""
        return np.bincount(self.chart_of, per_vertex, self.n_charts).astype(np.float64)

    def jacobians(self, flat: Floats) -> Floats:
        """(2, 2, k) float64: d(flat) / d(surface) in each triangle, for vertices at `flat`, (n, 2)."""
        a, b, c = flat[self.corners.T]
        length, x, y = self.shapes.T
        along = (b - a).T / length
        across = ((c - a).T - along * x) / y
        return np.stack([along, across], axis=1)

    def signed_areas(self, flat: Floats) -> Floats:
        """(k,) float64: of the triangles in the plane, negative where one lies on its face."""
        a, b, c = flat[self.corners.T]
        e, f = b - a, c - a
        return 0.5 * (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])


def _chosen_rims(rims: Rims, wanted: Indices) -> Rims:
    sizes = np.diff(rims.first)[wanted]
    first = np.append(0, np.cumsum(sizes))
    within = np.arange(first[-1]) - np.repeat(first[:-1], sizes)
    return Rims(rims.half_edges[np.repeat(rims.first[wanted], sizes) + within], first)
