"""Resampling: constants to the bit, means kept, no aliases, no colour from what is transparent; SciPy and Pillow agree."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Picture

from limner.errors import SceneError
from limner.image.image import Image
from limner.image.reconstruct import FILTERS
from limner.image.separable import convolution_taps, filtered

NAMES = sorted(FILTERS)
SIDES = st.integers(1, 40)


@pytest.mark.parametrize("name", NAMES)
@given(size=st.tuples(SIDES, SIDES), new=st.tuples(SIDES, SIDES), alpha=st.sampled_from([1.0, 0.3]))
def test_a_constant_picture_stays_the_same_to_the_bit(name: str, size: tuple[int, int], new: tuple[int, int], alpha: float) -> None:
    """Whatever the sizes; opaque or not."""
    pixels = np.full((*size, 4), (0.1, 1.7, 1 / 3, alpha), dtype=np.float32)
    made = Image(pixels).resized(*new, filter=name)
    assert made.pixels.shape == (new[1], new[0], 4)
    assert (made.pixels == pixels[0, 0]).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("factor", [2, 3, 4])
def test_the_mean_is_kept(name: str, factor: int) -> None:
    """Shrinking by whole factors loses no light but at the edges: a spot in the middle keeps its sum."""
    pixels = np.zeros((48, 48, 4), dtype=np.float32)
    pixels[..., 3] = 1.0
    pixels[20:28, 20:28, :3] = 1.0
    made = Image(pixels).resized(48 // factor, 48 // factor, filter=name)
    assert made.pixels[..., 0].sum() * factor**2 == pytest.approx(64.0, rel=0.005)


@pytest.mark.parametrize("name", ["tent", "gaussian", "mitchell", "lanczos3"])
def test_stripes_too_fine_to_be_shown_become_grey(name: str) -> None:
    """No alias: stripes of one pixel, shrunk to a third, are even in the middle of the picture."""
    pixels = np.ones((60, 60, 4), dtype=np.float32)
    pixels[:, ::2, :3] = 0.0
    made = Image(pixels).resized(20, 20, filter=name).pixels[5:15, 5:15, 0]
    assert np.abs(made - 0.5).max() < 0.06


@pytest.mark.parametrize(("name", "pillows"), [("tent", "BILINEAR"), ("lanczos3", "LANCZOS")])
@pytest.mark.parametrize("size", [(20, 13), (90, 70), (37, 29)])
def test_pillow_agrees(name: str, pillows: str, size: tuple[int, int]) -> None:
    """The same filter in another implementation, inside (Pillow leaves taps beyond the edge out, we hold them)."""
    grey = np.random.default_rng(0).random((40, 50), dtype=np.float32)
    pixels = np.ones((40, 50, 4), dtype=np.float32)
    pixels[..., :3] = grey[..., None]
    theirs = np.asarray(Picture.fromarray(grey).resize(size, getattr(Picture.Resampling, pillows)))
    ours = Image(pixels).resized(*size, filter=name).pixels[..., 0]
    edge = 3 * max(1, round(size[0] / 50) + 1)
    inner = (slice(edge, -edge), slice(edge, -edge))
    np.testing.assert_allclose(ours[inner], theirs[inner], atol=2e-5)


def test_the_same_size_is_the_same_picture_where_the_filter_interpolates() -> None:
    """Box, tent and Lanczos are 1 at 0 and 0 at other integers."""
    image = Image(np.random.default_rng(3).random((8, 9, 4), dtype=np.float32))
    for name in ("box", "tent", "lanczos3"):
        np.testing.assert_allclose(image.resized(9, 8, filter=name).pixels, image.pixels, atol=2e-6)


def test_what_is_transparent_does_not_bleed_in() -> None:
    """Green that cannot be seen beside opaque red leaves no green, whatever the filter; alpha stays in [0, 1]."""
    pixels = np.zeros((16, 16, 4), dtype=np.float32)
    pixels[:, :8] = (1.0, 0.0, 0.0, 1.0)
    pixels[:, 8:] = (0.0, 1.0, 0.0, 0.0)
    for name in NAMES:
        for size in ((5, 5), (31, 31)):
            made = Image(pixels).resized(*size, filter=name).pixels
            assert (made[..., 1] == 0.0).all()
            assert made[..., 3].min() >= 0.0
            assert made[..., 3].max() <= 1.0
            np.testing.assert_allclose(made[..., 0][made[..., 3] > 0.01], 1.0, atol=1e-5)


def test_the_print_stays_as_large() -> None:
    """Half the pixels, half the dots per inch; the recipe stays, AOVs do not."""
    image = Image(np.ones((10, 20, 4), dtype=np.float32), aov={"depth": np.ones((10, 20))}, recipe={"seed": 1}, dpi=300.0)
    made = image.resized(10, 5)
    assert (made.dpi, made.print_size(), made.recipe, dict(made.aov)) == (150.0, image.print_size(), {"seed": 1}, {})


@pytest.mark.parametrize("size", [(0, 5), (5, -1), (1.5, 2), (True, 2), (40000, 2)])
def test_sizes_that_are_none_are_refused(size: tuple) -> None:
    """With what was given."""
    with pytest.raises(SceneError, match="must be an integer from 1 to 32768"):
        Image(np.ones((2, 2, 4), dtype=np.float32)).resized(*size)


def test_convolution_is_scipys() -> None:
    """The banded matrices against ndimage, with edges that go on, for a kernel that is not even."""
    from scipy.ndimage import convolve1d

    planes = np.random.default_rng(1).random((70, 45, 2))
    kernel = np.array([0.1, 0.5, -0.2, 0.4, 0.9])
    expected = convolve1d(convolve1d(planes, kernel, axis=0, mode="nearest"), kernel, axis=1, mode="nearest")
    np.testing.assert_allclose(filtered(planes, convolution_taps(kernel, 70), convolution_taps(kernel, 45)), expected, atol=1e-12)
