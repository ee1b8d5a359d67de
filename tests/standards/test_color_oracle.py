"""Colour against `colour-science` and OpenColorIO, where they are installed: the same answers on random input."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from limner._jit import MODE
from limner.color.chromaticity import uv_from_xy, xyy_from_xyz, xyz_from_xyy
from limner.color.convert import convert_color
from limner.color.difference import color_difference
from limner.color.encodings import hlg_from_linear, linear_from_hlg, nits_from_pq, pq_from_nits
from limner.color.illuminants import daylight, planck
from limner.color.observer import matching_functions
from limner.color.published import published
from limner.color.spaces import SPACES, Space
from limner.color.spectrum import WAVELENGTHS, Spectrum
from limner.color.temperature import kelvin_from_xy
from limner.color.tristimulus import xyz_from_reflectance
from limner.color.uniform import lab_from_xyz, luv_from_xyz, oklab_from_xyz

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    colour = pytest.importorskip("colour", reason="colour-science, the oracle, is not installed")
    np.set_printoptions(legacy=False)  # it has numbers written as long ago, for all the process

RANDOM = np.random.default_rng(11)
XYZ = RANDOM.uniform(0.01, 1.2, (200, 3))
RGB = RANDOM.uniform(0.0, 1.0, (200, 3))
NAMES = {
    "srgb": "sRGB", "rec2020": "ITU-R BT.2020", "adobe_rgb": "Adobe RGB (1998)", "acescg": "ACEScg", "prophoto": "ProPhoto RGB",
    "dci_p3": "DCI-P3", "display_p3": "Display P3", "cie_rgb": "CIE RGB", "aces2065_1": "ACES2065-1",
}  # fmt: skip


def _white() -> np.ndarray:
    return np.array([0.3127, 0.3290])


@pytest.mark.parametrize("name", sorted(NAMES))
def test_linear_rgb_of_every_space_is_the_oracles(name: str) -> None:
    """Primaries as published, matrices derived, Bradford between whites: 1e-6 on random colours."""
    theirs = colour.RGB_COLOURSPACES[NAMES[name]].copy()
    theirs.use_derived_matrix_XYZ_to_RGB = theirs.use_derived_matrix_RGB_to_XYZ = True
    assert SPACES[name].primaries == pytest.approx(theirs.primaries, abs=1e-7)
    # The digits of the white are a matter of the source: the same are given to both.
    ours = Space(name, name, *map(tuple, theirs.primaries.tolist()), tuple(theirs.whitepoint.tolist()), "linear")
    assert SPACES[name].white == pytest.approx(theirs.whitepoint, abs=5e-5)
    srgb = colour.RGB_COLOURSPACES["sRGB"].copy()
    srgb.use_derived_matrix_XYZ_to_RGB = srgb.use_derived_matrix_RGB_to_XYZ = True
    expected = colour.RGB_to_RGB(RGB, srgb, theirs, chromatic_adaptation_transform="Bradford")
    assert convert_color(RGB, "linear_srgb", ours) == pytest.approx(expected, abs=1e-6)


def test_uniform_spaces_are_the_oracles() -> None:
    """Lab, Luv, Oklab, u'v', xyY: 1e-9 on random colours under D65. Oklab's matrices are printed to ten digits."""
    assert lab_from_xyz(XYZ) == pytest.approx(colour.XYZ_to_Lab(XYZ, _white()), abs=1e-9)
    assert luv_from_xyz(XYZ) == pytest.approx(colour.XYZ_to_Luv(XYZ, _white()), abs=1e-9)
    assert oklab_from_xyz(XYZ) == pytest.approx(colour.XYZ_to_Oklab(XYZ), abs=1e-6)
    assert xyy_from_xyz(XYZ) == pytest.approx(colour.XYZ_to_xyY(XYZ), abs=1e-12)
    assert xyz_from_xyy(XYZ) == pytest.approx(colour.xyY_to_XYZ(XYZ), abs=1e-12)
    assert uv_from_xy(XYZ[:, :2]) == pytest.approx(colour.xy_to_Luv_uv(XYZ[:, :2]), abs=1e-12)


def test_hue_saturation_and_value_are_the_oracles() -> None:
    """HSV and HSL of stored sRGB."""
    assert convert_color(RGB, "srgb", "hsv") == pytest.approx(colour.RGB_to_HSV(RGB), abs=1e-7)
    assert convert_color(RGB, "srgb", "hsl") == pytest.approx(colour.RGB_to_HSL(RGB), abs=1e-7)


@pytest.mark.parametrize(("ours", "theirs"), [("2000", "CIE 2000"), ("94", "CIE 1994"), ("76", "CIE 1976")])
def test_differences_are_the_oracles(ours: str, theirs: str) -> None:
    """On random pairs of Lab, far and near: 1e-9."""
    first = RANDOM.uniform((0.0, -100.0, -100.0), (100.0, 100.0, 100.0), (500, 3))
    second = first + RANDOM.normal(0.0, 1.0, first.shape) * RANDOM.choice([0.5, 50.0], (500, 1))
    assert color_difference(first, second, ours) == pytest.approx(colour.delta_E(first, second, method=theirs), abs=1e-9)


def test_curves_of_high_dynamic_range_are_the_oracles() -> None:
    """PQ and HLG, there and back; black is 0 here, 7e-7 there."""
    nits = np.concatenate([[0.001, 10000.0], RANDOM.uniform(0.0, 10000.0, 100)])
    assert pq_from_nits(nits) == pytest.approx(colour.models.eotf_inverse_ST2084(nits), abs=1e-9)
    signal = RANDOM.uniform(0.01, 1.0, 100)
    assert nits_from_pq(signal) == pytest.approx(colour.models.eotf_ST2084(signal), rel=1e-6)
    assert linear_from_hlg(signal) == pytest.approx(colour.models.oetf_inverse_BT2100_HLG(signal), abs=1e-6)
    assert hlg_from_linear(signal) == pytest.approx(colour.models.oetf_BT2100_HLG(signal), abs=1e-6)


def test_spectra_become_the_oracles_tristimulus_values() -> None:
    """Random reflectances at each nm under D65: sums at the same steps, 1e-9; and the same light of black bodies and of the sky."""
    table = published("illuminant_d65")
    values = RANDOM.uniform(0.0, 1.0, len(WAVELENGTHS))
    power = np.interp(WAVELENGTHS, table.wavelengths, table.values[:, 0])
    functions = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].values
    assert np.array_equal(matching_functions(), functions)
    weights = functions * power[:, None]
    assert xyz_from_reflectance(values) == pytest.approx(values @ weights / weights[:, 1].sum(), abs=1e-12)
    assert planck(WAVELENGTHS, 3200.0) * 1e9 == pytest.approx(
        colour.colorimetry.planck_law(WAVELENGTHS * 1e-9, 3200.0), rel=3e-4
    )  # its second constant has five digits
    theirs = colour.sd_CIE_illuminant_D_series(colour.temperature.CCT_to_xy_CIE_D(7000.0))
    assert daylight(7000.0).at(theirs.wavelengths) == pytest.approx(theirs.values, abs=1e-6)


def test_the_colour_checker_is_the_oracles() -> None:
    """Each patch's chromaticity in C, D50's light, is the one published beside the spectra: within 0.002."""
    table = published("color_checker")
    printed = colour.CCS_COLOURCHECKERS["BabelColor Average"]
    expected = np.array(list(printed.data.values()))
    found = np.array([xyy_from_xyz(xyz_from_reflectance(Spectrum(table.wavelengths, column), "D50")) for column in table.values.T])
    assert found == pytest.approx(expected, abs=2e-3)


def test_correlated_temperatures_are_the_oracles() -> None:
    """Ohno's method, as the oracle has it: within a tenth of a per cent, and Duv within 1e-5."""
    xy = np.column_stack([RANDOM.uniform(0.28, 0.46, 40), np.zeros(40)])
    xy[:, 1] = 2.87 * xy[:, 0] - 3.0 * xy[:, 0] ** 2 - 0.275 + RANDOM.uniform(-0.01, 0.01, 40)
    found = kelvin_from_xy(xy)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected = colour.temperature.uv_to_CCT_Ohno2013(colour.xy_to_UCS_uv(xy))
    assert found.kelvin == pytest.approx(expected[:, 0], rel=1e-3)
    assert found.duv == pytest.approx(expected[:, 1], abs=2e-5)


@pytest.mark.skipif(MODE != "compiled", reason="about the speed of compiled code")
@pytest.mark.parametrize(("source", "target", "theirs"), [
    ("linear_srgb", "linear_acescg", ("Linear Rec.709 (sRGB)", "ACEScg")),
    ("srgb", "acescg", ("sRGB - Texture", "ACEScg")),
    ("linear_srgb", "srgb", ("Linear Rec.709 (sRGB)", "sRGB - Texture")),
])  # fmt: skip
def test_large_pictures_get_the_numbers_of_opencolorio(source: str, target: str, theirs: tuple[str, str]) -> None:
    """A large float32 picture, to 2e-4: its curves are approximate. How fast is told by benchmarks/color.py."""
    ocio = pytest.importorskip("PyOpenColorIO", reason="OpenColorIO, the peer, is not installed")
    config = ocio.Config.CreateFromBuiltinConfig("cg-config-v1.0.0_aces-v1.3_ocio-v2.1")
    processor = config.getProcessor(*theirs).getOptimizedCPUProcessor(ocio.OPTIMIZATION_DEFAULT)
    picture = RANDOM.random((270, 480, 3), dtype=np.float32)
    other = picture.copy()
    processor.apply(ocio.PackedImageDesc(other, 480, 270, 3))
    assert np.abs(convert_color(picture, source, target) - other).max() < 2e-4
