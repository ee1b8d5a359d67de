"""Reading pictures for surfaces: PNG, JPEG, WebP and a few more become texels, each picture once.

Pillow decodes; what it may open is decided here, from the first bytes, so that none of its stranger formats is ever tried on
a foreign file. The size is compared with the limits before a pixel is decoded. Colour profiles and orientation tags are
ignored, as glTF 2.0 (3.9.4 "Images") demands. Rows are turned here, once: row 0 of texels lies at the bottom.
"""

from __future__ import annotations

import importlib
import io
import os
from collections.abc import Callable, Hashable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from ..scene.texture import MAX_TEXTURE_SIZE, Texels
from .limits import Limits

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["PictureError", "Pictures", "open_picture", "picture_format", "read_picture"]

_WORKERS = 4


class PictureError(LimnerError):
    """A picture that cannot be decoded; the message says why, the caller where it stands."""


def picture_format(data: bytes | memoryview) -> str:
    """Return Pillow's name of the format that the first bytes announce; empty where none that is read does.

    >>> picture_format(b"\\x89PNG\\r\\n\\x1a\\n")
    'PNG'
    """
    head = bytes(data[:32])
    if head[:4] == b"RIFF" and head[8:12] == b"WEBP":
        return "WEBP"
    if head[4:8] == b"ftyp" and head[8:12] in (b"avif", b"avis", b"mif1"):
        return "AVIF"
    if len(head) >= 18 and head[1] in (0, 1) and head[2] in (1, 2, 3, 9, 10, 11) and head[16] in (8, 15, 16, 24, 32):
        return "TGA"
    known = {b"\x89PNG": "PNG", b"\xff\xd8\xff": "JPEG", b"GIF8": "GIF", b"BM": "BMP", b"II*\0": "TIFF", b"MM\0*": "TIFF"}
    return next((name for magic, name in known.items() if head.startswith(magic)), "")


_PLUGINS = {
    "PNG": "Png", "JPEG": "Jpeg", "WEBP": "WebP", "AVIF": "Avif", "GIF": "Gif", "BMP": "Bmp", "TGA": "Tga", "TIFF": "Tiff"
}  # fmt: skip


def read_picture(data: bytes | memoryview, limits: Limits) -> NDArray[np.uint8]:
    """Decode a picture to (height, width, 4) uint8 RGBA, straight alpha, row 0 at the *bottom*.

    Raises PictureError for what is no picture, is cut off, or is larger than the limits.
    """
    return _decode(open_picture(data, limits))


def open_picture(data: bytes | memoryview, limits: Limits) -> Image:
    """Return Pillow's picture with its header read and its size checked, no pixel decoded; raises PictureError."""
    name = picture_format(data)
    if not name:
        ktx = "; KTX2 textures are not supported" if bytes(data[1:4]) == b"KTX" else ""
        raise PictureError(f"is neither PNG, JPEG, WebP, AVIF, GIF, BMP, TGA nor TIFF{ktx}")
    try:
        # Not Image.open: it imports the decoders of five formats, and has limits of its own.
        plugin = importlib.import_module(f"PIL.{_PLUGINS[name]}ImagePlugin")
        picture: Image = getattr(plugin, f"{_PLUGINS[name]}ImageFile")(io.BytesIO(data))
    except Exception as error:  # a decoder on a foreign file may raise anything
        raise PictureError(f"is no readable {name} picture: {_reason(error)}") from None
    width, height = picture.size
    if width * height > limits.max_texture_pixels or max(width, height) > MAX_TEXTURE_SIZE:
        raise PictureError(f"has {width} x {height} pixels, more than the limits allow (max_texture_pixels)")
    return picture


def _decode(picture: Image) -> NDArray[np.uint8]:
    try:
        if picture.mode.startswith(("I", "F")):
            return _from_deep(picture)
        colored = picture if picture.mode == "RGBA" else picture.convert("RGBA")
        # The last argument is the step from row to row: -1 turns the picture over while it is copied.
        return np.frombuffer(colored.tobytes("raw", "RGBA", 0, -1), dtype=np.uint8).reshape(picture.height, picture.width, 4)
    except Exception as error:  # as above
        raise PictureError(f"is no readable {picture.format} picture: {_reason(error)}") from None


def _from_deep(picture: Image) -> NDArray[np.uint8]:
    # Grey with 16 or 32 bits: Pillow's own conversion clips instead of scaling.
    deep = np.asarray(picture).astype(np.float64)
    scale = 1.0 if picture.mode == "F" else 65535.0
    grey = np.round(np.clip(np.nan_to_num(deep) / scale, 0.0, 1.0) * 255.0).astype(np.uint8)
    rgba = np.full((*grey.shape, 4), 255, dtype=np.uint8)
    rgba[..., :3] = grey[::-1, :, None]
    return rgba


def _reason(error: Exception) -> str:
    return " ".join(str(error).split())[:120] or type(error).__name__


class Pictures:
    """The pictures of one model: each decoded once, however many textures show it, as colour or as data.

    Parameters
    ----------
    limits : Limits
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._pixels: dict[Hashable, NDArray[np.uint8] | LimnerError] = {}
        self._texels: dict[tuple[Hashable, bool], Texels] = {}
        self._n_pixels = 0

    def prepare(self, sources: Mapping[Any, Callable[[], bytes | memoryview]]) -> None:
        """Decode the pictures that `sources` (key: what gives the encoded bytes) holds, some at a time.

        What goes wrong is kept, and raised by `texels` where the picture is asked for.
        """
        opened: dict[Hashable, Image] = {}
        for key, give in sources.items():
            if key in self._pixels or key in opened:
                continue
            try:
                opened[key] = self._within_budget(open_picture(give(), self._limits))
            except LimnerError as error:
                self._pixels[key] = error
        if len(opened) > 1 and (os.cpu_count() or 1) > 1:
            from concurrent.futures import ThreadPoolExecutor

            with ThreadPoolExecutor(max_workers=min(_WORKERS, len(opened))) as pool:
                decoded = list(pool.map(_decode_or_error, opened.values()))
        else:
            decoded = [_decode_or_error(picture) for picture in opened.values()]
        self._pixels.update(zip(opened, decoded, strict=True))

    def texels(self, key: Hashable, give: Callable[[], bytes | memoryview], *, srgb: bool, name: str = "") -> Texels:
        """Return the texels of the picture `key`; `give` yields its encoded bytes where it was not prepared.

        Raises LimnerError, the same each time, where the picture cannot be had.
        """
        if key not in self._pixels:
            self.prepare({key: give})
        pixels = self._pixels[key]
        if isinstance(pixels, LimnerError):
            raise pixels
        if (key, srgb) not in self._texels:
            self._texels[key, srgb] = Texels(pixels, srgb=srgb, name=name)
        return self._texels[key, srgb]

    def _within_budget(self, picture: Image) -> Image:
        n_pixels = picture.size[0] * picture.size[1]
        if self._n_pixels + n_pixels > self._limits.max_total_texture_pixels:
            raise PictureError("is one picture too many for the limits (max_total_texture_pixels)")
        self._n_pixels += n_pixels
        return picture


def _decode_or_error(picture: Image) -> NDArray[np.uint8] | LimnerError:
    try:
        return _decode(picture)
    except PictureError as error:
        return error
