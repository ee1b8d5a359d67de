"""Pictures become texels: right way up, whatever the encoding, within the limits."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from limner.errors import FileFormatError
from limner.files.limits import Limits
from limner.files.pictures import PictureError, Pictures, picture_format, read_picture

LIMITS = Limits()


def encoded(picture: Image.Image, kind: str, **options: object) -> bytes:
    """Return a picture as a file."""
    stream = io.BytesIO()
    picture.save(stream, kind, **options)
    return stream.getvalue()


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA", "I;16"])
def test_every_mode_of_png(mode: str) -> None:
    """Grey, palette, colour, alpha, sixteen bits: RGBA with the same look, the file's top row last."""
    grey = np.array([[0, 255], [255, 255]], dtype=np.uint8)
    if mode == "I;16":
        picture = Image.fromarray(grey.astype(np.uint16) * 257)
    else:
        picture = Image.fromarray(grey).convert("RGB").convert(mode)
    pixels = read_picture(encoded(picture, "PNG"), LIMITS)
    np.testing.assert_array_equal(pixels[..., :3], np.repeat(grey[::-1, :, None], 3, axis=2))
    assert (pixels[..., 3] == 255).all()


def test_sixteen_bits_are_scaled_not_clipped() -> None:
    """The middle of sixteen bits is the middle of eight."""
    picture = Image.fromarray(np.array([[0, 32768, 65535]], dtype=np.uint16))
    assert read_picture(encoded(picture, "PNG"), LIMITS)[0, :, 0].tolist() == [0, 128, 255]


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "GIF", "BMP", "TGA", "TIFF"])
def test_formats(kind: str) -> None:
    """Each format that is read is told by its first bytes and decoded."""
    picture = Image.new("RGB", (5, 3), (200, 200, 200))
    data = encoded(picture, kind)
    assert picture_format(data) == kind
    assert np.abs(read_picture(data, LIMITS)[..., :3].astype(int) - 200).max() <= 3


def test_cmyk_jpeg() -> None:
    """JPEG for print becomes RGB."""
    data = encoded(Image.new("CMYK", (2, 2), (0, 0, 0, 0)), "JPEG")
    assert read_picture(data, LIMITS).min() >= 250


@pytest.mark.parametrize("data", [b"", b"\x89PNG", b"\xab" + b"KTX 20\xbb\r\n\x1a\n", b"%!PS-Adobe-3.0 EPSF-3.0", b"BM" + b"\0" * 60])
def test_what_is_no_picture(data: bytes) -> None:
    """Foreign and broken bytes are one clear error; strange formats are not even tried."""
    with pytest.raises(PictureError):
        read_picture(data, LIMITS)


def test_every_truncation_is_an_error() -> None:
    """A picture cut off anywhere is refused or decoded, never anything else."""
    noise = Image.fromarray(np.random.default_rng(1).integers(0, 256, (16, 16, 3), dtype=np.uint8))
    for kind in ("PNG", "JPEG", "WEBP"):
        data = encoded(noise, kind)
        for end in range(0, len(data) - 20, 5):
            with pytest.raises(PictureError):
                read_picture(data[:end], LIMITS)


def test_sizes_are_checked_before_decoding() -> None:
    """A small file of many pixels is refused by its header; the error names the limit."""
    data = encoded(Image.new("L", (3000, 3000)), "PNG")
    assert len(data) < 20_000
    with pytest.raises(PictureError, match="3000 x 3000"):
        read_picture(data, Limits(max_texture_pixels=1_000_000))


def test_each_picture_is_decoded_once() -> None:
    """Two textures of one picture, as colour and as data, share its pixels; errors are kept too."""
    n_reads = 0

    def give() -> bytes:
        nonlocal n_reads
        n_reads += 1
        return encoded(Image.new("RGB", (2, 2)), "PNG")

    def fail() -> bytes:
        nonlocal n_reads
        n_reads += 1
        raise FileFormatError("gone")

    pictures = Pictures(LIMITS)
    pictures.prepare({"a": give, "b": fail})
    color, data = pictures.texels("a", give, srgb=True), pictures.texels("a", give, srgb=False)
    assert np.shares_memory(color.pixels, data.pixels)
    assert pictures.texels("a", give, srgb=True) is color
    for _ in range(2):
        with pytest.raises(FileFormatError, match="gone"):
            pictures.texels("b", fail, srgb=True)
    assert n_reads == 2
