"""Tone curves against what their authors published, and what every view owes whoever looks."""

from __future__ import annotations

import numpy as np
import pytest

from limner.color.agx import INSET, agx, agx_curve
from limner.color.tonemap import aces, hable, narkowicz, pbr_neutral, reinhard
from limner.color.transfer import srgb_from_linear
from limner.color.views import VIEWS, screen_light
from limner.errors import LimnerError

CURVES = [name for name in VIEWS if name not in ("none", "standard")]


def test_khronos_neutral_is_the_reference_shader() -> None:
    """The specification's formula, pixel by pixel, with branches, on random light from 1e-3 to 1e3."""

    def reference(color: np.ndarray) -> np.ndarray:
        start, desaturation = 0.8 - 0.04, 0.15
        x = color.min()
        color = color - (x - 6.25 * x * x if x < 0.08 else 0.04)
        peak = color.max()
        if peak < start:
            return color
        d = 1.0 - start
        new_peak = 1.0 - d * d / (peak + d - start)
        g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0)
        return (1.0 - g) * color * (new_peak / peak) + g * new_peak

    light = 10.0 ** np.random.default_rng(1).uniform(-3, 3, (500, 3))
    np.testing.assert_allclose(pbr_neutral(light), [reference(color) for color in light], atol=1e-12)


def test_khronos_neutral_gives_base_colours_back() -> None:
    """Under light of 1, a dielectric reflects 0.96 of its colour and 0.04: the view shows the colour itself, up to 0.76."""
    base = np.random.default_rng(2).uniform(0.04, 0.76, (100, 3))
    np.testing.assert_allclose(pbr_neutral(base + 0.04), base, atol=1e-12)


def test_agx_is_near_the_published_polynomial() -> None:
    """Wrensch's fit of the sixth order errs by 0.006 at most; his outset is the inverse of the inset, to its printed digits."""
    x = np.linspace(0.0, 1.0, 200)
    fit = 15.5 * x**6 - 40.14 * x**5 + 31.96 * x**4 - 6.868 * x**3 + 0.4298 * x**2 + 0.1191 * x - 0.00232
    assert np.abs(agx_curve(x) - fit).max() < 0.006
    printed = [
        [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
        [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
        [-0.0529716355144438, -0.0980434501171241, 1.15107367264116],
    ]
    np.testing.assert_allclose(np.linalg.inv(INSET), printed, atol=1e-9)


def test_agx_has_its_slope_and_its_ends() -> None:
    """2 through the pivot, and (0, 0) to (1, 1), as the sigmoid promises."""
    pivot, h = 10.0 / 16.5, 1e-5
    assert (agx_curve(pivot + h) - agx_curve(pivot - h)) / (2 * h) == pytest.approx(2.0, abs=1e-6)
    assert agx_curve([0.0, pivot, 1.0]) == pytest.approx([0.0, 0.5, 1.0], abs=1e-12)


def test_tables_of_the_authors() -> None:
    """Values worked out by hand from the printed formulas."""
    grey = np.full(3, 0.18)
    assert reinhard(grey)[0] == pytest.approx(0.18 / 1.18)
    assert reinhard(np.full(3, 3.0), white=3.0)[0] == pytest.approx(1.0)
    assert hable(np.full(3, 5.6))[0] == pytest.approx(1.0)
    assert narkowicz(grey)[0] == pytest.approx(0.18 * (2.51 * 0.18 + 0.03) / (0.18 * (2.43 * 0.18 + 0.59) + 0.14))
    # The rows of Hill's matrices sum to 1 within their five digits, so on greys only the fit is left.
    fit = (0.18 * (0.18 + 0.0245786) - 0.000090537) / (0.18 * (0.983729 * 0.18 + 0.4329510) + 0.238081)
    assert aces(grey) == pytest.approx(fit, abs=3e-5)
    assert agx(grey) == pytest.approx(0.5**2.2, abs=1e-4)  # nor do rows of the inset quite


def test_colours_keep_their_ratios_under_reinhard() -> None:
    """It bends luminance; what is not cut off keeps its chromaticity."""
    light = np.random.default_rng(3).uniform(0.1, 0.9, (50, 3))
    share = reinhard(light) / light
    np.testing.assert_allclose(share, share[:, :1] * np.ones(3), rtol=1e-12)


@pytest.mark.parametrize("name", CURVES)
def test_a_view_is_monotone_in_exposure_and_keeps_greys(name: str) -> None:
    """A brighter grey is never darker, greys stay grey to a thousandth, black is black, and all lies in [0, 1]."""
    stops = np.linspace(-20.0, 20.0, 400)
    greys = np.repeat(np.float32(0.18) * np.exp2(stops, dtype=np.float32)[:, None], 3, axis=1).astype(np.float32)
    shown = screen_light(greys, name)
    assert shown.dtype == np.float32
    assert (np.diff(shown[:, 1]) >= -2e-6).all()
    assert np.ptp(shown, axis=1).max() < 1e-3
    assert 0.0 <= shown.min() < 1e-4
    assert 0.9 < shown.max() <= 1.0


@pytest.mark.parametrize("name", CURVES)
def test_middle_grey_lands_near_the_middle_of_the_code(name: str) -> None:
    """A grey card is between a third and 0.56 of the sRGB code, where the eye puts a middle grey."""
    code = float(srgb_from_linear(screen_light(np.full((1, 3), 0.18, np.float32), name)[0, 1]))
    assert 1 / 3 < code < 0.56


@pytest.mark.parametrize("name", VIEWS)
def test_nothing_breaks_a_view(name: str) -> None:
    """NaN, infinities, what is negative and denormal: finite numbers in [0, 1] come out of the curves, and alpha is kept."""
    odd = np.array([np.nan, np.inf, -np.inf, -1.0, 1e-45, 3e38, 0.5], dtype=np.float32)
    pixels = np.stack(np.meshgrid(odd, odd, odd, np.float32([0.25]), indexing="ij"), axis=-1).reshape(-1, 1, 4)
    shown = screen_light(pixels, name, exposure=0.0)
    assert (shown[..., 3] == 0.25).all()
    if name in CURVES:
        assert np.isfinite(shown).all()
        assert ((shown >= 0.0) & (shown <= 1.0)).all()
    else:
        assert shown is pixels


def test_bright_saturated_light_turns_pale_in_the_views_that_promise_it() -> None:
    """A blue lamp ten stops above grey: AgX, ACES and Khronos mix white in; a curve on each channel leaves it pure."""
    blue = np.array([[0.0, 0.0, 180.0]], dtype=np.float32)
    assert all(screen_light(blue, name)[0, 0] > 0.2 for name in ("agx", "aces", "pbr_neutral"))
    assert all(screen_light(blue, name)[0, 0] == 0.0 for name in ("hable", "narkowicz", "reinhard"))


def test_exposure_doubles_light_by_the_stop() -> None:
    """Two stops up and two stops down meet; and every curve sees what exposure leaves."""
    light = np.random.default_rng(4).uniform(0.0, 2.0, (10, 4)).astype(np.float32)
    assert (screen_light(light, exposure=2.0)[:, :3] == light[:, :3] * 4).all()
    assert (screen_light(light, exposure=2.0)[:, 3] == light[:, 3]).all()
    darker = light * np.float32([0.25, 0.25, 0.25, 1.0])
    for name in VIEWS:
        assert (screen_light(darker, name, exposure=2.0) == screen_light(light, name)).all()


@pytest.mark.parametrize(("view", "exposure"), [("sepia", 0.0), ("", 0.0), ("agx", float("nan")), ("agx", 1000.0), ("agx", "bright")])
def test_bad_views_and_exposures_are_refused(view: str, exposure: float) -> None:
    """In one line that says what is expected."""
    with pytest.raises(LimnerError, match=r"must be one of none, standard|stops") as raised:
        screen_light(np.zeros((1, 3), np.float32), view, exposure)
    assert "\n" not in str(raised.value)
