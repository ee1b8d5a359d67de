"""Which creases are lines, and which are the roughness of a scanned surface.

A fold of a design runs on: round a hole, or from one corner to another. Where a surface is only rough, single edges turn by more than any
angle that one may choose, here and there. So creases that hang together are looked at as one, in space, which is why a moving camera
does not make them flicker: they stay where they are a ring, end on other lines, or are long for the object that they are on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..mesh.components import component_labels

__all__ = ["lasting"]

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

_SHORT = 0.04  # of the object's extent


def lasting(points: NDArray[np.float64], edges: NDArray[np.int32], creased: Flags, firm: Flags, extents: NDArray[np.float64]) -> Flags:
    """Which creases are drawn.

    Parameters
    ----------
    points : (n, 3) float64
    edges : (k, 2) int32
    creased : (k,) bool
    firm : (k,) bool
        Edges that are lines whatever the angle: boundaries, for one.
    extents : (k,) float64
        Of the object that each edge is on, metres.

    Returns
    -------
    (k,) bool
    """
    rows = np.flatnonzero(creased)
    a, b = edges[rows].T
    lines_at = np.bincount(edges[creased | firm].reshape(-1), minlength=len(points))
    component = component_labels(len(points), a, b)[a]
    loose = np.zeros(len(points), dtype=bool)
    loose[component[(lines_at[a] < 2) | (lines_at[b] < 2)]] = True
    length = np.bincount(component, np.linalg.norm(points[a] - points[b], axis=1), len(points))
    made = np.zeros(len(edges), dtype=bool)
    made[rows] = ~loose[component] | (length[component] >= _SHORT * extents[rows])
    return made
