"""A scene as files of triangles hold it: no nodes, no instances, no formulas, all in one space.

Every shape becomes a mesh, or a cloud of points, where it stands in the world; one that is shown twice is there twice. Exact shapes
become the triangles that a picture of 1024 rows would be drawn with, displaced ones what they are displaced to, and bodies with joints
stand as they are posed. Infinite planes have no end and are left out.
"""

from __future__ import annotations

import dataclasses
import importlib
from typing import Any, NamedTuple
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerWarning, SceneError
from ..linear.transform import normal_matrix, transform_points
from ..mesh.mesh import Mesh
from ..scene.framing import extent_points, framing_camera
from ..scene.line_set import LineSet
from ..scene.material import BlinnPhong, Dielectric, Lambert, Material, MetallicRoughness
from ..scene.node import Placed
from ..scene.points import PointCloud
from ..scene.pose import posed
from ..scene.scene import Scene
from ..scene.shape import Plane, Shape

__all__ = ["Part", "base_color", "per_vertex", "world_parts"]

_ROWS = 1024


class Part(NamedTuple):
    """A shape in the world: the path of its node, its triangles, points or lines, and its materials."""

    name: str
    geometry: Mesh | PointCloud | LineSet
    materials: tuple[Material, ...]


def world_parts(scene: Scene, *, lines: bool = False) -> list[Part]:
    """Find what is visible, in the order of the graph, as meshes and clouds in the world; SceneError where that is nothing.

    Lines stay lines where `lines` says so, and are cut into tubes for files that have none.
    """
    cutter = _Cutter(scene)
    parts = []
    for placed, shape in posed(scene).shapes():
        geometry, matrix = shape.geometry, placed.world_from_object
        if isinstance(geometry, Plane):
            warn(f"{placed.path} is an infinite plane and is left out", LimnerWarning, stacklevel=4)
            continue
        kept = (Mesh, PointCloud, LineSet) if lines else (Mesh, PointCloud)
        if not isinstance(geometry, kept) or shape.displacement is not None:
            geometry = cutter.mesh(shape, placed)
        if len(geometry.positions):
            parts.append(Part(placed.path, _placed(geometry, matrix), shape.materials))
    if not parts:
        raise SceneError("there is nothing to save: no visible shape with triangles or points")
    return parts


class _Cutter:
    """Cuts what is no mesh into triangles, as a picture of the whole scene would need them.

    The room that does it is looked up only where it is needed: most models are meshes, and reading and writing those loads no compiler.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sight: Any = None

    def mesh(self, shape: Shape, placed: Placed) -> Mesh:
        """The triangles of a shape in its own space."""
        room = importlib.import_module("..tables.stand_ins", __package__)
        if self._sight is None:
            camera = framing_camera(extent_points(self._scene), 1.0)
            self._sight = room.Sight(camera, _ROWS, _ROWS, self._scene.bounds())
        matrix = placed.world_from_object
        mesh: Mesh = room.tessellation(shape, matrix, self._sight, room.StandIns())
        if shape.displacement is not None:
            relief = importlib.import_module("..tables.relief", __package__)
            mesh = relief.Reliefs().get(shape, mesh, matrix, room.inverse(matrix), self._sight, placed.path)
        return mesh


def _placed(geometry: Mesh | PointCloud | LineSet, matrix: NDArray[np.float64]) -> Mesh | PointCloud | LineSet:
    if isinstance(geometry, LineSet):
        return dataclasses.replace(geometry, positions=transform_points(matrix, geometry.positions.astype(np.float64)).astype(np.float32))
    if isinstance(geometry, PointCloud) and not geometry.shown.all():
        geometry = _finite(geometry)
    if np.array_equal(matrix, np.eye(4)):
        return geometry
    positions = transform_points(matrix, np.asarray(geometry.positions, dtype=np.float64)).astype(np.float32)
    normals = geometry.normals
    if normals is not None:
        turned = np.asarray(normals, dtype=np.float64) @ normal_matrix(matrix).T
        length = np.linalg.norm(turned, axis=1, keepdims=True)
        normals = (turned / np.where(length > 0.0, length, 1.0)).astype(np.float32)
    if isinstance(geometry, PointCloud):
        radii = geometry.point_radii * np.float32(abs(np.linalg.det(matrix[:3, :3])) ** (1.0 / 3.0))
        return dataclasses.replace(geometry, positions=positions, normals=normals, radii=radii if (radii > 0.0).all() else None)
    tangents = geometry.tangents
    if tangents is not None:
        along = tangents[:, :3].astype(np.float64) @ matrix[:3, :3].T
        length = np.linalg.norm(along, axis=1, keepdims=True)
        tangents = np.concatenate([along / np.where(length > 0.0, length, 1.0), tangents[:, 3:]], axis=1).astype(np.float32)
    made = dataclasses.replace(geometry, positions=positions, normals=normals, tangents=tangents)
    return _turned(made) if np.linalg.det(matrix[:3, :3]) < 0.0 else made


def _finite(cloud: PointCloud) -> PointCloud:
    """The points that are shown."""
    kept = cloud.shown
    radii = cloud.radii if cloud.radii is None or not np.ndim(cloud.radii) else np.asarray(cloud.radii)[kept]
    return PointCloud(
        cloud.positions[kept],
        None if cloud.colors is None else cloud.colors[kept],
        None if cloud.normals is None else cloud.normals[kept],
        radii,
        cloud.shown_as,
        {name: values[kept] for name, values in (cloud.scalars or {}).items()},
        cloud.name,
    )


def _turned(mesh: Mesh) -> Mesh:
    """The mesh with its triangles the other way round: a mirror turns them."""

    def reverse(indices: NDArray[np.int32] | None) -> NDArray[np.int32] | None:
        return None if indices is None else np.ascontiguousarray(indices[:, ::-1])

    return dataclasses.replace(
        mesh, triangles=np.ascontiguousarray(mesh.triangles[:, ::-1]), normal_triangles=reverse(mesh.normal_triangles),
        uv_triangles=reverse(mesh.uv_triangles),
    )  # fmt: skip


def per_vertex(values: NDArray[np.float32] | None, indices: NDArray[np.int32] | None, mesh: Mesh) -> NDArray[np.float32] | None:
    """One row per position of an attribute; None where there is none, or where corners at one position differ."""
    if values is None or indices is None or values.shape[0] == 0:
        return values if indices is None else None
    if np.array_equal(indices, mesh.triangles) and len(values) >= len(mesh.positions):
        return values[: len(mesh.positions)]
    return None


def base_color(material: Material) -> tuple[float, float, float]:
    """The colour that a material multiplies vertex colours with."""
    if isinstance(material, Lambert):
        return material.color
    if isinstance(material, BlinnPhong):
        return material.diffuse
    if isinstance(material, MetallicRoughness):
        return material.base_color
    return material.tint if isinstance(material, Dielectric) else (0.8, 0.8, 0.8)
