"""Pictures in KTX 2.0 files, as glTF has them by KHR_texture_basisu.

    header, index  ->  the largest level  ->  supercompression undone  ->  blocks decoded  ->  texels

The container is read here, and what it says compared with the limits and with the bytes that are there before a library sees any of it.
What is not compressed is read without any; Zstandard, Basis Universal and the block formats of graphics cards have theirs, which are
imported when a file needs them. Of what a file holds only its largest picture is looked at: the smaller ones are made anew.

**Source**: Khronos Group, *KTX File Format Specification*, version 2.0; *Khronos Data Format Specification*, version 1.3, section 5.
"""

from __future__ import annotations

import importlib
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from ..scene.texture import MAX_TEXTURE_SIZE
from .limits import Limits
from .pictures import PictureError

__all__ = ["MAGIC", "Ktx2", "read_header"]

MAGIC = b"\xabKTX 20\xbb\r\n\x1a\n"

_HEADER = struct.Struct("<9I4I2Q")
_LEVEL = struct.Struct("<3Q")
_NONE, _BASIS_LZ, _ZSTANDARD, _ZLIB = 0, 1, 2, 3
_ETC1S, _UASTC = 163, 166  # color models of the data format descriptor
_BRIGHTEST = 65504.0  # the greatest half: what an infinite texel was at least

Pixels = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]


class _Plain(NamedTuple):
    """Texels one after the other: of which type, and which channels; whether red comes last."""

    dtype: str
    channels: int
    swapped: bool = False


class _Blocks(NamedTuple):
    """Blocks of texels: the function that decodes them, how many bytes one has, and how many texels a side."""

    decoder: str
    n_bytes: int
    width: int = 4
    height: int = 4


# By the numbers that Vulkan gives formats.
_PLAIN = {
    **dict.fromkeys((9, 15), _Plain("u1", 1)), **dict.fromkeys((16, 22), _Plain("u1", 2)), **dict.fromkeys((23, 29), _Plain("u1", 3)),
    **dict.fromkeys((30, 36), _Plain("u1", 3, True)), **dict.fromkeys((37, 43), _Plain("u1", 4)),
    **dict.fromkeys((44, 50), _Plain("u1", 4, True)),
    70: _Plain("<u2", 1), 77: _Plain("<u2", 2), 84: _Plain("<u2", 3), 91: _Plain("<u2", 4),
    76: _Plain("<f2", 1), 83: _Plain("<f2", 2), 90: _Plain("<f2", 3), 97: _Plain("<f2", 4),
    100: _Plain("<f4", 1), 103: _Plain("<f4", 2), 106: _Plain("<f4", 3), 109: _Plain("<f4", 4),
}  # fmt: skip
_ASTC_SIZES = (
    (4, 4), (5, 4), (5, 5), (6, 5), (6, 6), (8, 5), (8, 6), (8, 8), (10, 5), (10, 6), (10, 8), (10, 10), (12, 10), (12, 12),
)  # fmt: skip
_BLOCKS = {
    **dict.fromkeys((131, 132, 133, 134), _Blocks("decode_bc1", 8)), **dict.fromkeys((137, 138), _Blocks("decode_bc3", 16)),
    139: _Blocks("decode_bc4", 8), 141: _Blocks("decode_bc5", 16), **dict.fromkeys((145, 146), _Blocks("decode_bc7", 16)),
    **dict.fromkeys((147, 148), _Blocks("decode_etc2", 8)), **dict.fromkeys((149, 150), _Blocks("decode_etc2a1", 8)),
    **dict.fromkeys((151, 152), _Blocks("decode_etc2a8", 16)), 153: _Blocks("decode_eacr", 8), 155: _Blocks("decode_eacrg", 16),
    **{157 + k: _Blocks("decode_astc", 16, *_ASTC_SIZES[k // 2]) for k in range(2 * len(_ASTC_SIZES))},
}  # fmt: skip
_OPAQUE_WITHOUT_ALPHA = (131, 132)  # BC1 of which the transparent texel is black


@dataclass(frozen=True)
class Ktx2:
    """A file whose header was read.

    Parameters
    ----------
    width, height : int
    decode : callable
        Returns (height, width, 4) uint8, uint16 or float32, straight alpha, row 0 at the *bottom*; raises PictureError.
    """

    width: int
    height: int
    decode: Callable[[], Pixels]


class _Header(NamedTuple):
    format: int
    type_size: int
    width: int
    height: int
    depth: int
    n_layers: int
    n_faces: int
    n_levels: int
    scheme: int
    descriptor: int
    descriptor_length: int
    pairs: int
    pairs_length: int
    shared: int
    shared_length: int


def read_header(data: bytes | memoryview, limits: Limits) -> Ktx2:
    """Read what a file says that it is; nothing is decoded.

    Raises PictureError for what is broken, too large or no plain picture, UnsupportedError for what needs a library that is missing, or is
    not read at all.
    """
    data = bytes(data)
    if not data.startswith(MAGIC) or len(data) < len(MAGIC) + _HEADER.size + _LEVEL.size:
        raise PictureError("is no readable KTX2 picture: its header is cut off")
    header = _Header(*_HEADER.unpack_from(data, len(MAGIC)))
    width, height = header.width, header.height
    if header.depth or header.n_layers > 1 or header.n_faces != 1 or not (width and height):
        shape = f"{width} x {height} x {header.depth}, {header.n_layers} layers, {header.n_faces} faces"
        raise PictureError(f"must be one flat picture in a KTX2 file, got {shape}")
    if width * height > limits.max_texture_pixels or max(width, height) > MAX_TEXTURE_SIZE:
        most = f"{MAX_TEXTURE_SIZE} a side and max_texture_pixels, {limits.max_texture_pixels}, in all"
        raise PictureError(f"has {width} x {height} pixels, more than the limits allow: {most}")
    begin, length, _ = _LEVEL.unpack_from(data, len(MAGIC) + _HEADER.size)
    if begin + length > len(data):
        raise PictureError(f"is no readable KTX2 picture: it is cut off, {begin + length} bytes are needed, there are {len(data)}")
    upside_down = _orientation(data, header)[1:2] == "u"
    make = _decoder(data, header, data[begin : begin + length])
    return Ktx2(width, height, lambda: _upright(make(), upside_down))


def _upright(top_down: Pixels, upside_down: bool) -> Pixels:
    turned = top_down if upside_down else top_down[::-1]
    return np.ascontiguousarray(turned)  # type: ignore[return-value]


def _decoder(data: bytes, header: _Header, level: bytes) -> Callable[[], Pixels]:
    """What makes the picture of its largest level, row 0 as it is in the file."""
    model = data[header.descriptor + 12] if header.descriptor + 12 < len(data) else 0
    if header.scheme == _BASIS_LZ or (header.format == 0 and model in (_ETC1S, _UASTC)):
        library = _library("opengl_basisu", "a KTX2 picture of Basis Universal")
        return lambda: _transcoded(library, data, header)
    plain, blocks = _PLAIN.get(header.format), _BLOCKS.get(header.format)
    if plain is None and blocks is None:
        raise UnsupportedError(f"is a KTX2 picture of Vulkan's format {header.format}, which is not read; `ktx create` makes another")
    restore = _restorer(header.scheme)
    if plain is not None:
        size = header.width * header.height * plain.channels * np.dtype(plain.dtype).itemsize
        return lambda: _from_plain(restore(level, size), header, plain)
    assert blocks is not None
    library = _library("texture2ddecoder", "a KTX2 picture of compressed blocks")
    size = -(-header.width // blocks.width) * -(-header.height // blocks.height) * blocks.n_bytes
    return lambda: _from_blocks(library, restore(level, size), header, blocks)


def _library(name: str, what: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UnsupportedError(f'is {what}; pip install "limner[ktx2]" reads it') from None


def _orientation(data: bytes, header: _Header) -> str:
    """Which way the picture's axes point: "rd", the rule of glTF, where the file does not say."""
    place, end = header.pairs, min(header.pairs + header.pairs_length, len(data))
    while place + 4 <= end:
        length = int.from_bytes(data[place : place + 4], "little")
        key, _, value = data[place + 4 : min(place + 4 + length, end)].partition(b"\0")
        if key == b"KTXorientation":
            return value.rstrip(b"\0").decode("ascii", "replace")
        place += 4 + length + (-length % 4)
    return "rd"


# --- supercompression -----------------------------------------------------------------------------------------------------------


def _restorer(scheme: int) -> Callable[[bytes, int], bytes]:
    """What undoes a supercompression; it returns exactly as many bytes as are expected, or raises PictureError."""
    if scheme == _NONE:
        return lambda level, size: _exactly(level, size)
    if scheme == _ZLIB:
        return lambda level, size: _exactly(_reasoned(lambda: zlib.decompressobj().decompress(level, size)), size)
    if scheme == _ZSTANDARD:
        decompress = _zstandard()
        return lambda level, size: _exactly(_reasoned(lambda: decompress(level, size)), size)
    raise UnsupportedError(f"is a KTX2 picture with supercompression {scheme}, which is not read")


def _zstandard() -> Callable[[bytes, int], bytes]:
    """What decompresses Zstandard up to a number of bytes: Python's own from 3.14 on, else a library."""
    try:
        own = importlib.import_module("compression.zstd")
        return lambda data, size: own.ZstdDecompressor().decompress(data, size)
    except ImportError:
        library = _library("zstandard", "a KTX2 picture compressed with Zstandard")
        return lambda data, size: library.ZstdDecompressor().stream_reader(data).read(size)


def _exactly(data: bytes, size: int) -> bytes:
    if len(data) < size:
        raise PictureError(f"is no readable KTX2 picture: its texels need {size} bytes, there are {len(data)}")
    return data[:size]


def _reasoned(function: Callable[[], Any]) -> Any:
    try:
        return function()
    except Exception as error:  # a decoder on a foreign file may raise anything
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise PictureError(f"is no readable KTX2 picture: {reason}") from None


# --- texels -----------------------------------------------------------------------------------------------------------------------


def _from_plain(data: bytes, header: _Header, plain: _Plain) -> Pixels:
    given = np.frombuffer(data, dtype=plain.dtype).reshape(header.height, header.width, plain.channels)
    if plain.dtype[-2] == "f":
        return _rgba(np.nan_to_num(given.astype(np.float32), nan=0.0, posinf=_BRIGHTEST, neginf=-_BRIGHTEST), 1.0)
    ordered = given[..., [2, 1, 0, 3][: plain.channels]] if plain.swapped else given
    native = ordered.astype(ordered.dtype.newbyteorder("="))
    return _rgba(native, np.iinfo(native.dtype).max)


def _rgba(given: NDArray[Any], white: float) -> Pixels:
    """Four channels: what is missing is 0, and alpha 1, as graphics cards have it."""
    made = np.zeros((*given.shape[:2], 4), dtype=given.dtype)
    made[..., 3] = white
    made[..., : given.shape[2]] = given
    return made


def _from_blocks(library: Any, data: bytes, header: _Header, blocks: _Blocks) -> Pixels:
    size = (blocks.width, blocks.height) if blocks.decoder == "decode_astc" else ()
    decoded = _reasoned(lambda: getattr(library, blocks.decoder)(data, header.width, header.height, *size))
    pixels = np.frombuffer(decoded, dtype=np.uint8).reshape(header.height, header.width, 4)[..., [2, 1, 0, 3]]
    if header.format in _OPAQUE_WITHOUT_ALPHA:
        pixels[..., 3] = 255
    return pixels


def _transcoded(library: Any, data: bytes, header: _Header) -> Pixels:
    pixels = _reasoned(lambda: np.asarray(library.open(data).transcode("rgba8").data))
    if pixels.dtype != np.uint8 or pixels.size != header.width * header.height * 4:
        raise PictureError("is no readable KTX2 picture: it does not have the size that it says")
    return pixels.reshape(header.height, header.width, 4)
