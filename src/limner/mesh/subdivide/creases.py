"""Edges that stay sharp while a surface is smoothed: for ever, or for some steps (Hoppe et al. 1994, DeRose et al. 1998).

A number for each edge tells how long: it falls by one with every step, and while it is positive the edge is treated as the border of a
surface is. Between 0 and 1 a step blends both rules. Borders are sharp for ever. How many sharp edges meet in a vertex decides its rule:

    0 or 1   smooth       2   crease: a curve of the sharp edges alone       3 and more   corner: it stays

**Source**: Hoppe et al., "Piecewise Smooth Surface Reconstruction", SIGGRAPH 1994; DeRose, Kass and Truong, "Subdivision Surfaces in
Character Animation", SIGGRAPH 1998.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from .faces import Faces, summed

__all__ = ["NO_CREASES", "Creases", "Sharpness", "blended", "checked_creases", "sharpness_of"]

Values = NDArray[np.float64]


class Creases(NamedTuple):
    """Edges by their vertices, and how sharp they are.

    Attributes
    ----------
    pairs : (k, 2) int64
    sharpness : (k,) float64
        Steps for which each stays sharp; inf: for ever.
    keeps_corners : bool
        Vertices of a single polygon stay where they are.
    """

    pairs: NDArray[np.int64]
    sharpness: Values
    keeps_corners: bool

    def divided(self, faces: Faces) -> Creases:
        """What is left of them after a step that puts vertex ``n_vertices + e`` in the middle of edge e."""
        edges = faces.find_edges(self.pairs)
        left = self.sharpness - 1.0
        kept = (left > 0.0) & (edges >= 0)
        middle = faces.n_vertices + edges[kept]
        halves = [np.stack([self.pairs[kept, end], middle], axis=1) for end in (0, 1)]
        return Creases(np.concatenate(halves), np.tile(left[kept], 2), self.keeps_corners)


class Sharpness(NamedTuple):
    """How sharp edges and vertices are, as weights from 0 to 1.

    Attributes
    ----------
    edge : (e,) float64
    crease, corner : (n,) float64
        How much of a vertex follows the rule of a crease, and how much stays; what is left is smooth.
    along : (e,) bool
        The edges that creases run along.
    """

    edge: Values
    crease: Values
    corner: Values
    along: NDArray[np.bool_]


NO_CREASES = Creases(np.zeros((0, 2), dtype=np.int64), np.zeros(0), False)


def checked_creases(creases: ArrayLike, sharpness: ArrayLike, keeps_corners: bool, faces: Faces, name: str) -> Creases:
    """Check what a caller gives: pairs of vertices (k, 2) that are edges, and one number or one for each."""
    pairs = np.asarray(creases)
    if pairs.size == 0:
        pairs = np.zeros((0, 2), dtype=np.int64)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.dtype.kind not in "iu":
        raise SceneError(f"{name}.creases must be vertex pairs of shape (k, 2), got {pairs.dtype} of shape {pairs.shape}")
    pairs = pairs.astype(np.int64)
    if pairs.size and not 0 <= pairs.min() <= pairs.max() < faces.n_vertices:
        raise SceneError(f"{name}.creases must lie in 0..{faces.n_vertices - 1}, got {pairs.min()}..{pairs.max()}")
    missing = np.flatnonzero(faces.find_edges(pairs) < 0)
    if len(missing):
        raise SceneError(f"{name}.creases[{missing[0]}] = {pairs[missing[0]].tolist()} is not an edge of the mesh")
    steps = np.asarray(sharpness, dtype=np.float64)
    if steps.shape not in ((), (len(pairs),)) or np.isnan(steps).any() or (steps < 0.0).any():
        raise SceneError(f"{name}.sharpness must be one number >= 0 or one per crease ({len(pairs)}), got {steps.tolist()}")
    return Creases(pairs, np.broadcast_to(steps, (len(pairs),)).copy(), keeps_corners)


def sharpness_of(faces: Faces, creases: Creases, *, at_the_limit: bool = False) -> Sharpness:
    """Weigh the rules for a step; `at_the_limit`: what is sharp still is so for ever."""
    left = np.where(faces.is_sharp, np.inf, 0.0)
    if len(creases.pairs):
        np.maximum.at(left, faces.find_edges(creases.pairs), creases.sharpness)
    if at_the_limit:
        left = np.where(left > 0.0, np.inf, 0.0)
    along = left > 0.0
    n = faces.n_vertices
    count = np.bincount(faces.edges[along].reshape(-1), minlength=n)
    crease, corner = np.zeros(n), np.zeros(n)
    if along.any():
        total = summed(faces.edges[along].reshape(-1), np.minimum(np.repeat(left[along], 2), 1e30)[:, None], n)[:, 0]
        weight = np.minimum(total / np.maximum(count, 1), 1.0)
        crease, corner = np.where(count == 2, weight, 0.0), np.where(count > 2, weight, 0.0)
    alone = np.bincount(faces.vertex, minlength=n)
    stays = (alone == 1) & (count > 0) if creases.keeps_corners else np.zeros(n, dtype=bool)
    stays |= alone == 0
    return Sharpness(np.minimum(left, 1.0), np.where(stays, 0.0, crease), np.where(stays, 1.0, corner), along)


def blended(faces: Faces, values: Values, sharp: Sharpness, smooth: Values, share: float) -> Values:
    """Smooth values, but where a crease gives a vertex `share` of both its neighbours on it, and where a corner keeps it."""
    if not (sharp.crease.any() or sharp.corner.any()):
        return smooth
    beside, _ = faces.neighbours(values, sharp.along)
    crease = (1.0 - 2.0 * share) * values + share * beside
    w_crease, w_corner = sharp.crease[:, None], sharp.corner[:, None]
    return (1.0 - w_crease - w_corner) * smooth + w_crease * crease + w_corner * values
