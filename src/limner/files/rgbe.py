"""Radiance pictures (.hdr, .pic): three mantissas that share an exponent, in four bytes a pixel.

A text header, a line that says how long and how many the scan lines are and where they begin, then the scan lines: each of the four
bytes in runs of its own (since 1991), or whole pixels, some of them saying "as often again".

**Source**: Ward, *Real pixels*, Graphics Gems II, 1991; the Radiance file formats, Lawrence Berkeley National Laboratory
(``filefmts.pdf``), "Picture file format". A mantissa m with the exponent e is m 2^(e - 136), as most readers have it; Radiance itself
adds half a step to m.
"""

from __future__ import annotations

import math
import os
import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, UnsupportedError
from .limits import Limits
from .notes import quoted

__all__ = ["MAGIC", "decode"]

MAGIC = b"#?"

_MAX_HEADER = 1 << 16
_RESOLUTION = re.compile(rb"([-+])([XY]) +(\d{1,9}) +([-+])([XY]) +(\d{1,9})\s*")
_SCALE = np.ldexp(np.float32(1.0), np.arange(256) - 136)
_SCALE[0] = 0.0  # by definition: the exponent 0 is black
_REC_709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
_PRIMARIES_SLACK = 0.03  # Radiance's own green and white, and rounding, are taken for Rec. 709


class _Header(NamedTuple):
    gain: NDArray[np.float64]  # (3,): what the pixels were multiplied by
    lines: int
    length: int
    order: tuple[bytes, bytes, bytes, bytes]  # sign and axis from line to line, and along a line
    end: int
    slips: tuple[str, ...]


def decode(data: bytes, path: str | os.PathLike[str], limits: Limits) -> tuple[NDArray[np.float32], tuple[str, ...]]:
    """Decode a Radiance picture.

    Parameters
    ----------
    data : bytes
    path : str or path-like
        For messages.
    limits : Limits
        `max_texture_pixels` of it.

    Returns
    -------
    pixels : (height, width, 3) float32
        Linear radiance, row 0 on top; what EXPOSURE and COLORCORR say was multiplied is divided out again.
    slips : tuple of str
        What was taken for something else.

    Raises FileFormatError, with the byte, where it is none or is cut off.
    """
    header = _read_header(data, path)
    if header.lines * header.length > limits.max_texture_pixels:
        size = f"{header.length} x {header.lines}"
        raise FileFormatError(f"has {size} pixels, more than the limits allow (max_texture_pixels)", path)
    if 8 <= header.length <= 0x7FFF and _begins_line(data, header.end):
        planes = _separate_runs(data, header, path)
    else:
        planes = _whole_pixels(data, header, path)
    pixels = np.empty((header.lines, header.length, 3), dtype=np.float32)
    scale = _SCALE[planes[:, 3]]
    for channel in range(3):
        np.multiply(planes[:, channel], scale, out=pixels[..., channel])
    if (header.gain != 1.0).any():
        with np.errstate(over="ignore"):
            pixels = (pixels / header.gain).astype(np.float32)
    return _upright(pixels, header.order), header.slips


# --- the header -----------------------------------------------------------------------------------------------------------


def _read_header(data: bytes, path: str | os.PathLike[str]) -> _Header:
    gain, slips, place = np.ones(3), [], 0
    while True:
        end = data.find(b"\n", place, _MAX_HEADER)
        if end < 0:
            raise FileFormatError("the header has no end", path, f"byte {place}")
        line = data[place:end].strip()
        if not line and place:
            break
        name, _, value = line.partition(b"=")
        if name == b"FORMAT" and value.strip() == b"32-bit_rle_xyze":
            raise UnsupportedError(f"{os.fspath(path)}: Radiance pictures in XYZ are not read; ra_xyze -r makes them RGB")
        if name == b"FORMAT" and value.strip() != b"32-bit_rle_rgbe":
            raise FileFormatError(f"FORMAT must be 32-bit_rle_rgbe, got {_text(value)}", path, f"byte {place}")
        if name in (b"EXPOSURE", b"COLORCORR"):
            gain *= _factors(value, path, f"byte {place}")
        if name == b"PRIMARIES" and not _is_rec_709(value):
            slips.append("the primaries of the file are taken for those of Rec. 709")
        place = end + 1
    place = end + 1
    end = data.find(b"\n", place, place + 200)
    found = _RESOLUTION.fullmatch(data[place:end]) if end > 0 else None
    if found is None or found[2] == found[5]:
        raise FileFormatError(f"expected the size, as in -Y 512 +X 1024, got {_text(data[place : place + 40])}", path, f"byte {place}")
    lines, length = int(found[3]), int(found[6])
    if not lines or not length:
        raise FileFormatError(f"has {length} x {lines} pixels", path, f"byte {place}")
    return _Header(gain, lines, length, (found[1], found[2], found[4], found[5]), end + 1, tuple(slips))


def _text(value: bytes) -> str:
    return quoted(value.decode("latin-1").strip())


def _factors(value: bytes, path: str | os.PathLike[str], position: str) -> NDArray[np.float64]:
    """One factor, or three: positive."""
    try:
        factors = [float(part) for part in value.split()]
    except ValueError:
        factors = []
    if len(factors) not in (1, 3) or not all(0.0 < factor < math.inf for factor in factors):
        raise FileFormatError(f"EXPOSURE and COLORCORR must be positive numbers, got {_text(value)}", path, position)
    return np.array(factors)


def _is_rec_709(value: bytes) -> bool:
    """Whether primaries are those of Rec. 709 or near, or say nothing."""
    try:
        numbers = [float(part) for part in value.split()]
    except ValueError:
        return False
    near = len(numbers) == 8 and all(abs(a - b) <= _PRIMARIES_SLACK for a, b in zip(numbers, _REC_709, strict=True))
    return near or not any(numbers)


def _upright(pixels: NDArray[np.float32], order: tuple[bytes, bytes, bytes, bytes]) -> NDArray[np.float32]:
    """Scan lines (lines, length, 3) as rows from the top, pixels from the left."""
    if order[1] == b"X":
        pixels, order = pixels.transpose(1, 0, 2), (order[2], order[3], order[0], order[1])
    return np.ascontiguousarray(pixels[:: -1 if order[0] == b"+" else 1, :: -1 if order[2] == b"-" else 1])


# --- the scan lines -------------------------------------------------------------------------------------------------------


def _begins_line(data: bytes, place: int) -> bool:
    """Whether a scan line in separate runs begins here: 2, 2, and its length, which is below 2^15."""
    return data[place : place + 2] == b"\2\2" and data[place + 2 : place + 3] < b"\x80"


def _separate_runs(data: bytes, header: _Header, path: str | os.PathLike[str]) -> NDArray[np.uint8]:
    """(lines, 4, length): scan lines whose four bytes come one after the other, each in runs and literal stretches."""
    length, place = header.length, header.end
    if len(data) - place < header.lines * (4 + 8 * -(-length // 127)):
        raise FileFormatError("is cut off: too short for its size even if it were of one colour", path, f"byte {len(data)}")
    planes = np.empty((header.lines, 4 * length), dtype=np.uint8)
    begin = bytes((2, 2, length >> 8, length & 255))
    for line in range(header.lines):
        if data[place : place + 4] != begin:
            if place + 4 > len(data):
                raise _cut_off(line, data, path)
            raise FileFormatError(f"scan line {line} does not begin as one of {length} pixels", path, f"byte {place}")
        place += 4
        parts: list[bytes] = []
        try:
            for _ in range(4):
                place = _one_plane(data, place, length, parts)
        except IndexError:
            raise _cut_off(line, data, path) from None
        except ValueError as error:
            raise FileFormatError(f"scan line {line} {error}", path, f"byte {place}") from None
        row = b"".join(parts)
        if len(row) != 4 * length:
            raise _cut_off(line, data, path)
        planes[line] = np.frombuffer(row, dtype=np.uint8)
    return planes.reshape(header.lines, 4, length)


def _one_plane(data: bytes, place: int, left: int, parts: list[bytes]) -> int:
    """Append `left` bytes in pieces. Returns where the next plane begins; ValueError where the pieces do not add up."""
    while left > 0:
        code = data[place]
        if code > 128:
            code -= 128
            parts.append(data[place + 1 : place + 2] * code)
            place += 2
        else:
            parts.append(data[place + 1 : place + 1 + code])
            place += 1 + code
        if not 0 < code <= left:
            raise ValueError("has a run that is empty" if code == 0 else "has a run beyond its end")
        left -= code
    return place


def _cut_off(line: int, data: bytes, path: str | os.PathLike[str]) -> FileFormatError:
    return FileFormatError(f"is cut off in scan line {line}", path, f"byte {len(data)}")


def _whole_pixels(data: bytes, header: _Header, path: str | os.PathLike[str]) -> NDArray[np.uint8]:
    """(lines, 4, length): pixel after pixel; (1, 1, 1, n) repeats the last one n times, the next such in a row 256 n times, and on."""
    wanted = header.lines * header.length
    units = np.frombuffer(data, dtype=np.uint8, count=(len(data) - header.end) // 4 * 4, offset=header.end).reshape(-1, 4)
    repeats = (units[:, :3] == 1).all(axis=1)
    if len(units) >= wanted and not repeats[:wanted].any():
        chosen = units[:wanted]
    else:
        place = np.arange(len(units))
        last = np.maximum.accumulate(np.where(repeats, -1, place))
        shift = np.clip(8 * (place - last - 1), 0, 32)
        counts = np.where(repeats, np.minimum(units[:, 3].astype(np.int64) << shift, wanted + 1), 1)
        ends = np.cumsum(counts)
        k = int(np.searchsorted(ends, wanted))
        if k == len(units):
            raise _cut_off(int(ends[-1] if k else 0) // header.length, data, path)
        if ends[k] > wanted or last[0] < 0:
            what = "repeats a pixel beyond the picture's end" if ends[k] > wanted else "repeats a pixel before there is one"
            raise FileFormatError(what, path, f"byte {header.end + (4 * k if ends[k] > wanted else 0)}")
        chosen = units[np.repeat(last[: k + 1], counts[: k + 1])]
    return chosen.reshape(header.lines, header.length, 4).transpose(0, 2, 1)
