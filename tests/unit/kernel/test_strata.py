"""Samplers that know how many samples there will be: who gets which part of the square, and how much noise that saves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from compiled import over
from staging import SLOW_AS_PYTHON

from limner._jit import kernel
from limner.kernel.rng import pixel_word
from limner.kernel.sampler import Sampler, draw_1d, draw_2d
from limner.kernel.sampler_kinds import HALTON, JITTERED, MULTI_JITTERED, RANDOM, REGULAR, SAMPLERS, SOBOL, columns_of
from limner.kernel.strata import permuted, radical_inverse_3

stats = pytest.importorskip("scipy.stats")

UNIFORM = sorted(set(SAMPLERS.values()) - {REGULAR})


@kernel
def _drawn(
    kind: int, seed: np.int64, i: np.int64, sample: np.int64, n: np.int64, columns: np.int64, dimension: np.int64
) -> tuple[np.float32, np.float32, np.float32]:
    sampler = Sampler(kind, pixel_word(seed, i, np.int64(0)), sample, n, columns)
    x, y = draw_2d(sampler, dimension)
    return x, y, draw_1d(sampler, dimension)


def _draw(kind: int, n: int, pixels: int = 1, dimension: int = 0, seed: int = 0) -> np.ndarray:
    """(pixels, n, 3) float64: the points of all samples of some pixels, and their numbers."""
    i, sample = np.divmod(np.arange(pixels * n), n)
    drawn = over(_drawn, kind, seed, i, sample, n, columns_of(n), dimension)
    return np.stack(drawn, axis=1).reshape(pixels, n, 3).astype(np.float64)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 12, 17, 64])
def test_every_order_is_one_and_each_is_as_likely(n):
    """A random order names each place once; over many keys, each element and each pair is as often anywhere (chi-squared)."""
    keys = np.random.default_rng(n).integers(0, 1 << 32, 3000)
    found = over(permuted, np.tile(np.arange(n), len(keys)), n, np.repeat(keys, n)).reshape(len(keys), n)
    np.testing.assert_array_equal(np.sort(found, axis=1), np.tile(np.arange(n), (len(keys), 1)))
    if n < 3:
        return
    for element in {0, n // 2, n - 1}:
        assert stats.chisquare(np.bincount(found[:, element], minlength=n)).pvalue > 1e-4
    apart = (found[:, 0] - found[:, -1]) % n
    assert stats.chisquare(np.bincount(apart, minlength=n)[1:]).pvalue > 1e-4


@pytest.mark.parametrize("n", [1, 4, 7, 12, 64])
@pytest.mark.parametrize("dimension", [0, 3])
def test_a_regular_grid_is_the_centres_of_its_cells(n, dimension):
    columns = columns_of(n)
    points = _draw(REGULAR, n, pixels=3, dimension=dimension)
    x, y = (np.arange(columns) + 0.5) / columns, (np.arange(n // columns) + 0.5) / (n // columns)
    expected = sorted((a, b) for a in x for b in y)
    for pixel in points:
        np.testing.assert_allclose(sorted(map(tuple, pixel[:, :2].tolist())), expected, atol=1e-6)
        np.testing.assert_allclose(np.sort(pixel[:, 2]), (np.arange(n) + 0.5) / n, atol=1e-6)


@pytest.mark.parametrize("kind", [JITTERED, MULTI_JITTERED])
@pytest.mark.parametrize("n", [1, 4, 7, 12, 64, 256])
def test_each_cell_holds_one_sample(kind, n):
    """Of the n cells of the grid each has one, of n parts of a line each has one; multi-jittered, of n thin rows and columns, too."""
    columns = columns_of(n)
    for dimension in (0, 5):
        for pixel in _draw(kind, n, pixels=4, dimension=dimension):
            x, y, z = pixel.T
            cell = np.floor(x * columns) * (n // columns) + np.floor(y * (n // columns))
            np.testing.assert_array_equal(np.sort(cell), np.arange(n))
            np.testing.assert_array_equal(np.sort(np.floor(z * n)), np.arange(n))
            if kind == MULTI_JITTERED:
                for part in (x, y):
                    np.testing.assert_array_equal(np.sort(np.floor(part * n)), np.arange(n))


def test_halton_mirrors_digits():
    """Base 3 by hand, and the points of a pixel are the sequence, moved: differences of x are multiples of 1/64, of y of 1/81."""
    np.testing.assert_allclose(over(radical_inverse_3, np.arange(10)), [0, 1 / 3, 2 / 3, 1 / 9, 4 / 9, 7 / 9, 2 / 9, 5 / 9, 8 / 9, 1 / 27],
                               atol=1e-7)  # fmt: skip
    x, y, _ = _draw(HALTON, 64, seed=3)[0].T
    for part, grid in ((x, 64), (y, 81)):
        steps = (part - part[0]) * grid
        np.testing.assert_allclose(steps, np.round(steps), atol=2e-4)
        assert len(set(np.round(steps % grid).astype(int))) == 64


@SLOW_AS_PYTHON
@pytest.mark.parametrize("kind", UNIFORM)
@pytest.mark.parametrize("dimension", [0, 1, -2])
def test_each_sample_alone_is_uniform(kind, dimension):
    """Whichever of its samples: over many pixels it is anywhere alike (chi-squared, 8 x 8), and below 1."""
    drawn = _draw(kind, 12, pixels=3000, dimension=dimension)
    assert (drawn >= 0).all()
    assert (drawn < 1).all()
    for sample in (0, 5, 11):
        x, y, z = drawn[:, sample].T
        assert stats.chisquare(np.histogram2d(x, y, 8, ((0, 1), (0, 1)))[0].ravel()).pvalue > 1e-4
        assert stats.chisquare(np.histogram(z, 16, (0, 1))[0]).pvalue > 1e-4


@SLOW_AS_PYTHON
@pytest.mark.parametrize("kind", sorted(SAMPLERS.values()))
def test_decisions_are_independent(kind):
    """Where a sample stands in the pixel says nothing of where it stands on the lens (chi-squared over the pairs)."""
    here, there = _draw(kind, 16, pixels=400, dimension=0), _draw(kind, 16, pixels=400, dimension=-1)
    for p in range(2):
        for q in range(2):
            pairs = np.histogram2d(here[..., p].ravel(), there[..., q].ravel(), 4, ((0, 1), (0, 1)))[0].ravel()
            assert stats.chisquare(pairs).pvalue > 1e-4


def _noise(kind: int, n: int, function, pixels: int = 400) -> float:
    """The variance of the mean of n samples."""
    x, y, _ = np.moveaxis(_draw(kind, n, pixels=pixels), 2, 0)
    return float(function(x, y).mean(axis=1).var())


@SLOW_AS_PYTHON
@pytest.mark.parametrize(
    ("kind", "edge", "smooth"),
    [(RANDOM, 1.0, 1.0), (JITTERED, 1.5, 2.0), (MULTI_JITTERED, 1.5, 1.7), (HALTON, 1.5, 1.8), (SOBOL, 1.5, 2.5)],
)
def test_the_noise_falls_as_theory_says(kind, edge, smooth):
    """Variance n^-p: random 1; strata 2 where the picture is smooth, 3/2 across an edge; nets beyond that (Owen: 3).

    **Source**: Mitchell, *Consequences of stratified sampling in graphics*, 1996, for strata.
    """
    few, many = 16, 256

    def power(function) -> float:
        return math.log(_noise(kind, few, function) / _noise(kind, many, function)) / math.log(many / few)

    slant = power(lambda x, y: (y < 0.3 + 0.37 * x).astype(float))
    even = power(lambda x, y: np.exp(x) * np.sin(math.pi * y))
    if kind == RANDOM:
        assert slant == pytest.approx(edge, abs=0.15)
        assert even == pytest.approx(smooth, abs=0.15)
    else:
        assert slant > edge - 0.2
        assert even > smooth - 0.2


@SLOW_AS_PYTHON
def test_rooks_are_better_than_jitter_alone():
    """Multi-jittering keeps what jittering has, and adds to it: less noise for any number of samples, of edges and of gradients."""
    for n in (16, 64, 256):
        for function in (lambda x, y: (y < 0.3 + 0.37 * x).astype(float), lambda x, y: np.exp(x) * np.sin(math.pi * y)):
            assert _noise(MULTI_JITTERED, n, function) < 0.85 * _noise(JITTERED, n, function)


def test_columns_make_the_squarest_grid():
    for n in range(1, 200):
        columns = columns_of(n)
        assert n % columns == 0
        assert columns * columns <= n
        assert not any(n % k == 0 for k in range(columns + 1, math.isqrt(n) + 1))
