"""Meshes into glTF: corners become vertices, and what lives on them attributes (glTF 2.0, section 3.7.2).

A `Mesh` counts positions, normals and texture coordinates separately; glTF has one number for all. Where they agree nothing is changed,
else each combination that occurs is a vertex:

    corner (position, normal, uv)   ->   vertex, in the order of positions, then normals, then coordinates

v is turned back (``1 - v``, see `limner.files.gltf_material`), which leaves the tangents as they are. A v that came from a file comes back
to the bit; one that is finer than what single precision has beside 1 is rounded to that.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from ..mesh.mesh import Mesh
from ..scene.line_set import LineSet
from ..scene.material import Material
from ..scene.points import PointCloud
from ..scene.rig import Binding, Morph
from ..tables.frames import with_frames
from .gltf_mesh import UNIT_TOLERANCE
from .notes import Notes
from .triangles import finite_rows
from .write_gltf_buffers import Buffers, Json
from .write_gltf_material import Materials, identity, plain_text
from .write_gltf_shape import Shown

__all__ = ["Drawn", "Meshes", "Vertices", "vertices_of"]

Floats = NDArray[np.float32]
Rows = NDArray[np.int64] | slice

_POINTS, _LINES = 0, 1
_ALL = slice(None)
_IN_A_SET = 4  # joints
_GREATEST_JOINT = 65535


class Drawn(NamedTuple):
    """A shape as it is written, with what bends it."""

    shown: Shown
    morphs: tuple[Morph, ...] = ()
    binding: Binding | None = None


class Vertices(NamedTuple):
    """Which rows of a mesh's arrays make its vertices, and the triangles between these, (m, 3)."""

    positions: Rows
    normals: Rows
    uvs: Rows
    triangles: NDArray[Any]


def vertices_of(mesh: Mesh) -> Vertices:
    """Find the vertices of a mesh: its positions, or, where corners at one position differ, each combination that occurs.

    >>> corners = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], normals=[[0, 0, 1]], normal_triangles=[[0, 0, 0]])
    >>> vertices_of(corners).normals.tolist()
    [0, 0, 0]
    """
    n = len(mesh.positions)
    agree = [
        values is None or indices is None or (len(values) >= n and np.array_equal(indices, mesh.triangles))
        for values, indices in ((mesh.normals, mesh.normal_triangles), (mesh.uvs, mesh.uv_triangles))
    ]  # fmt: skip
    if all(agree):
        return Vertices(_ALL, slice(n), slice(n), mesh.triangles)
    columns = [mesh.triangles, *(
        mesh.triangles if indices is None else indices for indices in (mesh.normal_triangles, mesh.uv_triangles)
    )]  # fmt: skip
    rows = [column.reshape(-1).astype(np.int64) for column in columns]
    # Two at a time: three would not fit into one number where a mesh is large.
    pairs, pair = np.unique(rows[0] * (int(rows[1].max()) + 1) + rows[1], return_inverse=True)
    del pairs
    _, first, vertex = np.unique(pair * (int(rows[2].max()) + 1) + rows[2], return_index=True, return_inverse=True)
    return Vertices(rows[0][first], rows[1][first], rows[2][first], vertex.reshape(-1, 3))


def _with_own_tangents(mesh: Mesh, materials: Sequence[Material]) -> Mesh:
    """A mesh with the tangents that a coat or a grain needs, where there is no normal map from which readers would know them."""
    blind = tuple(material for material in materials if getattr(material, "normal_texture", None) is None)
    return with_frames(mesh, blind)


class Meshes:
    """The meshes of one file, each written once however many nodes show it."""

    def __init__(self, buffers: Buffers, materials: Materials, notes: Notes) -> None:
        self._buffers = buffers
        self._materials = materials
        self._notes = notes
        self.meshes: list[Json] = []
        self._known: dict[tuple[Any, ...], int] = {}
        self._vertices: dict[int, Vertices] = {}
        self._attributes: dict[tuple[Any, ...], Json] = {}
        self._held: list[Any] = []  # what an id stands for must not be forgotten while the id is remembered

    def index_of(self, drawn: Sequence[Drawn], path: str) -> int:
        """The number of the mesh that shows these shapes, all with as many morphs."""
        key = tuple(
            (id(shown.geometry), *map(identity, shown.materials), *map(id, morphs), id(binding)) for shown, morphs, binding in drawn
        )  # fmt: skip
        if key not in self._known:
            self._held.append(drawn)
            primitives = [primitive for one in drawn for primitive in self._primitives(one, path)]
            name = next((one.shown.geometry.name for one in drawn if one.shown.geometry.name), "")
            made: Json = ({"name": plain_text(name)} if name else {}) | {"primitives": primitives}
            names = [plain_text(morph.name) for morph in drawn[0].morphs]
            if any(names):
                made["extras"] = {"targetNames": names}
            self._known[key] = len(self.meshes)
            self.meshes.append(made)
        return self._known[key]

    def _primitives(self, drawn: Drawn, path: str) -> list[Json]:
        geometry, materials = drawn.shown
        if isinstance(geometry, PointCloud):
            return [self._with_material({"attributes": self._of_points(geometry, path), "mode": _POINTS}, materials[0])]
        if isinstance(geometry, LineSet):
            return [self._with_material(self._of_lines(geometry, path) | {"mode": _LINES}, materials[0])]
        if not drawn.morphs:
            geometry = _with_own_tangents(geometry, materials)
        vertices = self._vertices_of(geometry)
        shared: Json = {"attributes": self._of_mesh(geometry, vertices, path) | self._of_binding(geometry, vertices, drawn.binding)}
        if drawn.morphs:
            shared["targets"] = [self._target(geometry, vertices, morph) for morph in drawn.morphs]
        slots = geometry.triangle_materials
        groups = [0] if slots is None else np.unique(slots).tolist()
        n_vertices = self._buffers.accessors[shared["attributes"]["POSITION"]]["count"]
        found = []
        for slot in groups:
            triangles = vertices.triangles if slots is None or len(groups) == 1 else vertices.triangles[slots == slot]
            made = shared | {"indices": self._buffers.indices(triangles, n_vertices)}
            found.append(self._with_material(made, materials[slot]))
        return found

    def _with_material(self, primitive: Json, material: Any) -> Json:
        primitive = primitive | self._materials.mappings(material)
        index = self._materials.index_of(material)
        if index is None:
            return primitive
        missing = [f"TEXCOORD_{k}" for k in self._materials.uv_sets(index) if f"TEXCOORD_{k}" not in primitive["attributes"]]
        if missing:
            # Where there are no coordinates, all of a surface shows the texture at (0, 0).
            count = self._buffers.accessors[primitive["attributes"]["POSITION"]]["count"]
            corner = self._buffers.accessor(np.tile(np.array([0.0, 1.0], dtype=np.float32), (count, 1)), "vertices")
            wanted = ["TEXCOORD_0", "TEXCOORD_1"] if "TEXCOORD_1" in missing else missing
            primitive = primitive | {"attributes": dict.fromkeys(wanted, corner) | primitive["attributes"]}
        return primitive | {"material": index}

    # What lives on vertices

    def _vertices_of(self, mesh: Mesh) -> Vertices:
        if id(mesh) not in self._vertices:
            self._held.append(mesh)
            self._vertices[id(mesh)] = vertices_of(mesh)
        return self._vertices[id(mesh)]

    def _of_mesh(self, mesh: Mesh, vertices: Vertices, path: str) -> Json:
        if (id(mesh),) not in self._attributes:
            self._attributes[(id(mesh),)] = self._build(mesh, vertices, path)
            if mesh.vertex_attributes or mesh.edge_attributes or mesh.face_attributes:
                self._notes.add("named attributes of vertices, edges and faces are left out", path)
        return self._attributes[(id(mesh),)]

    def _build(self, mesh: Mesh, vertices: Vertices, path: str) -> Json:
        positions = mesh.positions[vertices.positions]
        made: Json = {"POSITION": self._buffers.accessor(positions, "vertices", bounds=True, own=True)}
        if mesh.normals is not None:
            normals = self._unit(mesh.normals[vertices.normals], _facing(positions, vertices.triangles, mesh.normals), "normals", path)
            made["NORMAL"] = self._vertices_accessor(normals)
            if mesh.tangents is not None:
                made["TANGENT"] = self._vertices_accessor(self._tangents(mesh.tangents[vertices.normals], normals, path))
        for name, uvs in (("TEXCOORD_0", mesh.uvs), ("TEXCOORD_1", mesh.uvs1)):
            if uvs is not None:
                made[name] = self._vertices_accessor(self._turned(uvs[vertices.uvs], path))
        return made | self._colors_and_scalars(mesh, vertices.positions, path)

    def _of_points(self, cloud: PointCloud, path: str) -> Json:
        if (id(cloud),) not in self._attributes:
            self._held.append(cloud)
            kept = _ALL if cloud.shown.all() else np.flatnonzero(cloud.shown)
            positions = cloud.positions[kept]
            made: Json = {"POSITION": self._buffers.accessor(positions, "vertices", bounds=True, own=True)}
            if cloud.normals is not None:
                upright = np.tile(np.array([0.0, 1.0, 0.0], dtype=np.float32), (len(positions), 1))
                made["NORMAL"] = self._vertices_accessor(self._unit(cloud.normals[kept], upright, "normals", path))
            self._attributes[(id(cloud),)] = made | self._colors_and_scalars(cloud, kept, path)
        return self._attributes[(id(cloud),)]

    def _of_lines(self, lines: LineSet, path: str) -> Json:
        if (id(lines),) not in self._attributes:
            self._held.append(lines)
            # Where all is finite the positions stay as they are: what no segment uses is written too, and comes back.
            is_whole = finite_rows(lines.positions).all()
            kept, segments = (_ALL, lines.ends) if is_whole else np.unique(lines.ends[lines.shown].astype(np.int64), return_inverse=True)
            positions = lines.positions[kept]
            made: Json = {"POSITION": self._buffers.accessor(positions, "vertices", bounds=True, own=True)}
            made |= self._colors_and_scalars(lines, kept, path)
            self._attributes[(id(lines),)] = {"attributes": made, "indices": self._buffers.indices(segments, len(positions))}
        return self._attributes[(id(lines),)]

    def _vertices_accessor(self, values: Floats) -> int:
        return self._buffers.accessor(values, "vertices")

    def _unit(self, vectors: Floats, otherwise: Floats, what: str, path: str) -> Floats:
        """Vectors of length 1: as they are where they are so nearly, made so, or others where they have no length."""
        squared = np.einsum("ij,ij->i", vectors, vectors, dtype=np.float64)
        with np.errstate(invalid="ignore"):
            if (np.abs(squared - 1.0) <= 2.0 * UNIT_TOLERANCE).all():
                return vectors
        usable = np.isfinite(squared) & (squared > 0.0)
        length = np.sqrt(np.where(usable, squared, 1.0))
        self._notes.add(f"{what} that are not unit are made so", path)
        return np.where(usable[:, None], np.where(usable[:, None], vectors, 0.0) / length[:, None], otherwise).astype(np.float32)

    def _tangents(self, tangents: Floats, normals: Floats, path: str) -> Floats:
        least = np.eye(3)[np.abs(normals).argmin(axis=1)]
        across = np.cross(normals, least)
        across = (across / np.linalg.norm(across, axis=1, keepdims=True)).astype(np.float32)
        along = self._unit(np.ascontiguousarray(tangents[:, :3]), across, "tangents", path)
        return np.concatenate([along, np.where(tangents[:, 3:] < 0.0, np.float32(-1.0), np.float32(1.0))], axis=1)

    def _turned(self, uvs: Floats, path: str) -> Floats:
        turned = np.stack([uvs[:, 0], np.float32(1.0) - uvs[:, 1]], axis=1)
        return self._finite(turned, "texture coordinates", path)

    def _finite(self, values: Floats, what: str, path: str) -> Floats:
        if finite_rows(values).all():
            return values
        self._notes.add(f"{what} that are not finite are written as 0", path)
        return np.where(np.isfinite(values), values, np.float32(0.0))

    def _colors_and_scalars(self, geometry: Mesh | PointCloud | LineSet, rows: Rows, path: str) -> Json:
        made: Json = {}
        if geometry.colors is not None:
            colors = self._finite(geometry.colors[rows], "colours", path)
            if colors.size and not (float(colors.min()) >= 0.0 and float(colors.max()) <= 1.0):
                self._notes.add("vertex colours are clipped to [0, 1], which is what glTF can hold", path)
                colors = np.clip(colors, 0.0, 1.0)
            made["COLOR_0"] = self._vertices_accessor(colors)
        for name, values in (geometry.scalars or {}).items():
            if np.isfinite(values).all():
                made["_" + plain_text(str(name))] = self._vertices_accessor(values[rows])
            else:
                self._notes.add(f"the scalars {name!r} are left out, not all of them are finite", path)
        return made

    # What bends them

    def _of_binding(self, mesh: Mesh, vertices: Vertices, binding: Binding | None) -> Json:
        if binding is None:
            return {}
        key = id(mesh), id(binding)
        if key not in self._attributes:
            joints, weights = _sets(binding)
            made: Json = {}
            for k in range(0, joints.shape[1], _IN_A_SET):
                columns = slice(k, k + _IN_A_SET)
                led_by, shares = joints[vertices.positions, columns], weights[vertices.positions, columns]
                made[f"JOINTS_{k // _IN_A_SET}"] = self._buffers.accessor(led_by, "vertices")
                made[f"WEIGHTS_{k // _IN_A_SET}"] = self._vertices_accessor(shares)
            self._attributes[key] = made
        return self._attributes[key]

    def _target(self, mesh: Mesh, vertices: Vertices, morph: Morph) -> Json:
        key = id(mesh), id(morph)
        if key not in self._attributes:
            rows = {"POSITION": (morph.positions, vertices.positions), "NORMAL": (morph.normals, vertices.normals),
                    "TANGENT": (morph.tangents, vertices.normals)}  # fmt: skip
            given = {name: np.ascontiguousarray(moved[kept]) for name, (moved, kept) in rows.items() if moved is not None}
            # A morph that moves nothing is none that glTF knows; one that moves positions by 0 is.
            given = given or {"POSITION": np.zeros_like(mesh.positions[vertices.positions])}
            self._attributes[key] = {
                name: self._buffers.offsets(moved, bounds=name == "POSITION") for name, moved in given.items()
            }  # fmt: skip
        return self._attributes[key]


def _facing(positions: Floats, triangles: NDArray[Any], normals: Floats) -> Floats:
    """(n, 3): for each vertex the normal of a triangle that has it, for where its own is unusable; +y where there is none."""
    made = np.tile(np.array([0.0, 1.0, 0.0]), (len(positions), 1))
    squared = np.einsum("ij,ij->i", normals, normals, dtype=np.float64)
    if np.isfinite(squared).all() and squared.min(initial=1.0) > 0.0:
        return made.astype(np.float32)
    a, b, c = (positions[triangles[:, corner]].astype(np.float64) for corner in range(3))
    across = np.cross(b - a, c - a)
    length = np.linalg.norm(across, axis=1)
    good = length > 0.0
    made[triangles[good].reshape(-1)] = np.repeat(across[good] / length[good, None], 3, axis=0)
    return made.astype(np.float32)


def _sets(binding: Binding) -> tuple[NDArray[Any], Floats]:
    """Joints and weights in sets of four: each joint once for a vertex, and joint 0 where there is no weight."""
    joints, weights = binding.joints, binding.weights
    if _has_twins(joints, weights):
        joints, weights = _merged(joints, weights)
    joints = np.where(weights > 0.0, joints, 0)
    if joints.max(initial=0) > _GREATEST_JOINT:
        raise UnsupportedError(f"glTF counts joints up to {_GREATEST_JOINT}, got {int(joints.max())}")
    beyond = -joints.shape[1] % _IN_A_SET
    width = np.uint8 if joints.max(initial=0) < 256 else np.uint16
    return np.pad(joints, ((0, 0), (0, beyond))).astype(width), np.pad(weights, ((0, 0), (0, beyond)))


def _has_twins(joints: NDArray[np.int32], weights: Floats) -> bool:
    # What weighs nothing is no twin of anything.
    named = np.sort(np.where(weights > 0.0, joints, -1 - np.arange(joints.shape[1])), axis=1)
    return bool((named[:, 1:] == named[:, :-1]).any())


def _merged(joints: NDArray[np.int32], weights: Floats) -> tuple[NDArray[np.int32], Floats]:
    """The weight of a joint that a vertex names twice goes to where it is named first."""
    summed = weights.astype(np.float64)
    for k in range(1, joints.shape[1]):
        for earlier in range(k):
            same = (joints[:, k] == joints[:, earlier]) & (summed[:, k] > 0.0) & (summed[:, earlier] > 0.0)
            summed[:, earlier] += np.where(same, summed[:, k], 0.0)
            summed[:, k] = np.where(same, 0.0, summed[:, k])
    return joints, summed.astype(np.float32)
