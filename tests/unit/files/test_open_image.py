"""Opening pictures: exact round trips of every format, cameras held in eight ways, 16 bits against other writers, broken files."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
import pytest
from PIL import Image as Picture

import limner
from limner.color.transfer import linear_from_gamma, linear_from_srgb, srgb_from_linear
from limner.errors import FileFormatError, LimnerError, UnsupportedError
from limner.files.limits import Limits
from limner.image.image import Image

RECIPE = {"model": "Würfel", "seed": 7}


def _picture(height: int = 17, width: int = 23, *, opaque: bool = False, seed: int = 3) -> Image:
    pixels = np.random.default_rng(seed).random((height, width, 4), dtype=np.float32)
    if opaque:
        pixels[..., 3] = 1.0
    return Image(pixels, recipe=RECIPE)


@pytest.mark.parametrize("opaque", [False, True])
def test_png_of_16_bits_comes_back_to_the_quantum(tmp_path: Path, opaque: bool) -> None:
    """Half a step of 65535 of what is encoded, alpha too; a second trip changes nothing at all."""
    image = _picture(opaque=opaque)
    image.save(tmp_path / "a.png", bits=16)
    read = limner.open_image(tmp_path / "a.png")
    error = np.abs(srgb_from_linear(read.pixels[..., :3]) - srgb_from_linear(image.pixels[..., :3])).max()
    assert error <= 0.5 / 65535 + 1e-7
    assert np.abs(read.pixels[..., 3] - image.pixels[..., 3]).max() <= 0.5 / 65535 + 1e-7
    assert {key: read.recipe[key] for key in RECIPE} == RECIPE
    read.save(tmp_path / "b.png", bits=16)
    assert (limner.open_image(tmp_path / "b.png").pixels == read.pixels).all()


def test_png_of_8_bits_comes_back_to_the_code(tmp_path: Path) -> None:
    """What a screen got is what is read; Image.open is the same door."""
    image = _picture()
    image.save(tmp_path / "a.png")
    assert (Image.open(tmp_path / "a.png").to_uint8() == image.to_uint8()).all()


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_opencv_writes_16_bits_that_we_read(tmp_path: Path, channels: int) -> None:
    """Another encoder's filters (Sub, Average, Paeth …), to the code."""
    smooth = np.add.outer(np.arange(40) * 700, np.arange(61) * 511)[..., None] + np.arange(channels) * 4000
    codes = (smooth + np.random.default_rng(1).integers(0, 900, smooth.shape)).astype(np.uint16)
    assert cv2.imwrite(str(tmp_path / "a.png"), codes[..., 0] if channels == 1 else codes)
    read = limner.open_image(tmp_path / "a.png").pixels
    rgb = codes[..., [0, 0, 0] if channels == 1 else [2, 1, 0]]
    assert (read[..., :3] == linear_from_srgb(np.arange(65536) / 65535.0).astype(np.float32)[rgb]).all()
    alpha = codes[..., 3] / np.float32(65535) if channels == 4 else np.float32(1.0)
    assert (read[..., 3] == alpha).all()


def test_we_write_16_bits_that_opencv_reads(tmp_path: Path) -> None:
    """And the other way round."""
    image = _picture()
    image.save(tmp_path / "a.png", bits=16)
    read = cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED)
    expected = np.floor(srgb_from_linear(image.pixels[..., :3]) * 65535.0 + 0.5)
    assert read.dtype == np.uint16
    assert (read[..., 2::-1] == expected).all()


def _png16(samples: np.ndarray, filters: list[int], *, interlaced: bool = False) -> bytes:
    """An encoder of every filter and of interlacing, straight from the standard: slow, and nothing like the decoder."""

    def filtered(rows: np.ndarray) -> bytes:
        if not rows.size:
            return b""
        unit = rows.shape[2] * 2
        lines = rows.astype(">u2").reshape(len(rows), -1).view(np.uint8).astype(int)
        out = bytearray()
        for y, line in enumerate(lines):
            above = lines[y - 1] if y else np.zeros_like(line)
            kind = filters[y % len(filters)]
            out.append(kind)
            for x, value in enumerate(line.tolist()):
                a, b = (int(line[x - unit]) if x >= unit else 0), int(above[x])
                c = int(above[x - unit]) if x >= unit else 0
                nearest = min((abs(a + b - c - v), order, v) for order, v in enumerate((a, b, c)))[2]
                out.append((value - (0, a, b, (a + b) // 2, nearest)[kind]) % 256)
        return bytes(out)

    height, width, channels = samples.shape
    passes = [(0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)]
    if not interlaced:
        passes = [(0, 0, 1, 1)]
    raw = b"".join(filtered(samples[y::sy, x::sx]) for y, x, sy, sx in passes)
    color_type = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    head = struct.pack(">IIBBBBB", width, height, 16, color_type, 0, 0, int(interlaced))
    body = b"\x89PNG\r\n\x1a\n"
    for kind, data in ((b"IHDR", head), (b"IDAT", zlib.compress(raw)), (b"IEND", b"")):
        body += struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return body


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("filters", [[0], [1], [2], [3], [4], [4, 1, 3, 0, 2]])
def test_every_filter_of_png(tmp_path: Path, channels: int, filters: list[int], interlaced: bool) -> None:
    """All colour types, all filters, interlaced or not, to the code."""
    samples = np.random.default_rng(channels).integers(0, 65536, (9, 11, channels)).astype(np.uint16)
    (tmp_path / "a.png").write_bytes(_png16(samples, filters, interlaced=interlaced))
    read = limner.open_image(tmp_path / "a.png").pixels
    rgb = samples[..., :3] if channels >= 3 else samples[..., [0, 0, 0]]
    assert (np.round(srgb_from_linear(read[..., :3]) * 65535) == rgb).all()
    assert (np.round(read[..., 3] * 65535) == (samples[..., -1] if channels in (2, 4) else 65535)).all()


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["jpg", "png", "webp", "tiff"])
def test_a_camera_may_be_held_in_eight_ways(tmp_path: Path, orientation: int, kind: str) -> None:
    """What Pillow turns upright is what we do; the tag is written by Pillow."""
    blocks = np.random.default_rng(0).integers(0, 256, (3, 2, 3)).astype(np.uint8).repeat(16, 0).repeat(16, 1)
    told = Picture.Exif()
    told[0x0112] = orientation
    Picture.fromarray(blocks).save(tmp_path / f"a.{kind}", exif=told, **({"quality": 95} if kind == "jpg" else {}))
    from PIL import ImageOps

    with Picture.open(tmp_path / f"a.{kind}") as picture:
        expected = np.asarray(ImageOps.exif_transpose(picture).convert("RGB")).astype(int)
    read = limner.open_image(tmp_path / f"a.{kind}").to_uint8()[..., :3].astype(int)
    assert read.shape == expected.shape == ((32, 48, 3) if orientation >= 5 else (48, 32, 3))
    assert np.abs(read - expected).max() == 0


def test_exr_comes_back_to_the_bit(tmp_path: Path) -> None:
    """Opaque light of any size and sign, depth with infinity, ids, vectors, resolution, recipe; layers or parts."""
    rng = np.random.default_rng(5)
    pixels = np.ones((9, 13, 4), dtype=np.float32)
    pixels[..., :3] = rng.normal(size=(9, 13, 3)) * 10.0 ** rng.integers(-30, 30, (9, 13, 1))
    depth = rng.random((9, 13), dtype=np.float32)
    depth[0, 0] = np.inf
    ids = rng.integers(-1, 1 << 24, (9, 13)).astype(np.int32)
    normal, uv = rng.normal(size=(9, 13, 3)).astype(np.float32), rng.random((9, 13, 2), dtype=np.float32)
    aov = {"depth": depth, "instance_id": ids, "normal": normal, "uv": uv, "albedo": normal}
    image = Image(pixels, aov=aov, recipe=RECIPE, dpi=300.0)
    for name, parts in (("layers", False), ("parts", True)):
        image.save(tmp_path / f"{name}.exr", parts=parts)
        read = limner.open_image(tmp_path / f"{name}.exr")
        assert (read.pixels == pixels).all()
        assert set(read.aov) == set(aov)
        for key, values in aov.items():
            assert read.aov[key].dtype == values.dtype
            np.testing.assert_array_equal(read.aov[key], values)
        assert ({key: read.recipe[key] for key in RECIPE}, read.dpi) == (RECIPE, 300.0)
    with OpenEXR.File(str(tmp_path / "parts.exr")) as file:
        assert [part.header["name"] for part in file.parts] == ["picture", *aov]


def test_premultiplied_light_comes_back_but_for_rounding(tmp_path: Path) -> None:
    """Colour times alpha and divided again: within two units in the last place."""
    image = _picture()
    image.save(tmp_path / "a.exr")
    read = limner.open_image(tmp_path / "a.exr").pixels
    assert (read[..., 3] == image.pixels[..., 3]).all()
    np.testing.assert_allclose(read, image.pixels, rtol=2.5e-7)


def test_exr_halves(tmp_path: Path) -> None:
    """Colours to 11 bits, depth still to the bit; what is too bright for a half becomes its greatest."""
    pixels = np.ones((2, 2, 4), dtype=np.float32)
    pixels[..., :3] = [[[0.1, 2.5, 3e4], [1e9, 1e-3, 0.0]], [[1, 2, 3], [4, 5, 6]]]
    depth = np.float32([[0.1, 1 / 3], [1e9, np.inf]])
    Image(pixels, aov={"depth": depth}).save(tmp_path / "a.exr", bits=16)
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        kinds = {name: channel.pixels.dtype for name, channel in file.channels().items()}
    assert kinds == {**dict.fromkeys("RGBA", np.float16), "depth.Z": np.float32}
    read = limner.open_image(tmp_path / "a.exr")
    np.testing.assert_allclose(read.pixels, np.minimum(pixels, 65504.0), rtol=2.0**-11)
    np.testing.assert_array_equal(read.aov["depth"], depth)


@pytest.mark.parametrize("width", [5, 8, 131, 300])
def test_hdr_comes_back_to_the_precision_of_its_mantissas(tmp_path: Path, width: int) -> None:
    """Half a step of the shared exponent's mantissa, from 1e-30 to 1e30; black is black; a second trip changes nothing."""
    rng = np.random.default_rng(width)
    pixels = np.ones((7, width, 4), dtype=np.float32)
    pixels[..., :3] = rng.random((7, width, 3)) * 10.0 ** rng.integers(-30, 30, (7, width, 1))
    pixels[0, 0, :3] = 0.0
    pixels[0, 1, :3] = 1.0 - 2.0**-10  # rounds up into the next exponent
    Image(pixels, recipe=RECIPE).save(tmp_path / "a.hdr")
    read = limner.open_image(tmp_path / "a.hdr")
    greatest = pixels[..., :3].max(axis=2, keepdims=True)
    assert (np.abs(read.pixels[..., :3] - pixels[..., :3]) <= greatest / 256.0 * 1.0001).all()
    assert (read.pixels[0, 0, :3] == 0.0).all()
    assert read.recipe == RECIPE
    read.save(tmp_path / "b.hdr")
    assert (limner.open_image(tmp_path / "b.hdr").pixels == read.pixels).all()


def test_opencv_reads_our_hdr(tmp_path: Path) -> None:
    """The file is Radiance's, not ours alone."""
    image = _picture(width=200, opaque=True)
    image.save(tmp_path / "a.hdr")
    read = cv2.imread(str(tmp_path / "a.hdr"), cv2.IMREAD_UNCHANGED)[..., ::-1]
    np.testing.assert_allclose(read, limner.open_image(tmp_path / "a.hdr").pixels[..., :3], atol=1 / 256)


def test_pfm_comes_back_to_the_bit(tmp_path: Path) -> None:
    """Floats, the right way up."""
    image = _picture(opaque=True)
    image.save(tmp_path / "a.pfm")
    assert (limner.open_image(tmp_path / "a.pfm").pixels == image.pixels).all()


@pytest.mark.parametrize(("kind", "close"), [("png", 0.01), ("jpg", 0.01), ("tiff", 0.01), ("exr", 0.0)])
def test_dots_per_inch_travel(tmp_path: Path, kind: str, close: float) -> None:
    """In and out, by argument and by the picture's own; Pillow reads the same; no number where none was given."""
    image = _picture(opaque=True)
    image.save(tmp_path / f"a.{kind}", dpi=300)
    read = limner.open_image(tmp_path / f"a.{kind}")
    assert read.dpi == pytest.approx(300, abs=close)
    read.save(tmp_path / f"b.{kind}")
    assert limner.open_image(tmp_path / f"b.{kind}").dpi == pytest.approx(300, abs=close)
    if kind != "exr":
        with Picture.open(tmp_path / f"a.{kind}") as picture:
            assert picture.info["dpi"] == pytest.approx((300, 300), abs=0.01)
    image.save(tmp_path / f"c.{kind}")
    assert limner.open_image(tmp_path / f"c.{kind}").dpi is None


@pytest.mark.parametrize("kind", ["png", "exr", "jpg", "webp", "tiff", "hdr"])
def test_the_recipe_travels(tmp_path: Path, kind: str) -> None:
    """In every format that can carry text; how it was saved goes with it where that is unusual."""
    _picture().save(tmp_path / f"a.{kind}")
    assert limner.open_image(tmp_path / f"a.{kind}").recipe == RECIPE
    if kind in ("png", "jpg"):
        _picture().save(tmp_path / f"b.{kind}", dither="random", seed=4)
        assert limner.open_image(tmp_path / f"b.{kind}").recipe == {**RECIPE, "saved": {"dither": "random", "seed": 4}}


def test_a_png_may_name_a_plain_power(tmp_path: Path) -> None:
    """gAMA 1.0 is linear, gAMA 1/2.2 means sRGB as everywhere; with an sRGB chunk it says nothing."""
    encoded = np.full((2, 2, 3), 128, dtype=np.uint8)
    stream = io.BytesIO()
    Picture.fromarray(encoded).save(stream, "PNG")
    plain = stream.getvalue()

    def with_gamma(stored: int) -> float:
        body = b"gAMA" + struct.pack(">I", stored)
        chunk = struct.pack(">I", 4) + body + struct.pack(">I", zlib.crc32(body))
        (tmp_path / "a.png").write_bytes(plain[:33] + chunk + plain[33:])
        return float(limner.open_image(tmp_path / "a.png").pixels[0, 0, 0])

    assert with_gamma(100000) == pytest.approx(128 / 255)
    assert with_gamma(50000) == pytest.approx(linear_from_gamma(128 / 255, 2.0))
    assert with_gamma(45455) == pytest.approx(linear_from_srgb(128 / 255))


def test_grey_of_16_bits_in_a_tiff(tmp_path: Path) -> None:
    """Scanners write it; nothing is cut down to 8 bits."""
    codes = np.arange(12, dtype=np.uint16).reshape(3, 4) * 5000
    Picture.fromarray(codes).save(tmp_path / "a.tiff")
    read = limner.open_image(tmp_path / "a.tiff").pixels
    assert (np.round(srgb_from_linear(read[..., 1]) * 65535) == codes).all()


def test_one_bit(tmp_path: Path) -> None:
    """Black and white in a PNG of one bit, its luminance kept by the dither."""
    pixels = np.ones((64, 61, 4), dtype=np.float32)
    pixels[..., :3] = 0.25
    Image(pixels).save(tmp_path / "a.png", bits=1, dither="floyd_steinberg")
    with Picture.open(tmp_path / "a.png") as picture:
        assert picture.mode == "1"
    read = limner.open_image(tmp_path / "a.png").pixels
    assert set(np.unique(read)) == {0.0, 1.0}
    assert read[..., 1].mean() == pytest.approx(0.25, abs=0.01)


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("a.jpg", {"bits": 16}, "JPEG holds 8 bits"),
        ("a.png", {"bits": 32}, "PNG holds 8 or 16 or 1 bits"),
        ("a.exr", {"dither": "random"}, "nothing to dither"),
        ("a.png", {"dither": "stars"}, "dither must be one of ordered"),
        ("a.webp", {"dpi": 300}, "WebP has no place"),
        ("a.png", {"parts": True}, "PNG has no parts"),
    ],
)
def test_what_a_format_cannot_hold_is_refused(tmp_path: Path, name: str, options: dict, words: str) -> None:
    """With what can, and nothing is written."""
    with pytest.raises(UnsupportedError, match=words):
        _picture().save(tmp_path / name, **options)
    assert not list(tmp_path.iterdir())


def test_broken_files_are_told_in_one_line(tmp_path: Path) -> None:
    """Every prefix of a deep PNG, and no picture at all: an error of ours, with the file's name."""
    whole = _png16(np.random.default_rng(2).integers(0, 65536, (5, 4, 3)).astype(np.uint16), [4])
    target = tmp_path / "a.png"
    for length in range(len(whole)):
        target.write_bytes(whole[:length])
        with pytest.raises(LimnerError) as raised:
            limner.open_image(target)
        assert "a.png" in str(raised.value)
        assert "\n" not in str(raised.value)
    target.write_bytes(b"plain text that goes on for a while")
    with pytest.raises(UnsupportedError, match="is no picture that is read"):
        limner.open_image(target)
    with pytest.raises(LimnerError, match="missing"):
        limner.open_image(tmp_path / "missing.png")


def test_a_damaged_checksum_is_seen(tmp_path: Path) -> None:
    """One bit in the pixels of a deep PNG."""
    whole = bytearray(_png16(np.zeros((5, 4, 3), np.uint16), [0]))
    whole[50] ^= 4
    (tmp_path / "a.png").write_bytes(bytes(whole))
    with pytest.raises(FileFormatError, match=r"broken|checksum"):
        limner.open_image(tmp_path / "a.png")


@pytest.mark.parametrize("kind", ["png", "exr", "jpg", "pfm"])
def test_limits_hold(tmp_path: Path, kind: str) -> None:
    """A picture that is too large is refused before it is decoded."""
    _picture().save(tmp_path / f"a.{kind}", **({"bits": 16} if kind == "png" else {}))
    with pytest.raises(FileFormatError, match="max_texture_pixels"):
        limner.open_image(tmp_path / f"a.{kind}", limits=Limits(max_texture_pixels=100))
