"""FLIP and SSIM against the published tools: their authors' own, and scikit-image."""

from __future__ import annotations

import numpy as np
import pytest

from limner.color.transfer import linear_from_srgb
from limner.image.compare import ssim_of
from limner.image.flip import flip_map, pixels_per_degree


def _pair(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Two sRGB-encoded pictures (96, 128, 3) float32."""
    rng = np.random.default_rng(7)
    y, x = np.mgrid[0:96, 0:128] / 96
    a = np.stack([x / 1.34, y, 0.5 + 0.5 * np.sin(40 * x * y)], axis=-1)
    b = a.copy()
    if kind == "noise":
        b += rng.normal(size=a.shape) * 0.08
    elif kind == "blocks":
        b[10:40, 20:60], b[50:52, :], b[60:, 90:] = (1, 0, 0), 0, b[60:, 90:, ::-1]
    elif kind == "shift":
        b = np.roll(a, 1, axis=1)
    elif kind == "opposites":
        a, b = np.broadcast_to((0.0, 1.0, 0.0), a.shape), np.broadcast_to((0.0, 0.0, 1.0), a.shape)
    return tuple(np.clip(picture, 0, 1).astype(np.float32) for picture in (a, b))  # type: ignore[return-value]


@pytest.mark.parametrize("kind", ["noise", "blocks", "shift", "opposites"])
@pytest.mark.parametrize("distance", [0.35, 0.7, 1.5])
def test_flip_is_its_authors(kind: str, distance: float) -> None:
    """Every pixel of the error map to 2e-4, the mean to 1e-5, at three distances from the monitor; theirs computes in float32."""
    flip_evaluator = pytest.importorskip("flip_evaluator", reason="the published tool is not installed")
    a, b = _pair(kind)
    ppd = pixels_per_degree(distance)
    theirs, mean, _ = flip_evaluator.evaluate(a, b, "LDR", inputsRGB=True, applyMagma=False, parameters={"ppd": ppd})
    ours = flip_map(linear_from_srgb(a), linear_from_srgb(b), ppd)
    np.testing.assert_allclose(ours, theirs.reshape(ours.shape), atol=2e-4)
    assert ours.mean() == pytest.approx(mean, abs=1e-5)


@pytest.mark.parametrize("kind", ["noise", "blocks", "shift"])
def test_ssim_is_scikit_images(kind: str) -> None:
    """With Wang's window and biased moments, to rounding."""
    metrics = pytest.importorskip("skimage.metrics", reason="scikit-image is not installed")
    a, b = (picture[..., 1].astype(np.float64) for picture in _pair(kind))
    theirs = metrics.structural_similarity(a, b, data_range=1.0, gaussian_weights=True, sigma=1.5, use_sample_covariance=False)
    assert ssim_of(a, b) == pytest.approx(theirs, abs=1e-12)
