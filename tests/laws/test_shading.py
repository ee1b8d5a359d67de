"""Laws that every lobe keeps: it is the same both ways, reflects no more than arrives, and its parts integrate to what they must."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over

from limner.shading.fresnel import schlick
from limner.shading.lambert import eval_lambert
from limner.shading.microfacet import eval_ggx, ggx_distribution, smith_visibility
from limner.shading.phong import eval_blinn_phong

ROUGHNESS = (0.05, 0.2, 0.5, 1.0)  # alpha, the square of what glTF calls roughness
UP = (0.0, 0.0, 1.0)
WHITE = (1.0, 1.0, 1.0)


def _upper_directions(n: int, seed: int = 0) -> np.ndarray:
    v = np.random.default_rng(seed).normal(size=(n, 3))
    v[:, 2] = np.abs(v[:, 2])
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def _hemisphere(n: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """Directions of a midpoint rule over the hemisphere, denser towards the pole, and their solid angles."""
    edges = (np.arange(n + 1) / n) ** 2 * np.pi / 2
    theta, weight = (edges[1:] + edges[:-1]) / 2, np.cos(edges[:-1]) - np.cos(edges[1:])
    phi = (np.arange(n) + 0.5) / n * 2 * np.pi
    theta, phi, weight = (a.ravel() for a in np.broadcast_arrays(theta[:, None], phi, weight[:, None] * (2 * np.pi / n)))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1), weight


@pytest.mark.parametrize("alpha", ROUGHNESS)
def test_projected_microfacets_cover_the_surface(alpha):
    """Integral of D(h) (n.h) over the hemisphere = 1 (Walter et al. 2007, eq. 4)."""
    edges = np.pi / 2 * (np.arange(20001) / 20000) ** 3
    cos = np.cos((edges[1:] + edges[:-1]) / 2)
    d = over(ggx_distribution, np.full(20000, alpha * alpha), cos).astype(np.float64)
    assert np.sum(d * cos * 2 * np.pi * (np.cos(edges[:-1]) - np.cos(edges[1:]))) == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("alpha", ROUGHNESS)
def test_masking_and_shadowing_is_a_share(alpha):
    """0 <= G = 4 (n.l) (n.v) V <= 1, alike for both directions, 1 from straight above."""
    n_l, n_v = np.random.default_rng(1).uniform(1e-3, 1.0, size=(2, 2000))
    both_ways = over(smith_visibility, alpha**2, n_l, n_v), over(smith_visibility, alpha**2, n_v, n_l)
    np.testing.assert_allclose(*both_ways, rtol=1e-6)
    g = 4 * n_l * n_v * both_ways[0]
    assert (g >= 0).all()
    assert (g <= 1 + 1e-5).all()
    assert 4 * over(smith_visibility, alpha**2, np.ones(1), np.ones(1))[0] == pytest.approx(1.0, rel=1e-6)


def test_schlick_runs_from_r0_to_one():
    """R(0) = R0, R(90 degrees) = 1, growing in between, and within 0.04 of Fresnel's equations for glass (n = 1.5)."""
    cos = np.linspace(0, 1, 400)
    r = over(schlick, np.tile([0.04, 0.5, 1.0], (400, 1)), cos)
    np.testing.assert_allclose(r[-1], [0.04, 0.5, 1.0], rtol=1e-6)
    np.testing.assert_allclose(r[0], 1.0, rtol=1e-6)
    assert (np.diff(r, axis=0) <= 1e-7).all()
    cos_t = np.sqrt(1 - (1 - cos**2) / 1.5**2)
    exact = (((cos - 1.5 * cos_t) / (cos + 1.5 * cos_t)) ** 2 + ((cos_t - 1.5 * cos) / (cos_t + 1.5 * cos)) ** 2) / 2
    np.testing.assert_allclose(r[:, 0], exact, atol=0.04)


def test_lobes_are_reciprocal():
    """What is given to light from l towards v is given to light from v towards l."""
    n = 3000
    l, v = _upper_directions(n, 2), _upper_directions(n, 3)  # noqa: E741 - the book's letters
    for alpha in ROUGHNESS:
        there = over(eval_ggx, (0.3, 0.5, 0.9), np.full(n, alpha), UP, l, v) / np.maximum(l[:, 2:], 1e-4)
        back = over(eval_ggx, (0.3, 0.5, 0.9), np.full(n, alpha), UP, v, l) / np.maximum(v[:, 2:], 1e-4)
        sure = (l[:, 2] > 1e-3) & (v[:, 2] > 1e-3)
        np.testing.assert_allclose(there[sure], back[sure], rtol=2e-3)
    np.testing.assert_array_equal(
        over(eval_blinn_phong, WHITE, np.full(n, 30.0), UP, l, v), over(eval_blinn_phong, WHITE, np.full(n, 30.0), UP, v, l)
    )


def test_no_lobe_reflects_more_than_arrives():
    """The integral of a lobe, cosine included, is at most 1 towards every eye; a white matte surface has exactly 1."""
    l, weight = _hemisphere()  # noqa: E741
    matte = over(eval_lambert, WHITE, UP, l)[:, 0].astype(np.float64)
    assert np.sum(matte * weight) == pytest.approx(1.0, rel=1e-4)
    for z in (1.0, 0.8, 0.3, 0.05):
        v = (np.sqrt(1 - z * z), 0.0, z)
        for alpha in (0.1, 0.3, 0.6, 1.0):
            share = np.sum(over(eval_ggx, WHITE, np.full(len(l), alpha), UP, l, v)[:, 0] * weight)
            assert 0.3 < share < 1.01


def test_energy_of_the_highlight():
    """Seen from above, ks (n.h)^p sends out 8/(p + 2) (1 - 2^-(p/2 + 1)) of ks: the half vector leans half as far as the light."""
    l, weight = _hemisphere()  # noqa: E741
    for p in (0.0, 1.0, 10.0, 100.0, 1000.0):
        share = np.sum(over(eval_blinn_phong, WHITE, np.full(len(l), p), UP, l, UP)[:, 0] * weight)
        assert share == pytest.approx(8 / (p + 2) * (1 - 2 ** -(p / 2 + 1)), rel=2e-3)


def test_lobes_are_black_from_below():
    below = _upper_directions(500, 5) * (1, 1, -1)
    eye = _upper_directions(500, 6)
    for values in (
        over(eval_lambert, WHITE, UP, below),
        over(eval_ggx, WHITE, np.full(500, 0.3), UP, below, eye),
        over(eval_blinn_phong, WHITE, np.full(500, 10.0), UP, below, eye),
    ):
        np.testing.assert_array_equal(values, 0.0)


def test_lobes_stay_finite_where_they_are_singular():
    """A perfect mirror, grazing light, the eye in the surface: no infinity, no NaN."""
    directions = np.array([(0, 0, 1), (1, 0, 0), (1, 0, 1e-8), (0, 1, -1e-8), (-1, 0, 1e-30), (0, 0, -1)], dtype=np.float64)
    l, v = (a.reshape(-1, 3) for a in np.broadcast_arrays(directions[:, None], directions))  # noqa: E741
    for alpha in (0.0, 1e-8, 1.0):
        assert np.isfinite(over(eval_ggx, WHITE, np.full(len(l), alpha), UP, l, v)).all()
    for p in (0.0, 1e6):
        assert np.isfinite(over(eval_blinn_phong, WHITE, np.full(len(l), p), UP, l, v)).all()
