"""OpenEXR pictures, read whole: the colours, and every other layer or part as what lies beside them.

    R G B A                     the picture; premultiplied in the file, straight in an Image
    depth.Z   normal.X .Y .Z    AOVs: a layer's channels, in the order that their names give
    parts                       a part's name takes the layer's place where its channels have none
"""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, UnsupportedError
from ..image.formats import is_light
from .limits import Limits

__all__ = ["Exr", "opened", "read_exr"]

_ORDERS = ("RGBA", "XYZW", "UV")
_WHOLE = ("instance_id", "material_id", "triangle_id", "samples")


class Exr(NamedTuple):
    """pixels (height, width, 4) float32, straight alpha, row 0 on top; layers by name; header of the first part."""

    pixels: NDArray[np.float32]
    aov: dict[str, NDArray[Any]]
    header: dict[str, Any]


def read_exr(path: str | os.PathLike[str], limits: Limits) -> Exr:
    """Read a picture with everything beside it.

    Raises
    ------
    FileFormatError
        The file is broken, cut off or too large.
    UnsupportedError
        There is no colour in it.
    """
    _check_size(path, limits)
    with opened(path) as file:
        header = dict(file.parts[0].header)
        several = len(file.parts) > 1
        layers: dict[str, dict[str, NDArray[Any]]] = {}
        for number, part in enumerate(file.parts):
            own = "" if number == 0 or not several else str(part.header.get("name", number))
            for name, channel in part.channels.items():
                layer, _, suffix = name.rpartition(".")
                layers.setdefault(layer or own, {})[suffix] = np.array(channel.pixels)
    color = layers.pop("", {})
    if not ({"R", "G", "B"} <= set(color) or "Y" in color):
        found = ", ".join([*color, *layers]) or "none"
        raise UnsupportedError(f"{os.fspath(path)}: channels must be R, G, B or Y beside others, got {found[:100]}")
    pixels = _straight(color)
    extra = {suffix: color[suffix] for suffix in color if suffix not in ("R", "G", "B", "A", "Y", "RY", "BY")}
    aov = {name: _stacked(name, channels) for name, channels in layers.items()}
    aov.update({name: values for name, values in extra.items() if name not in aov})
    fitting = {name: values for name, values in aov.items() if values.shape[:2] == pixels.shape[:2]}
    return Exr(pixels, {name: _as_the_picture(name, values, pixels[..., 3:]) for name, values in fitting.items()}, header)


def _as_the_picture(name: str, values: NDArray[Any], alpha: NDArray[np.float32]) -> NDArray[Any]:
    """A part of the picture's light with straight alpha, as the picture has; other layers as they are."""
    if not is_light(name) or values.ndim != 3:
        return values
    return np.asarray(values / np.where(alpha > 0.0, alpha, np.float32(1.0)), dtype=np.float32)


def _check_size(path: str | os.PathLike[str], limits: Limits) -> None:
    with opened(path, header_only=True) as file:
        for part in file.parts:
            low, high = (np.asarray(corner, dtype=np.int64) for corner in part.header["dataWindow"])
            width, height = (int(size) for size in high - low + 1)
            if width < 1 or height < 1 or width * height > limits.max_texture_pixels:
                raise FileFormatError(f"has {width} x {height} pixels, more than the limits allow (max_texture_pixels) or none", path)


def opened(path: str | os.PathLike[str], *, header_only: bool = False) -> Any:
    """An open EXR file of at least one part; the library raises, or finds no part, where it is broken."""
    import OpenEXR

    try:
        file = OpenEXR.File(os.fspath(path), separate_channels=True, header_only=header_only)
    except Exception as error:  # a decoder on a foreign file may raise anything
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise FileFormatError(f"is no readable EXR picture: {reason}", path) from None
    if not file.parts:
        raise FileFormatError("is no readable EXR picture: it is broken or cut off", path)
    return file


def _straight(color: dict[str, NDArray[Any]]) -> NDArray[np.float32]:
    names = ("R", "G", "B") if {"R", "G", "B"} <= set(color) else ("Y", "Y", "Y")
    planes = [color[name] for name in names]
    alpha = color.get("A", np.ones_like(planes[0]))
    if any(plane.shape != alpha.shape for plane in planes):
        raise UnsupportedError("an EXR whose colours have fewer pixels than the picture is not read")
    pixels = np.stack([*planes, alpha], axis=-1).astype(np.float32)
    partial = (pixels[..., 3:] > 0.0) & (pixels[..., 3:] != 1.0)
    np.divide(pixels[..., :3], pixels[..., 3:], out=pixels[..., :3], where=partial)
    return pixels


def _stacked(name: str, channels: dict[str, NDArray[Any]]) -> NDArray[Any]:
    """One array of a layer's channels, in their usual order; ids and counts as the integers that they are."""
    order = next((order for order in _ORDERS if set(channels) <= set(order)), "".join(sorted(channels)))
    planes = [channels[suffix] for suffix in order if suffix in channels] if set(channels) <= set(order) else [*channels.values()]
    if any(plane.shape != planes[0].shape for plane in planes):
        return planes[0]
    values = planes[0] if len(planes) == 1 else np.stack(planes, axis=-1)
    whole = name in _WHOLE and np.isfinite(values).all()
    return np.rint(values).astype(np.int32) if whole else values
