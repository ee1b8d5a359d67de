"""Rays against bare triangles: no scene, no picture.

    caster = limner.RayCaster(vertices, triangles)
    hits = caster.intersect(origins, directions)      # hits.t (inf: a miss), hits.triangle (-1: a miss), hits.u, hits.v
    dark = caster.occluded(points, towards_light, t_max=1.0)

    every = caster.all_hits(origins, directions)      # every.t, every.triangle, and every.ray: whose hit it is

The tree and the tests at its leaves are those of the ray tracer: watertight, both sides of every triangle. Work is split over threads
with the interpreter's lock released; what a ray hits does not depend on how. Nor does it depend on the accelerator: the book's other
structures (FoCG 12.3) stand beside the tree to be compared with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .accel import batch, batch_structures
from .accel.batch_structures import Structure
from .accel.bvh import build_over_triangles
from .accel.layouts import Accelerator
from .accel.volume_tree import VolumeTree, build_volume_tree
from .errors import SceneError, UnsupportedError
from .tiles import thread_count

__all__ = ["AllHits", "Hits", "Kind", "RayCaster", "Visits"]

Kind: TypeAlias = Literal["bvh", "grid", "bsp", "volume_tree", "linear"]

_FAR = 4.0  # a mesh whose centre lies this many half edges away from the origin is moved there
_SMALLEST, _LARGEST = 1e-6, 1e6  # half edges that float32 can square and square again


@dataclass(frozen=True, eq=False)
class Hits:
    """What rays met, an element for each.

    Attributes
    ----------
    t : (n,) float32
        The hit is at ``origin + t * direction``; inf: a miss.
    triangle : (n,) int32
        Row of the given triangles; -1: a miss.
    u, v : (n,) float32
        Weights of the triangle's second and third vertex, the first has 1 - u - v; 0 for a miss.
    """

    t: NDArray[np.float32]
    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]

    @property
    def hit(self) -> NDArray[np.bool_]:
        """(n,) bool: which rays met anything."""
        return np.asarray(self.triangle >= 0)

    def __len__(self) -> int:
        return len(self.t)


@dataclass(frozen=True, eq=False)
class AllHits:
    """All that rays met, an element for each hit, ray by ray, the nearest first.

    Attributes
    ----------
    ray : (m,) int64
        Which ray; rays in a grid are counted row by row.
    t : (m,) float32
    triangle : (m,) int32
    u, v : (m,) float32
        As of `Hits`.
    starts : (n + 1,) int64
        The hits of ray k are ``starts[k]:starts[k + 1]`` of each array.
    """

    ray: NDArray[np.int64]
    t: NDArray[np.float32]
    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    starts: NDArray[np.int64]

    @property
    def counts(self) -> NDArray[np.int64]:
        """(n,) int64: how many hits each ray has."""
        return np.diff(self.starts)

    def __len__(self) -> int:
        return len(self.t)


@dataclass(frozen=True, eq=False)
class Visits:
    """What was looked at to find the hits of rays, an element for each.

    Attributes
    ----------
    nodes : (n,) int32
        Cells of a grid, nodes of a BSP, boxes of the plain tree; of the tree of eight children its nodes, of which each is eight boxes that
        are met at once.
    triangles : (n,) int32
        Those listed twice and met twice count twice. The tree of eight children meets up to eight at once.
    """

    nodes: NDArray[np.int32]
    triangles: NDArray[np.int32]


class RayCaster:
    """Finds which triangle a ray meets first, and whether it meets any.

    Parameters
    ----------
    vertices : (n, 3) array_like
        Any floats or integers. A mesh far from the origin is moved there in float64 before anything is rounded.
    triangles : (m, 3) array_like of integers
        Rows of `vertices`. Triangles with a vertex that is not finite are left out, their numbers stay; those without area are
        never hit.
    accelerator : "bvh" | "grid" | "bsp" | "volume_tree" | "linear"
        How triangles are found: by the ray tracer's tree, the fastest; by a uniform grid, a binary space partition or the plain tree of
        least volumes; or by trying all, which is slow, and the oracle. The answer is the same: where triangles are met at the very same t,
        "bvh" may find any of them, the others the first.

    spatial_splits : bool
        Of "bvh": whether large triangles stand in the tree in parts. Slower to build, and up to half as large again; faster where long
        triangles lie across the axes, as in architecture and plans.

    Raises
    ------
    SceneError
        The arrays have no such shape, or an index refers to no vertex.
    UnsupportedError
        There is no such accelerator.

    Examples
    --------
    >>> caster = RayCaster([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hits = caster.intersect([[0.25, 0.5, 3], [2, 2, 3]], [0, 0, -1])
    >>> hits.t.tolist(), hits.triangle.tolist(), hits.u.tolist(), hits.v.tolist()
    ([3.0, inf], [0, -1], [0.25, 0.0], [0.5, 0.0])
    """

    def __init__(self, vertices: ArrayLike, triangles: ArrayLike, *, accelerator: Kind = "bvh", spatial_splits: bool = False) -> None:
        points = _rows_of_three(vertices, "vertices", "fiu")
        indices = _rows_of_three(triangles, "triangles", "iu")
        _check_range(indices, len(points))
        self.n_triangles = len(indices)
        self._rows, used = _finite_triangles(points, indices)
        self._frame = _frame(points if used.all() else points[used])
        self._n_vertices, self._triangles = len(points), indices.astype(np.int32)
        self._accelerator = _built(self._near(points), self._kept_triangles(), self._rows, accelerator, spatial_splits)
        self._in_parts = spatial_splits and accelerator == "bvh"
        self._tree: VolumeTree | Accelerator | None = None
        if isinstance(self._accelerator, (Accelerator, VolumeTree)):
            self._tree = self._accelerator

    def intersect(self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf, threads: int | None = None) -> Hits:
        """Find the first hit of every ray.

        Parameters
        ----------
        origins, directions : (n, 3) array_like, or (3,)
            One origin may serve many directions, and the other way round. Directions may have any length but zero. A ray with a
            number that is not finite misses.
        t_max : float or (n,) array_like
            Hits count where 0 < t < t_max, in units of the direction's length.
        threads : int, optional
            None: all cores. The hits do not depend on it.

        Returns
        -------
        Hits
            Arrays of n; where rays come in a grid, (h, w, 3), of (h, w).
        """
        shape, rays = _rays(origins, directions, t_max)
        if isinstance(self._accelerator, Accelerator):
            t, triangle, u, v = batch.nearest_hits(self._accelerator, self._frame, *rays, thread_count(threads))
        else:
            t, row, u, v, _ = batch_structures.cast(self._accelerator, self._frame, *rays, thread_count(threads))
            triangle = self._triangles_of(row)
        return Hits(t.reshape(shape), triangle.reshape(shape), u.reshape(shape), v.reshape(shape))

    def occluded(
        self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf, threads: int | None = None
    ) -> NDArray[np.bool_]:
        """Tell of every ray, (n,) bool, whether it meets anything within (0, t_max); faster than finding the first hit.

        From a point p towards a light at q: ``origins=p, directions=q - p, t_max=1``, p moved a little off its surface.
        """
        shape, rays = _rays(origins, directions, t_max)
        if isinstance(self._accelerator, Accelerator):
            return batch.any_hits(self._accelerator, self._frame, *rays, thread_count(threads)).reshape(shape)
        found = batch_structures.cast(self._accelerator, self._frame, *rays, thread_count(threads), any_hit=True)
        return np.asarray(found.row >= 0).reshape(shape)

    def all_hits(
        self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf, threads: int | None = None
    ) -> AllHits:
        """Find every triangle that a ray meets, not only the first; arguments as of `intersect`.

        A ray through an edge or a vertex meets all triangles there. Where the accelerator is a grid or a BSP, whose parts share triangles,
        the first call builds a tree of boxes beside it.

        >>> caster = RayCaster([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2], [3, 4, 5]])
        >>> every = caster.all_hits([[0.25, 0.25, 3], [2, 2, 3]], [0, 0, -1])
        >>> every.t.tolist(), every.triangle.tolist(), every.ray.tolist(), every.counts.tolist()
        ([2.0, 3.0], [1, 0], [0, 0], [2, 0])
        """
        _, rays = _rays(origins, directions, t_max)
        if self._tree is None:
            assert not isinstance(self._accelerator, Accelerator)
            self._tree = build_volume_tree(self._accelerator.corners)
        starts, t, row, u, v = batch_structures.every_hit(self._tree, self._frame, *rays, thread_count(threads))
        triangle = row if isinstance(self._tree, Accelerator) else self._triangles_of(row)
        ray = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        if self._in_parts:
            # A ray may have met several parts of a triangle, at one point.
            once = np.sort(np.unique(ray * self.n_triangles + triangle, return_index=True)[1])
            ray, t, triangle, u, v = ray[once], t[once], triangle[once], u[once], v[once]
            starts = np.searchsorted(ray, np.arange(len(starts)))
        return AllHits(ray, t, triangle, u, v, starts)

    def refit(self, vertices: ArrayLike) -> None:
        """Move the vertices: the same triangles in another pose, as of an animation or a simulation; several times as fast as anew.

        The tree keeps its shape and gets new boxes, so rays become slower the less the pose is like the first one; hits are those of a new
        caster, but where triangles are met at the very same t.

        Parameters
        ----------
        vertices : (n, 3) array_like
            As many as there were. Those of triangles that were left out at first may be anything.

        Raises
        ------
        SceneError
            The array has another shape, or a triangle lost a vertex that is finite.
        UnsupportedError
            The accelerator is another than "bvh" or "linear".

        >>> caster = RayCaster([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> caster.refit([[0, 0, 1], [1, 0, 1], [0, 1, 1]])
        >>> caster.intersect([0.25, 0.25, 3], [0, 0, -1]).t.tolist()
        [2.0]
        """
        if not isinstance(self._accelerator, Accelerator):
            raise UnsupportedError('a pose is changed with accelerator="bvh" or "linear"; of the others, make a new one')
        points = _rows_of_three(vertices, "vertices", "fiu").astype(np.float64)
        if len(points) != self._n_vertices:
            raise SceneError(f"vertices must have shape ({self._n_vertices}, 3), as before, got {points.shape}")
        rows = np.arange(self.n_triangles, dtype=np.int32) if self._rows is None else self._rows
        used = points[self._triangles[rows]]
        if not np.isfinite(used).all():
            k = int(np.flatnonzero(~np.isfinite(used).all(axis=(1, 2)))[0])
            raise SceneError(f"vertices must be finite, got {used[k].tolist()} at triangle {rows[k]}")
        self._frame = _frame(used.reshape(-1, 3))
        batch.refit(self._accelerator, rows, self.n_triangles, self._corners(points))

    def visits(
        self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf, threads: int | None = None, *, any_hit: bool = False
    ) -> Visits:
        """Count what is looked at to find the first hit of every ray, or any; other arguments as of `intersect`.

        >>> caster = RayCaster([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> caster.visits([0.25, 0.25, 3], [0, 0, -1]).triangles.tolist()
        [1]
        """
        shape, rays = _rays(origins, directions, t_max)
        if isinstance(self._accelerator, Accelerator):
            counted = batch.visits_of(self._accelerator, self._frame, *rays, thread_count(threads), any_hit=any_hit)
        else:
            counted = batch_structures.cast(
                self._accelerator, self._frame, *rays, thread_count(threads), any_hit=any_hit, counting=True
            ).visits
        return Visits(counted[:, 0].reshape(shape), counted[:, 1].reshape(shape))

    @property
    def nbytes(self) -> int:
        """Bytes that the acceleration structure holds, the triangles' corners among them; not those of what `all_hits` builds."""
        return sum(part.nbytes for part in self._accelerator if isinstance(part, np.ndarray))

    def _near(self, points: NDArray[Any]) -> NDArray[np.float32]:
        """(n, 3) float32: the vertices, moved and scaled."""
        if points.dtype == np.float32 and not self._frame[:3].any() and self._frame[3] == 1.0:
            return np.ascontiguousarray(points)
        with np.errstate(invalid="ignore", over="ignore"):
            return np.ascontiguousarray((points.astype(np.float64) - self._frame[:3]) * self._frame[3], dtype=np.float32)

    def _kept_triangles(self) -> NDArray[np.int32]:
        """(m, 3): the triangles that are made of numbers."""
        return self._triangles if self._rows is None else self._triangles[self._rows]

    def _corners(self, points: NDArray[Any]) -> NDArray[np.float32]:
        """(m, 9) float32: the vertices of the triangles that are kept, moved and scaled."""
        return _corners_of(self._near(points), self._kept_triangles())

    def _triangles_of(self, rows: NDArray[np.int32]) -> NDArray[np.int32]:
        """The given triangles that stand in rows of the corners; -1 stays."""
        if self._rows is None or not len(self._rows):
            return rows
        return np.where(rows >= 0, self._rows[rows], rows)

    def __repr__(self) -> str:
        return f"RayCaster({self.n_triangles} triangles)"


def _corners_of(points: NDArray[np.float32], triangles: NDArray[np.int32]) -> NDArray[np.float32]:
    """(m, 9): the vertices of triangles."""
    return np.take(points, triangles.reshape(-1), axis=0).reshape(-1, 9)


def _built(
    points: NDArray[np.float32], triangles: NDArray[np.int32], numbers: NDArray[np.int32] | None, kind: Kind, spatial_splits: bool
) -> Accelerator | Structure:
    """An acceleration structure over triangles (m, 3) of points (n, 3); `numbers`: as what a tree of eight knows them."""
    if kind not in get_args(Kind):
        raise UnsupportedError(f"accelerator must be one of {', '.join(map(repr, get_args(Kind)))}, got {kind!r}")
    if kind != "bvh" and kind != "linear":
        return batch_structures.build_structure(_corners_of(points, triangles), kind)
    return build_over_triangles(points, triangles, kind, numbers=numbers, spatial_splits=spatial_splits)


_Rays = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]


def _numbers(values: ArrayLike, name: str, kinds: str) -> NDArray[Any]:
    try:
        given = np.asarray(values)
    except ValueError:
        raise SceneError(f"{name} must be an array of numbers, got rows of different lengths") from None
    if given.size and given.dtype.kind not in kinds:
        raise SceneError(f"{name} must be {'integers' if kinds == 'iu' else 'real numbers'}, got {given.dtype}")
    return given


def _rows_of_three(values: ArrayLike, name: str, kinds: str) -> NDArray[Any]:
    given = _numbers(values, name, kinds)
    if given.shape == (0,):
        given = given.reshape(0, 3)
    if given.ndim != 2 or given.shape[1] != 3:
        raise SceneError(f"{name} must have shape (n, 3), got {given.shape}")
    return given if given.size else given.astype(np.int64 if kinds == "iu" else np.float64)


def _check_range(triangles: NDArray[Any], n_vertices: int) -> None:
    if triangles.size and not (triangles.min() >= 0 and triangles.max() < n_vertices):
        row = int(np.flatnonzero(((triangles < 0) | (triangles >= n_vertices)).any(axis=1))[0])
        raise SceneError(f"triangles must lie in 0..{n_vertices - 1}, got {triangles[row].tolist()} at triangle {row}")


def _finite_triangles(points: NDArray[Any], triangles: NDArray[Any]) -> tuple[NDArray[np.int32] | None, NDArray[np.bool_]]:
    """The triangles that are made of numbers, (m,) rows, None if all are, and which vertices, (n,) bool, they are made of."""
    used = np.zeros(len(points), dtype=np.bool_)
    if np.isfinite(points).all():
        used[triangles.reshape(-1)] = True
        return None, used
    finite = np.isfinite(points).all(axis=1)
    kept = np.flatnonzero(finite[triangles].all(axis=1)).astype(np.int32)
    used[triangles[kept]] = True
    return kept if len(kept) < len(triangles) else None, used


def _frame(points: NDArray[Any]) -> NDArray[np.float64]:
    """(8,) float64: by what the mesh is moved, by what it is scaled (a power of two), then its sphere: centre and radius."""
    frame = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    if not len(points):
        return frame
    low, high = points.min(axis=0).astype(np.float64), points.max(axis=0).astype(np.float64)
    # Halves first: the sum of two great numbers may be infinite.
    centre, half = low / 2.0 + high / 2.0, high / 2.0 - low / 2.0
    reach = float(half.max())
    if np.abs(centre).max() > _FAR * reach:
        frame[:3] = centre
    if reach > 0.0 and not _SMALLEST <= reach <= _LARGEST:
        frame[3] = np.ldexp(1.0, int(np.clip(-np.frexp(reach)[1], -1000, 1000)))
    frame[4:7] = (centre - frame[:3]) * frame[3]
    frame[7] = np.linalg.norm(half * frame[3]) * 1.0001
    return frame


def _rays(origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike) -> tuple[tuple[int, ...], _Rays]:
    """The shape of the answer, and origins (n, 3), directions (n, 3) and t_max (n,), repeated where one serves many."""
    parts = {"origins": _numbers(origins, "origins", "fiu"), "directions": _numbers(directions, "directions", "fiu")}
    for name, part in parts.items():
        if part.size == 0 and part.ndim == 1:
            parts[name] = np.zeros((0, 3))
        elif part.ndim == 0 or part.shape[-1] != 3:
            raise SceneError(f"{name} must have shape (n, 3), got {part.shape}")
    ends = _numbers(t_max, "t_max", "fiu")
    given = ", ".join(f"{name} {part.shape}" for name, part in {**parts, "t_max": ends}.items())
    try:
        shape = np.broadcast_shapes((1,), ends.shape, *(part.shape[:-1] for part in parts.values()))
        ends = np.broadcast_to(ends, shape)
    except ValueError:
        raise SceneError(f"origins, directions and t_max must be of the same number, or one; got {given}") from None
    from_where, where_to = (np.broadcast_to(part, (*shape, 3)).reshape(-1, 3) for part in parts.values())
    return shape, (from_where, where_to, ends.reshape(-1))
