"""Laws of light at the surface between two media, whatever the angle and the indices."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from staging import SLOW_AS_PYTHON

from limner.shading.dielectric import fresnel, meet_interface, reflectance, refract, straight_transmittance
from limner.shading.frosted import walk_interface
from limner.tables.layouts import EXACT, SCHLICK

N = np.array((0.0, 0.0, 1.0))


def _arriving(n: int, seed: int = 0) -> np.ndarray:
    """Unit rays that come down on z = 0."""
    d = np.random.default_rng(seed).normal(size=(n, 3))
    d[:, 2] = -np.abs(d[:, 2]) - 1e-3
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.mark.parametrize(("n_i", "n_t"), [(1.0, 1.5), (1.5, 1.0), (1.33, 1.5), (1.0, 1.0), (2.4, 1.33)])
def test_snell(n_i, n_t):
    """n_i sin theta = n_t sin phi, in the plane of incidence, of unit length; none where that has no solution."""
    d = _arriving(3000)
    t, cos_t = over(refract, d, N, n_i / n_t)
    sine = n_i / n_t * np.sqrt(1 - d[:, 2] ** 2)
    total = cos_t < 0
    np.testing.assert_array_equal(total[np.abs(sine - 1) > 1e-5], (sine > 1)[np.abs(sine - 1) > 1e-5])
    t, d, cos_t, sine = t[~total], d[~total], cos_t[~total], sine[~total]
    np.testing.assert_allclose(np.linalg.norm(t, axis=1), 1.0, atol=2e-6)
    np.testing.assert_allclose(np.linalg.norm(t[:, :2], axis=1), sine, atol=2e-6)
    np.testing.assert_allclose(-t[:, 2], cos_t, atol=2e-6)
    np.testing.assert_allclose(np.cross(t, d) @ N, 0.0, atol=1e-6)


def test_there_and_back_is_the_same_way():
    """A refracted ray, turned round, is refracted to where it came from, and as much of it is reflected (Stokes, Helmholtz)."""
    d = _arriving(2000, 1)
    d = d[d[:, 2] < -0.05]  # where a cosine of float32 tells an angle
    t, cos_t = over(refract, d, N, 1.0 / 1.5)
    back, cos_back = over(refract, -t, -N, 1.5)
    np.testing.assert_allclose(back, -d, atol=5e-6)
    np.testing.assert_allclose(over(fresnel, -d[:, 2], cos_t, 1.0, 1.5), over(fresnel, cos_t, cos_back, 1.5, 1.0), atol=3e-5)


@given(st.floats(0.2, 5.0), st.floats(0.2, 5.0))
def test_straight_on_and_grazing(n_i, n_t):
    """((n_i - n_t) / (n_i + n_t))^2 straight on, exact and by Schlick; everything at grazing angles; never more, never less than none."""
    r0 = ((n_i - n_t) / (n_i + n_t)) ** 2
    cos_i = np.linspace(1.0, 0.0, 101)
    squared = 1 - (n_i / n_t) ** 2 * (1 - cos_i**2)
    cos_t = np.where(squared > 0, np.sqrt(np.maximum(squared, 0)), -1.0)
    for kind in (EXACT, SCHLICK):
        r = over(reflectance, kind, cos_i, cos_t, n_i, n_t)
        assert r[0] == pytest.approx(r0, abs=1e-5)
        assert r[-1] == pytest.approx(1.0, abs=1e-5) or (abs(n_i - n_t) < 1e-3 and kind == EXACT)
        assert (r >= 0).all()
        assert (r <= 1 + 1e-6).all()
        np.testing.assert_array_equal(r[cos_t < 0], 1.0)


def test_critical_angle():
    """Out of glass, everything is reflected beyond arcsin(1/n), not only near 90 degrees (errata to 13.1)."""
    angle = np.radians(np.array([41.0, 41.7, 41.9, 45.0, 89.0]))
    d = np.stack([np.sin(angle), 0 * angle, -np.cos(angle)], axis=1)
    _, cos_t = over(refract, d, N, 1.5)
    np.testing.assert_array_equal(cos_t < 0, angle > np.arcsin(1 / 1.5))


def test_brewster():
    """At tan theta = n, light along the plane of incidence is not reflected at all: the mean is half of the other part."""
    theta = np.arctan(1.5)
    cos_i, cos_t = np.cos(theta), np.cos(np.arcsin(np.sin(theta) / 1.5))
    across = ((cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t)) ** 2
    assert over(fresnel, cos_i, cos_t, 1.0, 1.5)[0] == pytest.approx(across / 2, rel=1e-5)


def test_schlick_comes_close():
    """Within 0.04 of Fresnel for glass, from either side, since its cosine is taken on the thinner side."""
    for n_i, n_t in ((1.0, 1.5), (1.5, 1.0)):
        cos_i = np.linspace(0.001, 1.0, 500)
        squared = 1 - (n_i / n_t) ** 2 * (1 - cos_i**2)
        cos_t = np.where(squared > 0, np.sqrt(np.maximum(squared, 0)), -1.0)
        exact, quick = over(reflectance, EXACT, cos_i, cos_t, n_i, n_t), over(reflectance, SCHLICK, cos_i, cos_t, n_i, n_t)
        np.testing.assert_allclose(quick, exact, atol=0.04)


def test_straight_through_is_alike_from_both_sides():
    """Light that is taken to go straight on leaves as much on its way in as on its way out; of thin glass, 92 % is left."""
    cosine = np.linspace(0.0, 1.0, 50)
    there, back = over(straight_transmittance, EXACT, cosine, 1.0, 1.5), over(straight_transmittance, EXACT, cosine, 1.5, 1.0)
    np.testing.assert_array_equal(there, back)
    assert there[-1] ** 2 == pytest.approx(0.96**2, rel=1e-5)


@pytest.mark.parametrize("roughness2", [0.0, 1e-4, 0.1, 0.5, 1.0])
@pytest.mark.parametrize(("n_i", "n_t"), [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0)])
def test_an_interface_gives_what_it_gets_or_less(roughness2, n_i, n_t):
    """Reflected light stays above, transmitted light goes below, unit rays both, and together no more than came: polished, all of it."""
    d = _arriving(4000, 2)
    u, v = np.random.default_rng(3).uniform(size=(2, len(d)))
    r, share_r, t, share_t = over(meet_interface, EXACT, roughness2, N, N, d, n_i, n_t, u, v)
    both = share_r.astype(np.float64) + share_t
    assert (share_r >= 0).all()
    assert (share_t >= 0).all()
    assert (both <= 1 + 1e-5).all()
    assert (r[share_r > 0, 2] > 0).all()
    assert (t[share_t > 0, 2] < 0).all()
    np.testing.assert_allclose(np.linalg.norm(r[share_r > 0], axis=1), 1.0, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(t[share_t > 0], axis=1), 1.0, atol=1e-5)
    if roughness2 == 0.0:
        np.testing.assert_allclose(both, 1.0, atol=1e-5)
    else:
        assert both.mean() > 0.35  # what is scattered more than once is lost


def test_a_leaning_normal_sends_no_light_to_the_wrong_side():
    """Shading normals that differ from the surface, as they do on smooth meshes: never a reflected ray below, nor a refracted one above."""
    d = _arriving(5000, 4)
    leaning = np.random.default_rng(5).normal(size=(5000, 3)) * 0.4 + N
    leaning /= np.linalg.norm(leaning, axis=1, keepdims=True)
    leaning[leaning[:, 2] < 0.05] = N
    for n_i, n_t in ((1.0, 1.5), (1.5, 1.0)):
        r, share_r, t, share_t = over(meet_interface, EXACT, 0.0, N, leaning, d, n_i, n_t, 0.5, 0.5)
        assert (r[share_r > 0, 2] > 0).all()
        assert (t[share_t > 0, 2] < 0).all()
        np.testing.assert_allclose(share_r + share_t, 1.0, atol=1e-5)




def _spread(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As much light from every direction of the upper side: rays, squared cosines, and two numbers each."""
    square, turn, u, v = np.random.default_rng(seed).random((4, n))
    sine, phi = np.sqrt(1 - square), 2 * np.pi * turn
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), -np.sqrt(square)], axis=1), square, np.stack([u, v])


@SLOW_AS_PYTHON
@pytest.mark.parametrize("kind", [EXACT, SCHLICK])
@pytest.mark.parametrize("roughness", [0.1, 0.5, 1.0])
def test_light_that_walks_over_a_frosted_surface_leaves_it(kind, roughness):
    """Furnace: whatever the index and the angle, one way carries all; single facets keep as little as half, and little is lost to them."""
    d, _, (u, v) = _spread(4000, 11)
    for n_i, n_t in ((1.0, 1.1), (1.0, 2.0), (1.1, 1.0), (1.5, 1.0), (2.0, 1.0)):
        r, share_r, t, share_t = over(walk_interface, kind, roughness**2, N, N, d, n_i, n_t, u, v)
        assert (share_r + share_t).mean(dtype=np.float64) > 0.999
        assert set(np.unique(share_r)) <= {0.0, 1.0}
        assert (r[share_r > 0, 2] > 0).all()
        assert (t[share_t > 0, 2] < 0).all()
        np.testing.assert_allclose(np.linalg.norm(np.where(share_r[:, None] > 0, r, t), axis=1), 1.0, atol=1e-5)
        once_r, once_t = (over(meet_interface, kind, roughness**2, N, N, d, n_i, n_t, u, v)[k].mean(dtype=np.float64) for k in (1, 3))
        error = 3 / np.sqrt(len(d))
        assert share_r.mean() > once_r - error
        assert share_t.mean() > once_t - error


@SLOW_AS_PYTHON
def test_a_walk_is_as_likely_there_as_back():
    """Helmholtz: from every fifth of the light of either side to every other goes as much as back, of both sides' n^2 as light is squeezed.

    z-scores of the differences of counts, reflected and refracted, are as far spread as chance has them.
    """
    n, fifths = 100_000, 5
    flow = np.zeros((2 * fifths, 2 * fifths))
    squared = np.zeros_like(flow)
    for side, (n_i, n_t) in enumerate(((1.0, 1.5), (1.5, 1.0))):
        d, square, (u, v) = _spread(n, 5 + side)
        r, share_r, t, share_t = over(walk_interface, EXACT, 0.64, N, N, d, n_i, n_t, u, v)
        start = side * fifths + np.minimum((square * fifths).astype(int), fifths - 1)
        for way, share, other in ((r, share_r, side), (t, share_t, 1 - side)):
            end = other * fifths + np.minimum((way[:, 2].astype(np.float64) ** 2 * fifths).astype(int), fifths - 1)
            np.add.at(flow, (start, end), share * n_i**2)
            np.add.at(squared, (start, end), share * n_i**4)
    upper = np.triu_indices(2 * fifths, 1)
    z = ((flow - flow.T) / np.sqrt(squared + squared.T))[upper]
    assert flow[upper].min() > 50
    assert stats.chi2.sf(np.sum(z**2), len(z)) > 1e-3


def test_a_walk_between_equal_indices_goes_straight_on():
    """Facets that bend nothing are not there."""
    d, _, (u, v) = _spread(60, 2)
    _, _, t, share = over(walk_interface, EXACT, 0.5, N, N, d, 1.3, 1.3, u, v)
    assert share.mean() > 0.95
    np.testing.assert_allclose(t[share > 0], d[share > 0], atol=2e-5)
