"""Opening pictures: what is in a file becomes an Image, decoded to light, upright, with its recipe.

    image = limner.open_image("photo.jpg")      # a camera's orientation tag is obeyed
    image = limner.open_image("render.exr")     # layers become AOVs

What a file is, its first bytes say. Pictures for screens are decoded with the sRGB curve, or with the plain power that a PNG names
(gAMA); 16 bits are kept. What says that its colours are not sRGB's is converted: by an ICC profile of three lamps, the code of a PNG
(cICP), an EXR's chromaticities.
"""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..color.decode_table import SRGB_DECODE
from ..color.profile_reading import Meaning, meaning_of_cicp, meaning_of_profile, rec709_from_chromaticities
from ..color.transfer import linear_from_gamma, linear_from_srgb
from ..color.triples import in_pieces
from ..errors import FileFormatError, UnsupportedError
from ..image.image import Image
from ..image.png import decode_deep, is_deep
from ..image.recipe import KEYWORD, recipe_from_text
from . import rgbe
from .limits import DEFAULT, Limits
from .pictures import PictureError, open_picture, picture_format
from .sources import Sources

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

__all__ = ["open_image", "upright"]

_EXR = b"\x76\x2f\x31\x01"
_PFM = re.compile(rb"P[Ff]\s")
_ORIENTATION, _IMAGE_DESCRIPTION = 0x0112, 0x010E  # EXIF and TIFF tags
_SRGB_GAMMA = 0.45455  # what a PNG says that means sRGB but has no word for it


def open_image(path: str | os.PathLike[str], *, limits: Limits = DEFAULT) -> Image:
    """Read a picture.

    Parameters
    ----------
    path : str or path-like
        PNG (8 and 16 bits), JPEG, WebP, AVIF, GIF, BMP, TGA, TIFF: decoded from sRGB. OpenEXR, Radiance HDR, PFM: linear as they are.
    limits : Limits

    Returns
    -------
    Image
        Linear Rec. 709, straight alpha, row 0 on top. `recipe`, `dpi` and, from an EXR, `aov` as far as the file has them.

    Raises
    ------
    FileFormatError
        The file is missing, broken or too large.
    UnsupportedError
        The file is of a kind that is not read; the message says which are.
    """
    data = Sources(path, limits).read_model()
    if not data:
        raise FileFormatError("the file is empty", path)
    if data.startswith(_EXR):
        return _from_exr(path, limits)
    if data.startswith(rgbe.MAGIC) or _PFM.match(data):
        return _from_radiance(data, path, limits)
    if not picture_format(data):
        kinds = ".png, .jpg, .webp, .tiff, .exr, .hdr, .pfm and the like"
        raise UnsupportedError(f"{os.fspath(path)}: is no picture that is read; these are: {kinds}")
    try:
        return _from_screen(data, path, limits)
    except PictureError as error:
        raise FileFormatError(str(error), path) from None


# --- light ------------------------------------------------------------------------------------------------------------------


def _from_exr(path: str | os.PathLike[str], limits: Limits) -> Image:
    from .exr import read_exr

    found = read_exr(path, limits)
    recipe = recipe_from_text(str(found.header.get(KEYWORD, "")))
    matrix = rec709_from_chromaticities(found.header.get("chromaticities", ()))
    pixels = found.pixels if matrix is None else _mixed(found.pixels, matrix)
    return Image(pixels, aov=found.aov, recipe=recipe, dpi=_sound_dpi(found.header.get("xDensity")))


def _from_radiance(data: bytes, path: str | os.PathLike[str], limits: Limits) -> Image:
    from .radiance import read_radiance

    light = read_radiance(path, limits=limits)
    pixels = np.ones((*light.shape[:2], 4), dtype=np.float32)
    pixels[..., :3] = light
    told = re.search(rb"^" + KEYWORD.encode() + rb"=(.*)$", data[: data.find(b"\n\n")], re.MULTILINE)
    return Image(pixels, recipe=recipe_from_text(told[1]) if told else {})


# --- screens ----------------------------------------------------------------------------------------------------------------


def _from_screen(data: bytes, path: str | os.PathLike[str], limits: Limits) -> Image:
    picture = open_picture(data, limits)
    told = picture.info
    gamma = _own_gamma(told)
    try:
        encoded = _samples(data, picture, path)
        orientation = int(picture.getexif().get(_ORIENTATION, 1))
        recipe = _recipe(picture)
    except (FileFormatError, PictureError):
        raise
    except Exception as error:  # a decoder on a foreign file may raise anything
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise PictureError(f"is no readable {picture.format} picture: {reason}") from None
    meaning = _meaning(data, told)
    pixels = _light(encoded, gamma) if meaning is None else _light_by(meaning, encoded)
    dpi = told.get("dpi")
    return Image(upright(pixels, orientation), recipe=recipe, dpi=_sound_dpi(dpi[0] if isinstance(dpi, tuple) else None))


def _samples(data: bytes, picture: Picture, path: str | os.PathLike[str]) -> NDArray[Any]:
    """(height, width, 4) uint8 or uint16 as encoded, or float32 where the file holds floats; straight alpha, row 0 on top."""
    if is_deep(data):
        try:
            return decode_deep(data)
        except FileFormatError as error:
            raise FileFormatError(str(error), path) from None
    if picture.mode == "F" or picture.mode.startswith("I"):
        grey = np.asarray(picture)
        deep = grey.astype(np.float32) if picture.mode == "F" else np.clip(grey, 0, 65535).astype(np.uint16)
        rgba = np.full((*deep.shape, 4), 1.0 if picture.mode == "F" else 65535, dtype=deep.dtype)
        rgba[..., :3] = deep[..., None]
        return rgba
    return np.asarray(picture if picture.mode == "RGBA" else picture.convert("RGBA"))


def _light(encoded: NDArray[Any], gamma: float | None) -> NDArray[np.float32]:
    """Decode the colours by table; alpha is linear in every file."""
    if encoded.dtype.kind == "f":
        return encoded
    greatest = int(np.iinfo(encoded.dtype).max)
    levels = np.arange(greatest + 1) / greatest
    if gamma is not None:
        table = linear_from_gamma(levels, gamma).astype(np.float32)
    else:
        table = SRGB_DECODE if greatest == 255 else linear_from_srgb(levels).astype(np.float32)
    pixels = np.empty(encoded.shape, dtype=np.float32)
    np.take(table, encoded[..., :3], out=pixels[..., :3])
    np.divide(encoded[..., 3], np.float32(greatest), out=pixels[..., 3])
    return pixels


def _meaning(data: bytes, told: Mapping[Any, Any]) -> Meaning | None:
    """What a picture says of its colours; None: they are sRGB's, or it says nothing."""
    place = data.find(b"cICP", 0, data.find(b"IDAT")) if data.startswith(b"\x89PNG") else -1
    if place >= 0 and len(data) >= place + 8:
        return meaning_of_cicp(data[place + 4], data[place + 5])
    profile = told.get("icc_profile")
    return meaning_of_profile(profile) if isinstance(profile, bytes) else None


def _light_by(meaning: Meaning, encoded: NDArray[Any]) -> NDArray[np.float32]:
    """Decode as the file says."""
    scale = 1.0 if encoded.dtype.kind == "f" else 1.0 / float(np.iinfo(encoded.dtype).max)
    pixels = (encoded * np.float32(scale)).astype(np.float32, copy=False)
    pixels[..., :3] = in_pieces(meaning.light, pixels[..., :3])
    return pixels


def _mixed(pixels: NDArray[np.float32], matrix: NDArray[np.float64]) -> NDArray[np.float32]:
    made = pixels.copy()
    made[..., :3] = in_pieces(lambda rows: rows @ matrix.T, pixels[..., :3])
    return made


def _own_gamma(told: Mapping[Any, Any]) -> float | None:
    """The power that decodes a PNG which names one instead of sRGB; None: sRGB."""
    stored = told.get("gamma")
    if not isinstance(stored, float) or "srgb" in told or "icc_profile" in told:
        return None
    return 1.0 / stored if 0.01 < stored < 100.0 and abs(stored - _SRGB_GAMMA) > 1e-3 else None


def _recipe(picture: Picture) -> dict[str, Any]:
    candidates = [picture.info.get(KEYWORD), picture.info.get("comment"), picture.getexif().get(_IMAGE_DESCRIPTION)]
    for text in candidates:
        found = recipe_from_text(text) if isinstance(text, (str, bytes)) else {}
        if found:
            return found
    return {}


def _sound_dpi(dpi: Any) -> float | None:
    """A number of pixels per inch, at the resolution at which files hold it; None where there is none that means anything."""
    try:
        value = round(float(dpi), 2)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError, struct.error):
        return None
    return value if 1.0 < value < 1e7 else None


def upright(pixels: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Turn a picture as its camera says that it was held.

    Parameters
    ----------
    pixels : (height, width, ...) array
    orientation : int
        1 to 8: where row 0 and column 0 of the stored picture lie, as EXIF counts (1: top left, 2: top right, 3: bottom right,
        4: bottom left, 5: left top, 6: right top, 7: right bottom, 8: left bottom); anything else is taken for 1.

    **Source**: CIPA DC-008 (EXIF 2.32), 4.6.4 A, tag 274.
    """
    if orientation in (5, 6, 7, 8):
        pixels = np.swapaxes(pixels, 0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)
