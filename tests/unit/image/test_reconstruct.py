"""Reconstruction filters: their closed forms, and what every picture between its pixels must obey."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError, UnsupportedError
from limner.image.image import Image
from limner.image.reconstruct import FILTERS, reconstruction, taps

NAMES = sorted(FILTERS)
INTERPOLATING = ("box", "tent", "lanczos3")


def _random(height: int = 9, width: int = 11, *, opaque: bool = True) -> Image:
    pixels = np.random.default_rng(1).random((height, width, 4), dtype=np.float32)
    if opaque:
        pixels[..., 3] = 1.0
    return Image(pixels)


@pytest.mark.parametrize(("name", "slack"), [("box", 1e-12), ("tent", 1e-12), ("mitchell", 1e-12), ("lanczos3", 0.011), ("gaussian", 0.28)])
def test_translates_sum_to_one(name: str, slack: float) -> None:
    """A partition of unity at every place: exactly for box, tent and Mitchell's piecewise cubic, nearly for the others."""
    kind = FILTERS[name]
    place = np.linspace(-0.5, 0.5, 101, endpoint=False)
    near = np.arange(-5, 6)
    assert np.abs(kind.function(place[:, None] - near).sum(axis=1) - 1.0).max() <= slack


@pytest.mark.parametrize("name", NAMES)
def test_divided_weights_sum_to_one(name: str) -> None:
    """Inside, at edges and far outside, stretched or not: what makes constants constant."""
    for stretch in (1.0, 1.7, 4.0):
        made = taps(np.linspace(-30.0, 40.0, 333), 10, FILTERS[name], stretch)
        assert np.abs(made.weights.sum(axis=1) - 1.0).max() < 1e-12
        assert made.pixels.min() >= 0
        assert made.pixels.max() <= 9


@pytest.mark.parametrize("name", NAMES)
def test_filters_end_at_their_radius_and_are_even(name: str) -> None:
    """f(x) = f(-x), and nothing beyond the radius; all but the box are continuous there."""
    kind = FILTERS[name]
    x = np.linspace(0.0, kind.radius, 200, endpoint=False)[1:]
    np.testing.assert_allclose(kind.function(x), kind.function(-x), atol=1e-14)
    assert (kind.function(np.array([kind.radius + 1e-9, -kind.radius - 1e-9, 9.0])) == 0.0).all()
    if name != "box":
        assert abs(kind.function(np.array([kind.radius - 1e-6]))[0]) < 1e-5


def test_mitchell_has_its_published_values() -> None:
    """B = C = 1/3: 8/9 in the middle, 1/18 at one pixel, -7/288 ... by hand at 3/2."""
    values = FILTERS["mitchell"].function(np.array([0.0, 1.0, 1.5, 2.0]))
    a = 1.5
    at_three_halves = ((-1 / 3 - 2) * a**3 + (2 + 10) * a**2 + (-4 - 16) * a + (8 / 3 + 8)) / 6
    np.testing.assert_allclose(values, [8 / 9, 1 / 18, at_three_halves, 0.0], atol=1e-15)


@pytest.mark.parametrize("name", INTERPOLATING)
def test_interpolating_filters_go_through_the_pixels(name: str) -> None:
    """At integers the picture is its pixels: column x, row y from the top."""
    image = _random()
    y, x = np.mgrid[0:9, 0:11]
    np.testing.assert_allclose(image.sample(x, y, filter=name), image.pixels, atol=1e-6)


@pytest.mark.parametrize("name", ["tent", "mitchell"])
def test_a_ramp_stays_a_ramp(name: str) -> None:
    """Filters that reproduce linear functions do, away from the edges: I(x, y) = 2 x - y + 30."""
    pixels = np.ones((20, 20, 4), dtype=np.float32)
    y, x = np.mgrid[0:20, 0:20]
    pixels[..., 0] = 2.0 * x - y + 30.0
    rng = np.random.default_rng(2)
    px, py = rng.uniform(2.0, 17.0, (2, 50))
    np.testing.assert_allclose(Image(pixels).sample(px, py, filter=name)[:, 0], 2.0 * px - py + 30.0, atol=1e-4)


@pytest.mark.parametrize("name", NAMES)
@given(x=st.floats(-40, 40), y=st.floats(-40, 40))
def test_a_constant_picture_is_constant_everywhere(name: str, x: float, y: float) -> None:
    """To the bit, inside and out."""
    pixels = np.full((5, 6, 4), 0.3337, dtype=np.float32)
    pixels[..., 3] = 1.0
    assert (Image(pixels).sample(x, y, filter=name) == pixels[0, 0]).all()


def test_the_doors_coordinates_are_the_books_but_for_the_row() -> None:
    """I(x, y) at x = i, y = height - 1 - j is at(i, j)."""
    image = _random()
    for i, j in ((0, 0), (10, 0), (3, 8), (7, 2)):
        assert (image.sample(i, image.height - 1 - j, filter="box") == image.at(i, j)).all()


def test_what_is_transparent_has_no_colour() -> None:
    """Half-way between opaque red and transparent green there is half-covering red."""
    pixels = np.float32([[[1, 0, 0, 1], [0, 1, 0, 0]]])
    np.testing.assert_allclose(Image(pixels).sample(0.5, 0.0, filter="tent"), [1.0, 0.0, 0.0, 0.5])


def test_shapes_and_slips() -> None:
    """Any shape in, the same out; unknown filters and places that are no places are refused."""
    image = _random()
    assert image.sample(np.zeros((3, 1)), np.zeros((1, 5))).shape == (3, 5, 4)
    assert image.sample(1.0, 2.0).shape == (4,)
    with pytest.raises(UnsupportedError, match="box, tent, gaussian, mitchell, lanczos3, got 'sinc'"):
        image.sample(0, 0, filter="sinc")
    with pytest.raises(SceneError, match="finite"):
        image.sample(np.nan, 0)
    assert reconstruction("tent").radius == 1.0
