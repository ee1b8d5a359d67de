"""Reading Wavefront OBJ with MTL, fast and to the letter.

    v 0 0 0        a position (and a colour)        f 1/1/1 2/2/1 3/3/1     a polygon: position / uv / normal, from 1
    vt 0 0         a texture coordinate             f -3 -2 -1              counted back from here
    vn 0 0 1       a normal                         usemtl red, o ball, s off
    l 1 2 3        a line through positions

`obj_text` parses; here indices are resolved, polygons cut, materials looked up, normals made. Corners keep their separate
indices: positions are never split at texture seams or creases.

**Source**: Alias/Wavefront, *Object Files (.obj)*, appendix B of the Advanced Visualizer manual (1995).
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import linear_from_srgb
from ..errors import FileFormatError, LimnerError
from ..mesh.mesh import Mesh
from ..scene.line_set import LineSet
from ..scene.material import Lambert, Material
from ..scene.node import Node
from ..scene.scene import Scene
from ..scene.shape import Shape
from .limits import DEFAULT, Limits
from .notes import Notes, quoted, without_path
from .obj_text import KINDS, Events, Faces, Text, read_faces, read_table
from .pictures import Pictures
from .polygon import triangulate
from .sources import Sources
from .triangles import count_degenerate, finite_rows

__all__ = ["CREASE_DEGREES", "read"]

CREASE_DEGREES = 40.0
# More smoothing groups than this in one mesh are not told apart.
MAX_SMOOTHING_GROUPS = 256
Integers = NDArray[np.int64]
Reals = NDArray[np.float64]


def read(
    data: bytes,
    path: str | os.PathLike[str],
    *,
    limits: Limits = DEFAULT,
    notes: Notes | None = None,
    sources: Sources | None = None,
) -> Scene:
    """Read the bytes of an .obj file; MTL libraries and textures are looked up beside it.

    One child node for each `o` that has faces, and one for each that has lines; groups only name it where there is none.
    Faces without normals get smooth ones that break at creases sharper than 40 degrees, or, where the file has smoothing groups, at their
    borders; those under ``s off`` stay faceted. Vertex colours are taken as sRGB-encoded, as MeshLab, ZBrush and Blender write them.

    Raises FileFormatError, with the line, where there is neither a face nor a line to be read.
    """
    notes = notes if notes is not None else Notes()
    sources = sources if sources is not None else Sources(path, limits)
    return _Reader(Text(data, path), sources, notes).scene()


class _Triangles(NamedTuple):
    """All triangles in the file's order.

    The line each comes from, (m,); the (position, uv, normal) of its corners, (m, 3, 3), counted from 0, -1 for none.
    """

    lines: Integers
    corners: Integers


class _Reader:
    """One OBJ file while it is read."""

    def __init__(self, text: Text, sources: Sources, notes: Notes) -> None:
        self._text = text
        self._sources = sources
        self._limits = sources.limits
        self._notes = notes
        self._n_degenerate = 0

    def scene(self) -> Scene:
        """Read everything."""
        self._events = Events(self._text, self._notes)
        self._check_limits()
        self._read_vertices()
        faces, bad = read_faces(self._text)
        segment_lines, segments = self._segments()
        triangles = self._triangles(faces, bad, needed=not len(segments))
        self._slots, self._materials = self._read_materials()
        nodes = tuple(self._node(name, part) for name, part in self._parts(triangles))
        nodes += tuple(self._line_nodes(segment_lines, segments))
        if self._n_degenerate:
            self._notes.slip(f"{self._n_degenerate} triangles have no area; they are kept")
        return Scene(Node(children=nodes), name=Path(self._text.path).stem, notes=self._notes.lines())

    def _check_limits(self) -> None:
        kind = self._text.kind
        n_vertices, is_face = int(np.count_nonzero(kind == KINDS[b"v"])), kind == KINDS[b"f"]
        n_triangles = int(np.maximum(self._text.n_numbers[is_face] - 2, 0).sum()) + sum(map(len, self._events.polylines))
        for found, limit, what in (
            (n_vertices, self._limits.max_vertices, "vertices"), (n_triangles, self._limits.max_triangles, "triangles")
        ):  # fmt: skip
            if found > limit:
                raise FileFormatError(f"has {found} {what}, the limit is {limit} (max_{what})", self._text.path)
        if not is_face.any() and not self._events.polylines:
            only = f", only {n_vertices} vertices" if n_vertices else ""
            raise FileFormatError(f"has no faces{only}", self._text.path)

    def _read_vertices(self) -> None:
        values, counts = read_table(self._text, b"v", 7)
        with np.errstate(over="ignore"):
            positions = values[:, :3].astype(np.float32)
        self._finite = finite_rows(positions)
        self._positions = np.where(self._finite[:, None], positions, np.float32(0.0)) if not self._finite.all() else positions
        self._colors = self._vertex_colors(values, counts)
        uvs = np.nan_to_num(read_table(self._text, b"vt", 2)[0], posinf=0.0, neginf=0.0)
        self._uvs = np.clip(uvs, -1e30, 1e30).astype(np.float32)
        self._normals = read_table(self._text, b"vn", 3)[0]

    def _vertex_colors(self, values: Reals, counts: Integers) -> NDArray[np.float32] | None:
        colored = counts >= 6
        if not colored.any():
            return None
        colors = np.where((counts >= 7)[:, None], values[:, 4:7], values[:, 3:6])
        # Seven numbers are either x y z w r g b or x y z r g b a; only a w of 1 tells.
        with_alpha = (counts >= 7) & (values[:, 3] != 1.0)
        colors = np.where(with_alpha[:, None], values[:, 3:6], colors)
        colors = np.where(colored[:, None] & np.isfinite(colors), colors, 1.0)
        if colors[colored].max() > 1.0:
            self._notes.add("vertex colours above 1 are read as fractions of 255")
            colors = np.where(colored[:, None], colors / 255.0, 1.0)
        return linear_from_srgb(colors).astype(np.float32)

    # Faces

    def _triangles(self, faces: list[Faces], malformed: list[int], needed: bool) -> _Triangles:
        lines, corners = [], []
        n_fans, beyond, lost = 0, [], []
        for group in faces:
            resolved = self._resolve(group)
            good = (resolved[:, :, 0] >= 0).all(axis=1)
            beyond.extend(group.lines[~good].tolist())
            resolved, kept_lines = (resolved, group.lines) if good.all() else (resolved[good], group.lines[good])
            if not self._finite.all():
                finite = self._finite[resolved[:, :, 0]].all(axis=1)
                lost.extend(kept_lines[~finite].tolist())
                resolved, kept_lines = resolved[finite], kept_lines[finite]
            if resolved.shape[1] == 3:
                lines.append(kept_lines)
                corners.append(resolved)
                continue
            cut, n_more_fans = triangulate(self._positions[resolved[:, :, 0]].astype(np.float64))
            n_fans += n_more_fans
            lines.append(np.repeat(kept_lines, cut.shape[1]))
            corners.append(resolved[np.arange(len(resolved))[:, None, None], cut].reshape(-1, 3, 3))
        self._note_faces(malformed + beyond, lost, n_fans)
        if not sum(map(len, lines)):
            if needed:
                raise self._no_face(malformed, beyond, lost)
            return _Triangles(np.zeros(0, dtype=np.int64), np.zeros((0, 3, 3), dtype=np.int64))
        if len(lines) == 1:
            return _Triangles(lines[0], corners[0])
        all_lines = np.concatenate(lines)
        order = np.argsort(all_lines, kind="stable")
        return _Triangles(all_lines[order], np.concatenate(corners)[order])

    def _no_face(self, malformed: list[int], beyond: list[int], lost: list[int]) -> FileFormatError:
        """What is wrong with the first face of a file that has no sound one."""
        if not malformed + beyond + lost:
            return FileFormatError("has neither faces nor lines that can be read", self._text.path)
        first = min(malformed + beyond + lost)
        if first in malformed:
            reason = "the first is not three or more corners of the form v, v/vt, v//vn or v/vt/vn"
        elif first in beyond:
            reason = f"the first refers to a vertex that is not there: the file has {len(self._positions)}"
        else:
            reason = "the first uses a position that is not finite"
        return FileFormatError(f"no face can be read; {reason}", self._text.path, f"line {self._text.number_of(first)}")

    def _resolve(self, group: Faces) -> Integers:
        """Turn indices from 1, or from behind, into indices from 0; -1 for none or one that does not exist."""
        resolved = np.empty_like(group.corners)
        totals = (len(self._positions), len(self._uvs), len(self._normals))
        for place, (keyword, total) in enumerate(zip((b"v", b"vt", b"vn"), totals, strict=True)):
            written = group.corners[:, :, place]
            index = written - 1
            if written.min(initial=0) < 0:
                before = np.searchsorted(np.flatnonzero(self._text.kind == KINDS[keyword]), group.lines)
                index = np.where(written < 0, before[:, None] + written, index)
            index[(written == 0) | (index < 0) | (index >= total)] = -1
            if place:
                absent = (index < 0).any(axis=1)
                wrong = absent & (written != 0).any(axis=1)
                if wrong.any():
                    what = "texture coordinates" if keyword == b"vt" else "normals"
                    first = self._text.number_of(int(group.lines[wrong].min()))
                    self._notes.slip(f"{int(wrong.sum())} faces lack some {what}; they are drawn without", f"line {first}")
                index[absent] = -1
            resolved[:, :, place] = index
        return resolved

    def _note_faces(self, bad: list[int], lost: list[int], n_fans: int) -> None:
        if bad:
            first = self._text.number_of(min(bad))
            self._notes.slip(f"{len(bad)} faces cannot be read and are left out, the first in line {first}")
        if lost:
            first = self._text.number_of(min(lost))
            self._notes.slip(f"{len(lost)} faces with positions that are no numbers are left out, the first in line {first}")
        if n_fans:
            self._notes.slip(f"{n_fans} large polygons are cut as if they were convex")

    # Materials

    def _read_materials(self) -> tuple[dict[str, int], list[Material]]:
        """Return the slots of the names that the file uses, and their materials; the last is that of faces without."""
        from .mtl import read_materials

        known: dict[str, Material] = {}
        pictures = Pictures(self._limits)
        for reference in self._events.libraries:
            try:
                for name, data in self._library(reference):
                    known.update(read_materials(data, name, self._sources, pictures, self._notes))
            except LimnerError as error:
                self._notes.slip(f"the materials of {quoted(reference)} are missing: {without_path(error)}")
        names = list(dict.fromkeys(self._events.material_names))
        for name in names:
            if name not in known:
                self._notes.add(f"material {quoted(name)} is not defined and drawn in grey")
        default = Lambert((0.8, 0.8, 0.8))
        materials = [known.get(name, Lambert((0.8, 0.8, 0.8), name=name)) for name in names]
        return {name: slot for slot, name in enumerate(names)}, [*materials, default]

    def _library(self, reference: str) -> Iterator[tuple[str, bytes]]:
        """The libraries that one `mtllib` names: a name with spaces, or several names."""
        try:
            yield reference, self._sources.read_beside(reference)
        except FileFormatError:
            names = reference.split()
            if len(names) < 2:
                raise
            for name in names:
                yield name, self._sources.read_beside(name)

    # Meshes

    def _parts(self, triangles: _Triangles) -> list[tuple[str, _Triangles]]:
        """Cut the triangles at the `o` lines; where fewer than two of them have faces, all is one part."""
        objects = self._events.objects
        slot = np.searchsorted(objects.lines, triangles.lines, side="right")
        used, starts = np.unique(slot, return_index=True)
        if len(used) > self._limits.max_nodes:
            text = f"has {len(used)} objects, the limit is {self._limits.max_nodes} (max_nodes)"
            raise FileFormatError(text, self._text.path)
        if not len(used):
            return []
        if len(used) == 1:
            name = objects.names[used[0] - 1] if used[0] else ""
            groups = list(dict.fromkeys(self._events.groups.names))
            return [(name or (groups[0] if len(groups) == 1 else "") or Path(self._text.path).stem, triangles)]
        ends = [*starts[1:].tolist(), len(slot)]
        return [
            (objects.names[s - 1] if s else "", _Triangles(triangles.lines[start:end], triangles.corners[start:end]))
            for s, start, end in zip(used.tolist(), starts.tolist(), ends, strict=True)
        ]

    def _node(self, name: str, part: _Triangles) -> Node:
        positions, triangles, kept = _used_rows(self._positions, part.corners[:, :, 0])
        self._n_degenerate += count_degenerate(positions, triangles)
        uvs, uv_triangles = self._mesh_uvs(part)
        normals, normal_triangles = self._mesh_normals(part, positions, triangles)
        slots, materials = self._mesh_materials(part)
        colors = None if self._colors is None else self._colors[kept]
        mesh = Mesh(
            positions, triangles.astype(np.int32),
            normals=normals, normal_triangles=normal_triangles, uvs=uvs, uv_triangles=uv_triangles,
            colors=colors, triangle_materials=slots, name=name,
        )  # fmt: skip
        return Node(name=name, shapes=(Shape(mesh, materials),))

    # Lines

    def _segments(self) -> tuple[Integers, Integers]:
        """The segments of all polylines: the line of the text that each comes from, (m,), and its ends, (m, 2)."""
        lines: list[int] = []
        found: list[tuple[int, int]] = []
        bad: list[int] = []
        rows = np.flatnonzero(self._text.kind == KINDS[b"v"])
        for line, written in zip(self._events.polyline_lines, self._events.polylines, strict=True):
            before = int(np.searchsorted(rows, line))
            places = [k - 1 if k > 0 else before + k if k < 0 else -1 for k in written]
            if len(places) < 2 or not all(0 <= k < len(rows) and self._finite[k] for k in places):
                bad.append(line)
                continue
            lines += [line] * (len(places) - 1)
            found += itertools.pairwise(places)
        if bad:
            first = self._text.number_of(bad[0])
            self._notes.slip(f"{len(bad)} lines cannot be read and are left out, the first in line {first}")
        return np.array(lines, dtype=np.int64), np.array(found, dtype=np.int64).reshape(-1, 2)

    def _line_nodes(self, lines: Integers, segments: Integers) -> Iterator[Node]:
        """One node for the lines of each object in each material."""
        objects = self._events.objects
        slot = np.searchsorted(objects.lines, lines, side="right")
        material = np.searchsorted(self._events.material_lines, lines, side="right") - 1
        for of, with_material in np.unique(np.stack([slot, material], axis=1), axis=0).tolist():
            positions, ends, kept = _used_rows(self._positions, segments[(slot == of) & (material == with_material)])
            name = (objects.names[of - 1] if of else "") or Path(self._text.path).stem
            colors = None if self._colors is None else self._colors[kept]
            own = len(self._slots) if with_material < 0 else self._slots[self._events.material_names[with_material]]
            shape = Shape(LineSet(positions, ends.astype(np.int32), colors, name=name), (self._materials[own],))
            yield Node(name=name, shapes=(shape,))

    def _mesh_uvs(self, part: _Triangles) -> tuple[NDArray[np.float32] | None, NDArray[np.int32] | None]:
        corners = part.corners[:, :, 1]
        without = corners[:, 0] < 0
        if without.all():
            return None, None
        uvs, indices, _ = _used_rows(self._uvs, np.where(without[:, None], 0, corners))
        if without.any():
            indices = np.where(without[:, None], len(uvs), indices)
            uvs = np.concatenate([uvs, np.zeros((1, 2), dtype=np.float32)])
        return uvs, indices.astype(np.int32)

    def _mesh_materials(self, part: _Triangles) -> tuple[NDArray[np.int32] | None, tuple[Material, ...]]:
        events = self._events
        event = np.searchsorted(events.material_lines, part.lines, side="right") - 1
        slot_of_event = np.array([*(self._slots[name] for name in events.material_names), len(self._slots)])
        used, slots = np.unique(slot_of_event[event], return_inverse=True)
        return slots.astype(np.int32) if len(used) > 1 else None, tuple(self._materials[slot] for slot in used.tolist())

    def _mesh_normals(
        self, part: _Triangles, positions: NDArray[np.float32], triangles: Integers
    ) -> tuple[NDArray[np.float32] | None, NDArray[np.int32] | None]:
        """Take the file's normals where it has them, facets under ``s off``, and smooth ones elsewhere."""
        corners = part.corners[:, :, 2]
        given = corners[:, 0] >= 0
        group = self._events.smoothing_of(part.lines)
        flat = ~given & (group == 0)
        if flat.all():
            return None, None
        pool: list[NDArray[np.float32]] = []
        indices = np.empty(triangles.shape, dtype=np.int64)
        n_pooled = 0

        def put(rows: NDArray[np.bool_], normals: NDArray[np.float32], own: Integers) -> None:
            nonlocal n_pooled
            indices[rows] = own + n_pooled
            pool.append(normals)
            n_pooled += len(normals)

        if given.any():
            raw, own, _ = _used_rows(self._normals, corners[given])
            unit, bad = _unit(raw)
            if bad.any():
                # A normal without length is none: its faces are smoothed like those that never had one.
                good = ~bad[own].any(axis=1)
                self._notes.add(f"{int(bad.sum())} normals without length are replaced by those of the surface")
                given[np.flatnonzero(given)[~good]] = False
                own = own[good]
            put(given, unit, own)
            flat = ~given & (group == 0)
        if flat.any():
            put(flat, _facet_normals(positions, triangles[flat]), np.repeat(np.arange(int(flat.sum())), 3).reshape(-1, 3))
        smooth = ~given & ~flat
        for rows, crease in self._smoothing_groups(group, smooth):
            put(rows, *_smooth_normals(positions, triangles[rows], crease))
        return np.concatenate(pool), indices.astype(np.int32)

    def _smoothing_groups(self, group: Integers, smooth: NDArray[np.bool_]) -> Iterator[tuple[NDArray[np.bool_], float]]:
        numbers = np.unique(group[smooth]).tolist()
        if len(numbers) > MAX_SMOOTHING_GROUPS:
            self._notes.add(f"{len(numbers)} smoothing groups are not told apart")
            yield smooth, CREASE_DEGREES
            return
        for number in numbers:
            # -1: the file does not say; a group that it does say is smooth throughout, its borders are the creases.
            yield smooth & (group == number), CREASE_DEGREES if number < 0 else 180.0


def _used_rows(values: NDArray[Any], indices: Integers) -> tuple[NDArray[Any], Integers, slice | Integers]:
    """Return the rows that `indices` use, the indices into those, and which they are; all where most are used."""
    first, last = int(indices.min()), int(indices.max()) + 1
    if 2 * indices.size >= last - first:
        return values[first:last], indices - first if first else indices, slice(first, last)
    kept, renumbered = np.unique(indices, return_inverse=True)
    return values[kept], renumbered.reshape(indices.shape), kept


def _unit(vectors: Reals) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Make vectors unit; also say which cannot be."""
    with np.errstate(all="ignore"):
        length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
        bad = ~((length > 0.0) & np.isfinite(length))
    unit = np.where(bad[:, None], 0.0, vectors) / np.where(bad, 1.0, length)[:, None]
    return unit.astype(np.float32), bad


def _facet_normals(positions: NDArray[np.float32], triangles: Integers) -> NDArray[np.float32]:
    a, b, c = (positions[triangles[:, corner]].astype(np.float64) for corner in range(3))
    unit, bad = _unit(np.cross(b - a, c - a))
    unit[bad] = (0.0, 1.0, 0.0)
    return unit


def _smooth_normals(positions: NDArray[np.float32], triangles: Integers, crease: float) -> tuple[NDArray[np.float32], Integers]:
    from ..mesh.normals import crease_normals

    normals, normal_triangles = crease_normals(positions, triangles.astype(np.int32), crease)
    return normals, normal_triangles.astype(np.int64)
