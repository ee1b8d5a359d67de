"""Pictures into files, each format with what it can keep, and never half a file.

    .png                       8 bits, sRGB, straight alpha; the recipe as text under "limner"
    .exr                       float32, linear, premultiplied alpha; AOVs as layers; the recipe in the header
    .jpg .jpeg .webp .tif .tiff    8 bits, sRGB; JPEG, which has no alpha, shows the picture over white

A file is written beside its place under another name and moved into it when it is whole, so a full disk, an interrupt or a
crash leaves what was there before.
"""

from __future__ import annotations

import io
import json
import os
import stat
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import bytes_from_linear
from ..errors import RenderError, UnsupportedError
from .png import png_bytes

if TYPE_CHECKING:
    from .image import Image

__all__ = ["EXTENSIONS", "check_destination", "keeps_aovs", "save"]

_KEYWORD = "limner"  # of the recipe, in every format that can carry it
_CHANNELS = {
    "depth": "Z", "distance": "Z", "instance_id": "X", "material_id": "X", "triangle_id": "X",
    "uv": "UV", "albedo": "RGB",
}  # fmt: skip
_EXACT_INTEGERS = 1 << 24  # in a float32


def save(image: Image, path: str | os.PathLike[str]) -> None:
    """Write `image` to `path`.

    Parameters
    ----------
    path : str or path-like
        The extension says the format; "-" writes a PNG to standard output.

    Raises
    ------
    UnsupportedError
        An unknown extension; nothing is written.
    RenderError
        The file cannot be written: no such folder, no permission, a full disk. What was there before is still there.
    """
    if os.fspath(path) == "-":
        _write_stream(_png(image))
        return
    write = _writer(path)
    check_destination(path)
    target = Path(os.path.realpath(path))
    try:
        if target.exists() and not target.is_file():
            _write_special(image, write, target)
        else:
            _write_whole(image, write, target)
    except OSError as error:
        raise RenderError(f"cannot write {os.fspath(path)}: {error.strerror or error}") from error


def keeps_aovs(path: str | os.PathLike[str]) -> bool:
    """Whether the format that `path` names holds AOVs beside the picture."""
    return Path(path).suffix.lower() == ".exr"


def check_destination(path: str | os.PathLike[str]) -> None:
    """Refuse a place where no picture can be written, before any work is done for it.

    Raises UnsupportedError for an unknown extension and RenderError for a folder that is missing or may not be written.
    """
    name = os.fspath(path)
    if name == "-":
        return
    _writer(path)
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise RenderError(f"cannot write {name}: it is a folder")
    if target.exists() and not target.is_file():
        return
    folder = target.parent
    if not folder.is_dir():
        raise RenderError(f"cannot write {name}: there is no folder {folder}")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RenderError(f"cannot write {name}: no permission to write in {folder}")


# --- places ---------------------------------------------------------------------------------------------------------------


def _write_whole(image: Image, write: Callable[[Image, Path], None], target: Path) -> None:
    """Write under another name in the same folder, then move into place."""
    part = target.with_name(f".{target.name[:100]}.{os.urandom(6).hex()}.part")
    try:
        os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        if target.exists():
            part.chmod(stat.S_IMODE(target.stat().st_mode))
        write(image, part)
        os.replace(part, target)
    except BaseException:  # an interrupt, too, must leave nothing behind
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def _write_special(image: Image, write: Callable[[Image, Path], None], target: Path) -> None:
    """Write to what is no file (a pipe, a device), which must not be replaced by one."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "picture"
        write(image, part)
        with target.open("wb", buffering=0) as stream:
            stream.write(part.read_bytes())


def _write_stream(data: bytes) -> None:
    stream = sys.stdout.buffer
    stream.write(data)
    stream.flush()


# --- formats --------------------------------------------------------------------------------------------------------------


def _png(image: Image) -> bytes:
    return png_bytes(image.to_uint8(), {_KEYWORD: _recipe_text(image)})


def _write_png(image: Image, path: Path) -> None:
    path.write_bytes(_png(image))


def _write_exr(image: Image, path: Path) -> None:
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, _KEYWORD: _recipe_text(image)}
    try:
        with OpenEXR.File(header, exr_channels(image)) as file:
            file.write(os.fspath(path))
    except RuntimeError as error:  # how the library reports a file that could not be written
        raise OSError(0, str(error).strip().rstrip(".").rpartition(". ")[2]) from error


def exr_channels(image: Image) -> dict[str, NDArray[np.float32]]:
    """Name the channels as compositors expect them: R G B A premultiplied, and a layer for each AOV.

    Ids become floats, as compositors take them: exact, with -1 for nothing.
    """
    alpha = image.pixels[..., 3:]
    layers = {"RGBA": np.concatenate([image.pixels[..., :3] * alpha, alpha], axis=2)}
    for name, values in image.aov.items():
        if values.dtype.kind in "iu" and values.size and int(np.abs(values).max()) > _EXACT_INTEGERS:
            raise UnsupportedError(f"{name} holds numbers above {_EXACT_INTEGERS}, which an EXR's floats cannot tell apart")
        planes = values.reshape(*values.shape[:2], -1)
        for index, suffix in enumerate(_CHANNELS.get(name, "XYZW")[: planes.shape[2]]):
            layers[f"{name}.{suffix}"] = np.ascontiguousarray(planes[..., index], dtype=np.float32)
    return layers


def _write_pillow(image: Image, path: Path, kind: str, **options: Any) -> None:
    from PIL import Image as Picture

    if kind == "JPEG":
        alpha = np.clip(image.pixels[..., 3:], 0.0, 1.0)
        picture = Picture.fromarray(bytes_from_linear(image.pixels[..., :3] * alpha + (np.float32(1.0) - alpha)))
    else:
        encoded = image.to_uint8()
        picture = Picture.fromarray(np.ascontiguousarray(encoded[..., :3]) if (encoded[..., 3] == 255).all() else encoded)
    made = io.BytesIO()
    try:
        picture.save(made, kind, **options)
    except ValueError as error:  # a size that the format cannot hold
        raise UnsupportedError(f"a {kind} cannot hold this picture of {image.width} x {image.height}: {error}") from error
    path.write_bytes(made.getvalue())


def _write_jpeg(image: Image, path: Path) -> None:
    _write_pillow(image, path, "JPEG", quality=95, subsampling=0, comment=_recipe_text(image).encode()[:65000])


def _write_webp(image: Image, path: Path) -> None:
    _write_pillow(image, path, "WEBP", lossless=True)


def _write_tiff(image: Image, path: Path) -> None:
    _write_pillow(image, path, "TIFF", compression="tiff_adobe_deflate", description=_recipe_text(image))


_WRITERS: dict[str, Callable[[Image, Path], None]] = {
    ".png": _write_png,
    ".exr": _write_exr,
    ".jpg": _write_jpeg,
    ".jpeg": _write_jpeg,
    ".webp": _write_webp,
    ".tif": _write_tiff,
    ".tiff": _write_tiff,
}

EXTENSIONS = tuple(_WRITERS)


def _writer(path: str | os.PathLike[str]) -> Callable[[Image, Path], None]:
    extension = Path(path).suffix.lower()
    if extension not in _WRITERS:
        found = f"got {extension!r}" if extension else "got none"
        raise UnsupportedError(f"the extension of {os.fspath(path)!r} must be one of {', '.join(EXTENSIONS)}; {found}")
    return _WRITERS[extension]


def _recipe_text(image: Image) -> str:
    """The recipe as JSON in ASCII, which every format's text fields can hold."""
    return json.dumps(dict(image.recipe), sort_keys=True)
