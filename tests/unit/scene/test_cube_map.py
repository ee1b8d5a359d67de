"""Cube maps become skies: every direction finds its side, in all layouts, and as much light comes from the sky as from the cube."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.errors import SceneError
from limner.scene.camera import PerspectiveCamera
from limner.scene.cube_map import side_of_direction, sides_of, sky_from_cube
from limner.scene.environment import Environment, direction_from_uv, uv_from_direction

N = 8
AXES = {"right": (1, 0, 0), "left": (-1, 0, 0), "up": (0, 1, 0), "down": (0, -1, 0), "front": (0, 0, -1), "back": (0, 0, 1)}


def _cube(seed: int = 1) -> NDArray[np.float64]:
    return np.random.default_rng(seed).uniform(0.0, 1.0, (6, N, N, 3))


def test_each_side_is_what_a_camera_at_the_centre_sees():
    """A pinhole camera with a right angle of view, turned to each side in turn: its corners and middle are the side's."""
    ups = {"up": (0, 0, 1), "down": (0, 0, -1)}
    for k, (name, axis) in enumerate(AXES.items()):
        camera = PerspectiveCamera.look_at((0, 0, 0), axis, up=ups.get(name, (0, 1, 0)), yfov_degrees=90)
        right, up, back = np.asarray(camera.place())[:3, :3].T
        for x, y in ((0.5, 0.5), (0.1, 0.2), (0.9, 0.3), (0.2, 0.95)):
            d = -back + right * (2 * x - 1) + up * (1 - 2 * y)
            side, found_x, found_y = side_of_direction(d[None])
            assert side[0] == k, name
            np.testing.assert_allclose([found_x[0], found_y[0]], [x, y], atol=1e-12)


def test_directions_of_the_sky_are_exact():
    """Six sides of one colour each: the sky has at every place the colour of the side that its direction meets."""
    sides = np.broadcast_to(np.arange(6.0)[:, None, None, None], (6, 4, 4, 3))
    sky = sky_from_cube(sides, height=32)
    v, u = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(64) + 0.5) / 64, indexing="ij")
    directions = direction_from_uv(np.stack([u, v], axis=-1))
    side, x, y = side_of_direction(directions)
    inner = (np.minimum(x, 1 - x) > 0.08) & (np.minimum(y, 1 - y) > 0.08)
    np.testing.assert_array_equal(sky[inner][:, 0], side[inner])
    for k, axis in enumerate(AXES.values()):
        u0, v0 = uv_from_direction(axis)
        assert sky[min(int(v0 * 32), 31), min(int(u0 * 64), 63), 0] == k


def test_as_much_light_comes_from_the_sky_as_from_the_cube():
    """Means over solid angle: of the cube's texels, each weighted by its own (Lambert's cosine over distance squared), and of the sky's."""
    sides = _cube()
    m = 40
    fine = ((np.arange(N * m) + 0.5) / (N * m) * 2.0 - 1.0) ** 2
    share = ((1.0 + fine[:, None] + fine[None, :]) ** -1.5).reshape(N, m, N, m).sum(axis=(1, 3))
    expected = (sides * share[None, :, :, None]).sum(axis=(0, 1, 2)) / (6.0 * share.sum())
    assert 6.0 * share.sum() * (2.0 / (N * m)) ** 2 == pytest.approx(4.0 * np.pi, rel=1e-4)
    height = 48
    sky = sky_from_cube(sides, height).astype(np.float64)
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    found = (sky.mean(axis=1) * -np.diff(edges)[:, None]).sum(axis=0) / 2.0
    np.testing.assert_allclose(found, expected, rtol=2e-3)
    even = sky_from_cube(np.ones((6, 3, 3, 3)))
    np.testing.assert_allclose(even, 1.0, rtol=1e-6)


def test_layouts_hold_the_same_cube():
    """Strips and crosses of the six pictures are the six pictures."""
    sides = _cube()
    right, left, up, down, front, back = sides
    empty = np.zeros_like(right)
    rows = [[empty, up, empty, empty], [left, front, right, back], [empty, down, empty, empty]]
    wide = np.concatenate([np.concatenate(row, axis=1) for row in rows])
    rows = [[empty, up, empty], [left, front, right], [empty, down, empty], [empty, back[::-1, ::-1], empty]]
    tall = np.concatenate([np.concatenate(row, axis=1) for row in rows])
    for layout in (list(sides), np.concatenate(sides), np.concatenate(sides, axis=1), wide, tall):
        np.testing.assert_array_equal(sides_of(layout), sides.astype(np.float32))
    environment = Environment.from_cube(wide, intensity=2.0)
    assert environment.source.shape == (2 * N, 4 * N, 3)
    assert environment.intensity == 2.0


@pytest.mark.parametrize(
    "wrong", [np.zeros((5, 4, 4, 3)), np.zeros((6, 4, 5, 3)), np.zeros((6, 4, 4, 4)), np.zeros((6, 4, 4, 3), int), np.zeros((7, 4, 3))]
)
def test_what_is_no_cube_is_said(wrong):
    """Its shape, and what was expected."""
    with pytest.raises(SceneError, match=r"a cube map must be six \(n, n, 3\) float pictures, a strip or a cross"):
        Environment.from_cube(wrong)
