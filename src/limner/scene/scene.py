"""A whole scene: a graph of nodes, the camera to see it with, what lies behind it, and what was said while it was read."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LimnerError, SceneError
from ..linear.affine import cross
from ._values import Triple, triple
from .animation import Animation
from .camera import Camera
from .environment import Environment
from .fog import Fog
from .light import Light
from .material import Material, ShadowCatcher
from .node import Node, Placed
from .shape import Plane, Shape

__all__ = ["Scene"]


@dataclass(frozen=True, eq=False)
class Scene:
    """What there is to see.

    Parameters
    ----------
    root : Node
    camera : Camera, optional
        World space; None: the first camera of the graph, or one that frames everything.
    background : three floats >= 0, "environment", or None
        Radiance behind everything; the environment itself; None: transparent.
    name : str
    notes : tuple of str
        What a reader approximated, ignored or repaired.
    environment : Environment, optional
        Light from all around.
    fog : Fog, optional
        What the air is full of; for `ray` and `path`.
    animations : tuple of Animation
        What its nodes and materials can do; see `at`.

    A change is a copy: ``scene.replace(camera=...)``.
    """

    root: Node = field(default_factory=Node)
    camera: Camera | None = None
    background: Triple | Literal["environment"] | None = None
    name: str = ""
    notes: tuple[str, ...] = ()
    environment: Environment | None = None
    fog: Fog | None = None
    animations: tuple[Animation, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.root, Node):
            raise SceneError(f"scene.root must be a Node, got {type(self.root).__name__}")
        if self.environment is not None and not isinstance(self.environment, Environment):
            raise SceneError(f"scene.environment must be an Environment, got {type(self.environment).__name__}")
        if self.fog is not None and not isinstance(self.fog, Fog):
            raise SceneError(f"scene.fog must be a Fog, got {type(self.fog).__name__}")
        object.__setattr__(self, "animations", tuple(self.animations))
        for animation in self.animations:
            if not isinstance(animation, Animation):
                raise SceneError(f"scene.animations must be Animations, got {type(animation).__name__}")
        if isinstance(self.background, str):
            if self.background != "environment":
                raise SceneError(f'scene.background must be three numbers, "environment" or None, got {self.background!r}')
            if self.environment is None:
                raise SceneError('scene.background is "environment", but scene.environment is None')
        elif self.background is not None:
            object.__setattr__(self, "background", triple(self.background, "scene.background", minimum=0.0))

    def replace(self, **changes: Any) -> Scene:
        """Return a copy with the given fields changed."""
        made = dataclasses.replace(self, **changes)
        if made.root is self.root:
            # What was found in the graph holds for every scene that has it.
            vars(made).update({name: found for name, found in vars(self).items() if name in _OF_THE_GRAPH})
        return made

    def at(self, time: float, animation: str | int | None = None) -> Scene:
        """The scene as it is at a time, in seconds, of an animation (its name or number; None: the first); see `limner.scene.pose.at`."""
        pose = importlib.import_module(".pose", __package__)
        moment: Scene = pose.at(self, time, animation)
        return moment

    def find(self, pattern: str) -> tuple[Placed, ...]:
        """Every node whose path or name is like a pattern; see `limner.scene.graph.find`."""
        found: tuple[Placed, ...] = importlib.import_module(".graph", __package__).find(self, pattern)
        return found

    def with_node(self, path: str, new: Any) -> Scene:
        """The scene with another node at a path, or none; see `limner.scene.graph.with_node`."""
        made: Scene = importlib.import_module(".graph", __package__).with_node(self, path, new)
        return made

    def walk(self, time: ArrayLike = 0.0) -> Iterator[Placed]:
        """The visible nodes, parents first, as they stand at a time, or at k times at once."""
        if isinstance(time, float) and time == 0.0:
            return iter(self._nodes_at_first)
        return self.root.walk(hidden=False, time=time)

    def shapes(self, time: ArrayLike = 0.0) -> list[tuple[Placed, Shape]]:
        """Every visible shape with the node that shows it, in the order of the graph: the order of instance ids."""
        if isinstance(time, float) and time == 0.0:
            return self._shapes_at_first.copy()
        return [(placed, shape) for placed in self.walk(time) for shape in placed.node.shapes]

    @cached_property
    def _nodes_at_first(self) -> list[Placed]:
        """Of time 0: asked for many times for every picture."""
        return list(self.root.walk(hidden=False))

    @cached_property
    def _shapes_at_first(self) -> list[tuple[Placed, Shape]]:
        return [(placed, shape) for placed in self._nodes_at_first for shape in placed.node.shapes]

    def lights(self, time: ArrayLike = 0.0) -> list[tuple[Placed, Light]]:
        """Every visible light with its node."""
        if isinstance(time, float) and time == 0.0:
            return list(self._lights_at_first)
        return [(placed, light) for placed in self.walk(time) for light in placed.node.lights]

    @cached_property
    def _lights_at_first(self) -> list[tuple[Placed, Light]]:
        return [(placed, light) for placed in self.walk() for light in placed.node.lights]

    def cameras(self) -> list[Camera]:
        """Every camera of the graph, placed in the world; negative and uneven scale of its node is taken out."""
        found = []
        for placed in self.walk():
            for camera in placed.node.cameras:
                matrix = placed.world_from_object @ camera.world_from_camera
                found.append(dataclasses.replace(camera, world_from_camera=_rigid(matrix)))
        return found

    def with_ground(self, material: Material | None = None) -> Scene:
        """Put an infinite plane under what is there; of nothing but shadows unless a material is given."""
        low = self.bounds()[0, 1]
        place = np.eye(4)
        place[1, 3] = low if np.isfinite(low) else 0.0
        ground = Node("ground", place, shapes=(Shape(Plane(), (material or ShadowCatcher("ground"),)),))
        root = self.root
        if root.visible and root.motion is None and (root.parent_from_node == np.eye(4)).all():
            # Beside the others, so that nodes keep the paths by which animations and skins name them.
            return self.replace(root=dataclasses.replace(root, children=(*root.children, ground)))
        return self.replace(root=Node(root.name, children=(root, ground)))

    def _repr_png_(self) -> bytes | None:
        """A small picture, as notebooks show it; None where there is none to be had."""
        # A face of the whole, the one place where the description looks up to the renderers, and only when it is looked at.
        render = importlib.import_module("..render", __package__).render
        try:
            png: bytes = render(self, width=400, height=300)._repr_png_()
            return png
        except LimnerError:
            return None

    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) float64: least and greatest corner of all bounded shapes in the world; (inf, -inf) where there are none."""
        return self._bounds.copy()

    @cached_property
    def _bounds(self) -> NDArray[np.float64]:
        boxes: dict[int, NDArray[np.float64] | None] = {}
        found, places = [], []
        for placed, shape in self.shapes():
            if id(shape) not in boxes:
                boxes[id(shape)] = _object_bounds(shape)
            box = boxes[id(shape)]
            if box is not None:
                found.append(box)
                places.append(placed.world_from_object)
        if not found:
            return np.array([[np.inf] * 3, [-np.inf] * 3])
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for start in range(0, len(found), _AT_ONCE):
            part = slice(start, start + _AT_ONCE)
            corners = np.array(found[part])[:, _CORNERS, np.arange(3)]
            matrices = np.array(places[part])
            world = corners @ np.swapaxes(matrices[:, :3, :3], 1, 2) + matrices[:, None, :3, 3]
            world = world[np.isfinite(world).all(axis=(1, 2))].reshape(-1, 3)
            low, high = np.minimum(low, world.min(axis=0, initial=np.inf)), np.maximum(high, world.max(axis=0, initial=-np.inf))
        return np.array([low, high])


_OF_THE_GRAPH = ("_nodes_at_first", "_shapes_at_first", "_lights_at_first", "_bounds")
_AT_ONCE = 1 << 13  # shapes whose corners are looked at together
_CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def _object_bounds(shape: Shape) -> NDArray[np.float64] | None:
    geometry = shape.geometry
    if isinstance(geometry, Plane):
        return None
    box = geometry.bounds
    if shape.displacement is not None:
        box = box + np.array([[-shape.displacement.reach], [shape.displacement.reach]])
    # Parts of an intersection that do not meet leave nothing.
    return box if (box[0] <= box[1]).all() and np.isfinite(box).all() else None


def _rigid(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Keep a camera's place and gaze, drop scale and shear (Gram-Schmidt from the gaze)."""
    w = matrix[:3, 2]
    w = w / (np.linalg.norm(w) or 1.0)
    u = cross(matrix[:3, 1], w)
    u = u / (np.linalg.norm(u) or 1.0)
    made = np.eye(4)
    made[:3, 0], made[:3, 1], made[:3, 2], made[:3, 3] = u, cross(w, u), w, matrix[:3, 3]
    return made
