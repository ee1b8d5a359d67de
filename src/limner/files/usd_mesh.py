"""Geometries of USD: polygons, surfaces of subdivision, points, curves and exact shapes.

A mesh of USD is subdivided by Catmull and Clark unless it says "none"; here it is twice. What lives on it (`primvars`) has one value for
all of it, for a face, for a vertex or for the corner of a face, and stays where it is: our meshes index each of these separately.

**Source**: OpenUSD, UsdGeom, *Mesh* and *PrimvarsAPI*.
"""

from __future__ import annotations

import dataclasses
import importlib
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from ..linear.transform import rotate
from ..mesh.mesh import Mesh
from ..mesh.polygons import triangulate
from ..mesh.shapes.revolution import capsule
from ..scene.line_set import LineSet
from ..scene.points import PointCloud
from ..scene.rig import Morph
from ..scene.shape import Box, Cone, Cylinder, Geometry, Shape, Sphere
from .notes import Notes
from .sources import Sources
from .triangles import finite_rows
from .usd_curves import Chords, chords
from .usd_curves import n_ends as ends_of_pieces

if TYPE_CHECKING:
    from .usd import Modules
    from .usd_material import Materials

__all__ = ["Geometries", "Standing", "along_axis"]

LEVELS = 2
"""How often surfaces of subdivision are divided."""

_MOST_DIVIDED = 1_000_000  # triangles of one mesh after that; larger ones are divided less
_UVS = ("st", "UVMap", "uv", "st0", "map1", "Texture_uv")  # what texture coordinates are called, the likeliest first
_MOST_MOVED = 20_000_000  # positions of all morphs of one mesh
_SHARP = 10.0  # what USD calls a crease that stays for ever

Floats = NDArray[np.float32]
Indices = NDArray[np.int64]


class Standing(NamedTuple):
    """A shape, how it is turned in its node where it is, and at which time codes it is at rest, then in each of its morphs."""

    shape: Shape
    node_from_shape: NDArray[np.float64] | None = None
    codes: tuple[float, ...] = ()


class _Faces(NamedTuple):
    """Triangles as the corners of the file's faces that they join, (m, 3); the face of each, (m,); the position at each corner."""

    corners: Indices
    face: Indices
    positions_of: Indices


class _Values(NamedTuple):
    """Values of a primvar, (n, k), and what there is one of: "constant", "uniform", "vertex" or "faceVarying"."""

    values: Floats
    of: str


def along_axis(axis: str) -> NDArray[np.float64] | None:
    """The turn that takes +y, along which our shapes stand, to an axis of the file; None: none is needed.

    >>> along_axis("X")[:3, 1].round(6).tolist()
    [1.0, 0.0, 0.0]
    """
    if axis == "X":
        return rotate((0.0, 0.0, 1.0), -np.pi / 2.0)
    return rotate((1.0, 0.0, 0.0), np.pi / 2.0) if axis == "Z" else None


class Geometries:
    """The geometries of one stage."""

    def __init__(self, modules: Modules, sources: Sources, notes: Notes, time: Any) -> None:
        self._usd = modules.UsdGeom
        self._shading = modules.UsdShade
        self._limits = sources.limits
        self._path = sources.path
        self._notes = notes
        self._time = time
        self._n_vertices = 0
        self._n_triangles = 0

    def shapes(self, prim: Any, bound: Any, materials: Materials) -> tuple[Standing, ...]:
        """What a prim shows; nothing where it is no geometry."""
        if not prim.IsA(self._usd.Gprim):
            return ()
        where = str(prim.GetPath())
        moves = prim.IsA(self._usd.PointBased) and self._usd.PointBased(prim).GetPointsAttr().ValueMightBeTimeVarying()
        if moves and not prim.IsA(self._usd.Mesh):
            self._notes.add("points that move are shown where they are at first; it does not move", where)
        if prim.IsA(self._usd.Mesh):
            return self._mesh(prim, bound, materials)
        made = self._other(prim)
        if made is None:
            self._notes.slip(f"{prim.GetTypeName()} is not supported and is left out", where, what=str(prim.GetTypeName()))
            return ()
        geometry, turn = made
        plain, alpha = self._display_color(prim)
        material = materials.of(bound, plain if getattr(geometry, "colors", None) is None else (1.0, 1.0, 1.0), alpha)
        return (Standing(Shape(geometry, (material,)), turn),)

    def _other(self, prim: Any) -> tuple[Geometry, NDArray[np.float64] | None] | None:
        kind, usd, time = str(prim.GetTypeName()), self._usd, self._time

        def number(name: str) -> float:
            return float(prim.GetAttribute(name).Get(time))

        if kind == "Sphere":
            return Sphere(number("radius")), None
        if kind == "Cube":
            return Box((number("size"),) * 3), None
        if kind in ("Cylinder", "Cone"):
            made = (Cylinder if kind == "Cylinder" else Cone)(number("radius"), number("height"))
            return made, along_axis(str(prim.GetAttribute("axis").Get(time)))
        if kind == "Capsule":
            mesh = dataclasses.replace(capsule(number("radius"), number("height")), name=prim.GetName())
            return mesh, along_axis(str(prim.GetAttribute("axis").Get(time)))
        if kind == "Plane":
            across, along = number("width") / 2.0, number("length") / 2.0
            corners = np.array([[-across, 0, along], [across, 0, along], [across, 0, -along], [-across, 0, -along]])
            uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
            mesh = Mesh(corners.astype(np.float32), np.array([[0, 1, 2], [0, 2, 3]]), uvs=uvs.astype(np.float32), name=prim.GetName())
            return mesh, along_axis(str(prim.GetAttribute("axis").Get(time)))
        if kind == "Points":
            return self._points(prim), None
        return (self._curves(prim), None) if prim.IsA(usd.BasisCurves) else None

    def _positions(self, prim: Any) -> Floats:
        given = self._usd.PointBased(prim).GetPointsAttr().Get(self._time)
        positions = np.array(given if given is not None else [], dtype=np.float32).reshape(-1, 3)
        self._n_vertices += len(positions)
        if self._n_vertices > self._limits.max_vertices:
            raise FileFormatError(f"exceeds the limit of {self._limits.max_vertices} vertices (max_vertices)", self._path)
        return positions

    def _points(self, prim: Any) -> PointCloud:
        positions = self._positions(prim)
        widths = self._usd.Points(prim).GetWidthsAttr().Get(self._time)
        count = len(positions)
        return PointCloud(positions, self._colors_of_vertices(prim, count), radii=_radii(widths, count), name=prim.GetName())

    def _curves(self, prim: Any) -> LineSet:
        curves, time = self._usd.BasisCurves(prim), self._time
        positions = self._positions(prim)
        counts = np.array(curves.GetCurveVertexCountsAttr().Get(time) or [len(positions)], dtype=np.int64)
        counts = counts[(counts > 0) & (np.cumsum(counts) <= len(positions))]
        if str(curves.GetTypeAttr().Get(time)) != "linear":
            basis = str(curves.GetBasisAttr().Get(time))
            if basis in ("bezier", "bspline", "catmullRom"):
                return self._cubic_curves(prim, positions, counts, basis)
            text = f"curves of the basis {basis} are shown as the lines through their control points"
            self._notes.add(text, str(prim.GetPath()), kind="approximated")
        starts = np.cumsum(counts) - counts
        first = np.concatenate([start + np.arange(max(n - 1, 0)) for start, n in zip(starts, counts, strict=True)] or [np.zeros(0)])
        segments = np.stack([first, first + 1], axis=1)
        if str(curves.GetWrapAttr().Get(time)) == "periodic":
            segments = np.concatenate([segments, np.stack([starts + counts - 1, starts], axis=1)[counts > 2]])
        widths = curves.GetWidthsAttr().Get(time)
        colors = self._colors_of_vertices(prim, len(positions))
        return LineSet(positions, segments.astype(np.int32), colors, _radii(widths, len(positions)), name=prim.GetName())

    def _cubic_curves(self, prim: Any, positions: Floats, counts: Indices, basis: str) -> LineSet:
        """Curves as chords; widths and colours of their points go as they do, those of the ends of their pieces straight."""
        curves, where = self._usd.BasisCurves(prim), str(prim.GetPath())
        wrap = str(curves.GetWrapAttr().Get(self._time))
        if wrap not in ("nonperiodic", "periodic", "pinned"):
            wrap = "nonperiodic"
        n_ends = ends_of_pieces(counts, basis, wrap)
        radii = _radii(curves.GetWidthsAttr().Get(self._time), -1)
        widths = np.array(curves.GetWidthsAttr().Get(self._time) or [], dtype=np.float32).reshape(-1, 1)
        colors = self._primvar(prim, "displayColor")
        given = [values for values in (widths, None if colors is None else colors.values[:, :3]) if values is not None]
        of_points, of_ends = (
            [values if len(values) == n and n > 1 else None for values in given] for n in (len(positions), n_ends)
        )  # fmt: skip
        made = chords(positions, counts, basis, wrap, _side_by_side(of_points), _side_by_side(of_ends))
        if made.n_left_out:
            self._notes.slip(f"{made.n_left_out} curves of too few points are left out", where)
        along = None if radii is None else _column(made, of_points, of_ends, 0)
        if along is not None:
            radii = np.maximum(along[:, 0] / 2.0, 1e-6 * widths.max()).astype(np.float32)
        shown = _column(made, of_points, of_ends, 1) if colors is not None else None
        rgb = None if shown is None else np.clip(shown, 0.0, None).astype(np.float32)
        return LineSet(made.positions, made.segments, rgb, radii, name=prim.GetName())

    def _colors_of_vertices(self, prim: Any, count: int) -> Floats | None:
        given = self._primvar(prim, "displayColor")
        return given.values[:, :3] if given is not None and given.of == "vertex" and len(given.values) == count else None

    # Meshes

    def _mesh(self, prim: Any, bound: Any, materials: Materials) -> tuple[Standing, ...]:
        where, name = str(prim.GetPath()), prim.GetName()
        usd, time = self._usd.Mesh(prim), self._time
        positions = self._positions(prim)
        counts = np.array(usd.GetFaceVertexCountsAttr().Get(time) or [], dtype=np.int64)
        indices = np.array(usd.GetFaceVertexIndicesAttr().Get(time) or [], dtype=np.int64)
        if not len(counts) or not len(positions) or int(counts.clip(0).sum()) > len(indices):
            self._notes.slip("a mesh without faces, or whose faces have too few indices, is left out", where)
            return ()
        faces = self._cut(positions, counts, indices, prim)
        self._n_triangles += len(faces.face)
        if self._n_triangles > self._limits.max_triangles:
            raise FileFormatError(f"exceeds the limit of {self._limits.max_triangles} triangles (max_triangles)", self._path)
        if not len(faces.face):
            self._notes.slip("a mesh without faces that can be shown is left out", where)
            return ()
        positions = np.where(finite_rows(positions)[:, None], positions, np.float32(0.0))
        codes, moved = self._moved(usd, positions)
        slots, used = self._materials_of_faces(prim, bound, len(counts))
        scheme = str(usd.GetSubdivisionSchemeAttr().Get(time))
        divides = scheme in ("catmullClark", "loop")
        display = self._primvar(prim, "displayColor")
        reads_display = any(materials.reads_display_color(one) for one in used)
        per_corner = reads_display and not divides and display is not None and display.of in ("uniform", "faceVarying")
        if per_corner:
            # One colour for a corner needs a position for it.
            positions, moved = positions[faces.positions_of], [points[faces.positions_of] for points in moved]
            faces = faces._replace(positions_of=np.arange(len(faces.positions_of)))
        triangles = faces.positions_of[faces.corners].astype(np.int32)
        uvs, uv_triangles = self._texture_coordinates(prim, materials.coordinates_of(used), faces, triangles)
        normals, normal_triangles = (None, None) if divides else self._normals(prim, faces, triangles)
        mesh = Mesh(
            positions, triangles,
            normals=normals, normal_triangles=normal_triangles, uvs=uvs, uv_triangles=uv_triangles,
            colors=self._colors(display, faces, len(positions), prim) if reads_display else None,
            triangle_materials=None if slots is None else slots[faces.face].astype(np.int32), name=name,
        )  # fmt: skip
        if str(usd.GetOrientationAttr().Get(time)) == "leftHanded":
            mesh = _turned(mesh)
        bare, morphs = mesh, list[Morph]()
        if divides:
            mesh = self._divided(bare, usd, scheme, faces, where)
        if (len(codes) - 1) * len(mesh.positions) > _MOST_MOVED:
            self._notes.add("a mesh that moves in too many ways is shown where it is at first; it does not move", where)
            codes, moved = (), []
        for points in moved:
            bent = dataclasses.replace(bare, positions=points)
            morphs.append(_morph(mesh, self._divided(bent, usd, scheme, faces, where, again=True) if divides else bent))
        plain, alpha = self._display_color(prim)
        color = (1.0, 1.0, 1.0) if mesh.colors is not None else plain
        return (Standing(Shape(mesh, tuple(materials.of(one, color, alpha) for one in used), tuple(morphs)), None, codes),)

    def _moved(self, usd: Any, positions: Floats) -> tuple[tuple[float, ...], list[Floats]]:
        """At which time codes the points of a mesh are told, and where they are from the second on; nothing where they stay."""
        attribute = usd.GetPointsAttr()
        codes = tuple(map(float, attribute.GetTimeSamples()))
        if len(codes) < 2 or (len(codes) - 1) * len(positions) > _MOST_MOVED:
            if len(codes) > 1:
                self._notes.add("a mesh that moves in too many ways is shown where it is at first; it does not move", str(usd.GetPath()))
            return (), []
        found = [np.array(attribute.Get(code), dtype=np.float32).reshape(-1, 3) for code in codes[1:]]
        if any(len(points) != len(positions) or not np.isfinite(points).all() for points in found):
            self._notes.add("a mesh whose points come and go does not move", str(usd.GetPath()))
            return (), []
        return codes, found

    def _cut(self, positions: Floats, counts: Indices, indices: Indices, prim: Any) -> _Faces:
        """Cut faces into triangles; what has no place is left out."""
        starts = np.cumsum(counts) - counts
        finite = finite_rows(positions)
        safe = np.clip(indices, 0, len(positions) - 1)
        sound = (indices == safe) & finite[safe]
        holes = self._usd.Mesh(prim).GetHoleIndicesAttr().Get(self._time)
        kept = counts >= 3
        kept[np.array(holes or [], dtype=np.int64).clip(0, len(counts) - 1)] = False
        corners, owners, n_bad = [], [], 0
        for size in np.unique(counts[kept]).tolist():
            chosen = np.flatnonzero(kept & (counts == size))
            around = starts[chosen, None] + np.arange(size)
            good = sound[around].all(axis=1)
            n_bad += int((~good).sum())
            chosen, around = chosen[good], around[good]
            if not len(chosen):
                continue
            cut, _ = triangulate(positions[indices[around]].astype(np.float64))
            corners.append(around[np.arange(len(chosen))[:, None, None], cut].reshape(-1, 3))
            owners.append(np.repeat(chosen, size - 2))
        if n_bad:
            self._notes.slip(f"{n_bad} faces that refer to no finite point are left out", str(prim.GetPath()))
        if not corners:
            return _Faces(np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64), safe)
        face = np.concatenate(owners)
        order = np.argsort(face, kind="stable")
        return _Faces(np.concatenate(corners)[order], face[order], safe)

    def _materials_of_faces(self, prim: Any, bound: Any, n_faces: int) -> tuple[Indices | None, list[Any]]:
        """The slot of each face, None where all have one, and the material prims of the slots; None: none is bound."""
        subsets = self._shading.MaterialBindingAPI(prim).GetMaterialBindSubsets()
        slots, used = np.zeros(n_faces, dtype=np.int64), [bound]
        for subset in subsets:
            material = self._shading.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0].GetPrim()
            chosen = np.array(subset.GetIndicesAttr().Get(self._time) or [], dtype=np.int64)
            slots[chosen[(chosen >= 0) & (chosen < n_faces)]] = len(used)
            used.append(material if material else bound)
        return (slots, used) if len(used) > 1 else (None, used)

    def _divided(self, mesh: Mesh, usd: Any, scheme: str, faces: _Faces, where: str, *, again: bool = False) -> Mesh:
        """A mesh as smooth as it means to be; `again`: its triangles have been counted."""
        levels = LEVELS
        while levels and len(mesh.triangles) * 4**levels > _MOST_DIVIDED:
            levels -= 1
        self._n_triangles += 0 if again else len(mesh.triangles) * (4**levels - 1)
        if not levels or self._n_triangles > self._limits.max_triangles:
            self._notes.add("a large surface of subdivision is shown as its faces", where, kind="approximated")
            return mesh
        self._notes.add(f"surfaces of subdivision are divided {levels} times", where, kind="approximated")
        rules = importlib.import_module("..mesh.subdivide", __package__)
        boundary = str(usd.GetInterpolateBoundaryAttr().Get(self._time))
        linear = str(usd.GetFaceVaryingLinearInterpolationAttr().Get(self._time)) == "all"
        if scheme == "loop" and (np.bincount(faces.face) <= 1).all():
            made: Mesh = rules.loop(mesh, levels)
            return made
        mesh = dataclasses.replace(mesh, face_attributes={"polygon": faces.face.astype(np.int32)})
        creases, sharpness = self._creases(usd)
        here = np.isin(_edge_keys(creases), _edge_keys(_sides(mesh, faces)))
        made = rules.catmull_clark(
            mesh, levels, polygons=faces.face, creases=creases[here], sharpness=sharpness[here], limit=True,
            keep_corners=boundary == "edgeAndCorner", uv_rule="linear" if linear else "smooth",
        )  # fmt: skip
        return dataclasses.replace(made, face_attributes=None)

    def _creases(self, usd: Any) -> tuple[Indices, NDArray[np.float64]]:
        """Edges that stay sharp, (k, 2), and for how long."""
        time = self._time
        indices = np.array(usd.GetCreaseIndicesAttr().Get(time) or [], dtype=np.int64)
        lengths = np.array(usd.GetCreaseLengthsAttr().Get(time) or [], dtype=np.int64)
        given = np.array(usd.GetCreaseSharpnessesAttr().Get(time) or [], dtype=np.float64)
        if usd.GetCornerIndicesAttr().Get(time):
            self._notes.add("corners that stay sharp are ignored", str(usd.GetPrim().GetPath()))
        ends, sharpness = [], []
        start = k = 0
        for length in lengths.tolist():
            chain = indices[start : start + length]
            start += length
            n_edges = max(len(chain) - 1, 0)
            ends.append(np.stack([chain[:-1], chain[1:]], axis=1))
            per_edge = len(given) != len(lengths)
            own = given[k : k + (n_edges if per_edge else 1)]
            k += n_edges if per_edge else 1
            sharpness.append(np.broadcast_to(own, n_edges) if len(own) in (1, n_edges) and n_edges else np.full(n_edges, _SHARP))
        if not ends:
            return np.zeros((0, 2), dtype=np.int64), np.zeros(0)
        all_sharp = np.concatenate(sharpness)
        return np.concatenate(ends), np.where(all_sharp >= _SHARP, np.inf, np.maximum(all_sharp, 0.0))

    # What lives on meshes

    def _primvar(self, prim: Any, name: str) -> _Values | None:
        found = self._usd.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        if not found or not found.HasValue():
            return None
        given = found.ComputeFlattened(self._time)
        if given is None:
            return None
        values = np.array(given, dtype=np.float32)
        values = values.reshape(len(given), -1) if hasattr(given, "__len__") and values.ndim == 2 else values.reshape(-1, 1)
        if not np.isfinite(values).all():
            self._notes.slip(f"values of {name} that are not finite are set to 0", str(prim.GetPath()))
            values = np.nan_to_num(values, posinf=0.0, neginf=0.0)
        of = str(found.GetInterpolation())
        return _Values(values, "vertex" if of == "varying" else of) if len(values) else None

    @staticmethod
    def _placed(given: _Values, faces: _Faces, triangles: NDArray[Any]) -> tuple[Floats, NDArray[np.int32] | None] | None:
        """Values with what the triangles' corners have of them; None where there are too few."""
        if given.of == "vertex" and len(given.values) > int(triangles.max()):
            return given.values[: int(triangles.max()) + 1], None
        if given.of == "vertex" and len(given.values) > int(faces.positions_of.max()):
            return given.values, faces.positions_of[faces.corners].astype(np.int32)
        if given.of == "faceVarying" and len(given.values) > int(faces.corners.max()):
            return given.values, faces.corners.astype(np.int32)
        return None

    def _texture_coordinates(
        self, prim: Any, wanted: str, faces: _Faces, triangles: NDArray[Any]
    ) -> tuple[Floats | None, NDArray[np.int32] | None]:
        for name in dict.fromkeys((wanted, *_UVS)):
            given = self._primvar(prim, name) if name else None
            if given is not None and given.values.shape[1] == 2:
                placed = self._placed(given, faces, triangles)
                if placed is not None:
                    return placed
                self._notes.slip(f"drawn without {name}, which has too few values", str(prim.GetPath()))
        return None, None

    def _normals(self, prim: Any, faces: _Faces, triangles: NDArray[Any]) -> tuple[Floats | None, NDArray[np.int32] | None]:
        given = self._primvar(prim, "normals")
        if given is None:
            usd = self._usd.Mesh(prim)
            values = usd.GetNormalsAttr().Get(self._time)
            if not values:
                return None, None
            of = str(usd.GetNormalsInterpolation())
            given = _Values(np.nan_to_num(np.array(values, dtype=np.float32)), "vertex" if of == "varying" else of)
        if given.of == "uniform" or given.values.shape[1] != 3:
            return None, None
        placed = self._placed(given, faces, triangles)
        if placed is None:
            self._notes.slip("drawn without normals, which are too few", str(prim.GetPath()))
            return None, None
        length = np.linalg.norm(placed[0], axis=1, keepdims=True)
        unit = placed[0] / np.where(length > 0.0, length, 1.0)
        return np.where(length > 0.0, unit, np.array([0.0, 1.0, 0.0], dtype=np.float32)).astype(np.float32), placed[1]

    def _colors(self, given: _Values | None, faces: _Faces, n_positions: int, prim: Any) -> Floats | None:
        """Colours of positions; those of faces and corners as the mean of what meets there."""
        if given is None or given.values.shape[1] != 3 or given.of == "constant" or len(given.values) == 1:
            return None
        if given.of == "vertex":
            return given.values if len(given.values) == n_positions else None
        counts = np.array(self._usd.Mesh(prim).GetFaceVertexCountsAttr().Get(self._time), dtype=np.int64)
        n_corners = len(faces.positions_of)
        of_corners = np.repeat(given.values, counts, axis=0) if given.of == "uniform" and len(given.values) == len(counts) else given.values
        if len(of_corners) < n_corners:
            return None
        weights = np.maximum(np.bincount(faces.positions_of, minlength=n_positions), 1)
        summed = [np.bincount(faces.positions_of, of_corners[:n_corners, k], minlength=n_positions) for k in range(3)]
        return (np.stack(summed, axis=1) / weights[:, None]).astype(np.float32)

    def _display_color(self, prim: Any) -> tuple[tuple[float, float, float] | None, float]:
        """The one colour, None where there is none, and the opacity that a prim is shown in without a material."""
        color, opacity = self._primvar(prim, "displayColor"), self._primvar(prim, "displayOpacity")
        single = color is not None and len(color.values) == 1 and color.values.shape[1] == 3
        alpha = float(np.clip(opacity.values[0, 0], 0.0, 1.0)) if opacity is not None and len(opacity.values) == 1 else 1.0
        if not single or color is None:
            return None, alpha
        r, g, b = (float(k) for k in np.clip(color.values[0], 0.0, None))
        return (r, g, b), alpha


def _morph(mesh: Mesh, bent: Mesh) -> Morph:
    """From a mesh to what it becomes, whose rows are the same."""
    normals = None
    if mesh.normals is not None and bent.normals is not None and mesh.normals.shape == bent.normals.shape:
        normals = bent.normals - mesh.normals
    return Morph(bent.positions - mesh.positions, normals)


def _radii(widths: Any, count: int) -> float | Floats | None:
    """Half of what widths say; None where they say nothing that could be used."""
    given = np.array(widths if widths is not None else [], dtype=np.float32)
    if not len(given) or not (np.isfinite(given) & (given > 0.0)).all():
        return None
    return given / 2.0 if len(given) == count else float(given[0]) / 2.0


def _side_by_side(columns: list[Floats | None]) -> Floats | None:
    """Values that there are one after the other in each row; None: none are."""
    given = [column for column in columns if column is not None]
    return np.hstack(given) if given else None


def _column(made: Chords, of_points: list[Floats | None], of_ends: list[Floats | None], k: int) -> NDArray[np.float64] | None:
    """What became of the k-th values along curves; None where they were neither of points nor of ends."""
    for columns, values in ((of_points, made.of_points), (of_ends, made.of_ends)):
        column = columns[k]
        if column is not None and values is not None:
            first = sum(before.shape[1] for before in columns[:k] if before is not None)
            found: NDArray[np.float64] = values[:, first : first + column.shape[1]]
            return found
    return None


def _turned(mesh: Mesh) -> Mesh:
    """The mesh with its triangles the other way round."""

    def reverse(rows: NDArray[np.int32] | None) -> NDArray[np.int32] | None:
        return None if rows is None else np.ascontiguousarray(rows[:, ::-1])

    triangles = np.ascontiguousarray(mesh.triangles[:, ::-1])
    return dataclasses.replace(
        mesh, triangles=triangles, normal_triangles=reverse(mesh.normal_triangles), uv_triangles=reverse(mesh.uv_triangles)
    )


def _sides(mesh: Mesh, faces: _Faces) -> Indices:
    """(k, 2): the sides of a mesh's faces, which the cuts through them are not: they belong to two triangles of one face."""
    sides = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].astype(np.int64)
    _, edge = np.unique(_edge_keys(sides), return_inverse=True)
    keys = edge.reshape(-1, 3) * (int(faces.face.max()) + 1) + faces.face[:, None]
    _, first, n_times = np.unique(keys, return_index=True, return_counts=True)
    return np.asarray(sides.reshape(-1, 2)[first[n_times == 1]])


def _edge_keys(edges: Indices) -> Indices:
    """One number for an edge, whichever way it is written."""
    low, high = np.sort(edges.reshape(-1, 2), axis=1).astype(np.int64).T
    return np.asarray(low * (1 << 31) + high)

