"""Laws of the lobes beyond a plain base: drawn as they say, no more sent back than arrives, and as the closed forms have it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from compiled import over
from scipy import stats
from staging import SLOW_AS_PYTHON

from limner._jit import kernel
from limner.kernel.vec import Color, Vec3, max_component
from limner.scene.material_extensions import Conductor
from limner.shading.bsdf import eval_bsdf
from limner.shading.conductor import conductor_reflectance
from limner.shading.iridescence import film_reflectance
from limner.shading.layered import far_side
from limner.shading.layers import Layered  # noqa: F401 - its room belongs to the doors of these tests
from limner.shading.lobes import Bsdf, Layers
from limner.shading.oren_nayar import eval_oren_nayar, rough_matte_sent_on
from limner.shading.sample import pdf_bsdf, sample_bsdf
from limner.shading.sheen import eval_sheen, sheen_sent_on
from limner.tables.layouts import ANISOTROPY, COAT, COMPENSATED, CONDUCTOR, FILM, SHEEN, SHEET, SPECULAR_LAYER

f32 = np.float32
UP, WHITE, BLACK = (0.0, 0.0, 1.0), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
GOLD = Conductor.named("gold")

#        bits, diffuse, f0, alpha, along, coat (factor, alpha, -), sheen, sheen alpha, through
LOBES = {
    "specular": (SPECULAR_LAYER, (0.5, 0.4, 0.3), (0.1, 0.05, 0.02), 0.2, 0.2, BLACK, BLACK, 0.0, BLACK),
    "coat": (COAT, (0.5, 0.1, 0.1), (0.04, 0.04, 0.04), 0.5, 0.5, (1.0, 0.1, 0.0), BLACK, 0.0, BLACK),
    "sheen": (SHEEN, (0.3, 0.1, 0.1), (0.04, 0.04, 0.04), 0.5, 0.5, BLACK, (0.8, 0.6, 0.9), 0.3, BLACK),
    "brushed": (ANISOTROPY, BLACK, (0.9, 0.8, 0.6), 0.1, 0.6, BLACK, BLACK, 0.0, BLACK),
    "film": (FILM, (0.2, 0.2, 0.2), (0.04, 0.04, 0.04), 0.3, 0.3, BLACK, BLACK, 0.0, BLACK),
    "gold": (CONDUCTOR, BLACK, WHITE, 0.3, 0.3, BLACK, BLACK, 0.0, BLACK),
    "rough metal": (COMPENSATED, BLACK, (0.9, 0.7, 0.5), 0.8, 0.8, BLACK, BLACK, 0.0, BLACK),
    "all": (COAT | SHEEN | ANISOTROPY | FILM, (0.3, 0.2, 0.1), (0.3, 0.2, 0.1), 0.2, 0.5, (0.5, 0.2, 0.0), (0.5, 0.4, 0.3), 0.4, BLACK),
}


class Probed(NamedTuple):
    """What a lobe answers: its value and density for wi, and what it draws itself."""

    value: Color
    pdf: np.float32
    drawn: Vec3
    drawn_value: Color
    drawn_pdf: np.float32


@kernel
def probed(
    bits: np.int64, diffuse: Color, f0: Color, alpha: np.float32, along: np.float32, coat: Color, sheen: Color, sheen_alpha: np.float32,
    through: Color, wo: Vec3, wi: Vec3, choice: np.float32, u: np.float32, w: np.float32,
) -> Probed:  # fmt: skip
    """Ask a Bsdf about +z, its highlights drawn out along x, with a film of 400 nm and gold's index; FAR_SIDE asks its far side."""
    n, black = Vec3(f32(0.0), f32(0.0), f32(1.0)), Color(f32(0.0), f32(0.0), f32(0.0))
    zero, one = f32(0.0), f32(1.0)
    layers = Layers(
        one, max_component(f0), one, through, black, coat.r, coat.g, Vec3(f32(0.6), f32(0.0), f32(0.8)), sheen, sheen_alpha,
        Vec3(one, zero, zero), along, one, f32(400.0), f32(1.33), Color(f32(0.187), f32(0.518), f32(1.313)),
        Color(f32(3.409), f32(2.283), f32(1.852)), zero,
    )  # fmt: skip
    bsdf = Bsdf(n, diffuse, black, one, f0, alpha, black, one, black, black, one, Color(one, one, one), zero, bits, layers)
    if bits == SHEET:
        bsdf = far_side(bsdf)
    drawn = sample_bsdf(bsdf, wo, choice, u, w)
    return Probed(eval_bsdf(bsdf, wo, wi), pdf_bsdf(bsdf, wo, wi), drawn.wi, drawn.value, drawn.pdf)


def ask(*columns) -> Probed:
    return Probed(*over(probed, *columns))


def hemisphere(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions of a midpoint rule over the hemisphere, denser towards the pole, and their solid angles."""
    edges = (np.arange(n + 1) / n) ** 1.5 * np.pi / 2
    theta, weight = (edges[1:] + edges[:-1]) / 2, np.cos(edges[:-1]) - np.cos(edges[1:])
    phi = (np.arange(n) + 0.5) / n * 2 * np.pi
    theta, phi, weight = (a.ravel() for a in np.broadcast_arrays(theta[:, None], phi, weight[:, None] * (2 * np.pi / n)))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1), weight


def towards(cosine: float, azimuth: float = 0.4) -> np.ndarray:
    sine = np.sqrt(1 - cosine * cosine)
    return np.array([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine])


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", LOBES)
def test_drawn_as_its_density_says(name):
    """Chi-squared: directions fall into cells of the whole sphere of directions as often as the density's integral over them says."""
    n, cells, fine = 40_000, 12, 24
    u = np.random.default_rng(7).random((3, n))
    wo = towards(0.7)
    drawn = ask(*LOBES[name], wo, UP, *u).drawn.astype(np.float64)
    z = np.clip((drawn[:, 2] + 1) / 2 * cells, 0, cells - 1).astype(int)
    phi = np.clip((np.arctan2(drawn[:, 1], drawn[:, 0]) / (2 * np.pi) % 1.0) * cells, 0, cells - 1).astype(int)
    counts = np.bincount(z * cells + phi, minlength=cells * cells)
    edges = (np.arange(cells * fine) + 0.5) / (cells * fine)
    zz, pp = (a.ravel() for a in np.broadcast_arrays(edges[:, None] * 2 - 1, edges * 2 * np.pi))
    d = np.stack([np.sqrt(1 - zz * zz) * np.cos(pp), np.sqrt(1 - zz * zz) * np.sin(pp), zz], axis=1)
    pdf = ask(*LOBES[name], wo, d, 0.5, 0.5, 0.5).pdf.astype(np.float64).reshape(cells, fine, cells, fine)
    expected = pdf.sum(axis=(1, 3)).ravel() * (4 * np.pi / (cells * fine) ** 2) * n
    enough = expected > 20
    rest = np.array([counts[~enough].sum()]), np.array([expected[~enough].sum()])
    assert expected.sum() == pytest.approx(n, rel=5e-3)
    f_exp = np.append(expected[enough], max(rest[1][0], 1e-9))
    f_obs = np.append(counts[enough], rest[0][0])
    statistic = np.sum((f_obs - f_exp)[f_exp > 5] ** 2 / f_exp[f_exp > 5])
    assert stats.chi2.sf(statistic, (f_exp > 5).sum() - 1) > 1e-3


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", LOBES)
def test_no_more_is_sent_back_than_arrives(name):
    """The weights of drawn directions have the mean of the integral over the hemisphere, at most 1 in each channel."""
    n = 20_000
    u = np.random.default_rng(3).random((3, n))
    for cosine in (0.95, 0.5, 0.2):
        seen = ask(*LOBES[name], towards(cosine), UP, *u)
        found = seen.drawn_pdf > 0
        weights = np.where(found[:, None], seen.drawn_value / np.where(found, seen.drawn_pdf, 1)[:, None], 0).astype(np.float64)
        error = weights.std(axis=0) / np.sqrt(n)
        d, solid = hemisphere(160)
        integral = (ask(*LOBES[name], towards(cosine), d, 0.5, 0.5, 0.5).value * solid[:, None]).sum(axis=0)
        assert (np.abs(weights.mean(axis=0) - integral) < 5 * error + 0.01).all()
        assert (integral < 1.01).all()


@pytest.mark.parametrize("name", ["specular", "sheen", "brushed", "film", "gold"])
def test_lobes_are_the_same_both_ways(name):
    """f(l, v) = f(v, l) but for coats and compensation, which look at the eye alone."""
    rng = np.random.default_rng(5)
    a, b = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in rng.normal(size=(2, 60, 3)))
    a[:, 2], b[:, 2] = np.abs(a[:, 2]) + 0.05, np.abs(b[:, 2]) + 0.05
    a, b = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (a, b))
    there = ask(*LOBES[name], a, b, 0.5, 0.5, 0.5).value / b[:, 2:]
    back = ask(*LOBES[name], b, a, 0.5, 0.5, 0.5).value / a[:, 2:]
    np.testing.assert_allclose(there, back, rtol=2e-3, atol=1e-6)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("alpha", [0.09, 0.25, 0.64, 1.0])
def test_white_furnace_of_rough_metal(alpha):
    """A metal that reflects everything, under an even sky of 1, shows 1 within a hundredth from every side, however rough."""
    d, solid = hemisphere(260)
    for cosine in (1.0, 0.8, 0.5, 0.25):
        lobe = (COMPENSATED, BLACK, WHITE, alpha, alpha, BLACK, BLACK, 0.0, BLACK)
        sent = (ask(*lobe, towards(cosine), d, 0.5, 0.5, 0.5).value[:, 0] * solid).sum()
        assert sent == pytest.approx(1.0, abs=0.01)


@SLOW_AS_PYTHON
def test_the_table_of_fibres():
    """What white fibres send on of an even sky, integrated again."""
    d, solid = hemisphere(200)
    for roughness, cosine in ((0.4, 0.8), (0.6, 0.4), (1.0, 0.6)):
        alpha = roughness * roughness
        sent = (over(eval_sheen, WHITE, np.full(len(d), alpha), UP, d, towards(cosine))[:, 0] * solid).sum()
        assert over(sheen_sent_on, np.array([alpha]), cosine)[0] == pytest.approx(sent, rel=0.02, abs=2e-3)


def test_what_goes_through_a_rough_sheet():
    """The far side of a sheet is its reflection turned over, tinted, with what is reflected missing."""
    lobe = (0, BLACK, (0.04, 0.04, 0.04), 0.3, 0.3, BLACK, BLACK, 0.0)
    above, below = towards(0.8), towards(0.6, 2.0)
    mirrored = ask(SPECULAR_LAYER, *lobe[1:], BLACK, above[None], below[None], 0.5, 0.5, 0.5)
    down = np.array([1.0, 1.0, -1.0])
    through = ask(SHEET, *lobe[1:], (0.5, 0.25, 1.0), above[None] * down, below[None] * down, 0.5, 0.5, 0.5)
    h = above + below
    f = 0.04 + 0.96 * (1 - np.dot(above, h / np.linalg.norm(h))) ** 5
    np.testing.assert_allclose(through.value[0], mirrored.value[0] / f * (1 - f) * (0.5, 0.25, 1.0), rtol=1e-4)
    assert through.pdf[0] == pytest.approx(mirrored.pdf[0], rel=1e-4)


def test_metals_reflect_what_was_measured():
    """Straight on ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2), at 90 degrees 1, between them Fresnel's equations in complex numbers."""
    cos = np.linspace(0.0, 1.0, 30)
    seen = over(conductor_reflectance, np.tile(GOLD.eta, (30, 1)), GOLD.k, cos)
    eta = np.array(GOLD.eta) - 1j * np.array(GOLD.k)
    c = cos[:, None]
    inner = np.sqrt(1 - (1 - c * c) / eta**2)
    across, along = (c - eta * inner) / (c + eta * inner), (eta * c - inner) / (eta * c + inner)
    np.testing.assert_allclose(seen, (np.abs(across) ** 2 + np.abs(along) ** 2) / 2, atol=2e-5)
    # Reflectances at normal incidence as handbooks have them (CRC Handbook of Chemistry and Physics, 12-130): red, green, blue.
    for metal, known in (("silver", (0.98, 0.97, 0.95)), ("gold", (0.94, 0.74, 0.39)), ("aluminium", (0.91, 0.92, 0.92))):
        m = Conductor.named(metal)
        straight = over(conductor_reflectance, np.array([m.eta]), m.k, 1.0)[0]
        np.testing.assert_allclose(straight, known, atol=0.04)  # as far apart as films of different makers are


def airy(n_film: float, n_base: float, nanometres: float, cosine: float, wavelengths: np.ndarray) -> np.ndarray:
    """The reflectance of a film by Airy's sum, both polarisations averaged, in float64."""
    total = np.zeros_like(wavelengths)
    cos_film = np.sqrt(1 - (1 - cosine**2) / n_film**2)
    cos_base = np.sqrt(1 - (1 - cosine**2) / n_base**2)
    phase = 4 * np.pi * n_film * nanometres * cos_film / wavelengths
    for s in (True, False):
        if s:
            r12 = (cosine - n_film * cos_film) / (cosine + n_film * cos_film)
            r23 = (n_film * cos_film - n_base * cos_base) / (n_film * cos_film + n_base * cos_base)
        else:
            r12 = (n_film * cosine - cos_film) / (n_film * cosine + cos_film)
            r23 = (n_base * cos_film - n_film * cos_base) / (n_base * cos_film + n_film * cos_base)
        total += np.abs((r12 + r23 * np.exp(1j * phase)) / (1 + r12 * r23 * np.exp(1j * phase))) ** 2
    return total / 2


def test_a_film_against_the_sum_of_airy():
    """The mean over the eye's sensitivities, as the Gaussians have them, of Airy's exact spectrum: within 0.025 up to 60 degrees."""
    wavelengths = np.linspace(330.0, 900.0, 800)
    k = 1e9 / wavelengths  # wave numbers, the variable of the Gaussians
    parts = ((5.4856e-13, 1.6810e6, 4.3278e9), (4.4201e-13, 1.7953e6, 9.3046e9), (5.2481e-13, 2.2084e6, 6.6121e9))
    x, y, z = (v * np.exp(-((k - m) ** 2) / (2 * s)) for v, m, s in parts)
    x = x + 9.7470e-14 * np.exp(-((k - 2.2399e6) ** 2) / (2 * 4.5282e9))
    rgb_from_xyz = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]])
    f0 = ((1.8 - 1) / (1.8 + 1)) ** 2
    for nanometres in (250.0, 400.0, 700.0):
        for cosine in (1.0, 0.8, 0.5):
            r = airy(1.33, 1.8, nanometres, cosine, wavelengths)
            rgb = rgb_from_xyz @ [np.trapezoid(c[::-1] * r[::-1], k[::-1]) / np.trapezoid(y[::-1], k[::-1]) for c in (x, y, z)]
            flat = rgb_from_xyz @ [np.trapezoid(c[::-1], k[::-1]) / np.trapezoid(y[::-1], k[::-1]) for c in (x, y, z)]
            mean = r.mean()
            seen = over(film_reflectance, np.array([[f0] * 3]), 1.33, nanometres, cosine)[0]
            np.testing.assert_allclose(seen, np.clip(rgb - (flat - 1) * mean, 0, 1), atol=0.025)


def test_a_rough_matte_ball_is_as_bright_at_its_edge():
    """With the light in one's back Lambert falls off with the cosine; sigma 0 is Lambert, and roughness lifts the edge."""
    cos = np.array([0.2, 0.5, 1.0])
    d = np.stack([towards(c) for c in cos])
    smooth, rough = (over(eval_oren_nayar, WHITE, np.full(3, s), UP, d, d)[:, 0] * np.pi for s in (0.0, 0.6))
    np.testing.assert_allclose(smooth, cos, rtol=1e-5)
    assert rough[0] / rough[2] > 2 * smooth[0] / smooth[2]
    d, solid = hemisphere(80)
    for sigma, cosine in ((0.6, 0.5), (0.3, 0.15), (1.2, 0.9)):
        sent = (over(eval_oren_nayar, WHITE, np.full(len(d), sigma), UP, d, towards(cosine))[:, 0] * solid).sum()
        assert sent < 1.0
        assert over(rough_matte_sent_on, np.array([sigma]), cosine)[0] == pytest.approx(sent, rel=5e-3)
