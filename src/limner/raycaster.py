"""Rays against bare triangles: no scene, no picture.

    caster = limner.RayCaster(vertices, triangles)
    hits = caster.intersect(origins, directions)      # hits.t (inf: a miss), hits.triangle (-1: a miss), hits.u, hits.v
    dark = caster.occluded(points, towards_light, t_max=1.0)

The tree and the tests at its leaves are those of the ray tracer: watertight, both sides of every triangle. Work is split over threads
with the interpreter's lock released; what a ray hits does not depend on how.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .accel import batch
from .accel.bvh import Kind, build_over
from .accel.layouts import PRIMITIVE
from .errors import SceneError
from .tiles import thread_count

__all__ = ["Hits", "RayCaster"]

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


class RayCaster:
    """Finds which triangle a ray meets first, and whether it meets any.

    Parameters
    ----------
    vertices : (n, 3) array_like
        Any floats or integers. A mesh far from the origin is moved there in float64 before anything is rounded.
    triangles : (m, 3) array_like of integers
        Rows of `vertices`. Triangles with a vertex that is not finite are left out, their numbers stay; those without area are
        never hit.
    accelerator : "bvh" | "linear"
        How triangles are found: by a tree, or by trying all, which is slow, and the oracle.

    Raises
    ------
    SceneError
        The arrays have no such shape, or an index refers to no vertex.

    Examples
    --------
    >>> caster = RayCaster([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hits = caster.intersect([[0.25, 0.5, 3], [2, 2, 3]], [0, 0, -1])
    >>> hits.t.tolist(), hits.triangle.tolist(), hits.u.tolist(), hits.v.tolist()
    ([3.0, inf], [0, -1], [0.25, 0.0], [0.5, 0.0])
    """

    def __init__(self, vertices: ArrayLike, triangles: ArrayLike, *, accelerator: Kind = "bvh") -> None:
        points = _rows_of_three(vertices, "vertices", "fiu")
        indices = _rows_of_three(triangles, "triangles", "iu")
        _check_range(indices, len(points))
        self.n_triangles = len(indices)
        kept, corners = _finite_corners(points, indices)
        self._frame = _frame(corners)
        near = ((corners - self._frame[:3]) * self._frame[3]).astype(np.float32)
        primitives = np.zeros(len(near), dtype=PRIMITIVE)
        primitives["triangle"], primitives["opaque"] = kept, 1
        self._accelerator = build_over(
            primitives,
            near.reshape(-1, 9),
            np.concatenate([near.min(axis=1), near.max(axis=1)], axis=1),
            np.zeros(0, dtype=PRIMITIVE),
            accelerator,
        )

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
        found = batch.nearest_hits(self._accelerator, self._frame, *rays, thread_count(threads))
        t, triangle, u, v = found
        return Hits(t.reshape(shape), triangle.reshape(shape), u.reshape(shape), v.reshape(shape))

    def occluded(
        self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf, threads: int | None = None
    ) -> NDArray[np.bool_]:
        """Tell of every ray, (n,) bool, whether it meets anything within (0, t_max); faster than finding the first hit.

        From a point p towards a light at q: ``origins=p, directions=q - p, t_max=1``, p moved a little off its surface.
        """
        shape, rays = _rays(origins, directions, t_max)
        return batch.any_hits(self._accelerator, self._frame, *rays, thread_count(threads)).reshape(shape)

    def __repr__(self) -> str:
        return f"RayCaster({self.n_triangles} triangles)"


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


def _finite_corners(points: NDArray[Any], triangles: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The triangles that are made of numbers, (m,) rows, and their vertices (m, 3, 3)."""
    corners = points[triangles].astype(np.float64)
    kept = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
    return kept, corners if len(kept) == len(corners) else corners[kept]


def _frame(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(8,) float64: by what the mesh is moved, by what it is scaled (a power of two), then its sphere: centre and radius."""
    frame = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    if not len(corners):
        return frame
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
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
