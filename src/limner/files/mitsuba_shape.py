"""Shapes of Mitsuba scenes: exact ones, and meshes from files.

    sphere, disk, cylinder      limner's own, turned so that Mitsuba's poles and fronts (+z) lie on limner's (+y)
    rectangle, cube             meshes with Mitsuba's texture coordinates: [-1, 1] along each side
    obj, ply, serialized        read by the readers of those formats; the surface is the scene's, whatever the file says of it

Mitsuba's texture coordinates have v downwards in pictures; they are turned here, once: v is 1 - v, and cylinders stand on their heads. OBJ
files it turns itself, so that they stay as they are.

**Source**: the Mitsuba 3 documentation, *Shapes*.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError
from ..linear import transform
from ..mesh.mesh import Mesh
from ..mesh.normals import crease_normals
from ..scene.scene import Scene
from ..scene.shape import Cylinder, Disk, Geometry, Sphere
from .mitsuba_properties import Properties
from .mitsuba_serialized import read_serialized
from .notes import Notes, quoted, without_path
from .sources import Sources

__all__ = ["Geometries", "Placed"]

Matrix = NDArray[np.float64]
Placed = list[tuple[Matrix, Geometry]]

# From limner's y up to Mitsuba's z up, with u running round from where Mitsuba's does.
_TURNED = np.array([[-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_MATERIALS = re.compile(rb"^[ \t]*(?:mtllib|usemtl)\b[^\n]*", re.MULTILINE)
_HAS_NORMALS = re.compile(rb"^[ \t]*vn[ \t]", re.MULTILINE)
_CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class Geometries:
    """The geometries of one scene; files that several shapes name are read once.

    Parameters
    ----------
    sources : Sources
    notes : Notes
    """

    def __init__(self, sources: Sources, notes: Notes) -> None:
        self._sources = sources
        self._notes = notes
        self._files: dict[tuple[object, ...], Placed] = {}
        self._kinds: dict[str, Callable[[Properties], Placed]] = {
            "sphere": self._sphere, "disk": self._disk, "cylinder": self._cylinder, "rectangle": self._rectangle, "cube": self._cube,
            "obj": self._file, "ply": self._file, "serialized": self._file,
        }  # fmt: skip

    def placed(self, properties: Properties) -> Placed | None:
        """The geometries of a shape, each with its place in the world; None: shapes of this kind are not read."""
        make = self._kinds.get(properties.element.kind)
        return None if make is None else make(properties)

    # Exact shapes

    def _sphere(self, properties: Properties) -> Placed:
        radius = properties.number("radius", 1.0)
        if radius <= 0.0:
            raise properties.error(f"radius must be positive, got {radius:g}", properties.child("radius"))
        centre = transform.translate(*properties.point("center"))
        if properties.flag("flip_normals", False):
            self._note_flip(properties)
        return [(properties.transform("to_world") @ centre @ _TURNED, Sphere(radius))]

    def _disk(self, properties: Properties) -> Placed:
        turned = _TURNED @ transform.scale(1.0, -1.0, 1.0) if properties.flag("flip_normals", False) else _TURNED
        return [(properties.transform("to_world") @ turned, Disk(1.0))]

    def _cylinder(self, properties: Properties) -> Placed:
        first, last = np.array(properties.point("p0")), np.array(properties.point("p1", (0.0, 0.0, 1.0)))
        radius, axis = properties.number("radius", 1.0), last - first
        length = float(np.linalg.norm(axis))
        if radius <= 0.0 or not length > 0.0:
            raise properties.error(f"a cylinder needs a radius above 0 and ends that differ, got radius {radius:g}, length {length:g}")
        if properties.flag("flip_normals", False):
            self._note_flip(properties)
        place = np.eye(4)
        place[:3, :3] = _frame(axis / length)
        place[:3, 3] = (first + last) / 2.0
        # Mirrored, so that v runs from the end to the beginning, as it does in pictures.
        turned = _TURNED @ transform.scale(1.0, -1.0, 1.0)
        return [(properties.transform("to_world") @ place @ turned, Cylinder(radius, length, capped=False))]

    def _note_flip(self, properties: Properties) -> None:
        text = "flip_normals is ignored: exact shapes are not turned inside out"
        self._notes.add(text, properties.where, kind="ignored", what=properties.what)

    # Meshes

    def _rectangle(self, properties: Properties) -> Placed:
        positions = np.concatenate([_CORNERS, np.zeros((4, 1))], axis=1)
        uvs = (_CORNERS + 1.0) / 2.0 * (1.0, -1.0) + (0.0, 1.0)
        mesh = Mesh(positions.astype(np.float32), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), uvs=uvs.astype(np.float32))
        return [(properties.transform("to_world"), _turned(mesh) if properties.flag("flip_normals", False) else mesh)]

    def _cube(self, properties: Properties) -> Placed:
        mesh = _cube_mesh()
        return [(properties.transform("to_world"), _turned(mesh) if properties.flag("flip_normals", False) else mesh)]

    def _file(self, properties: Properties) -> Placed:
        kind = properties.element.kind
        name = properties.text("filename")
        if not name:
            raise properties.error(f"shape {kind} needs a filename")
        index = properties.integer("shape_index", 0)
        flips_uvs = properties.flag("flip_tex_coords", kind == "obj")
        faceted, inside_out = properties.flag("face_normals", False), properties.flag("flip_normals", False)
        properties.skip("max_smooth_angle", "collapse")
        key = (name, kind, index, flips_uvs, faceted, inside_out)
        if key not in self._files:
            found, has_normals = self._read(properties, name, kind, index)
            self._files[key] = [
                (place, _dressed(mesh, flips_uvs, faceted, has_normals, inside_out) if isinstance(mesh, Mesh) else mesh)
                for place, mesh in found
            ]
        world = properties.transform("to_world")
        return [(world @ place, geometry) for place, geometry in self._files[key]]

    def _read(self, properties: Properties, name: str, kind: str, index: int) -> tuple[Placed, bool]:
        data = self._sources.read_beside(name, properties.where)
        own, said = Sources(self._sources.locate(name, properties.where), self._sources.limits), Notes()
        try:
            if kind == "serialized":
                mesh = read_serialized(data, index, self._sources.limits)
                return [(np.eye(4), mesh)], mesh.normals is not None
            if kind == "obj":
                from .obj import read as read_obj

                scene = read_obj(_MATERIALS.sub(b"", data), own.path, limits=own.limits, notes=said, sources=own)
                has_normals = bool(_HAS_NORMALS.search(data))
            else:
                from .ply import read as read_ply

                scene = read_ply(data, own.path, limits=own.limits, notes=said, sources=own)
                has_normals = b"property" in data[:4096] and bool(re.search(rb"property\s+\w+\s+nx\b", data[:8192]))
        except (LimnerError, ValueError) as error:
            raise FileFormatError(f"{quoted(name)} cannot be read: {without_path(error)}", self._sources.path, properties.where) from None
        self._notes.absorb(said, name)
        return _geometries(scene), has_normals


def _frame(n: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3): two axes at right angles to a unit vector, and it: where u of a cylinder begins.

    **Source**: Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017, listing 3.
    """
    x, y, z = n.tolist()
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return np.array([(1.0 + sign * x * x * a, sign * b, -sign * x), (b, sign + y * y * a, -y), (x, y, z)]).T


def _geometries(scene: Scene) -> Placed:
    return [(placed.world_from_object, shape.geometry) for placed, shape in scene.shapes()]


def _dressed(mesh: Mesh, flips_uvs: bool, faceted: bool, has_normals: bool, inside_out: bool) -> Mesh:
    """A mesh from a file as the scene asks for it."""
    mesh = _without_slots(mesh) if flips_uvs else _uvs_turned(_without_slots(mesh))
    mesh = _shaded(mesh, faceted=faceted, has_normals=has_normals)
    return _turned(mesh) if inside_out else mesh


def _without_slots(mesh: Mesh) -> Mesh:
    return mesh if mesh.triangle_materials is None else dataclasses.replace(mesh, triangle_materials=None)


def _uvs_turned(mesh: Mesh) -> Mesh:
    if mesh.uvs is None:
        return mesh
    return dataclasses.replace(mesh, uvs=(np.array((0.0, 1.0)) + mesh.uvs * (1.0, -1.0)).astype(np.float32))


def _shaded(mesh: Mesh, *, faceted: bool, has_normals: bool) -> Mesh:
    """Facets where the scene asks for them; the file's normals; or smooth ones throughout, as Mitsuba makes them."""
    if faceted:
        return dataclasses.replace(mesh, normals=None, normal_triangles=None, tangents=None)
    if has_normals or not len(mesh.triangles):
        return mesh
    normals, corners = crease_normals(mesh.positions, mesh.triangles, 180.0)
    return dataclasses.replace(mesh, normals=normals, normal_triangles=corners, tangents=None)


def _turned(mesh: Mesh) -> Mesh:
    """Inside out: the corners of every triangle the other way round, the normals the other way."""
    return dataclasses.replace(
        mesh,
        triangles=mesh.triangles[:, ::-1],
        normals=None if mesh.normals is None else -mesh.normals,
        normal_triangles=None if mesh.normal_triangles is None else mesh.normal_triangles[:, ::-1],
        uv_triangles=None if mesh.uv_triangles is None else mesh.uv_triangles[:, ::-1],
        tangents=None,
    )  # fmt: skip


def _cube_mesh() -> Mesh:
    """Six faces of [-1, 1]^3, each with the whole picture, upright as Mitsuba lays it."""
    positions, uvs = [], []
    for normal, along_u, along_v in _FACES:
        n, u, v = (np.array(axis, dtype=np.float64) for axis in (normal, along_u, along_v))
        for a, b in _CORNERS:
            positions.append(n + a * u + b * v)
            uvs.append(((a + 1.0) / 2.0, (1.0 - b) / 2.0))
    first = 4 * np.arange(6)[:, None]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    wound = np.array(positions)
    a, b, c = (wound[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) < 0.0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return Mesh(wound.astype(np.float32), triangles.astype(np.int32), uvs=np.array(uvs, dtype=np.float32))


# Of each face: its normal, and the directions in which Mitsuba's u and v grow.
_FACES = (
    ((0, -1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, 1, 0), (-1, 0, 0), (0, 0, -1)),
    ((1, 0, 0), (0, 1, 0), (0, 0, -1)),
    ((0, 0, 1), (0, 1, 0), (1, 0, 0)),
    ((-1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((0, 0, -1), (0, -1, 0), (1, 0, 0)),
)
