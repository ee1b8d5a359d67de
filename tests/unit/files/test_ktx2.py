"""KTX2 pictures: the container is ours, and is not taken on trust; what libraries decode is tried where they are."""

from __future__ import annotations

import base64
import random
import struct
import sys
import zlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from limner.errors import LimnerError, UnsupportedError
from limner.files.gltf import read
from limner.files.ktx2 import MAGIC, read_header
from limner.files.limits import DEFAULT, Limits
from limner.files.notes import Notes
from limner.files.pictures import PictureError, Pictures, read_texels

# 8 x 8 in four quarters, red green over blue grey, as the encoder of Basis Universal 2.1 writes it.
ETC1S = (
    "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAACwAAACUAAAAJAAAALgAAAAAAAAAiwAAAAAAAABDAQAAAAAAAAIAAAAAAAAAAAAA"
    "AAAAAAAsAAAAAAAAAAIAKACjAQIAAwMAAAgAAAAAAAAAAAA/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuMTAAAAQAAgAtAAAACQAAAC0A"
    "AAAAAAAAAAAAAAAAAAACAAAAAAAAAAAAAAAgwEQAAAAAAADiRAIwAwAAAAAAgKwEYAqAAAAAAAiilQHABAAAAAAAAAJgZgCsqqqqUlVVVQUAwUQAAAAAAADyX40AmAEAAAAA"
    "AEDCCDAhQAAAAAAEkVMKACYAAAAAAAAQQAAQBg=="
)
UASTC = (
    "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAACAAAAaAAAACwAAACUAAAAJAAAAAAAAAAAAAAAAAAAAAAAAAC4AAAAAAAAAC8AAAAAAAAAQAAA"
    "AAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAABAAAAAAAAAAAAB/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuMTAAACi1L/0gQDUBAOD3HwDg"
    "H3oAF+Af4B8CDwDg/x8C4AEZGfnfXGsBBEAHgIAycxcg"
)
QUARTERS = np.repeat(np.repeat([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [200, 200, 200]]], 4, axis=0), 4, axis=1)

RGBA8, RGB8, BGRA8, R8, RGBA16, RG16F, RGBA32F, BC1, BC7, ASTC_8X5 = 37, 29, 50, 9, 91, 83, 109, 133, 145, 167


def ktx2(
    data: bytes, vulkan: int, width: int, height: int, *, scheme: int = 0, orientation: str = "", faces: int = 1, depth: int = 0
) -> bytes:
    """A file with one level, without a data format descriptor, which none of these needs."""
    pair = b"KTXorientation\0" + orientation.encode() + b"\0"
    pairs = struct.pack("<I", len(pair)) + pair + bytes(-len(pair) % 4) if orientation else b""
    start = 12 + 68 + 24
    header = struct.pack("<9I4I2Q", vulkan, 1, width, height, depth, 0, faces, 1, scheme, 0, 0, start if pairs else 0, len(pairs), 0, 0)
    return MAGIC + header + struct.pack("<3Q", start + len(pairs), len(data), len(data)) + pairs + data


def texels(data: bytes, limits: Limits = DEFAULT) -> np.ndarray:
    """What a file shows, row 0 on top."""
    return np.asarray(Pictures(limits).texels(1, lambda: data, srgb=False).pixels)[::-1]


def test_plain_formats() -> None:
    """8 and 16 bits and floats, one to four channels, red first or blue: what is missing is 0, and alpha 1."""
    rng = np.random.default_rng(1)
    eight, deep = rng.integers(0, 256, (3, 5, 4), dtype=np.uint8), rng.integers(0, 65536, (3, 5, 4), dtype=np.uint16)
    floats = rng.normal(size=(3, 5, 4)).astype(np.float32)
    assert (texels(ktx2(eight.tobytes(), RGBA8, 5, 3)) == eight).all()
    assert (texels(ktx2(eight[..., [2, 1, 0, 3]].tobytes(), BGRA8, 5, 3)) == eight).all()
    rgb = texels(ktx2(eight[..., :3].tobytes(), RGB8, 5, 3))
    assert (rgb[..., :3] == eight[..., :3]).all()
    assert (rgb[..., 3] == 255).all()
    red = texels(ktx2(eight[..., :1].tobytes(), R8, 5, 3))
    assert (red[..., 0] == eight[..., 0]).all()
    assert not red[..., 1:3].any()
    assert (texels(ktx2(deep.tobytes(), RGBA16, 5, 3)) == deep).all()
    assert (texels(ktx2(floats.tobytes(), RGBA32F, 5, 3)) == floats).all()
    halves = floats[..., :2].astype(np.float16)
    assert (texels(ktx2(halves.tobytes(), RG16F, 5, 3))[..., :2] == halves.astype(np.float32)).all()


def test_orientation() -> None:
    """A file whose first row is the lowest says so, and comes out the same."""
    rows = np.arange(24, dtype=np.uint8).reshape(3, 2, 4)
    assert (texels(ktx2(rows.tobytes(), RGBA8, 2, 3, orientation="rd")) == rows).all()
    assert (texels(ktx2(rows[::-1].tobytes(), RGBA8, 2, 3, orientation="ru")) == rows).all()


def test_supercompression() -> None:
    """Zlib is undone, and no further than the picture is large; an unknown scheme is named."""
    rows = np.arange(24, dtype=np.uint8).reshape(3, 2, 4)
    assert (texels(ktx2(zlib.compress(rows.tobytes()), RGBA8, 2, 3, scheme=3)) == rows).all()
    assert (texels(ktx2(zlib.compress(rows.tobytes() + bytes(10**6)), RGBA8, 2, 3, scheme=3)) == rows).all()
    with pytest.raises(PictureError, match="24 bytes, there are 8"):
        texels(ktx2(zlib.compress(rows.tobytes()[:8]), RGBA8, 2, 3, scheme=3))
    with pytest.raises(UnsupportedError, match="supercompression 9"):
        texels(ktx2(rows.tobytes(), RGBA8, 2, 3, scheme=9))


def test_zstandard() -> None:
    """Zstandard is undone, by Python itself or by a library."""
    name = "compression.zstd" if sys.version_info >= (3, 14) else "zstandard"
    zstd: Any = pytest.importorskip(name, reason="needs zstandard, of the extra ktx2")
    rows = np.arange(24, dtype=np.uint8).reshape(3, 2, 4)
    assert (texels(ktx2(zstd.compress(rows.tobytes()), RGBA8, 2, 3, scheme=2)) == rows).all()
    with pytest.raises(PictureError):
        texels(ktx2(b"no zstd", RGBA8, 2, 3, scheme=2))


@pytest.mark.parametrize(
    ("vulkan", "size", "name", "arguments"),
    [(BC1, 2 * 8, "decode_bc1", ()), (BC7, 2 * 16, "decode_bc7", ()), (ASTC_8X5, 16, "decode_astc", (8, 5))],
)
def test_blocks(vulkan: int, size: int, name: str, arguments: tuple[int, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks go to their decoder, exactly as many as the picture has, and come back from blue first to red first."""
    calls: list[tuple[Any, ...]] = []

    def decoder(data: bytes, width: int, height: int, *blocks: int) -> bytes:
        calls.append((len(data), width, height, *blocks))
        return bytes([3, 2, 1, 255]) * (width * height)

    monkeypatch.setitem(sys.modules, "texture2ddecoder", SimpleNamespace(**{name: decoder}))
    assert (texels(ktx2(bytes(size + 5), vulkan, 7, 3)) == (1, 2, 3, 255)).all()
    assert calls == [(size, 7, 3, *arguments)]
    # The library reads beyond what it is given.
    with pytest.raises(PictureError, match="there are"):
        texels(ktx2(bytes(size - 1), vulkan, 7, 3))
    assert len(calls) == 1


def test_real_blocks() -> None:
    """A red block is red."""
    pytest.importorskip("texture2ddecoder", reason="needs texture2ddecoder, of the extra ktx2")
    assert (texels(ktx2(struct.pack("<HHI", 0xF800, 0x001F, 0), BC1, 3, 2)) == (255, 0, 0, 255)).all()


@pytest.mark.parametrize("text", [ETC1S, UASTC])
def test_basis_universal(text: str) -> None:
    """Both codecs of glTF come out upright and in their colours; broken files are errors and nothing worse."""
    pytest.importorskip("opengl_basisu", reason="needs opengl_basisu, of the extra ktx2")
    sound = base64.b64decode(text)
    found = texels(sound)
    assert np.abs(found[..., :3].astype(int) - QUARTERS).max() <= 4
    assert (found[..., 3] == 255).all()
    rng = random.Random(4)
    for _ in range(100):
        changed = bytearray(sound)
        changed[rng.randrange(len(changed))] = rng.randrange(256)
        try:
            texels(bytes(changed))
        except LimnerError:
            continue


@pytest.mark.parametrize(
    ("data", "name"),
    [
        (base64.b64decode(ETC1S), "opengl_basisu"), (base64.b64decode(UASTC), "opengl_basisu"),
        (ktx2(bytes(16), BC7, 4, 4), "texture2ddecoder"), (ktx2(bytes(16), RGBA8, 2, 2, scheme=2), "zstandard"),
    ],
)  # fmt: skip
def test_without_the_library(data: bytes, name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    """The message says what the file is, and what to install."""
    monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, "compression.zstd", None)
    (tmp_path / "picture.ktx2").write_bytes(data)
    with pytest.raises(UnsupportedError, match=r'KTX2 picture.*pip install "limner\[ktx2\]"'):
        read_texels(tmp_path / "picture.ktx2")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (MAGIC, "cut off"), (ktx2(bytes(16), RGBA8, 2, 2)[:-1], "cut off"), (ktx2(b"", RGBA8, 0, 2), "flat picture"),
        (ktx2(bytes(16), RGBA8, 2, 2, faces=6), "6 faces"), (ktx2(bytes(16), RGBA8, 2, 2, depth=2), "x 2, 0 layers"),
        (ktx2(bytes(16), RGBA8, 20000, 1), "more than the limits"), (ktx2(bytes(15), RGBA8, 2, 2), "needs? 16 bytes"),
        (ktx2(bytes(16), 1000, 2, 2), "format 1000"), (b"\xabKTX 11\xbb\r\n\x1a\n" + bytes(60), "KTX 1 is not read"),
    ],
)  # fmt: skip
def test_broken_files(data: bytes, message: str) -> None:
    """What is broken, too large or no plain picture is refused in a line."""
    with pytest.raises(LimnerError, match=message):
        texels(data)


def test_header_alone() -> None:
    """Reading the header decodes nothing, and the limits are asked before."""
    found = read_header(ktx2(b"x", RGBA8, 2, 2), DEFAULT)
    assert (found.width, found.height) == (2, 2)
    with pytest.raises(PictureError, match="max_texture_pixels"):
        read_header(ktx2(bytes(16), RGBA8, 2, 2), Limits(max_texture_pixels=3))


def test_noise_is_no_picture() -> None:
    """Changed bytes give a picture or an error, never anything else."""
    sound = ktx2(zlib.compress(bytes(range(64))), RGBA8, 4, 4, scheme=3, orientation="rd")
    rng = random.Random(9)
    for _ in range(500):
        changed = bytearray(sound)
        for _ in range(rng.randint(1, 4)):
            changed[rng.randrange(12, len(changed))] = rng.randrange(256)
        try:
            assert texels(bytes(changed)).shape[2] == 4
        except LimnerError:
            continue


@pytest.mark.parametrize("fallback", [True, False])
def test_texture_of_a_model(triangle: Any, fallback: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """KHR_texture_basisu is read; where its library is missing, the picture that stands in for it, or the surface does without."""
    rows = np.arange(64, dtype=np.uint8).reshape(4, 4, 4)
    document = triangle.document
    triangle.picture(np.full((1, 1, 3), 7))
    document["images"].append({"bufferView": triangle.view(ktx2(rows.tobytes(), 43, 4, 4)), "mimeType": "image/ktx2"})
    document["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 1}}} | ({"source": 0} if fallback else {})]
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    document["meshes"][0]["primitives"][0]["material"] = 0

    def material(notes: Notes) -> Any:
        return read(triangle.glb(), "model.glb", notes=notes).shapes()[0][1].materials[0]

    assert (material(Notes()).base_color_texture.texels.pixels[::-1] == rows).all()
    document["images"][1]["bufferView"] = triangle.view(base64.b64decode(UASTC))
    monkeypatch.setitem(sys.modules, "opengl_basisu", None)
    notes = Notes()
    texture = material(notes).base_color_texture
    assert any('pip install "limner[ktx2]"' in line and "/images/1" in line for line in notes.lines())
    assert (texture.texels.pixels[0, 0, 0] == 7) if fallback else texture is None
