"""Random numbers as a pure function of seed, pixel, sample and dimension: uniform, independent, the same everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over

from limner.kernel import rng

stats = pytest.importorskip("scipy.stats")
N = 4096
_AXES = {"seed": 0, "i": 1, "j": 2, "sample": 3, "dimension": 4}


def _along(axis: str, base: tuple[int, ...] = (3, 17, 250, 5, 2), n: int = N) -> np.ndarray:
    columns: list[object] = list(base)
    columns[_AXES[axis]] = np.arange(n)
    return over(rng.random_float, *columns).astype(np.float64)


def test_known_answers() -> None:
    """The numbers themselves are a promise: a stored picture must come out again. Computed with Python integers."""

    def mix(x: int) -> int:
        x = ((x ^ x >> 16) * 0x21F0AAAD) & 0xFFFFFFFF
        x = ((x ^ x >> 15) * 0x735A2D97) & 0xFFFFFFFF
        return x ^ x >> 15

    def expected(*numbers: int) -> float:
        state = 0x9E3779B9
        for number in numbers:
            state = mix(((state ^ (number & 0xFFFFFFFF)) + 0x9E3779B9) & 0xFFFFFFFF)
        return (state >> 8) / 2.0**24

    rows = [(0, 0, 0, 0, 0), (1, 2, 3, 4, 5), (-1, 0, 0, 0, 0), (2**40 + 7, 1919, 1079, 4095, 31), (7, -3, -8, 0, 0)]
    got = over(rng.random_float, *(np.array(column) for column in zip(*rows, strict=True)))
    np.testing.assert_array_equal(got, [expected(*row) for row in rows])


def test_mix_is_injective_and_avalanches() -> None:
    """No two of 2^13 neighbours collide; flipping one input bit flips each output bit in 40 to 60 % of cases."""
    x = np.arange(2**13)
    assert len(np.unique(over(rng.mix, x))) == len(x)
    words = np.random.default_rng(5).integers(0, 2**32, 400)
    reference = over(rng.mix, words)
    for bit in range(32):
        flips = (over(rng.mix, words ^ (1 << bit)) ^ reference)[:, None] >> np.arange(32) & 1
        assert np.all(np.abs(flips.mean(0) - 0.5) < 0.1), bit


def test_floats_are_in_the_half_open_interval() -> None:
    """The largest word gives the float32 below 1; all are multiples of 2^-24."""
    got = over(rng.float_from_word, [0, 255, 256, 2**32 - 1, 2**31])
    np.testing.assert_array_equal(got, [0.0, 0.0, 2.0**-24, 1.0 - 2.0**-24, 0.5])


@pytest.mark.parametrize("axis", list(_AXES))
def test_uniform_and_uncorrelated_along_every_axis(axis: str) -> None:
    """Along each argument alone: chi-squared over 64 bins, no correlation of neighbours, pairs uniform over 8 x 8."""
    x = _along(axis)
    assert stats.chisquare(np.histogram(x, 64, (0, 1))[0]).pvalue > 1e-3
    for lag in (1, 2, 16):
        assert abs(np.corrcoef(x[:-lag], x[lag:])[0, 1]) < 4.0 / np.sqrt(N)
    pairs = np.histogram2d(x[:-1:2], x[1::2], 8, ((0, 1), (0, 1)))[0]
    assert stats.chisquare(pairs.ravel()).pvalue > 1e-3


@pytest.mark.parametrize("axis", list(_AXES))
def test_next_door_is_independent(axis: str) -> None:
    """One more in any argument gives another stream: the pairs fill the unit square evenly."""
    other = "sample" if axis != "sample" else "dimension"
    base = [3, 17, 250, 5, 2]
    a = _along(other, tuple(base))
    base[_AXES[axis]] += 1
    b = _along(other, tuple(base))
    assert stats.chisquare(np.histogram2d(a, b, 8, ((0, 1), (0, 1)))[0].ravel()).pvalue > 1e-3


def test_pixels_show_no_pattern() -> None:
    """The picture of a seed has a flat spectrum: no frequency stands out of 32 x 32 pixels' noise."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(32), np.arange(32)))
    noise = over(rng.random_float, 0, i, j, 0, 0).reshape(32, 32).astype(np.float64)
    power = np.abs(np.fft.fft2(noise - noise.mean())) ** 2 * 12 / noise.size
    # Each is exponentially distributed with mean 1: the greatest of 512 exceeds 16 once in 17,000 pictures.
    assert power.max() < 16.0
