"""A picture of every model in a folder.

    batch = limner.thumbnails("models", "thumbs", size=256, recursive=True)
    [item.source for item in batch.items if item.error]

    models/car.glb          thumbs/car.glb.png
    models/parts/nut.stl    thumbs/parts/nut.stl.png       the name with its extension: car.glb and car.obj do not meet

One model after the other is read, drawn and forgotten, so memory is that of the largest. One that fails is told of and does not stop
the rest. Whatever happens, each picture is whole or not there.
"""

from __future__ import annotations

import gc
import os
import threading
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..color.decode_table import SRGB_DECODE
from ..color.views import checked_exposure, checked_view
from ..errors import LimnerError, RenderError, SceneError, UnsupportedError
from ..image.image import Image
from ..progress import Meter, OnProgress
from .sheet import Canvas, Grid, Rgb, grid_for, shortened, wrapped

__all__ = ["Batch", "Thumbnail", "index_sheet", "models_in", "thumbnails"]

_LEAST_SIZE, _GREATEST_SIZE = 16, 4096
_MOST_SHEET_PIXELS = 1 << 24
_LARGEST_CELL, _SMALLEST_CELL = 256, 24
_LONGEST = 300  # characters of an error that nobody wrote for people
_BLANK = 0.0005  # of the pixels: less is nothing, or a speck

_PAPER: Rgb = (246, 247, 248)
_GROUND: Rgb = (188, 194, 201)
_INK: Rgb = (34, 38, 43)
_ALARM: Rgb = (160, 24, 34)

Status = Literal["made", "kept", "failed"]


@dataclass(frozen=True)
class Thumbnail:
    """What became of one model.

    Parameters
    ----------
    source : Path
    path : Path
        Of the picture; there is none where `status` is "failed", unless one was there before.
    status : "made" | "kept" | "failed"
    error : str
        One line; empty unless it failed.
    warning : str
        A likely slip, such as that nothing is seen; empty where there is none.
    seconds : float
    """

    source: Path
    path: Path
    status: Status
    error: str = ""
    warning: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Batch:
    """What became of a folder.

    Parameters
    ----------
    items : tuple of Thumbnail
        In the order of their paths.
    finished : bool
        False: stopped by the user; those that are there are whole.
    """

    items: tuple[Thumbnail, ...] = ()
    finished: bool = True

    def count(self, status: Status) -> int:
        """How many were made, kept, or failed."""
        return sum(item.status == status for item in self.items)


def models_in(folder: str | os.PathLike[str], *, recursive: bool = False) -> list[Path]:
    """The files in a folder whose extension is a model's, by name; hidden ones, and folders that links lead to, are passed over.

    Raises SceneError where there is no such folder.
    """
    from ..files.load import EXTENSIONS

    top = Path(folder)
    if not top.is_dir():
        raise SceneError(f"{top} is no folder" if top.exists() else f"there is no folder {top}")
    found: list[Path] = []
    for place, folders, names in os.walk(top):
        folders[:] = sorted(name for name in folders if not name.startswith(".")) if recursive else []
        found += [Path(place) / name for name in names if not name.startswith(".") and Path(name).suffix.lower() in EXTENSIONS]
    return sorted(path for path in found if path.is_file())


def thumbnails(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    size: int = 256,
    recursive: bool = False,
    update: bool = False,
    renderer: str = "raster",
    background: Any = None,
    view: str = "standard",
    exposure: float = 0.0,
    up: str = "y",
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
    **options: Any,
) -> Batch:
    """Make a picture of every model in a folder.

    Parameters
    ----------
    folder : path
    output : path
        A folder; is made where it is not there. Sub-folders are as in `folder`.
    size : int from 16 to 4096
        Width and height, pixels.
    recursive : bool
        Look into sub-folders, too.
    update : bool
        Keep pictures that are newer than their models and of the right size. Files that a model refers to do not count.
    renderer : "raster" | "ray" | "path"
    background : three floats >= 0 or None
        In place of that of scenes that have none; None: transparent.
    view, exposure
        As for `limner.Image.save`.
    up : "y" | "z"
        Which axis of the files points up, as for `limner.load`.
    on_progress : callable, optional
    cancel : threading.Event, optional
        Set it to stop; so does a KeyboardInterrupt.
    **options
        As for `limner.render`: samples, seed, threads, ….

    Returns
    -------
    Batch

    Raises
    ------
    SceneError
        No folder, no model in it, or a size that is none.
    RenderError
        Nothing can be written in `output`.
    """
    if isinstance(size, bool) or not hasattr(size, "__index__") or not _LEAST_SIZE <= size <= _GREATEST_SIZE:
        raise SceneError(f"size must be an integer from {_LEAST_SIZE} to {_GREATEST_SIZE}, got {size!r}")
    sources = models_in(folder, recursive=recursive)
    if not sources:
        deeper = "" if recursive else "; its sub-folders were not looked into"
        raise SceneError(f"there is no model in {os.fspath(folder)}{deeper}")
    from ..render import Renderer

    # What is wrong with the options is wrong for all: say it once, before anything is read.
    Renderer(_nothing(), width=size, height=size, renderer=renderer, **options).close()
    saving = {"view": checked_view(view), "exposure": checked_exposure(exposure)}
    work = _Work(Path(folder), Path(output), int(size), update, background, {"renderer": renderer, **options}, saving, up)
    meter, items = Meter(on_progress, "thumbnails"), []
    finished = True
    try:
        for index, source in enumerate(sources):
            meter.report(index / len(sources))
            made = None if cancel is not None and cancel.is_set() else work.one(source, cancel)
            if made is None:
                finished = False
                break
            items.append(made)
            gc.collect(0)  # a scene and its film can refer to themselves; the collector counts objects, not the megabytes in them
    except KeyboardInterrupt:
        finished = False
    if finished:
        meter.report(1.0)
    return Batch(tuple(items), finished)


def _nothing() -> Any:
    from ..scene.scene import Scene

    return Scene()


@dataclass(frozen=True)
class _Work:
    folder: Path
    output: Path
    size: int
    update: bool
    background: Any
    options: dict[str, Any]
    saving: dict[str, Any]
    up: str

    def one(self, source: Path, cancel: threading.Event | None) -> Thumbnail | None:
        """Make the picture of one model; None: it was stopped."""
        place = self.output / source.relative_to(self.folder)
        path = place.with_name(place.name + ".png")
        if self.update and _is_fresh(path, source, self.size):
            return Thumbnail(source, path, "kept")
        started = time.perf_counter()
        try:
            image = self._drawn(source, cancel)
            if not image.finished:
                return None
        except Exception as error:  # whatever is wrong with one model is not wrong with the next
            return Thumbnail(source, path, "failed", error=_line(error, source), seconds=time.perf_counter() - started)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RenderError(f"cannot write in {path.parent}: {error.strerror or error}") from error
        image.save(path, **self.saving)
        blank = float((image.pixels[..., 3] > 1.0 / 255.0).mean()) < _BLANK
        warning = "nothing is seen" if blank else next((slip for slip in image.warnings if "not finite" in slip), "")
        return Thumbnail(source, path, "made", warning=warning, seconds=time.perf_counter() - started)

    def _drawn(self, source: Path, cancel: threading.Event | None) -> Image:
        from ..files.load import load
        from ..render import Renderer
        from ..scene.framing import extent_points, framing_camera

        scene = load(source, up=self.up)
        if scene.background is None and self.background is not None:
            scene = scene.replace(background=self.background)
        # Its own camera may show whatever its maker liked; a thumbnail shows what it is.
        camera = framing_camera(extent_points(scene), 1.0, yfov_degrees=30.0)
        with Renderer(scene, width=self.size, height=self.size, **self.options) as renderer:
            return renderer.render(camera, cancel=cancel)


def _is_fresh(path: Path, source: Path, size: int) -> bool:
    """Whether a picture is younger than its model and of the right size."""
    try:
        with path.open("rb") as file:
            head = file.read(24)
        young = path.stat().st_mtime_ns >= source.stat().st_mtime_ns
    except OSError:
        return False
    return young and head[:8] == b"\x89PNG\r\n\x1a\n" and head[16:24] == size.to_bytes(4, "big") * 2


def _line(error: Exception, source: Path) -> str:
    """What went wrong, on one line, without the file that is named beside it anyway."""
    said = str(error) or ("not enough memory" if isinstance(error, MemoryError) else "failed")
    if not isinstance(error, (LimnerError, OSError, MemoryError)):
        said = f"{said[:_LONGEST]} ({type(error).__name__}, not foreseen)"
    said = said.removeprefix(os.fspath(source)).removeprefix(": ").removeprefix(", ")
    return " ".join(said.split())


# --- all on one sheet -----------------------------------------------------------------------------------------------------


def index_sheet(batch: Batch) -> Image:
    """All pictures of a batch on one contact sheet, each with its name; those that failed, with the reason.

    Cells shrink as they become many, so that the sheet stays below 16 million pixels. Raises SceneError where there is nothing to show, and
    UnsupportedError for more than fit (about 20 000).
    """
    if not batch.items:
        raise SceneError("a contact sheet needs at least one picture")
    cell, letters, caption, grid = _layout(len(batch.items))
    canvas = Canvas(*grid.size, _PAPER)
    names = _names(batch)
    for index, item in enumerate(batch.items):
        x, y = grid.corner(index)
        canvas.box(x, y, cell, cell, _GROUND)
        image = None if item.status == "failed" else _shrunk(item.path, cell)
        if image is not None:
            canvas.picture(x + (cell - image.width) // 2, y + (cell - image.height) // 2, image)
        else:
            lines = wrapped(item.error or "there is no picture", letters, cell - letters)
            for k, line in enumerate(lines[: max(1, cell // (letters + 3) - 1)]):
                canvas.text(x + letters // 2, y + letters // 2 + k * (letters + 3), line, size=letters, color=_ALARM)
        name = shortened(names[index], letters, cell)
        canvas.text(x + cell / 2, y + cell + caption / 2, name, size=letters, color=_ALARM if item.error else _INK, anchor="mm")
    return canvas.image(finished=batch.finished)


def _names(batch: Batch) -> list[str]:
    """The name of each file; where several are called the same, with its folder's."""
    names = [item.source.name for item in batch.items]
    seen = Counter(names)
    return [name if seen[name] == 1 else f"{item.source.parent.name}/{name}" for name, item in zip(names, batch.items, strict=True)]


def _layout(n: int) -> tuple[int, int, int, Grid]:
    """Sides of pictures, letters and captions, pixels, and the grid: the largest that is not too large."""
    for cell in range(_LARGEST_CELL, _SMALLEST_CELL - 1, -8):
        letters = max(9, cell // 16)
        caption = round(1.7 * letters)
        grid = grid_for(n, cell, cell + caption, max(3, cell // 24), 16.0 / 10.0)
        if grid.size[0] * grid.size[1] <= _MOST_SHEET_PIXELS:
            return cell, letters, caption, grid
    raise UnsupportedError(f"a contact sheet holds no {n} pictures; leave it out, or make one for each sub-folder")


def _shrunk(path: Path, size: int) -> Image | None:
    """A picture that fits into a square, averaged in linear light; None where it cannot be read."""
    try:
        encoded = _read(path)
    except OSError:
        return None
    alpha = encoded[..., 3:] / np.float32(255.0)
    image = Image(np.concatenate([SRGB_DECODE[encoded[..., :3]], alpha], axis=2))
    if image.width <= size and image.height <= size:
        return image
    scale = size / max(image.width, image.height)
    return image.resized(max(1, round(image.width * scale)), max(1, round(image.height * scale)))


def _read(path: Path) -> Any:
    from PIL import Image as pillow  # noqa: N813 - the module

    with pillow.open(path) as picture:
        return np.asarray(picture.convert("RGBA"))
