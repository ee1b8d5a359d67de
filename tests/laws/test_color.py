"""What holds of all colours: conversions come back, shapes and kinds of floats stay, white is white, and NaN is nobody else's."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON

from limner.color.adaptation import ADAPTATIONS, adaptation_matrix
from limner.color.chromaticity import dominant_wavelength, uv_from_xy, xy_from_uv, xyy_from_xyz, xyz_from_xyy
from limner.color.convert import COLOR_SPACES, convert_color
from limner.color.encodings import ENCODINGS, decoded, encoded
from limner.color.gamut import fit_to_gamut, gamut_area, gamut_coverage, in_gamut
from limner.color.illuminants import illuminant
from limner.color.observer import matching_functions
from limner.color.spaces import SPACES, rgb_from_rgb
from limner.color.spectrum import WAVELENGTHS
from limner.color.temperature import kelvin_from_xy, xy_from_kelvin
from limner.color.tristimulus import metamer, white_xyz, xyz_from_reflectance
from limner.color.uniform import oklab_from_xyz

RANDOM = np.random.default_rng(7)
RGB = RANDOM.uniform(0.0, 1.0, (64, 3))
WIDE = RANDOM.uniform(-0.5, 2.0, (64, 3))


@pytest.mark.parametrize("name", COLOR_SPACES)
def test_every_space_comes_back(name: str) -> None:
    """From stored sRGB to any space and back: 1e-12 in float64 (1e-9 through Luv of nearly black)."""
    there = convert_color(RGB, "srgb", name)
    assert convert_color(there, name, "srgb") == pytest.approx(RGB, abs=1e-12)


@pytest.mark.parametrize("name", [name for name in COLOR_SPACES if name not in ("hsv", "hsl", "xyy", "lch_uv", "luv")])
def test_what_no_screen_shows_comes_back_too(name: str) -> None:
    """Numbers below 0 and above 1: the curves go on beyond both ends."""
    there = convert_color(WIDE, "linear_srgb", name)
    assert convert_color(there, name, "linear_srgb") == pytest.approx(WIDE, abs=3e-12)


@pytest.mark.parametrize("name", ENCODINGS)
def test_curves_are_odd_rise_and_have_an_inverse(name: str) -> None:
    """Also on both sides of the joints, where the standards' rounding would leave a gap."""
    x = np.sort(np.concatenate([np.linspace(0.0, 1.5, 400), RANDOM.uniform(0.0028, 0.0034, 400), RANDOM.uniform(0.0178, 0.0182, 400)]))
    y = encoded(x, name)
    assert (np.diff(y) >= 0.0).all()
    assert np.array_equal(encoded(-x, name), -y)
    assert decoded(y, name) == pytest.approx(x, abs=1e-12)
    assert decoded(-y, name) == pytest.approx(-x, abs=1e-12)
    assert encoded(0.0, name) == 0.0


@pytest.mark.parametrize("name", sorted(SPACES))
def test_white_is_white_in_every_space(name: str) -> None:
    """(1, 1, 1) is a space's white, and becomes (1, 1, 1) of every other, however one gets used to it."""
    assert SPACES[name].xyz_from_rgb.sum(axis=1) == pytest.approx(SPACES[name].white_xyz, abs=1e-14)
    for adaptation in ADAPTATIONS:
        assert rgb_from_rgb("srgb", name, adaptation).sum(axis=1) == pytest.approx(1.0, abs=1e-13)
    assert convert_color(np.ones(3), f"linear_{name}", "oklab") == pytest.approx((1.0, 0.0, 0.0), abs=2e-4)


def test_neighbours_multiply() -> None:
    """c_from_b @ b_from_a = c_from_a, where whites are alike; adapting there and back is nothing."""
    assert rgb_from_rgb("rec2020", "display_p3") @ rgb_from_rgb("display_p3", "srgb") == pytest.approx(rgb_from_rgb("rec2020", "srgb"))
    there, back = adaptation_matrix((0.96, 1, 0.82), (0.95, 1, 1.09)), adaptation_matrix((0.95, 1, 1.09), (0.96, 1, 0.82))
    assert there @ back == pytest.approx(np.eye(3), abs=1e-14)


@pytest.mark.parametrize("target", ["display_p3", "linear_acescg", "lab", "oklch", "hsv", "xyy", "rec2100_pq"])
def test_shapes_stay_and_float32_stays_float32(target: str) -> None:
    """One triple, rows, a picture, nothing at all, strided memory: as many, as they were; float32 is float64, rounded."""
    picture = RGB.reshape(4, 16, 3)
    expected = convert_color(picture, "srgb", target)
    assert convert_color(picture[:, ::2], "srgb", target) == pytest.approx(expected[:, ::2], rel=1e-12)
    assert convert_color(picture[1, 2], "srgb", target) == pytest.approx(expected[1, 2], rel=1e-12)
    assert convert_color(np.zeros((0, 3)), "srgb", target).shape == (0, 3)
    single = convert_color(picture.astype(np.float32), "srgb", target)
    assert single.dtype == np.float32
    assert single == pytest.approx(expected, rel=1e-4, abs=2e-5)


@SLOW_AS_PYTHON
def test_large_pictures_take_the_kernel_to_the_same_numbers() -> None:
    """Many float32 colours, converted by the kernel, differ from float64 by a few last places; odd sizes, NaN, infinities too."""
    many = np.concatenate([RANDOM.uniform(-0.5, 4.0, (5461, 3)), [[np.nan, 0.5, 1.0]], [[0.0, -0.0, 1e-30]]]).astype(np.float32)
    for source, target in (
        ("srgb", "linear_display_p3"),
        ("linear_srgb", "adobe_rgb"),
        ("linear_rec2020", "linear_srgb"),
        ("rec709", "srgb"),
    ):
        found, expected = convert_color(many, source, target), convert_color(many.astype(np.float64), source, target)
        assert found.dtype == np.float32
        assert np.array_equal(np.isnan(found), np.isnan(expected))
        sound = ~np.isnan(expected)
        assert np.abs(found - expected)[sound].max() <= 4e-6 * np.abs(expected[sound]).max()
    infinite = np.full((6000, 3), np.inf, dtype=np.float32)
    assert np.isposinf(convert_color(infinite, "linear_srgb", "srgb")).all()
    place = many.copy()
    assert convert_color(place, "srgb", "display_p3", out=place) is place
    assert np.array_equal(place, convert_color(many, "srgb", "display_p3"), equal_nan=True)


@pytest.mark.parametrize("name", ["display_p3", "linear_acescg", "lab", "oklab", "lch", "luv", "xyy", "hsl"])
def test_nan_stays_where_it_is(name: str) -> None:
    """A colour that is no number becomes none, without a warning; its neighbours do not notice."""
    spoiled = RGB.copy()
    spoiled[3] = np.nan
    found = convert_color(spoiled, "srgb", name)
    assert np.isnan(found[3]).all()
    keep = np.arange(len(RGB)) != 3
    assert np.array_equal(found[keep], convert_color(RGB, "srgb", name)[keep])


def test_chromaticity_comes_back_and_answers_for_black() -> None:
    """xyY and u'v' there and back; y = 0 and black have answers, not warnings."""
    xyz = RANDOM.uniform(0.01, 1.0, (100, 3))
    assert xyz_from_xyy(xyy_from_xyz(xyz)) == pytest.approx(xyz, abs=1e-14)
    xy = RANDOM.uniform(0.05, 0.6, (100, 2))
    assert xy_from_uv(uv_from_xy(xy)) == pytest.approx(xy, abs=1e-13)
    assert xyz_from_xyy([[0.3, 0.0, 0.5], [0.3, 0.0, 0.0]]).tolist() == [[0.0] * 3] * 2
    assert xyy_from_xyz(np.zeros(3)).tolist() == [0.3127, 0.3290, 0.0]


def test_temperature_comes_back_from_beside_the_locus() -> None:
    """A point of the locus, moved off it at a right angle by Duv, has the temperature it was taken from."""
    kelvin = np.geomspace(1000.0, 50000.0, 25)
    xy = xy_from_kelvin(kelvin)
    found = kelvin_from_xy(xy)
    assert found.kelvin == pytest.approx(kelvin, rel=1e-5)
    assert np.abs(found.duv).max() < 1e-7
    assert np.isnan(kelvin_from_xy([[np.nan, 0.3], [0.15, 0.06]]).kelvin).all()


def test_mixtures_with_white_keep_their_dominant_wavelength() -> None:
    """Purity falls with the share of white, the wavelength stays; white has none; a purple has its complement's, with a minus."""
    white, pure = np.array([0.3127, 0.3290]), np.array([0.1, 0.7])
    shares = np.array([0.1, 0.5, 0.9])
    found = dominant_wavelength(white + shares[:, None] * (pure - white))
    assert found.wavelength == pytest.approx(found.wavelength[0])
    assert found.purity / shares == pytest.approx(found.purity[0] / shares[0])
    opposite = dominant_wavelength(white - 0.2 * (pure - white))
    assert opposite.wavelength == pytest.approx(-found.wavelength[0])
    none = dominant_wavelength(white)
    assert np.isnan(none.wavelength)
    assert none.purity == 0.0


def test_metamers_look_alike_in_one_light_only() -> None:
    """The same XYZ in D65 to rounding, another in A; both are reflectances."""
    paint = 0.3 + 0.3 / (1.0 + np.exp((560.0 - WAVELENGTHS) / 15.0))
    other = metamer(paint, "D65")
    assert other.min() >= 0.0
    assert other.max() <= 1.0
    assert xyz_from_reflectance(other) == pytest.approx(xyz_from_reflectance(paint), abs=1e-13)
    assert np.abs(xyz_from_reflectance(other, "A") - xyz_from_reflectance(paint, "A")).max() > 0.005
    assert np.abs(other - paint).max() > 0.1


def test_grey_is_as_bright_as_it_reflects() -> None:
    """A reflectance of 0.5 everywhere has half of the white's XYZ, in any light, for any observer."""
    for observer in ("cie_1931_2", "cie_1964_10"):
        for name in ("A", "D50", "E"):
            half = xyz_from_reflectance(np.full((2, len(WAVELENGTHS)), 0.5), illuminant(name), observer)
            assert half == pytest.approx(np.stack([0.5 * white_xyz(name, observer)] * 2))
    assert (matching_functions() >= 0.0).all()


def test_colours_that_cannot_be_shown_are_fitted() -> None:
    """Both ways end in the gamut and leave what is in it; giving up chroma keeps Oklab's hue and lightness, clipping does not."""
    inside = in_gamut(RGB)
    assert inside.all()
    for method in ("clip", "chroma"):
        assert np.array_equal(fit_to_gamut(RGB, method), RGB)
        assert in_gamut(fit_to_gamut(WIDE, method, "display_p3")).all()
        assert np.isnan(fit_to_gamut([np.nan, 0.5, 2.0], method)).any()
    strong = convert_color([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "linear_rec2020", "linear_srgb")
    before = oklab_from_xyz(strong @ SPACES["srgb"].xyz_from_rgb.T)
    after = oklab_from_xyz(fit_to_gamut(strong, "chroma") @ SPACES["srgb"].xyz_from_rgb.T)
    clipped = oklab_from_xyz(fit_to_gamut(strong, "clip") @ SPACES["srgb"].xyz_from_rgb.T)
    hue = np.arctan2(before[:, 2], before[:, 1])
    assert after[:, 0] == pytest.approx(before[:, 0], abs=1e-6)
    assert np.arctan2(after[:, 2], after[:, 1]) == pytest.approx(hue, abs=1e-4)
    assert np.abs(np.arctan2(clipped[:, 2], clipped[:, 1]) - hue).max() > 0.01


def test_gamuts_cover_themselves_and_what_they_contain() -> None:
    """Coverage is 1 of itself, symmetric in its area, and less than 1 of what is larger."""
    for name in SPACES:
        assert gamut_coverage(name, name) == pytest.approx(1.0)
    for first, second in (("adobe_rgb", "display_p3"), ("srgb", "rec2020"), ("acescg", "prophoto")):
        both = gamut_coverage(first, second) * gamut_area(second)
        assert both == pytest.approx(gamut_coverage(second, first) * gamut_area(first))
    assert gamut_coverage("rec2020", "srgb") == pytest.approx(1.0)
    assert gamut_coverage("srgb", "rec2020", "uv") < 0.6
