"""Pictures of light: what is read is what was written, whatever the encoding; what is broken is one clear line."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from limner.errors import FileFormatError, LimnerError, LimnerWarning, UnsupportedError
from limner.files.limits import Limits
from limner.files.radiance import read_radiance

OpenEXR = pytest.importorskip("OpenEXR")

ENVIRONMENTS = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "environments"

HEADER = b"#?RADIANCE\n# made by hand\nFORMAT=32-bit_rle_rgbe\n"


def file_of(folder: Path, data: bytes, name: str = "light.hdr") -> Path:
    """Write a file to read."""
    path = folder / name
    path.write_bytes(data)
    return path


def noise(height: int, width: int, seed: int = 0) -> NDArray[np.uint8]:
    """(height, width, 4) RGBE pixels: noise in some places, runs in others, never (1, 1, 1, n)."""
    rng = np.random.default_rng(seed)
    pixels = rng.integers(2, 256, (height, width, 4), dtype=np.uint8)
    pixels[:, width // 3 : width // 2] = (7, 9, 200, 130)
    pixels[:, width // 2 :, 3] = rng.integers(0, 2) * 128
    pixels[..., 3] = np.clip(pixels[..., 3], 0, 250)
    return pixels


def light(pixels: NDArray[np.uint8]) -> NDArray[np.float64]:
    """The definition, pixel by pixel in float64: mantissa times 2^(exponent - 136), black for the exponent 0."""
    exponent = pixels[..., 3:].astype(np.float64)
    return np.where(exponent == 0.0, 0.0, pixels[..., :3] * 2.0 ** (exponent - 136.0))


def separate_runs(pixels: NDArray[np.uint8]) -> bytes:
    """Scan lines as Radiance writes them since 1991."""
    lines = []
    for row in pixels:
        line = bytes((2, 2, len(row) >> 8, len(row) & 255))
        for plane in row.T.tolist():
            k = 0
            while k < len(plane):
                n = 1
                while k + n < len(plane) and n < 127 and plane[k + n] == plane[k]:
                    n += 1
                if n > 2:
                    line += bytes((128 + n, plane[k]))
                else:
                    n = min(len(plane) - k, 3)
                    line += bytes((n, *plane[k : k + n]))
                k += n
        lines.append(line)
    return b"".join(lines)


def repeated_pixels(pixels: NDArray[np.uint8]) -> bytes:
    """Whole pixels with the old runs, counts of more than 255 over two of them."""
    out, flat, k = b"", pixels.reshape(-1, 4).tolist(), 0
    while k < len(flat):
        n = 0
        while k + 1 + n < len(flat) and flat[k + 1 + n] == flat[k]:
            n += 1
        out += bytes(flat[k])
        k += 1 + n
        while n:
            out += bytes((1, 1, 1, n & 255))
            n >>= 8
    return out


@pytest.mark.parametrize("encode", [separate_runs, repeated_pixels, lambda pixels: pixels.tobytes()])
@pytest.mark.parametrize("size", [(5, 8), (3, 300), (2, 9), (1, 17), (4, 1000)])
def test_each_encoding_of_scan_lines(tmp_path: Path, size: tuple[int, int], encode: object) -> None:
    """Separate runs, old runs and flat pixels hold the same light, exactly."""
    pixels = noise(*size)
    data = HEADER + b"\n-Y %d +X %d\n" % size + encode(pixels)  # type: ignore[operator]
    found = read_radiance(file_of(tmp_path, data))
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, light(pixels))


@pytest.mark.parametrize("size", [(1, 1), (2, 7), (3, 1)])
def test_narrow_pictures_are_flat(tmp_path: Path, size: tuple[int, int]) -> None:
    """Lines of fewer than eight pixels are never in separate runs, even where they look like it."""
    pixels = noise(*size)
    pixels[0, 0] = (2, 2, 0, size[1])
    found = read_radiance(file_of(tmp_path, HEADER + b"\n-Y %d +X %d\n" % size + pixels.tobytes()))
    np.testing.assert_array_equal(found, light(pixels).astype(np.float32))


def test_old_runs_of_many_bytes(tmp_path: Path) -> None:
    """Runs in a row count 1, 256, 65536 times their number, and begin anew after a pixel."""
    body = bytes((10, 20, 30, 129, 1, 1, 1, 4, 1, 1, 1, 3, 40, 50, 60, 130, 1, 1, 1, 2))
    n = 1 + 4 + 3 * 256 + 1 + 2
    found = read_radiance(file_of(tmp_path, HEADER + b"\n-Y 1 +X %d\n" % n + body))
    assert found[0, : n - 3].tolist() == [[10 / 128, 20 / 128, 30 / 128]] * (n - 3)
    assert found[0, n - 3 :].tolist() == [[40 / 64, 50 / 64, 60 / 64]] * 3


@pytest.mark.parametrize("order", ["-Y +X", "-Y -X", "+Y +X", "+Y -X", "-X +Y", "-X -Y", "+X +Y", "+X -Y"])
def test_orientations(tmp_path: Path, order: str) -> None:
    """The size line says where the first pixel lies and which way lines run; all eight come out upright."""
    upright = noise(9, 11)
    first, second = order.split()
    stored = upright if first[1] == "Y" else upright.transpose(1, 0, 2)
    along_y, along_x = (0, 1) if first[1] == "Y" else (1, 0)
    if "+Y" in order:
        stored = np.flip(stored, along_y)
    if "-X" in order:
        stored = np.flip(stored, along_x)
    size = f"{first} {stored.shape[0]} {second} {stored.shape[1]}".encode()
    found = read_radiance(file_of(tmp_path, HEADER + b"\n" + size + b"\n" + separate_runs(stored)))
    np.testing.assert_array_equal(found, light(upright))


def test_exposure_is_divided_out(tmp_path: Path) -> None:
    """EXPOSURE and COLORCORR, however often they stand there, were multiplied; the light comes back as it was."""
    header = HEADER + b"EXPOSURE=2\nEXPOSURE= 4.0\nCOLORCORR=1 2 .5\nSOFTWARE=x\nVIEW= -vp 0 0 0\n\n-Y 1 +X 1\n"
    assert read_radiance(file_of(tmp_path, header + bytes((128, 128, 128, 129)))).tolist() == [[[1 / 8, 1 / 16, 1 / 4]]]


@pytest.mark.parametrize(
    ("primaries", "warns"),
    [(b"0 0 0 0 0 0 0 0", False), (b".64 .33 .29 .6 .15 .06 .333 .333", False), (b"1 0 0 1 0 0 .33 .33", True), (b"x", True)],
)
def test_primaries(tmp_path: Path, primaries: bytes, warns: bool) -> None:
    """Primaries near those of Rec. 709, or none, pass in silence; others are said."""
    path = file_of(tmp_path, HEADER + b"PRIMARIES=" + primaries + b"\n\n-Y 1 +X 1\n" + bytes((1, 2, 3, 136)))
    if warns:
        with pytest.warns(LimnerWarning, match=r"light\.hdr: the primaries"):
            read_radiance(path)
    else:
        assert read_radiance(path).tolist() == [[[1.0, 2.0, 3.0]]]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "the file is empty"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe", "byte 11: the header has no end"),
        (b"#?RADIANCE\n" + b"x=1\n" * 40000, "the header has no end"),
        (HEADER.replace(b"rgbe", b"rgbx") + b"\n-Y 1 +X 1\n", "byte 26: FORMAT must be 32-bit_rle_rgbe, got '32-bit_rle_rgbx'"),
        (HEADER + b"EXPOSURE=0\n\n-Y 1 +X 1\n", "EXPOSURE and COLORCORR must be positive numbers, got '0'"),
        (HEADER + b"\n512 1024\n", "expected the size, as in -Y 512 [+]X 1024, got '512 1024'"),
        (HEADER + b"\n-Y 1 +Y 1\n", "expected the size"),
        (HEADER + b"\n-Y 0 +X 5\n", "has 5 x 0 pixels"),
        (HEADER + b"\n-Y 999999 +X 999999\n", "has 999999 x 999999 pixels, more than the limits allow"),
        (HEADER + b"\n-Y 20000 +X 3000\n\2\2\x0b\xb8", "byte [0-9]+: is cut off: too short"),
        (HEADER + b"\n-Y 2 +X 8\n" + b"\2\2\0\x08" + b"\x88\0" * 4 + b"\2\2\0\x09" + b"\x88\0" * 4, "line 1 does not begin as one of 8"),
        (HEADER + b"\n-Y 1 +X 8\n" + b"\2\2\0\x08" + b"\x89\0" * 4, "scan line 0 has a run beyond its end"),
        (HEADER + b"\n-Y 1 +X 8\n" + b"\2\2\0\x08" + b"\0\0" * 4, "scan line 0 has a run that is empty"),
        (HEADER + b"\n-Y 2 +X 2\n" + b"\5\5\5\5" * 3, "is cut off in scan line 1"),
        (HEADER + b"\n-Y 1 +X 2\n" + b"\1\1\1\2", "repeats a pixel before there is one"),
        (HEADER + b"\n-Y 1 +X 2\n" + b"\5\5\5\5\1\1\1\2", "repeats a pixel beyond the picture's end"),
        (b"PF 2 2 -1.0\n" + b"\0" * 47, "byte 59: is cut off: 2 x 2 pixels take 48 bytes"),
        (b"PF 0 2 -1.0\n", "has 0 x 2 pixels"),
        (b"Pf 2 2 1e-+5\n" + b"\0" * 16, "byte 7: the scale must be a number"),
        (b"\x76\x2f\x31\x01\2\0\0\0", "is no readable EXR picture"),
        (b"\x89PNG\r\n\x1a\n", "is no readable PNG picture"),
    ],
)  # fmt: skip
def test_broken_files(tmp_path: Path, data: bytes, message: str) -> None:
    """One line with the file and, where there is one, the byte."""
    with pytest.raises(FileFormatError, match=message) as caught:
        read_radiance(file_of(tmp_path, data))
    assert "light.hdr" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    """Missing files, folders, other kinds, other channels."""
    for path, message in ((tmp_path / "gone.hdr", "there is no such file"), (tmp_path, "is a folder")):
        with pytest.raises(FileFormatError, match=message):
            read_radiance(path)
    with pytest.raises(UnsupportedError, match="is no picture that is read"):
        read_radiance(file_of(tmp_path, b"hello"))
    with pytest.raises(UnsupportedError, match="ra_xyze"):
        read_radiance(file_of(tmp_path, b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234"))


@pytest.mark.parametrize("encode", [separate_runs, repeated_pixels])
def test_every_truncation_is_an_error(tmp_path: Path, encode: object) -> None:
    """A picture that ends early is refused, wherever it ends."""
    data = HEADER + b"\n-Y 3 +X 40\n" + encode(noise(3, 40))  # type: ignore[operator]
    for end in range(2, len(data)):
        with pytest.raises(FileFormatError):
            read_radiance(file_of(tmp_path, data[:end]))


@given(st.binary(max_size=200), st.integers(0, 4), st.integers(0, 300))
def test_foreign_bytes(tmp_path_factory: pytest.TempPathFactory, tail: bytes, lines: int, length: int) -> None:
    """Whatever follows the header: a picture of the size that was promised, or an error of ours."""
    path = file_of(tmp_path_factory.getbasetemp(), HEADER + b"\n-Y %d +X %d\n" % (lines, length) + tail, "foreign.hdr")
    with contextlib.suppress(LimnerError):
        assert read_radiance(path).shape == (lines, length, 3)


@given(st.data())
def test_damaged_runs(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """One byte that changed on the way: a picture or an error of ours."""
    whole = bytearray(HEADER + b"\n-Y 3 +X 40\n" + separate_runs(noise(3, 40)))
    whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    try:
        found = read_radiance(file_of(tmp_path_factory.getbasetemp(), bytes(whole), "damaged.hdr"))
    except LimnerError:
        return
    assert found.ndim == 3
    assert np.isfinite(found).all()


@pytest.mark.parametrize("kind", ["PF", "Pf"])
@pytest.mark.parametrize("scale", [b"-1.0", b"1", b"-2.5e-3"])
def test_pfm(tmp_path: Path, kind: str, scale: bytes) -> None:
    """From the bottom row, in either order of bytes, in colour or grey; the size of the scale is not heeded."""
    rng = np.random.default_rng(3)
    pixels = rng.random((4, 5, 3 if kind == "PF" else 1), dtype=np.float32) * 1000.0
    body = pixels[::-1].astype("<f4" if scale.startswith(b"-") else ">f4").tobytes()
    found = read_radiance(file_of(tmp_path, kind.encode() + b"\n5 4\n" + scale + b"\n" + body))
    np.testing.assert_array_equal(found, np.broadcast_to(pixels, (4, 5, 3)))


def write_exr(path: Path, channels: dict[str, NDArray[np.generic]]) -> Path:
    """Write an EXR file."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))
    return path


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize(
    "names", ["RGB", "RGBA", "Y", ("beauty.R", "beauty.G", "beauty.B", "depth.Z"), ("R", "G", "B", "a.R", "a.G", "a.B")]
)
def test_exr(tmp_path: Path, dtype: type, names: tuple[str, ...]) -> None:
    """Half or float, colour or luminance, with other channels beside it or in a layer of its own."""
    rng = np.random.default_rng(4)
    pixels = (rng.random((6, 9, len(names))) * 100.0).astype(dtype)
    path = write_exr(tmp_path / "light.exr", {name: np.ascontiguousarray(pixels[..., k]) for k, name in enumerate(names)})
    found = read_radiance(path)
    assert (found.dtype, found.shape) == (np.float32, (6, 9, 3))
    np.testing.assert_array_equal(found, pixels[..., :3] if len(names) > 1 else np.repeat(pixels, 3, axis=2))


def test_exr_that_is_no_picture(tmp_path: Path) -> None:
    """Other channels, too many pixels, a file cut off anywhere."""
    plane = np.random.default_rng(5).random((20, 30), dtype=np.float32)
    with pytest.raises(UnsupportedError, match=r"channels must be R, G, B or Y, got Z"):
        read_radiance(write_exr(tmp_path / "depth.exr", {"Z": plane}))
    path = write_exr(tmp_path / "light.exr", {"Y": plane})
    with pytest.raises(FileFormatError, match="has 30 x 20 pixels, more than the limits allow"):
        read_radiance(path, limits=Limits(max_texture_pixels=100))
    data = path.read_bytes()
    for end in range(8, len(data) - 1, 97):
        with pytest.raises(FileFormatError, match="is no readable EXR picture"):
            read_radiance(file_of(tmp_path, data[:end], "cut.exr"))


def test_pictures_for_screens(tmp_path: Path) -> None:
    """A PNG is decoded from sRGB, row 0 stays on top, alpha is left out."""
    pixels = np.zeros((2, 3, 4), dtype=np.uint8)
    pixels[0, 0] = (255, 188, 0, 0)
    Image.fromarray(pixels).save(tmp_path / "sky.png")
    found = read_radiance(tmp_path / "sky.png")
    np.testing.assert_allclose(found[0, 0], (1.0, 0.5029, 0.0), atol=1e-4)
    assert found.shape == (2, 3, 3)
    assert found[1].max() == 0.0


def test_what_is_no_light_is_repaired(tmp_path: Path) -> None:
    """NaN and negative pixels become black, infinite ones the brightest; each is one warning that says where."""
    pixels = np.array([[[1, 2, 3], [-1, 5, 6]], [[np.nan, 8, 9], [7, np.inf, 1e5]]], dtype="<f4")
    path = file_of(tmp_path, b"PF\n2 2\n-1\n" + pixels[::-1].tobytes(), "odd.pfm")
    with pytest.warns(LimnerWarning) as caught:
        found = read_radiance(path)
    assert found.tolist() == [[[1, 2, 3], [0, 5, 6]], [[0, 8, 9], [7, 1e5, 1e5]]]
    assert [str(warning.message) for warning in caught] == [
        "odd.pfm: 2 pixels are negative or no numbers and were made black, the first at row 0, column 1",
        "odd.pfm: 1 pixels are infinite and were made 100000, the first at row 1, column 1",
    ]


@pytest.mark.parametrize("name", ["chinese_garden_1k", "qwantani_afternoon_puresky_1k"])
def test_environments_from_the_field(name: str) -> None:
    """Real files are read as OpenCV reads them where it is installed."""
    path = ENVIRONMENTS / f"{name}.hdr"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    found = read_radiance(path)
    assert found.shape == (512, 1024, 3)
    if name == "chinese_garden_1k":
        # Its sun, where the notes of the reference pictures have it: u = 0.601, v = 0.331.
        row, column = np.unravel_index(found.max(axis=2).argmax(), (512, 1024))
        assert (found.max(), round((column + 0.5) / 1024, 3), round((row + 0.5) / 512, 3)) == (78848.0, 0.601, 0.331)
    cv2 = pytest.importorskip("cv2")
    np.testing.assert_array_equal(found, cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1])
