"""Pictures into files, each format with what it can keep, and never half a file.

What each format keeps says `limner.image.formats`.

A file is written beside its place under another name and moved into it when it is whole, so a full disk, an interrupt or a
crash leaves what was there before.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import RenderError
from .formats import FORMATS, Options, checked_options, format_of, png

if TYPE_CHECKING:
    from .image import Image

__all__ = ["EXTENSIONS", "check_destination", "keeps_aovs", "save"]

EXTENSIONS = tuple(FORMATS)


def save(
    image: Image,
    path: str | os.PathLike[str],
    *,
    bits: int | None = None,
    dither: str | None = None,
    dpi: float | None = None,
    seed: int = 0,
    parts: bool = False,
    view: str = "standard",
    exposure: float = 0.0,
    color_space: str = "srgb",
) -> None:
    """Write `image` to `path`.

    Parameters
    ----------
    path : str or path-like
        The extension says the format; "-" writes a PNG to standard output.
    bits : int, optional
        Of each channel: 1 (black and white, by luminance), 8 (the default) or 16 in a PNG; 16 (half) or 32 (float, the default) in an
        EXR; what the others hold is fixed.
    dither : "ordered" | "blue_noise" | "random" | "floyd_steinberg", optional
        How the error of rounding is spread (`limner.image.quantize`); None: to the nearest.
    dpi : float, optional
        Pixels per inch on paper, in PNG, JPEG, TIFF and EXR; None: `image.dpi`.
    seed : int
        For the dither.
    parts : bool
        In an EXR, give each AOV a part of its own instead of a layer beside the colours.
    view : str
        How light becomes colour on a screen: one of `limner.color.views.VIEWS`. Only for formats that are for screens: EXR, HDR and PFM
        hold light as it is.
    exposure : float
        Stops by which the light is made brighter first; likewise.
    color_space : str
        Whose numbers are written, one of `limner.color.spaces.SPACES`, and said in the file: by an ICC profile, in an EXR by its
        chromaticities. Radiance HDR and PFM have no place for it.

    Raises
    ------
    UnsupportedError
        An unknown extension, or what the format cannot hold; nothing is written.
    RenderError
        The file cannot be written: no such folder, no permission, a full disk. What was there before is still there.
    """
    to_stdout = os.fspath(path) == "-"
    kind = FORMATS[".png"] if to_stdout else format_of(path)
    options = checked_options(kind, Options(bits, dither, dpi, seed, parts, view, exposure, color_space), image.dpi)
    if to_stdout:
        _write_stream(png(image, options))
        return
    check_destination(path)

    def write(image: Image, path: Path) -> None:
        kind.write(image, path, options)

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


def check_destination(path: str | os.PathLike[str], *, view: str = "standard", exposure: float = 0.0, color_space: str = "srgb") -> None:
    """Refuse a place where no picture can be written, before any work is done for it.

    Raises UnsupportedError for an unknown extension, or one whose format has no views or spaces; RenderError for a folder that is missing
    or may not be written.
    """
    name = os.fspath(path)
    if name == "-":
        return
    checked_options(format_of(path), Options(view=view, exposure=exposure, color_space=color_space), None)
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
