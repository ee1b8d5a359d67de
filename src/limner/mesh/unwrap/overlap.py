"""Whether a flattened chart lies over itself.

A map of a disc that turns no triangle over and whose rim does not cross itself is one to one: it is enough to look at the rims.

**Source**: Lipman, *Bijective mappings of meshes with boundary and the degree in mesh processing*, 2014.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..._door import Array, Door
from .pieces import Pieces

__all__ = ["crossings", "overlapping", "turned_over"]

_crossings = Door(
    "limner.mesh.unwrap.overlap_kernel",
    "crossings",
    (Array(np.float64, 2), Array(np.int64, 1), Array(np.int64, 2), Array(np.int64, 2)),
    "the test of charts for overlaps",
)


def turned_over(pieces: Pieces, flat: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(charts,) bool: whether a triangle of the chart lies on its face, or has no area left."""
    return np.bincount(pieces.charts, pieces.signed_areas(flat) <= 0.0, pieces.n_charts) > 0


def overlapping(pieces: Pieces, flat: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(charts,) bool: whether the chart's rim crosses itself, for vertices at `flat`, (n, 2)."""
    return crossings(pieces, flat)[:, 0] >= 0


def crossings(pieces: Pieces, flat: NDArray[np.float64]) -> NDArray[np.int64]:
    """(charts, 2) int64: two half-edges of each chart's rim that cross, as places in `pieces.rims.half_edges`; -1: there are none."""
    i, j = pieces.rim_corners, pieces.rim_next
    charts = np.repeat(np.arange(pieces.n_charts), np.diff(pieces.rims.first))
    segments = np.concatenate([flat[i], flat[j]], axis=1)
    order = np.lexsort((np.minimum(segments[:, 0], segments[:, 2]), charts))
    found = np.full((pieces.n_charts, 2), -1, dtype=np.int64)
    _crossings(np.ascontiguousarray(segments[order]), charts[order], np.ascontiguousarray(np.stack([i, j], axis=1)[order]), found)
    return np.where(found >= 0, order[np.maximum(found, 0)] if len(order) else -1, -1)
