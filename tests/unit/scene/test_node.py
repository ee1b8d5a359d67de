"""The scene graph (FoCG 12.2): what stands on a node moves with it and with all above it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import PointLight
from limner.scene.node import MAX_DEPTH, Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Shape, Sphere


def car(position: float, spin: float) -> Node:
    """The book's example: a wheel that turns on a car that drives."""
    wheel = Node("wheel", transform.translate(1, 0.5, 0) @ transform.rotate_z(spin), shapes=(Shape(Sphere(0.5)),))
    return Node("car", transform.translate(position, 0, 0), shapes=(Shape(primitives.box()),), children=(wheel,))


@given(st.floats(-100, 100), st.floats(-10, 10))
def test_a_wheel_turns_about_its_own_axis_and_drives_with_its_car(position, spin):
    """world_from_wheel is the product of the matrices on the way down, the root's first."""
    places = {placed.path: placed.world_from_object for placed in Node(children=(car(position, spin),)).walk()}
    assert list(places) == ["world", "world/car", "world/car/wheel"]
    wheel = places["world/car/wheel"]
    np.testing.assert_allclose(transform.transform_points(wheel, [0, 0, 0]), [position + 1, 0.5, 0], atol=1e-12)
    spoke = transform.transform_points(wheel, [0.5, 0, 0])
    np.testing.assert_allclose(spoke, [position + 1 + 0.5 * np.cos(spin), 0.5 + 0.5 * np.sin(spin), 0], atol=1e-12)


def test_one_node_may_stand_in_two_places():
    """Instances: the same node under two parents is drawn twice, each with its own path and place."""
    shared = Node("tree", shapes=(Shape(Sphere()),))
    root = Node(children=tuple(Node(f"hill {k}", transform.translate(k, 0, 0), children=(shared,)) for k in (1, 2)))
    shown = Scene(root=root).shapes()
    assert [placed.path for placed, _ in shown] == ["world/hill 1/tree", "world/hill 2/tree"]
    assert [placed.world_from_object[0, 3] for placed, _ in shown] == [1.0, 2.0]
    assert shown[0][1] is shown[1][1]


def test_what_is_hidden_hides_what_stands_on_it():
    """An invisible node takes its shapes, lights, cameras and children along, and nobody else."""
    below = Node("below", shapes=(Shape(Sphere()),), lights=(PointLight(),), cameras=(PerspectiveCamera(),))
    scene = Scene(root=Node(children=(Node("off", visible=False, children=(below,)), Node("off-by-one", children=(below,)))))
    assert [placed.path for placed, _ in scene.shapes()] == ["world/off-by-one/below"]
    assert len(scene.lights()) == len(scene.cameras()) == 1


def test_bounds_enclose_what_is_bounded():
    """A plane has no bounds; a scaled sphere's box is scaled with it; an empty scene's are empty."""
    ball = Node("ball", transform.translate(1, 2, 3) @ transform.scale(1, 2, 3), shapes=(Shape(Sphere()),))
    scene = Scene(root=Node(children=(ball, Node(shapes=(Shape(Plane()),)))))
    np.testing.assert_allclose(scene.bounds(), [[0, 0, 0], [2, 4, 6]])
    np.testing.assert_array_equal(Scene().bounds(), [[np.inf] * 3, [-np.inf] * 3])


def test_cameras_of_the_graph_are_rigid_in_the_world():
    """A scaled node moves its camera and does not stretch what it sees."""
    node = Node("tripod", transform.translate(0, 1, 0) @ transform.scale(2, 3, 4), cameras=(PerspectiveCamera(),))
    (camera,) = Scene(root=Node(children=(node,))).cameras()
    np.testing.assert_allclose(camera.world_from_camera, transform.translate(0, 1, 0), atol=1e-15)


def test_a_bottomless_graph_is_refused():
    """Deep graphs are walked without recursion, and too deep ones are named instead of overflowing."""
    node = Node("leaf")
    for _ in range(MAX_DEPTH):
        node = Node("n", children=(node,))
    assert sum(1 for _ in node.walk()) == MAX_DEPTH + 1
    with pytest.raises(SceneError, match="deeper than"):
        list(Node("n", children=(node,)).walk())


def test_matrices_that_are_not_affine_are_refused():
    """The node is named, and what its matrix should be."""
    with pytest.raises(SceneError, match="parent_from_node of 'lens'"):
        Node("lens", np.diag([1.0, 1.0, 1.0, 2.0]))
    with pytest.raises(SceneError, match="finite"):
        Node("lens", np.full((4, 4), np.nan))


def test_what_a_node_cannot_hold_is_named() -> None:
    """A sphere without its Shape is the likely slip; nothing of it waits until something is drawn."""
    with pytest.raises(SceneError, match=r"^node.shapes of 'ball' must be shapes, as in Shape\(Sphere\(1.0\)\), got Sphere$"):
        Node("ball", shapes=(Sphere(1.0),))  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"^node\.children of 'world' must be nodes, got int$"):
        Node("world", children=(3,))  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"^scene\.root must be a Node, got Sphere$"):
        Scene(Sphere(1.0))  # type: ignore[arg-type]
