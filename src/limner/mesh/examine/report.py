"""Everything that topology says of a mesh at once, for people and for programs.

    report = topology_report(mesh)
    print(report)
    report.is_sound                 # nothing that a renderer, a slicer or a subdivision would stumble over
    json.dumps(report.as_dict())
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..adjacency import Adjacency, adjacency
from ..mesh import Mesh
from .defects import degenerate_triangles, duplicate_triangles, duplicate_vertices, t_junctions, unused_vertices
from .topology import (
    boundary_loops,
    bow_tie_vertices,
    components,
    deficit,
    euler_characteristic,
    inconsistent_edges,
    is_closed,
    non_manifold_edges,
    orientation_flips,
)

__all__ = ["TopologyReport", "topology_report"]

Pair = tuple[int, int]

_SHOWN = 8  # of a long list


@dataclass(frozen=True)
class TopologyReport:
    """What kind of surface a mesh is, and where it is none.

    Attributes
    ----------
    name : str
        Of the mesh.
    n_vertices, n_edges, n_triangles, n_components : int
        All vertices and triangles; pieces that hang together through edges.
    euler_characteristic : int
        ``V - E + F`` of what triangles use.
    genus : int or None
        Handles, summed over all pieces; None: the surface is no manifold, or has one side only.
    cross_caps : int or None
        Of a manifold with one side only; None: it is none.
    boundary_loop_lengths : tuple of int
        Edges of each closed loop of edges with one triangle.
    n_boundary_edges : int
        Edges with one triangle.
    is_closed, is_manifold, is_manifold_with_boundary, is_consistently_oriented, is_orientable : bool
        See `limner.mesh.examine.topology`.
    non_manifold_edges : tuple of (int, int)
        Vertices of edges of more than two triangles.
    bow_tie_vertices : tuple of int
        Vertices between fans that share nothing else.
    inconsistent_edges : tuple of (int, int)
        Vertices of edges whose two triangles face opposite sides.
    t_junctions : tuple of (int, (int, int))
        A vertex, and the edge of the boundary on which it lies.
    degenerate_triangles, duplicate_triangles : tuple of int
        Triangles without area; triangles of which there is an earlier one.
    unused_vertices, duplicate_vertices : tuple of int
        Vertices of no triangle; vertices that stand exactly where an earlier one stands, as where texture seams split them.
    """

    name: str
    n_vertices: int
    n_edges: int
    n_triangles: int
    n_components: int
    euler_characteristic: int
    genus: int | None
    cross_caps: int | None
    boundary_loop_lengths: tuple[int, ...]
    n_boundary_edges: int
    is_closed: bool
    is_manifold: bool
    is_manifold_with_boundary: bool
    is_consistently_oriented: bool
    is_orientable: bool
    non_manifold_edges: tuple[Pair, ...]
    bow_tie_vertices: tuple[int, ...]
    inconsistent_edges: tuple[Pair, ...]
    t_junctions: tuple[tuple[int, Pair], ...]
    degenerate_triangles: tuple[int, ...]
    duplicate_triangles: tuple[int, ...]
    unused_vertices: tuple[int, ...]
    duplicate_vertices: tuple[int, ...]

    @property
    def faults(self) -> tuple[str, ...]:
        """One line for each kind of fault, with the first places; a boundary, unused and duplicate vertices are none."""
        return tuple(_told(getattr(self, field), *words) for field, *words in _FAULTS if getattr(self, field))

    @property
    def remarks(self) -> tuple[str, ...]:
        """One line for each thing worth knowing that is no fault."""
        return tuple(_told(getattr(self, field), *words) for field, *words in _REMARKS if getattr(self, field))

    @property
    def is_sound(self) -> bool:
        """Whether it is a manifold, perhaps with boundary, consistently oriented, without degenerate or duplicate triangles or
        T-junctions."""
        return not self.faults

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold: all fields, and ``is_sound``."""
        return {**{field.name: _plain(getattr(self, field.name)) for field in fields(self)}, "is_sound": self.is_sound}

    def __str__(self) -> str:
        counts = (
            _counted(self.n_vertices, "vertex", "vertices"), _counted(self.n_edges, "edge", "edges"),
            _counted(self.n_triangles, "triangle", "triangles"), _counted(self.n_components, "piece", "pieces"),
        )  # fmt: skip
        lines = [
            f"{self.name or 'mesh'}: {'sound' if self.is_sound else 'not sound'}",
            f"  {', '.join(counts)}",
            f"  {self._kind()}, Euler characteristic {self.euler_characteristic}{self._handles()}",
        ]
        if self.n_boundary_edges:
            loops = self.boundary_loop_lengths
            told = f", loops of {_listed(loops)}" if loops else ""
            lines.append(f"  boundary of {_counted(self.n_boundary_edges, 'edge', 'edges')}{told}")
        lines += [f"  fault: {line}" for line in self.faults] + [f"  note: {line}" for line in self.remarks]
        return "\n".join(lines)

    def _kind(self) -> str:
        if not self.n_edges:
            return "no surface"
        closed = "open" if self.n_boundary_edges else "closed"
        manifold = "manifold" if self.is_manifold_with_boundary else "surface, no manifold"
        sided = "consistently oriented" if self.is_consistently_oriented else "orientable" if self.is_orientable else "one-sided"
        return f"{closed} {manifold}, {sided}"

    def _handles(self) -> str:
        if self.genus is not None:
            return f", genus {self.genus}"
        return "" if self.cross_caps is None else f", {_counted(self.cross_caps, 'cross-cap', 'cross-caps')}"


_FAULTS = (
    ("non_manifold_edges", "edge of more than two triangles", "edges of more than two triangles"),
    ("bow_tie_vertices", "bow-tie vertex", "bow-tie vertices"),
    ("inconsistent_edges", "edge between triangles that face opposite sides", "edges between triangles that face opposite sides"),
    ("t_junctions", "T-junction", "T-junctions"),
    ("degenerate_triangles", "triangle without area", "triangles without area"),
    ("duplicate_triangles", "duplicate triangle", "duplicate triangles"),
)
_REMARKS = (
    ("unused_vertices", "vertex of no triangle", "vertices of no triangle"),
    ("duplicate_vertices", "vertex in the place of an earlier one", "vertices in the place of an earlier one"),
)


def topology_report(mesh: Mesh, *, tolerance: float | None = None, surface: Adjacency | None = None) -> TopologyReport:
    """Examine a mesh.

    Parameters
    ----------
    mesh : Mesh
    tolerance : float >= 0, optional
        How near an edge a vertex makes a T-junction, metres; None: a millionth of the mesh's diagonal.
    surface : Adjacency, optional
        Of the mesh, where it is known.

    Examples
    --------
    >>> from limner.mesh.shapes.primitives import torus
    >>> print(topology_report(torus()))
    torus: sound
      2048 vertices, 6144 edges, 4096 triangles, 1 piece
      closed manifold, consistently oriented, Euler characteristic 0, genus 1
    """
    found = adjacency(mesh) if surface is None else surface
    branching, bow_ties = non_manifold_edges(found), bow_tie_vertices(found)
    manifold = not len(branching) and not len(bow_ties)
    opposed = inconsistent_edges(found)
    orientable = orientation_flips(found)[1].size == 0
    junctions = t_junctions(mesh, tolerance, found)
    closed = is_closed(found)
    pieces = int(components(found).max(initial=-1)) + 1
    loops = tuple(len(loop) for loop in boundary_loops(found))
    characteristic = euler_characteristic(found)
    missing = deficit(pieces, len(loops), characteristic) if manifold else 0
    return TopologyReport(
        name=mesh.name,
        n_vertices=len(mesh.positions),
        n_edges=len(found.edges),
        n_triangles=len(mesh.triangles),
        n_components=pieces,
        euler_characteristic=characteristic,
        genus=missing // 2 if manifold and orientable else None,
        cross_caps=missing if manifold and not orientable else None,
        boundary_loop_lengths=loops,
        n_boundary_edges=len(found.boundary_halfedges),
        is_closed=closed,
        is_manifold=manifold and closed,
        is_manifold_with_boundary=manifold,
        is_consistently_oriented=not len(opposed),
        is_orientable=orientable,
        non_manifold_edges=_pairs(found.edges[branching]),
        bow_tie_vertices=tuple(bow_ties.tolist()),
        inconsistent_edges=_pairs(found.edges[opposed]),
        t_junctions=tuple(
            (vertex, edge)
            for vertex, edge in zip(
                junctions[:, 0].tolist(), _pairs(found.edges[found.triangle_edges.reshape(-1)[junctions[:, 1]]]), strict=True
            )
        ),
        degenerate_triangles=tuple(degenerate_triangles(mesh).tolist()),
        duplicate_triangles=tuple(duplicate_triangles(found).tolist()),
        unused_vertices=tuple(unused_vertices(found).tolist()),
        duplicate_vertices=tuple(duplicate_vertices(mesh).tolist()),
    )


def _pairs(rows: NDArray[np.int32]) -> tuple[Pair, ...]:
    return tuple((a, b) for a, b in rows.tolist())


def _plain(value: Any) -> Any:
    return [_plain(part) for part in value] if isinstance(value, tuple) else value


def _counted(n: int, one: str, many: str) -> str:
    return f"{n} {one if n == 1 else many}"


def _told(places: tuple[Any, ...], one: str, many: str) -> str:
    return f"{_counted(len(places), one, many)}: {_listed(places)}"


def _listed(places: tuple[Any, ...]) -> str:
    more = f", and {len(places) - _SHOWN} more" if len(places) > _SHOWN else ""
    return ", ".join(_place(place) for place in places[:_SHOWN]) + more


def _place(place: Any) -> str:
    """A vertex or triangle as its number, an edge as its two vertices, a T-junction as a vertex on an edge."""
    if not isinstance(place, tuple):
        return str(place)
    first, second = place
    return f"{first} on {second[0]}-{second[1]}" if isinstance(second, tuple) else f"{first}-{second}"
