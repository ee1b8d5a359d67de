"""What people hold becomes a scene, or one line says what would."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import limner
from limner.errors import FileFormatError, SceneError
from limner.files.interop import as_scene

VERTICES = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
TRIANGLES = [[0, 1, 2]]


def n_triangles(scene: limner.Scene) -> int:
    """Of all shapes."""
    return sum(len(shape.geometry.triangles) for _, shape in scene.shapes())  # type: ignore[union-attr]


def test_scenes_and_their_parts() -> None:
    """A scene is itself; a node, a shape, a mesh gets the rest around it."""
    mesh = limner.Mesh(np.array(VERTICES, np.float32), np.array(TRIANGLES))
    scene = limner.Scene(limner.Node(shapes=(limner.Shape(mesh),)))
    assert as_scene(scene) is scene
    for part in (scene.root, limner.Shape(mesh), mesh):
        assert as_scene(part).shapes()[0][1].geometry is mesh


def test_names_and_paths(tmp_path: Path) -> None:
    """A built-in's name, or a path, as text or not."""
    assert as_scene("cornell").name == "cornell"
    path = tmp_path / "one.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert n_triangles(as_scene(path)) == n_triangles(as_scene(str(path))) == 1
    with pytest.raises(FileFormatError, match="there is no such file"):
        as_scene(tmp_path / "gone.glb")


@pytest.mark.parametrize(
    "thing",
    [
        (VERTICES, TRIANGLES),
        [np.array(VERTICES), np.array(TRIANGLES, np.uint16)],
        SimpleNamespace(vertices=VERTICES, faces=TRIANGLES),
        SimpleNamespace(vertices=np.array(VERTICES), triangles=np.array(TRIANGLES)),
    ],
)
def test_bare_triangles(thing: Any) -> None:
    """Pairs of arrays, and objects that have them under the usual names."""
    assert n_triangles(as_scene(thing)) == 1


def test_trimesh() -> None:
    """A mesh, and a scene of meshes."""
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=1)
    assert n_triangles(as_scene(ball)) == n_triangles(as_scene(trimesh.Scene([ball]))) == 80


@pytest.mark.parametrize(
    ("thing", "message"),
    [
        (None, "scene must be a Scene, the path of a model, .*, got NoneType"),
        (7, "got int"),
        (np.zeros((3, 3)), "got ndarray"),
        ((VERTICES, TRIANGLES, TRIANGLES), "got tuple"),
        (SimpleNamespace(vertices=VERTICES), "got SimpleNamespace"),
        (([[0, 0]], TRIANGLES), r"mesh.positions must have shape \(n, 3\)"),
        ((VERTICES, [[0, 1, 3]]), r"mesh.triangles must lie in 0\.\.2"),
        (([*VERTICES[:2], [0]], TRIANGLES), "vertices and triangles must be arrays of numbers"),
    ],
)
def test_what_is_no_scene(thing: Any, message: str) -> None:
    """One line that says what would be one, or what is wrong with the arrays."""
    with pytest.raises(SceneError, match=message) as caught:
        as_scene(thing)
    assert "\n" not in str(caught.value)


def test_a_scene_becomes_one_of_trimesh_and_comes_back() -> None:
    """The graph, the places and the triangles are those of the scene; a shared mesh is shared."""
    trimesh = pytest.importorskip("trimesh")
    from limner.files.interop import scene_from_trimesh, to_trimesh
    from limner.linear import transform
    from limner.mesh.shapes.platonic import box
    from limner.scene.node import Node
    from limner.scene.scene import Scene
    from limner.scene.shape import Shape, Sphere

    shape = Shape(box((1, 2, 3)))
    nodes = tuple(Node(f"part {k}", transform.translate(4.0 * k, 0, 0) @ transform.rotate_y(k), shapes=(shape,)) for k in range(3))
    scene = Scene(Node("world", children=(*nodes, Node("ball", transform.translate(0, 9, 0), shapes=(Shape(Sphere(1.0)),)))))
    made = to_trimesh(scene)
    assert isinstance(made, trimesh.Scene)
    assert len(made.geometry) == 2
    assert {f"part {k}" for k in range(3)} <= set(made.graph.nodes)
    np.testing.assert_allclose(made.bounds, scene.bounds(), atol=1e-2)
    np.testing.assert_allclose(made.graph.get("part 2")[0], nodes[2].parent_from_node, atol=1e-6)
    again = scene_from_trimesh(made)
    np.testing.assert_allclose(again.bounds(), made.bounds, atol=1e-6)
    assert len(again.shapes()) == 4
