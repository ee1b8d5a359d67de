"""A ray engine for trimesh: its methods, on limner's rays.

    import trimesh
    from limner.interop.trimesh import RayMeshIntersector

    mesh = trimesh.load_mesh("model.stl")
    mesh.ray = RayMeshIntersector(mesh)
    mesh.ray.intersects_location(origins, directions)     # all hits; and mesh.contains(points) asks it too

Neither rtree nor Embree is needed, and not even trimesh: whatever has `vertices` and `faces` will do. Rays of any float dtype and memory
layout are taken, one origin may serve many directions, and all cores work.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ..raycaster import RayCaster

__all__ = ["RayMeshIntersector"]

_AT_EDGE = 1e-4  # barycentrics below this may be those of an edge
_AT_ONCE = 1e-5  # of the distance: hits of neighbours that are one crossing
_GRAZING = 1e-5  # sine of the angle between ray and triangle below which their crossing is not computed anew
# No two coordinates alike, no axis near: meshes seldom have edges along these.
_DIRECTIONS = np.array([
    [0.4395064455, 0.6175986299, 0.6522315667], [-0.7103412, 0.3512786, 0.6099321], [0.2113249, -0.8312951, 0.5140632],
    [-0.3381941, -0.5517293, -0.7623517], [0.9013728, 0.1928374, -0.3877461],
])  # fmt: skip


class _Crossings(NamedTuple):
    """Hits: whose, of which triangle, with which weights of its vertices."""

    ray: NDArray[np.int64]
    triangle: NDArray[np.int64]
    t: NDArray[np.float64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]

    def chosen(self, rows: NDArray[Any]) -> _Crossings:
        return _Crossings(*(part[rows] for part in self))


class RayMeshIntersector:
    """Rays against a mesh, with the methods of trimesh's own engines.

    Hits are told ray by ray, along each the nearest first. Where a ray passes through an edge or a vertex of a surface, that is one hit, of
    one of the triangles there. Both sides of a triangle are met. A ray with a number that is not finite, or without a direction, misses.

    Parameters
    ----------
    geometry : trimesh.Trimesh, or anything with vertices and faces
        What is kept of it is made anew when its hash changes, which a trimesh does with its vertices and faces.
    scale_to_box : bool
        Ignored: every mesh is scaled as it needs to be. trimesh's Embree engine has it.
    threads : int, optional
        None: all cores.
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True, *, threads: int | None = None) -> None:
        self.mesh = geometry
        self.threads = threads
        self._made_of: int | None = None
        self._caster: RayCaster | None = None

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> tuple[NDArray[Any], ...]:
        """Find the triangles that rays hit.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) float
        multiple_hits : bool
            All along each ray, or the first only.
        max_hits : int, optional
            Of each ray, so many of the nearest. None: all.
        return_locations : bool

        Returns
        -------
        index_tri : (m,) int64
            Rows of the faces.
        index_ray : (m,) int64
        locations : (m, 3) float64
            Only where asked for.
        """
        origins, directions = _rays(ray_origins, ray_directions)
        found = self._all(origins, directions, max_hits) if multiple_hits else self._first(origins, directions)
        if not return_locations:
            return found.triangle, found.ray
        return found.triangle, found.ray, self._locations(found, origins, directions)

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True, **options: Any
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Find where rays hit: locations (m, 3) float64, index_ray (m,), index_tri (m,); arguments as of `intersects_id`."""
        options["return_locations"] = True
        triangle, ray, locations = self.intersects_id(ray_origins, ray_directions, multiple_hits=multiple_hits, **options)
        return locations, ray, triangle

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.int64]:
        """Find the first triangle that each ray hits, (n,) int64; -1: none."""
        hits = self._ready().intersect(*_rays(ray_origins, ray_directions), threads=self.threads)
        return hits.triangle.astype(np.int64)

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Tell of each ray, (n,) bool, whether it hits anything."""
        return self._ready().occluded(*_rays(ray_origins, ray_directions), threads=self.threads)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Tell of each point, (n,) bool, whether it is inside the mesh, which must be closed; on its surface anything may be answered.

        A ray from inside leaves once more than it enters. Two opposite ones are asked; where they disagree, as they do where the mesh has a
        hole, the majority of more of them decides.
        """
        places = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        inside = np.zeros(len(places), dtype=np.bool_)
        vertices = np.asarray(self.mesh.vertices, dtype=np.float64)
        if not len(vertices):
            return inside
        near = np.flatnonzero(((places >= vertices.min(axis=0)) & (places <= vertices.max(axis=0))).all(axis=1))
        one, other = (self._leaves(places[near], way) for way in (_DIRECTIONS[0], -_DIRECTIONS[0]))
        inside[near] = one
        unsure = near[one != other]
        if len(unsure):
            votes = sum(self._leaves(places[unsure], way).astype(np.int64) for way in _DIRECTIONS)
            inside[unsure] = votes > len(_DIRECTIONS) // 2
        return inside

    def _leaves(self, points: NDArray[np.float64], direction: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(n,) bool: whether a ray from each point crosses the surface an odd number of times."""
        found = self._all(points, np.broadcast_to(direction, points.shape), None)
        return np.asarray(np.bincount(found.ray, minlength=len(points)) % 2 == 1)

    def _ready(self) -> RayCaster:
        """The rays' engine for the mesh as it is now."""
        made_of = hash(self.mesh)
        if self._caster is None or made_of != self._made_of:
            self._caster, self._made_of = RayCaster(self.mesh.vertices, self.mesh.faces), made_of
        return self._caster

    def _first(self, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> _Crossings:
        hits = self._ready().intersect(origins, directions, threads=self.threads)
        rows = np.flatnonzero(hits.hit)
        return _crossings(rows, hits.triangle[rows], hits.t[rows], hits.u[rows], hits.v[rows])

    def _all(self, origins: NDArray[np.float64], directions: NDArray[np.float64], max_hits: int | None) -> _Crossings:
        hits = self._ready().all_hits(origins, directions, threads=self.threads)
        found = _crossings(hits.ray, hits.triangle, hits.t, hits.u, hits.v)
        found = found.chosen(self._is_crossing(found, directions))
        if max_hits is None:
            return found
        counts = np.bincount(found.ray, minlength=len(origins))
        rank = np.arange(len(found.ray)) - (np.cumsum(counts) - counts)[found.ray]
        return found.chosen(rank < max_hits)

    def _is_crossing(self, found: _Crossings, directions: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(m,) bool: which hits stay; of triangles that share the vertex or edge through which a ray goes, the same way, the first."""
        stays = np.ones(len(found.ray), dtype=np.bool_)
        at_edge = np.flatnonzero(np.minimum(np.minimum(found.u, found.v), 1.0 - found.u - found.v) < _AT_EDGE)
        if not len(at_edge):
            return stays
        faces = np.asarray(self.mesh.faces)
        normals = self._normals(found.triangle[at_edge])
        is_leaving = np.einsum("nk,nk->n", normals, directions[found.ray[at_edge]]) > 0.0
        order = np.lexsort((at_edge, is_leaving, found.ray[at_edge]))
        rows, way = at_edge[order], is_leaving[order]
        a, b = rows[:-1], rows[1:]
        same = (found.ray[a] == found.ray[b]) & (way[:-1] == way[1:]) & (found.t[b] - found.t[a] <= _AT_ONCE * found.t[b])
        neighbours = (faces[found.triangle[a]][:, :, None] == faces[found.triangle[b]][:, None, :]).any(axis=(1, 2))
        stays[b[same & neighbours]] = False
        return stays

    def _corners(self, triangle: NDArray[np.int64]) -> NDArray[np.float64]:
        return np.asarray(self.mesh.vertices, dtype=np.float64)[np.asarray(self.mesh.faces)[triangle]]

    def _normals(self, triangle: NDArray[np.int64]) -> NDArray[np.float64]:
        corners = self._corners(triangle)
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    def _locations(self, found: _Crossings, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """(m, 3) float64: where rays cross the planes of their triangles; nearly within such a plane, the point of the triangle."""
        corners, normals = self._corners(found.triangle), self._normals(found.triangle)
        o, d = origins[found.ray], directions[found.ray]
        u, v = found.u[:, None], found.v[:, None]
        points = (1.0 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2]
        across = np.einsum("nk,nk->n", normals, d)
        steep = np.abs(across) > _GRAZING * np.linalg.norm(normals, axis=1) * np.linalg.norm(d, axis=1)
        t = np.einsum("nk,nk->n", normals, corners[:, 0] - o)[steep] / across[steep]
        points[steep] = o[steep] + t[:, None] * d[steep]
        return points

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, threads=self.threads)

    def __deepcopy__(self, memo: Any) -> RayMeshIntersector:
        return self.__copy__()

    def __repr__(self) -> str:
        return f"RayMeshIntersector({len(self.mesh.faces)} triangles)"


def _crossings(
    ray: NDArray[np.int64], triangle: NDArray[np.int32], t: NDArray[np.float32], u: NDArray[np.float32], v: NDArray[np.float32]
) -> _Crossings:
    return _Crossings(ray, triangle.astype(np.int64), t.astype(np.float64), u.astype(np.float64), v.astype(np.float64))


def _rays(origins: ArrayLike, directions: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Origins and directions (n, 3) float64, repeated where one serves many."""
    parts = []
    for name, values in (("ray_origins", origins), ("ray_directions", directions)):
        given = np.asarray(values, dtype=np.float64)
        given = given.reshape(0, 3) if given.shape == (0,) else given
        if given.ndim not in (1, 2) or given.shape[-1] != 3:
            raise SceneError(f"{name} must have shape (n, 3), got {given.shape}")
        parts.append(np.atleast_2d(given))
    a, b = parts
    if len(a) != len(b) and 1 not in (len(a), len(b)):
        raise SceneError(f"ray_origins and ray_directions must be of the same number, or one; got {len(a)} and {len(b)}")
    n = len(b) if len(a) == 1 else len(a)
    return np.broadcast_to(a, (n, 3)), np.broadcast_to(b, (n, 3))
