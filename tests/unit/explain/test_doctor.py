"""The doctor: each planted fault is named, with its place; sound scenes are left in peace."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, checkers, lit_from, place, point_light_at, scene_of, two_triangles

from limner.errors import UnsupportedError
from limner.explain.doctor import doctor
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes.primitives import box, uv_sphere
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.library import BUILTINS, builtin
from limner.scene.light import PointLight, RectangleLight, SpotLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.material_extensions import Transmission
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box

FRONT = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0))
ONE_SIDED = Lambert(double_sided=False)
DOTS = Mesh(np.zeros((3, 3), np.float32), np.array([[0, 1, 2]] * 4, np.int32))
SQUARE = two_triangles((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))


def _named(node: Node, name: str) -> Node:
    return dataclasses.replace(node, name=name)


def _ball(**changes: Any) -> Mesh:
    return dataclasses.replace(uv_sphere(32, 16, 0.5), **changes)


def _scene(*nodes: Node, camera: Any = FRONT, **changes: Any) -> Scene:
    return scene_of(*nodes, camera=camera).replace(**changes)


def _turned(mesh: Mesh) -> Mesh:
    return Mesh(mesh.positions, np.ascontiguousarray(mesh.triangles[:, ::-1]))


def _hidden() -> Scene:
    return _scene(dataclasses.replace(place(_ball()), visible=False))


def _unlit() -> Scene:
    dead = dataclasses.replace(point_light_at((0, 2, 2), PointLight(intensity=0.0)), name="lamp")
    return Scene(Node(children=(place(_ball()), dead)), camera=FRONT)


BROKEN: dict[str, tuple[Callable[[], Scene], str, str]] = {
    "hidden": (_hidden, "empty", ""),
    "behind the camera": (lambda: _scene(place(_ball(), at=(0, 0, 9))), "behind-camera", "camera"),
    "past it": (lambda: _scene(place(_ball(), at=(9, 0, 0))), "looks-past", "camera"),
    "units": (lambda: _scene(place(_ball(), matrix=transform.scale(4000.0)), camera=None), "units", ""),
    "camera in millimetres": (
        lambda: _scene(place(_ball()), camera=PerspectiveCamera.look_at((0, 0, 4000), (0, 0, 0))), "camera-far-outside", "camera",
    ),
    "far plane": (
        lambda: _scene(place(_ball()), camera=PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), near=0.1, far=2.0)), "far-plane", "camera",
    ),
    "near plane": (
        lambda: _scene(place(_ball()), camera=PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), near=3.8)), "near-plane", "camera",
    ),
    "no power": (_unlit, "no-power", "world/lamp"),
    "light inside": (
        lambda: _scene(_named(place(box((1.0, 1.0, 1.0))), "crate"), point_light_at((0, 0, 0), PointLight())), "light-inside", "1",
    ),
    "spot misses": (
        lambda: _scene(place(_ball()), Node("spot", transform.translate(0, 0, -9), lights=(SpotLight(outer_degrees=20),))),
        "spot-misses", "spot",
    ),
    "out of range": (
        lambda: _scene(place(_ball()), _named(point_light_at((0, 0, 5), PointLight(range=1.0)), "lamp")), "out-of-range", "lamp",
    ),
    "too weak": (
        lambda: _scene(place(_ball()), point_light_at((0, 0, 5), PointLight(intensity=0.01))), "too-dark", "",
    ),
    "too strong": (lambda: _scene(place(_ball()), point_light_at((0, 0, 5), PointLight(intensity=1e5))), "too-bright", ""),
    "inside out": (lambda: _scene(_named(place(_turned(box((1.0, 1.0, 1.0))), ONE_SIDED), "crate")), "inside-out", "crate"),
    "seen from behind": (
        lambda: _scene(_named(place(SQUARE, ONE_SIDED, matrix=transform.rotate((0, 1, 0), np.pi)), "square")), "seen-from-behind", "square",
    ),
    "normals flipped": (lambda: _scene(_named(place(_ball(normals=-_ball().normals)), "ball")), "normals-flipped", "ball"),
    "faceted": (lambda: _scene(_named(place(_ball(normals=None, tangents=None)), "ball")), "faceted", "ball"),
    "z-fighting": (lambda: _scene(place(SQUARE), _named(place(SQUARE, Lambert((1, 0, 0))), "poster")), "z-fighting", "poster"),
    "no uvs": (lambda: _scene(_named(place(SQUARE, Lambert(texture=checkers())), "square")), "no-uvs", "square"),
    "alpha 0": (lambda: _scene(_named(place(SQUARE, Lambert(alpha=0.0, alpha_mode="blend")), "ghost")), "alpha", "ghost"),
    "flattened": (lambda: _scene(_named(place(_ball(), matrix=transform.scale(1.0, 0.0, 1.0)), "flat")), "flattened", "flat"),
    "no area": (lambda: _scene(place(_ball()), _named(place(DOTS), "dots")), "degenerate", "dots"),
    "emissive room": (
        lambda: Scene(Node(children=(place(_ball(), Lambert(emission=(5, 5, 5))), place(SQUARE, at=(0, 0, -1)))), camera=FRONT),
        "emissive-only", "",
    ),
    "dark sky": (
        lambda: Scene(Node(children=(place(_ball()),)), camera=FRONT, environment=Environment((0.0, 0.0, 0.0))), "dark-sky", "environment",
    ),
    "missing texture": (lambda: _scene(place(_ball()), notes=("the picture wood.png is missing: drawn without",)), "missing-texture", ""),
}  # fmt: skip


@SLOW_AS_PYTHON
@pytest.mark.parametrize("fault", sorted(BROKEN))
def test_it_names_the_planted_fault_and_its_place(fault: str) -> None:
    """Each of these scenes has one fault, which is found where it is; and nothing else is."""
    make, kind, where = BROKEN[fault]
    found = doctor(make())
    assert found.kinds == (kind,), found.text()
    assert any(where in finding.where for finding in found.findings), found.text()
    assert all(finding.what and finding.why and finding.do for finding in found.findings)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", BUILTINS)
def test_it_finds_nothing_in_the_built_in_scenes(name: str) -> None:
    """They are sound."""
    assert doctor(builtin(name)).text() == "nothing is wrong"


@SLOW_AS_PYTHON
def test_it_finds_nothing_in_a_room_lit_by_a_lamp() -> None:
    """A camera and a lamp within a closed box are no fault; nor are spheres of triangles, squares side by side, a light in a glass ball."""
    left = place(SQUARE, Lambert((0.5, 0.4, 0.3)), at=(-1, 0, -1))
    lamp = Node("lamp", transform.translate(0, 1, 0), lights=(RectangleLight(intensity=8.0),))
    room = place(box((12.0, 12.0, 12.0)), Lambert((0.7, 0.7, 0.7)))
    scene = scene_of(room, left, place(SQUARE, at=(1.5, 0, -1)), place(_ball()), lamp, lit_from((0, 0, 1)), camera=FRONT)
    assert doctor(scene).is_sound, doctor(scene).text()


@SLOW_AS_PYTHON
def test_a_veil_of_glass_is_not_dark() -> None:
    """Bug: the rasteriser's clear glass, a veil of nearly no color, was said to be black. Fix: a veil's own light is not looked at."""
    clear = MetallicRoughness(metallic=0.0, roughness=0.0, transmission=Transmission())
    assert doctor(_scene(place(_ball(), clear))).is_sound


@SLOW_AS_PYTHON
def test_metal_in_an_empty_room_wants_an_environment() -> None:
    """Bug: brighter lights were advised, a thousandfold. Fix: what a metal lacks is something to mirror."""
    found = doctor(_scene(place(_ball(), MetallicRoughness(metallic=1.0, roughness=0.0)), lit_from((1.0, 3.0, -5.0))))
    assert found.kinds == ("too-dark",)
    assert "--environment" in found.findings[0].do
    assert "intensity" not in found.findings[0].do


@SLOW_AS_PYTHON
def test_noise_is_measured_where_it_is_asked_for() -> None:
    """One path through each pixel of a room with a small bright panel is noise, and the samples that help are told."""
    panel = place(two_triangles((-0.1, 2, -0.1), (0.1, 2, -0.1), (0.1, 2, 0.1), (-0.1, 2, 0.1)), Lambert(emission=(60, 60, 60)))
    room = place(Box((6.0, 6.0, 6.0)), Lambert((0.8, 0.8, 0.8)))
    scene = Scene(Node(children=(room, panel)), camera=PerspectiveCamera.look_at((0, 0, 2.5), (0, 0, 0)))
    found = doctor(scene, renderer="path", samples=1)
    assert found.kinds == ("noisy",)
    assert "--samples" in found.findings[0].do


def test_without_a_picture_only_the_description_is_looked_at() -> None:
    """What is planted in the description is found, and told for programs, too."""
    found = doctor(_unlit(), picture=False)
    assert found.kinds == ("no-power",)
    told = json.loads(found.json())
    assert told["is_sound"] is False
    assert told["findings"][0]["where"] == "world/lamp"
    assert "no light has any" in found.text()


def test_an_unknown_renderer_is_refused() -> None:
    """One line that lists the renderers."""
    with pytest.raises(UnsupportedError, match="renderer must be one of raster, ray, path, got 'rey'"):
        doctor("teapot", renderer="rey")


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", ["Duck", "Fox", "NegativeScaleTest", "Cameras"])
def test_it_finds_nothing_in_sound_models(name: str) -> None:
    """Models of the Khronos group, which are sound."""
    folder = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "khronos" / name
    files = sorted(folder.rglob("*.gltf")) + sorted(folder.rglob("*.glb"))
    if not files:
        pytest.skip(f"no {name} in the data folder")
    assert doctor(str(files[0])).text() == "nothing is wrong"
