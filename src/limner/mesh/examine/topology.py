"""What kind of surface a mesh is, asked of its triangles alone (FoCG 12.1.1).

A mesh is a *manifold* where it looks like a piece of the plane around every point: every edge has two triangles, and the triangles
around every vertex form one loop. With *boundary*, an edge may have one triangle, and the triangles of a vertex one fan.

    two triangles at an edge,        three: a fin,              two fans that meet
    one loop at a vertex             no manifold                in a vertex: a bow-tie

          .---.                         .---.                       .---.   .---.
         / \\ / \\                       / \\  |\\                      |    \\ /    |
        .---o---.                     .---o-|-.                     |     o     |
         \\ / \\ /                          \\ | /                     |    / \\    |
          '---'                            \\|/                      '---'   '---'

Positions are not looked at. Every function takes a mesh, or its `Adjacency` where several are asked.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..adjacency import Adjacency, adjacency, following
from ..components import component_labels
from ..mesh import Mesh

__all__ = [
    "Surface", "adjacent", "boundary_chains", "boundary_loops", "bow_tie_vertices", "components", "corner_fans", "cross_caps", "deficit",
    "euler_characteristic", "genus", "inconsistent_edges", "is_closed", "is_consistently_oriented", "is_manifold",
    "is_manifold_with_boundary", "is_orientable", "non_manifold_edges", "orientation_flips",
]  # fmt: skip

Surface: TypeAlias = Mesh | Adjacency
Indices = NDArray[np.int32]
Flags = NDArray[np.bool_]


def adjacent(surface: Surface) -> Adjacency:
    """The adjacency of a mesh, or what is one already."""
    return surface if isinstance(surface, Adjacency) else adjacency(surface)


# --- verdicts -------------------------------------------------------------------------------------------------------------


def is_manifold(surface: Surface) -> bool:
    """Tell whether every edge has two triangles, and every vertex one complete loop of them; true of no triangles at all.

    **Source**: FoCG 12.1.1, with "every *vertex* has a single, complete loop of triangles around it".
    """
    found = adjacent(surface)
    return is_closed(found) and not len(bow_tie_vertices(found))


def is_manifold_with_boundary(surface: Surface) -> bool:
    """Tell whether every edge has one or two triangles, and every vertex one loop or one fan of triangles joined by edges.

    **Source**: FoCG 12.1.1.
    """
    found = adjacent(surface)
    return not len(non_manifold_edges(found)) and not len(bow_tie_vertices(found))


def is_closed(surface: Surface) -> bool:
    """Tell whether every edge has exactly two triangles: such a surface holds water, whether or not it is a manifold."""
    return bool((adjacent(surface).edge_counts == 2).all())


def is_consistently_oriented(surface: Surface) -> bool:
    """Tell whether the two triangles of each edge run through it in opposite directions, so that their fronts are on one side.

    **Source**: FoCG 12.1.1.
    """
    return not len(inconsistent_edges(surface))


def is_orientable(surface: Surface) -> bool:
    """Tell whether triangles could be turned so that the surface is oriented consistently; a Möbius strip's cannot."""
    return orientation_flips(surface)[1].size == 0


# --- what stands in the way -----------------------------------------------------------------------------------------------


def non_manifold_edges(surface: Surface) -> Indices:
    """The edges, (k,) int32, at which more than two triangles meet."""
    return np.flatnonzero(adjacent(surface).edge_counts > 2).astype(np.int32)


def inconsistent_edges(surface: Surface) -> Indices:
    """The edges, (k,) int32, of two triangles that run through them in the same direction."""
    found = adjacent(surface)
    edges = np.flatnonzero(found.edge_counts == 2)
    first = found.edge_start[edges]
    start = found.triangles.reshape(-1)
    return edges[start[found.edge_halfedges[first]] == start[found.edge_halfedges[first + 1]]].astype(np.int32)


def bow_tie_vertices(surface: Surface) -> Indices:
    """The vertices, (k,) int32, whose triangles do not all hang together through edges at the vertex: they form several fans."""
    found = adjacent(surface)
    fan = corner_fans(found)
    # A fan is named by its least corner: one for each fan of a vertex.
    named = found.triangles.reshape(-1)[fan == np.arange(len(fan), dtype=np.int32)]
    return np.flatnonzero(np.bincount(named, minlength=found.n_vertices) > 1).astype(np.int32)


def corner_fans(surface: Surface, *, through_branches: bool = True) -> Indices:
    """Name the fan of each corner: the triangles around its vertex that hang together through edges at the vertex.

    Parameters
    ----------
    surface : Mesh or Adjacency
    through_branches : bool
        Whether edges of more than two triangles hold them together; False: the surface ends there.

    Returns
    -------
    (3 m,) int32
        The least corner of the fan; -1 where the triangle has collapsed.
    """
    found = adjacent(surface)
    same_edge = np.ones(len(found.edge_halfedges), dtype=bool)
    same_edge[found.edge_start[:-1]] = False
    if not through_branches:
        same_edge &= np.repeat(found.edge_counts == 2, found.edge_counts)
    at = np.flatnonzero(same_edge)
    one, other = found.edge_halfedges[at - 1], found.edge_halfedges[at]
    start = found.triangles.reshape(-1)
    alike = start[one] == start[other]
    ahead_one, ahead_other = following(one), following(other)
    first = np.concatenate([one, ahead_one])
    second = np.concatenate([np.where(alike, other, ahead_other), np.where(alike, ahead_other, other)])
    fan = component_labels(len(start), first, second)
    fan[found.triangle_edges.reshape(-1) < 0] = -1
    return fan


# --- pieces ---------------------------------------------------------------------------------------------------------------


def components(surface: Surface, *, through_branches: bool = True) -> Indices:
    """Number the pieces that hang together through edges.

    Parameters
    ----------
    surface : Mesh or Adjacency
    through_branches : bool
        Whether edges of more than two triangles hold them together.

    Returns
    -------
    (m,) int32
        Piece of each triangle, numbered from 0 in the order of their first triangles; -1: the triangle has collapsed.
    """
    found = adjacent(surface)
    first, second = _beside(found, (found.edge_counts > 1) if through_branches else (found.edge_counts == 2))
    label = component_labels(len(found.triangles), first, second)
    whole = found.triangle_edges[:, 0] >= 0
    number = np.full(len(label), -1, dtype=np.int32)
    number[whole] = np.unique(label[whole], return_inverse=True)[1]
    return number


def _beside(found: Adjacency, chosen: Flags) -> tuple[Indices, Indices]:
    """Pairs of triangles, one after the other at the chosen edges."""
    same_edge = np.repeat(chosen, found.edge_counts)
    same_edge[found.edge_start[:-1]] = False
    at = np.flatnonzero(same_edge)
    return found.edge_halfedges[at - 1] // 3, found.edge_halfedges[at] // 3


def orientation_flips(surface: Surface) -> tuple[Flags, Indices]:
    """Find which triangles to turn over so that neighbours agree.

    The first triangle of each piece stays as it is. Edges of more than two triangles hold nothing together here.

    Returns
    -------
    flips : (m,) bool
        False throughout where a piece cannot be oriented.
    one_sided : (k,) int32
        The least triangle of each piece that cannot be oriented.

    **Source**: the orientation double cover. Every triangle is there twice, once turned; each copy is joined to that copy of its
    neighbour which it agrees with. A piece can be oriented where its two sheets stay apart (A. Hatcher, *Algebraic Topology*, 2002, 3.3).
    """
    found = adjacent(surface)
    m = len(found.triangles)
    first, second = _beside(found, found.edge_counts == 2)
    pairs = found.edge_start[:-1][found.edge_counts == 2]
    start = found.triangles.reshape(-1)
    disagree = start[found.edge_halfedges[pairs]] == start[found.edge_halfedges[pairs + 1]]
    if not disagree.any():
        return np.zeros(m, dtype=bool), np.zeros(0, dtype=np.int32)
    turned = np.where(disagree, m, 0).astype(np.int32)
    sheets = component_labels(2 * m, np.concatenate([first, first + m]), np.concatenate([second + turned, second + (m - turned)]))
    upright, upside_down = sheets[:m], sheets[m:]
    # The sheet with the piece's least triangle upright has the lesser name.
    flips = upside_down < upright
    one_sided = upright == upside_down
    return flips & ~one_sided, np.unique(upright[one_sided]).astype(np.int32)


def boundary_loops(surface: Surface) -> list[Indices]:
    """Follow the edges that have one triangle.

    Where several loops meet in a vertex, a loop goes on along the same fan of triangles.

    Returns
    -------
    list of (k,) int32
        Vertices of each closed loop, in the direction in which the triangle of its first edge runs: a hole's rim is passed with the
        surface on the left, seen from the front. Chains that end where more than two triangles meet are left out.
    """
    return [loop for loop, _ in boundary_chains(surface)]


def boundary_chains(surface: Surface) -> list[tuple[Indices, Indices]]:
    """`boundary_loops`, each with the half-edges it runs along, (k,) int32; those of triangles that are turned run backwards."""
    found = adjacent(surface)
    halfedges = found.boundary_halfedges
    if not len(halfedges):
        return []
    fan = corner_fans(found, through_branches=False)
    start, end = found.ends(halfedges)
    ends = np.stack([fan[halfedges], fan[following(halfedges)]], axis=1)
    partner = _partners(ends)
    loops = []
    seen = [False] * len(halfedges)
    vertices = np.stack([start, end], axis=1).tolist()
    for begin in range(len(halfedges)):
        if seen[begin]:
            continue
        edge, side, chain, loop = begin, 0, [], []
        while edge >= 0 and not seen[edge]:
            seen[edge] = True
            chain.append(edge)
            loop.append(vertices[edge][side])
            # Leave by the other end.
            edge, side = partner[edge][1 - side]
        if edge == begin:
            loops.append((np.array(loop, dtype=np.int32), halfedges[chain]))
    return loops


def _partners(ends: Indices) -> list[list[tuple[int, int]]]:
    """For both ends of each boundary edge, which edge goes on there and which of its ends that is; (-1, 0): none.

    A fan that does not close has two outermost edges; only where both are on the boundary do they belong together.
    """
    flat = ends.reshape(-1)
    order = np.argsort(flat, kind="stable")
    same = np.flatnonzero(flat[order[1:]] == flat[order[:-1]])
    partner = np.full(len(flat), -1, dtype=np.int64)
    partner[order[same]], partner[order[same + 1]] = order[same + 1], order[same]
    edge, side = np.where(partner >= 0, partner // 2, -1), np.where(partner >= 0, partner % 2, 0)
    pairs = list(zip(edge.tolist(), side.tolist(), strict=True))
    return [[pairs[2 * k], pairs[2 * k + 1]] for k in range(len(ends))]


# --- numbers --------------------------------------------------------------------------------------------------------------


def euler_characteristic(surface: Surface) -> int:
    """Count ``V - E + F`` over the vertices that triangles use; collapsed triangles count for nothing.

    >>> from limner.mesh.shapes.primitives import box, torus
    >>> euler_characteristic(box()), euler_characteristic(torus())
    (2, 0)

    **Source**: Euler's polyhedron formula; ``V - E + F = 2 (1 - g) - b`` for g handles and b boundary loops.
    """
    found = adjacent(surface)
    vertices = int(np.count_nonzero(found.vertex_counts))
    return vertices - len(found.edges) + int(np.count_nonzero(found.triangle_edges[:, 0] >= 0))


def genus(surface: Surface) -> int:
    """Count handles: 0 for a sphere or a disk, 1 for a torus; the sum over all pieces.

    Parameters
    ----------
    surface : Mesh or Adjacency
        A manifold, with or without boundary, that can be oriented.

    Raises SceneError where it is none.

    **Source**: ``g = (2 c - b - chi) / 2`` of c pieces with b boundary loops and Euler characteristic chi.
    """
    found = adjacent(surface)
    if not is_manifold_with_boundary(found):
        raise SceneError("genus needs a manifold: this surface has edges of more than two triangles, or vertices between two fans")
    if not is_orientable(found):
        raise SceneError("genus needs a surface that can be oriented: this one has one side only; count its cross-caps")
    return _deficit(found) // 2


def cross_caps(surface: Surface) -> int:
    """Count the cross-caps of a manifold that cannot be oriented, every handle as two: 1 for a Möbius strip, 2 for a Klein bottle.

    **Source**: ``k = 2 c - b - chi``; see `genus`.
    """
    found = adjacent(surface)
    if not is_manifold_with_boundary(found) or is_orientable(found):
        raise SceneError("cross-caps are counted on manifolds that cannot be oriented")
    return _deficit(found)


def _deficit(found: Adjacency) -> int:
    pieces = int(components(found).max(initial=-1)) + 1
    return deficit(pieces, len(boundary_loops(found)), euler_characteristic(found))


def deficit(n_pieces: int, n_loops: int, characteristic: int) -> int:
    """By how much the Euler characteristic is less than that of as many spheres with as many holes: 2 for a handle, 1 for a cross-cap."""
    return 2 * n_pieces - n_loops - characteristic
