"""Colour against what is published: CIE's tables and white points, IEC's and ITU's matrices and curves, Sharma's pairs."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest

import limner.color.published as published_tables
from limner.color.chromaticity import D65_XY, dominant_wavelength, uv_from_xy, xy_from_xyz
from limner.color.difference import color_difference
from limner.color.encodings import decoded, encoded, hlg_from_linear, nits_from_pq, pq_from_nits
from limner.color.illuminants import daylight, daylight_xy, illuminant
from limner.color.observer import OBSERVERS, cone_fundamentals, luminous_efficiency, matching_functions, rgb_matching_primaries
from limner.color.published import published
from limner.color.spaces import SPACES, rgb_from_rgb, space
from limner.color.spectrum import WAVELENGTHS, Spectrum
from limner.color.temperature import kelvin_from_xy, xy_from_kelvin
from limner.color.tristimulus import luminance, white_xyz

CHECKSUMS = {
    "cie_1931_2": "51ecbc8090992737c029e9c4c31a755ddd57d101e4c31869f17c6ccf1562ca93",
    "cie_1964_10": "4f99741e8ab80e87d7ab52d657bfd21014888390d5248c2a752d2f05cfcebd0c",
    "color_checker": "b63942ab2ad5d45ba00b04b90afc7bdd389e9e57d3d56fe841f26dbe3ee7dfc1",
    "cones_2": "41a907ba8825ace1405f73a58d4c31b928754104a753190b9d8f3256f6f8c99d",
    "daylight": "88f803f08c119566d8c2565ed3f4b5ff3b946ba31adbb360aeac29efaddf3db9",
    "illuminant_c": "d4d55baba326f88a25673dd686423e91027050c4f245ee9c5b8c68d82a29f1b4",
    "illuminant_d65": "e9cb33e49e144a2f597fe2a4b8d600497883448bc5a95030c10fae6aec67e7aa",
    "metals": "73fd94464c8129459cf52fc34147eb0c70eecee1140cd3448982b638179c0b46",
    "scotopic": "34cf30a5d2e9fc29e724e0dfd430b1f37fbd44ad60b4f3f623fc9466ccd30303",
}


def test_tables_are_the_published_ones_to_the_digit() -> None:
    """Each table's numbers have the checksum of the day they were copied, and each file names its source on top."""
    folder = Path(published_tables.__file__).parent / "data"
    assert {path.stem for path in folder.glob("*.csv")} == set(CHECKSUMS)
    for name, checksum in CHECKSUMS.items():
        text = (folder / f"{name}.csv").read_text(encoding="utf-8")
        head = [line for line in text.splitlines() if line.startswith("#")]
        assert any("Source:" in line for line in head), name
        body = "".join(f"{line}\n" for line in text.splitlines() if not line.startswith("#"))
        assert hashlib.sha256(body.encode()).hexdigest() == checksum, name


@pytest.mark.parametrize(
    ("observer", "nm", "expected"),
    [
        ("cie_1931_2", 400, (0.01431, 0.000396, 0.06785001)), ("cie_1931_2", 450, (0.3362, 0.038, 1.77211)),
        ("cie_1931_2", 500, (0.0049, 0.323, 0.272)), ("cie_1931_2", 555, (0.5120501, 1.0, 0.005749999)),
        ("cie_1931_2", 600, (1.0622, 0.631, 0.0008)), ("cie_1931_2", 700, (0.01135916, 0.004102, 0.0)),
        ("cie_1964_10", 450, (0.370702, 0.089456, 1.994800)), ("cie_1964_10", 550, (0.529826, 0.991761, 0.003988)),
        ("cie_1964_10", 600, (1.123990, 0.658341, 0.0)),
    ],
)  # fmt: skip
def test_matching_functions_have_the_printed_numbers(observer: str, nm: int, expected: tuple[float, float, float]) -> None:
    """Rows of CIE 018:2019, tables 6 and 7, digit by digit."""
    assert matching_functions(observer)[nm - 360] == pytest.approx(expected, abs=1e-9)


def test_equal_energy_is_nearly_white_for_both_observers() -> None:
    """The sums of the three functions, which the CIE made equal, agree to 4e-4."""
    for observer in OBSERVERS:
        sums = matching_functions(observer).sum(axis=0)
        assert np.ptp(sums) / sums.mean() < 4e-4


@pytest.mark.parametrize(
    ("name", "two", "ten"),
    [
        ("A", (0.44758, 0.40745), (0.45117, 0.40594)), ("C", (0.31006, 0.31616), (0.31039, 0.31905)),
        ("D50", (0.34567, 0.35851), (0.34773, 0.35952)), ("D55", (0.33243, 0.34744), (0.33412, 0.34877)),
        ("D65", (0.31272, 0.32903), (0.31382, 0.33100)), ("D75", (0.29903, 0.31488), (0.29968, 0.31740)),
        ("E", (0.33333, 0.33333), (0.33333, 0.33333)),
    ],
)  # fmt: skip
def test_illuminants_have_the_published_white_points(name: str, two: tuple[float, float], ten: tuple[float, float]) -> None:
    """CIE 015:2018, table T.3, which sums at other steps: within a ten-thousandth."""
    assert xy_from_xyz(white_xyz(name)) == pytest.approx(two, abs=1e-4)
    assert xy_from_xyz(white_xyz(name, "cie_1964_10")) == pytest.approx(ten, abs=1e-4)


def test_daylight_by_its_formula_is_the_printed_d65() -> None:
    """S0 + M1 S1 + M2 S2 at 6504 K gives ISO 11664-2's table, of which each second number was interpolated, to a thousandth of 100."""
    table = published("illuminant_d65")
    assert np.abs(daylight(6500.0 * 1.4388 / 1.4380).at(table.wavelengths) - table.values[:, 0]).max() < 1e-3
    assert daylight_xy(6504.0) == pytest.approx((0.31271, 0.32912), abs=2e-5)
    assert illuminant("A").at([300.0, 380.0, 560.0, 780.0]) == pytest.approx((0.930483, 9.7951, 100.0, 241.675), rel=1e-5)


def test_lamps_of_the_matching_experiment_give_the_matrix_of_1931() -> None:
    """The colours of 700, 546.1 and 435.8 nm, mixed to equal energy: the well-known 0.49, 0.31, 0.20."""
    printed = np.array([[0.49, 0.31, 0.20], [0.17697, 0.81240, 0.01063], [0.0, 0.01, 0.99]])
    assert rgb_matching_primaries() == pytest.approx(printed, abs=2.5e-4)
    assert space("cie_rgb").xyz_from_rgb == pytest.approx(printed, abs=2e-4)


def test_cones_and_efficiencies_have_their_printed_peaks() -> None:
    """Long, middle and short cones at 570, 543 and 442 nm; V at 555, V' at 507; 683 lm/W."""
    assert WAVELENGTHS[cone_fundamentals().argmax(axis=0)].tolist() == [570.0, 543.0, 442.0]
    assert WAVELENGTHS[luminous_efficiency().argmax()] == 555.0
    assert luminous_efficiency("scotopic")[[400 - 360, 507 - 360, 555 - 360]] == pytest.approx((0.00929, 1.0, 0.402), abs=1e-9)
    line = np.zeros(len(WAVELENGTHS))
    line[555 - 360] = 1.0
    assert luminance(line) == pytest.approx(683.002)
    assert luminance(Spectrum([555.0], [1.0])) == pytest.approx(683.002 * 106.856917)


# --- spaces -----------------------------------------------------------------------------------------------------------------

LINDBLOOM = {
    "srgb": [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]],
    "adobe_rgb": [[0.5767309, 0.1855540, 0.1881852], [0.2973769, 0.6273491, 0.0752741], [0.0270343, 0.0706872, 0.9911085]],
}
"""Bruce Lindbloom's page of RGB/XYZ matrices, whose D65 is (0.95047, 1, 1.08883)."""


@pytest.mark.parametrize("name", sorted(LINDBLOOM))
def test_derived_matrices_are_lindblooms_with_his_white(name: str) -> None:
    """From the same lamps and his white the same matrix comes, to seven digits."""
    found = space(name)
    lamps = np.column_stack([found.primaries, 1.0 - found.primaries.sum(axis=1)]).T
    total = 0.95047 + 1.0 + 1.08883
    white = (0.95047 / total, 1.0 / total)
    with_his = type(found)("his", "his", found.red, found.green, found.blue, white, found.transfer)
    assert with_his.xyz_from_rgb == pytest.approx(np.array(LINDBLOOM[name]), abs=6e-7)
    assert lamps.sum(axis=0) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("srgb", [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]),
        ("rec2020", [[0.636958, 0.144617, 0.168881], [0.262700, 0.677998, 0.059302], [0.0, 0.028073, 1.060985]]),
        ("display_p3", [[0.486571, 0.265668, 0.198217], [0.228975, 0.691739, 0.079287], [0.0, 0.045113, 1.043944]]),
        ("adobe_rgb", [[0.57667, 0.18556, 0.18823], [0.29734, 0.62736, 0.07529], [0.02703, 0.07069, 0.99134]]),
        ("acescg", [[0.6624541811, 0.1340042065, 0.1561876870], [0.2722287168, 0.6740817658, 0.0536895174],
                    [-0.0055746495, 0.0040607335, 1.0103391003]]),
        ("aces2065_1", [[0.9525523959, 0.0, 0.0000936786], [0.3439664498, 0.7281660966, -0.0721325464], [0.0, 0.0, 1.0088251844]]),
        ("prophoto", [[0.7976749, 0.1351917, 0.0313534], [0.2880402, 0.7118741, 0.0000857], [0.0, 0.0, 0.8252100]]),
    ],
)  # fmt: skip
def test_derived_matrices_are_the_printed_ones(name: str, expected: list[list[float]]) -> None:
    """IEC 61966-2-1, BT.2020 (as in BT.2087), SMPTE EG 432-1, Adobe RGB 4.3.5.3, the Academy's S-2014-004, Lindbloom's ProPhoto."""
    digits = min(len(f"{abs(part)}".partition(".")[2]) for row in expected for part in row if part not in (0.0, 1.0))
    tolerance = {"prophoto": 2e-4, "adobe_rgb": 1.1e-5}.get(name, 0.51 * 10.0**-digits)
    assert space(name).xyz_from_rgb == pytest.approx(np.array(expected), abs=tolerance)


def test_rec2020_to_rec709_is_bt2087() -> None:
    """ITU-R BT.2087-0, 2.2, four digits; and BT.2407's inverse."""
    printed = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]]
    assert rgb_from_rgb("rec709", "rec2020") == pytest.approx(np.array(printed), abs=6e-5)
    back = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
    assert rgb_from_rgb("rec2020", "srgb") == pytest.approx(np.array(back), abs=6e-5)


def test_aces_from_rec709_is_the_academys() -> None:
    """Bradford from D65 to the white of ACES, after TB-2014-004's worked matrix for AP1."""
    printed = [
        [0.6130974024, 0.3395231462, 0.0473794514],
        [0.0701937225, 0.9163538791, 0.0134523985],
        [0.0206155929, 0.1095697729, 0.8698146342],
    ]
    assert rgb_from_rgb("acescg", "srgb") == pytest.approx(np.array(printed), abs=2e-6)


def test_curves_have_their_printed_numbers() -> None:
    """IEC 61966-2-1; BT.709's joints; BT.2100's PQ code values and HLG at 1/12 and 1; BT.2408's levels."""
    assert encoded([0.0031308, 0.18, 1.0], "srgb") == pytest.approx((0.04045, 0.46136, 1.0), abs=1e-5)
    assert encoded([0.018, 0.5, 1.0], "rec709") == pytest.approx((0.0812, 0.7055, 1.0), abs=3e-4)
    assert decoded(0.0809, "rec709") == pytest.approx(0.0809 / 4.5, abs=1e-12)
    assert pq_from_nits([0.1, 1.0, 100.0, 203.0, 1000.0, 4000.0, 10000.0]) == pytest.approx(
        (0.06234, 0.14995, 0.50808, 0.58069, 0.75183, 0.90257, 1.0), abs=1e-5
    )
    assert nits_from_pq([0.0, 0.508078, 1.0]) == pytest.approx((0.0, 100.0, 10000.0), rel=1e-4)
    assert hlg_from_linear([1.0 / 12.0, 1.0]) == pytest.approx((0.5, 1.0), abs=1e-7)
    assert encoded(1.0, "pq") == pytest.approx(0.58069, abs=1e-5)
    assert encoded(1.0, "hlg") == pytest.approx(0.75)


# --- differences ------------------------------------------------------------------------------------------------------------

SHARMA = """
50 2.6772 -79.7751 50 0 -82.7485 2.0425|50 3.1571 -77.2803 50 0 -82.7485 2.8615|50 2.8361 -74.0200 50 0 -82.7485 3.4412
50 -1.3802 -84.2814 50 0 -82.7485 1.0000|50 -1.1848 -84.8006 50 0 -82.7485 1.0000|50 -0.9009 -85.5211 50 0 -82.7485 1.0000
50 0 0 50 -1 2 2.3669|50 -1 2 50 0 0 2.3669|50 2.4900 -0.0010 50 -2.4900 0.0009 7.1792|50 2.4900 -0.0010 50 -2.4900 0.0010 7.1792
50 2.4900 -0.0010 50 -2.4900 0.0011 7.2195|50 2.4900 -0.0010 50 -2.4900 0.0012 7.2195|50 -0.0010 2.4900 50 0.0009 -2.4900 4.8045
50 -0.0010 2.4900 50 0.0010 -2.4900 4.8045|50 -0.0010 2.4900 50 0.0011 -2.4900 4.7461|50 2.5 0 50 0 -2.5 4.3065
50 2.5 0 73 25 -18 27.1492|50 2.5 0 61 -5 29 22.8977|50 2.5 0 56 -27 -3 31.9030|50 2.5 0 58 24 15 19.4535
50 2.5 0 50 3.1736 0.5854 1.0000|50 2.5 0 50 3.2972 0 1.0000|50 2.5 0 50 1.8634 0.5757 1.0000|50 2.5 0 50 3.2592 0.3350 1.0000
60.2574 -34.0099 36.2677 60.4626 -34.1751 39.4387 1.2644|63.0109 -31.0961 -5.8663 62.8187 -29.7946 -4.0864 1.2630
61.2901 3.7196 -5.3901 61.4292 2.2480 -4.9620 1.8731|35.0831 -44.1164 3.7933 35.0232 -40.0716 1.5901 1.8645
22.7233 20.0904 -46.6940 23.0331 14.9730 -42.5619 2.0373|36.4612 47.8580 18.3852 36.2715 50.5065 21.2231 1.4146
90.8027 -2.0831 1.4410 91.1528 -1.6435 0.0447 1.4441|90.9257 -0.5406 -0.9208 88.6381 -0.8985 -0.7239 1.5381
6.7747 -0.2908 -2.4247 5.8714 -0.0985 -2.2286 0.6377|2.0776 0.0795 -1.1350 0.9033 -0.0636 -0.5514 0.9082
"""
"""Sharma, Wu and Dalal 2005, table 1: the 34 pairs, in order."""


def test_ciede2000_gives_sharmas_pairs() -> None:
    """All 34, to the four printed digits, both ways round."""
    pairs = np.array([[float(word) for word in pair.split()] for line in SHARMA.strip().splitlines() for pair in line.split("|")])
    assert pairs.shape == (34, 7)
    assert color_difference(pairs[:, :3], pairs[:, 3:6]) == pytest.approx(pairs[:, 6], abs=5e-5)
    assert color_difference(pairs[:, 3:6], pairs[:, :3]) == pytest.approx(pairs[:, 6], abs=5e-5)


# --- chromaticity and temperature ---------------------------------------------------------------------------------------------


def test_temperatures_of_illuminants_are_the_known_ones() -> None:
    """A is 2856 K by definition; CIE 015 gives D50 5003, D65 6504, D75 7504 and C 6774 K."""
    found = kelvin_from_xy([xy_from_xyz(white_xyz(name)) for name in ("A", "C", "D50", "D65", "D75")]).kelvin
    assert found == pytest.approx((2856.0, 6774.0, 5001.0, 6504.0, 7506.0), abs=4.0)
    assert xy_from_kelvin(2856.0) == pytest.approx((0.4475, 0.4074), abs=1e-4)
    assert uv_from_xy(D65_XY) == pytest.approx((0.1978, 0.4683), abs=1e-4)


def test_dominant_wavelengths_of_the_lamps_of_srgb() -> None:
    """Red 611.4, green 549.1, blue 464.2 nm under D65, as commonly given; single wavelengths are themselves, wholly pure."""
    found = dominant_wavelength(SPACES["srgb"].primaries)
    assert found.wavelength == pytest.approx((611.4, 549.1, 464.2), abs=0.3)
    lines = np.eye(len(WAVELENGTHS))[[470 - 360, 520 - 360, 600 - 360]]
    pure = dominant_wavelength(xy_from_xyz(lines @ matching_functions()))
    assert pure.wavelength == pytest.approx((470.0, 520.0, 600.0), abs=1e-6)
    assert pure.purity == pytest.approx(1.0)
