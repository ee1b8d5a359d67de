"""What is wrong with surfaces: inside out, normals against the faces, facets where smooth was meant, one surface on top of another."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linear import transform
from ..mesh.adjacency import adjacency
from ..mesh.examine.measure import dihedral_angles, signed_volume
from ..mesh.examine.topology import is_closed, is_consistently_oriented
from ..mesh.mesh import Mesh
from ..mesh.normals import face_normals
from ..mesh.weld import welded
from ..scene.scene import Scene
from ..tables.exact import materials_of
from .findings import Finding

__all__ = ["examine_meshes", "examine_overlaps"]

Floats = NDArray[np.float64]

_MOST_TRIANGLES = 300_000  # of a mesh that is looked at edge by edge
_AGAINST = 0.5  # the share of corners whose normal points behind their face
_SMOOTH = math.radians(15.0)  # angles between neighbours that tell of a smooth surface, if half of them are less
_LEAST_SMOOTH = math.radians(0.5)
_LEAST_FACETS = 200
_DEGENERATE = 0.2
_PLANE_DIGITS = 1e-4  # of the scene's size: planes that near are one
_MOST_PER_PLANE = 400
_NOTABLE = 0.05  # the share of a shape's triangles that lie on another's
_MOST_OVERLAPS = 4


def examine_meshes(scene: Scene) -> Iterator[Finding]:
    """Look at each mesh once."""
    seen: set[int] = set()
    for placed, shape in scene.shapes():
        mesh = shape.geometry
        if not isinstance(mesh, Mesh) or id(mesh) in seen or not len(mesh.triangles):
            continue
        seen.add(id(mesh))
        is_one_sided = not all(getattr(material, "double_sided", True) for material in materials_of(shape))
        yield from _examine(placed.path, mesh, is_one_sided, shape.displacement is not None)


def _examine(path: str, mesh: Mesh, is_one_sided: bool, is_displaced: bool) -> Iterator[Finding]:
    faces = face_normals(mesh.positions, mesh.triangles)
    with np.errstate(invalid="ignore"):
        degenerate = ~(np.abs(faces).sum(axis=1) > 0.0)
    if degenerate.mean() > _DEGENERATE:
        what = f"{int(degenerate.sum())} of {len(faces)} triangles have no area"
        why, do = "they are not drawn: holes, or nothing at all", "limner mesh repair MODEL -o OUT, or look at what wrote it"
        yield Finding("degenerate", what, path, why, do)
        return
    against = _share_against(mesh, faces)
    if against > _AGAINST:
        what = f"{against:.0%} of its normals point behind their faces"
        why = "it is lit from the wrong side: dark where light falls" + (", and its front is taken for its back" if is_one_sided else "")
        yield Finding("normals-flipped", what, path, why, "limner mesh repair MODEL -o OUT, or Mesh(positions, triangles[:, ::-1])")
    if len(mesh.triangles) > _MOST_TRIANGLES:
        return
    joined = _joined(mesh)
    surface = adjacency(joined)
    if is_closed(surface) and is_consistently_oriented(surface) and signed_volume(joined) < 0.0:
        what = "it is closed, and its faces look inwards"
        why = "glass, solids and printing take it for a cavity"
        if is_one_sided:
            why = "its outside is the back of single-sided surfaces: one looks into it"
        yield Finding("inside-out", what, path, why, "limner mesh repair MODEL -o OUT, or Mesh(positions, triangles[:, ::-1])")
    if not is_displaced and _is_flat_shaded(mesh, faces) and len(mesh.triangles) >= _LEAST_FACETS:
        bend = np.abs(np.pi - dihedral_angles(joined, surface))
        bend = bend[np.isfinite(bend)]
        curved = bend[bend > _LEAST_SMOOTH]
        if len(curved) > 0.5 * len(bend) and float(np.median(curved)) < _SMOOTH:
            what = f"neighbours differ by {math.degrees(float(np.median(curved))):.1f} degrees, and each triangle is shaded flat"
            do = "dataclasses.replace(mesh, normals=limner.mesh.normals.vertex_normals(mesh.positions, mesh.triangles)), after welding"
            yield Finding("faceted", what, path, "a surface that is meant to be smooth shows its triangles", do)


def _share_against(mesh: Mesh, faces: Floats) -> float:
    """The share of corners whose normal points away from the side that their face shows."""
    if mesh.normals is None:
        return 0.0
    corners = mesh.normal_triangles if getattr(mesh, "normal_triangles", None) is not None else mesh.triangles
    given = mesh.normals[corners].astype(np.float64)
    along = np.einsum("tkc,tc->tk", given, faces)
    told = np.isfinite(along) & (np.abs(along) > 1e-3)
    return float((along[told] < 0.0).mean()) if told.any() else 0.0


def _is_flat_shaded(mesh: Mesh, faces: Floats) -> bool:
    """Whether normals are missing, or are those of the faces."""
    if mesh.normals is None:
        return True
    corners = mesh.normal_triangles if getattr(mesh, "normal_triangles", None) is not None else mesh.triangles
    given = mesh.normals[corners].astype(np.float64)
    along = np.einsum("tkc,tc->tk", given, faces)
    told = along[np.isfinite(along)]
    return len(told) > 0 and float((told > 1.0 - 1e-5).mean()) > 0.99


def _joined(mesh: Mesh) -> Mesh:
    """The mesh with its vertices welded: seams of texture coordinates and of normals split them."""
    index, first = welded(np.asarray(mesh.positions, dtype=np.float32))
    return Mesh(mesh.positions[first], index[mesh.triangles].astype(np.int32))


# --- one surface on top of another ------------------------------------------------------------------------------------------


class _Face(NamedTuple):
    shape: int
    corners: Floats
    normal: Floats


def examine_overlaps(scene: Scene) -> Iterator[Finding]:
    """Opaque surfaces of two shapes in one plane, which fight for the same depth."""
    shapes = scene.shapes()
    meshes = [(k, placed, shape) for k, (placed, shape) in enumerate(shapes) if isinstance(shape.geometry, Mesh)]
    sizes = {k: len(shape.geometry.triangles) for k, _, shape in meshes if isinstance(shape.geometry, Mesh)}
    if len(meshes) < 2 or sum(sizes.values()) > _MOST_TRIANGLES:
        return
    scale = float(np.nanmax(np.abs(np.where(np.isfinite(scene.bounds()), scene.bounds(), 0.0)), initial=0.0)) or 1.0
    planes: dict[tuple[int, ...], list[_Face]] = defaultdict(list)
    for k, placed, shape in meshes:
        if any(material.alpha_mode == "blend" for material in shape.materials) or not isinstance(shape.geometry, Mesh):
            continue
        _list_planes(planes, k, placed.world_from_object, shape.geometry, scale)
    found: dict[tuple[int, int], int] = {}
    for faces in planes.values():
        if len({face.shape for face in faces}) > 1:
            for pair in _fighting(faces[:_MOST_PER_PLANE], scale):
                found[pair] = found.get(pair, 0) + 1
    notable = [(pair, count) for pair, count in found.items() if count >= _NOTABLE * min(sizes[k] for k in pair)]
    for (one, other), count in notable[:_MOST_OVERLAPS]:
        a, b = shapes[one][0].path, shapes[other][0].path
        what = f"{count} triangles of {a!r} and {b!r} lie in one plane, one on top of the other"
        why = "which is in front is decided by rounding: stripes and dots that change from pixel to pixel (z-fighting)"
        yield Finding("z-fighting", what, b, why, "remove one of them, or move it by a thousandth of its size along its normal")


def _list_planes(planes: dict[tuple[int, ...], list[_Face]], k: int, world: Floats, mesh: Mesh, scale: float) -> None:
    corners = transform.transform_points(world, np.asarray(mesh.positions, dtype=np.float64))[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    usable = np.flatnonzero(length > 1e-12 * scale * scale)
    normals = normals[usable] / length[usable, None]
    # Both sides of a plane are one plane.
    first = np.argmax(np.abs(normals) > 0.5, axis=1)
    normals *= np.sign(normals[np.arange(len(normals)), first])[:, None]
    offsets = (normals * corners[usable, 0]).sum(axis=1) / scale
    keys = np.column_stack([np.rint(normals / 1e-3), np.rint(offsets / _PLANE_DIGITS)]).astype(np.int64)
    for row, key, normal in zip(usable, keys.tolist(), normals, strict=True):
        planes[tuple(key)].append(_Face(k, corners[row], normal))


def _fighting(faces: list[_Face], scale: float) -> Iterator[tuple[int, int]]:
    """Pairs of shapes of which a triangle of one has its middle in a triangle of the other."""
    for a in faces:
        for b in faces:
            if a.shape != b.shape and abs(float(a.normal @ (a.corners[0] - b.corners[0]))) < 1e-6 * scale:
                middle = a.corners.mean(axis=0)
                if _holds(b.corners, b.normal, middle):
                    yield min(a.shape, b.shape), max(a.shape, b.shape)


def _holds(corners: Floats, normal: Floats, point: Floats) -> bool:
    sides = [float(normal @ np.cross(corners[(k + 1) % 3] - corners[k], point - corners[k])) for k in range(3)]
    return all(side > 0.0 for side in sides) or all(side < 0.0 for side in sides)
