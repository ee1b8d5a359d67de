"""The scene graph into glTF (glTF 2.0, sections 3.5 and 3.7.3; KHR_node_visibility, EXT_mesh_gpu_instancing).

A node of glTF has one mesh, one camera and one light, where ours has any number; what does not fit stands below it, where it is. A place
is written as translation, rotation and scale where these make its matrix again, else as the matrix; one with shear, which glTF forbids,
as two nodes, one in the other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..linear.decompose import trs
from ..scene.node import Node, Placed
from ..scene.scene import Scene
from ..scene.shape import Shape
from .notes import Notes
from .write_gltf_buffers import Buffers, Json
from .write_gltf_camera import Cameras, Lights
from .write_gltf_exact import Parts, factors, nearest_parts, parts_of
from .write_gltf_material import identity, plain_text
from .write_gltf_mesh import Drawn, Meshes
from .write_gltf_shape import Shapes

__all__ = ["Graph", "Stand"]

_SHEAR = 1e-6  # cosine between axes from which on a matrix is not one that glTF allows
_FEWEST_INSTANCES = 2
_IDENTITY = np.eye(4)


class Stand(NamedTuple):
    """Where a node of the scene is in the file: its number, where it stands at rest, and the nodes that carry its meshes and how many
    morphs these have."""

    number: int
    rest: Parts | None
    carriers: list[tuple[int, int]]


class Graph:
    """The nodes of one file.

    Parameters
    ----------
    moving : mapping
        The paths of nodes that are animated, with what of their translation, rotation and scale stays as it is.
    told : set of str
        The paths of nodes whose visibility is animated.
    gpu_instancing : bool
        Write siblings that show one mesh as instances of it.
    """

    def __init__(
        self, scene: Scene, buffers: Buffers, meshes: Meshes, cameras: Cameras, lights: Lights, notes: Notes, *,
        moving: Mapping[str, Mapping[str, NDArray[np.float64]]], told: set[str], gpu_instancing: bool,
    ) -> None:  # fmt: skip
        self._scene = scene
        self._buffers = buffers
        self._meshes = meshes
        self._cameras = cameras
        self._lights = lights
        self._notes = notes
        self._moving = moving
        self._told = told
        self._gpu_instancing = gpu_instancing
        self._shapes = Shapes(scene, notes)
        self.nodes: list[Json] = []
        self.roots: list[int] = []
        self.skins: list[Json] = []
        self.extensions: set[str] = set()
        self.stands: dict[str, Stand] = {}
        self._hung: list[tuple[int, Placed]] = []
        self._joints = {joint for placed in scene.root.walk() if placed.node.skin is not None for joint in placed.node.skin.joints}
        self._instances: set[str] = set()

    def build(self) -> None:
        """Make all nodes, parents before children, then the skins, which name them."""
        if self._scene.camera is not None:
            # The first camera of a file is the one that it is seen with.
            camera = self._scene.camera
            self.roots.append(self._add_camera(camera, camera.name or "camera", "scene.camera"))
        first = self._scene.root
        skip_root = self._is_plain(first)
        above: list[int] = []
        for placed in first.walk():
            if placed.path in self._instances:
                continue
            if placed.depth == 0 and skip_root:
                self._add_instances(None, placed)
                continue
            del above[placed.depth - skip_root :]
            outer, inner = self._add_node(placed)
            (self.nodes[above[-1]].setdefault("children", []) if above else self.roots).append(outer)
            above.append(inner)
        for index, placed in self._hung:
            self.nodes[index]["skin"] = self._skin(placed)

    def _is_plain(self, root: Node) -> bool:
        """Whether the root does nothing but hold others, so that the scene of the file can stand for it."""
        path = root.name or "world"
        holds = root.shapes or root.lights or root.cameras or root.weights or root.skin or root.motion
        named = root.name not in ("", "world") or path in self._moving or path in self._told or path in self._joints
        across = {joint.split("/")[1] for joint in self._joints if "/" in joint}
        return not holds and not named and root.visible and np.array_equal(root.parent_from_node, _IDENTITY) and len(across) <= 1

    # One node

    def _add_node(self, placed: Placed) -> tuple[int, int]:
        """Make a node; the numbers of what its parent holds, and of what holds its children: two where it has shear."""
        node, path = placed.node, placed.path
        made: Json = {"name": plain_text(node.name)} if node.name else {}
        places, rest = self._places(node, path)
        made |= places[0]
        if not node.visible or path in self._told:
            self._extend(made, "KHR_node_visibility", {"visible": node.visible})
        outer = index = self._add(made)
        for place in places[1:]:
            index = self._add(place)
            self.nodes[outer]["children"] = [index]
        self.stands[path] = Stand(outer, rest, self._add_shapes(index, placed))
        self._add_lights(index, node, path)
        self._add_cameras(index, node, path)
        self._add_instances(index, placed)
        return outer, index

    def _add(self, node: Json) -> int:
        self.nodes.append(node)
        return len(self.nodes) - 1

    def _add_below(self, parent: int, node: Json) -> int:
        index = self._add(node)
        self.nodes[parent].setdefault("children", []).append(index)
        return index

    def _extend(self, node: Json, name: str, fields: Json) -> None:
        node.setdefault("extensions", {})[name] = fields
        self.extensions.add(name)

    def _places(self, node: Node, path: str) -> tuple[list[Json], Parts | None]:
        """Where a node stands, as one node says it or two, and its parts where it is animated."""
        matrix = node.place()
        if path in self._moving:
            rest = parts_of(matrix) or nearest_parts(matrix)
            if _shear(matrix) > _SHEAR:
                self._notes.add("is animated, which leaves out the shear it has at rest", path)
            kept = {name: value for name, value in self._moving[path].items() if np.allclose(value, getattr(rest, name), 1e-6, 1e-6)}
            rest = rest._replace(**kept)
            return [_said(rest)], rest
        if np.array_equal(matrix, _IDENTITY):
            return [{}], None
        parts = parts_of(matrix)
        if parts is not None:
            return [_said(parts)], None
        if _shear(matrix) <= _SHEAR:
            return [{"matrix": matrix.T.reshape(-1).tolist()}], None
        self._notes.add("has shear, which glTF allows between two nodes only: it is written as one in another", path)
        return [_said(parts) for parts in factors(matrix)], None

    # What a node shows

    def _add_shapes(self, index: int, placed: Placed) -> list[tuple[int, int]]:
        node, path = placed.node, placed.path
        groups: dict[tuple[bool, int], list[Drawn]] = {}
        for shape in node.shapes:
            drawn = self._drawn(shape, placed)
            if drawn is not None:
                groups.setdefault((drawn.binding is not None, len(drawn.morphs)), []).append(drawn)
        carriers: list[tuple[int, int]] = []
        for (is_bound, n_morphs), drawn_alike in groups.items():
            carrier = self._add_below(index, {}) if carriers else index
            self.nodes[carrier]["mesh"] = self._meshes.index_of(drawn_alike, path)
            if is_bound:
                self._hung.append((carrier, placed))
            if n_morphs and node.weights:
                self.nodes[carrier]["weights"] = [*node.weights[:n_morphs], *(0.0,) * (n_morphs - len(node.weights))]
            carriers.append((carrier, n_morphs))
        return carriers

    def _drawn(self, shape: Shape, placed: Placed) -> Drawn | None:
        shown = self._shapes.of(shape, placed.world_from_object, placed.path)
        if shown is None:
            return None
        return Drawn(shown, shape.morphs, shape.binding if placed.node.skin is not None else None)

    def _add_lights(self, index: int, node: Node, path: str) -> None:
        for light in node.lights:
            number = self._lights.index_of(light, path)
            if number is None:
                continue
            is_free = "KHR_lights_punctual" not in self.nodes[index].get("extensions", {})
            holder = index if is_free else self._add_below(index, {"name": plain_text(light.name)} if light.name else {})
            self._extend(self.nodes[holder], "KHR_lights_punctual", {"light": number})

    def _add_cameras(self, index: int, node: Node, path: str) -> None:
        for camera in node.cameras:
            if "camera" not in self.nodes[index] and np.array_equal(camera.place(), _IDENTITY):
                self.nodes[index]["camera"] = self._cameras.index_of(camera, path)
            else:
                self.nodes[index].setdefault("children", []).append(self._add_camera(camera, camera.name, path))

    def _add_camera(self, camera: Any, name: str, path: str) -> int:
        place = camera.place()
        parts = parts_of(place)
        made: Json = {"name": plain_text(name)} if name else {}
        made |= {"matrix": place.T.reshape(-1).tolist()} if parts is None else _said(parts)
        return self._add(made | {"camera": self._cameras.index_of(camera, path)})

    # What leads meshes

    def _skin(self, placed: Placed) -> int:
        skin = placed.node.skin
        assert skin is not None
        assert skin.joint_from_mesh is not None
        missing = [joint for joint in skin.joints if joint not in self.stands]
        if missing:
            raise SceneError(f"a skin names the joint {missing[0]!r}, and there is no such node", placed.path)
        matrices = skin.joint_from_mesh.transpose(0, 2, 1).reshape(-1, 16).astype(np.float32)
        made: Json = {"name": plain_text(skin.name)} if skin.name else {}
        made |= {
            "inverseBindMatrices": self._buffers.accessor(matrices, "matrices"),
            "joints": [self.stands[joint].number for joint in skin.joints],
        }  # fmt: skip
        if made not in self.skins:
            self.skins.append(made)
        return self.skins.index(made)

    # Instances

    def _add_instances(self, index: int | None, placed: Placed) -> None:
        """Write children that show one mesh, and do nothing else, as one node with their places; None: the file's scene holds it."""
        if not self._gpu_instancing:
            return
        alike: dict[tuple[Any, ...], list[Placed]] = {}
        for child, name in zip(placed.node.children, placed.node.names_of_children, strict=True):
            path = f"{placed.path}/{name}"
            if self._is_instance(child, path):
                here = Placed(child, path, placed.world_from_object @ child.parent_from_node, placed.depth + 1)
                key = tuple((id(shape.geometry), id(shape.displacement), *map(identity, shape.materials)) for shape in child.shapes)
                alike.setdefault(key, []).append(here)
        for group in alike.values():
            drawn = [self._drawn(shape, group[0]) for shape in group[0].node.shapes]
            shown = [one for one in drawn if one is not None]
            if len(group) < _FEWEST_INSTANCES or not shown:
                continue
            made: Json = {"mesh": self._meshes.index_of(shown, group[0].path)}
            self._extend(made, "EXT_mesh_gpu_instancing", {"attributes": self._places_of_instances(group)})
            if index is None:
                self.roots.append(self._add(made))
            else:
                self._add_below(index, made)
            self._instances |= {one.path for one in group}
            self._notes.add(f"{len(group)} nodes are written as instances, without their names", placed.path)

    def _is_instance(self, node: Node, path: str) -> bool:
        holds = node.lights or node.cameras or node.children or node.motion or node.skin
        bends = any(shape.morphs or shape.binding is not None for shape in node.shapes)
        named = path in self._moving or path in self._told or path in self._joints
        return bool(node.shapes) and not (holds or bends or named) and node.visible and _shear(node.parent_from_node) <= _SHEAR

    def _places_of_instances(self, group: list[Placed]) -> Json:
        matrices = np.array([placed.node.parent_from_node for placed in group])
        try:
            columns = dict(zip(("TRANSLATION", "ROTATION", "SCALE"), trs(matrices), strict=True))
        except SceneError:
            parts = [nearest_parts(matrix) for matrix in matrices]
            columns = {name.upper(): np.array([getattr(part, name) for part in parts]) for name in Parts._fields}
        return {name: self._buffers.accessor(np.array(rows, dtype=np.float32), "instances") for name, rows in columns.items()}


def _shear(matrix: NDArray[np.float64]) -> float:
    """The greatest cosine between two of its axes."""
    (a, b, c), (d, e, f), (g, h, i) = matrix[:3, :3].tolist()
    x, y, z = (max(math.hypot(*axis), 1e-300) for axis in ((a, d, g), (b, e, h), (c, f, i)))
    return max(abs(a * b + d * e + g * h) / x / y, abs(b * c + e * f + h * i) / y / z, abs(a * c + d * f + g * i) / x / z)


def _said(parts: Parts) -> Json:
    """What of a place is not as it would be without a word."""
    defaults = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}
    return {name: getattr(parts, name).tolist() for name, plain in defaults.items() if tuple(getattr(parts, name).tolist()) != plain}
