"""scene_digest: the same everywhere for the same scene, another for every change that may be seen."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from limner.mesh.mesh import Mesh
from limner.scene.camera import PerspectiveCamera
from limner.scene.digest import scene_digest
from limner.scene.environment import Environment
from limner.scene.light import PointLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere
from limner.scene.texture import Texels, Texture

POSITIONS = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])


def _scene(*, x: float = 0.0, red: float = 0.5, texel: int = 7, intensity: float = 2.0, last: float = 1.0, name: str = "a") -> Scene:
    positions = POSITIONS.copy()
    positions[2, 1] = last
    pixels = np.zeros((2, 2, 4), dtype=np.uint8)
    pixels[0, 0, 0] = texel
    material = MetallicRoughness(base_color_texture=Texture(Texels(pixels, name=name)), name=name)
    place = np.eye(4)
    place[0, 3] = x
    return Scene(
        Node(
            name,
            place,
            shapes=(Shape(Mesh(positions, np.int32([[0, 1, 2]]), name=name), (material,)), Shape(Sphere(2.0), (Lambert((red, 0, 0)),))),
            lights=(PointLight(intensity=intensity, name=name),),
            children=(Node("child"), Node("other", children=(Node("leaf"),))),
        ),
        notes=(name,),
        name=name,
    )


def test_equal_scenes_have_equal_digests() -> None:
    """Built twice from nothing; names and notes change no pixel."""
    assert scene_digest(_scene()) == scene_digest(_scene()) == scene_digest(_scene(name="b"))
    assert len(scene_digest(_scene())) == 32


@pytest.mark.parametrize(
    "change", [{"x": 1e-12}, {"red": 0.5000001}, {"texel": 8}, {"intensity": 2.5}, {"last": np.nextafter(np.float32(1), np.float32(2))}]
)
def test_one_bit_changes_it(change: dict) -> None:
    """A place, a colour, a texel, a light, a vertex."""
    assert scene_digest(_scene()) != scene_digest(_scene(**change))


def test_the_tree_counts() -> None:
    """Who hangs on whom, who is hidden; the camera, what lies behind, what surrounds."""
    scene = _scene()
    flat = dataclasses.replace(scene.root, children=(Node(), Node(), Node()))
    hidden = dataclasses.replace(scene.root, visible=False)
    variants = [
        scene,
        scene.replace(root=flat),
        scene.replace(root=hidden),
        scene.replace(camera=PerspectiveCamera()),
        scene.replace(camera=PerspectiveCamera(yfov_degrees=41.0)),
        scene.replace(background=(0.0, 0.0, 0.0)),
        scene.replace(environment=Environment((1.0, 1.0, 1.0))),
        scene.replace(environment=Environment((1.0, 1.0, 1.0)), background="environment"),
        scene.replace(environment=Environment(np.ones((2, 4, 3)))),
    ]
    assert len({scene_digest(variant) for variant in variants}) == len(variants)


def test_an_environment_counts_with_what_its_file_holds(tmp_path: Path) -> None:
    """Not with where it lies."""
    for name, data in (("a.hdr", b"one"), ("b.hdr", b"one"), ("c.hdr", b"two")):
        (tmp_path / name).write_bytes(data)
    a, b, c = (scene_digest(Scene(environment=Environment(str(tmp_path / f"{name}.hdr")))) for name in "abc")
    assert a == b != c
    assert scene_digest(Scene(environment=Environment("no-such-file.hdr"))) not in (a, c)


def test_deep_graphs_need_no_recursion() -> None:
    """As deep as a graph may be."""
    node = Node()
    for _ in range(510):
        node = Node(children=(node,))
    assert scene_digest(Scene(node)) != scene_digest(Scene(node.children[0]))


def test_every_process_finds_the_same() -> None:
    """Whatever Python's hash seed."""
    script = "import limner; from limner.scene.digest import scene_digest; print(scene_digest(limner.builtin('teapot')))"
    made = {
        subprocess.run(
            [sys.executable, "-c", script], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True
        ).stdout
        for seed in ("1", "2")
    }
    assert len(made) == 1
