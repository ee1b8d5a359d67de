"""The scene graph (FoCG 12.2): a node places what it holds, and its children, in its parent's space."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ._values import finite, matrix4
from .camera import Camera
from .light import Light
from .motion import KeyedMotion, Motion
from .rig import Skin
from .shape import Shape

__all__ = ["MAX_DEPTH", "Node", "Placed", "names_among_siblings"]

MAX_DEPTH = 512


class Placed(NamedTuple):
    """A node with its path from the root ("world/car/wheel"), its place in the world, (4, 4) or (k, 4, 4) at k times, and its depth.

    A node without a name is called by its number among its siblings, from 0; of several with one name the second is "wheel#2", and so on:
    no two nodes have one path.
    """

    node: Node
    path: str
    world_from_object: NDArray[np.float64]
    depth: int = 0


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
    motion : Motion or KeyedMotion, optional
        How it moves, with its children, in its own space: at a time t it stands at ``parent_from_node @ motion.at(t)``. Shapes move while
        the shutter is open; lights stand where they are when it opens, and cameras, which may have a motion of their own, at time 0.
    weights : tuple of floats
        How far its meshes are morphed, a number for each of their morphs; empty: not at all.
    skin : Skin, optional
        The joints on which its meshes hang.
    """

    name: str = ""
    parent_from_node: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    shapes: tuple[Shape, ...] = ()
    lights: tuple[Light, ...] = ()
    cameras: tuple[Camera, ...] = ()
    children: tuple[Node, ...] = ()
    visible: bool = True
    motion: Motion | KeyedMotion | None = None
    weights: tuple[float, ...] = ()
    skin: Skin | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parent_from_node", matrix4(self.parent_from_node, f"node.parent_from_node of {self.name!r}"))
        for name, kind, hint in _HELD:
            given = getattr(self, name)
            if not isinstance(given, tuple):
                given = tuple(given) if isinstance(given, list) else (given,)
                object.__setattr__(self, name, given)
            for held in given:
                if not isinstance(held, kind):
                    raise SceneError(f"node.{name} of {self.name!r} must be {hint}, got {type(held).__name__}")
        if self.motion is not None and not isinstance(self.motion, (Motion, KeyedMotion)):
            raise SceneError(f"node.motion of {self.name!r} must be a Motion, got {type(self.motion).__name__}")
        if len(self.weights):
            object.__setattr__(self, "weights", tuple(finite(weight, f"node.weights of {self.name!r}") for weight in self.weights))
        elif not isinstance(self.weights, tuple):
            object.__setattr__(self, "weights", ())
        if self.skin is not None and not isinstance(self.skin, Skin):
            raise SceneError(f"node.skin of {self.name!r} must be a Skin, got {type(self.skin).__name__}")

    def place(self, time: ArrayLike = 0.0) -> NDArray[np.float64]:
        """Where it stands in its parent's space at a time, (4, 4), or at k times, (k, 4, 4) if it moves."""
        return self.parent_from_node if self.motion is None else self.parent_from_node @ self.motion.at(time)

    @cached_property
    def names_of_children(self) -> tuple[str, ...]:
        """What each child is called in paths; see `Placed`."""
        return names_among_siblings([child.name for child in self.children])

    def walk(self, hidden: bool = True, time: ArrayLike = 0.0) -> Iterator[Placed]:
        """Yield this node and all below it, parents first, each with its path and its place; without recursion.

        `hidden` False leaves out the nodes that are not visible, and what is below them. `time` is when to look, or k times at once.
        """
        # Branches that are under way: what is left of a node's children, and with what their paths begin.
        branches = [(zip((self,), (self.name or "world",), (self.place(time),), strict=True), "")]
        while branches:
            following = next(branches[-1][0], None)
            if following is None:
                branches.pop()
                continue
            node, name, world_from_object = following
            if not (hidden or node.visible):
                continue
            depth, path = len(branches) - 1, branches[-1][1] + name
            if depth > MAX_DEPTH:
                raise SceneError(f"the scene graph must not be deeper than {MAX_DEPTH} nodes", path[:80] + "…")
            yield Placed(node, path, world_from_object, depth)
            if node.children:
                places = _places_of(node.children, world_from_object, time)
                branches.append((zip(node.children, node.names_of_children, places, strict=True), f"{path}/"))


def _places_of(children: Sequence[Node], world_from_parent: NDArray[np.float64], time: ArrayLike) -> Sequence[NDArray[np.float64]]:
    """Where siblings stand in the world; many that rest are placed at once, in one array."""
    if world_from_parent.ndim > 2 or any(child.motion is not None for child in children):
        return [world_from_parent @ child.place(time) for child in children]
    places: Sequence[NDArray[np.float64]] = world_from_parent @ np.array([child.parent_from_node for child in children])
    return places


def names_among_siblings(given: Sequence[str]) -> tuple[str, ...]:
    """What siblings of these names are called in paths; see `Placed`.

    >>> names_among_siblings(["wheel", "", "wheel"])
    ('wheel', '1', 'wheel#2')
    """
    names = [name or str(index) for index, name in enumerate(given)]
    if len(set(names)) == len(names):
        return tuple(names)
    taken, counts = set(names), dict[str, int]()
    for index, name in enumerate(names):
        counts[name] = counts.get(name, 0) + 1
        while counts[name] > 1 and f"{name}#{counts[name]}" in taken:
            counts[name] += 1
        if counts[name] > 1:
            names[index] = f"{name}#{counts[name]}"
    return tuple(names)


_HELD = (
    ("shapes", Shape, "shapes, as in Shape(Sphere(1.0))"),
    ("lights", Light, "lights"),
    ("cameras", Camera, "cameras"),
    ("children", Node, "nodes"),
)
"""What a node may hold where, and how to say it."""
