"""Meshes of glTF: a primitive's accessors become a `Mesh`, a `PointCloud` or a `LineSet` (glTF 2.0, section 3.7.2).

What the file promises is checked, what is broken in few places is repaired and noted: triangles that refer to vertices that
do not exist or lie at infinity are left out, normals without length are replaced by those of the surface.

Turning v (``v' = 1 - v``, see `limner.files.gltf_material`) leaves tangents as they are. glTF's normal maps are green *up*
(3.9.3: "+Y is up") while its v points *down* the picture, so the bitangent ``b = w cross(n, t)`` that goes with green must
point towards decreasing v of the file (so the tangents of its sample models lie), which is increasing v here. The sign w
stands; ``ns = t n_x + b n_y + n n_z`` with our coordinates is right.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from ..mesh.mesh import Mesh
from ..scene.line_set import LineSet
from ..scene.points import PointCloud
from .accessors import Accessors
from .document import Element
from .draco import DracoError, decode
from .limits import Limits
from .notes import Notes, without_path
from .triangles import count_degenerate, finite_rows

__all__ = ["Meshes", "compact", "fan_triangles", "line_segments", "strip_triangles"]

POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = range(7)
# How far a vector may be from unit length before it is made unit; quantised normals are within.
UNIT_TOLERANCE = 1e-3

Floats = NDArray[np.float32]
Indices = NDArray[Any]


def strip_triangles(corners: Indices) -> Indices:
    """Return the triangles of a strip: every second one is turned, so that all face the same way.

    **Source**: glTF 2.0, 3.7.2.1: p_i = {v_i, v_(i + (1 + i mod 2)), v_(i + (2 - i mod 2))}.

    >>> strip_triangles(np.array([0, 1, 2, 3])).tolist()
    [[0, 1, 2], [1, 3, 2]]
    """
    first = np.arange(max(len(corners) - 2, 0))
    odd = first % 2
    return corners[np.stack([first, first + 1 + odd, first + 2 - odd], axis=1)]


def fan_triangles(corners: Indices) -> Indices:
    """Return the triangles of a fan round its first corner.

    **Source**: glTF 2.0, 3.7.2.1: p_i = {v_(i+1), v_(i+2), v_0}.

    >>> fan_triangles(np.array([0, 1, 2, 3])).tolist()
    [[1, 2, 0], [2, 3, 0]]
    """
    first = np.arange(max(len(corners) - 2, 0))
    return corners[np.stack([first + 1, first + 2, np.zeros_like(first)], axis=1)]


def line_segments(corners: Indices, mode: int) -> Indices:
    """Return the segments of separate lines, of a loop or of a strip; an odd corner left over belongs to none.

    **Source**: glTF 2.0, 3.7.2.1.

    >>> line_segments(np.array([4, 5, 6]), LINE_LOOP).tolist()
    [[4, 5], [5, 6], [6, 4]]
    """
    if mode == LINES:
        return corners[: len(corners) // 2 * 2].reshape(-1, 2)
    strip = np.stack([corners[:-1], corners[1:]], axis=1)
    if mode == LINE_STRIP or len(corners) < 2:
        return strip
    return np.concatenate([strip, [[corners[-1], corners[0]]]])


def compact(triangles: Indices, n_vertices: int) -> tuple[Indices, Indices | None]:
    """Leave out vertices that no triangle uses, where those are more than half.

    Returns the triangles and the indices of the vertices they kept; None: all.
    """
    if 2 * triangles.size >= n_vertices:
        return triangles, None
    kept, renumbered = np.unique(triangles, return_inverse=True)
    return renumbered.reshape(triangles.shape), kept


class Meshes:
    """The triangle meshes of one glTF file, each primitive built once, when it is asked for."""

    def __init__(self, root: Element, accessors: Accessors, limits: Limits, notes: Notes) -> None:
        self._meshes = root.array("meshes")
        self._accessors = accessors
        self._limits = limits
        self._notes = notes
        self._built: dict[tuple[Any, ...], Mesh | PointCloud | LineSet | None] = {}
        self._n_vertices = 0
        self._n_triangles = 0
        self.n_degenerate = 0
        self.first_error: LimnerError | None = None
        self.n_built = 0
        self._kept: dict[int, tuple[int, Indices | None]] = {}

    def __len__(self) -> int:
        return len(self._meshes)

    def primitives(self, index: int) -> list[Element]:
        """The primitives of mesh `index`."""
        return self._meshes[index].child("primitives").elements()

    def element(self, index: int) -> Element:
        """Mesh `index` of the document."""
        return self._meshes[index]

    def name(self, index: int) -> str:
        """The name of mesh `index`."""
        return self._meshes[index].name()

    def vertices_of(self, mesh: Mesh) -> tuple[int, Indices | None]:
        """How many vertices the file has of a mesh, and which of them it kept (None: all)."""
        return self._kept[id(mesh)]

    def of(self, primitive: Element, name: str) -> Mesh | PointCloud | LineSet | None:
        """Return the mesh, points or lines of a primitive; None, with a note, where there is nothing to draw or it cannot be read."""
        try:
            key = _identity(primitive)
            if key not in self._built:
                self._built[key] = self._build(primitive, name)
                self.n_built += self._built[key] is not None
            return self._built[key]
        except LimnerError as error:
            self.first_error = self.first_error or error
            self._notes.slip(f"left out: {without_path(error)}", primitive.pointer)
            return None

    def _build(self, primitive: Element, name: str) -> Mesh | PointCloud | LineSet | None:
        mode = primitive.get_integer("mode", TRIANGLES)
        if mode > TRIANGLE_FAN:
            raise primitive.error(f"must be at most {TRIANGLE_FAN}, got {mode}", "mode")
        attributes = primitive.child("attributes")
        reference = attributes.get("POSITION")
        if reference is None:
            self._notes.add("left out, it has no positions", primitive.pointer)
            return None
        compressed = primitive.extension("KHR_draco_mesh_compression")
        if compressed is not None and not self._accessors.has_data(reference):
            self._decompress(primitive, compressed)
            mode = TRIANGLES  # what was a strip comes back as triangles
        if mode == POINTS:
            return self._cloud(primitive, attributes, reference, name)
        if mode < TRIANGLES:
            return self._lines(primitive, attributes, reference, mode, name)
        return self._assemble(primitive, attributes, reference, mode, name)

    def _decompress(self, primitive: Element, compressed: Element) -> None:
        """Give the accessors of a primitive what its Draco stream holds.

        **Source**: Khronos Group, *KHR_draco_mesh_compression*.
        """
        attributes = primitive.child("attributes")
        if self._n_vertices + self._accessors.count(attributes.child("POSITION")) > self._limits.max_vertices:
            raise primitive.error(f"exceeds the limit of {self._limits.max_vertices} vertices (max_vertices)")
        stream = self._accessors.view_bytes(compressed.child("bufferView"))
        try:
            mesh = decode(stream, f"{primitive.path}, {primitive.pointer}")
        except DracoError as error:
            raise compressed.error(str(error)) from None
        for name in compressed.child("attributes").keys():  # noqa: SIM118 (an Element is no dictionary)
            number = compressed.child("attributes").child(name)
            reference = attributes.get(name)
            if reference is not None:
                values = mesh.attributes.get(number.integer())
                missing = number.error(f"must be one of {sorted(mesh.attributes)}, got {number.integer()}")
                self._accessors.supply(reference, missing if values is None else values)
        indices = primitive.get("indices")
        if indices is None:
            raise primitive.error("is missing", "indices")
        self._accessors.supply(indices, mesh.triangles.reshape(-1, 1))

    def _cloud(self, primitive: Element, attributes: Element, reference: Element, name: str) -> PointCloud | None:
        n_vertices = self._accessors.count(reference)
        self._n_vertices += n_vertices
        self._check_limits(primitive, 0)
        positions = self._accessors.floats(reference, "VEC3")
        indices = primitive.get("indices")
        chosen = np.arange(n_vertices) if indices is None else np.unique(self._accessors.indices(indices))
        kept = chosen[chosen < n_vertices]
        kept = kept[finite_rows(positions[kept])]
        if len(kept) < len(chosen):
            text = f"{len(chosen) - len(kept)} of {len(chosen)} points do not exist or are not finite and are left out"
            self._notes.slip(text, primitive.pointer)
        if not len(kept):
            self._notes.add("left out, it has no points", primitive.pointer)
            return None
        reader = _Attributes(attributes, self._accessors, self._notes, n_vertices, None if len(kept) == n_vertices else kept)
        normals = reader.unit_vectors("NORMAL", "VEC3")
        positions = np.ascontiguousarray(positions[kept])
        return PointCloud(positions, reader.colors(), normals, scalars=reader.scalars(), name=name)

    def _lines(self, primitive: Element, attributes: Element, reference: Element, mode: int, name: str) -> LineSet | None:
        n_vertices = self._accessors.count(reference)
        indices = primitive.get("indices")
        n_corners = n_vertices if indices is None else self._accessors.count(indices)
        self._n_vertices += n_vertices
        # A segment is drawn as several triangles: what bounds these bounds the segments.
        self._check_limits(primitive, n_corners)
        positions = self._accessors.floats(reference, "VEC3")
        corners = np.arange(n_vertices) if indices is None else self._accessors.indices(indices)
        segments = line_segments(corners.astype(np.int64), mode)
        good = np.asarray((segments < n_vertices).all(axis=1))
        good[good] = finite_rows(positions)[segments[good]].all(axis=1)
        if not good.all():
            text = f"{int((~good).sum())} of {len(good)} segments have ends that do not exist or are not finite and are left out"
            self._notes.slip(text, primitive.pointer)
        if not good.any():
            self._notes.add("left out, it has no lines", primitive.pointer)
            return None
        segments, kept = compact(segments[good], n_vertices)
        reader = _Attributes(attributes, self._accessors, self._notes, n_vertices, kept)
        places = np.ascontiguousarray(positions if kept is None else positions[kept])
        return LineSet(places, segments.astype(np.int32), reader.colors(), scalars=reader.scalars(), name=name)

    def _assemble(self, primitive: Element, attributes: Element, reference: Element, mode: int, name: str) -> Mesh | None:
        n_vertices = self._accessors.count(reference)
        indices = primitive.get("indices")
        n_corners = n_vertices if indices is None else self._accessors.count(indices)
        self._check_limits(primitive, n_corners // 3 if mode == TRIANGLES else max(n_corners - 2, 0))
        positions = self._accessors.floats(reference, "VEC3")
        corners = np.arange(len(positions)) if indices is None else self._accessors.indices(indices)
        triangles = self._triangles(primitive, corners, mode)
        triangles = self._existing(primitive, triangles, len(positions))
        triangles, kept = compact(triangles, len(positions))
        positions = positions if kept is None else positions[kept]
        triangles, positions = self._finite(primitive, triangles, positions)
        if not len(triangles):
            self._notes.add("left out, it has no triangles", primitive.pointer)
            return None
        self._n_vertices += len(positions)
        self._check_limits(primitive, 0)
        self._n_triangles += len(triangles)
        triangles = triangles.astype(np.int32)
        self.n_degenerate += count_degenerate(positions, triangles)
        reader = _Attributes(attributes, self._accessors, self._notes, n_vertices, kept)
        normals = reader.unit_vectors("NORMAL", "VEC3")
        if normals is not None:
            normals = _repair_normals(normals, positions, triangles, f"{attributes.pointer}/NORMAL", self._notes)
        tangents = reader.unit_vectors("TANGENT", "VEC4") if normals is not None else None
        if tangents is not None and normals is not None:
            tangents = _repair_tangents(tangents, normals, f"{attributes.pointer}/TANGENT", self._notes)
        uvs, uvs1 = reader.uvs("TEXCOORD_0"), reader.uvs("TEXCOORD_1")
        if uvs1 is not None and uvs is None:
            uvs = np.zeros_like(uvs1)
        mesh = Mesh(
            positions, triangles,
            normals=normals, uvs=uvs, uvs1=uvs1, colors=reader.colors(), tangents=tangents, name=name,
            scalars=reader.scalars(),
        )  # fmt: skip
        self._kept[id(mesh)] = n_vertices, kept
        return mesh

    def _check_limits(self, primitive: Element, n_more_triangles: int) -> None:
        if self._n_triangles + n_more_triangles > self._limits.max_triangles:
            raise primitive.error(f"exceeds the limit of {self._limits.max_triangles} triangles (max_triangles)")
        if self._n_vertices > self._limits.max_vertices:
            raise primitive.error(f"exceeds the limit of {self._limits.max_vertices} vertices (max_vertices)")

    def _triangles(self, primitive: Element, corners: Indices, mode: int) -> Indices:
        if mode == TRIANGLES:
            extra = len(corners) % 3
            if extra:
                text = f"{len(corners)} corners are no multiple of three, the last {extra} are left out"
                self._notes.slip(text, primitive.pointer)
            return corners[: len(corners) - extra].reshape(-1, 3)
        triangles = strip_triangles(corners) if mode == TRIANGLE_STRIP else fan_triangles(corners)
        # Strips repeat corners on purpose, to turn round; those triangles are no part of the surface.
        a, b, c = triangles.T
        return triangles[(a != b) & (b != c) & (c != a)]

    def _existing(self, primitive: Element, triangles: Indices, n_vertices: int) -> Indices:
        if not triangles.size or int(triangles.max()) < n_vertices:
            return triangles
        good = (triangles < n_vertices).all(axis=1)
        text = f"{int((~good).sum())} triangles refer to vertices that do not exist and are left out"
        self._notes.slip(text, f"{primitive.pointer}/indices")
        return triangles[good]

    def _finite(self, primitive: Element, triangles: Indices, positions: Floats) -> tuple[Indices, Floats]:
        finite = finite_rows(positions)
        if finite.all():
            return triangles, positions
        good = finite[triangles].all(axis=1)
        if not good.all():
            text = f"{int((~good).sum())} triangles with positions that are not finite are left out"
            self._notes.slip(text, f"{primitive.pointer}/attributes/POSITION")
        return triangles[good], np.where(finite[:, None], positions, np.float32(0.0))


class _Attributes:
    """The attributes of one primitive besides its positions; a bad one is left out, with a slip."""

    def __init__(self, attributes: Element, accessors: Accessors, notes: Notes, n_vertices: int, kept: Indices | None) -> None:
        self._attributes = attributes
        self._accessors = accessors
        self._notes = notes
        self._n_vertices = n_vertices
        self._kept = kept

    def _read(self, name: str, *types: str, normalize: bool = False) -> Floats | None:
        reference = self._attributes.get(name)
        if reference is None:
            return None
        try:
            values = self._accessors.floats(reference, *types, normalize=normalize)
            if len(values) != self._n_vertices:
                raise reference.error(f"must have one element per position ({self._n_vertices}), got {len(values)}")
        except LimnerError as error:
            self._notes.slip(f"drawn without {name}: {without_path(error)}")
            return None
        return values if self._kept is None else values[self._kept]

    def unit_vectors(self, name: str, kind: str) -> Floats | None:
        """Vectors, as integers always fractions."""
        return self._read(name, kind, normalize=True)

    def uvs(self, name: str) -> Floats | None:
        """Texture coordinates with v turned up."""
        values = self._read(name, "VEC2")
        if values is None:
            return None
        turned = np.empty_like(values)
        turned[:, 0] = values[:, 0]
        np.subtract(1.0, values[:, 1], out=turned[:, 1])
        if not np.isfinite(turned).all():
            self._notes.slip("coordinates that are not finite are set to 0", f"{self._attributes.pointer}/{name}")
            turned = np.where(np.isfinite(turned), turned, np.float32(0.0))
        return turned

    def scalars(self) -> dict[str, Floats]:
        """What an application has to say of each vertex, ``_NAME``, by its name without the underscore; numbers only, no vectors."""
        found = {}
        for name in self._attributes.keys():  # noqa: SIM118 (an Element is no dictionary)
            values = self._read(name, "SCALAR") if name.startswith("_") and self._is_scalar(name) else None
            if values is not None:
                found[name.removeprefix("_")] = values.reshape(-1)
        return found

    def _is_scalar(self, name: str) -> bool:
        reference = self._attributes.get(name)
        return reference is not None and self._accessors.type_of(reference) == "SCALAR"

    def colors(self) -> Floats | None:
        """Linear vertex colours; integers are fractions, though the file may have forgotten to say so."""
        values = self._read("COLOR_0", "VEC3", "VEC4", normalize=True)
        if values is not None and not (np.isfinite(values).all() and values.min() >= 0.0):
            self._notes.slip("colours that are negative or not finite are set to 0", f"{self._attributes.pointer}/COLOR_0")
            return np.where(np.isfinite(values), np.maximum(values, np.float32(0.0)), np.float32(0.0))
        return values


def _repair_normals(normals: Floats, positions: Floats, triangles: Indices, where: str, notes: Notes) -> Floats:
    """Make normals unit; replace those without length by the area-weighted mean of the triangles around."""
    squared = np.einsum("ij,ij->i", normals, normals, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        unit = np.abs(squared - 1.0) <= 2.0 * UNIT_TOLERANCE
    if unit.all():
        return normals
    usable = np.isfinite(squared) & (squared > 0.0)
    length = np.sqrt(np.where(usable, squared, 1.0))
    repaired = (np.where(usable[:, None], normals, 0.0) / length[:, None]).astype(np.float32)
    if not usable.all():
        surface = _vertex_normals(positions, triangles)
        repaired[~usable] = surface[~usable]
        notes.add(f"{int((~usable).sum())} normals without length are replaced by those of the surface", where)
    return repaired


def _vertex_normals(positions: Floats, triangles: Indices) -> Floats:
    corners = positions[triangles].astype(np.float64)
    doubled_areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.stack([np.bincount(triangles.reshape(-1), np.repeat(doubled_areas[:, axis], 3), len(positions)) for axis in range(3)], axis=1)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    upright = np.array([0.0, 1.0, 0.0])
    return np.where(length > 0.0, sums / np.where(length > 0.0, length, 1.0), upright).astype(np.float32)


def _repair_tangents(tangents: Floats, normals: Floats, where: str, notes: Notes) -> Floats:
    """Make tangents unit and their signs +1 or -1; replace those without length by any vector along the surface."""
    along, sign = tangents[:, :3], tangents[:, 3]
    squared = np.einsum("ij,ij->i", along, along, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        if (np.abs(squared - 1.0) <= 2.0 * UNIT_TOLERANCE).all() and (np.abs(sign) == 1.0).all():
            return tangents
    usable = np.isfinite(squared) & (squared > 0.0)
    repaired = np.empty_like(tangents)
    repaired[:, :3] = np.where(usable[:, None], along, 0.0) / np.sqrt(np.where(usable, squared, 1.0))[:, None]
    repaired[:, 3] = np.where(sign < 0.0, -1.0, 1.0)
    if not usable.all():
        least = np.eye(3)[np.abs(normals[~usable]).argmin(axis=1)]
        crossed = np.cross(normals[~usable], least)
        repaired[~usable, :3] = crossed / np.linalg.norm(crossed, axis=1, keepdims=True)
        notes.add(f"{int((~usable).sum())} tangents without length are replaced", where)
    return repaired


def _identity(primitive: Element) -> tuple[Any, ...]:
    """Return what two primitives share that show the same triangles: the accessors they name."""
    attributes = primitive.child("attributes")
    named = tuple((key, _plain(attributes.child(key).value)) for key in sorted(attributes.keys()))
    indices = primitive.get("indices")
    return named, None if indices is None else _plain(indices.value), primitive.get_integer("mode", TRIANGLES)


def _plain(value: Any) -> Any:
    return value if isinstance(value, (int, float, str)) else repr(type(value))
