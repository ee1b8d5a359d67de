"""Reading pictures for surfaces: PNG, JPEG, WebP and a few more become texels, each picture once.

PNG of 16 bits stay so, and what holds floats (Radiance HDR, OpenEXR) stays floats. KTX2 has a module of its own.

Pillow decodes; what it may open is decided here, from the first bytes, so that none of its stranger formats is ever tried on
a foreign file. The size is compared with the limits before a pixel is decoded. Colour profiles and orientation tags are
ignored, as glTF 2.0 (3.9.4 "Images") demands. Rows are turned here, once: row 0 of texels lies at the bottom.
"""

from __future__ import annotations

import functools
import importlib
import io
import os
from collections.abc import Callable, Hashable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError
from ..image.png import decode_deep, is_deep
from ..scene.texture import MAX_TEXTURE_SIZE, Texels
from . import rgbe
from .limits import DEFAULT, Limits
from .sources import Sources

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["PictureError", "Pictures", "open_picture", "picture_format", "read_picture", "read_texels"]

_WORKERS = 4
_EXR = b"\x76\x2f\x31\x01"
_BRIGHTEST = 65504.0  # the greatest half: what an infinite texel was at least

_Pixels = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]


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
        ktx = "; KTX 1 is not read, KTX 2 is" if bytes(data[1:7]) == b"KTX 11" else ""
        raise PictureError(f"is neither PNG, JPEG, WebP, AVIF, GIF, BMP, TGA, TIFF nor KTX2{ktx}")
    try:
        # Not Image.open: it imports the decoders of five formats, and has limits of its own.
        plugin = importlib.import_module(f"PIL.{_PLUGINS[name]}ImagePlugin")
        picture: Image = getattr(plugin, f"{_PLUGINS[name]}ImageFile")(io.BytesIO(data))
    except Exception as error:  # a decoder on a foreign file may raise anything
        raise PictureError(f"is no readable {name} picture: {_reason(error)}") from None
    width, height = picture.size
    if width * height > limits.max_texture_pixels or max(width, height) > MAX_TEXTURE_SIZE:
        most = f"{MAX_TEXTURE_SIZE} a side and max_texture_pixels, {limits.max_texture_pixels}, in all"
        raise PictureError(f"has {width} x {height} pixels, more than the limits allow: {most}")
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


def read_texels(path: str | os.PathLike[str], *, srgb: bool = True, limits: Limits = DEFAULT) -> Texels:
    """Read a picture for a texture: 8 bits, 16 bits or floats, as the file has them.

    Parameters
    ----------
    path : str or path-like
        PNG (8 and 16 bits), JPEG, WebP, AVIF, GIF, BMP, TGA, TIFF, KTX2; Radiance HDR and OpenEXR, whose floats are linear.
    srgb : bool
        Whether integers hold sRGB-encoded colours: not for normals, heights, roughness.
    limits : Limits

    Raises FileFormatError for what is missing, broken or too large.
    """
    data = Sources(path, limits).read_model()
    try:
        return Pictures(limits).texels(None, lambda: data, srgb=srgb, name=Path(path).name)
    except PictureError as error:
        raise FileFormatError(str(error), path) from None


def _open_any(data: bytes | memoryview, limits: Limits) -> tuple[int, Callable[[], _Pixels]]:
    """How many pixels a picture has, and what decodes it; what holds floats is decoded at once."""
    head = bytes(data[:16])
    if head.startswith((rgbe.MAGIC, _EXR)):
        floats = _floats(data, limits)
        return floats.shape[0] * floats.shape[1], lambda: floats
    if head[:7] == b"\xabKTX 20":
        from .ktx2 import read_header

        texture = read_header(data, limits)
        return texture.width * texture.height, texture.decode
    picture = open_picture(data, limits)
    decode = functools.partial(_decode_words, data) if is_deep(data) else functools.partial(_decode, picture)
    return picture.size[0] * picture.size[1], decode


def _decode_words(data: bytes | memoryview) -> NDArray[np.uint16]:
    try:
        return np.ascontiguousarray(decode_deep(data)[::-1])
    except FileFormatError as error:
        raise PictureError(str(error)) from None


def _floats(data: bytes | memoryview, limits: Limits) -> NDArray[np.float32]:
    """(height, width, 4) float32 of a Radiance HDR or OpenEXR picture, row 0 at the bottom, all finite."""
    try:
        if bytes(data[:4]) == _EXR:
            pixels = _exr_pixels(data, limits)
        else:
            light, _ = rgbe.decode(bytes(data), "", limits)
            pixels = np.ones((*light.shape[:2], 4), dtype=np.float32)
            pixels[..., :3] = light
    except FileFormatError as error:
        raise PictureError(str(error).removeprefix(": ")) from None
    return np.ascontiguousarray(np.nan_to_num(pixels[::-1], nan=0.0, posinf=_BRIGHTEST, neginf=-_BRIGHTEST), dtype=np.float32)


def _exr_pixels(data: bytes | memoryview, limits: Limits) -> NDArray[np.float32]:
    import tempfile

    from .exr import read_exr

    # The library reads files by name alone.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "texture.exr")
        path.write_bytes(data)
        return read_exr(path, limits).pixels


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
        self._pixels: dict[Hashable, _Pixels | LimnerError] = {}
        self._texels: dict[tuple[Hashable, bool], Texels] = {}
        self._n_pixels = 0

    def prepare(self, sources: Mapping[Any, Callable[[], bytes | memoryview]]) -> None:
        """Decode the pictures that `sources` (key: what gives the encoded bytes) holds, some at a time.

        What goes wrong is kept, and raised by `texels` where the picture is asked for.
        """
        opened: dict[Hashable, Callable[[], _Pixels]] = {}
        for key, give in sources.items():
            if key in self._pixels or key in opened:
                continue
            try:
                n_pixels, opened[key] = _open_any(give(), self._limits)
                self._count(n_pixels)
            except LimnerError as error:
                opened.pop(key, None)
                self._pixels[key] = error
        if len(opened) > 1 and (os.cpu_count() or 1) > 1:
            from concurrent.futures import ThreadPoolExecutor

            with ThreadPoolExecutor(max_workers=min(_WORKERS, len(opened))) as pool:
                decoded = list(pool.map(_decode_or_error, opened.values()))
        else:
            decoded = [_decode_or_error(decode) for decode in opened.values()]
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
        srgb = srgb and pixels.dtype != np.float32
        if (key, srgb) not in self._texels:
            self._texels[key, srgb] = Texels(pixels, srgb=srgb, name=name)
        return self._texels[key, srgb]

    def _count(self, n_pixels: int) -> None:
        if self._n_pixels + n_pixels > self._limits.max_total_texture_pixels:
            raise PictureError("is one picture too many for the limits (max_total_texture_pixels)")
        self._n_pixels += n_pixels


def _decode_or_error(decode: Callable[[], _Pixels]) -> _Pixels | LimnerError:
    try:
        return decode()
    except PictureError as error:
        return error
