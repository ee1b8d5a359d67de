"""Reconstruction filters and culling in the rasteriser (FoCG 8.3, 8.1.2)."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, place, scene_of

from limner.errors import UnsupportedError
from limner.image.reconstruct import FILTERS, reconstruction
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.pixel_filter import filtered_samples
from limner.render import render
from limner.samples import pixel_samples
from limner.scene.camera import OrthographicCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Lambert
from limner.scene.node import Node

LIGHT = Node(lights=(AmbientLight(),))
WIDE = [name for name in FILTERS if name != "box"]


def _half_plane(edge: float) -> Mesh:
    """What lies to the left of x = edge, in pixels of the camera below."""
    corners = [(-50.0, -50.0, 0.0), (edge, -50.0, 0.0), (edge, 50.0, 0.0), (-50.0, 50.0, 0.0)]
    return Mesh(np.array(corners, np.float32), np.array([(0, 1, 2), (0, 2, 3)], np.int32))


def _alpha(filter_: str, edge: float, antialiasing: str = "multisample", **options: object) -> np.ndarray:
    camera = OrthographicCamera.look_at((7.5, 7.5, 10.0), (7.5, 7.5, 0.0), height=16)
    scene = scene_of(place(_half_plane(edge), Lambert(color=(1, 1, 1), double_sided=True)), LIGHT, camera=camera)
    image = render(scene, width=16, height=16, samples=1024, filter=filter_, antialiasing=antialiasing, tile_size=8, **options)
    return image.pixels[8, :, 3]


@pytest.mark.parametrize("name", FILTERS)
def test_weights_sum_to_the_number_of_samples_and_reach_as_far_as_the_filter(name: str) -> None:
    places, weights = filtered_samples(256, name)
    assert weights.sum(dtype=np.float64) == pytest.approx(256.0, rel=1e-6)
    radius = reconstruction(name).radius
    assert abs(places / 256.0).max() <= radius
    assert abs(places / 256.0).max() > 0.97 * radius
    assert abs((weights[:, None] * places).sum(axis=0) / 256.0 / 256.0).max() < 0.02


def test_the_box_is_what_it_was() -> None:
    places, weights = filtered_samples(8, "box")
    np.testing.assert_array_equal(places, pixel_samples(8))
    np.testing.assert_array_equal(weights, 1.0)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("antialiasing", ["multisample", "supersample"])
@pytest.mark.parametrize("name", WIDE)
def test_an_edge_is_the_integral_of_the_filter(name: str, antialiasing: str) -> None:
    """A pixel at distance x from a straight edge has the filter's integral up to there; so have its neighbours in other tiles."""
    edge = 7.75
    alpha = _alpha(name, edge, antialiasing)
    found = reconstruction(name)
    x = np.linspace(-found.radius, found.radius, 20001)
    cumulative = np.cumsum(found.function(x))
    cumulative /= cumulative[-1]
    expected = np.interp(edge - np.arange(16), x, cumulative, left=0.0, right=1.0)
    assert abs(alpha - np.clip(expected, 0.0, 1.0)).max() < 0.03


@pytest.mark.parametrize("name", ["mitchell", "gaussian"])
def test_tiles_do_not_show(name: str) -> None:
    """Samples outside their pixel lie in other tiles, too: the bits are the same without tiles."""
    camera = OrthographicCamera.look_at((7.5, 7.5, 10.0), (7.5, 7.5, 0.0), height=16)
    scene = scene_of(place(_half_plane(7.6), Lambert(color=(1, 0.5, 0.2), double_sided=True)), LIGHT, camera=camera)
    one, many = (render(scene, width=16, height=16, samples=16, filter=name, tile_size=size).pixels for size in (64, 8))
    np.testing.assert_array_equal(one, many)


def test_filters_of_others_are_refused() -> None:
    with pytest.raises(UnsupportedError, match="box"):
        _alpha("tent", 3.0, renderer="ray")
    with pytest.raises(UnsupportedError, match="mitchell"):
        _alpha("cubic", 3.0)


@pytest.mark.parametrize("double_sided", [False, True])
def test_culling(double_sided: bool) -> None:
    """From inside a box its backs are seen, from outside its fronts: each way to cull shows what it leaves, whatever the material."""
    camera = OrthographicCamera.look_at((0.0, 0.0, 10.0), (0.0, 0.0, 0.0), height=4)
    scene = scene_of(place(primitives.box((2.0, 2.0, 2.0)), Lambert(double_sided=double_sided)), LIGHT, camera=camera)

    def depth(culling: str) -> float:
        return float(render(scene, width=9, height=9, culling=culling, aovs=("depth",)).aov["depth"][4, 4])

    assert depth("none") == depth("back") == depth("material") == pytest.approx(9.0)
    assert depth("front") == pytest.approx(11.0)
    with pytest.raises(UnsupportedError, match="front"):
        depth("both")
