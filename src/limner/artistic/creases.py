"""Which creases are lines, and which are the roughness of a scanned surface.

A fold of a design runs on: round a hole, or from one corner to another. Where a surface is only rough, single edges turn by more than any
angle that one may choose, here and there. So creases that hang together are looked at as one, in space, which is why a moving camera
does not make them flicker: they stay where they are a ring, end on other lines, or are long for the object that they are on. Hairs that
stand off a fold, and end in the open, are roughness, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..mesh.components import component_labels

__all__ = ["lasting"]

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

_SHORT = 0.04  # of the object's extent
_SHAVES = 3  # times that hairs are taken away, for hairs stand on hairs


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
    made = creased.copy()
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    for _ in range(_SHAVES):
        lines_at = np.bincount(edges[made | firm].reshape(-1), minlength=len(points))
        hairs = _loose(edges, made, lines_at, length, extents, lines_at == 2)
        if not hairs.any():
            break
        made &= ~hairs
    lines_at = np.bincount(edges[made | firm].reshape(-1), minlength=len(points))
    return made & ~_loose(edges, made, lines_at, length, extents, np.ones(len(points), dtype=bool))


def _loose(
    edges: NDArray[np.int32], creased: Flags, lines_at: Indices, length: NDArray[np.float64], extents: NDArray[np.float64], through: Flags
) -> Flags:
    """(k,) bool: creases that hang together through points, (n,), are short, and end somewhere in the open."""
    rows = np.flatnonzero(creased)
    ends = edges[rows]
    at = np.argsort(ends.reshape(-1), kind="stable")
    point = ends.reshape(-1)[at]
    linked = (point[1:] == point[:-1]) & through[point[1:]]
    chain = component_labels(len(rows), at[:-1][linked] >> 1, at[1:][linked] >> 1)
    long = np.bincount(chain, length[rows], len(rows)) >= _SHORT * extents[rows]
    open_end = np.zeros(len(rows), dtype=bool)
    open_end[chain[(lines_at[ends] < 2).any(axis=1)]] = True
    made = np.zeros(len(edges), dtype=bool)
    made[rows] = open_end[chain] & ~long[chain]
    return made
