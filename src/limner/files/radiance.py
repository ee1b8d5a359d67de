"""Reading pictures as light: Radiance (.hdr, .pic), OpenEXR (.exr), portable float maps (.pfm), and pictures for screens.

What a file is, its first bytes say. Radiance comes back linear and as bright as the file says it is, row 0 on top; pixels that are
no light (NaN, negative, infinite) are repaired, and a warning tells of it.
"""

from __future__ import annotations

import os
import re
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..color.decode_table import SRGB_DECODE
from ..errors import FileFormatError, LimnerWarning, UnsupportedError
from . import exr, rgbe
from .limits import DEFAULT, Limits
from .pictures import PictureError, picture_format, read_picture
from .sources import Sources

__all__ = ["read_radiance"]

_EXR = b"\x76\x2f\x31\x01"
_PFM = re.compile(rb"(P[Ff])\s+(\d{1,9})\s+(\d{1,9})\s+([-+0-9.eE]{1,40})\s")
_BRIGHTEST = 65504.0  # the greatest half: what an infinite pixel was at least


def read_radiance(path: str | os.PathLike[str], *, limits: Limits = DEFAULT) -> NDArray[np.float32]:
    """Read a picture as linear radiance.

    Parameters
    ----------
    path : str or path-like
        .hdr and .pic (Radiance RGBE), .exr (channels R, G, B or Y), .pfm; PNG, JPEG and the like are decoded from sRGB, 1 at the
        brightest.
    limits : Limits

    Returns
    -------
    (height, width, 3) float32
        Rec. 709, row 0 on top, finite and not negative. Alpha is left out.

    Raises
    ------
    FileFormatError
        The file is missing, broken or too large; the message says where.
    UnsupportedError
        The file is of a kind that is not read; the message says which are.

    Warns LimnerWarning where pixels had to be repaired.
    """
    data = Sources(path, limits).read_model()
    slips: tuple[str, ...] = ()
    if not data:
        raise FileFormatError("the file is empty", path)
    if data.startswith(rgbe.MAGIC):
        pixels, slips = rgbe.decode(data, path, limits)
    elif data.startswith(_EXR):
        pixels = _read_exr(path, limits)
    elif _PFM.match(data):
        pixels = _decode_pfm(data, path, limits)
    elif picture_format(data):
        pixels = _decode_screen(data, path, limits)
    else:
        raise UnsupportedError(f"{os.fspath(path)}: is no picture that is read; these are: .hdr, .exr, .pfm, .png, .jpg and the like")
    pixels, repairs = _repaired(pixels)
    for text in (*slips, *repairs):
        warnings.warn(f"{Path(path).name}: {text}", LimnerWarning, stacklevel=2)
    return pixels


def _repaired(pixels: NDArray[np.float32]) -> tuple[NDArray[np.float32], list[str]]:
    """Pixels that can be light, and what was done to make them so."""
    sound = (pixels >= 0.0) & (pixels < np.inf)
    if sound.all():
        return pixels, []
    brightest = max(_BRIGHTEST, float(pixels.max(where=sound, initial=0.0)))
    infinite = pixels == np.inf
    dark = ~sound & ~infinite
    repairs = []
    became = {"are negative or no numbers and were made black": dark, f"are infinite and were made {brightest:g}": infinite}
    for what, which in became.items():
        if which.any():
            row, column = (int(k) for k in np.argwhere(which)[0, :2])
            repairs.append(f"{int(which.any(axis=2).sum())} pixels {what}, the first at row {row}, column {column}")
    return np.where(sound, pixels, np.where(infinite, np.float32(brightest), np.float32(0.0))), repairs


def _check_size(width: int, height: int, path: str | os.PathLike[str], limits: Limits, position: str = "") -> None:
    if width < 1 or height < 1:
        raise FileFormatError(f"has {width} x {height} pixels", path, position)
    if width * height > limits.max_texture_pixels:
        raise FileFormatError(f"has {width} x {height} pixels, more than the limits allow (max_texture_pixels)", path, position)


def _decode_screen(data: bytes, path: str | os.PathLike[str], limits: Limits) -> NDArray[np.float32]:
    try:
        encoded = read_picture(data, limits)
    except PictureError as error:
        raise FileFormatError(str(error), path) from None
    return SRGB_DECODE[encoded[::-1, :, :3]]


def _decode_pfm(data: bytes, path: str | os.PathLike[str], limits: Limits) -> NDArray[np.float32]:
    """Float by float from the bottom row; the sign of the scale is the order of bytes, its size no reader heeds (Debevec, *PFM*, 2001)."""
    found = _PFM.match(data)
    assert found is not None
    channels, width, height = 3 if found[1] == b"PF" else 1, int(found[2]), int(found[3])
    _check_size(width, height, path, limits, f"byte {found.start(2)}")
    try:
        big_endian = float(found[4]) > 0.0
    except ValueError:
        raise FileFormatError(f"the scale must be a number, got {found[4].decode()!r}", path, f"byte {found.start(4)}") from None
    count = width * height * channels
    if len(data) - found.end() < 4 * count:
        raise FileFormatError(f"is cut off: {width} x {height} pixels take {4 * count} bytes", path, f"byte {len(data)}")
    values = np.frombuffer(data, dtype=">f4" if big_endian else "<f4", count=count, offset=found.end())
    rows = values.reshape(height, width, channels)[::-1].astype(np.float32)
    return np.ascontiguousarray(np.broadcast_to(rows, (height, width, 3)))


def _read_exr(path: str | os.PathLike[str], limits: Limits) -> NDArray[np.float32]:
    with exr.opened(path, header_only=True) as file:
        low, high = (np.asarray(corner, dtype=np.int64) for corner in file.header()["dataWindow"])
    width, height = (int(size) for size in high - low + 1)
    _check_size(width, height, path, limits)
    with exr.opened(path) as file:
        channels = file.parts[0].channels
        planes = [np.array(channels[name].pixels) for name in _color_channels(tuple(channels), path)]
    if any(plane.shape != (height, width) for plane in planes):
        raise UnsupportedError(f"{os.fspath(path)}: channels of fewer pixels than the picture are not read")
    return np.stack(planes * (1 if len(planes) == 3 else 3), axis=-1).astype(np.float32)


def _color_channels(names: tuple[str, ...], path: str | os.PathLike[str]) -> tuple[str, ...]:
    """The names of red, green and blue, or of luminance; those of a layer ("beauty.R") where there are none outside."""
    layers = sorted({name.rpartition(".")[0] for name in names}, key=lambda layer: (layer != "", layer))
    for wanted in (("R", "G", "B"), ("Y",)):
        for layer in layers:
            chosen = tuple(f"{layer}.{channel}" if layer else channel for channel in wanted)
            if set(chosen) <= set(names):
                return chosen
    raise UnsupportedError(f"{os.fspath(path)}: channels must be R, G, B or Y, got {', '.join(names)[:100]}")
