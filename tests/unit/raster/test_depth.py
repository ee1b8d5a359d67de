"""The z-buffer (FoCG 8.2.3): the nearest surface wins, in any order of drawing, and by as little as float32 can tell."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, grid, place, scene_of, two_triangles

from limner.linear import transform
from limner.render import render
from limner.samples import GRID, pixel_samples
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.node import Node


def _ids(nodes: tuple[Node, ...], camera: object) -> NDArray[np.int32]:
    image = render(scene_of(*nodes, camera=camera), width=80, height=60, samples=1, aovs=("instance_id",))
    return image.aov["instance_id"]


@SLOW_AS_PYTHON
def test_the_order_of_drawing_does_not_matter():
    """Three sheets through each other: every permutation shows the same."""
    tilts = (0.0, 0.5, -0.7)
    sheets = [place(grid(2, 1.0), matrix=transform.rotate_z(t) @ transform.rotate_x(0.3 * k)) for k, t in enumerate(tilts)]
    for camera in (PerspectiveCamera.look_at((0.3, 2, 1.5), (0, 0, 0)), OrthographicCamera.look_at((0.3, 2, 1.5), (0, 0, 0), height=2)):
        pictures = []
        for order in itertools.permutations(range(3)):
            ids = _ids(tuple(sheets[k] for k in order), camera)
            pictures.append(np.where(ids < 0, -1, np.array((*order, -1))[ids]))
        for picture in pictures[1:]:
            np.testing.assert_array_equal(picture, pictures[0])
        assert set(np.unique(pictures[0])) == {-1, 0, 1, 2}


def test_a_sheet_just_above_a_floor_that_passes_under_the_camera():
    """Bug: depth was anchored in the middle of the floor's triangle, far outside the picture, and had no digits left inside it."""
    camera = PerspectiveCamera.look_at((0, 1.7, 1), (0.3, 1, -5), yfov_degrees=60)
    sheet = place(grid(2, 3.0), at=(0, 1e-5, -4))
    ids = _ids((place(grid(2, 10.0)), sheet), camera)
    alone = _ids((sheet,), camera)
    np.testing.assert_array_equal(ids == 1, alone == 0)


def test_equal_depth_goes_to_the_first_drawn():
    wall = two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    assert (_ids((place(wall), place(wall), place(wall)), PerspectiveCamera.look_at((1, 2, 3), (0, 0, 0))) == 0).all()


def test_near_and_far_cut():
    """What lies before the near or behind the far plane is not drawn, by both kinds of camera."""
    walls = tuple(place(two_triangles((-9, -9, -z), (9, -9, -z), (9, 9, -z), (-9, 9, -z))) for z in (1.0, 2.0, 3.0))
    for kind in (PerspectiveCamera, OrthographicCamera):
        assert (_ids(walls, kind(near=0.5, far=10.0)) == 0).all()
        assert (_ids(walls, kind(near=1.5, far=10.0)) == 1).all()
        assert (_ids(walls, kind(near=2.5, far=2.9)) == -1).all()
        assert (_ids(walls[::-1], kind(near=2.5, far=3.5)) == 0).all()


def test_samples_are_spread_over_the_pixel():
    """Each of n columns and rows holds one (a net of Sobol's), their mean is the centre, and so is a single one (FoCG 8.3)."""
    assert pixel_samples(1).tolist() == [[0, 0]]
    for n in (2, 4, 8, 16, 64):
        places = pixel_samples(n)
        assert np.abs(places.mean(axis=0)).max() == 0.0
        assert places.dtype == np.int32
        assert places.min() >= -GRID // 2
        assert places.max() < GRID // 2
        cells = (places + GRID // 2) * n // GRID
        assert sorted(cells[:, 0]) == list(range(n))
        assert sorted(cells[:, 1]) == list(range(n))
        # However few of them are taken, each half of the pixel has its share.
        for k in range(1, n + 1):
            assert np.abs((places[:k] < 0).sum(axis=0) - k / 2).max() <= 1.0


def test_edges_get_as_many_grey_levels_as_there_are_samples():
    """A half-plane that moves over a pixel covers 0, 1/n, ... 1 of it (FoCG 8.3)."""
    n, levels = 8, set()
    for x in np.linspace(-0.6, 0.6, 40):
        wall = two_triangles((x, -9, 0), (9, -9, 0), (9, 9, 0), (x, 9, 0))
        camera = OrthographicCamera.look_at((0, 0, 1), (0, 0, 0), height=1.0)
        levels.add(float(render(scene_of(place(wall), camera=camera), width=1, height=1, samples=n).pixels[0, 0, 3]))
    assert levels == {k / n for k in range(n + 1)}
