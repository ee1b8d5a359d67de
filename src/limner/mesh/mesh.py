"""A triangle mesh: positions, triangles, and what lives on them (FoCG 12.1).

Positions are never split: a corner (one of a triangle's three) names its position, its normal and its texture coordinate by
separate indices, as OBJ does, so that the topology of the surface stays readable where normals or texture seams break. Where
an attribute is given per vertex its index array is left out and the triangles' own indices serve.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["Attributes", "Mesh", "named_scalars", "read_only"]

Floats = NDArray[np.float32]
Indices = NDArray[np.int32]


def read_only(array: Any, dtype: Any, columns: tuple[int, ...], name: str) -> NDArray[Any]:
    """Return `array` as a read-only C-contiguous array of the declared dtype with one of the given column counts.

    Raises SceneError, naming the field, where the shape does not fit or a number is no number.
    """
    try:
        made = np.array(array, dtype=dtype, order="C", copy=None)
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(f"{name} must be numbers of shape (n, {columns[0]}): {error}") from None
    if made.ndim == 1 and made.size == 0:
        made = made.reshape(0, columns[0])
    if made.ndim != 2 or made.shape[1] not in columns:
        expected = " or ".join(f"(n, {c})" for c in columns)
        raise SceneError(f"{name} must have shape {expected}, got {made.shape}")
    if made.flags.writeable:
        made = made if made.base is None and made is not array else made.view()
        made.flags.writeable = False
    return made


def named_scalars(given: Any, count: int, field: str) -> dict[str, NDArray[np.float32]] | None:
    """Return numbers by name, each as a read-only (count,) float32; None where there are none."""
    if not given:
        return None
    if not isinstance(given, Mapping):
        raise SceneError(f"{field} must map names to arrays, got {type(given).__name__}")
    made = {}
    for name, values in given.items():
        array = read_only(np.asarray(values).reshape(-1, 1), np.float32, (1,), f"{field}[{name!r}]").reshape(-1)
        if len(array) != count:
            raise SceneError(f"{field}[{name!r}] must have {count} numbers, got {len(array)}")
        made[str(name)] = array
    return made


class Attributes(dict[str, NDArray[Any]]):
    """Named arrays that cannot be changed; a dictionary in all else."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("attributes cannot be changed; dataclasses.replace makes a mesh with others")

    __setitem__ = __delitem__ = __ior__ = update = setdefault = pop = popitem = clear = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        # Filling it item by item, as a dictionary is copied and pickled, would be a change.
        return Attributes, (dict(self),)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles over shared positions.

    Parameters
    ----------
    positions : (n, 3) float32
        Object space, metres.
    triangles : (m, 3) int32
        Position indices, counter-clockwise seen from outside.
    normals : (k, 3) float32, optional
        Shading normals, unit; None: faceted.
    normal_triangles : (m, 3) int32, optional
        Normal indices of the corners; None: `triangles`.
    uvs : (k, 2) float32, optional
        First set of texture coordinates, v up.
    uv_triangles : (m, 3) int32, optional
        Texture coordinate indices of the corners; None: `triangles`.
    uvs1 : (k, 2) float32, optional
        Second set; it is indexed like the first.
    colors : (n, 3) or (n, 4) float32, optional
        Linear colour (and alpha) per position.
    tangents : (k, 4) float32, optional
        Unit tangent along u and the sign of the bitangent, indexed like the normals.
    triangle_materials : (m,) int32, optional
        Index into the materials of the shape that shows the mesh; None: all 0.
    name : str
    scalars : mapping of str to (n,) float32, optional
        What else is known at each position, by name, to be shown by `limner.color_by`.
    vertex_attributes, edge_attributes, face_attributes : mapping of str to array, optional
        Named values of whatever meaning: one row for each position, edge or triangle, numbers or booleans of any shape. Edges are counted
        and numbered as `limner.mesh.adjacency` does: once each, their lesser vertex first, in lexicographic order. No renderer looks at
        them; `limner.repair` keeps them.

    Raises SceneError where shapes do not fit, an index is out of range, or a position is not finite.
    """

    positions: Floats
    triangles: Indices
    normals: Floats | None = None
    normal_triangles: Indices | None = None
    uvs: Floats | None = None
    uv_triangles: Indices | None = None
    uvs1: Floats | None = None
    colors: Floats | None = None
    tangents: Floats | None = None
    triangle_materials: Indices | None = None
    name: str = ""
    scalars: Mapping[str, Floats] | None = None
    vertex_attributes: Mapping[str, NDArray[Any]] | None = None
    edge_attributes: Mapping[str, NDArray[Any]] | None = None
    face_attributes: Mapping[str, NDArray[Any]] | None = None

    def __post_init__(self) -> None:
        def put(field: str, value: Any) -> None:
            object.__setattr__(self, field, value)

        put("positions", read_only(self.positions, np.float32, (3,), "mesh.positions"))
        put("triangles", self._indices("triangles", len(self.positions)))
        if not np.isfinite(self.positions).all():
            bad = int(np.flatnonzero(~np.isfinite(self.positions).all(axis=1))[0])
            raise SceneError(f"mesh.positions must be finite, got {self.positions[bad]} at vertex {bad}", self.name)
        for field, columns in (("normals", (3,)), ("uvs", (2,)), ("uvs1", (2,)), ("colors", (3, 4)), ("tangents", (4,))):
            if getattr(self, field) is not None:
                put(field, read_only(getattr(self, field), np.float32, columns, f"mesh.{field}"))
        for field, index, default in (("normals", "normal_triangles", True), ("uvs", "uv_triangles", True)):
            values = getattr(self, field)
            if getattr(self, index) is not None:
                if values is None:
                    raise SceneError(f"mesh.{index} is given without mesh.{field}", self.name)
                put(index, self._indices(index, len(values)))
                if getattr(self, index).shape != self.triangles.shape:
                    raise SceneError(f"mesh.{index} must have the shape of mesh.triangles", self.name)
            elif values is not None and default and len(values) != len(self.positions):
                raise SceneError(
                    f"mesh.{field} must have one row per position ({len(self.positions)}) or come with {index}, got {len(values)}",
                    self.name,
                )
        if self.colors is not None and len(self.colors) != len(self.positions):
            raise SceneError(f"mesh.colors must have one row per position, got {len(self.colors)}", self.name)
        if self.uvs1 is not None and (self.uvs is None or len(self.uvs1) != len(self.uvs)):
            raise SceneError("mesh.uvs1 must have as many rows as mesh.uvs", self.name)
        if self.tangents is not None and (self.normals is None or len(self.tangents) != len(self.normals)):
            raise SceneError("mesh.tangents must have as many rows as mesh.normals", self.name)
        put("scalars", named_scalars(self.scalars, len(self.positions), "mesh.scalars"))
        if self.triangle_materials is not None:
            slots = np.array(self.triangle_materials, dtype=np.int32, order="C").reshape(-1)
            if len(slots) != len(self.triangles) or (slots.size and slots.min() < 0):
                raise SceneError("mesh.triangle_materials must hold one index >= 0 per triangle", self.name)
            slots.flags.writeable = False
            put("triangle_materials", slots)
        for field, rows, one in (("vertex_attributes", self.positions, "position"), ("face_attributes", self.triangles, "triangle")):
            if getattr(self, field) is not None:
                put(field, self._attributes(field, len(rows), one))
        if self.edge_attributes is not None:
            put("edge_attributes", self._attributes("edge_attributes", self._n_edges(), "edge"))

    def _attributes(self, field: str, n_rows: int, one: str) -> Attributes | None:
        given = getattr(self, field)
        if not isinstance(given, Mapping):
            raise SceneError(f"mesh.{field} must map names to arrays, got {type(given).__name__}", self.name)
        made = {}
        for name, values in given.items():
            if not isinstance(name, str):
                raise SceneError(f"mesh.{field} must have names that are strings, got {name!r}", self.name)
            try:
                array = np.array(values, order="C")
            except ValueError as error:
                raise SceneError(f"mesh.{field}[{name!r}] must be an array: {error}", self.name) from None
            if array.dtype.kind not in "biufc":
                raise SceneError(f"mesh.{field}[{name!r}] must be numbers or booleans, got {array.dtype}", self.name)
            if array.ndim < 1 or len(array) != n_rows:
                raise SceneError(f"mesh.{field}[{name!r}] must have one row per {one} ({n_rows}), got shape {array.shape}", self.name)
            array.flags.writeable = False
            made[name] = array
        return Attributes(made) or None

    def _n_edges(self) -> int:
        from .adjacency import adjacency

        return len(adjacency(self).edges)

    def _indices(self, field: str, limit: int) -> NDArray[np.int32]:
        given = np.asarray(getattr(self, field))
        if given.size and given.dtype.kind not in "iu":
            raise SceneError(f"mesh.{field} must be integers, got {given.dtype}", self.name)
        if given.size and (int(given.min()) < 0 or int(given.max()) >= limit):
            row = int(np.flatnonzero(((given < 0) | (given >= limit)).reshape(len(given), -1).any(axis=1))[0])
            raise SceneError(f"mesh.{field} must lie in 0..{limit - 1}, got {given[row]} at triangle {row}", self.name)
        return read_only(given, np.int32, (3,), f"mesh.{field}")

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) float64: least and greatest corner of the positions that triangles use; (inf, -inf) where there are none."""
        if not len(self.triangles):
            return np.array([[np.inf] * 3, [-np.inf] * 3])
        used = np.zeros(len(self.positions), dtype=bool)
        used[self.triangles.reshape(-1)] = True
        points = self.positions if used.all() else self.positions[used]
        return np.array([points.min(axis=0), points.max(axis=0)], dtype=np.float64)

    def __repr__(self) -> str:
        return f"Mesh({self.name!r}, {len(self.positions)} positions, {len(self.triangles)} triangles)"
