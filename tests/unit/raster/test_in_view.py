"""Instances beside the picture are left out, and nothing that is in it."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, place, scene_of

from limner.errors import UnsupportedError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.raster import in_view
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.scene import Scene
from limner.tables.build import flatten, view


def _crowd() -> Scene:
    random = np.random.default_rng(4)
    ball = primitives.sphere(0.4, 6)
    places = np.eye(4) + np.zeros((200, 1, 1))
    places[:, :3, :3] = random.normal(size=(200, 3, 3)) * 0.6
    places[:, :3, 3] = random.normal(size=(200, 3)) * 3.0
    return scene_of(*(place(ball, matrix=matrix) for matrix in places))


def _seen(scene: Scene, camera: PerspectiveCamera) -> np.ndarray:
    built = flatten(scene, camera, 64, 48)
    return in_view.instances_in_view(built.tables, view(scene, built.tables, camera, 64, 48), 64, 48, (-128, 128))


@SLOW_AS_PYTHON
def test_leaving_out_what_is_not_seen_changes_no_bit(monkeypatch):
    """From amid a crowd, with one behind the camera, one around it and many beside: the same picture as with everything drawn."""
    scene = _crowd()
    for target in ((1, 0, 0), (0.3, 1, 0.2)):
        camera = PerspectiveCamera.look_at((0, 0, 0), target, up=(0, 0, 1), yfov_degrees=60)
        seen = _seen(scene, camera)
        assert 3 < seen.sum() < 120
        few = render(scene, camera=camera, width=64, height=48, samples=4, aovs=("instance_id",))
        with monkeypatch.context() as all_drawn:
            all_drawn.setattr(in_view, "_REPEATED", 1 << 40)
            every = render(scene, camera=camera, width=64, height=48, samples=4, aovs=("instance_id",))
        np.testing.assert_array_equal(few.pixels, every.pixels)
        assert set(np.unique(every.aov["instance_id"])) - {-1} <= set(np.flatnonzero(seen))
        assert len(np.unique(every.aov["instance_id"])) > 3


def test_more_than_can_be_told_apart_is_refused(monkeypatch):
    """One line that says how many there are, and what can draw them."""
    monkeypatch.setattr(in_view, "_MOST_WORDS", 1 << 12)
    scene = scene_of(*(place(primitives.sphere(), matrix=transform.translate(k, 0, 0)) for k in range(3)))
    with pytest.raises(UnsupportedError, match=r"at most \d+ triangles in a picture, here are \d+; ray and path"):
        render(scene, width=16, height=16)
