"""Points of glTF, and what applications say of vertices by names of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import LimnerWarning
from limner.files.load import load
from limner.scene.points import PointCloud

PLACES = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [np.inf, 0, 0]])


def test_points_are_a_cloud(triangle: Any, tmp_path: Path) -> None:
    """Mode 0 is a cloud with colours, normals and scalars of its points; those at infinity are left out, which is said."""
    made = triangle.primitive(PLACES, mode=0)
    made["attributes"] |= {
        "COLOR_0": triangle.accessor(np.eye(4)[:, :3]), "NORMAL": triangle.accessor([[0, 0, 2.0]] * 4),
        "_HEAT": triangle.accessor([1, 2, 3, 4], "u2"),
    }  # fmt: skip
    with pytest.warns(LimnerWarning, match="1 of 4 points"):
        scene = load(triangle.save(tmp_path))
    cloud = scene.shapes()[1][1].geometry
    assert isinstance(cloud, PointCloud)
    assert cloud.positions.tolist() == PLACES[:3].tolist()
    assert cloud.colors is not None
    assert cloud.colors.tolist() == np.eye(3).tolist()
    assert cloud.shown_as == "discs"
    assert cloud.scalars is not None
    assert cloud.scalars["HEAT"].tolist() == [1, 2, 3]


def test_indices_choose_points(triangle: Any, tmp_path: Path) -> None:
    """Only points that are named are shown, each once; those that do not exist are left out."""
    triangle.primitive(PLACES[:3], [2, 0, 2, 9], mode=0)
    with pytest.warns(LimnerWarning, match="1 of 3 points do not exist"):
        cloud = load(triangle.save(tmp_path)).shapes()[1][1].geometry
    assert isinstance(cloud, PointCloud)
    assert cloud.positions.tolist() == PLACES[[0, 2]].tolist()


def test_scalars_of_meshes(triangle: Any, tmp_path: Path) -> None:
    """``_NAME`` is kept by its name where it is one number a vertex; vectors, and what is broken, are left out."""
    attributes = triangle.document["meshes"][0]["primitives"][0]["attributes"]
    n = triangle.document["accessors"][attributes["POSITION"]]["count"]
    attributes |= {"_RISK": triangle.accessor(np.arange(n) / 4), "_FLOW": triangle.accessor(np.zeros((n, 3)))}
    mesh = load(triangle.save(tmp_path)).shapes()[0][1].geometry
    assert {name: values.tolist() for name, values in mesh.scalars.items()} == {"RISK": (np.arange(n) / 4).tolist()}
    attributes["_SHORT"] = triangle.accessor(np.arange(n + 1))
    with pytest.warns(LimnerWarning, match="drawn without _SHORT"):
        load(triangle.save(tmp_path))
