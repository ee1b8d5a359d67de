"""Looking for nodes, and exchanging them (FoCG 12.2).

    find(scene, "wheel*")                            every node of such a name
    node(scene, "world/car/wheel#2")                 the one at a path
    with_node(scene, "world/car", lambda placed: dataclasses.replace(placed.node, visible=False))
    visited(scene, lambda placed: None if placed.node.name == "tree" else placed.node)

Nodes are never changed: what comes back is another scene, which shares with the first every branch in which nothing is different.
"""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Callable
from fnmatch import fnmatchcase

from ..errors import SceneError
from .node import Node, Placed
from .scene import Scene

__all__ = ["find", "node", "visited", "with_node"]

Change = Callable[[Placed], Node | None]


def find(scene: Scene, pattern: str, time: float = 0.0) -> tuple[Placed, ...]:
    """Every node whose path, or whose name, is like `pattern`, parents first; hidden ones, too.

    Parameters
    ----------
    scene : Scene
    pattern : str
        With * for any characters and ? for one. With a "/" it is compared with whole paths, otherwise with names.
    time : float
        When to look at what moves.

    >>> car = Node("car", children=(Node("wheel"), Node("wheel"), Node("mirror")))
    >>> [placed.path for placed in find(Scene(Node("world", children=(car,))), "wh*")]
    ['world/car/wheel', 'world/car/wheel#2']
    """
    whole = "/" in pattern
    return tuple(
        placed for placed in scene.root.walk(time=time) if fnmatchcase(placed.path if whole else placed.node.name, pattern)
    )  # fmt: skip


def node(scene: Scene, path: str, time: float = 0.0) -> Placed:
    """The node at a path, with its place in the world.

    Raises SceneError, which names the nearest paths that there are.
    """
    paths = []
    for placed in scene.root.walk(time=time):
        if placed.path == path:
            return placed
        paths.append(placed.path)
    near = difflib.get_close_matches(path, paths, n=3)
    hint = f"; did you mean {', '.join(map(repr, near))}?" if near else ""
    raise SceneError(f"there is no node {path!r}{hint}")


def with_node(scene: Scene, path: str, new: Node | Change | None) -> Scene:
    """The scene with another node at a path.

    Parameters
    ----------
    scene : Scene
    path : str
    new : Node, callable or None
        What takes the place of the node and of all below it; a function of what is there; None: nothing does.

    Raises SceneError where there is no such node, or where nothing would be left.
    """
    node(scene, path)
    if callable(new):
        ask = new
        return visited(scene, lambda placed: ask(placed) if placed.path == path else placed.node)
    below = path + "/"

    def exchange(placed: Placed) -> Node | None:
        if placed.path == path:
            return new
        return None if placed.path.startswith(below) else placed.node

    return visited(scene, exchange, keep_children=False) if new is not None else visited(scene, exchange)


def visited(scene: Scene, change: Change, time: float = 0.0, *, keep_children: bool = True) -> Scene:
    """Exchange nodes, from the leaves up.

    Parameters
    ----------
    scene : Scene
    change : callable
        Takes each node with its path and its place, as they are in the given scene; returns what takes its place, the node itself where
        nothing does, or None where it goes, with all below it. It need not care for children: they are put in afterwards, as they became.
    time : float
        When to look at what moves.
    keep_children : bool
        False: a node that is exchanged brings its own children.
    """
    made: list[list[Node]] = [[]]
    # The walk is in preorder, so in reverse every node comes after its children, the last child first.
    for placed in reversed(list(scene.root.walk(time=time))):
        old, depth = placed.node, placed.depth
        while len(made) <= depth + 1:
            made.append([])
        children = tuple(reversed(made[depth + 1]))
        made[depth + 1] = []
        new = change(placed)
        if new is None:
            continue
        stays = len(children) == len(old.children) and all(a is b for a, b in zip(children, old.children, strict=True))
        if not stays and (keep_children or new is old):
            new = dataclasses.replace(new, children=children)
        made[depth].append(new)
    if not made[0]:
        raise SceneError("the root of a scene cannot be taken away")
    (root,) = made[0]
    return scene if root is scene.root else scene.replace(root=root)
