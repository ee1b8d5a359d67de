"""Measures of difference: closed forms, laws, and the picture of where."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.errors import SceneError, UnsupportedError
from limner.image.compare import METRICS, compared, difference_picture, flip, psnr, rel_mse, rmse, ssim, ssim_of
from limner.image.flip import flip_map, pixels_per_degree
from limner.image.image import Image


def _grey(value: float, alpha: float = 1.0, size: int = 16) -> Image:
    pixels = np.full((size, size, 4), value, dtype=np.float32)
    pixels[..., 3] = alpha
    return Image(pixels)


def _random(seed: int = 0, size: int = 32) -> Image:
    pixels = np.random.default_rng(seed).random((size, size, 4), dtype=np.float32)
    pixels[..., 3] = 1.0
    return Image(pixels)


def test_a_picture_is_like_itself() -> None:
    """No difference by any measure."""
    found = compared(_random(), _random())
    assert (found.rmse, found.rel_mse, found.psnr, found.flip, found.max_difference, found.n_different) == (0, 0, math.inf, 0, 0, 0)
    assert found.ssim == pytest.approx(1.0, abs=1e-12)


def test_closed_forms_of_constants() -> None:
    """Half against three quarters: by hand."""
    a, b = _grey(0.5), _grey(0.75)
    assert rmse(a, b) == pytest.approx(0.25)
    assert rel_mse(a, b) == pytest.approx(0.0625 / 0.26)
    assert psnr(_grey(0.0), _grey(1.0)) == pytest.approx(0.0)
    assert ssim_of(np.full((20, 20), 0.5), np.full((20, 20), 0.25)) == pytest.approx((0.25 + 1e-4) / (0.3125 + 1e-4))


def test_alpha_counts() -> None:
    """Colours are compared as they cover; where nothing else differs the alpha itself does."""
    assert rmse(_grey(0.5, 0.5), _grey(0.25, 1.0)) == pytest.approx(math.sqrt(0.25 / 4))
    assert rmse(_grey(0.7, 0.0), _grey(0.1, 0.0)) == 0.0


def test_flip_of_black_and_white_is_near_one() -> None:
    """The greatest difference of lightness; symmetric; more noise is more."""
    assert flip(_grey(0.0), _grey(1.0)) > 0.9
    assert flip(_random(0), _random(1)) == pytest.approx(flip(_random(1), _random(0)), rel=1e-6)
    reference = _random().pixels
    noise = np.random.default_rng(5).normal(size=(32, 32, 4)).astype(np.float32) * np.float32([1, 1, 1, 0])
    means = [flip(_random(), Image(np.clip(reference + s * noise, 0, 1).astype(np.float32))) for s in (0.01, 0.03, 0.1, 0.3)]
    assert means == sorted(means)


def test_flip_sees_less_from_afar() -> None:
    """A checkerboard of pixels is grey to who stands far off."""
    board = np.indices((64, 64)).sum(axis=0) % 2
    fine = np.repeat(board[..., None], 3, axis=2).astype(float)
    grey = np.full_like(fine, 0.5)
    near, far = (float(flip_map(grey, fine, pixels_per_degree(distance))[16:48, 16:48].mean()) for distance in (0.1, 3.0))
    assert far < 0.1 < near


def test_ssim_sees_structure() -> None:
    """A little brighter is nearly alike; noise of the same error is not."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[0:64, 0:64] / 64
    a = 0.4 + 0.2 * np.sin(9 * x) * np.cos(7 * y)
    noise = rng.normal(size=a.shape)
    noise *= 0.05 / np.sqrt((noise**2).mean())
    assert ssim_of(a, a + 0.05) > 0.95 > 0.6 > ssim_of(a, a + noise)


def test_the_picture_of_where() -> None:
    """Dark where nothing differs, light where it does; amplified differences to the number."""
    pixels = _random().pixels.copy()
    pixels[20:, 20:, :3] = 1.0 - pixels[20:, 20:, :3]
    other = Image(pixels)
    heat = difference_picture(_random(), other)
    luminance = heat.pixels[..., :3].sum(axis=2)
    assert luminance[:8, :8].max() < 0.02 < luminance[22:, 22:].mean()
    amplified = difference_picture(_random(), other, "absolute", gain=3.0)
    expected = 3.0 * np.abs(_random().pixels[..., :3].astype(float) - pixels[..., :3])
    np.testing.assert_allclose(amplified.pixels[..., :3], expected, rtol=1e-6)
    with pytest.raises(UnsupportedError, match="kind must be flip or absolute"):
        difference_picture(_random(), other, "map")


@pytest.mark.parametrize("measure", [rmse, rel_mse, psnr, ssim, flip, compared, difference_picture])
def test_sizes_must_agree(measure: object) -> None:
    """With both sizes in the line."""
    with pytest.raises(SceneError, match="of one size, got 16 x 16 and 8 x 8"):
        measure(_grey(0.5), _grey(0.5, size=8))  # type: ignore[operator]


def test_tiny_pictures_are_measured() -> None:
    """One pixel is a picture, too."""
    found = compared(_grey(0.5, size=1), _grey(0.4, size=1))
    assert all(math.isfinite(getattr(found, name)) for name in METRICS)
