"""Pictures one after the other, as a file that plays for ever or as a folder.

    .gif            256 colours for the whole clip, no alpha, at most 50 pictures a second
    .webp           without loss, or by quality; alpha
    .png .apng      animated PNG: without loss; alpha
    .mp4            H.264 as every player reads it (extra ``video``); no alpha
    no extension    a folder: 0000.png, 0001.png, …, with alpha and recipe

A file comes into its place when it is whole; whatever happens before, what was there before is still there. In a folder each picture is
whole or not there. The same pictures make the same bytes, but for MP4.
"""

from __future__ import annotations

import os
import struct
import tempfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..color.views import checked_exposure, checked_view
from ..errors import RenderError, SceneError, UnsupportedError
from ..image.image import Image
from ..image.recipe import KEYWORD, recipe_text
from ..tiles import Cancelled

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

__all__ = ["KINDS", "Clip", "ClipKind", "check_clip", "write_clip"]

_CENTISECONDS = 100
_MOST_IN_MEMORY = 1 << 28  # bytes of a GIF's pictures before they go to disk
_MOST_BYTES = 1 << 32  # of what an encoder must be given all at once
_IMAGE_DESCRIPTION = 270  # in EXIF


@dataclass(frozen=True)
class Clip:
    """What became of a clip.

    Parameters
    ----------
    path : Path
    n_pictures : int
        That are in it.
    fps : float
    finished : bool
        False: stopped by the user. Then there is no file; a folder holds the pictures so far.
    warnings : tuple of str
        Likely slips, each once.
    """

    path: Path
    n_pictures: int
    fps: float
    finished: bool
    warnings: tuple[str, ...] = ()


class _Order(NamedTuple):
    fps: float
    quality: int | None
    view: str = "standard"
    exposure: float = 0.0


class ClipKind(NamedTuple):
    """A kind of clip: its name, how it is written, whether it keeps alpha, and what it can do with fps and quality."""

    name: str
    write: Callable[[Iterator[Image], Path, _Order], None]
    keeps_alpha: bool
    greatest_fps: float = 1000.0
    has_quality: bool = False


def check_clip(path: str | os.PathLike[str], *, n_pictures: int | None = None, fps: float = 20.0, quality: int | None = None) -> ClipKind:
    """Refuse a clip that cannot be written before anything is drawn for it; return its kind.

    Parameters
    ----------
    path : str or path-like
        The extension says the kind; none, or a folder that is there: a folder.
    n_pictures : int, optional
        Where it is known, a folder that holds more than so many is refused: its end would stay.
    fps : float > 0
    quality : int from 1 to 100, optional

    Raises
    ------
    SceneError, UnsupportedError
        What the kind cannot do.
    RenderError
        A place where nothing can be written.
    """
    kind = _kind_of(path)
    rate = float(fps)
    if not 0.0 < rate <= kind.greatest_fps:  # NaN, too
        raise SceneError(f"fps must be above 0 and at most {kind.greatest_fps:g} in {kind.name}, got {fps}")
    if quality is not None:
        if not kind.has_quality:
            raise UnsupportedError(f"{kind.name} has no quality to choose; WebP and MP4 have")
        if isinstance(quality, bool) or not hasattr(quality, "__index__") or not 1 <= quality <= 100:
            raise SceneError(f"quality must be an integer from 1 to 100, got {quality!r}")
    if kind is _FOLDER:
        _check_folder(Path(path), n_pictures)
    else:
        _check_file(Path(path))
        if kind is KINDS[".mp4"]:
            _ffmpeg()
    return kind


def write_clip(
    pictures: Iterable[Image],
    path: str | os.PathLike[str],
    *,
    fps: float = 20.0,
    quality: int | None = None,
    view: str = "standard",
    exposure: float = 0.0,
) -> Clip:
    """Write pictures as a clip.

    Parameters
    ----------
    pictures : iterable of Image
        All of one size; they are asked for one by one. One that is not finished, or a KeyboardInterrupt, stops the clip.
    path, fps, quality
        As for `check_clip`. GIF and MP4 put what is transparent before white.
    view : str
        How light becomes colour on a screen: one of `limner.color.views.VIEWS`.
    exposure : float
        Stops by which the light is made brighter first.

    Returns
    -------
    Clip
    """
    kind = check_clip(path, fps=fps, quality=quality)
    order = _Order(float(fps), quality, checked_view(view), checked_exposure(exposure))
    place, counted = Path(path), _Counted(pictures)
    finished = True
    try:
        if kind is _FOLDER:
            kind.write(iter(counted), place, order)
        else:
            with _whole(place) as part:
                kind.write(iter(counted), part, order)
    except (Cancelled, KeyboardInterrupt):
        finished = False
    except OSError as error:
        raise RenderError(f"cannot write {place}: {error.strerror or error}") from error
    n = counted.n if finished or kind is _FOLDER else 0
    return Clip(place, n, float(fps), finished, tuple(counted.warnings))


class _Counted:
    """Pictures on their way into a clip: all of one size, finished, and at least one of them."""

    def __init__(self, pictures: Iterable[Image]) -> None:
        self._pictures = pictures
        self.n = 0
        self.warnings: dict[str, None] = {}

    def __iter__(self) -> Iterator[Image]:
        size = None
        for image in self._pictures:
            if not image.finished:
                raise Cancelled
            size = size or (image.width, image.height)
            if (image.width, image.height) != size:
                raise SceneError(f"pictures of a clip must be of one size, got {size} and {(image.width, image.height)}")
            self.warnings |= dict.fromkeys(image.warnings)
            yield image
            self.n += 1
        if not self.n:
            raise SceneError("a clip needs at least one picture")


# --- places ---------------------------------------------------------------------------------------------------------------


def _kind_of(path: str | os.PathLike[str]) -> ClipKind:
    place = Path(path)
    extension = place.suffix.lower()
    if place.is_dir() or not extension or os.fspath(path).endswith(("/", os.sep)):
        return _FOLDER
    if extension not in KINDS:
        raise UnsupportedError(f"a clip must be {', '.join(KINDS)} or, without extension, a folder, got {os.fspath(path)!r}")
    return KINDS[extension]


def _check_file(place: Path) -> None:
    folder = place.absolute().parent
    if not folder.is_dir():
        raise RenderError(f"cannot write {place}: there is no folder {folder}")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RenderError(f"cannot write {place}: no permission to write in {folder}")


def _check_folder(place: Path, n_pictures: int | None) -> None:
    nearest = next(folder for folder in (place.absolute(), *place.absolute().parents) if folder.exists())
    if not nearest.is_dir():
        raise RenderError(f"cannot write in {place}: {nearest} is no folder")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise RenderError(f"cannot write in {place}: no permission to write in {nearest}")
    if n_pictures is not None and place.is_dir():
        last = max((int(old.stem) for old in place.glob("*.png") if old.stem.isdecimal()), default=-1)
        if last >= n_pictures:
            raise SceneError(f"{place} holds a longer clip, up to {last:04d}.png: its end would stay behind; choose another folder")


@contextmanager
def _whole(place: Path) -> Iterator[Path]:
    """Another name beside `place`, moved there at the end, and gone if there is none."""
    target = Path(os.path.realpath(place))
    part = target.with_name(f".{target.name[:100]}.{os.urandom(6).hex()}.part")
    try:
        yield part
        if target.exists():
            part.chmod(target.stat().st_mode & 0o7777)
        os.replace(part, target)
    finally:  # an interrupt, too, must leave nothing behind
        with suppress(OSError):
            part.unlink(missing_ok=True)


# --- the kinds ------------------------------------------------------------------------------------------------------------


def _ends(fps: float, unit: int) -> Iterator[tuple[int, int]]:
    """Beginning and end of each picture in whole units of time; their rounding does not add up."""
    k = 0
    while True:
        yield round(k * unit / fps), round((k + 1) * unit / fps)
        k += 1


def _over_white(image: Image, order: _Order) -> NDArray[np.uint8]:
    """(height, width, 3) uint8: mixed in linear light, as if the screen's white had been behind it."""
    pixels = image.viewed(order.view, order.exposure).pixels
    curve = "none" if order.view == "none" else "standard"
    if (pixels[..., 3] == 1.0).all():
        return np.ascontiguousarray(Image(pixels).to_uint8(curve)[..., :3])
    alpha = np.clip(pixels[..., 3:], 0.0, 1.0)
    mixed = np.concatenate([pixels[..., :3] * alpha + (1.0 - alpha), np.ones_like(alpha)], axis=2)
    return np.ascontiguousarray(Image(mixed).to_uint8(curve)[..., :3])


def _write_gif(pictures: Iterator[Image], part: Path, order: _Order) -> None:
    """All pictures are looked at before the first is written: they share a palette."""
    from PIL import Image as pillow  # noqa: N813 - the module

    from .palette import Tally, fitted

    tally, shape, n, text = Tally(), (0, 0, 3), 0, ""
    with tempfile.SpooledTemporaryFile(max_size=_MOST_IN_MEMORY) as spool:
        for image in pictures:
            picture = _over_white(image, order)
            tally.add(picture)
            spool.write(picture.tobytes())
            text = text or recipe_text(image.recipe)
            shape, n = picture.shape, n + 1
        spool.seek(0)
        palette = fitted(tally)
        colors = np.zeros((256, 3), dtype=np.uint8)
        colors[: len(palette.colors)] = palette.colors

        def shown() -> Iterator[Picture]:
            for _ in range(n):
                picture = np.frombuffer(spool.read(shape[0] * shape[1] * 3), dtype=np.uint8).reshape(shape)
                made = pillow.fromarray(palette.indices(picture))
                made.putpalette(colors.tobytes())
                yield made

        frames = shown()
        times = _ends(order.fps, _CENTISECONDS)
        durations = [10 * (end - start) for start, end in (next(times) for _ in range(n))]
        next(frames).save(
            part,
            "GIF",
            save_all=True,
            append_images=frames,
            duration=durations,
            loop=0,
            disposal=1,
            palette=colors.tobytes(),
            optimize=False,
            comment=text.encode(),
        )


def _write_webp(pictures: Iterator[Image], part: Path, order: _Order) -> None:
    from PIL import Image as pillow  # noqa: N813 - the module

    made, text, total = [], "", 0
    for image in pictures:
        encoded = image.to_uint8(order.view, order.exposure)
        opaque = bool((encoded[..., 3] == 255).all())
        made.append(pillow.fromarray(np.ascontiguousarray(encoded[..., :3] if opaque else encoded)))
        total += encoded.nbytes
        text = text or recipe_text(image.recipe)
        if total > _MOST_BYTES:
            raise RenderError(f"more than {_MOST_BYTES >> 30} GiB of pictures is too much for a WebP: choose a folder, .png or .mp4")
    told = pillow.Exif()
    told[_IMAGE_DESCRIPTION] = text
    durations = [end - start for (start, end), _ in zip(_ends(order.fps, 1000), made, strict=False)]
    how: dict[str, Any] = {"lossless": True, "quality": 60} if order.quality is None else {"quality": order.quality}
    made[0].save(
        part, "WEBP", save_all=True, append_images=made[1:], duration=durations, loop=0, method=4, exif=told.tobytes(), **how
    )  # fmt: skip


def _write_apng(pictures: Iterator[Image], part: Path, order: _Order) -> None:
    """Picture by picture: no more than one of them is in memory, and what is in the file is whole all the time.

    **Source**: W3C, *Portable Network Graphics (PNG) Specification*, 3rd edition, 5 (chunks), 9 (filters), 11.3.6 (acTL, fcTL, fdAT).
    """
    delay = _delay(order.fps)
    n, count_at = 0, 0
    with part.open("wb") as file:
        for image in pictures:
            if n == 0:
                head = struct.pack(">IIBBBBB", image.width, image.height, 8, _TRUECOLOR_ALPHA, 0, 0, 0)
                told = KEYWORD.encode() + b"\0\0\0\0\0" + recipe_text(image.recipe).encode()
                file.write(_SIGNATURE + _chunk(b"IHDR", head) + _chunk(b"sRGB", bytes([_PERCEPTUAL])) + _chunk(b"iTXt", told))
                count_at = file.tell()
                file.write(_chunk(b"acTL", struct.pack(">II", 0, 0)))
            # Chunks of the animation are numbered: a control for each picture, then its data; those of the first are the PNG's own.
            control = struct.pack(">IIIIIHH", max(2 * n - 1, 0), image.width, image.height, 0, 0, *delay) + _REPLACE
            data = _deflated(image.to_uint8(order.view, order.exposure))
            file.write(_chunk(b"fcTL", control))
            file.write(_chunk(b"IDAT", data) if n == 0 else _chunk(b"fdAT", struct.pack(">I", 2 * n) + data))
            n += 1
        file.write(_chunk(b"IEND", b""))
        file.seek(count_at)
        file.write(_chunk(b"acTL", struct.pack(">II", n, 0)))


_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_TRUECOLOR_ALPHA = 6
_PERCEPTUAL = 0
_FILTER_UP = 2
_REPLACE = bytes([0, 0])  # nothing is cleared, all is overwritten, alpha too


def _delay(fps: float) -> tuple[int, int]:
    """Seconds for which a picture stays, as a fraction of two 16-bit numbers."""
    if fps < 1.0 / 0xFFFF:
        return 0xFFFF, 1
    fraction = 1 / Fraction(fps).limit_denominator(0xFF)
    if fraction.numerator > 0xFFFF or fraction.denominator > 0xFFFF:
        fraction = Fraction(round(1000.0 / fps), 1000) if fps > 0.02 else Fraction(round(1.0 / fps), 1)
    return fraction.numerator, fraction.denominator


def _deflated(encoded: NDArray[np.uint8]) -> bytes:
    """Each row of bytes as its difference from the row above, compressed; smaller and slower than what single pictures get."""
    rows = encoded.reshape(encoded.shape[0], -1)
    filtered = np.empty((rows.shape[0], rows.shape[1] + 1), dtype=np.uint8)
    filtered[:, 0] = _FILTER_UP
    filtered[0, 1:] = rows[0]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    return zlib.compress(filtered.data, level=6)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _ffmpeg() -> Any:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise UnsupportedError("MP4 needs imageio-ffmpeg: pip install 'limner[video]'; .webp, .gif and .png need nothing") from None
    return imageio_ffmpeg


def _write_mp4(pictures: Iterator[Image], part: Path, order: _Order) -> None:
    """H.264 with colours halved across and down, as players expect; the matrix of Rec. 709 is used, and said."""
    crf = 18 if order.quality is None else round(51.0 - 0.5 * order.quality)
    matrix = ["-vf", "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709", "-color_primaries", "bt709"]
    how = ["-f", "mp4", "-crf", str(crf), *matrix, "-color_trc", "iec61966-2-1", "-movflags", "+faststart"]
    first = next(pictures)
    frame = _even(_over_white(first, order))
    size = frame.shape[1], frame.shape[0]
    writer = _ffmpeg().write_frames(
        os.fspath(part), size, fps=order.fps, codec="libx264", macro_block_size=1, output_params=how, ffmpeg_log_level="error"
    )
    writer.send(None)
    try:
        writer.send(frame)
        for image in pictures:
            writer.send(_even(_over_white(image, order)))
    finally:
        writer.close()


def _even(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The last column and row twice where their number is odd, which halved colours do not allow."""
    height, width = picture.shape[:2]
    return np.ascontiguousarray(np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge"))


def _write_folder(pictures: Iterator[Image], folder: Path, order: _Order) -> None:
    for index, image in enumerate(pictures):
        if index == 0:
            folder.mkdir(parents=True, exist_ok=True)
        image.save(folder / f"{index:04d}.png", view=order.view, exposure=order.exposure)


_APNG = ClipKind("animated PNG", _write_apng, keeps_alpha=True)
_FOLDER = ClipKind("a folder of PNGs", _write_folder, keeps_alpha=True)

KINDS = {
    ".gif": ClipKind("GIF", _write_gif, keeps_alpha=False, greatest_fps=50.0),
    ".webp": ClipKind("WebP", _write_webp, keeps_alpha=True, has_quality=True),
    ".png": _APNG,
    ".apng": _APNG,
    ".mp4": ClipKind("MP4", _write_mp4, keeps_alpha=False, has_quality=True),
}
"""By extension."""
