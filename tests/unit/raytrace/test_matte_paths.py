"""The door of scenes that are matte alone: the same pictures by less code, and for no other scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from limner._jit import MODE
from limner.mesh.shapes import primitives
from limner.raytrace import driver
from limner.raytrace.driver import Stage
from limner.render import Renderer
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.fog import Fog
from limner.scene.light import AmbientLight, RectangleLight
from limner.scene.material import Dielectric, Lambert, Material, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere
from tests.staging import SLOW_AS_PYTHON, checkers, grid, place, point_light_at

CAMERA = PerspectiveCamera.look_at((0.0, 1.2, 4.0), (0.0, 0.3, 0.0), yfov_degrees=40.0)


def scene_with(material: Material, fog: Fog | None = None) -> Scene:
    """A smooth mesh and a ball over a floor, lit by a lamp, by a mesh that shines, from all around, and by a sky."""
    glow = Lambert(color=(0.2, 0.2, 0.2), emission=(4.0, 3.0, 2.0))
    nodes = (
        place(grid(2, 3.0), Lambert(color=(0.7, 0.4, 0.2))),
        place(primitives.sphere(0.5, 12), material, at=(-0.6, 0.5, 0.0)),
        Node(shapes=(Shape(Sphere(0.3), (Lambert(color=(0.1, 0.6, 0.3)),)),)),
        place(primitives.sphere(0.2, 6), glow, at=(0.8, 0.8, 0.3)),
        point_light_at((0.0, 3.0, 0.0), RectangleLight(width=0.5, height=0.5, intensity=3.0)),
        Node(lights=(AmbientLight(intensity=0.1),)),
    )
    return Scene(Node(children=nodes), camera=CAMERA, environment=Environment((0.3, 0.4, 0.5)), fog=fog)


def drawn(scene: Scene, **settings: Any) -> np.ndarray:
    with Renderer(scene, renderer="path", threads=1, **{"width": 12, "height": 8, "samples": 2, "max_depth": 5, **settings}) as renderer:
        return renderer.render().pixels.copy()


@SLOW_AS_PYTHON
def test_both_doors_draw_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the matte door leaves out would have done nothing."""
    scene = scene_with(Lambert(color=(0.8, 0.8, 0.3)))
    short = drawn(scene, width=36, height=24, samples=8)
    monkeypatch.setattr(Stage, "is_matte", lambda stage: False)
    np.testing.assert_array_equal(drawn(scene, width=36, height=24, samples=8), short)


def flat_scene(camera: Camera = CAMERA, sky: Environment | None = None) -> Scene:
    """Flat triangles, turned, stretched and mirrored, and a ball, under a mesh that shines."""
    glow, paint = Lambert(emission=(6.0, 5.0, 4.0), double_sided=False), Lambert(color=(0.7, 0.5, 0.3))
    box = primitives.box((0.7, 0.5, 0.9))
    turned = affine(((-1.0, 0.3, 0.0), (0.2, 0.8, 0.0), (0.0, 0.1, 1.2)), (0.5, 0.4, 0.2))
    nodes = (
        place(grid(2, 3.0), Lambert(color=(0.3, 0.5, 0.8))),
        Node(shapes=(Shape(box, (paint,)),), parent_from_node=turned),
        Node(shapes=(Shape(Sphere(0.3), (paint,)),)),
        place(primitives.box((0.4, 0.3, 0.2)), glow, at=(-0.7, 1.3, 0.3)),
    )
    return Scene(Node(children=nodes), camera=camera, environment=sky)


def affine(linear: tuple[tuple[float, float, float], ...], move: tuple[float, float, float]) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, move
    return matrix


THROUGH_A_LENS = replace(CAMERA, aperture_radius=0.1, focus_distance=4.0)
FROM_AFAR = OrthographicCamera.look_at((0.0, 1.2, 4.0), (0.0, 0.3, 0.0), height=2.5)


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        (flat_scene(), {}),
        (flat_scene(sky=Environment((0.3, 0.4, 0.5))), {"max_depth": 1}),
        (flat_scene(), {"max_depth": 400, "samples": 1}),
        (flat_scene(THROUGH_A_LENS), {"sampler": "multijittered"}),
        (flat_scene(FROM_AFAR), {"sampler": "halton"}),
    ],
    ids=["flat", "one scattering", "deep", "lens", "parallel"],
)
def test_eight_paths_at_a_time_are_eight_paths(scene: Scene, settings: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the camera, the sampler and the surfaces; with a number of paths that no block and no eight divides."""
    settings = {"width": 37, "height": 23, "samples": 3, **settings}
    eight = drawn(scene, **settings)
    monkeypatch.setattr(Stage, "is_matte", lambda stage: False)
    np.testing.assert_array_equal(drawn(scene, **settings), eight)


@pytest.mark.skipif(MODE == "compiled", reason="the compiled door traces eight at a time anyway")
def test_lanes_uncompiled_give_the_same_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lanes of the uncompiled classes round as the numbers do."""
    one = drawn(flat_scene(), width=5, height=4, samples=1)
    monkeypatch.setattr(driver, "MODE", "compiled")
    np.testing.assert_array_equal(drawn(flat_scene(), width=5, height=4, samples=1), one)


@pytest.mark.parametrize(
    ("material", "fog", "is_matte"),
    [
        (Lambert(), None, True),
        (Lambert(texture=checkers(2)), None, False),
        (Lambert(alpha=0.5, alpha_mode="blend"), None, False),
        (MetallicRoughness(), None, False),
        (Dielectric(), None, False),
        (Lambert(), Fog(density=0.1), False),
    ],
    ids=["matte", "textured", "blended", "shining", "glass", "fog"],
)
def test_only_matte_scenes_take_the_short_way(monkeypatch: pytest.MonkeyPatch, material: Material, fog: Fog | None, is_matte: bool) -> None:
    """One surface of another kind, or fog, and the scene takes the usual door."""
    said: list[bool] = []
    ask = Stage.is_matte
    monkeypatch.setattr(Stage, "is_matte", lambda stage: said.append(ask(stage)) or said[-1])
    drawn(scene_with(material, fog), width=1, height=1, samples=1, max_depth=0)
    assert said
    assert set(said) == {is_matte}


@SLOW_AS_PYTHON
@pytest.mark.parametrize("color", [(0.02, 0.02, 0.02), (0.9, 0.5, 0.1)], ids=["dark", "coloured"])
def test_roulette_measures_a_path_by_its_first_surface(color: tuple[float, float, float]) -> None:
    """Inside a ball that shines with 1 and reflects a, 16 samples come within 2 % of 1 + a + a^2 + ... however dark the ball is: a dark
    one's light is not left to chance at its first surface."""
    ball = Shape(Sphere(2.0), (Lambert(color=color, emission=(1.0, 1.0, 1.0)),))
    scene = Scene(Node(shapes=(ball,)), camera=PerspectiveCamera(yfov_degrees=70.0))
    seen = drawn(scene, width=24, height=24, samples=16, max_depth=40)[..., :3]
    np.testing.assert_allclose(seen.mean(axis=(0, 1)), 1.0 / (1.0 - np.array(color)), rtol=0.02)
