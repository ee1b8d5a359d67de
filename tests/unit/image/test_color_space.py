"""Pictures in other colour spaces: the file says which, and who reads it by that sees the same light."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import pytest

from limner.color.convert import convert_color
from limner.color.profile import icc_profile
from limner.color.spaces import SPACES
from limner.errors import UnsupportedError
from limner.image.image import Image


def _picture() -> Image:
    pixels = np.ones((6, 5, 4), dtype=np.float32)
    pixels[..., :3] = np.random.default_rng(5).uniform(0.05, 0.9, (6, 5, 3))
    return Image(pixels)


@pytest.mark.parametrize("extension", ["png", "jpg", "webp", "tiff"])
def test_files_for_screens_hold_the_numbers_and_the_profile(tmp_path: Path, extension: str) -> None:
    """Display P3: the profile is the space's, and the codes are those of the conversion (a JPEG's nearly)."""
    pillow = pytest.importorskip("PIL.Image")
    image, path = _picture(), tmp_path / f"picture.{extension}"
    image.save(path, color_space="display_p3")
    with pillow.open(path) as opened:
        assert opened.info["icc_profile"] == icc_profile("display_p3")
        codes = np.asarray(opened.convert("RGB"), dtype=np.float64)
    expected = 255.0 * convert_color(image.pixels[..., :3], "linear_srgb", "display_p3")
    assert np.abs(codes - expected).max() < (25.0 if extension == "jpg" else 0.51)


def test_viewers_that_heed_profiles_see_what_srgb_shows(tmp_path: Path) -> None:
    """LittleCMS converts a picture in Rec. 2020 back to the codes that the same picture has in sRGB, within a code or two."""
    pillow, cms = pytest.importorskip("PIL.Image"), pytest.importorskip("PIL.ImageCms")
    _picture().save(tmp_path / "wide.png", color_space="rec2020")
    _picture().save(tmp_path / "usual.png")
    with pillow.open(tmp_path / "wide.png") as wide, pillow.open(tmp_path / "usual.png") as usual:
        profile = cms.ImageCmsProfile(io.BytesIO(wide.info["icc_profile"]))
        seen = cms.profileToProfile(wide, profile, cms.createProfile("sRGB"), renderingIntent=cms.Intent.RELATIVE_COLORIMETRIC)
        assert np.abs(np.asarray(seen, dtype=int) - np.asarray(usual, dtype=int)).max() <= 3
        assert "icc_profile" not in usual.info


def test_a_png_says_pq_by_its_code(tmp_path: Path) -> None:
    """No profile holds PQ; the chunk cICP says 9, 16, RGB, full range. 16 bits come back to the light."""
    image, path = _picture(), tmp_path / "bright.png"
    image.save(path, color_space="rec2100_pq", bits=16)
    data = path.read_bytes()
    place = data.index(b"cICP")
    assert struct.unpack(">I", data[place - 4 : place]) == (4,)
    assert data[place + 4 : place + 8] == bytes([9, 16, 0, 1])
    assert b"iCCP" not in data
    assert b"sRGB" not in data


@pytest.mark.parametrize("name", ["srgb", "acescg", "rec2020"])
def test_an_exr_says_its_lamps_and_holds_their_light(tmp_path: Path, name: str) -> None:
    """Chromaticities in the header; pixels times the matrix that they say are the XYZ that they were."""
    exr = pytest.importorskip("OpenEXR")
    image, path = _picture(), tmp_path / "light.exr"
    image.save(path, color_space=name)
    with exr.File(str(path)) as file:
        said, stored = file.header()["chromaticities"], file.channels()["RGBA"].pixels.copy()
    found = SPACES[name]
    assert said == pytest.approx((*found.red, *found.green, *found.blue, *found.white))
    assert convert_color(stored[..., :3], f"linear_{name}", "linear_srgb") == pytest.approx(image.pixels[..., :3], abs=1e-5)


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("a.png", {"color_space": "p3"}, "display_p3.*got 'p3'"), ("a.hdr", {"color_space": "rec2020"}, "cannot say its colour space"),
        ("a.jpg", {"color_space": "rec2100_pq"}, "no ICC profile"), ("a.png", {"color_space": "rec2020", "bits": 1}, "needs colours"),
        ("a.png", {"color_space": "rec2020", "view": "none"}, "needs colours"),
    ],
)  # fmt: skip
def test_what_a_file_cannot_say_is_refused(tmp_path: Path, name: str, options: dict[str, object], said: str) -> None:
    """Before anything is written."""
    with pytest.raises(UnsupportedError, match=said):
        _picture().save(tmp_path / name, **options)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "space", "bits", "error"),
    [
        ("a.png", "display_p3", 16, 2e-4), ("a.png", "prophoto", 16, 2e-4), ("a.png", "rec2100_pq", 16, 5e-4),
        ("a.png", "rec2100_hlg", 16, 5e-4),
        ("a.tiff", "adobe_rgb", 8, 0.012), ("a.webp", "rec2020", 8, 0.012), ("a.exr", "acescg", 32, 2e-6),
    ],
)  # fmt: skip
def test_what_is_saved_in_another_space_is_opened_as_it_was(tmp_path: Path, name: str, space: str, bits: int, error: float) -> None:
    """There and back through the file: its profile, code or chromaticities are read again, up to the rounding of its numbers."""
    image = _picture()
    image.save(tmp_path / name, color_space=space, bits=bits)
    assert Image.open(tmp_path / name).pixels == pytest.approx(image.pixels, abs=error)


def test_profiles_of_others_are_read(tmp_path: Path) -> None:
    """LittleCMS's sRGB is sRGB, to the bit; broken, cut and foreign profiles are passed over."""
    pillow, cms = pytest.importorskip("PIL.Image"), pytest.importorskip("PIL.ImageCms")
    codes = np.random.default_rng(6).integers(0, 256, (4, 4, 3), dtype=np.uint8)
    expected = None
    srgb = cms.ImageCmsProfile(cms.createProfile("sRGB")).tobytes()
    lab = cms.ImageCmsProfile(cms.createProfile("LAB")).tobytes()
    for profile in (None, srgb, lab, b"", srgb[:200], icc_profile("display_p3")[:300], bytes(300)):
        pillow.fromarray(codes).save(tmp_path / "picture.png", icc_profile=profile)
        found = Image.open(tmp_path / "picture.png").pixels
        expected = found if expected is None else expected
        assert np.array_equal(found, expected)
