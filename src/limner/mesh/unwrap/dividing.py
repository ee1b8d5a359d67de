"""Cutting charts in two."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .gluing import Gluing
from .sparse import assembled

__all__ = ["divided", "regrouped"]

Indices = NDArray[np.int64]


def divided(gluing: Gluing, charts: Indices, chosen: Indices, seeds: Indices) -> Gluing:
    """Cut charts in two, each triangle going to the nearer of two seeds, by the way over the chart.

    Parameters
    ----------
    gluing : Gluing
    charts : (m,) int64
        Of the triangles.
    chosen : (k,) int64
        Charts of more than one triangle.
    seeds : (k, 2) int64
        Triangles; where both are one: the two that are about the farthest apart.
    """
    from scipy.sparse.csgraph import dijkstra

    surface = gluing.surface
    groups = 2 * charts
    wanted = np.zeros(int(charts.max()) + 1, dtype=bool)
    wanted[chosen] = True
    h = np.flatnonzero((gluing.glued == 1) & np.repeat(wanted[charts], 3))
    a, b = h // 3, surface.mates[h] // 3
    distances = np.linalg.norm(surface.centroids[a] - surface.centroids[b], axis=1) + 1e-12
    graph = assembled(surface.n_triangles, a, b, distances).tocsr()
    for chart, pair in zip(chosen, seeds, strict=True):
        inside = np.flatnonzero(charts == chart)
        part = graph[inside][:, inside]
        first, second = (int(place) for place in np.searchsorted(inside, pair))
        if first == second:
            first = int(np.argmax(dijkstra(part, directed=False, indices=0)))
            second = int(np.argmax(dijkstra(part, directed=False, indices=first)))
        from_first, from_second = (dijkstra(part, directed=False, indices=seed) for seed in (first, second))
        groups[inside[from_first < from_second]] += 1
    return regrouped(gluing, groups)


def regrouped(gluing: Gluing, groups: Indices) -> Gluing:
    """Glue anew what was glued, but only within groups of triangles; where a choice is left, cuts go along bends."""
    made = Gluing(gluing.surface)
    order = np.flatnonzero(gluing.glued == 1)
    made.glue(order[np.argsort(gluing.surface.bends[order], kind="stable")], groups)
    return made
