"""PNG, written: rows of differences, deflated (FoCG 3.2; W3C PNG, 3rd edition).

Compressing is what takes the time. Rendered pictures are smooth or empty, so the difference from the row above, deflated as
runs, is small and several times faster than what general encoders try; and it needs nothing but zlib.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

__all__ = ["png_bytes"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_TRUECOLOR, _TRUECOLOR_ALPHA = 2, 6
_FILTER_UP = 2
_PERCEPTUAL = 0


def png_bytes(encoded: NDArray[np.uint8], texts: Mapping[str, str] | None = None) -> bytes:
    """Encode a picture.

    Parameters
    ----------
    encoded : (height, width, 4) uint8
        sRGB-encoded colour, straight alpha, row 0 on top. Where all is opaque, no alpha is stored.
    texts : dict of str to str, optional
        Keywords (1 to 79 Latin-1 characters) and what they say, for `iTXt` chunks.

    **Source**: W3C, *Portable Network Graphics (PNG) Specification*, 3rd edition, 5 (chunks), 9 (filters), 11.3.3.4 (iTXt).
    """
    opaque = bool((encoded[..., 3] == 255).all())
    samples = np.ascontiguousarray(encoded[..., :3]) if opaque else encoded
    height, width = samples.shape[:2]
    color_type = _TRUECOLOR if opaque else _TRUECOLOR_ALPHA
    parts = [
        _SIGNATURE,
        _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color_type, 0, 0, 0)),
        _chunk(b"sRGB", bytes([_PERCEPTUAL])),
    ]
    for keyword, text in (texts or {}).items():
        parts.append(_chunk(b"iTXt", keyword.encode("latin-1") + b"\0\0\0\0\0" + text.encode("utf-8")))
    parts += [_chunk(b"IDAT", _deflated(samples.reshape(height, -1))), _chunk(b"IEND", b"")]
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
