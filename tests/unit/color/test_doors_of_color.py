"""The doors of the room: names that are not known, arrays that are no colours, lights, metals, gamma, and profiles."""

from __future__ import annotations

import io

import numpy as np
import pytest

from limner.color.convert import convert_color
from limner.color.difference import color_difference
from limner.color.encodings import encoding
from limner.color.gamut import fit_to_gamut, gamut_area
from limner.color.illuminants import daylight_xy, illuminant
from limner.color.light import light_color, rgb_from_reflectance
from limner.color.metals import METALS, measured_metal, metal_color, metal_spectrum, normal_reflectance
from limner.color.observer import luminous_efficiency, matching_functions
from limner.color.profile import icc_profile
from limner.color.spaces import SPACES, Space, space
from limner.color.spectrum import WAVELENGTHS, Spectrum
from limner.color.temperature import xy_from_kelvin
from limner.color.transfer import gamma_from_linear, gamma_from_match
from limner.errors import SceneError, UnsupportedError


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: convert_color([0, 0, 0], "srgb", "cmyk"), "prophoto.*lab.*got 'cmyk'"),
        (lambda: convert_color([0, 0, 0], "linear_lab", "srgb"), "got 'linear_lab'"),
        (lambda: convert_color([0, 0, 0], "srgb", "lab", "magic"), "bradford.*got 'magic'"),
        (lambda: space("P3"), "display_p3.*got 'P3'"),
        (lambda: encoding("gamma"), "srgb.*got 'gamma'"),
        (lambda: illuminant("F2"), "D65.*got 'F2'"),
        (lambda: matching_functions("me"), "cie_1931_2.*got 'me'"),
        (lambda: luminous_efficiency("dim"), "photopic or scotopic"),
        (lambda: color_difference([0, 0, 0], [0, 0, 0], "3000"), "2000, 94, 76"),
        (lambda: fit_to_gamut([0, 0, 0], "squeeze"), "clip, chroma"),
        (lambda: gamut_area("srgb", "lab"), "xy or uv"),
        (lambda: metal_color("mithril"), "gold.*got 'mithril'"),
        (lambda: icc_profile("rec2100_pq"), "no ICC profile"),
    ],
)
def test_unknown_names_are_told_the_known_ones(call: object, named: str) -> None:
    """Each says what there is."""
    with pytest.raises(UnsupportedError, match=named):
        call()  # type: ignore[operator]


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: convert_color([0.1, 0.2], "srgb", "lab"), r"3 numbers along the last axis, got shape \(2,\)"),
        (lambda: convert_color(0.5, "srgb", "lab"), r"got shape \(\)"),
        (lambda: convert_color("red", "srgb", "lab"), "must be numbers"),
        (lambda: convert_color(np.zeros(3), "srgb", "lab", out=np.zeros(3, np.float32)), "out must be an array of shape"),
        (lambda: color_difference(np.zeros((2, 3)), np.zeros((4, 3))), "shapes that fit"),
        (lambda: Spectrum([400, 500], [1.0]), "a value for each wavelength"),
        (lambda: Spectrum([500, 400], [1.0, 1.0]), "ascend"),
        (lambda: Spectrum([400, 500], [np.nan, 1.0]), "finite"),
        (lambda: rgb_from_reflectance([0.5, 0.5]), "471"),
        (lambda: daylight_xy(3000.0), "4000 to 25000"),
        (lambda: xy_from_kelvin(10.0), "between 500"),
        (lambda: light_color(-1), "above 0"),
        (lambda: light_color(300), "does not glow"),
        (lambda: light_color(), "give one"),
        (lambda: light_color(3000, spectrum=illuminant("A")), "give one"),
        (lambda: light_color(spectrum=Spectrum([900, 901], [0.0, 0.0])), "cannot be seen"),
        (lambda: gamma_from_match(1.0), "between 0 and 1"),
        (lambda: Space("x", "x", (0, 0), (0.1, 0.1), (0.2, 0.2), (0.3, 0.3), "srgb"), "on one line"),
    ],
)
def test_what_makes_no_colour_is_refused_in_words(call: object, said: str) -> None:
    """One clear line each."""
    with pytest.raises(SceneError, match=said):
        call()  # type: ignore[operator]


def test_lights_of_a_temperature_have_luminance_one() -> None:
    """Warm is red, cold is blue, 6504 K of the sky is white, and a candela stays a candela."""
    luminance = SPACES["srgb"].xyz_from_rgb[1]
    lights = np.array([light_color(kelvin) for kelvin in (1200, 1900, 2856, 5500, 9000, 1e5)])
    assert lights @ luminance == pytest.approx(1.0)
    assert (lights >= 0.0).all()
    assert (np.diff(lights[:, 0]) < 0.0).all()
    assert (np.diff(lights[1:, 2]) > 0.0).all()
    assert light_color(6500 * 1.4388 / 1.4380, is_daylight=True) == pytest.approx((1.0, 1.0, 1.0), abs=1e-3)
    assert light_color(spectrum=illuminant("A")) == pytest.approx(light_color(2856), abs=1e-3)


def test_metals_have_the_colours_that_they_have() -> None:
    """Silver, aluminium are bright and grey; gold and copper lose blue; all lie in [0, 1], and so does each spectrum."""
    colors = {name: np.array(metal_color(name)) for name in METALS}
    for name, color in colors.items():
        assert ((color > 0.3) & (color <= 1.0)).all(), name
        measured = measured_metal(name)
        assert measured.wavelengths[0] <= 390.0
        assert measured.wavelengths[-1] >= 780.0
        assert (metal_spectrum(name).values < 1.0).all()
    assert colors["silver"].min() > 0.9
    assert np.ptp(colors["aluminium"]) < 0.02
    assert colors["gold"] == pytest.approx((1.0, 0.73, 0.37), abs=0.02)
    assert colors["copper"][0] > colors["copper"][1] > colors["copper"][2]
    assert normal_reflectance(1.5, 0.0) == pytest.approx(0.04)


def test_a_white_paint_is_white_in_every_light() -> None:
    """Who looks is used to the light: what reflects all is (1, 1, 1), under lamps and by day."""
    for name in ("A", "C", "D50", "D65", "E"):
        assert rgb_from_reflectance(np.ones(len(WAVELENGTHS)), name) == pytest.approx((1.0, 1.0, 1.0), abs=1e-12)


def test_a_matched_grey_gives_the_gamma_of_its_display() -> None:
    """The number that a display of that gamma shows at half of its light, and at a quarter of it, gives the gamma back."""
    for gamma in (1.0, 1.8, 2.2, 2.6):
        for share in (0.25, 0.5):
            assert gamma_from_match(gamma_from_linear(share, gamma), share) == pytest.approx(gamma)


@pytest.mark.parametrize("name", ["srgb", "display_p3", "adobe_rgb", "prophoto", "rec2020", "dci_p3", "acescg"])
def test_profiles_mean_to_others_what_they_mean_here(name: str) -> None:
    """LittleCMS, which knows nothing of limner, converts by the profile to sRGB as `convert_color` does, within a code of 255."""
    cms = pytest.importorskip("PIL.ImageCms")
    picture = pytest.importorskip("PIL.Image")
    codes = np.random.default_rng(3).integers(40, 200, (8, 8, 3), dtype=np.uint8)
    profile = cms.ImageCmsProfile(io.BytesIO(icc_profile(name)))
    assert cms.getProfileDescription(profile).strip() == space(name).title
    srgb = cms.createProfile("sRGB")
    intent = cms.Intent.RELATIVE_COLORIMETRIC
    found = np.asarray(cms.profileToProfile(picture.fromarray(codes), profile, srgb, renderingIntent=intent), dtype=np.float64)
    expected = 255.0 * np.clip(convert_color(codes / 255.0, name, "srgb"), 0.0, 1.0)
    assert np.abs(found - expected).max() < 1.6
