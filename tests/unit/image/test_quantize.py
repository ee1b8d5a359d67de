"""Rounding to n bits: never more than half a step off; dithered, right on the mean; blue noise is blue."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from limner.errors import SceneError, UnsupportedError
from limner.image.blue_noise import SIDE, blue_noise
from limner.image.quantize import DITHERS, quantize


@given(arrays.arrays(np.float64, (3, 4), elements=st.floats(0.0, 1.0)), st.integers(1, 16))
def test_rounding_is_off_by_half_a_step_at_most(values: np.ndarray, bits: int) -> None:
    """And the codes fit the smallest type that holds them."""
    codes = quantize(values, bits)
    greatest = (1 << bits) - 1
    assert codes.dtype == (np.uint8 if bits <= 8 else np.uint16)
    assert np.abs(codes / greatest - values).max() <= 0.5 / greatest * (1 + 1e-9)


@pytest.mark.parametrize("dither", DITHERS)
@given(arrays.arrays(np.float64, (7, 5, 2), elements=st.floats(0.0, 1.0)), st.integers(1, 8), st.integers(0, 99))
def test_dithering_is_off_by_a_step_at_most(dither: str, values: np.ndarray, bits: int, seed: int) -> None:
    """One pixel for one pixel, for thresholds; what errors hand on may add up to one more."""
    greatest = (1 << bits) - 1
    error = np.abs(quantize(values, bits, dither, seed) / greatest - values).max()
    assert error <= (2.0 if dither == "floyd_steinberg" else 1.0) / greatest * (1 + 1e-9)


@pytest.mark.parametrize("dither", [None, *DITHERS])
@pytest.mark.parametrize("bits", [1, 3, 8])
def test_what_is_a_code_stays_it(dither: str | None, bits: int) -> None:
    """Black is black, white is white, and a picture that was quantised once is not changed again."""
    greatest = (1 << bits) - 1
    codes = np.random.default_rng(0).integers(0, greatest + 1, (20, 30, 3))
    assert (quantize(codes / greatest, bits, dither) == codes).all()


@pytest.mark.parametrize(
    ("dither", "slack"), [("ordered", 1 / 128), ("blue_noise", 1 / 8192), ("random", 0.01), ("floyd_steinberg", 0.006)]
)
@pytest.mark.parametrize("value", [0.03, 0.31, 0.5, 0.77, 0.999])
@pytest.mark.parametrize("bits", [1, 2])
def test_the_mean_survives_dithering(dither: str, slack: float, value: float, bits: int) -> None:
    """Over whole tables to half a rank of theirs; at random within five deviations; Floyd and Steinberg lose errors only at edges."""
    greatest = (1 << bits) - 1
    codes = quantize(np.full((256, 256), value), bits, dither)
    assert codes.mean() == pytest.approx(value * greatest, abs=slack * greatest + 1e-12)


def test_floyd_and_steinberg_to_the_letter() -> None:
    """The wave over the picture against two loops, which is how it is published."""
    values = np.random.default_rng(5).random((13, 17, 2))
    for shape in ((13, 17), (1, 9), (9, 1), (2, 2), (13, 2)):
        given_ = values[: shape[0], : shape[1]]
        work = np.zeros((shape[0] + 1, shape[1] + 2, 2))
        work[:-1, 1:-1] = given_ * 3
        for y in range(shape[0]):
            for x in range(1, shape[1] + 1):
                code = np.clip(np.floor(work[y, x] + 0.5), 0, 3)
                error, work[y, x] = work[y, x] - code, code
                work[y, x + 1] += error * (7 / 16)
                work[y + 1, x - 1] += error * (3 / 16)
                work[y + 1, x] += error * (5 / 16)
                work[y + 1, x + 1] += error * (1 / 16)
        assert (quantize(given_, 2, "floyd_steinberg") == work[:-1, 1:-1]).all()


def test_seeds_draw_the_grain() -> None:
    """The same seed the same picture, another seed another; ordered dither has none."""
    values = np.full((64, 64), 0.4)
    for dither in ("random", "blue_noise"):
        assert (quantize(values, 1, dither, 1) == quantize(values, 1, dither, 1)).all()
        assert (quantize(values, 1, dither, 1) != quantize(values, 1, dither, 2)).any()
    assert (quantize(values, 1, "ordered", 1) == quantize(values, 1, "ordered", 2)).all()


def test_strange_values() -> None:
    """Below, above, infinite and no number at all."""
    assert quantize([[-1.0, 2.0, np.inf, -np.inf, np.nan]], 8).tolist() == [[0, 255, 255, 0, 0]]


def test_slips_are_told() -> None:
    """Bits, kinds and shapes that are none."""
    for bits in (0, 17, 1.5, True):
        with pytest.raises(SceneError, match="from 1 to 16"):
            quantize([[0.5]], bits)  # type: ignore[arg-type]
    with pytest.raises(UnsupportedError, match="ordered, blue_noise, random, floyd_steinberg or None, got 'stars'"):
        quantize([[0.5]], 8, "stars")
    with pytest.raises(SceneError, match="height, width"):
        quantize([0.5], 8)


# --- blue noise -------------------------------------------------------------------------------------------------------------


def _spectrum(pattern: np.ndarray) -> tuple[float, float]:
    """Mean power of a pattern at low and at high frequencies, over that of white noise of the same share."""
    power = np.abs(np.fft.fft2(pattern - pattern.mean())) ** 2 / pattern.size / pattern.var()
    frequency = np.minimum(np.arange(SIDE), SIDE - np.arange(SIDE))
    radius = np.hypot(frequency[:, None], frequency)
    return float(power[(radius > 0) & (radius < 0.15 * SIDE)].mean()), float(power[radius > 0.35 * SIDE].mean())


def test_each_rank_is_there_once() -> None:
    """A permutation: every grey has its share."""
    assert (np.sort(blue_noise(), axis=None) == np.arange(SIDE * SIDE)).all()


@pytest.mark.parametrize("share", [0.05, 0.1, 0.25, 0.5, 0.75, 0.9])
def test_blue_noise_is_blue(share: float) -> None:
    """Low frequencies have less than a fifth of white noise's power at every grey, high ones more; white noise has 1 and 1."""
    low, high = _spectrum((blue_noise() < share * SIDE * SIDE).astype(float))
    assert low < 0.2
    assert high > 1.0
    white = np.random.default_rng(0).random((SIDE, SIDE)) < share
    assert _spectrum(white.astype(float))[0] > 0.7


@pytest.mark.parametrize("share", [0.02, 0.1, 0.25])
def test_points_keep_away_from_each_other(share: float) -> None:
    """The nearest two of the first n points are at least half as far apart as in a square grid, round the edges too."""
    y, x = np.nonzero(blue_noise() < share * SIDE * SIDE)
    dx, dy = (np.minimum(np.abs(a[:, None] - a), SIDE - np.abs(a[:, None] - a)) for a in (x, y))
    distance = np.hypot(dx, dy)
    np.fill_diagonal(distance, np.inf)
    assert distance.min() >= 0.5 / np.sqrt(share)
