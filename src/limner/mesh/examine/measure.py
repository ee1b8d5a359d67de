"""How large a mesh is: lengths, angles, area, volume, centres and moments of inertia.

Solids are summed over signed tetrahedra that join each triangle to one common point: what lies outside is counted once positively and
once negatively, whatever the point. The point is the middle of the bounds, so that little cancels.

All is computed in float64 from the float32 positions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..adjacency import Adjacency, adjacency
from ..mesh import Mesh
from ..normals import inner, triangle_vectors
from .topology import (
    boundary_loops,
    components,
    euler_characteristic,
    genus,
    inconsistent_edges,
    is_closed,
    is_manifold_with_boundary,
    is_orientable,
)

__all__ = [
    "area", "centroid", "corner_angles", "dihedral_angles", "edge_lengths", "inertia", "signed_volume", "solid_centroid", "summary",
    "triangle_areas", "volume",
]  # fmt: skip

Floats = NDArray[np.float64]


def triangle_areas(mesh: Mesh) -> Floats:
    """The area of each triangle, square metres: (m,) float64."""
    return 0.5 * np.sqrt((_double_area_vectors(mesh) ** 2).sum(axis=1))


def area(mesh: Mesh) -> float:
    """The area of all triangles, square metres.

    >>> from limner.mesh.shapes.primitives import box
    >>> area(box((1.0, 2.0, 3.0)))
    22.0
    """
    return float(triangle_areas(mesh).sum())


def centroid(mesh: Mesh) -> Floats:
    """The centre of mass of the surface, as of sheet metal: (3,) float64.

    Raises SceneError where the mesh has no area.
    """
    weight = triangle_areas(mesh)
    total = float(weight.sum())
    if not total > 0.0:
        raise SceneError("the centroid of a surface needs triangles with an area", mesh.name)
    return (weight[:, None] * _corners(mesh).mean(axis=1)).sum(axis=0) / total


def signed_volume(mesh: Mesh) -> float:
    """What the surface encloses, cubic metres; negative where it is turned inside out.

    Of an open surface it is the volume up to the cone from the rim to the middle of the bounds. `volume` refuses those.

    **Source**: C. Zhang and T. Chen, "Efficient feature extraction for 2D/3D objects in mesh representation", *Proc. ICIP* 2001, eq. 1.
    """
    return float(_tetrahedra(mesh)[1].sum())


def volume(mesh: Mesh, surface: Adjacency | None = None) -> float:
    """What a closed surface encloses, cubic metres; negative where it is turned inside out.

    Raises SceneError where the surface is not closed or not oriented consistently.

    >>> from limner.mesh.shapes.primitives import box
    >>> volume(box((1.0, 2.0, 3.0)))
    6.0

    **Source**: the divergence theorem; see `signed_volume`.
    """
    _check_solid(mesh, surface, "volume")
    return signed_volume(mesh)


def solid_centroid(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """The centre of mass of the solid that a closed surface encloses: (3,) float64.

    Raises SceneError where the surface is not closed, not oriented consistently, or encloses nothing.

    **Source**: S. Lien and J. Kajiya, "A symbolic method for calculating the integral properties of arbitrary nonconvex polyhedra", *IEEE
    Computer Graphics and Applications* 4(10), 1984.
    """
    _check_solid(mesh, surface, "the centroid of a solid")
    middle, volumes, corners = _solid(mesh)
    return middle + (volumes[:, None] * corners.sum(axis=1)).sum(axis=0) / (4.0 * volumes.sum())


def inertia(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """The tensor of inertia of the solid that a closed surface encloses, about its centre of mass, at density 1.

    Returns
    -------
    (3, 3) float64
        ``integral of (|r|^2 I - r r^T) dV``, kg m² at 1 kg/m³.

    Raises SceneError as `solid_centroid` does.

    **Source**: Lien and Kajiya (1984); for a tetrahedron with a corner in the origin, ``integral of r r^T dV =
    V/20 (s s^T + sum of p p^T)`` over its corners p with sum s.
    """
    _check_solid(mesh, surface, "inertia")
    _, volumes, corners = _solid(mesh)
    total = corners.sum(axis=1)
    second = np.einsum("m,mi,mj->ij", volumes, total, total) + np.einsum("m,mki,mkj->ij", volumes, corners, corners)
    first = (volumes[:, None] * total).sum(axis=0) / 4.0
    covariance = second / 20.0 - np.outer(first, first) / volumes.sum()
    return np.trace(covariance) * np.eye(3) - covariance


def edge_lengths(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """The length of each edge in metres, in the order of `adjacency`: (e,) float64."""
    found = adjacency(mesh) if surface is None else surface
    ends = mesh.positions[found.edges].astype(np.float64)
    return np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1))


def dihedral_angles(mesh: Mesh, surface: Adjacency | None = None) -> Floats:
    """The angle inside the surface between the two triangles of each edge.

    Returns
    -------
    (e,) float64
        Radians, in the order of `adjacency`: pi where the surface is flat, less at a ridge, more in a valley, as seen from the front. NaN
        where an edge has not two triangles, they face opposite sides, or one has no area.

    Notes
    -----
    atan2 of sine and cosine keeps its digits at flat edges, where the arc cosine loses half of them.
    """
    found = adjacency(mesh) if surface is None else surface
    angle = np.full(len(found.edges), np.nan)
    usable = found.edge_counts == 2
    usable[inconsistent_edges(found)] = False
    halfedges = found.edge_halfedges[found.edge_start[:-1][usable]]
    normals = _double_area_vectors(mesh)
    one, other = normals[halfedges // 3], normals[found.opposite[halfedges] // 3]
    start, end = found.ends(halfedges)
    along = mesh.positions[end].astype(np.float64) - mesh.positions[start]
    length = np.sqrt((along * along).sum(axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.arctan2((np.cross(one, other) * along).sum(axis=1) / length, (one * other).sum(axis=1))
    flat = ~(one.any(axis=1) & other.any(axis=1))
    angle[usable] = np.where(flat, np.nan, np.pi - turn)
    return angle


def corner_angles(mesh: Mesh) -> Floats:
    """The angle of each triangle at each corner, radians: (m, 3) float64; 0 where the triangle has no area.

    Those of a triangle with an area sum to pi.
    """
    e, f, g, normal = triangle_vectors(mesh.positions.astype(np.float64), mesh.triangles)
    double_area = np.sqrt(inner(normal, normal))
    angles = np.stack([np.arctan2(double_area, -inner(ahead, behind)) for ahead, behind in ((e, g), (f, e), (g, f))], axis=1)
    return np.where(double_area[:, None] > 0.0, angles, 0.0)


def summary(mesh: Mesh) -> dict[str, Any]:
    """Counts and measures of a mesh as plain values that JSON can hold; None where a measure has no meaning.

    >>> from limner.mesh.shapes.primitives import box
    >>> facts = summary(box())
    >>> facts["volume"], facts["genus"], facts["longest_edge"]
    (1.0, 0, 1.4142135623730951)
    """
    found = adjacency(mesh)
    lengths = edge_lengths(mesh, found)
    some = len(lengths) > 0
    solid = some and is_closed(found) and not len(inconsistent_edges(found))
    manifold = is_manifold_with_boundary(found)
    total = area(mesh)
    on_it = ("normals", "tangents", "uvs", "uvs1", "colors", "triangle_materials")
    named = ("scalars", "vertex_attributes", "edge_attributes", "face_attributes")
    return {
        "vertices": len(mesh.positions),
        "edges": len(found.edges),
        "triangles": len(mesh.triangles),
        "pieces": int(components(found).max(initial=-1)) + 1,
        "boundary_loops": len(boundary_loops(found)),
        "euler_characteristic": euler_characteristic(found),
        "genus": genus(found) if manifold and is_orientable(found) else None,
        "closed": some and is_closed(found),
        "bounds": mesh.bounds.tolist() if len(mesh.triangles) else None,
        "area": total,
        "volume": signed_volume(mesh) if solid else None,
        "centroid": centroid(mesh).tolist() if total > 0.0 else None,
        "shortest_edge": float(lengths.min()) if some else None,
        "mean_edge": float(lengths.mean()) if some else None,
        "longest_edge": float(lengths.max()) if some else None,
        "carries": [field for field in on_it if getattr(mesh, field) is not None]
        + [f"{field}: {name}" for field in named for name in (getattr(mesh, field) or {})],
    }


def _corners(mesh: Mesh) -> Floats:
    return mesh.positions[mesh.triangles].astype(np.float64)


def _double_area_vectors(mesh: Mesh) -> Floats:
    return np.stack(triangle_vectors(mesh.positions.astype(np.float64), mesh.triangles)[3], axis=1)


def _tetrahedra(mesh: Mesh) -> tuple[Floats, Floats, Floats]:
    """A common point (3,); the signed volumes (m,) of the tetrahedra from it, and their other corners as seen from it, (m, 3, 3)."""
    if not len(mesh.triangles):
        return np.zeros(3), np.zeros(0), np.zeros((0, 3, 3))
    middle = mesh.bounds.mean(axis=0)
    corners = _corners(mesh) - middle
    return middle, (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum(axis=1) / 6.0, corners


def _solid(mesh: Mesh) -> tuple[Floats, Floats, Floats]:
    middle, volumes, corners = _tetrahedra(mesh)
    if abs(float(volumes.sum())) <= 1e-12 * float(np.abs(volumes).sum()):
        raise SceneError("the surface encloses nothing", mesh.name)
    return middle, volumes, corners


def _check_solid(mesh: Mesh, surface: Adjacency | None, what: str) -> None:
    found = adjacency(mesh) if surface is None else surface
    if not is_closed(found):
        open_edges = int(np.count_nonzero(found.edge_counts != 2))
        raise SceneError(f"{what} needs a closed surface: {open_edges} of its edges have not two triangles", mesh.name)
    opposed = inconsistent_edges(found)
    if len(opposed):
        raise SceneError(f"{what} needs a consistently oriented surface: triangles disagree at {len(opposed)} edges", mesh.name)
