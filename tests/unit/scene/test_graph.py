"""Finding, exchanging and removing nodes: what is asked for changes, and nothing else."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from limner.errors import SceneError
from limner.linear import transform
from limner.scene.graph import find, node, visited, with_node
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Shape, Sphere

WHEEL = Shape(Sphere(0.5))


def car() -> Scene:
    """A car with two wheels, and a tree."""
    wheels = tuple(Node("wheel", transform.translate(x, 0, 0), shapes=(WHEEL,)) for x in (-1.0, 1.0))
    body = Node("car", transform.translate(0, 5, 0), children=wheels, shapes=(Shape(Box()),))
    return Scene(Node("world", children=(body, Node("tree", children=(Node("leaf"),)))))


def paths(scene: Scene) -> list[str]:
    """All of them, in the order of the walk."""
    return [placed.path for placed in scene.root.walk()]


def test_nodes_are_found_by_name_and_by_path() -> None:
    """With wildcards; a slash makes it a path. Each comes with its place in the world."""
    assert [placed.path for placed in find(car(), "wheel")] == ["world/car/wheel", "world/car/wheel#2"]
    assert [placed.path for placed in car().find("world/*/*")] == ["world/car/wheel", "world/car/wheel#2", "world/tree/leaf"]
    assert find(car(), "boat") == ()
    np.testing.assert_allclose(node(car(), "world/car/wheel#2").world_from_object, transform.translate(1, 5, 0))


def test_a_lost_path_is_answered_with_near_ones() -> None:
    """In one line."""
    with pytest.raises(SceneError, match=r"there is no node 'world/car/whel'; did you mean 'world/car/wheel'"):
        node(car(), "world/car/whel")


def test_a_node_is_exchanged_with_all_below_it() -> None:
    """Its own children come along; branches beside it are the same objects."""
    scene = car()
    changed = with_node(scene, "world/car", Node("boat", children=(Node("sail"),)))
    assert paths(changed) == ["world", "world/boat", "world/boat/sail", "world/tree", "world/tree/leaf"]
    assert changed.root.children[1] is scene.root.children[1]
    assert paths(scene)[1] == "world/car"


def test_a_function_changes_a_node_and_keeps_what_is_below() -> None:
    """Hiding the car hides its wheels; they are still there."""
    hidden = car().with_node("world/car", lambda placed: dataclasses.replace(placed.node, visible=False))
    assert paths(hidden) == paths(car())
    assert [placed.path for placed, _ in hidden.shapes()] == []


def test_nodes_go() -> None:
    """With what is below them; the second wheel is then the first of its name. The root stays."""
    assert paths(with_node(car(), "world/tree", None)) == ["world", "world/car", "world/car/wheel", "world/car/wheel#2"]
    left = with_node(car(), "world/car/wheel", None)
    assert [placed.world_from_object[0, 3] for placed, shape in left.shapes() if shape is WHEEL] == [1.0]
    with pytest.raises(SceneError, match="the root of a scene cannot be taken away"):
        with_node(car(), "world", None)


def test_every_node_is_visited_once_and_nothing_is_copied_for_nothing() -> None:
    """A visit that changes nothing gives the very same scene; one that renames all leaves no old name."""
    seen: list[str] = []

    def look(placed: object) -> Node:
        seen.append(placed.path)  # type: ignore[attr-defined]
        return placed.node  # type: ignore[attr-defined,no-any-return]

    scene = car()
    assert visited(scene, look) is scene
    assert sorted(seen) == sorted(paths(scene))
    renamed = visited(scene, lambda placed: dataclasses.replace(placed.node, name=placed.node.name.upper()))
    assert paths(renamed) == [path.upper() for path in paths(scene)]
    assert [shape for _, shape in renamed.shapes()] == [shape for _, shape in scene.shapes()]
