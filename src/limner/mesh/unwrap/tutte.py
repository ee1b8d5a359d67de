"""Tutte's embedding: a chart with its rim on a circle and every other vertex a mean of its neighbours. It cannot fold.

The weights of the means are Floater's, positive for any triangles, so that the theorem holds: with the rim on a strictly convex
curve no triangle lies on its face and none overlaps another. What it lacks is a good shape; `isometric` gives it one.

**Source**: Tutte, *How to draw a graph*, 1963; Floater, *Mean value coordinates*, 2003: w_ij = (tan(α/2) + tan(β/2)) / |x_j − x_i|.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .conformal import scaled_to_areas
from .pieces import Pieces
from .sparse import assembled, factorized

__all__ = ["mean_value_weights", "tutte"]

Floats = NDArray[np.float64]


def tutte(pieces: Pieces, uniform: bool = False) -> Floats:
    """Embed charts in disks.

    Parameters
    ----------
    pieces : Pieces
    uniform : bool
        Whether all neighbours weigh the same, as Tutte had it.

    Returns
    -------
    (n, 2) float64
        Each chart as large as it is on the surface, its rim on a circle, spaced by the lengths of its edges.
    """
    n = pieces.n_vertices
    flat = np.zeros((n, 2))
    on_rim = np.zeros(n, dtype=bool)
    on_rim[pieces.rim_corners] = True
    flat[pieces.rim_corners] = _circle(pieces)
    inside = np.flatnonzero(~on_rim)
    if len(inside):
        matrix = mean_value_weights(pieces, uniform)
        rows = matrix.tocsr()[inside]
        flat[inside] = factorized(rows[:, inside].tocsc(), symmetric=uniform).solve(-(rows @ flat))
    return scaled_to_areas(pieces, flat)


def _circle(pieces: Pieces) -> Floats:
    """(r, 2): the rim's vertices in order; spaced by length, but none too close to tell from the next."""
    lengths = np.linalg.norm(pieces.positions[pieces.rim_corners] - pieces.positions[pieces.rim_next], axis=1)
    first, sizes = pieces.rims.first[:-1], np.diff(pieces.rims.first)
    mean = np.add.reduceat(lengths, first) / sizes
    lengths = np.maximum(lengths, 1e-2 * np.repeat(np.where(mean > 0.0, mean, 1.0), sizes))
    total = np.repeat(np.add.reduceat(lengths, first), sizes)
    along = np.append(0.0, np.cumsum(lengths / total))
    angle = 2.0 * math.pi * (along[:-1] - np.repeat(along[first], sizes))
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def mean_value_weights(pieces: Pieces, uniform: bool = False) -> Any:
    """An (n, n) sparse matrix: minus the weight of each neighbour, and on the diagonal their sum; rows of rim vertices are incomplete."""
    n = pieces.n_vertices
    i, j, k = pieces.corners.T
    rows, columns = np.concatenate([i, j, k, i, j, k]), np.concatenate([j, k, i, k, i, j])
    if uniform:
        weights = np.full(len(rows), 0.5)
    else:
        length, x, y = pieces.shapes.T
        sides = np.stack([length, np.hypot(x - length, y), np.hypot(x, y)])  # ij, jk, ki
        cotangents = pieces.surface.cotangents[pieces.triangles].T
        # tan(θ/2) = sqrt(1 + cot² θ) − cot θ, written so that it is positive also for the smallest angle
        root = np.sqrt(1.0 + cotangents * cotangents)
        half = np.where(cotangents > 0.0, 1.0 / (root + np.abs(cotangents)), root - cotangents)
        weights = np.concatenate([half / sides, half / np.roll(sides, 1, axis=0)]).reshape(-1)
    return assembled(n, np.concatenate([rows, rows]), np.concatenate([columns, rows]), np.concatenate([-weights, weights]))
