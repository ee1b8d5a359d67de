"""The scene graph (FoCG 12.2): a node places what it holds, and its children, in its parent's space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ._values import matrix4
from .camera import Camera
from .light import Light
from .motion import Motion
from .shape import Shape

__all__ = ["MAX_DEPTH", "Node", "Placed"]

MAX_DEPTH = 512


class Placed(NamedTuple):
    """A node with its path from the root ("world/car/wheel") and its place in the world: (4, 4), or (k, 4, 4) at k times."""

    node: Node
    path: str
    world_from_object: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Node:
    """A place in the scene.

    Parameters
    ----------
    name : str
    parent_from_node : (4, 4) float64
        Affine; column vectors.
    shapes, lights, cameras : tuples
        What stands here.
    children : tuple of Node
    visible : bool
        False: neither it nor its children are drawn.
    motion : Motion, optional
        How it moves, with its children, in its own space: at a time t it stands at ``parent_from_node @ motion.at(t)``. Shapes move while
        the shutter is open; lights stand where they are when it opens, and cameras, which may have a motion of their own, at time 0.
    """

    name: str = ""
    parent_from_node: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    shapes: tuple[Shape, ...] = ()
    lights: tuple[Light, ...] = ()
    cameras: tuple[Camera, ...] = ()
    children: tuple[Node, ...] = ()
    visible: bool = True
    motion: Motion | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parent_from_node", matrix4(self.parent_from_node, f"node.parent_from_node of {self.name!r}"))
        for name in ("shapes", "lights", "cameras", "children"):
            given = getattr(self, name)
            object.__setattr__(self, name, tuple(given) if isinstance(given, (tuple, list)) else (given,))
        for name, kind, hint in _HELD:
            for held in getattr(self, name):
                if not isinstance(held, kind):
                    raise SceneError(f"node.{name} of {self.name!r} must be {hint}, got {type(held).__name__}")
        if self.motion is not None and not isinstance(self.motion, Motion):
            raise SceneError(f"node.motion of {self.name!r} must be a Motion, got {type(self.motion).__name__}")

    def place(self, time: ArrayLike = 0.0) -> NDArray[np.float64]:
        """Where it stands in its parent's space at a time, (4, 4), or at k times, (k, 4, 4) if it moves."""
        return self.parent_from_node if self.motion is None else self.parent_from_node @ self.motion.at(time)

    def walk(self, hidden: bool = True, time: ArrayLike = 0.0) -> Iterator[Placed]:
        """Yield this node and all below it, parents first, each with its path and its place; without recursion.

        `hidden` False leaves out the nodes that are not visible, and what is below them. `time` is when to look, or k times at once.
        """
        stack = [(self, self.name or "world", np.eye(4), 0)]
        while stack:
            node, path, world_from_parent, depth = stack.pop()
            if not (hidden or node.visible):
                continue
            if depth > MAX_DEPTH:
                raise SceneError(f"the scene graph must not be deeper than {MAX_DEPTH} nodes", path[:80] + "…")
            world_from_object = world_from_parent @ node.place(time)
            yield Placed(node, path, world_from_object)
            for index in reversed(range(len(node.children))):
                child = node.children[index]
                stack.append((child, f"{path}/{child.name or index}", world_from_object, depth + 1))


_HELD = (
    ("shapes", Shape, "shapes, as in Shape(Sphere(1.0))"),
    ("lights", Light, "lights"),
    ("cameras", Camera, "cameras"),
    ("children", Node, "nodes"),
)
"""What a node may hold where, and how to say it."""
