"""A mesh as unwrapping sees it: half-edges that may be glued, and every triangle's shape in its own plane.

Half-edge ``3 t + c`` runs from corner c of triangle t to the next. Its *mate* is the half-edge that runs the other way along the same
edge, also where a file has split its positions. Where more than two triangles meet, where two of them disagree about which side is
outside, and on the rim, there is none: such edges stay cut, and so every surface that is glued of triangles along mates is an oriented
manifold, whatever the input was.

Lengths are in units in which the whole surface has the area 1, so that thresholds mean the same for a bolt and for a planet.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UnsupportedError
from ..mesh import Mesh

__all__ = ["Surface", "components", "scipy_sparse"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_TIP = 0.8  # radians that are missing around a vertex
_CORNER, _SHARP = 0.2, 1.0  # so many, where an edge bends by so many
_LARGE = 2e-3  # of the surface, that the triangles around a corner cover
_LEAST_HEIGHT = 1e-5  # of the longest edge: a flatter triangle is flattened as if it were this high


class Surface:
    """Triangles with distinct corners, their mates and shapes.

    Parameters
    ----------
    mesh : Mesh

    Attributes
    ----------
    kept : (m,) int64
        Triangles of the mesh whose corners are three positions; those that name one twice have no shape to flatten.
    points : (n, 3) float64
        Scaled and centred positions of the mesh.
    unit : float
        Length in the mesh of the unit here: the square root of its area; 1 where it has none.
    triangles : (m, 3) int64
    mates : (3 m,) int64
        -1: none.
    """

    def __init__(self, mesh: Mesh) -> None:
        corners = mesh.triangles.astype(np.int64)
        distinct = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        self.kept: Indices = np.flatnonzero(distinct)
        self.triangles: Indices = np.ascontiguousarray(corners[distinct])
        points = mesh.positions.astype(np.float64)
        if len(self.triangles):
            points = points - (mesh.bounds[0] + mesh.bounds[1]) / 2.0
            points /= max(float(np.abs(points[self.triangles.reshape(-1)]).max()), 1e-300)
        area = float(_areas_and_normals(points[self.triangles])[0].sum())
        self.points: Floats = points / np.sqrt(area) if area > 0.0 else points
        original = float(np.abs(mesh.bounds[1] - mesh.bounds[0]).max() / 2.0) if len(self.triangles) else 1.0
        self.unit = original * float(np.sqrt(area)) if area > 0.0 and original > 0.0 else 1.0
        self.areas, self.normals = _areas_and_normals(self.points[self.triangles])
        self.mates = _mates(self.triangles, self.points)

    @property
    def n_triangles(self) -> int:
        """How many triangles there are to flatten."""
        return len(self.triangles)

    @cached_property
    def centroids(self) -> Floats:
        """(m, 3) float64."""
        return np.ascontiguousarray(self.points[self.triangles].mean(axis=1))

    @cached_property
    def lengths(self) -> Floats:
        """(3 m,) float64: of the half-edges."""
        p = self.points[self.triangles]
        return np.ascontiguousarray(np.linalg.norm(np.roll(p, -1, axis=1) - p, axis=2).reshape(-1))

    @cached_property
    def bends(self) -> Floats:
        """(3 m,) float64: radians by which the surface turns at a half-edge; 0 where there is no mate or a side has no area."""
        own = np.repeat(self.normals, 3, axis=0)
        other = self.normals[np.maximum(self.mates, 0) // 3]
        bends = np.arctan2(np.linalg.norm(np.cross(own, other), axis=1), np.einsum("ij,ij->i", own, other))
        return np.where(self.mates >= 0, bends, 0.0)

    @cached_property
    def shapes(self) -> Floats:
        """(m, 3) float64: corners at (0, 0), (l, 0) and (x, y) as l, x, y; y is positive, also where the triangle has no area."""
        p = self.points[self.triangles]
        first, second = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        longest = np.maximum(self.lengths.reshape(-1, 3).max(axis=1), 1e-12)
        length = np.linalg.norm(first, axis=1)
        safe = np.maximum(length, 1e-300)
        x = np.einsum("ij,ij->i", first, second) / safe
        y = np.linalg.norm(np.cross(first, second), axis=1) / safe
        least = _LEAST_HEIGHT * longest
        return np.stack([np.maximum(length, least), x, np.maximum(y, least)], axis=1)

    @cached_property
    def cotangents(self) -> Floats:
        """(m, 3) float64: of the angle at each corner."""
        length, x, y = self.shapes.T
        return np.stack([x / y, (length - x) / y, (x * x - length * x + y * y) / (length * y)], axis=1)

    @cached_property
    def angles(self) -> Floats:
        """(m, 3) float64: at each corner, radians."""
        p = self.points[self.triangles]
        first, second = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
        return np.arctan2(np.linalg.norm(np.cross(first, second), axis=2), np.einsum("ijk,ijk->ij", first, second))

    def fans(self, joined: NDArray[np.bool_]) -> Indices:
        """(m, 3) int64: for each corner its fan, from 0; corners around a point are in one where the edges between them are joined.

        Parameters
        ----------
        joined : (3 m,) bool
            Half-edges that are joined to their mates.
        """
        h = np.flatnonzero(joined & (self.mates > np.arange(len(joined))))
        g = self.mates[h]
        end_h, end_g = h - h % 3 + (h + 1) % 3, g - g % 3 + (g + 1) % 3
        return components(3 * self.n_triangles, np.concatenate([h, end_h]), np.concatenate([end_g, g])).reshape(-1, 3)

    @cached_property
    def umbrellas(self) -> Indices:
        """(m, 3) int64: for each corner the fan that it is in where all mates are joined: the points of the surface as a manifold."""
        return self.fans(self.mates >= 0)

    @cached_property
    def defects(self) -> Floats:
        """(n,) float64: of each umbrella 2π less the angles in it, its curvature; 0 on the rim of the surface."""
        at = self.umbrellas.reshape(-1)
        n = int(at.max()) + 1 if len(at) else 0
        defects = np.asarray(2.0 * np.pi - np.bincount(at, self.angles.reshape(-1), n), dtype=np.float64)
        rim = np.flatnonzero(self.mates < 0)
        defects[at[rim]] = defects[at[rim - rim % 3 + (rim + 1) % 3]] = 0.0
        return defects

    @cached_property
    def is_sharp(self) -> NDArray[np.bool_]:
        """(n,) bool: whether an edge at the umbrella bends sharply."""
        sharpest = np.zeros(len(self.defects))
        np.maximum.at(sharpest, self.umbrellas.reshape(-1), self.bends)
        return sharpest > _SHARP

    @cached_property
    def tips(self) -> Indices:
        """(3 m,) int64: 1 where a half-edge starts at a tip, which no chart may close around: of a cone, or a corner with sharp edges."""
        at = self.umbrellas.reshape(-1)
        # What is sharp but tiny is roughness, which costs less than a cut to each of its points.
        large = np.bincount(at, np.repeat(self.areas, 3), len(self.defects)) > _LARGE
        return ((self.defects > _TIP) | ((self.defects > _CORNER) & self.is_sharp & large))[at].astype(np.int64)


def components(n: int, first: Indices, second: Indices) -> Indices:
    """(n,) int64: the component of each node of a graph with edges between `first` and `second`, from 0."""
    if n == 0:
        return np.zeros(0, dtype=np.int64)
    graph = scipy_sparse().coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(n, n)).tocsr()
    from scipy.sparse.csgraph import connected_components

    return connected_components(graph, directed=False)[1].astype(np.int64)


def scipy_sparse() -> Any:
    """`scipy.sparse`; UnsupportedError, saying what to install, where it is not there."""
    try:
        import scipy.sparse as sparse
    except ImportError:
        raise UnsupportedError('unwrapping needs SciPy: pip install "limner[mesh]"') from None
    return sparse


def _areas_and_normals(p: Floats) -> tuple[Floats, Floats]:
    """(m,) and (m, 3): the normal of a triangle without area is zero."""
    cross: Floats = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    lengths: Any = np.linalg.norm(cross, axis=1)
    return lengths / 2.0, np.ascontiguousarray(cross / np.maximum(lengths, 1e-300)[:, None])


def _mates(triangles: Indices, points: Floats) -> Indices:
    """(3 m,): for each half-edge the only one that runs the other way along its edge, or -1.

    First by the positions that triangles name; on the rims that are left, by where these are: files split positions at seams.
    """
    starts, ends = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    mates = np.full(len(starts), -1, dtype=np.int64)
    _pair(np.arange(len(starts)), starts, ends, mates)
    alone = np.flatnonzero(_counts(starts, ends) == 1)
    if len(alone):
        used = np.unique(np.concatenate([starts[alone], ends[alone]]))
        place = np.zeros(len(points), dtype=np.int64)
        place[used] = np.unique(points[used] + 0.0, axis=0, return_inverse=True)[1].reshape(-1)
        proper = alone[place[starts[alone]] != place[ends[alone]]]
        _pair(proper, place[starts[proper]], place[ends[proper]], mates)
    return mates


def _edges(starts: Indices, ends: Indices) -> Indices:
    """(k,): the same number for both directions."""
    n = np.int64(max(int(starts.max(initial=0)), int(ends.max(initial=0))) + 1)
    return np.minimum(starts, ends) * n + np.maximum(starts, ends)


def _counts(starts: Indices, ends: Indices) -> Indices:
    """(k,): how many half-edges lie along the edge of each."""
    _, which, counts = np.unique(_edges(starts, ends), return_inverse=True, return_counts=True)
    return counts[which.reshape(-1)]


def _pair(half_edges: Indices, starts: Indices, ends: Indices, mates: Indices) -> None:
    """Enter into `mates` those of `half_edges`, from `starts` to `ends`, of which two lie along an edge, in opposite directions."""
    edges = _edges(starts, ends)
    order = np.argsort(edges, kind="stable")
    edges = edges[order]
    if len(edges) < 2:
        return
    same = edges[1:] == edges[:-1]
    alone_before, alone_after = np.append(True, ~same[:-1]), np.append(~same[1:], True)
    pairs = np.flatnonzero(same & alone_before & alone_after)
    first, second = order[pairs], order[pairs + 1]
    opposed = starts[first] == ends[second]
    first, second = half_edges[first[opposed]], half_edges[second[opposed]]
    mates[first], mates[second] = second, first
