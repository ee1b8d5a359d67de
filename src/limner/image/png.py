"""PNG, written: rows of differences, deflated; and read where it has 16 bits (FoCG 3.2; W3C PNG, 3rd edition).

Compressing is what takes the time. Rendered pictures are smooth or empty, so the difference from the row above, deflated as
runs, is small and several times faster than what general encoders try; and it needs nothing but zlib.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError

__all__ = ["decode_deep", "is_deep", "png_bytes"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_GREY, _TRUECOLOR, _GREY_ALPHA, _TRUECOLOR_ALPHA = 0, 2, 4, 6
_CHANNELS = {_GREY: 1, _TRUECOLOR: 3, _GREY_ALPHA: 2, _TRUECOLOR_ALPHA: 4}
_FILTER_UP = 2
_PERCEPTUAL = 0
_RGB, _FULL_RANGE = 0, 1
_METRE = 1
_INCHES_PER_METRE = 1000.0 / 25.4
_ADAM7 = ((0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1))  # y, x, step y, step x


def png_bytes(
    encoded: NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.bool_],
    texts: Mapping[str, str] | None = None,
    dpi: float | None = None,
    *,
    profile: bytes | None = None,
    cicp: tuple[int, int] | None = None,
) -> bytes:
    """Encode a picture.

    Parameters
    ----------
    encoded : (height, width, 4) uint8 or uint16, or (height, width) bool
        sRGB-encoded colour, straight alpha, row 0 on top; 8 or 16 bits. Where all is opaque, no alpha is stored. Booleans are black
        and white, of 1 bit.
    texts : dict of str to str, optional
        Keywords (1 to 79 Latin-1 characters) and what they say, for `iTXt` chunks.
    dpi : float, optional
        Pixels per inch on paper; stored as a whole number per metre.
    profile : bytes, optional
        ICC profile of the colours, where they are not sRGB.
    cicp : (primaries, transfer), optional
        Their code points in ITU-T H.273, likewise.

    **Source**: W3C, *Portable Network Graphics (PNG) Specification*, 3rd edition, 5 (chunks), 9 (filters), 11.3.3.4 (iTXt), 11.3.4.3
    (pHYs), 11.3.2.3 (iCCP), 11.3.2.6 (cICP).
    """
    height, width = encoded.shape[:2]
    rows: NDArray[np.uint8]
    if encoded.dtype == np.bool_:
        rows, bits, color_type = np.packbits(encoded, axis=1), 1, _GREY
    else:
        bits = 8 * encoded.itemsize
        opaque = bool(np.all(encoded[..., 3] == (1 << bits) - 1))
        samples: NDArray[Any] = np.ascontiguousarray(encoded[..., :3] if opaque else encoded)
        color_type = _TRUECOLOR if opaque else _TRUECOLOR_ALPHA
        rows = samples.astype(">u2" if bits == 16 else np.uint8, copy=False).reshape(height, -1).view(np.uint8)
    parts = [
        _SIGNATURE,
        _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, color_type, 0, 0, 0)),
    ]
    if cicp is not None:
        parts.append(_chunk(b"cICP", bytes([*cicp, _RGB, _FULL_RANGE])))
    if profile is not None:
        parts.append(_chunk(b"iCCP", b"ICC profile\0\0" + zlib.compress(profile)))
    if cicp is None and profile is None:
        parts.append(_chunk(b"sRGB", bytes([_PERCEPTUAL])))
    if dpi is not None:
        per_metre = min(max(round(dpi * _INCHES_PER_METRE), 1), (1 << 31) - 1)
        parts.append(_chunk(b"pHYs", struct.pack(">IIB", per_metre, per_metre, _METRE)))
    for keyword, text in (texts or {}).items():
        parts.append(_chunk(b"iTXt", keyword.encode("latin-1") + b"\0\0\0\0\0" + text.encode("utf-8")))
    parts += [_chunk(b"IDAT", _deflated(rows)), _chunk(b"IEND", b"")]
    return b"".join(parts)


def _deflated(rows: NDArray[np.uint8]) -> bytes:
    """Compress rows of bytes, each as its difference from the row above."""
    filtered = np.empty((rows.shape[0], rows.shape[1] + 1), dtype=np.uint8)
    filtered[:, 0] = _FILTER_UP
    filtered[0, 1:] = rows[0]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    deflate = zlib.compressobj(level=1, strategy=zlib.Z_RLE)
    return deflate.compress(filtered.data) + deflate.flush()


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


# --- 16 bits, read ----------------------------------------------------------------------------------------------------------


def is_deep(data: bytes | memoryview) -> bool:
    """Whether these are the first bytes of a PNG of 16 bits, which most readers cut down to 8."""
    head = bytes(data[:33])
    return head.startswith(_SIGNATURE) and head[12:16] == b"IHDR" and head[24:25] == b"\x10"


def decode_deep(data: bytes | memoryview) -> NDArray[np.uint16]:
    """Decode a PNG of 16 bits: grey or colour, with alpha or without, interlaced or not.

    The caller has compared its size with the limits.

    Returns
    -------
    (height, width, 4) uint16
        As encoded; straight alpha, row 0 on top.

    Raises FileFormatError for what is broken or cut off.

    **Source**: W3C, *PNG*, 3rd edition, 7.3 (scanlines), 8 (interlacing), 9 (filters), 11.3.2.1 (tRNS).
    """
    header, compressed, transparent = b"", [], b""
    for kind, body in _chunks(memoryview(data)):
        if kind == b"IHDR":
            header = bytes(body)
        elif kind == b"IDAT":
            compressed.append(body)
        elif kind == b"tRNS":
            transparent = bytes(body)
    if len(header) != 13 or header[9] not in _CHANNELS or header[8] != 16 or header[10:12] != b"\0\0" or header[12] > 1:
        raise FileFormatError("is no readable PNG picture: its header is broken")
    width, height = struct.unpack(">II", header[:8])
    channels = _CHANNELS[header[9]]
    passes = _ADAM7 if header[12] else ((0, 0, 1, 1),)
    sizes = [(max(0, -(-(height - y) // step_y)), max(0, -(-(width - x) // step_x))) for y, x, step_y, step_x in passes]
    total = sum(rows * (1 + columns * channels * 2) for rows, columns in sizes if columns)
    raw = np.frombuffer(_inflated(compressed, total), dtype=np.uint8)
    samples = np.empty((height, width, channels), dtype=np.uint16)
    place = 0
    for (y, x, step_y, step_x), (rows, columns) in zip(passes, sizes, strict=True):
        if rows and columns:
            length = rows * (1 + columns * channels * 2)
            lines = raw[place : place + length].reshape(rows, -1)
            place += length
            plain = _unfiltered(lines, channels * 2)
            samples[y::step_y, x::step_x] = plain.view(">u2").reshape(rows, columns, channels)
    return _as_rgba(samples, transparent)


def _chunks(data: memoryview) -> Iterator[tuple[bytes, memoryview]]:
    place = len(_SIGNATURE)
    while place + 8 <= len(data):
        (length,) = struct.unpack_from(">I", data, place)
        body = data[place + 8 : place + 8 + length]
        kind = bytes(data[place + 4 : place + 8])
        checksum = bytes(data[place + 8 + length : place + 12 + length])
        if len(checksum) < 4:
            raise FileFormatError("is no readable PNG picture: it is cut off", "", f"byte {len(data)}")
        if kind in (b"IHDR", b"IDAT", b"tRNS") and checksum != struct.pack(">I", zlib.crc32(body, zlib.crc32(kind))):
            raise FileFormatError("is no readable PNG picture: a checksum is wrong", "", f"byte {place}")
        yield kind, body
        if kind == b"IEND":
            return
        place += 12 + length
    raise FileFormatError("is no readable PNG picture: it is cut off", "", f"byte {len(data)}")


def _inflated(parts: list[memoryview], total: int) -> bytes:
    """Exactly `total` bytes; what would be more is never unpacked."""
    inflate = zlib.decompressobj()
    try:
        raw = inflate.decompress(b"".join(parts), total)
    except zlib.error as error:
        raise FileFormatError(f"is no readable PNG picture: {error}") from None
    if len(raw) < total:
        raise FileFormatError("is no readable PNG picture: its pixels are cut off")
    return raw


def _unfiltered(lines: NDArray[np.uint8], unit: int) -> NDArray[np.uint8]:
    """Undo the five filters of scanlines (height, 1 + n) uint8 whose pixels are `unit` bytes.

    A byte needs those of the pixels to its left, above, and above left. Pixels of equal row + column do not need each other and are done
    at once: laid out flat, they are a stride of the row's length less one.
    """
    kinds, rows = lines[:, 0], lines[:, 1:]
    if kinds.max() > 4:
        raise FileFormatError(f"is no readable PNG picture: it has no filter {int(kinds.max())}")
    height, width = len(rows), rows.shape[1] // unit
    padded = width + 1
    flat = np.zeros((height + 1, padded, unit), dtype=np.int16)
    flat[1:, 1:] = rows.reshape(height, width, unit)
    if kinds.max() <= _FILTER_UP:
        return _without_left_and_above(flat, kinds)
    flat = flat.reshape(-1, unit)
    step = padded - 1
    for time in range(width + height - 1):
        first, last = max(0, time - width + 1), min(height - 1, time)
        start = (first + 1) * padded + 1 + time - first
        end = start + (last - first) * step + 1
        left, above, corner = (flat[start - offset : end - offset : step] for offset in (1, padded, padded + 1))
        kind = kinds[first : last + 1, None]
        nearest = _paeth(left, above, corner)
        predicted = np.select([kind == 0, kind == 1, kind == 2, kind == 3], [0, left, above, (left + above) >> 1], nearest)
        flat[start:end:step] = (flat[start:end:step] + predicted) & 255
    return np.ascontiguousarray(flat.reshape(height + 1, padded, unit)[1:, 1:].astype(np.uint8)).reshape(height, -1)


def _without_left_and_above(flat: NDArray[np.int16], kinds: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The common case, row by row: no row depends on left and above at once."""
    for row, kind in enumerate(kinds.tolist(), start=1):
        if kind == 1:
            flat[row] = np.cumsum(flat[row], axis=0, dtype=np.int64) & 255
        elif kind == _FILTER_UP:
            flat[row] = (flat[row] + flat[row - 1]) & 255
    return np.ascontiguousarray(flat[1:, 1:].astype(np.uint8)).reshape(len(flat) - 1, -1)


def _paeth(left: NDArray[np.int16], above: NDArray[np.int16], corner: NDArray[np.int16]) -> NDArray[np.int16]:
    """Of the three, the one nearest to left + above - corner; ties go to left, then above."""
    to_left, to_above, to_corner = np.abs(above - corner), np.abs(left - corner), np.abs(left + above - 2 * corner)
    return np.where((to_left <= to_above) & (to_left <= to_corner), left, np.where(to_above <= to_corner, above, corner))


def _as_rgba(samples: NDArray[np.uint16], transparent: bytes) -> NDArray[np.uint16]:
    height, width, channels = samples.shape
    rgba = np.full((height, width, 4), 65535, dtype=np.uint16)
    rgba[..., :3] = samples[..., :3] if channels >= 3 else samples[..., :1]
    if channels in (2, 4):
        rgba[..., 3] = samples[..., -1]
    elif len(transparent) == 2 * channels:
        key = np.frombuffer(transparent, dtype=">u2")
        rgba[..., 3] = np.where((samples == key).all(axis=2), 0, 65535)
    return rgba
