"""What a node shows as glTF can hold it: triangles, lines or points.

Exact shapes, and what displacement moves, become the triangles that a picture of 1024 rows would be drawn with, each geometry once however
often it is shown. A plane without end becomes a square around what else there is.
"""

from __future__ import annotations

import dataclasses
import importlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linear.transform import transform_points
from ..mesh.mesh import Mesh
from ..scene.framing import extent_points, framing_camera
from ..scene.line_set import LINE_WIDTH, LineSet
from ..scene.material import Material, ShadowCatcher
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.shape import Combination, Plane, Shape
from .notes import Notes

__all__ = ["Shapes", "Shown"]

_ROWS = 1024
_EXTENTS = 10.0  # from the middle of a plane that has an end to its sides


class Shown(NamedTuple):
    """Triangles, lines or points with the materials that `triangle_materials` counts."""

    geometry: Mesh | PointCloud | LineSet
    materials: tuple[Material, ...]


class Shapes:
    """The geometries of a scene as they are written.

    The room that cuts exact shapes is looked up only where it is needed: most scenes are meshes, and writing those loads no compiler.

    Parameters
    ----------
    scene : Scene
        What decides how finely exact shapes are cut.
    """

    def __init__(self, scene: Scene, notes: Notes) -> None:
        self._scene = scene
        self._notes = notes
        self._made: dict[tuple[int, ...], tuple[Shape, Shown | None]] = {}
        self._sight: Any = None

    def of(self, shape: Shape, world_from_object: NDArray[np.float64], path: str) -> Shown | None:
        """Triangles, lines or points for a shape; None, with a note, where there is nothing that could be written."""
        geometry, displacement = shape.geometry, shape.displacement
        if displacement is not None and (shape.morphs or shape.binding is not None):
            self._notes.add("displacement of a mesh that bends is left out", path)
            displacement = None
        if displacement is None and isinstance(geometry, (Mesh, PointCloud, LineSet)):
            return self._plain(geometry, shape, path)
        # Leaves of a combination have materials of their own; of all else, what is cut does not depend on materials.
        is_mixed = isinstance(geometry, Combination)
        key = (id(geometry), id(displacement), *(map(id, shape.materials) if is_mixed else ()))
        if key not in self._made:
            self._made[key] = shape, self._cut(shape, world_from_object, path)
        made = self._made[key][1]
        return made if made is None or is_mixed else Shown(made.geometry, shape.materials)

    def _plain(self, geometry: Mesh | PointCloud | LineSet, shape: Shape, path: str) -> Shown | None:
        if isinstance(geometry, Mesh):
            if not len(geometry.triangles):
                self._notes.add("a mesh without triangles is left out", path)
                return None
            return Shown(geometry, shape.materials)
        if isinstance(geometry, LineSet):
            if geometry.radii is not None or geometry.width_pixels != LINE_WIDTH:
                self._notes.add("lines are written without their width", path)
            return Shown(geometry, shape.materials)
        if geometry.radii is not None or geometry.shown_as != ("spheres" if geometry.normals is None else "discs"):
            self._notes.add("points are written without their size", path)
        return Shown(geometry, shape.materials)

    def _cut(self, shape: Shape, matrix: NDArray[np.float64], path: str) -> Shown | None:
        if isinstance(shape.geometry, Plane):
            if isinstance(shape.materials[0], ShadowCatcher):
                self._notes.add("a ground that only catches shadows is left out", path)
                return None
            self._notes.add("a plane without end is written as a square", path)
            return Shown(self._square(matrix), shape.materials)
        room = importlib.import_module("..tables.stand_ins", __package__)
        if self._sight is None:
            camera = framing_camera(extent_points(self._scene), 1.0)
            self._sight = room.Sight(camera, _ROWS, _ROWS, self._scene.bounds())
        mesh: Mesh = room.tessellation(shape, matrix, self._sight, room.StandIns())
        kind = type(shape.geometry).__name__
        if shape.displacement is None:
            self._notes.add(f"{kind} is written as triangles", path)
        else:
            relief = importlib.import_module("..tables.relief", __package__)
            mesh = relief.Reliefs().get(shape, mesh, matrix, room.inverse(matrix), self._sight, path)
            self._notes.add("displacement is written as triangles", path)
        if not isinstance(shape.geometry, Mesh):
            mesh = dataclasses.replace(mesh, name=kind.lower())
        return Shown(mesh, room.materials_of(shape)) if len(mesh.triangles) else None

    def _square(self, matrix: NDArray[np.float64]) -> Mesh:
        """As large as makes no difference to what stands on it."""
        bounds = self._scene.bounds()
        bounds = bounds if np.isfinite(bounds).all() else np.array([[-1.0] * 3, [1.0] * 3])
        local = transform_points(np.linalg.pinv(matrix), np.array([bounds.mean(axis=0), *bounds]))
        side = _EXTENTS * max(float(np.linalg.norm(local[2] - local[1])), 1e-3)
        corners = np.array([(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]) * side + local[0, [0, 2]]
        positions = np.insert(corners, 1, 0.0, axis=1).astype(np.float32)
        uvs = (corners * (1.0, -1.0)).astype(np.float32)
        normals = np.tile(np.array([0.0, 1.0, 0.0], dtype=np.float32), (4, 1))
        return Mesh(positions, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), normals=normals, uvs=uvs, name="plane")
