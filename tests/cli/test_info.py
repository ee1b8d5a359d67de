"""`limner info`: what is in a model, and what is wrong with it."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from limner.cli.info import describe
from limner.mesh.mesh import Mesh
from limner.scene.light import PointLight
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Shape
from limner.scene.texture import Texels, Texture


def _scene() -> Scene:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], dtype=np.float32)
    mesh = Mesh(corners, np.array([[0, 1, 2], [0, 1, 3], [1, 1, 2]], dtype=np.int32), name="thin")
    texels = Texels(np.zeros((2, 8, 4), np.uint8), name="wood")
    matte = Lambert(texture=Texture(texels))
    twice = (Node("left", shapes=(Shape(mesh, (matte,)),)), Node("right", shapes=(Shape(mesh, (matte,)),)))
    hidden = Node("hidden", visible=False, children=(Node("below", lights=(PointLight(),)),))
    return Scene(root=Node("world", children=(*twice, hidden), lights=(PointLight(name="lamp"),)))


def test_shared_things_are_counted_once() -> None:
    """Two nodes show one mesh with one material and one picture; what is hidden is not there."""
    told = describe(_scene())
    assert (told["nodes"], told["hidden_nodes"], told["shapes"], told["meshes"]) == (5, 2, 2, 1)
    assert (told["triangles"], told["drawn_triangles"], told["materials"]) == (3, 6, {"Lambert": 1})
    assert told["textures"] == [{"name": "wood", "width": 8, "height": 2}]
    assert told["lights"] == [{"kind": "PointLight", "name": "lamp", "node": "world"}]
    assert told["bounds"] == [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0]]


def test_likely_slips_are_found() -> None:
    """Collinear and repeated corners, no camera; and in an empty scene everything that is missing."""
    assert describe(_scene())["warnings"] == [
        "no camera: one that frames everything will be used",
        "mesh 'thin' has 2 triangles of no area",
    ]
    empty = describe(Scene())
    assert empty["bounds"] is None
    assert empty["warnings"][0] == "there is nothing to see"


def test_an_unbounded_plane_has_no_bounds() -> None:
    """JSON knows no infinity."""
    told = describe(Scene(root=Node(shapes=(Shape(Plane()),))))
    assert told["bounds"] is None
    json.dumps(told, allow_nan=False)


def test_text_and_json_tell_the_same(limner: Callable[..., Any]) -> None:
    """Results on standard output, notes and warnings on standard error."""
    text = limner("info", "box.glb")
    assert text.code == 0
    assert text.out.splitlines()[0] == "box.glb"
    assert "shapes     1 (1 Box)" in text.out
    assert "cameras    0 front PerspectiveCamera; 1 plan OrthographicCamera" in text.out
    assert "(-1, -2, -3) to (1, 2, 3): 2 x 4 x 6 m" in text.out
    assert "limner: note: extension EXT_nothing is ignored\n" in text.err
    assert "limner: warning: no light" in text.err
    told = json.loads(limner("info", "box.glb", "--json").out)
    assert told["shapes_by_kind"] == {"Box": 1}
    assert told["notes"] == ["extension EXT_nothing is ignored"]


@pytest.mark.parametrize("quiet", [(), ("--quiet",)])
def test_quiet_keeps_the_result(limner: Callable[..., Any], quiet: tuple[str, ...]) -> None:
    """--quiet silences standard error only."""
    done = limner("info", "box.glb", *quiet)
    assert bool(done.err) != bool(quiet)
    assert done.out
