"""Shadows on the screen are those that the ray tracer finds (FoCG 4.7)."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, place, scene_of

from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight, DirectionalLight, PointLight, SpotLight
from limner.scene.material import BlinnPhong, Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Sphere

SIZE = {"width": 64, "height": 48}


def _nodes(glass: float = 1.0) -> tuple[Node, ...]:
    """A ball and a box over a floor."""
    mode = "blend" if glass < 1.0 else "opaque"
    ball = Lambert(color=(0.8, 0.3, 0.2), alpha=glass, alpha_mode=mode)
    return (
        place(Plane(), Lambert(color=(0.7, 0.7, 0.7))),
        place(Sphere(0.5), ball, at=(-0.7, 0.6, 0.3)),
        place(primitives.box((0.8, 0.8, 0.8)), BlinnPhong(diffuse=(0.3, 0.4, 0.8)), at=(0.7, 0.5, 0.0)),
        Node(lights=(AmbientLight(intensity=0.3),)),
    )


LIGHTS = {
    "sun": DirectionalLight(intensity=3.0),
    "lamp": PointLight(intensity=30.0),
    "spot": SpotLight(intensity=60.0),
}


def _light(name: str) -> Node:
    """A light above, to the right, that looks down."""
    down = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)  # -z becomes -y
    tilt = np.eye(4)
    tilt[:3, :3] = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]
    matrix = tilt @ down
    matrix[:3, 3] = (2.0, 4.0, 1.0)
    return Node(parent_from_node=matrix, lights=(LIGHTS[name],))


def _lit(name: str, glass: float = 1.0) -> Scene:
    camera = PerspectiveCamera.look_at((2.5, 2.5, 5.0), (0.0, 0.4, 0.0), yfov_degrees=40.0)
    return scene_of(*_nodes(glass), _light(name), camera=camera)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("antialiasing", ["supersample", "multisample"])
@pytest.mark.parametrize("name", LIGHTS)
def test_raster_casts_the_shadows_of_ray(name: str, antialiasing: str) -> None:
    """One sample in the middle of each pixel: the same colours, but for a ray or two that graze."""
    scene = _lit(name)
    on_screen = render(scene, **SIZE, samples=1, shadows=True, antialiasing=antialiasing).pixels
    traced = render(scene, **SIZE, samples=1, renderer="ray").pixels
    unshadowed = render(scene, **SIZE, samples=1).pixels
    differs = np.abs(on_screen - traced).max(axis=2) > 1.0 / 255.0
    assert differs.mean() < 0.002
    assert (np.abs(unshadowed - traced).max(axis=2) > 1.0 / 255.0).mean() > 0.015


@SLOW_AS_PYTHON
def test_what_is_half_transparent_casts_half_a_shadow() -> None:
    """As the ray tracer has it, through the blended layers, too."""
    scene = _lit("lamp", glass=0.5)
    on_screen = render(scene, **SIZE, samples=1, shadows=True).pixels
    traced = render(scene, **SIZE, samples=1, renderer="ray").pixels
    assert (np.abs(on_screen - traced).max(axis=2) > 1.0 / 255.0).mean() < 0.004


@SLOW_AS_PYTHON
def test_a_ground_shows_the_shadow_alone() -> None:
    """A shadow catcher is transparent where light falls and dark where it does not, as in the ray tracer."""
    camera = PerspectiveCamera.look_at((0.0, 2.0, 4.0), (0.0, 0.3, 0.0))
    scene = scene_of(place(Sphere(0.5), Lambert(), at=(0.0, 0.5, 0.0)), _light("lamp"), camera=camera).with_ground()
    on_screen = render(scene, **SIZE, samples=1, shadows=True, default_lights=False).pixels
    traced = render(scene, **SIZE, samples=1, renderer="ray", default_lights=False).pixels
    assert (np.abs(on_screen - traced).max(axis=2) > 2.0 / 255.0).mean() < 0.004
    assert render(scene, **SIZE, samples=1, default_lights=False).pixels[-1, :, 3].max() == 0.0
    assert on_screen[..., 3].min() == 0.0
