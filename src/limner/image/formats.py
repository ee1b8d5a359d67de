"""What each format of picture can keep, and how it is written.

    .png                       8 bits (or 16, or 1), sRGB, straight alpha; the recipe as text under "limner"; dots per inch
    .exr                       float32 (or half), linear, premultiplied alpha; AOVs as layers or parts; the recipe in the header
    .jpg .jpeg                 8 bits, sRGB, over white, for it has no alpha; the recipe as comment; dots per inch
    .webp                      8 bits, sRGB, straight alpha, without loss; the recipe as image description
    .tif .tiff                 8 bits, sRGB, straight alpha; the recipe as image description; dots per inch
    .hdr                       linear, three mantissas of 8 bits that share an exponent, over black; the recipe in the header
    .pfm                       float32, linear, over black

All but the last two say which colour space their numbers are of where that is not sRGB: by an ICC profile (and its code, CICP, in a PNG),
an EXR by its chromaticities, always.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import bytes_from_linear, bytes_from_unit, srgb_from_linear
from ..color.views import checked_exposure, checked_view
from ..errors import UnsupportedError
from .png import png_bytes
from .recipe import KEYWORD, recipe_text

if TYPE_CHECKING:
    from .image import Image

__all__ = [
    "FORMATS", "LUMINANCE", "Format", "Options", "checked_options", "exr_layers", "format_of", "is_light", "luminance_over_white", "png",
]  # fmt: skip

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
"""(3,) float32: Y of linear Rec. 709. **Source**: ITU-R BT.709-6, 3.2."""

_CHANNELS = {
    "depth": "Z", "distance": "Z", "instance_id": "X", "material_id": "X", "triangle_id": "X",
    "uv": "UV", "albedo": "RGB", "denoising_albedo": "RGB", "denoising_depth": "Z", "variance": "RGB", "samples": "X",
}  # fmt: skip
_EXACT_INTEGERS = 1 << 24  # in a float32
_GREATEST_HALF = 65504.0
_IMAGE_DESCRIPTION = 270  # in TIFF and EXIF


class Options(NamedTuple):
    """How a picture is written; see `limner.image.save.save`."""

    bits: int | None = None
    dither: str | None = None
    dpi: float | None = None
    seed: int = 0
    parts: bool = False
    view: str = "standard"
    exposure: float = 0.0
    color_space: str = "srgb"


class Format(NamedTuple):
    """A kind of file: the bits that it can hold (the usual number first), and whether it has places for more."""

    name: str
    write: Callable[[Image, Path, Options], None]
    bits: tuple[int, ...] = (8,)
    dithers: bool = True
    keeps_dpi: bool = True
    keeps_parts: bool = False
    keeps_space: bool = True


def format_of(path: str | os.PathLike[str]) -> Format:
    """The format that the extension names; UnsupportedError names all of them."""
    extension = Path(path).suffix.lower()
    if extension not in FORMATS:
        found = f"got {extension!r}" if extension else "got none"
        raise UnsupportedError(f"the extension of {os.fspath(path)!r} must be one of {', '.join(FORMATS)}; {found}")
    return FORMATS[extension]


def checked_options(kind: Format, given: Options, image_dpi: float | None) -> Options:
    """Complete what is left open; UnsupportedError where the format cannot do what is asked for."""
    bits = kind.bits[0] if given.bits is None else given.bits
    if bits not in kind.bits:
        raise UnsupportedError(f"{kind.name} holds {' or '.join(map(str, kind.bits))} bits in each channel, got {given.bits!r}")
    if given.dither is not None:
        from .quantize import DITHERS

        if not kind.dithers:
            raise UnsupportedError(f"{kind.name} holds light as it is; there is nothing to dither")
        if given.dither not in DITHERS:
            raise UnsupportedError(f"dither must be one of {', '.join(DITHERS)} or None, got {given.dither!r}")
    if given.parts and not kind.keeps_parts:
        raise UnsupportedError(f"{kind.name} has no parts; EXR has")
    view, exposure = checked_view(given.view), checked_exposure(given.exposure)
    if not kind.dithers and (view != "standard" or exposure != 0.0):
        raise UnsupportedError(f"{kind.name} holds light as it is: view and exposure are for screens, as in PNG, JPEG, WebP and TIFF")
    _check_space(kind, given.color_space, view, bits)
    dpi = image_dpi
    if given.dpi is not None:
        from .hardcopy import checked_dpi

        dpi = checked_dpi(given.dpi)
        if not kind.keeps_dpi:
            raise UnsupportedError(f"{kind.name} has no place for dots per inch; PNG, JPEG, TIFF and EXR have")
    return Options(bits, given.dither, dpi, given.seed, given.parts, view, exposure, given.color_space)


def _check_space(kind: Format, name: str, view: str, bits: int) -> None:
    """Refuse a colour space that is not known, or that the file could not say."""
    if name == "srgb":
        return
    from ..color.profile import icc_profile
    from ..color.spaces import space

    found = space(name)
    if not kind.keeps_space:
        raise UnsupportedError(f"{kind.name} cannot say its colour space; PNG, JPEG, WebP, TIFF and EXR can")
    if view == "none" or bits == 1:
        raise UnsupportedError(f"color_space {name} needs colours: numbers as they are (view none) and black and white (1 bit) have none")
    if kind.dithers and not (kind.name == "PNG" and found.cicp):
        icc_profile(found)


def _recipe(image: Image, options: Options) -> str:
    """The recipe, with how the picture was written where that is unusual."""
    usual = Options(bits=None, dpi=options.dpi)
    saved = {name: value for name, value in options._asdict().items() if value != usual._asdict()[name]}
    if saved.get("bits") in (8, 32):
        del saved["bits"]
    told = {key: value for key, value in image.recipe.items() if key != "saved"}
    return recipe_text({**told, "saved": saved} if saved else told)


# --- for screens ------------------------------------------------------------------------------------------------------------


def _stored(light: NDArray[np.float32], options: Options) -> NDArray[Any]:
    """(height, width, 3): light as the numbers of the file's colour space; beyond [0, 1] where that cannot show it."""
    if options.color_space == "srgb":
        return srgb_from_linear(light)
    from ..color.convert import convert_color

    return convert_color(light, "linear_srgb", options.color_space)


def _profile(options: Options) -> bytes | None:
    """What says which colour space the numbers are of; None: sRGB, as everybody assumes."""
    if options.color_space == "srgb":
        return None
    from ..color.profile import icc_profile

    return icc_profile(options.color_space)


def _encoded(image: Image, options: Options) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """(height, width, 4): sRGB-encoded colour, straight alpha, in as many bits as asked for."""
    if options.bits == 8 and options.dither is None and options.color_space == "srgb":
        return image.to_uint8(options.view, options.exposure)
    from .quantize import quantize

    bits = options.bits or 8
    seen = image.viewed(options.view, options.exposure).pixels[..., :3]
    color = quantize(seen if options.view == "none" else _stored(seen, options), bits, options.dither, options.seed)
    return np.concatenate([color, quantize(image.pixels[..., 3:], bits)], axis=2)


def _black_and_white(image: Image, options: Options) -> NDArray[np.bool_]:
    """(height, width): paper or ink, over white; luminance is linear, so that what is dithered is as bright as it was."""
    from .quantize import quantize

    return quantize(luminance_over_white(image.viewed(options.view, options.exposure)), 1, options.dither, options.seed).astype(bool)


def luminance_over_white(image: Image) -> NDArray[np.float32]:
    """(height, width) float32: how bright white paper is with the picture on it."""
    return _over_white(image) @ LUMINANCE


def _over_white(image: Image) -> NDArray[np.float32]:
    alpha = np.clip(image.pixels[..., 3:], 0.0, 1.0)
    return image.pixels[..., :3] * alpha + (np.float32(1.0) - alpha)


def png(image: Image, options: Options) -> bytes:
    """Encode as PNG."""
    pixels = _black_and_white(image, options) if options.bits == 1 else _encoded(image, options)
    texts = {KEYWORD: _recipe(image, options)}
    if options.color_space == "srgb":
        return png_bytes(pixels, texts, options.dpi)
    from ..color.spaces import space

    found = space(options.color_space)
    return png_bytes(pixels, texts, options.dpi, profile=_profile(options) if found.encoding.curve else None, cicp=found.cicp)


def _write_png(image: Image, path: Path, options: Options) -> None:
    path.write_bytes(png(image, options))


def _write_pillow(image: Image, encoded: NDArray[np.uint8], path: Path, kind: str, **settings: Any) -> None:
    from PIL import Image as Picture

    made = io.BytesIO()
    try:
        Picture.fromarray(encoded).save(made, kind, **{key: value for key, value in settings.items() if value is not None})
    except ValueError as error:  # a size that the format cannot hold
        raise UnsupportedError(f"a {kind} cannot hold this picture of {image.width} x {image.height}: {error}") from error
    path.write_bytes(made.getvalue())


def _dpi_pair(options: Options) -> tuple[float, float] | None:
    return None if options.dpi is None else (options.dpi, options.dpi)


def _write_jpeg(image: Image, path: Path, options: Options) -> None:
    over_white = _over_white(image.viewed(options.view, options.exposure))
    if options.dither is None and options.color_space == "srgb":
        encoded = bytes_from_unit(over_white) if options.view == "none" else bytes_from_linear(over_white)
    else:
        from .quantize import quantize

        codes = over_white if options.view == "none" else _stored(over_white, options)
        encoded = quantize(codes, 8, options.dither, options.seed).astype(np.uint8)
    comment = _recipe(image, options).encode()[:65000]
    _write_pillow(
        image, encoded, path, "JPEG", quality=95, subsampling=0, comment=comment, dpi=_dpi_pair(options), icc_profile=_profile(options)
    )


def _opaque_as_rgb(encoded: NDArray[Any]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(encoded[..., :3] if (encoded[..., 3] == 255).all() else encoded).astype(np.uint8, copy=False)


def _write_webp(image: Image, path: Path, options: Options) -> None:
    from PIL.Image import Exif

    told = Exif()
    told[_IMAGE_DESCRIPTION] = _recipe(image, options)
    _write_pillow(
        image, _opaque_as_rgb(_encoded(image, options)), path, "WEBP", lossless=True, exif=told.tobytes(), icc_profile=_profile(options)
    )


def _write_tiff(image: Image, path: Path, options: Options) -> None:
    settings: dict[str, Any] = {"compression": "tiff_adobe_deflate", "description": _recipe(image, options), "dpi": _dpi_pair(options)}
    settings["icc_profile"] = _profile(options)
    _write_pillow(image, _opaque_as_rgb(_encoded(image, options)), path, "TIFF", **settings)


# --- for light --------------------------------------------------------------------------------------------------------------


def _write_exr(image: Image, path: Path, options: Options) -> None:
    import OpenEXR

    header: dict[str, Any] = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    told = {**header, KEYWORD: _recipe(image, options)}
    if options.dpi is not None:
        told["xDensity"] = options.dpi
    told["chromaticities"] = chromaticities(options.color_space)
    layers = exr_layers(_in_space(image, options.color_space), half=options.bits == 16)
    try:
        if options.parts:
            names = list(dict.fromkeys(name.rpartition(".")[0] for name in layers))
            parts = []
            for layer in names:
                channels = {name: values for name, values in layers.items() if name.rpartition(".")[0] == layer}
                parts.append(OpenEXR.Part(dict(told if not layer else header), channels, layer or "picture"))
            with OpenEXR.File(parts) as file:
                file.write(os.fspath(path))
        else:
            with OpenEXR.File(told, layers) as file:
                file.write(os.fspath(path))
    except RuntimeError as error:  # how the library reports a file that could not be written
        raise OSError(0, str(error).strip().rstrip(".").rpartition(". ")[2]) from error


def chromaticities(name: str) -> tuple[float, ...]:
    """x, y of a space's red, green, blue and white: what an EXR says of its channels (OpenEXR, *Technical Introduction*)."""
    from ..color.spaces import space

    found = space(name)
    return tuple(float(part) for part in (*found.red, *found.green, *found.blue, *found.white))


def _in_space(image: Image, name: str) -> Image:
    """The same light as amounts of another space's lamps."""
    if name == "srgb":
        return image
    from ..color.convert import convert_color

    def converted(light: NDArray[Any]) -> NDArray[Any]:
        return convert_color(light, "linear_srgb", f"linear_{name}")

    pixels = image.pixels.copy()
    pixels[..., :3] = converted(image.pixels[..., :3])
    return replace(image, pixels=pixels, aov={key: converted(values) if is_light(key) else values for key, values in image.aov.items()})


def exr_layers(image: Image, *, half: bool = False) -> dict[str, NDArray[Any]]:
    """Name the channels as compositors expect them: R G B A premultiplied, and a layer for each AOV.

    Ids become floats, as compositors take them: exact, with -1 for nothing. `half` makes the colours float16; what is beside them
    stays float32.
    """
    alpha = image.pixels[..., 3:]
    color: NDArray[Any] = np.concatenate([image.pixels[..., :3] * alpha, alpha], axis=2)
    layers: dict[str, NDArray[Any]] = {"RGBA": np.clip(color, -_GREATEST_HALF, _GREATEST_HALF).astype(np.float16) if half else color}
    for name, values in image.aov.items():
        if values.dtype.kind in "iu" and values.size and int(np.abs(values).max()) > _EXACT_INTEGERS:
            raise UnsupportedError(f"{name} holds numbers above {_EXACT_INTEGERS}, which an EXR's floats cannot tell apart")
        planes = values.reshape(*values.shape[:2], -1)
        suffixes = _CHANNELS.get(name, "XYZW")
        if is_light(name):
            planes, suffixes = planes * alpha, "RGB"
        for index, suffix in enumerate(suffixes[: planes.shape[2]]):
            layers[f"{name}.{suffix}"] = np.ascontiguousarray(planes[..., index], dtype=np.float32)
    return layers


def is_light(name: str) -> bool:
    """Whether a channel holds a part of the picture's light, premultiplied in files as the picture is."""
    return name in ("direct", "indirect") or name.startswith("light_")


def _over_black(image: Image) -> NDArray[np.float32]:
    return image.pixels[..., :3] * np.clip(image.pixels[..., 3:], 0.0, 1.0)


def _write_pfm(image: Image, path: Path, options: Options) -> None:
    """Rows from the bottom, little-endian as the minus says (Debevec, *PFM*, 2001)."""
    rows = np.ascontiguousarray(_over_black(image)[::-1], dtype="<f4")
    path.write_bytes(f"PF\n{image.width} {image.height}\n-1.0\n".encode() + rows.tobytes())


def _write_hdr(image: Image, path: Path, options: Options) -> None:
    text = _recipe(image, options)
    told = f"{KEYWORD}={text}\n" if len(text) < 60000 else ""
    head = f"#?RADIANCE\nSOFTWARE=limner\n{told}FORMAT=32-bit_rle_rgbe\n\n-Y {image.height} +X {image.width}\n"
    path.write_bytes(head.encode() + _scan_lines(_rgbe_from_linear(_over_black(image))))


def _rgbe_from_linear(pixels: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(height, width, 4) uint8: the mantissas nearest to the colour, m 2^(e - 136), with one exponent for all three.

    **Source**: Ward, *Real pixels*, Graphics Gems II, 1991; rounded to the nearest instead of down, as readers add no half step.
    """
    sound = np.nan_to_num(np.maximum(pixels, 0.0), nan=0.0, posinf=1e38).astype(np.float64)
    greatest = sound.max(axis=2)
    _, exponent = np.frexp(greatest)
    # A mantissa that rounds up to 256 needs the next exponent.
    exponent = exponent + (np.ldexp(greatest, 8 - exponent) >= 255.5)
    exponent = np.clip(exponent, -127, 127)
    mantissas = np.minimum(np.floor(np.ldexp(sound, 8 - exponent[..., None]) + 0.5), 255.0)
    made = np.concatenate([mantissas, exponent[..., None] + 128], axis=2).astype(np.uint8)
    made[greatest <= 0.0] = 0
    return made


def _scan_lines(rgbe: NDArray[np.uint8]) -> bytes:
    """The four bytes of each line apart, in literal stretches of at most 128; whole pixels where a line is too short or too long for it."""
    height, width, _ = rgbe.shape
    if not 8 <= width <= 0x7FFF:
        return rgbe.tobytes()
    planes = rgbe.transpose(0, 2, 1)
    pieces = [np.broadcast_to(np.array([2, 2, width >> 8, width & 255], dtype=np.uint8), (height, 4))]
    for plane in range(4):
        for start in range(0, width, 128):
            piece = planes[:, plane, start : start + 128]
            pieces += [np.full((height, 1), piece.shape[1], dtype=np.uint8), piece]
    return np.concatenate(pieces, axis=1).tobytes()


_JPEG = Format("JPEG", _write_jpeg)
_TIFF = Format("TIFF", _write_tiff)

FORMATS = {
    ".png": Format("PNG", _write_png, bits=(8, 16, 1)),
    ".exr": Format("EXR", _write_exr, bits=(32, 16), dithers=False, keeps_parts=True),
    ".jpg": _JPEG,
    ".jpeg": _JPEG,
    ".webp": Format("WebP", _write_webp, keeps_dpi=False),
    ".tif": _TIFF,
    ".tiff": _TIFF,
    ".hdr": Format("Radiance HDR", _write_hdr, dithers=False, keeps_dpi=False, keeps_space=False),
    ".pfm": Format("PFM", _write_pfm, bits=(32,), dithers=False, keeps_dpi=False, keeps_space=False),
}
"""By extension."""
