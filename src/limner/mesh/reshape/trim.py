"""Parts of surfaces: triangles cut where a question about their points changes its answer.

What is known of a surface's edge is often only a test, "does this point belong to it?". A triangle whose vertices all answer alike is
kept or dropped; where one differs, the edges to it are halved until the place is found, and the triangle is cut there:

        dropped                 .
           /\\                  /  \\
          /  \\      ->        x----x      the two triangles below the cut are kept
         /____\\              /______\\
        kept  kept

What is smaller than a triangle and touches none of its vertices is missed, so triangles are made small first.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh import Mesh

__all__ = ["Surface", "joined", "refined", "surface_of", "trimmed"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_HALVINGS = 20
_MOST_REFINEMENTS = 10
_SLACK = 1e-6  # of a box: what lies on its faces may be rounded out of it


class Surface(NamedTuple):
    """Triangles whose corners carry all they need; corners are shared only where all of it is equal.

    Attributes
    ----------
    corners : (n, 8) float64
        Position, normal, texture coordinates.
    triangles : (m, 3) int64
    """

    corners: Floats
    triangles: Indices

    def mesh(self, slots: NDArray[np.int32] | None = None, name: str = "") -> Mesh:
        """As a mesh, its normals made unit; `slots` (m,): the material of each triangle."""
        used, triangles = np.unique(self.triangles, return_inverse=True)
        corners = self.corners[used]
        lengths = np.linalg.norm(corners[:, 3:6], axis=1, keepdims=True)
        return Mesh(
            positions=corners[:, :3].astype(np.float32),
            triangles=triangles.reshape(-1, 3).astype(np.int32),
            normals=(corners[:, 3:6] / np.where(lengths > 0.0, lengths, 1.0)).astype(np.float32),
            uvs=corners[:, 6:].astype(np.float32),
            triangle_materials=slots,
            name=name,
        )


def surface_of(mesh: Mesh) -> Surface:
    """Take a mesh that has normals and texture coordinates apart into corners."""
    assert mesh.normals is not None
    assert mesh.uvs is not None
    normal_corners = mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles
    uv_corners = mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles
    keys = np.stack([mesh.triangles, normal_corners, uv_corners], axis=-1).reshape(-1, 3)
    distinct, corner_of = np.unique(keys, axis=0, return_inverse=True)
    columns = [mesh.positions[distinct[:, 0]], mesh.normals[distinct[:, 1]], mesh.uvs[distinct[:, 2]]]
    return Surface(np.concatenate(columns, axis=1).astype(np.float64), corner_of.reshape(-1, 3).astype(np.int64))


def joined(surfaces: list[Surface]) -> Surface:
    """All of them, one after the other."""
    starts = np.cumsum([0, *(len(surface.corners) for surface in surfaces)])
    corners = np.concatenate([np.zeros((0, 8)), *(surface.corners for surface in surfaces)])
    triangles = [surface.triangles + start for surface, start in zip(surfaces, starts[:-1], strict=True)]
    return Surface(corners, np.concatenate([np.zeros((0, 3), dtype=np.int64), *triangles]))


def refined(surface: Surface, longest: float, within: Floats) -> Surface:
    """Halve all edges that are longer, until none is, and leave out triangles beyond a box (2, 3).

    An edge is halved for both of its triangles, so that nothing gapes.
    """
    corners, triangles = surface
    low, high = within[0] - _SLACK * (within[1] - within[0]), within[1] + _SLACK * (within[1] - within[0])
    for _ in range(_MOST_REFINEMENTS):
        p = corners[triangles, :3]
        triangles = triangles[((p.max(axis=1) >= low) & (p.min(axis=1) <= high)).all(axis=1)]
        # Edge k leads from corner k to the next
        pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
        edges, edge_of = np.unique(pairs, axis=0, return_inverse=True)
        long = np.linalg.norm(corners[edges[:, 0], :3] - corners[edges[:, 1], :3], axis=1) > longest
        if not long.any():
            break
        middles = np.where(long, len(corners) + np.cumsum(long) - 1, -1)[edge_of.reshape(-1, 3)]
        corners = np.concatenate([corners, (corners[edges[long, 0]] + corners[edges[long, 1]]) / 2.0])
        triangles = _halved(triangles, middles)
    return Surface(corners, triangles)


def _halved(triangles: Indices, middles: Indices) -> Indices:
    """Divide triangles whose edges, from each corner to the next, have middles; -1: none."""
    count = (middles >= 0).sum(axis=1)
    # Turned so that the only edge with a middle comes first, or the only one without comes last
    first = np.where(count == 2, (np.argmin(middles >= 0, axis=1) + 1) % 3, np.argmax(middles >= 0, axis=1))
    turn = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, turn, axis=1).T
    ab, bc, ca = np.take_along_axis(middles, turn, axis=1).T
    parts = [
        (count == 0, [(a, b, c)]),
        (count == 1, [(a, ab, c), (ab, b, c)]),
        (count == 2, [(ab, b, bc), (a, ab, bc), (a, bc, c)]),
        (count == 3, [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]),
    ]
    return np.concatenate([np.stack(corners, axis=1)[which] for which, made in parts for corners in made])


def trimmed(surface: Surface, belongs: Callable[[Floats], NDArray[np.bool_]]) -> Surface:
    """Keep the part of a surface whose points belong.

    Parameters
    ----------
    surface : Surface
    belongs : callable
        Takes corners (n, 8), interpolated along edges, and tells of each whether it is to be kept.
    """
    corners, triangles = surface
    kept = belongs(corners)
    states = kept[triangles]
    count = states.sum(axis=1)
    whole = triangles[count == 3]
    cut = triangles[(count == 1) | (count == 2)]
    # Corners that lie on an edge of the answer may answer otherwise than all between them
    whole = whole[belongs(corners[whole].mean(axis=1))]
    if not len(cut):
        return Surface(corners, whole)
    # Turn each triangle so that the corner that differs comes first
    differs = np.argmax(kept[cut] == (kept[cut].sum(axis=1) == 1)[:, None], axis=1)
    a, b, c = (np.take_along_axis(cut, ((differs + k) % 3)[:, None], axis=1)[:, 0] for k in range(3))
    pairs = np.sort(np.concatenate([np.stack([a, b], axis=1), np.stack([a, c], axis=1)]), axis=1)
    edges, edge_of = np.unique(pairs, axis=0, return_inverse=True)
    inside = np.where(kept[edges[:, :1]], corners[edges[:, 0]], corners[edges[:, 1]])
    outside = np.where(kept[edges[:, :1]], corners[edges[:, 1]], corners[edges[:, 0]])
    for _ in range(_HALVINGS):
        middle = (inside + outside) / 2.0
        still = belongs(middle)[:, None]
        inside, outside = np.where(still, middle, inside), np.where(still, outside, middle)
    on_ab, on_ac = len(corners) + edge_of.reshape(2, -1)
    tip = kept[a]
    tips = np.stack([a, on_ab, on_ac], axis=1)[tip]
    rests = [np.stack([on_ab, b, c], axis=1)[~tip], np.stack([on_ab, c, on_ac], axis=1)[~tip]]
    return Surface(np.concatenate([corners, inside]), np.concatenate([whole, tips, *rests]))
