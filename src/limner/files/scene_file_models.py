"""What a scene file takes from other files: whole models, one of their nodes, one of their meshes.

A model brings names of nodes with it: its skins and its animations say paths. Where it is put into another scene, they become paths of
that scene.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from ..errors import FileFormatError, SceneError
from ..scene.animation import Animation, Channel, FieldChannel
from ..scene.library import BUILTINS, builtin
from ..scene.node import Node
from ..scene.scene import Scene
from .limits import Limits
from .notes import quoted
from .sources import Sources

__all__ = ["Models", "geometries_of", "grafted", "part_of"]

_MAX_FILES = 256
_MAX_NESTING = 8


class Models:
    """The files that one scene includes, each read once.

    Parameters
    ----------
    sources : Sources
    limits : Limits
        Of each file.
    read : callable
        From a path, an axis that points up, limits and the files that are being read, to a scene.
    chain : tuple of Path
        The files that include each other down to this one.
    """

    def __init__(
        self, sources: Sources, limits: Limits, read: Callable[[Path, str, Limits, tuple[Path, ...]], Scene], chain: tuple[Path, ...] = ()
    ) -> None:
        self._sources, self._limits, self._read = sources, limits, read
        self._chain = (*chain, Path(os.path.realpath(sources.path)))
        self._opened: dict[tuple[str, str], Scene] = {}

    def open(self, name: str, up: str, position: str) -> Scene:
        """The built-in scene of that name, or what a file beside the scene's holds; ``./teapot`` is a file."""
        if (name, up) in self._opened:
            return self._opened[name, up]
        if name in BUILTINS:
            scene = builtin(name)
        else:
            path = self._sources.locate(name, position)
            if not path.is_file():
                raise FileFormatError(f"{quoted(name)} is missing", self._sources.path, position)
            if Path(os.path.realpath(path)) in self._chain:
                raise FileFormatError(f"{quoted(name)} includes itself", self._sources.path, position)
            if len(self._chain) > _MAX_NESTING or len(self._opened) >= _MAX_FILES:
                what = f"more than {_MAX_FILES} files" if len(self._chain) <= _MAX_NESTING else f"files more than {_MAX_NESTING} deep"
                raise FileFormatError(f"must not include {what}", self._sources.path, position)
            scene = self._read(path, up, self._limits, self._chain)
        self._opened[name, up] = scene
        return scene


def part_of(scene: Scene, path: str | None) -> tuple[Node, str]:
    """A scene's root, or the node that stands at a path, and its path."""
    if path is None:
        return scene.root, scene.root.name or "world"
    known = []
    for placed in scene.root.walk():
        if placed.path == path:
            return placed.node, path
        known.append(placed.path)
    raise SceneError(f"there is no node {quoted(path)} in it; there are: {_listed(known)}")


def geometries_of(scene: Scene, kind: type, path: str | None) -> list[Any]:
    """The geometries of a kind that a scene, or its node at a path, shows; each once."""
    node, _ = part_of(scene, path)
    shown = [shape.geometry for placed in node.walk() if path is None or placed.node is node for shape in placed.node.shapes]
    return list({id(geometry): geometry for geometry in shown if isinstance(geometry, kind)}.values())


def _listed(names: list[str]) -> str:
    return ", ".join(names[:8]) + (", …" if len(names) > 8 else "")


def grafted(part: Node, animations: Iterable[Animation], old: str, new: str) -> tuple[Node, list[Animation]]:
    """A part of a scene that stands elsewhere now: its root had the path `old` and has `new`; the same node where it names none."""

    def moved(path: str) -> str:
        return new + path[len(old) :] if path == old or path.startswith(f"{old}/") else ""

    made = []
    for animation in animations:
        channels = tuple(kept for channel in animation.channels if (kept := _moved_channel(channel, moved)) is not None)
        if channels:
            made.append(dataclasses.replace(animation, channels=channels))
    names_nodes = made or any(placed.node.skin is not None for placed in part.walk())
    return (_with_skins(part, moved) if names_nodes else part), made


def _moved_channel(channel: Channel, moved: Callable[[str], str]) -> Channel | None:
    if isinstance(channel, FieldChannel) and channel.kind != "node":
        return channel
    target = moved(channel.target)
    return dataclasses.replace(channel, target=target) if target else None


def _with_skins(part: Node, moved: Callable[[str], str]) -> Node:
    """The same nodes, their joints where they are now; without recursion."""
    order, made = [part], dict[int, Node]()
    for node in order:
        order += node.children
    for node in reversed(order):
        if id(node) in made:
            continue
        skin = node.skin
        if skin is not None:
            joints = tuple(map(moved, skin.joints))
            if not all(joints):
                raise SceneError(f"the joint {quoted(skin.joints[joints.index('')])} stands outside of the part that is asked for")
            skin = dataclasses.replace(skin, joints=joints)
        made[id(node)] = dataclasses.replace(node, skin=skin, children=tuple(made[id(child)] for child in node.children))
    return made[id(part)]
