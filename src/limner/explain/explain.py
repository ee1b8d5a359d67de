"""Why does this pixel look like that?

    told = limner.explain("teapot", 400, 300, renderer="ray")
    print(told.text())
    told.save("pixel.html")                    # a page with pictures; .json and .txt, too

The scene is prepared as for a picture. The compiled kernel is then called for one pixel, sample by sample, which gives the very bits of the
picture; and once more, in a process of its own, as Python with every call written down (`limner.explain.child`). What that finds must
be the same, to the bit, and is told as a tree.

    sample s of n                      what the compiled kernel found, and added to the film
    └─ tree of rays | path | fragments     the kernels' own calls: arguments, results, formulas, where these come from
    the pixel                          the sum of the samples over n
"""

from __future__ import annotations

import inspect
import json
import os
import pickle
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._door import DoorCall, witnessed
from .._jit import MODE
from ..errors import RenderError, SceneError, UnsupportedError
from ..image.png import png_bytes
from ..raster.layouts import SUBPIXELS
from ..render import Frame, Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..tables.build import names as names_of
from ..tiles import Tile, is_whole
from .drawing import drawing_of
from .parameters import parameters_of
from .request import Request
from .spaces import triangle_in_every_space
from .story import Step
from .values import shortest

__all__ = ["Explanation", "explain"]

_SUFFIXES = (".txt", ".json", ".html")
_AT_ONCE = 8  # samples that the rasteriser takes together
_THUMBNAIL = 320
_MOST_LOBES = 6
_MOST_TOLD = 64  # samples that are told of in full
_OF_WHOLE_PICTURES = {
    "denoise": "leave it out, and told is the light before the noise is taken out", "noise": "give samples instead",
    "time_limit": "give samples instead", "checkpoint": "leave it out",
}  # fmt: skip


@dataclass(frozen=True)
class Explanation:
    """The story of one pixel.

    Attributes
    ----------
    x, y : int
        Column, and row from the top.
    width, height : int
        Of the picture.
    renderer : str
    samples : int
    pixel : (4,) float32
        What `render` stores there: linear, straight alpha.
    contributions : (n, 4) float32
        What each sample, or each group of samples that is taken at once, adds to the film: premultiplied.
    told : tuple of int
        Which of the contributions are told of in full.
    story : Step
    is_exact : bool
        Whether the traced kernels found the bits of the compiled ones in all that is told.
    drawing : dict
        What pictures of it are made of: rays, triangles, lobes, boxes; see `limner.explain.drawing`.
    scene : Scene
        With the camera that it was seen by.
    options : dict
        Of `render`, as asked for.
    """

    x: int
    y: int
    width: int
    height: int
    renderer: str
    samples: int
    pixel: NDArray[np.float32]
    contributions: NDArray[np.float32]
    told: tuple[int, ...]
    story: Step
    is_exact: bool
    drawing: dict[str, Any]
    scene: Scene
    options: dict[str, Any]

    def text(self, depth: int | None = None) -> str:
        """The tree as lines, down to some depth."""
        return self.story.text(depth)

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold; float32 as the shortest numbers that are read as the same."""
        return {
            "x": self.x, "y": self.y, "width": self.width, "height": self.height, "renderer": self.renderer, "samples": self.samples,
            "pixel": [shortest(value) for value in self.pixel],
            "contributions": [[shortest(value) for value in row] for row in self.contributions],
            "told": list(self.told), "is_exact": self.is_exact, "story": self.story.as_dict(),
        }  # fmt: skip

    def json(self) -> str:
        """The same as JSON."""
        return json.dumps(self.as_dict(), ensure_ascii=False)

    def html(self) -> str:
        """A page with the tree and pictures, which needs nothing beside it."""
        from .page import page

        return page(self)

    def thumbnail(self) -> bytes | None:
        """The picture as a small PNG; None where kernels run as Python, which would take too long."""
        if MODE != "compiled":
            return None
        scale = min(1.0, _THUMBNAIL / max(self.width, self.height))
        width, height = max(1, round(self.width * scale)), max(1, round(self.height * scale))
        options = {**self.options, "width": width, "height": height, "samples": min(self.samples, 4)}
        with Renderer(self.scene, **options) as renderer:
            return png_bytes(renderer.render().to_uint8())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as .html, .json or .txt, as the name says.

        Raises
        ------
        UnsupportedError
            For other names.
        """
        target = Path(path)
        suffix = target.suffix.lower()
        if suffix not in _SUFFIXES:
            raise UnsupportedError(f"an explanation is saved as {', '.join(_SUFFIXES)}, got {os.fspath(path)!r}")
        content = {".html": self.html, ".json": self.json, ".txt": self.text}[suffix]()
        part = target.with_name(f".{target.name}.{os.getpid()}.part")
        try:
            part.write_text(content + ("" if content.endswith("\n") else "\n"), encoding="utf-8")
            os.replace(part, target)
        except OSError as error:
            part.unlink(missing_ok=True)
            raise RenderError(f"{os.fspath(path)} cannot be written: {error.strerror or error}") from None


def explain(
    scene: Any, x: int, y: int, *, camera: Camera | None = None, sample: int | str | None = None, **options: Any
) -> Explanation:
    """Tell how a pixel came about: every step of the renderer's own kernels, with numbers, formulas and their sources.

    Parameters
    ----------
    scene : Scene, path, or what else `render` takes
    x, y : int
        Column, and row from the top.
    camera : Camera, optional
        In place of the scene's own.
    sample : int or "all", optional
        Which of the pixel's samples is told of in full. None: by `raster` all, up to 64; else the one that is most like the pixel.
    **options
        Of `render`: width, height, renderer, samples, seed, …; they say of which picture it is a pixel.

    Returns
    -------
    Explanation
        Its `pixel` has the bits that `render` stores.

    Raises
    ------
    SceneError
        Where there is no such pixel or sample, beside what `render` raises.
    UnsupportedError
        For options by which a pixel depends on others, or on how long the picture took: denoise, noise, time_limit.
    """
    _check_options(options)
    with Renderer(scene, threads=1, **options) as renderer:
        settings = inspect.signature(Renderer).bind(scene, **options)
        settings.apply_defaults()
        asked = settings.arguments
        width, height = int(asked["width"]), int(asked["height"])
        _check_pixel(x, y, width, height)
        with witnessed() as calls:
            frame = renderer.prepared(camera)
            i, j = int(x), height - 1 - int(y)
            ranges = _ranges(calls, frame, renderer.samples, i, j)
            contributions = _contributions(calls, frame, ranges, i, j)
        pixel = _developed(frame, [contribution.sums for contribution in contributions], ranges[-1][1], i, j)
    told = _told(sample, contributions, ranges, asked["renderer"])
    made = [(k, call) for k in told if (call := contributions[k].call) is not None]
    answers = dict(zip([k for k, _ in made], _traced(frame, [call for _, call in made], i, j), strict=True))
    exact = {k: _same_bits(answers[k]["film"], contributions[k].sums) for k in answers}
    steps = [_sample_step(k, ranges, contributions[k].sums, answers.get(k), exact.get(k)) for k in range(len(ranges))]
    told_steps, others = [steps[k] for k in told], [step for k, step in enumerate(steps) if k not in told]
    if not made:
        told_steps = [Step("nothing touches the part of the picture in which this pixel lies: the film stays clear", kind="note")]
    screen = _screen_triangles(contributions[0].call)
    spaces = triangle_in_every_space(frame, [step for sample in told_steps for step in sample.steps], width, height, screen)
    if others:
        told_steps.append(Step("the other samples, of which only the sum is told", kind="note", steps=others))
    story = _story(x, y, asked["renderer"], pixel, ranges[-1][1], told_steps, spaces, frame)
    sums = np.array([contribution.sums for contribution in contributions], dtype=np.float32)
    return Explanation(
        int(x), int(y), width, height, asked["renderer"], ranges[-1][1], pixel, sums, tuple(told), story, all(exact.values()),
        drawing_of(frame, story, [lobe for k in answers for lobe in answers[k]["lobes"]][:_MOST_LOBES]),
        renderer.scene.replace(camera=frame.camera), dict(options),
    )  # fmt: skip


@dataclass(frozen=True)
class _Contribution:
    """What the compiled kernel added to the film, and how it was called; None: nothing touches the pixel's tile, and it was not."""

    call: DoorCall | None
    sums: NDArray[np.float32]


def _check_options(options: Mapping[str, Any]) -> None:
    """Refuse what makes a pixel depend on more than itself."""
    for name, instead in _OF_WHOLE_PICTURES.items():
        if options.get(name) is not None:
            raise UnsupportedError(f"explain tells of one pixel, and {name} looks at whole pictures: {instead}")


def _check_pixel(x: int, y: int, width: int, height: int) -> None:
    for name, value, end in (("x", x, width), ("y", y, height)):
        if not is_whole(value) or not 0 <= value < end:
            raise SceneError(f"{name} must be an integer from 0 to {end - 1} in a picture of {width} x {height}, got {value!r}")


def _ranges(calls: list[DoorCall], frame: Frame, samples: int, i: int, j: int) -> list[tuple[int, int]]:
    """The samples in the groups in which the kernel takes them: the rasteriser's multisamples eight by eight, else one by one."""
    before = len(calls)
    frame.work(_one_pixel(frame, i, j), 0, 1)
    named = dict(zip(_parameters(calls[-1]), calls[-1].arguments, strict=False)) if len(calls) > before else {}
    step = _AT_ONCE if named.get("multisample") and not named.get("has_blend") else 1
    return [(first, min(first + step, samples)) for first in range(0, samples, step)]


def _contributions(calls: list[DoorCall], frame: Frame, ranges: Sequence[tuple[int, int]], i: int, j: int) -> list[_Contribution]:
    found = []
    tile = _one_pixel(frame, i, j)
    for first, last in ranges:
        frame.film.sums[j, i] = 0.0
        before = len(calls)
        frame.work(tile, first, last)
        found.append(_Contribution(calls[-1] if len(calls) > before else None, frame.film.sums[j, i].copy()))
    frame.film.sums[j, i] = 0.0
    return found


def _one_pixel(frame: Frame, i: int, j: int) -> Tile:
    """The pixel as a tile, with the number of the tile in which it lies: the triangles that may touch it are listed under that."""
    number = next(
        tile.number for tile in frame.film.tiles
        if 0 <= i - tile.first_column < tile.columns and 0 <= j - tile.first_row < tile.rows
    )  # fmt: skip
    return Tile(number, i, j, 1, 1)


def _developed(frame: Frame, sums: Sequence[NDArray[np.float32]], samples: int, i: int, j: int) -> NDArray[np.float32]:
    """The pixel as it is stored: the film's own sum, in its order, and its own development."""
    tile = _one_pixel(frame, i, j)

    def add(_: Tile, first: int, last: int) -> None:
        for part in sums:
            frame.film.sums[j, i] += part

    frame.film.expose(tile, add, 0, samples)
    pixels, develop, _ = frame.film.developing()
    develop(tile)
    return pixels[len(pixels) - 1 - j, i].copy()


def _told(sample: int | str | None, contributions: Sequence[_Contribution], ranges: Sequence[tuple[int, int]], renderer: str) -> list[int]:
    """Which of the contributions are told of."""
    samples = ranges[-1][1]
    if sample == "all" or (sample is None and renderer == "raster"):
        return list(range(len(ranges)))[:_MOST_TOLD]
    if sample is None:
        sums = np.array([contribution.sums for contribution in contributions], dtype=np.float64)
        return [int(np.argmin(np.abs(sums - sums.mean(axis=0)).sum(axis=1)))]
    if not is_whole(sample) or not 0 <= int(sample) < samples:
        raise SceneError(f'sample must be "all" or an integer from 0 to {samples - 1}, got {sample!r}')
    return [next(k for k, (first, last) in enumerate(ranges) if first <= int(sample) < last)]


# --- the other process ----------------------------------------------------------------------------------------------------


def _parameters(call: DoorCall) -> tuple[str, ...]:
    return parameters_of(f"{call.module}.{call.function}")


def _traced(frame: Frame, calls: Sequence[DoorCall], i: int, j: int) -> list[dict[str, Any]]:
    """What the traced kernel finds where the compiled one was called, call by call."""
    if not calls:
        return []
    request = _request(frame, calls, i, j)
    package = str(Path(__file__).resolve().parents[2])
    places = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "LIMNER_MODE": "traced", "PYTHONPATH": os.pathsep.join(places)}
    done = subprocess.run(
        [sys.executable, "-m", "limner.explain.child"], input=pickle.dumps(request, protocol=5), capture_output=True, env=environment,
        check=False,
    )  # fmt: skip
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise RenderError(f"the pixel could not be traced: {lines[-1] if lines else f'exit code {done.returncode}'}")
    told: list[dict[str, Any]] = json.loads(done.stdout)
    return told


def _request(frame: Frame, calls: Sequence[DoorCall], i: int, j: int) -> Request:
    call = calls[0]
    arguments, film = list(call.arguments), _film_of(frame, call)
    arguments[film] = call.arguments[film].shape
    tables = frame.built.tables
    named = names_of(frame.scene)
    lights = tuple(light.name or placed.path for placed, light in frame.scene.lights())
    told = {"instance": (tables.instances, named["instance_id"]), "material": (tables.materials, named["material_id"])}
    told |= {"light": (tables.lights, lights), "texture": (tables.textures, _texture_names(frame))}
    places = {
        kind: (place, names) for kind, (table, names) in told.items() for place, value in enumerate(arguments)
        if isinstance(value, np.ndarray) and value.dtype == table.dtype
    }  # fmt: skip
    _leave_out_far_triangles(arguments, _parameters(call), i, j)
    changes = tuple(_changes(call, other) for other in calls)
    return Request(call.module, call.function, tuple(arguments), changes, film, j * frame.film.sums.shape[1] + i, places)


def _changes(call: DoorCall, other: DoorCall) -> dict[int, Any]:
    """Which numbers another call of the same kernel was made with, by their places."""
    pairs = enumerate(zip(call.arguments, other.arguments, strict=True))
    return {place: new for place, (old, new) in pairs if not isinstance(new, np.ndarray) and old != new}


def _film_of(frame: Frame, call: DoorCall) -> int:
    sums = frame.film.sums
    return next(k for k, value in enumerate(call.arguments) if isinstance(value, np.ndarray) and np.shares_memory(value, sums))


def _texture_names(frame: Frame) -> tuple[str, ...]:
    names = [getattr(getattr(texture, "texels", None), "name", "") for texture in frame.built.textures]
    return tuple(names) if len(names) == len(frame.built.tables.textures) else ()


def _screen_triangles(call: DoorCall | None) -> NDArray[np.void] | None:
    """The rasteriser's triangles that may touch the pixel's tile; None where there is no such call."""
    if call is None:
        return None
    named = dict(zip(_parameters(call), call.arguments, strict=False))
    if not {"screen", "binned", "bin_range", "tile"} <= set(named):
        return None
    tile, ranges = int(named["tile"]), named["bin_range"]
    rows: NDArray[np.void] = named["screen"][named["binned"][ranges[tile] : ranges[tile + 1]]]
    return rows


def _leave_out_far_triangles(arguments: list[Any], parameters: Sequence[str], i: int, j: int) -> None:
    """Of the rasteriser's list for the tile, keep what may touch the pixel: in Python every other one costs time and says nothing."""
    places = {name: parameters.index(name) for name in ("screen", "binned", "bin_range", "tile") if name in parameters}
    if len(places) < 4:
        return
    screen, binned, ranges, tile = (arguments[places[name]] for name in ("screen", "binned", "bin_range", "tile"))
    listed = binned[ranges[tile] : ranges[tile + 1]]
    near = np.ones(len(listed), dtype=bool)
    for axis, place in ((0, i), (1, j)):
        near &= screen["low"][listed, axis] <= (place + 4) * SUBPIXELS
        near &= screen["high"][listed, axis] >= (place - 4) * SUBPIXELS
    kept = np.ascontiguousarray(listed[near])
    if not len(kept) and len(listed):
        kept = listed[:1].copy()  # a tile that is touched is drawn by another branch than one that is not
    changed = np.zeros_like(ranges)
    changed[int(tile) + 1 :] = len(kept)
    arguments[places["binned"]], arguments[places["bin_range"]] = kept, changed


def _same_bits(found: Sequence[Any], sums: NDArray[np.float32]) -> bool:
    return np.array([float(value) for value in found], dtype=np.float32).tobytes() == sums.astype(np.float32).tobytes()


# --- the story ------------------------------------------------------------------------------------------------------------


def _sample_step(
    k: int, ranges: Sequence[tuple[int, int]], sums: NDArray[np.float32], answer: dict[str, Any] | None, is_exact: bool | None
) -> Step:
    first, last = ranges[k]
    name = f"sample {first}" if last == first + 1 else f"samples {first} to {last - 1}"
    steps = [] if answer is None else [Step.from_dict(step) for step in answer["steps"]]
    title = f"{name} of {ranges[-1][1]}"
    if is_exact is False:
        title += " (the traced kernels found other bits than the compiled ones)"
    formula = "red, green, blue and alpha that are added to the film"
    return Step(title, {}, [shortest(value) for value in sums], formula, kind="sample", steps=steps)


def _story(
    x: int, y: int, renderer: str, pixel: NDArray[np.float32], samples: int, steps: list[Step], spaces: list[Step], frame: Frame
) -> Step:
    value = [shortest(part) for part in pixel]
    found = "color over alpha" if 0.0 < pixel[3] < 1.0 else "the mean of its samples"
    notes = [Step(message, kind="note") for message in frame.messages]
    title = f"pixel ({x}, {y}) by {renderer}, {samples} samples"
    formula = f"sum over {samples}; {found}, linear light, straight alpha"
    return Step(title, {}, value, formula, "film_kernel.develop_tile", "FoCG 3.2, 8.3, 9.2", "pixel", [*notes, *spaces, *steps])

