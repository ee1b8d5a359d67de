"""Scenes coloured by numbers: one range for all that has them, the rest left alone, what was shared still shared."""

from __future__ import annotations

import numpy as np
import pytest

from limner.color.maps import mapped
from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.produce.scalars import colored, scalar_names, with_point_size
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.points import PointCloud
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere

CORNERS = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
MESH = Mesh(CORNERS, [[0, 1, 2]], scalars={"p": [0, 1, 2], "q": [7, 7, 7]}, triangle_materials=[1])  # type: ignore[arg-type, dict-item]
CLOUD = PointCloud(CORNERS, scalars={"p": [-2, 0, np.nan]})  # type: ignore[dict-item]
LEAF = Node("leaf", shapes=(Shape(MESH, (Lambert(), Lambert((1.0, 0.0, 0.0)))),))
SCENE = Scene(Node(shapes=(Shape(Sphere()),), children=(Node("a", children=(LEAF,)), LEAF, Node(shapes=(Shape(CLOUD),)))))


def test_one_range_for_all() -> None:
    """Mesh and cloud share the range of their numbers together; both become white below their colours; the sphere stays."""
    scene, bar = colored(SCENE, "p", "grey")
    assert (bar.color_map, bar.range, bar.label) == ("grey", (-2.0, 2.0), "p")
    sphere, first, second, cloud = (shape for _, shape in scene.shapes())
    assert (first.geometry.colors == mapped([0, 1, 2], "grey", (-2.0, 2.0))).all()  # type: ignore[union-attr]
    assert (cloud.geometry.colors[:2] == mapped([-2, 0], "grey", (-2.0, 2.0))).all()  # type: ignore[union-attr, index]
    assert first.materials == cloud.materials == (Lambert((1.0, 1.0, 1.0)),)
    assert first is second
    assert sphere is SCENE.shapes()[0][1]
    assert [placed.path for placed, _ in scene.shapes()] == [placed.path for placed, _ in SCENE.shapes()]


def test_names_and_what_is_refused() -> None:
    """All names are known; where none fits they are told."""
    assert scalar_names(SCENE) == ("p", "q")
    assert colored(SCENE, "q")[1].range == (7.0, 7.0)
    with pytest.raises(SceneError, match="nothing has scalars 'r'; there are: p, q"):
        colored(SCENE, "r")


def test_point_size() -> None:
    """Points get the radius; meshes are not touched."""
    scene = with_point_size(SCENE, 0.125)
    assert scene.shapes()[3][1].geometry.point_radii.tolist() == [0.125] * 3  # type: ignore[union-attr]
    assert scene.shapes()[1][1] is SCENE.shapes()[1][1]
    with pytest.raises(SceneError, match="point_size must be positive"):
        with_point_size(SCENE, 0.0)
