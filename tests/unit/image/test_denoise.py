"""Taking noise out: what must go, and what must stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON

from limner.errors import LimnerError, UnsupportedError
from limner.image.denoise import DENOISERS, denoised
from limner.image.image import Image

N = 20
LIGHT = 0.5


def _wall(seed: int = 0, noise: float = 0.2, **beside: np.ndarray) -> Image:
    """An evenly lit wall: a fine chessboard painted on its left half, an edge in depth at its right end, noise of known variance."""
    rows, columns = np.indices((N, N))
    albedo = np.full((N, N, 3), 0.6, dtype=np.float32)
    albedo[:, : N // 2] = np.where(((rows + columns) % 2 == 0)[:, : N // 2, None], 0.8, 0.1)
    depth = np.where(columns < N - 4, 2.0, 4.0).astype(np.float32)
    light = np.where(columns < N - 4, LIGHT, 2.0 * LIGHT)[..., None] * albedo
    deviation = (noise * albedo).astype(np.float32)
    pixels = np.ones((N, N, 4), dtype=np.float32)
    pixels[..., :3] = light + deviation * np.random.default_rng(seed).standard_normal((N, N, 1))
    normal = np.broadcast_to(np.float32([0.0, 0.0, 1.0]), (N, N, 3))
    known = {"denoising_albedo": albedo, "denoising_normal": normal, "denoising_depth": depth, "variance": deviation**2}
    return Image(pixels, aov={**known, **beside})


def _light(image: Image) -> np.ndarray:
    return image.pixels[..., 1] / image.aov["denoising_albedo"][..., 1]


@pytest.fixture(scope="module")
def cleaned() -> Image:
    """The wall, filtered once."""
    return denoised(_wall(), threads=1)


def test_noise_goes(cleaned: Image) -> None:
    """On each side of the edge the deviation falls to less than a fourth, of the narrow one a half, and the mean stays."""
    for side, light, share in ((np.s_[:, : N - 4], LIGHT, 0.25), (np.s_[:, N - 4 :], 2.0 * LIGHT, 0.5)):
        before, after = _light(_wall())[side], _light(cleaned)[side]
        assert after.std() < share * before.std()
        assert after.mean() == pytest.approx(light, abs=0.06)


def test_paint_stays(cleaned: Image) -> None:
    """A chessboard of single pixels keeps its contrast: it was divided off, and is multiplied on again."""
    painted = cleaned.pixels[:, : N // 2, 1]
    board = (np.indices((N, N)).sum(axis=0) % 2 == 0)[:, : N // 2]
    assert painted[board].mean() / painted[~board].mean() == pytest.approx(8.0, rel=0.1)


def test_edges_stay(cleaned: Image) -> None:
    """Depth alone keeps two walls of one paint apart: the step of light is as high and as steep as it was."""
    light = _light(cleaned)
    assert (light[:, N - 4] - light[:, N - 5]).mean() == pytest.approx(LIGHT, abs=0.12)


def test_what_is_sure_is_left_alone() -> None:
    """A gradient without variance comes back: nothing is blurred that has no noise."""
    image = _wall(noise=0.0)
    ramp = image.pixels.copy()
    ramp[..., :3] *= np.linspace(0.5, 1.5, N, dtype=np.float32)[:, None, None]
    image = replace(image, pixels=ramp)
    np.testing.assert_allclose(denoised(image, threads=1).pixels, ramp, rtol=2e-4)


def test_alpha_and_the_rest_stay() -> None:
    """What is transparent gives no colour to others, alpha is not filtered, and channels, recipe and words are kept."""
    image = _wall()
    pixels = image.pixels.copy()
    pixels[: N // 2, :, 3] = 0.0
    pixels[: N // 2, :, :3] = 50.0
    image = replace(image, pixels=pixels, recipe={"seed": 1})
    made = denoised(image, threads=1)
    assert (made.pixels[..., 3] == pixels[..., 3]).all()
    assert made.pixels[N // 2 :, :, :3].max() < 2.0
    assert set(made.aov) == set(image.aov)
    assert made.recipe == image.recipe


@SLOW_AS_PYTHON
@pytest.mark.parametrize("beside", [(), ("denoising_albedo",), ("variance", "denoising_depth")])
def test_it_does_with_what_there_is(beside: tuple[str, ...]) -> None:
    """Without any channel, or with some: finite, no brighter, less noisy where nothing is painted."""
    image = _wall()
    few = replace(image, aov={name: image.aov[name] for name in beside})
    made, wall = denoised(few, threads=1), np.s_[:, N // 2 : N - 4, :3]
    assert np.isfinite(made.pixels).all()
    assert made.pixels[wall].std() < image.pixels[wall].std()
    assert made.pixels.max() <= image.pixels.max() * 1.001


def test_what_is_no_number_spreads_nowhere() -> None:
    """One bad pixel becomes black before anything is averaged, and bad channels are as if they were not there."""
    image = _wall()
    pixels, normal = image.pixels.copy(), image.aov["denoising_normal"].copy()
    pixels[5, 5, 0], normal[7, 7] = np.nan, np.inf
    made = denoised(replace(image, pixels=pixels, aov={**image.aov, "denoising_normal": normal}), threads=1)
    assert np.isfinite(made.pixels).all()


@SLOW_AS_PYTHON
def test_threads_change_no_bit() -> None:
    """A pixel is a function of the picture before the pass."""
    image = _wall()
    wide = replace(image, pixels=np.tile(image.pixels, (1, 4, 1)), aov={})
    assert (denoised(wide, threads=1).pixels == denoised(wide, threads=3).pixels).all()


@pytest.mark.parametrize(("method", "strength"), [("median", 2.0), ("filter", 0.0), ("filter", float("nan"))])
def test_bad_calls_are_refused(method: str, strength: float) -> None:
    """In one line."""
    with pytest.raises(LimnerError, match=r"must be") as raised:
        denoised(_wall(), method, strength=strength)
    assert "\n" not in str(raised.value)


def test_the_network_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """And the message says what to install."""
    import sys

    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(UnsupportedError, match=r"limner\[denoise\]"):
        denoised(_wall(), "oidn")
    assert DENOISERS == ("filter", "oidn")


def test_the_network_takes_noise_out() -> None:
    """Open Image Denoise, where it is installed: less noise, the same mean, alpha kept."""
    pytest.importorskip("pyoidn", reason="Open Image Denoise (extra denoise) is not installed")
    image = _wall()
    made, wall = denoised(image, "oidn"), np.s_[:, N // 2 : N - 5]
    assert _light(made)[wall].std() < 0.5 * _light(image)[wall].std()
    assert _light(made)[wall].mean() == pytest.approx(LIGHT, abs=0.08)
    assert (made.pixels[..., 3] == image.pixels[..., 3]).all()
