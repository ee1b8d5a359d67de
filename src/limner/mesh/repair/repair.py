"""Making a mesh sound: one step after the other, each of which says what it did.

    mesh, report = repair(mesh)                     weld, drop what is degenerate, close T-junctions, orient
    mesh, report = repair(mesh, fill_holes=True)    and close every hole
    print(report)

    weld ─► drop triangles without area ─► split edges at T-junctions ─► drop duplicates ─► split where it is no manifold
                                                                                                        │
                                               drop unused vertices ◄─ fill holes ◄─ orient ◄───────────┘

What lives on the mesh is kept: corners keep their normals, tangents and texture coordinates, also where their vertices are welded;
vertices whose colour or named attributes differ are not welded at all. New corners on an edge get what lies between its ends, and the
triangles that fill a hole take after those beside it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..adjacency import following
from ..examine.defects import as_rows_of_bits, degenerate_triangles, duplicate_triangles, linked_within, t_junctions
from ..examine.topology import boundary_chains, components, corner_fans, orientation_flips
from ..mesh import Mesh
from .draft import Draft
from .holes import MAX_LEAST_AREA, triangulate_loop

__all__ = ["RepairReport", "repair"]

Indices = NDArray[np.int32]
Flags = NDArray[np.bool_]

_ROUNDS = 4  # of splitting edges: a split may bring a vertex to light that lies on the new edge
_SAME_SIDE = 0.5  # cosine: a normal that is further off the triangle that fills a hole belongs to another side of a crease


@dataclass(frozen=True)
class RepairReport:
    """What `repair` did.

    Attributes
    ----------
    welded_vertices : int
        Vertices for which another one stands now.
    vertices_kept_apart : int
        Vertices that would have been welded but for their colour or a named attribute.
    dropped_degenerate, dropped_duplicates : int
        Triangles.
    closed_t_junctions : int
        Vertices that became corners of the triangle on whose edge they lay.
    split_vertices : int
        Copies made where the surface was no manifold.
    flipped_triangles : int
        Triangles turned over.
    one_sided_pieces : int
        Pieces that cannot be oriented, left as they are.
    filled_holes, added_triangles : int
        Holes closed, and the triangles that close them.
    holes_left : int
        Holes that were to be filled but are too long, or whose filling would not be a manifold.
    dropped_vertices : int
        Vertices that no triangle uses.
    """

    welded_vertices: int = 0
    vertices_kept_apart: int = 0
    dropped_degenerate: int = 0
    dropped_duplicates: int = 0
    closed_t_junctions: int = 0
    split_vertices: int = 0
    flipped_triangles: int = 0
    one_sided_pieces: int = 0
    filled_holes: int = 0
    added_triangles: int = 0
    holes_left: int = 0
    dropped_vertices: int = 0

    @property
    def has_changed(self) -> bool:
        """Whether anything was done."""
        return any(getattr(self, name) for name, *_ in _WORDS if name not in _LEFT)

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def __str__(self) -> str:
        lines = [f"{getattr(self, name)} {one if getattr(self, name) == 1 else many}" for name, one, many in _WORDS if getattr(self, name)]
        return "\n".join(lines) or "nothing to repair"


_LEFT = ("vertices_kept_apart", "one_sided_pieces", "holes_left")
_WORDS = (
    ("welded_vertices", "vertex welded", "vertices welded"),
    ("vertices_kept_apart", "vertex not welded: its attributes differ", "vertices not welded: their attributes differ"),
    ("dropped_degenerate", "triangle without area dropped", "triangles without area dropped"),
    ("closed_t_junctions", "T-junction closed", "T-junctions closed"),
    ("dropped_duplicates", "duplicate triangle dropped", "duplicate triangles dropped"),
    ("split_vertices", "vertex added to split what was no manifold", "vertices added to split what was no manifold"),
    ("flipped_triangles", "triangle turned over", "triangles turned over"),
    ("one_sided_pieces", "piece cannot be oriented", "pieces cannot be oriented"),
    ("filled_holes", "hole filled", "holes filled"),
    ("added_triangles", "triangle added", "triangles added"),
    ("holes_left", "hole left open", "holes left open"),
    ("dropped_vertices", "unused vertex dropped", "unused vertices dropped"),
)


def repair(
    mesh: Mesh,
    *,
    weld: float | None = 0.0,
    degenerate: bool = True,
    duplicates: bool = True,
    junctions: bool = True,
    split: bool = False,
    orient: bool = True,
    fill_holes: bool | int = False,
    unused: bool = True,
) -> tuple[Mesh, RepairReport]:
    """Make a mesh sound.

    Parameters
    ----------
    mesh : Mesh
    weld : float >= 0, optional
        Let vertices at most this far apart, in metres, become the first of them, also in chains; 0: only those in one place; None: none.
    degenerate : bool
        Drop triangles without area.
    duplicates : bool
        Drop triangles with the vertices of an earlier one.
    junctions : bool
        Split triangles where a vertex lies on their edge.
    split : bool
        Cut the surface apart at edges of more than two triangles and in vertices between several fans.
    orient : bool
        Turn triangles over so that neighbours agree: closed pieces face outwards, open ones as most of their area did. A closed piece
        that agreed with itself and faces inwards stays so inside another one: it bounds a cavity.
    fill_holes : bool or int
        Close holes: all, or those of at most so many edges.
    unused : bool
        Drop vertices that no triangle uses.

    Returns
    -------
    mesh : Mesh
        Normals, tangents, texture coordinates, colours, materials and attributes are kept. Edge attributes of edges that are new are NaN,
        or 0 where they are no floats.
    report : RepairReport

    Raises SceneError where `weld` is negative, no number, or so large that nearly all vertices lie within it.

    Examples
    --------
    >>> print(repair(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]], [[0, 1, 2], [3, 2, 4]]))[1])
    1 vertex welded
    1 triangle turned over
    """
    if weld is not None and not (math.isfinite(weld) and weld >= 0.0):
        raise SceneError(f"weld must be a distance of at least 0, got {weld}")
    if not isinstance(fill_holes, bool) and fill_holes < 0:
        raise SceneError(f"fill_holes must be True, False or a number of edges, got {fill_holes}")
    draft = Draft(mesh)
    done: dict[str, int] = {}
    if weld is not None:
        done["welded_vertices"], done["vertices_kept_apart"] = _weld(draft, weld)
    if degenerate:
        done["dropped_degenerate"] = _drop(draft, degenerate_triangles(draft.bare()))
    if junctions:
        done["closed_t_junctions"] = _close_t_junctions(draft)
    if duplicates:
        done["dropped_duplicates"] = _drop(draft, duplicate_triangles(draft.adjacency()))
    if split:
        done["split_vertices"] = _split(draft)
    if orient:
        done["flipped_triangles"], done["one_sided_pieces"] = _orient(draft)
    if fill_holes is not False:
        longest = None if fill_holes is True else int(fill_holes)
        done["filled_holes"], done["added_triangles"], done["holes_left"] = _fill_holes(draft, longest)
    made, dropped = draft.finished(drop_unused=unused)
    return made, RepairReport(**done, dropped_vertices=dropped)


# --- the steps ------------------------------------------------------------------------------------------------------------


def _weld(draft: Draft, tolerance: float) -> tuple[int, int]:
    points = draft.positions
    kinds = _kinds(draft.given)
    root = linked_within(points, tolerance, kinds)
    draft.merge(root)
    n_roots = int(np.count_nonzero(root == np.arange(len(root))))
    if kinds is None:
        return len(root) - n_roots, 0
    anyway = linked_within(points, tolerance)
    return len(root) - n_roots, n_roots - int(np.count_nonzero(anyway == np.arange(len(anyway))))


def _kinds(mesh: Mesh) -> NDArray[np.int64] | None:
    """A number for each vertex, the same for those with equal colours and attributes; None: there are none."""
    held = [mesh.colors, *(mesh.scalars or {}).values(), *(mesh.vertex_attributes or {}).values()]
    kinds: NDArray[np.int64] | None = None
    for values in held:
        if values is None or not len(values):
            continue
        number = as_rows_of_bits(values)
        kinds = number if kinds is None else as_rows_of_bits(np.stack([kinds, number], axis=1))
    return kinds


def _drop(draft: Draft, triangles: Indices) -> int:
    kept = np.ones(len(draft.triangles), dtype=bool)
    kept[triangles] = False
    if len(triangles):
        draft.keep(kept)
    return len(triangles)


def _close_t_junctions(draft: Draft) -> int:
    n_closed = 0
    for _ in range(_ROUNDS):
        found = t_junctions(draft.bare(), surface=draft.adjacency())
        if not len(found):
            break
        n_closed += len(found)
        _split_edges(draft, found)
    return n_closed


def _split_edges(draft: Draft, junctions: Indices) -> None:
    """Make vertices (k, 2: vertex, half-edge, in their order along it) corners of the triangles of those half-edges."""
    vertex, halfedge = junctions.T.astype(np.int64)
    start, end = draft.corner(halfedge), draft.corner(following(halfedge))
    a, b, p = (draft.positions[v].astype(np.float64) for v in (start[:, 0], end[:, 0], vertex))
    along = b - a
    t = np.clip(((p - a) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    inserted = draft.between(start, end, t, vertex)
    on_side: dict[int, list[NDArray[np.int64]]] = {}
    for side, corner in zip(halfedge.tolist(), inserted, strict=True):
        on_side.setdefault(side, []).append(corner)
    split = np.unique(halfedge // 3)
    corners = draft.corner(np.arange(3 * len(draft.triangles))).reshape(-1, 3, 3)
    pieces: list[NDArray[np.int64]] = []
    owners: list[int] = []
    for triangle in split.tolist():
        ab, bc, ca = (on_side.get(3 * triangle + k, []) for k in range(3))
        a_corner, b_corner, c_corner = corners[triangle]
        made = _pieces((a_corner, b_corner, c_corner), (ab, bc, ca))
        pieces += made
        owners += [triangle] * len(made)
    draft.add(np.array(pieces, dtype=np.int64).reshape(-1, 3, 3), np.array(owners, dtype=np.int32))
    _drop(draft, split.astype(np.int32))


def _pieces(corners: tuple[Any, Any, Any], sides: tuple[list[Any], list[Any], list[Any]]) -> list[NDArray[np.int64]]:
    """Cut a triangle with corners on its sides: from the middle one of a side to the corner opposite, and so on."""
    made: list[NDArray[np.int64]] = []
    open_pieces = [(corners, sides)]
    while open_pieces:
        (a, b, c), (ab, bc, ca) = open_pieces.pop()
        if ab:
            middle = len(ab) // 2
            m = ab[middle]
            open_pieces += [((a, m, c), (ab[:middle], [], ca)), ((m, b, c), (ab[middle + 1 :], bc, []))]
        elif bc or ca:
            open_pieces.append(((b, c, a), (bc, ca, ab)))
        else:
            made.append(np.stack([a, b, c]))
    return made


def _split(draft: Draft) -> int:
    """Give each fan of triangles around a vertex a vertex of its own; the first keeps the given one."""
    found = draft.adjacency()
    fan = corner_fans(found, through_branches=False)
    names = np.flatnonzero(fan == np.arange(len(fan), dtype=np.int32))
    vertex = draft.triangles.reshape(-1)[names]
    order = np.lexsort((names, vertex))
    further = np.zeros(len(names), dtype=bool)
    further[order[1:]] = vertex[order[1:]] == vertex[order[:-1]]
    source = vertex[further]
    own = np.arange(found.n_vertices + len(source), dtype=np.int32)[found.n_vertices :]
    vertex_of_fan = np.zeros(len(fan), dtype=np.int32)
    vertex_of_fan[names] = vertex
    vertex_of_fan[names[further]] = own
    corners = np.where(fan >= 0, vertex_of_fan[fan], draft.triangles.reshape(-1)).astype(np.int32)
    if len(source):
        draft.divide(corners.reshape(-1, 3), source)
    return len(source)


def _orient(draft: Draft) -> tuple[int, int]:
    found = draft.adjacency()
    flips, one_sided = orientation_flips(found)
    piece = components(found, through_branches=False)
    whole = piece >= 0
    n = int(piece.max(initial=-1)) + 1
    if not n:
        return 0, 0
    triangles = np.where(flips[:, None], draft.triangles[:, (0, 2, 1)], draft.triangles)
    middle = draft.bare().bounds.mean(axis=0)
    a, b, c = (draft.positions[triangles[:, k]].astype(np.float64) - middle for k in range(3))
    cross = np.cross(b - a, c - a)
    area = np.sqrt((cross * cross).sum(axis=1))
    sums = ((a * cross).sum(axis=1), area, area * flips)
    signed, size, share = (np.asarray(np.bincount(piece[whole], value[whole], n), dtype=np.float64) for value in sums)
    is_open = np.zeros(n, dtype=bool)
    is_open[piece[found.edge_triangles[found.edge_counts != 2, 0]]] = True
    over = np.where(is_open, share > 0.5 * size, signed < 0.0)
    for cavity in _cavities(draft, piece, over & ~is_open & (share == 0.0), ~is_open):
        over[cavity] = False
    over[piece[one_sided]] = False
    flips = flips ^ (over[piece] & whole)
    if flips.any():
        draft.flip(flips)
    return int(np.count_nonzero(flips)), len(one_sided)


def _cavities(draft: Draft, piece: Indices, inward: Flags, closed: Flags) -> list[int]:
    """Which of the closed pieces that face inwards lie inside an odd number of other closed pieces."""
    candidates = np.flatnonzero(inward)
    if not len(candidates) or np.count_nonzero(closed) < 2:
        return []
    low, high = np.full((2, len(closed), 3), np.inf) * np.array([1.0, -1.0])[:, None, None]
    order = np.argsort(piece, kind="stable")
    numbers, start = np.unique(piece[order], return_index=True)
    run = dict(zip(numbers.tolist(), zip(start.tolist(), [*start[1:].tolist(), len(order)], strict=True), strict=True))
    points = draft.positions[draft.triangles[order]].astype(np.float64)
    low[numbers] = np.minimum.reduceat(points.min(axis=1), start)
    high[numbers] = np.maximum.reduceat(points.max(axis=1), start)
    inside = []
    for candidate in candidates.tolist():
        around = closed & (low <= low[candidate]).all(axis=1) & (high >= high[candidate]).all(axis=1)
        around[candidate] = False
        first = points[run[candidate][0], 0]
        turns = [_winding(points[slice(*run[other])], first) for other in np.flatnonzero(around).tolist()]
        if sum(round(turn) % 2 for turn in turns) % 2:
            inside.append(candidate)
    return inside


def _winding(corners: NDArray[np.float64], point: NDArray[np.float64]) -> float:
    """How often a closed surface goes round a point.

    **Source**: A. Van Oosterom and J. Strackee, "The solid angle of a plane triangle", *IEEE Transactions on Biomedical Engineering* 30(2),
    1983, eq. 8.
    """
    a, b, c = (corners[:, k] - point for k in range(3))
    la, lb, lc = (np.sqrt((v * v).sum(axis=1)) for v in (a, b, c))
    numerator = (a * np.cross(b, c)).sum(axis=1)
    denominator = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return float(2.0 * np.arctan2(numerator, denominator).sum() / (4.0 * np.pi))


def _fill_holes(draft: Draft, longest: int | None) -> tuple[int, int, int]:
    patches: list[NDArray[np.int64]] = []
    beside: list[Indices] = []
    n_left = 0
    found = draft.adjacency()
    n = found.n_vertices
    on_rim = np.zeros(n, dtype=bool)
    on_rim[found.edges[found.edge_counts == 1].reshape(-1)] = True
    joined = found.edges[on_rim[found.edges].all(axis=1)].astype(np.int64)
    edges = set((joined[:, 0] * n + joined[:, 1]).tolist())
    start = draft.triangles.reshape(-1)
    for loop, halfedges in boundary_chains(found):
        runs_along = bool((start[halfedges] == loop).all())
        for hole in _simple_loops(loop, halfedges):
            # A new triangle runs through the rim against the triangle that is there.
            rim = hole[::-1]
            cut = _patch(draft, rim, edges, n) if runs_along and (longest is None or len(rim) <= longest) else None
            if cut is None:
                n_left += 1
                continue
            patches.append(draft.corner(rim)[cut])
            beside.append(rim[cut[:, 0]] // 3)
    if not patches:
        return 0, 0, n_left
    corners = np.concatenate(patches)
    _shade(draft, corners)
    draft.add(corners, np.concatenate(beside))
    return len(patches), len(corners), n_left


def _simple_loops(loop: Indices, halfedges: Indices) -> list[Indices]:
    """Part a rim where it comes back to a vertex: what lies between are two holes that meet there."""
    parts, path = [], list[int]()
    place: dict[int, int] = {}
    for number, vertex in enumerate(loop.tolist()):
        if vertex in place:
            cycle = path[place[vertex] :]
            del path[place[vertex] :]
            for gone in cycle:
                del place[int(loop[gone])]
            parts.append(halfedges[cycle])
        place[vertex] = len(path)
        path.append(number)
    return [*parts, halfedges[path]]


def _patch(draft: Draft, rim: Indices, edges: set[int], n: int) -> NDArray[np.int64] | None:
    """Cut the polygon of a hole, whose corners are where half-edges begin, and note its diagonals; None where that makes no manifold."""
    vertices = draft.triangles.reshape(-1)[rim].astype(np.int64)
    k = len(vertices)
    # The three sides of one triangle: the filling would be its back.
    if k == 3 and len(set((rim // 3).tolist())) == 1:
        return None
    taken = None
    if k <= MAX_LEAST_AREA:
        keys = np.minimum.outer(vertices, vertices) * n + np.maximum.outer(vertices, vertices)
        taken = np.array([key in edges for key in keys.reshape(-1).tolist()]).reshape(k, k)
    cut = triangulate_loop(draft.positions[vertices].astype(np.float64), taken)
    diagonals = np.sort(vertices[_diagonals(cut, k)], axis=1)
    joined = set((diagonals[:, 0] * n + diagonals[:, 1]).tolist())
    if not joined.isdisjoint(edges):
        return None
    edges |= joined
    return cut


def _diagonals(cut: NDArray[np.int64], k: int) -> NDArray[np.int64]:
    sides = np.sort(cut[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    on_rim = (sides[:, 1] - sides[:, 0] == 1) | ((sides[:, 0] == 0) & (sides[:, 1] == k - 1))
    return sides[~on_rim]


def _shade(draft: Draft, corners: NDArray[np.int64]) -> None:
    """Give corners (k, 3, 3) of new triangles normals of their own where those of the rim belong to other sides."""
    if draft.normals is None:
        return
    front = draft.front(corners[:, :, 0]).astype(np.float32) + np.float32(0.0)
    rows = corners[:, :, 1]
    other = (draft.normals[rows] * front[:, None]).sum(axis=2) < _SAME_SIDE
    triangle, _ = np.nonzero(other)
    if draft.tangents is None:
        own, place = np.unique(triangle, return_inverse=True)
        corners[other, 1] = draft.add_normals(front[own], None)[place]
    else:
        corners[other, 1] = draft.add_normals(front[triangle], draft.tangents[rows[other]])
