"""Shaded pictures in styles: the formulas, and that lines lie over them."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, place

from limner.errors import SceneError, UnsupportedError
from limner.produce.stylized import banded, stylized, with_style
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.material import CoolToWarm, Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Sphere

EYE = PerspectiveCamera.look_at((0, 1, 4), (0, 0, 0))
BALL = Scene(root=Node(children=(place(Sphere(1.0), Lambert(color=(0.2, 0.6, 0.4))),)), camera=EYE)
SIZE = {"width": 40, "height": 30}


def test_bands_are_flat() -> None:
    """On every albedo the same few values of light over albedo, in order, their square roots evenly spaced; colours keep their hue."""
    light = np.linspace(0.0, 1.2, 400, dtype=np.float32)
    albedo = np.tile(np.array([0.5, 0.2, 0.1], dtype=np.float32), (1, 400, 1))
    pixels = np.ones((1, 400, 4), dtype=np.float32)
    pixels[..., :3] = albedo * light[:, None]
    made = banded(pixels, albedo, 4)
    factor = made[0, 1:, :3] / albedo[0, 1:]
    assert np.allclose(factor, factor[:, :1], atol=1e-5)
    assert (np.diff(factor[:, 0]) >= -1e-6).all()
    levels, counts = np.unique(np.round(np.sqrt(factor[:, 0]), 3), return_counts=True)
    assert np.allclose(levels[counts > 15], [0.125, 0.375, 0.625, 0.875], atol=1e-3)
    assert counts[counts > 15].sum() > 0.95 * 399
    nothing = np.zeros_like(albedo)
    assert (banded(pixels, nothing, 4) == pixels).all()


@SLOW_AS_PYTHON
@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_cool_to_warm_is_the_material(renderer: str) -> None:
    """The picture of the scene whose materials are CoolToWarm, to the bit; lines change what lies under them only."""
    dressed = with_style(BALL, "gooch")
    assert all(isinstance(material, CoolToWarm) for _, shape in dressed.shapes() for material in shape.materials)
    made = stylized(BALL, style="gooch", renderer=renderer, **SIZE)
    assert (made.pixels == render(dressed, renderer=renderer, **SIZE).pixels).all()
    lined = stylized(BALL, style="gooch", renderer=renderer, lines=True, **SIZE)
    changed = np.abs(lined.pixels - made.pixels).max(axis=2) > 0.01
    assert 20 < changed.sum() < 250
    assert lined.pixels[changed, :3].mean() < made.pixels[changed, :3].mean() or made.pixels[changed, 3].mean() < 1.0


@SLOW_AS_PYTHON
def test_what_lies_behind_shows_through() -> None:
    """Seen through, a ball within a ball is denser than its rim; a floor without end is left out."""
    inner = place(Sphere(0.4), Lambert())
    scene = BALL.replace(root=Node(children=(*BALL.root.children, inner, place(Plane(), at=(0, -1, 0)))))
    alpha = stylized(scene, style="xray", **SIZE).pixels[..., 3]
    assert alpha[15, 20] > alpha[15, 12] + 0.1 > 0.2
    assert alpha[28, 2] == 0.0


@SLOW_AS_PYTHON
def test_channels_stay() -> None:
    """What was asked for lies beside the picture, and nothing else."""
    made = stylized(BALL, style="toon", lines=True, aovs=("depth",), **SIZE)
    assert list(made.aov) == ["depth"]


def test_slips() -> None:
    """One line each."""
    with pytest.raises(UnsupportedError, match="gooch, toon, xray"):
        with_style(BALL, "nice")
    with pytest.raises(SceneError, match="bands"):
        stylized(BALL, bands=1)
