"""From where a displaced shape is seen: a grid of cells, each of which demands what any camera in it would."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.linear import transform
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.tables.relief import vantage
from limner.tables.stand_ins import Sight

BOUNDS = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
W, H = 160, 120


def _seen(camera: PerspectiveCamera, a: NDArray[np.float64], b: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """How long edges of the world are in the picture, but for the lens's stretch away from the middle, and which are in it."""
    eye = np.asarray(camera.world_from_camera)[:3, 3]
    scale = H / (2.0 * camera.half_height())
    middle = (a + b) / 2.0 - eye
    far = np.linalg.norm(middle, axis=1)
    along = ((b - a) * middle).sum(axis=1) / far
    length = scale * np.sqrt(np.maximum(((b - a) ** 2).sum(axis=1) - along**2, 0.0)) / far
    place = transform.transform_points(np.linalg.inv(np.asarray(camera.world_from_camera)), (a + b) / 2.0)
    inside = (np.abs(place[:, :2] / -place[:, 2:] * scale) <= (W / 2.0, H / 2.0)).all(axis=1) & (place[:, 2] < 0.0)
    return length, inside


@pytest.mark.parametrize("seed", range(6))
def test_no_edge_is_seen_longer_than_its_vantage_says(seed: int) -> None:
    """For random cameras and places, turned and unevenly scaled: never shorter than in the picture, and not 1.7 times as long."""
    rng = np.random.default_rng(seed)
    eye = rng.normal(size=3) * rng.choice([2.0, 6.0, 30.0]) + (0.0, 3.0, 0.0)
    camera = PerspectiveCamera.look_at(eye, rng.normal(size=3) * 0.2, yfov_degrees=float(rng.uniform(15, 60)))
    uneven, turned = transform.scale(*rng.uniform(0.5, 2.0, 3)), transform.rotate(rng.normal(size=3), 1.0)
    matrix = transform.in_order(uneven, turned, transform.translate(*rng.normal(size=3) * 0.1))
    a = rng.uniform(-1.0, 1.0, (4000, 3))
    b = a + rng.normal(size=(4000, 3)) * 1e-3
    view = vantage(matrix, np.linalg.inv(matrix), Sight(camera, W, H, BOUNDS), BOUNDS)
    told = view.lengths(a, b)
    seen, inside = _seen(camera, transform.transform_points(matrix, a), transform.transform_points(matrix, b))
    far = np.linalg.norm(transform.transform_points(matrix, a) - eye, axis=1) > 0.3
    broad = inside & far & (seen > 0.4 * told)
    assert broad.sum() > 300
    # What points to the camera turns a little as the camera moves within its cell, and counts by more than it is seen.
    assert (seen / told)[inside & far].max() <= 1.02
    assert (told / seen)[broad & (seen > 0.95 * told.max())].max(initial=1.0) < 1.7


def test_cameras_of_one_cell_are_one() -> None:
    """A small step, a small turn, a turned object and camera: the very same numbers; a large step or turn: others."""
    camera = PerspectiveCamera.look_at((3.1, 1.05, 4.02), (0, 0, 0))
    one = np.eye(4)
    first = vantage(one, one, Sight(camera, W, H, BOUNDS), BOUNDS)
    assert vantage(one, one, Sight(PerspectiveCamera.look_at((3.101, 1.05, 4.021), (0, 0, 0)), W, H, BOUNDS), BOUNDS) == first
    turned = transform.rotate((0, 1, 0), 0.7)
    both = PerspectiveCamera(world_from_camera=turned @ camera.world_from_camera, yfov_degrees=camera.yfov_degrees)
    again = vantage(turned, np.linalg.inv(turned), Sight(both, W, H, BOUNDS), BOUNDS)
    assert again[:4] == first[:4]
    assert vantage(one, one, Sight(PerspectiveCamera.look_at((4.0, 1.05, 4.02), (0, 0, 0)), W, H, BOUNDS), BOUNDS) != first
    assert vantage(one, one, Sight(PerspectiveCamera.look_at((3.1, 1.05, 4.02), (2, 0, 0)), W, H, BOUNDS), BOUNDS) != first


def test_orthographic_cameras_see_all_at_one_scale() -> None:
    """Pixels are metres times the picture's height over the camera's, to the next eighth of an octave, wherever it stands."""
    camera = OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=3.0)
    matrix = transform.scale(2.0, 2.0, 2.0)
    view = vantage(matrix, np.linalg.inv(matrix), Sight(camera, W, H, BOUNDS), BOUNDS)
    length = view.lengths(np.zeros((1, 3)), np.array([[0.1, 0.0, 0.0]]))
    assert 8.0 <= length[0] <= 8.0 * 2 ** (1 / 8)


def test_transforms_that_flatten_are_looked_at_all_the_same() -> None:
    """Finite numbers where a direction is lost, where nothing is left, and from inside the shape."""
    for matrix in (transform.scale(1.0, 0.0, 1.0), transform.scale(0.0, 0.0, 0.0)):
        for eye in ((3.0, 2.0, 1.0), (0.1, 0.0, 0.0)):
            camera = PerspectiveCamera.look_at(eye, (0, 0, -9))
            view = vantage(matrix, np.linalg.pinv(matrix), Sight(camera, W, H, BOUNDS), BOUNDS)
            assert np.isfinite(view.lengths(np.zeros((2, 3)), np.ones((2, 3)))).all()
