"""Reading PLY: what scanners, simulations and mesh tools write (FoCG 12.1).

    header -> rows -> triangles, or a cloud of points; colours, normals, texture coordinates; all else by its name

Read are vertices with any further properties, faces with any number of corners, triangle strips, colours of vertices or faces, texture
coordinates of vertices or of the faces' corners, and the picture that a comment ``TextureFile`` names. A vertex property without a
meaning of its own (curvature, quality, confidence …) is kept in `Mesh.scalars` by its name, for `limner.color_by`.

trimesh, which reads other formats for us, reads PLY as fast, but keeps neither those nor texture coordinates at corners.

**Source**: Greg Turk, *The PLY Polygon File Format*, 1994; for texture coordinates the files of MeshLab and Blender.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..color.decode_table import SRGB_DECODE
from ..color.transfer import linear_from_srgb
from ..errors import FileFormatError, LimnerError
from ..linear.transform import translate
from ..mesh.mesh import Mesh
from ..mesh.normals import crease_normals
from ..scene.material import Lambert, Material
from ..scene.node import Node
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.shape import Shape
from ..scene.texture import Texture
from .limits import DEFAULT, Limits
from .notes import Notes, quoted, without_path
from .obj import CREASE_DEGREES
from .pictures import Pictures
from .ply_rows import Header, Ragged, Rows, read_header, read_rows
from .polygon import triangulate
from .sources import Sources
from .triangles import count_degenerate, finite_rows

__all__ = ["read"]

_POSITION, _NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")
_COLORS = (("red", "green", "blue"), ("r", "g", "b"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_ALPHAS = ("alpha", "a", "diffuse_alpha")
_UVS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))
_CORNERS = ("vertex_indices", "vertex_index")
_RADII = ("radius", "radii")
# Coordinates that float32 tells apart by no less than this share of the model's extent are moved to its middle.
_COARSE = 1e-5

Indices = NDArray[np.int32]


class _Faces(NamedTuple):
    """Triangles, (m, 3); the face that each was cut from, (m,), and the corners of faces that it has, (m, 3); None: in their order."""

    triangles: Indices
    faces: NDArray[np.int64] | None = None
    corners: NDArray[np.int64] | None = None

    def kept(self, good: NDArray[np.bool_]) -> _Faces:
        """Some of them."""
        faces, corners = self.of_faces(), self.of_corners()
        return _Faces(self.triangles[good], faces[good], corners[good])

    def of_faces(self) -> NDArray[np.int64]:
        """The face that each triangle was cut from."""
        return np.arange(len(self.triangles)) if self.faces is None else self.faces

    def of_corners(self) -> NDArray[np.int64]:
        """The corners of the faces that each has."""
        return np.arange(self.triangles.size).reshape(-1, 3) if self.corners is None else self.corners


def read(
    data: bytes,
    path: str | os.PathLike[str],
    *,
    limits: Limits = DEFAULT,
    notes: Notes | None = None,
    sources: Sources | None = None,
) -> Scene:
    """Read the bytes of a .ply file.

    Parameters
    ----------
    data : bytes
    path : str or path-like
        Where it lies: a texture is looked up beside it.
    limits : Limits
    notes : Notes, optional
        Where remarks are collected; they are in `Scene.notes` in any case.
    sources : Sources, optional
        What has counted the bytes read so far.

    Returns
    -------
    Scene
        A mesh; a cloud of points where there are no faces.

    Raises FileFormatError.
    """
    header = read_header(data, path)
    rows = read_rows(data, header, ("vertex", "face", "tristrips"), path, limits)
    reader = _Reader(header, rows, path, limits, notes if notes is not None else Notes(), sources or Sources(path, limits))
    return reader.scene()


class _Reader:
    """One PLY file while it is read."""

    def __init__(
        self, header: Header, rows: dict[str, Rows], path: str | os.PathLike[str], limits: Limits, notes: Notes, sources: Sources
    ) -> None:
        self._header, self._rows, self._path, self._limits, self._notes = header, rows, path, limits, notes
        self._sources = sources
        self._name = Path(path).stem
        empty = Rows({}, {})
        self._vertices, self._face_rows = rows.get("vertex", empty).columns, rows.get("face", empty)
        self._used: set[str] = set()

    def scene(self) -> Scene:
        """Build the scene."""
        if not all(axis in self._vertices for axis in _POSITION) or not len(self._vertices["x"]):
            raise FileFormatError("it has no vertices with x, y and z", self._path)
        n_vertices = len(self._vertices["x"])
        if n_vertices > self._limits.max_vertices:
            raise FileFormatError(f"has {n_vertices} vertices, the limit is {self._limits.max_vertices} (max_vertices)", self._path)
        place, positions = self._positions()
        faces = self._faces(positions)
        if len(faces.triangles) > self._limits.max_triangles:
            n_triangles = len(faces.triangles)
            raise FileFormatError(f"has {n_triangles} triangles, the limit is {self._limits.max_triangles} (max_triangles)", self._path)
        shape = self._cloud(positions) if not len(faces.triangles) else self._surface(positions, faces)
        node = Node(self._name, place, shapes=(shape,))
        return Scene(Node(children=(node,)), name=self._name, notes=self._notes.lines())

    def _columns(self, names: tuple[str, ...], table: dict[str, NDArray[Any]], dtype: str) -> NDArray[Any] | None:
        if not all(name in table for name in names):
            return None
        made = np.empty((len(table[names[0]]), len(names)), dtype=dtype)
        with np.errstate(over="ignore"):
            for k, name in enumerate(names):
                made[:, k] = table[name]
        self._used.update(names)
        return made

    def _positions(self) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
        """Where the mesh stands, and its positions there."""
        double = self._vertices["x"].dtype.itemsize == 8
        given = self._columns(_POSITION, self._vertices, "f8" if double else "f4")
        assert given is not None
        if double:
            finite = given[finite_rows(given)]
            low, high = (finite.min(axis=0), finite.max(axis=0)) if len(finite) else (np.zeros(3), np.zeros(3))
            # Of coordinates on the Earth float32 would leave steps of half a metre.
            if np.spacing(np.float32(np.abs([low, high]).max())) > _COARSE * float((high - low).max()) > 0.0:
                middle = np.round((low + high) / 2.0)
                return translate(*middle), (given - middle).astype(np.float32)
            with np.errstate(over="ignore"):
                given = given.astype(np.float32)
        return np.eye(4), given

    # Faces

    def _faces(self, positions: NDArray[np.float32]) -> _Faces:
        name = next((name for name in _CORNERS if name in self._face_rows.lists), None)
        if name is not None:
            faces = self._cut(self._face_rows.lists[name], positions)
        elif "tristrips" in self._rows and self._rows["tristrips"].lists:
            faces = _from_strips(next(iter(self._rows["tristrips"].lists.values())).values)
        else:
            faces = _Faces(np.zeros((0, 3), np.int32))
        if not len(faces.triangles):
            return faces
        triangles = faces.triangles
        good: NDArray[np.bool_] | None = None
        if int(triangles.min()) < 0 or int(triangles.max()) >= len(positions):
            good = np.asarray(((triangles >= 0) & (triangles < len(positions))).all(axis=1))
            self._notes.slip(f"{int((~good).sum())} triangles refer to vertices that do not exist and are left out")
        finite = finite_rows(positions)
        if not finite.all():
            known = np.ones(len(triangles), dtype=bool) if good is None else good
            seen = known.copy()
            seen[known] = finite[triangles[known]].all(axis=1)
            self._notes.slip(f"{int((known & ~seen).sum())} triangles with positions that are not finite are left out")
            good = seen
            positions[~finite] = 0.0
        if good is not None:
            faces = faces.kept(good)
            if not len(faces.triangles):
                raise FileFormatError("none of its faces has vertices that exist and are finite", self._path)
        n_degenerate = count_degenerate(positions, faces.triangles)
        if n_degenerate:
            self._notes.slip(f"{n_degenerate} triangles have no area; they are kept")
        return faces._replace(triangles=np.ascontiguousarray(faces.triangles, dtype=np.int32))

    def _cut(self, corners: Ragged, positions: NDArray[np.float32]) -> _Faces:
        """Cut faces into triangles, in their order."""
        counts = corners.counts
        if len(counts) and (counts == 3).all():
            return _Faces(corners.values.reshape(-1, 3))
        lost = int((counts < 3).sum())
        if lost:
            self._notes.add(f"{lost} faces with fewer than three corners are left out")
        if int(np.maximum(counts - 2, 0).sum()) > self._limits.max_triangles:
            raise FileFormatError(f"has more triangles than {self._limits.max_triangles}, the limit (max_triangles)", self._path)
        parts: list[_Faces] = []
        starts = corners.starts
        for k in np.unique(counts[counts >= 3]).tolist():
            rows = np.flatnonzero(counts == k)
            indices = corners.values[starts[rows][:, None] + np.arange(k)]
            at = np.clip(np.nan_to_num(indices), 0, len(positions) - 1).astype(np.int64)
            cut, n_fans = triangulate(positions[at].astype(np.float64))
            if n_fans:
                self._notes.add(f"{n_fans} faces are too large to be cut well and may be wrong")
            local = cut.reshape(len(rows), -1)
            triangles = np.take_along_axis(indices, local, axis=1).reshape(-1, 3)
            parts.append(_Faces(triangles, np.repeat(rows, k - 2), (starts[rows][:, None] + local).reshape(-1, 3)))
        if not parts:
            return _Faces(np.zeros((0, 3), np.int32))
        faces = np.concatenate([part.of_faces() for part in parts])
        order = np.argsort(faces, kind="stable")
        triangles = np.concatenate([part.triangles for part in parts])[order]
        return _Faces(triangles, faces[order], np.concatenate([part.of_corners() for part in parts])[order])

    # What is on them

    def _colors(self, table: dict[str, NDArray[Any]], where: str) -> NDArray[np.float32] | None:
        """(n, 3) or (n, 4) linear."""
        names = next((names for names in _COLORS if all(name in table for name in names)), None)
        if names is None:
            return None
        self._used.update(names)
        channels = [_decoded(table[name]) for name in names]
        alpha = next((name for name in _ALPHAS if name in table), None)
        if alpha is not None:
            self._used.add(alpha)
            opacity = _fractions(table[alpha])
            if (opacity < 1.0).any():
                channels.append(opacity)
        made = np.stack(channels, axis=1)
        if not np.isfinite(made).all():
            self._notes.slip(f"colours of {where} that are not finite are set to 0")
            made = np.where(np.isfinite(made), made, np.float32(0.0))
        return made

    def _normals(self) -> NDArray[np.float32] | None:
        """Unit normals; None where one has no length."""
        given = self._columns(_NORMAL, self._vertices, "f4")
        if given is None:
            return None
        squared = np.einsum("ij,ij->i", given, given)
        if not (np.isfinite(squared) & (squared > 0.0)).all():
            self._notes.add("some normals have no length: all are replaced by those of the surface")
            return None
        if np.abs(squared - 1.0).max() > 1e-5:
            given /= np.sqrt(squared)[:, None]
        return given

    def _uvs(self) -> NDArray[np.float32] | None:
        names = next((names for names in _UVS if all(name in self._vertices for name in names)), None)
        return None if names is None else _finite(self._columns(names, self._vertices, "f4"))

    def _corner_uvs(self, faces: _Faces) -> tuple[NDArray[np.float32], Indices] | None:
        """Texture coordinates of the faces' corners."""
        texcoords = self._face_rows.lists.get("texcoord")
        name = next((name for name in _CORNERS if name in self._face_rows.lists), "")
        if texcoords is None or not (texcoords.counts == 2 * self._face_rows.lists[name].counts).all():
            return None
        return _finite(texcoords.values.astype(np.float32).reshape(-1, 2)), faces.of_corners().astype(np.int32)

    def _scalars(self, kept: NDArray[np.bool_] | None = None) -> dict[str, NDArray[np.float32]]:
        """Vertex properties that are nothing else."""
        made = {}
        for name, values in self._vertices.items():
            if name not in self._used:
                with np.errstate(over="ignore"):
                    made[name] = np.asarray(values if kept is None else values[kept], dtype=np.float32)
        return made

    def _material(self, colors: NDArray[np.float32] | None, textured: bool) -> Material:
        texture = self._texture() if textured else None
        if colors is None:
            return Lambert() if texture is None else Lambert((1.0, 1.0, 1.0), texture=texture)
        # The colours say it all, alpha included.
        return Lambert((1.0, 1.0, 1.0), texture=texture, alpha_mode="blend" if colors.shape[1] == 4 else "opaque")

    def _texture(self) -> Texture | None:
        name = next((line.split(None, 1)[1].strip() for line in self._header.comments if line.startswith("TextureFile ")), "")
        if not name:
            return None
        try:
            give = lambda: self._sources.read_beside(name)  # noqa: E731
            return Texture(Pictures(self._limits).texels(name, give, srgb=True, name=Path(name).name))
        except LimnerError as error:
            self._notes.slip(f"drawn without its texture {quoted(name)}: {without_path(error)}")
            return None

    # What it is

    def _surface(self, positions: NDArray[np.float32], faces: _Faces) -> Shape:
        normals, uvs, colors = self._normals(), self._uvs(), self._colors(self._vertices, "vertices")
        uv_triangles: Indices | None = None
        corner_uvs = self._corner_uvs(faces)
        if corner_uvs is not None:
            uvs, uv_triangles = corner_uvs
        scalars = self._scalars()
        triangles = faces.triangles
        face_colors = self._colors(self._face_rows.columns, "faces") if colors is None else None
        normal_triangles: Indices | None = None
        if normals is None:
            normals, normal_triangles = crease_normals(positions, triangles, CREASE_DEGREES)
        if face_colors is not None:
            # Each face has a colour of its own: no position can be shared.
            corner = triangles.reshape(-1)
            if normal_triangles is None:
                normal_triangles = triangles
            if uvs is not None and uv_triangles is None:
                uv_triangles = triangles
            colors = np.repeat(face_colors[faces.of_faces()], 3, axis=0)
            positions, scalars = positions[corner], {name: values[corner] for name, values in scalars.items()}
            triangles = np.arange(len(corner), dtype=np.int32).reshape(-1, 3)
        mesh = Mesh(
            positions, triangles, normals=normals, normal_triangles=normal_triangles, uvs=uvs, uv_triangles=uv_triangles,
            colors=colors, scalars=scalars, name=self._name,
        )  # fmt: skip
        return Shape(mesh, (self._material(colors, uvs is not None),))

    def _cloud(self, positions: NDArray[np.float32]) -> Shape:
        finite = finite_rows(positions)
        kept = None if finite.all() else finite
        if kept is not None:
            self._notes.slip(f"{int((~finite).sum())} of {len(finite)} points are not finite and are left out")
            if not finite.any():
                raise FileFormatError("none of its points is finite", self._path)

        def rows(values: NDArray[Any] | None) -> NDArray[Any] | None:
            return values if values is None or kept is None else values[kept]

        normals, colors = self._columns(_NORMAL, self._vertices, "f4"), self._colors(self._vertices, "points")
        radii = self._radii(kept)
        cloud = PointCloud(
            np.asarray(rows(positions)), rows(colors), rows(normals), radii, scalars=self._scalars(kept), name=self._name
        )
        return Shape(cloud, (self._material(colors, False),))

    def _radii(self, kept: NDArray[np.bool_] | None) -> NDArray[np.float32] | None:
        name = next((name for name in _RADII if name in self._vertices), None)
        if name is None:
            return None
        radii = np.asarray(self._vertices[name] if kept is None else self._vertices[name][kept], dtype=np.float32)
        if not (np.isfinite(radii) & (radii > 0.0)).all():
            self._notes.slip(f"its {name} are not all positive; points are drawn as large as they are apart")
            return None
        self._used.add(name)
        return radii


def _from_strips(corners: NDArray[Any]) -> _Faces:
    """The triangles of strips that end at -1: every second one is turned, so that all face the same way."""
    values = corners.astype(np.int64)
    at = np.arange(len(values))
    start = np.maximum.accumulate(np.where(values == -1, at + 1, 0))
    odd = (at - start) % 2
    first = at[: max(len(values) - 2, 0)]
    turned = odd[: len(first)]
    corner = np.stack([first, first + 1 + turned, first + 2 - turned], axis=1)
    triangles = values[corner]
    a, b, c = triangles.T
    kept = (triangles != -1).all(axis=1) & (a != b) & (b != c) & (c != a)
    return _Faces(triangles[kept].astype(np.int32), np.zeros(int(kept.sum()), np.int64), corner[kept])


def _fractions(values: NDArray[Any]) -> NDArray[np.float32]:
    """Integers as fractions of their greatest; floats beyond 1 as bytes."""
    if values.dtype.kind == "u":
        return values.astype(np.float32) / np.float32(np.iinfo(values.dtype).max)
    floats = values.astype(np.float32)
    # Integers of text, and signed ones, mean bytes as well.
    return floats / np.float32(255.0) if values.dtype.kind == "i" or np.nanmax(floats, initial=0.0) > 1.0 else floats


def _decoded(values: NDArray[Any]) -> NDArray[np.float32]:
    if values.dtype == np.uint8:
        return SRGB_DECODE[values]
    with np.errstate(invalid="ignore"):
        return linear_from_srgb(_fractions(values)).astype(np.float32)


def _finite(values: NDArray[np.float32] | None) -> NDArray[np.float32]:
    assert values is not None
    return np.nan_to_num(values, posinf=0.0, neginf=0.0)
