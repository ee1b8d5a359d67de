"""Charts as triangles glued along edges.

A cut surface is told by which edges are *not* cut. Every triangle begins as a disc of its own; two discs glued along an edge are a disc;
a disc may be glued to itself where two halves of an edge follow each other on its rim, like a zipper. Nothing else is ever glued, so
every chart is a topological disc at all times, whatever the surface: handles, holes, closed and non-orientable ones only leave a few
edges more that no zipper reaches.

        rim of one: … a h b …                       rim: … h g …
        of another: … c g d …    glued: … a d …, … c b …        zipped: … …
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._door import Array, Door
from .surface import Surface

__all__ = ["Gluing", "Rims", "Runs"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_f, _i = Array(np.float64, 1), Array(np.int64, 1)
_glue = Door("limner.mesh.unwrap.gluing_kernel", "glue", (_i,) * 9, "the gluing of charts")
_runs = Door("limner.mesh.unwrap.gluing_kernel", "runs", (_i, _i, _i, _i, _i, _i, _f, _i, _f, _i), "the search for neighbouring charts")
_walk_rims = Door("limner.mesh.unwrap.gluing_kernel", "walk_rims", (_i,) * 8, "the rims of charts")


class Runs(NamedTuple):
    """Where two charts lie along each other without a break.

    Attributes
    ----------
    starts : (k,) int64
        The first half-edge, of the one chart; its mate is of the other.
    sizes : (k,) float64
        Sum of the costs of its edges.
    """

    starts: Indices
    sizes: Floats


class Rims(NamedTuple):
    """The rim of each chart, one after the other.

    Attributes
    ----------
    half_edges : (k,) int64
        In order, the chart to the left.
    first : (charts + 1,) int64
    """

    half_edges: Indices
    first: Indices


class Gluing:
    """Which half-edges of a surface are glued to their mates; at first none.

    Attributes
    ----------
    glued : (3 m,) int64
        1: glued.
    """

    def __init__(self, surface: Surface) -> None:
        m = surface.n_triangles
        corner = np.arange(3 * m).reshape(m, 3)
        self.surface = surface
        self.glued: Indices = np.zeros(3 * m, dtype=np.int64)
        self._following = np.ascontiguousarray(np.roll(corner, -1, axis=1)).reshape(-1)
        self._before = np.ascontiguousarray(np.roll(corner, 1, axis=1)).reshape(-1)
        self._parents = np.arange(m)
        self._lengths = np.full(m, 3, dtype=np.int64)

    def copy(self) -> Gluing:
        """Another that may be glued further without changing this one."""
        made = Gluing.__new__(Gluing)
        made.surface, made.glued = self.surface, self.glued.copy()
        made._following, made._before = self._following.copy(), self._before.copy()
        made._parents, made._lengths = self._parents.copy(), self._lengths.copy()
        return made

    def glue(self, half_edges: Indices, groups: Indices) -> None:
        """Glue half-edges, in turn, where both triangles are of one group and a disc remains; zip up what that opens.

        Parameters
        ----------
        half_edges : (k,) int64
        groups : (m,) int64
            Of the triangles.
        """
        _glue(
            np.ascontiguousarray(half_edges), self.surface.mates, self.surface.tips, np.ascontiguousarray(groups), self._parents,
            self._lengths, self._following, self._before, self.glued,
        )  # fmt: skip

    def roots(self) -> Indices:
        """(m,) int64: for each triangle the one that stands for its chart."""
        roots = self._parents
        while True:
            further = roots[roots]
            if (further == roots).all():
                return further
            roots = further

    def charts(self) -> Indices:
        """(m,) int64: the chart of each triangle, from 0."""
        return np.unique(self.roots(), return_inverse=True)[1].reshape(-1).astype(np.int64)

    def runs(self, costs: Floats) -> Runs:
        """Find where charts lie along each other, with the sum of `costs`, (3 m,) float64, over each run."""
        starts, sizes, count = np.empty_like(self.glued), np.empty(len(self.glued)), np.zeros(1, np.int64)
        _runs(self.surface.mates, self.surface.tips, self._parents, self._following, self._before, self.glued, costs, starts, sizes, count)
        return Runs(starts[: count[0]], sizes[: count[0]])

    def rims(self) -> Rims:
        """The rims; the k-th is that of the chart that `rims().half_edges[rims().first[k]] // 3` is in."""
        seen, rim, count = np.zeros_like(self.glued), np.empty_like(self.glued), np.zeros(1, np.int64)
        first = np.zeros(self.surface.n_triangles + 1, dtype=np.int64)
        _walk_rims(self._parents, self._following, self._before, self.glued, seen, rim, first, count)
        return Rims(rim[: first[count[0]]], first[: count[0] + 1])

    def corners(self) -> Indices:
        """(m, 3) int64: the chart vertex of each corner, from 0: corners around a point are one where the edges between them are glued."""
        return self.surface.fans(self.glued == 1)
