"""Samplers: nets stay nets when scrambled, decisions and pixels are independent, and the noise falls faster."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over

from limner.kernel import sampler
from limner.kernel.sampler import MIDPOINT, RANDOM, SOBOL

stats = pytest.importorskip("scipy.stats")


def _points(kind: int, n: int, *, seed: int = 0, i: int = 0, j: int = 0, dimension: int = 0, start: int = 0) -> np.ndarray:
    return np.stack(over(sampler.sample_2d, kind, seed, i, j, np.arange(start, start + n), dimension), axis=1).astype(
        np.float64
    )


def _assert_net(points: np.ndarray) -> None:
    """Every elementary interval of area 1/n holds exactly one of the n = 2^m points."""
    n = len(points)
    for wide in range(n.bit_length()):
        columns = 2**wide
        cell = np.floor(points[:, 0] * columns) * (n // columns) + np.floor(points[:, 1] * (n // columns))
        np.testing.assert_array_equal(np.sort(cell), np.arange(n), err_msg=f"{columns} columns of {n}")


def test_the_unscrambled_sequence_is_a_net_in_every_block() -> None:
    """(0, 2)-sequence: each aligned block of 2^m indices, for m up to 8."""
    points = np.stack(over(sampler.sobol_2d, np.arange(1024)), axis=1) / 2.0**32
    for m in range(9):
        for start in range(0, 1024, 2**m * max(1, 128 >> m)):
            _assert_net(points[start : start + 2**m])


@pytest.mark.parametrize("dimension", [0, 1, 7])
@pytest.mark.parametrize(("seed", "i", "j"), [(0, 0, 0), (1, 5, 9), (123456789, 1919, 1079)])
def test_scrambled_and_shuffled_points_are_nets(seed: int, i: int, j: int, dimension: int) -> None:
    """The first 2^m samples of a pixel, and each later block of 2^m, are stratified in every elementary interval."""
    points = _points(SOBOL, 256, seed=seed, i=i, j=j, dimension=dimension)
    for m in range(9):
        for start in range(0, 256, max(2**m, 64)):
            _assert_net(points[start : start + 2**m])


def test_one_dimensional_samples_are_stratified() -> None:
    """The first 2^m numbers of a decision fall one into each of 2^m equal parts."""
    for dimension in (0, 3):
        x = over(sampler.sample_1d, SOBOL, 4, 1, 2, np.arange(256), dimension).astype(np.float64)
        for m in range(9):
            np.testing.assert_array_equal(np.sort(np.floor(x[: 2**m] * 2**m)), np.arange(2**m))


@pytest.mark.parametrize("kind", [RANDOM, SOBOL])
def test_each_sample_alone_is_uniform(kind: int) -> None:
    """The same sample of many pixels is uniform over the square, and so are samples of one pixel (chi-squared, 8 x 8)."""
    n = 4096
    for column in range(4):
        values: list[object] = [7, 3, 4, 0]
        values[column] = np.arange(n)
        x, y = over(sampler.sample_2d, kind, *values, 2)
        counts = np.histogram2d(x, y, 8, ((0, 1), (0, 1)))[0].ravel()
        assert stats.chisquare(counts).pvalue > 1e-3, column
        assert np.all((x >= 0) & (x < 1) & (y >= 0) & (y < 1))


@pytest.mark.parametrize("kind", [RANDOM, SOBOL])
@pytest.mark.parametrize(("this", "that"), [(0, 1), (1, 2), (0, 5)])
def test_decisions_are_independent(kind: int, this: int, that: int) -> None:
    """Any coordinate of one decision against any of another, within a pixel: the pairs are uniform (chi-squared, 8 x 8)."""
    a, b = _points(kind, 2048, dimension=this), _points(kind, 2048, dimension=that)
    for p in a.T:
        for q in b.T:
            assert stats.chisquare(np.histogram2d(p, q, 8, ((0, 1), (0, 1)))[0].ravel()).pvalue > 1e-3


@pytest.mark.parametrize("kind", [RANDOM, SOBOL])
def test_pixels_and_seeds_are_independent(kind: int) -> None:
    """The same decision in the next pixel, the next row, or with another seed."""
    here = _points(kind, 1024)
    for other in (_points(kind, 1024, i=1), _points(kind, 1024, j=1), _points(kind, 1024, seed=1)):
        for p, q in zip(here.T, other.T, strict=True):
            assert stats.chisquare(np.histogram2d(p, q, 8, ((0, 1), (0, 1)))[0].ravel()).pvalue > 1e-3


def test_scrambling_halves_the_noise_many_times_over() -> None:
    """A smooth integrand with 256 samples: the error is less than a tenth of that of random points (n^-1.5 against n^-0.5)."""

    def error(kind: int) -> float:
        errors = []
        for seed in range(12):
            x, y = _points(kind, 256, seed=seed).T
            errors.append(np.mean(np.exp(x) * np.sin(np.pi * y)) - (np.e - 1) * 2 / np.pi)
        return float(np.sqrt(np.mean(np.square(errors))))

    assert error(SOBOL) < 0.1 * error(RANDOM)


@pytest.mark.parametrize("kind", [MIDPOINT, 99])
def test_midpoint_and_unknown_kinds_give_the_middle(kind: int) -> None:
    """The family's neutral answer."""
    np.testing.assert_array_equal(_points(kind, 3), 0.5)
    np.testing.assert_array_equal(over(sampler.sample_1d, kind, 0, 0, 0, np.arange(3), 0), 0.5)


def test_scrambling_flips_a_bit_by_those_above_it_alone() -> None:
    """Owen's property: fractions that agree in k leading bits still do, and differ in the next bit as they did."""
    rng = np.random.default_rng(3)
    a = rng.integers(0, 2**32, 300)
    bit = rng.integers(0, 32, 300)
    higher = rng.integers(0, 2**32, 300) & ~((2 << bit) - 1)
    b = a ^ (1 << bit) ^ higher
    # Reversed fractions: leading bits are the low ones, so `bit` is the lowest in which a and b differ.
    for key in (0, 1, 0xDEADBEEF):
        difference = over(sampler.scramble_reversed, a, key) ^ over(sampler.scramble_reversed, b, key)
        np.testing.assert_array_equal(difference & -difference, 1 << bit)
