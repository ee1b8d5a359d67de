"""Tangent frames as normal maps expect them: MikkTSpace (Mikkelsen 2008; glTF 2.0, 3.7.2.1).

A normal map holds normals in a frame of the surface: along u, across it, and outwards. Whoever bakes the map and whoever shows it must
agree on that frame to the last degree, or every seam is seen; so there is one agreed way to make it from positions, normals and texture
coordinates:

- Each triangle has the direction in which u grows, and a handedness: whether its picture on the texture is seen from the front, or
  mirrored.
- The corners at a vertex, that is, where position, normal and texture coordinates are all the same, belong together as far as triangles
  of one handedness follow each other around it. A mirrored half of a model so gets frames of its own along the seam.
- Each such group has one tangent: the mean of its triangles' directions, each laid into the tangent plane of the vertex, made unit, and
  weighted by the triangle's angle there.

Tangents of one vertex may thus differ from corner to corner; a mesh names them by its normals' indices, which are split where needed.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from .mesh import Mesh
from .weld import welded

__all__ = ["corner_tangents", "with_tangents"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

_TINY = float(np.finfo(np.float32).tiny)  # below it, the published algorithm takes a number for zero
_NEXT = np.array([1, 2, 0])


def with_tangents(mesh: Mesh, uv_set: int = 0) -> Mesh:
    """Give a mesh tangents; those that it had are replaced.

    Parameters
    ----------
    mesh : Mesh
        With normals and texture coordinates, v up.
    uv_set : 0 or 1
        The texture coordinates that the normal map is looked up with.

    Returns
    -------
    Mesh
        The same, but for `tangents`, and `normals` and `normal_triangles`, which are split where corners that share a normal have
        different tangents.

    Raises SceneError for a mesh without normals or texture coordinates.

    Examples
    --------
    >>> square = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], normals=[[0, 0, 1]] * 4,
    ...               uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> with_tangents(square).tangents.tolist()[0]
    [1.0, 0.0, 0.0, 1.0]
    """
    frames = _frames(mesh, uv_set)
    assert mesh.normals is not None
    normal = _normal_triangles(mesh).reshape(-1)
    pairs, row = np.unique(normal * (len(frames.tangents) + 1) + frames.group, return_inverse=True)
    normals, groups = np.divmod(pairs, len(frames.tangents) + 1)
    return dataclasses.replace(
        mesh, normals=mesh.normals[normals], normal_triangles=row.reshape(-1, 3).astype(np.int32), tangents=frames.tangents[groups]
    )


def corner_tangents(mesh: Mesh, uv_set: int = 0) -> NDArray[np.float32]:
    """Compute the tangent of each corner of each triangle.

    Parameters
    ----------
    mesh : Mesh
        With normals and texture coordinates, v up.
    uv_set : 0 or 1

    Returns
    -------
    (m, 3, 4) float32
        A unit vector in the direction in which u grows, and +1 where the bitangent, in which v grows, is normal x tangent, -1 where it
        is its opposite. Corners for which there is no such direction (the texture is a point or a line there) have some unit vector at
        right angles to the normal.

    Notes
    -----
    Corners of a triangle without area take the frame of another triangle at the same vertex. A triangle without area on the texture adds
    nothing, and takes the handedness of the group that meets it first. Groups are not split by an angle: the published default of 180
    degrees splits those only whose members point in exactly opposite directions. Where the texture is mirrored, as v grows downwards in
    glTF, the sign is that of v upwards.

    **Source**: M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited*, University of Copenhagen 2008, section 3.4, and the rules of
    the implementation that he published with it; sums are float64.
    """
    frames = _frames(mesh, uv_set)
    return frames.tangents[frames.group].reshape(-1, 3, 4)


@dataclasses.dataclass(frozen=True)
class _Frames:
    """(k, 4) float32 tangents, and which of them each corner has: (3 m,) int64."""

    tangents: NDArray[np.float32]
    group: Indices


def _normal_triangles(mesh: Mesh) -> Indices:
    return (mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles).astype(np.int64)


def _frames(mesh: Mesh, uv_set: int) -> _Frames:
    if mesh.normals is None or mesh.uvs is None:
        missing = "normals" if mesh.normals is None else "texture coordinates (mesh.uvs)"
        raise SceneError(f"tangents follow from normals and texture coordinates: the mesh has no {missing}", mesh.name)
    if uv_set not in (0, 1) or (uv_set == 1 and mesh.uvs1 is None):
        raise SceneError(f"tangents need set {uv_set!r} of texture coordinates, which the mesh does not have", mesh.name)
    uvs = mesh.uvs if uv_set == 0 else mesh.uvs1
    assert uvs is not None
    uv = (mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles).reshape(-1)
    at = mesh.triangles.reshape(-1)
    normals, coordinates = np.nan_to_num(mesh.normals), np.nan_to_num(uvs)
    # Corners that name the same rows are welded before rows are compared by their numbers: most are.
    key = (at.astype(np.int64) * len(normals) + _normal_triangles(mesh).reshape(-1)) * len(coordinates) + uv
    _, some, named = np.unique(key, return_index=True, return_inverse=True)
    rows = mesh.positions[at[some]], normals[_normal_triangles(mesh).reshape(-1)[some]], coordinates[uv[some]]
    index, first = welded(*rows)
    place, n, t = (part[first].astype(np.float64) for part in rows)
    corners = index[named.reshape(-1)].reshape(-1, 3)
    points, _ = welded(mesh.positions)
    return _grouped(corners, points[mesh.triangles], place, n, t, rows[2][first])


def _grouped(corners: Indices, points: Indices, place: Floats, n: Floats, t: Floats, t32: NDArray[np.float32]) -> _Frames:
    """Tangents of welded vertices `corners` (m, 3), whose positions are the same where `points` are."""
    solid = (points[:, 0] != points[:, 1]) & (points[:, 1] != points[:, 2]) & (points[:, 2] != points[:, 0])
    good = np.flatnonzero(solid)
    tri = corners[good]
    along, preserves, any_side = _directions(tri, place, t, t32)
    links = _links(tri, len(place))
    preserves, settled = _settle(tri, links, preserves, any_side)
    label = _components(links, preserves, settled)
    sums = _angle_weighted(tri, place, n, along, any_side, label)
    used, group_of_corner = np.unique(label, return_inverse=True)
    vertex, sign = tri.reshape(-1)[used], np.where(np.repeat(preserves, 3)[used], 1.0, -1.0)
    tangents = np.concatenate([_or_any(sums[used], n[vertex]), sign[:, None]], axis=1)
    # Corners of triangles without area: any good corner of their vertex, or a group of their own.
    group = np.full(corners.size, -1, dtype=np.int64)
    of_vertex = np.full(len(place), -1, dtype=np.int64)
    of_vertex[tri.reshape(-1)[::-1]] = group_of_corner.reshape(-1)[::-1]
    group.reshape(-1, 3)[good] = group_of_corner.reshape(-1, 3)
    left = group < 0
    group[left] = of_vertex[corners.reshape(-1)[left]]
    lone, own = np.unique(corners.reshape(-1)[group < 0], return_inverse=True)
    group[group < 0] = len(tangents) + own.reshape(-1)
    extra = np.concatenate([_or_any(np.zeros((len(lone), 3)), n[lone]), np.ones((len(lone), 1))], axis=1)
    return _Frames(np.concatenate([tangents, extra]).astype(np.float32), group)


def _directions(tri: Indices, place: Floats, t: Floats, t32: NDArray[np.float32]) -> tuple[Floats, Flags, Flags]:
    """Per triangle: the unit direction in which u grows; whether its picture is not mirrored; whether it has none to speak of."""
    d1, d2 = (place[tri[:, k]] - place[tri[:, 0]] for k in (1, 2))
    (s1, t1), (s2, t2) = ((t[tri[:, k]] - t[tri[:, 0]]).T for k in (1, 2))
    # Whether the picture is mirrored is decided in float32, as all implementations do: nearly flat ones must fall on the same side.
    u, v = t32[:, 0], t32[:, 1]
    a, b, c = tri.T
    area = (u[b] - u[a]) * (v[c] - v[a]) - (v[b] - v[a]) * (u[c] - u[a])
    preserves = area > 0.0
    along = t2[:, None] * d1 - t1[:, None] * d2
    across = s1[:, None] * d2 - s2[:, None] * d1
    long = np.sqrt(_dot(along, along)), np.sqrt(_dot(across, across))
    known = (np.abs(area) > _TINY) & (np.minimum(*long) > _TINY * np.abs(area))
    scale = np.where(preserves, 1.0, -1.0) / np.where(known, long[0], 1.0)
    return along * np.where(known, scale, 0.0)[:, None], preserves, ~known


def _links(tri: Indices, n_vertices: int) -> Indices:
    """(3 m, 2): the corner at the same vertex in the neighbour across the edge that leaves a corner, and across the one that enters.

    -1 where there is none. Where more than two triangles share an edge, they are paired in their order.
    """
    start, end = tri.reshape(-1), tri[:, _NEXT].reshape(-1)
    forward, backward = start * n_vertices + end, end * n_vertices + start
    order = np.argsort(forward, kind="stable")
    in_order = forward[order]
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order)) - np.searchsorted(in_order, in_order, side="left")
    found = np.searchsorted(in_order, backward, side="left") + rank
    inside = np.minimum(found, max(len(order) - 1, 0))
    paired = (found < len(order)) & (in_order[inside] == backward) if len(order) else np.zeros(0, dtype=bool)
    opposite = np.where(paired, order[inside] if len(order) else 0, -1)  # half-edges have the numbers of the corners they leave
    following = 3 * (opposite // 3) + _NEXT[opposite % 3]
    leaving = np.where(opposite >= 0, following, -1)
    previous = opposite.reshape(-1, 3)[:, [2, 0, 1]].reshape(-1)
    return np.stack([leaving, previous], axis=1)


def _settle(tri: Indices, links: Indices, preserves: Flags, any_side: Flags) -> tuple[Flags, Flags]:
    """Give triangles without a picture the handedness of the group that meets them first; also tell which have one now."""
    preserves, settled = preserves.copy(), ~any_side
    pictured = np.flatnonzero(np.repeat(settled, 3))
    while not settled.all():
        open_corners = np.flatnonzero(np.repeat(~settled, 3))
        label = _components(links, preserves, settled)
        # Groups come in the order of their first corner with a picture.
        seed = np.full(len(label), len(label), dtype=np.int64)
        np.minimum.at(seed, label[pictured], pictured)
        near = links[open_corners]
        reached = (near >= 0) & settled[near // 3]
        least = np.where(reached, seed[label[near]], len(label)).min(axis=1)
        best = np.full(len(tri), len(label), dtype=np.int64)
        np.minimum.at(best, open_corners // 3, least)
        met = np.flatnonzero(best < len(label))
        if not len(met):
            break
        preserves[met] = preserves[best[met] // 3]
        settled[met] = True
    return preserves, settled


def _components(links: Indices, preserves: Flags, settled: Flags) -> Indices:
    """The least corner of each corner's group: what links join, of one handedness."""
    n = len(links)
    own = np.arange(n)
    side = np.repeat(preserves, 3)
    alive = np.repeat(settled, 3)
    joined = (links >= 0) & (side[links] == side[:, None]) & alive[links] & alive[:, None]
    near = np.where(joined, links, own[:, None])
    label = own
    while True:
        least = np.minimum(label, np.minimum(label[near[:, 0]], label[near[:, 1]]))
        np.minimum.at(least, label, least.copy())
        least = least[least]
        if np.array_equal(least, label):
            return label
        label = least


def _angle_weighted(tri: Indices, place: Floats, n: Floats, along: Floats, any_side: Flags, label: Indices) -> Floats:
    """(3 m, 3): at the number of each group, the sum of its triangles' directions in the vertex's tangent plane, by their angles."""
    sums = np.zeros((tri.size, 3))
    for k in range(3):
        vertex = tri[:, k]
        normal = n[vertex]
        to_next = _flat(place[tri[:, _NEXT[k]]] - place[vertex], normal)
        to_last = _flat(place[tri[:, k - 1]] - place[vertex], normal)
        angle = np.arccos(np.clip(_dot(to_next, to_last), -1.0, 1.0))
        share = _flat(along, normal) * np.where(any_side, 0.0, angle)[:, None]
        for axis in range(3):
            sums[:, axis] += np.bincount(label[k::3], weights=share[:, axis], minlength=tri.size)
    return sums


def _flat(vectors: Floats, normals: Floats) -> Floats:
    """Laid into the planes of the normals, and made unit; zero stays."""
    laid = vectors - normals * _dot(vectors, normals)[:, None]
    return _unit(laid)


def _unit(vectors: Floats) -> Floats:
    length = np.sqrt(_dot(vectors, vectors))
    known = length > _TINY
    return np.where(known, 1.0, 0.0)[:, None] * vectors / np.where(known, length, 1.0)[:, None]


def _or_any(vectors: Floats, normals: Floats) -> Floats:
    """Made unit; where there is none, some direction at right angles to the normal."""
    aside = np.where((np.abs(normals[:, 0]) < 0.9)[:, None], (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    made = _unit(vectors)
    has_direction = np.asarray(made.any(axis=1))
    return np.where(has_direction[:, None], made, _flat(aside, normals))


def _dot(p: Floats, q: Floats) -> Floats:
    return np.einsum("ij,ij->i", p, q)
