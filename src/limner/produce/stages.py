"""What each stage of the graphics pipeline makes of one model, side by side on a sheet with words and numbers (FoCG 8, 10, 11).

    sheet = limner.stages("model.glb")
    sheet.image.save("stages.png")
    sheet.facts["fragments"], sheet.facts["mip_level"]

    geometry       1 wireframe     2 clipping      3 coverage      4 overdraw
    attributes     5 depth         6 barycentrics  7 normals       8 texture coordinates
    light          9 flat         10 Gouraud      11 Phong        12 mipmap levels
    the picture   13 texture      14 lit          15 antialiasing 16 all together

Every panel shows what the raster pipeline itself has (`limner.raster.stages`), of the same scene, camera and pixels, or a picture that it
renders with later stages left out.
"""

from __future__ import annotations

import threading
from typing import Any, NamedTuple

import numpy as np

from ..errors import SceneError
from ..progress import Meter, OnProgress
from ..scene.camera import Camera
from ..scene.scene import Scene
from .false_color import Ramp, Swatches, along, picture
from .sheet import Canvas, Grid, Stroke, shortened, text_width, wrapped
from .stage_panels import FAINT, INK, PAPER, SHOW, Panel
from .stage_study import Stopped, Study
from .views import Sheet

__all__ = ["STAGES", "stages"]

_LEAST_WIDTH, _LEAST_HEIGHT, _GREATEST_SIDE = 320, 160, 1600
_SAMPLES = 16
_COLUMNS = 4


class Stage(NamedTuple):
    """What a panel shows.

    Attributes
    ----------
    name : str
        In the facts.
    title, section, words : str
        On the sheet: what it is, where the book has it, what is to be seen.
    """

    name: str
    title: str
    section: str
    words: str


STAGES = (
    Stage(
        "wireframe", "Wireframe", "8.1.1",
        "Vertices go through the camera's matrices to the screen, and edges join them. Faint: what nearer surfaces hide.",
    ),
    Stage(
        "clipping", "Clipping", "8.1.4, 8.1.6",
        "Triangles that cross the frame are cut along it, and the pieces are triangles again. What lies outside goes no further.",
    ),
    Stage(
        "coverage", "Coverage", "8.1.2, 8.3",
        "Of 16 points in each pixel, how many lie inside a triangle? Outlines run through pixels that are covered in part.",
    ),
    Stage(
        "overdraw", "Overdraw", "8.2.3",
        "How many triangles cover the middle of each pixel. All of them become fragments, and the z-buffer keeps the nearest.",
    ),
    Stage(
        "depth", "Depth", "8.2.3",
        "How far each pixel's surface lies along the gaze, in equal steps of what the z-buffer holds and compares.",
    ),
    Stage(
        "barycentrics", "Barycentric coordinates", "8.1.2",
        "How much each of the triangle's three vertices counts in each pixel. All that follows is interpolated by them.",
    ),
    Stage(
        "normals", "Normals", "10.2.2",
        "The surface's direction, interpolated between vertices: x, y and z of the world as red, green and blue.",
    ),
    Stage(
        "uv", "Texture coordinates", "11.1",
        "Where in the texture each pixel looks: u as red, v as green. Eight checks to a unit show where the mapping stretches.",
    ),
    Stage(
        "flat", "Flat shading", "10.1.1",
        "Light is computed once for each triangle, with the triangle's own normal: every facet is seen.",
    ),
    Stage(
        "gouraud", "Gouraud shading", "8.2.4, 10.1.3",
        "Light is computed at the vertices, and its colours are interpolated: a highlight inside a triangle is lost.",
    ),
    Stage(
        "phong", "Phong shading", "8.2.5, 10.2.2",
        "Normals are interpolated, and light is computed in each pixel: highlights are round, whatever the triangles.",
    ),
    Stage(
        "mip_level", "Mipmap level", "11.3.3",
        "How often the texture is halved until its texels are as large as the pixel. Level 0 is the texture itself.",
    ),
    Stage(
        "texture", "Texture", "11.3",
        "The base colour, looked up where panel 8 says and filtered as panel 12 says. There is no light yet.",
    ),
    Stage(
        "lit", "Textured and lit", "8.2.6",
        "Material and light together, looked at in the middle of each pixel only: outlines are stairs.",
    ),
    Stage(
        "antialiasing", "Antialiasing", "8.3",
        "The frame of panel 14, enlarged. Left: one sample in each pixel. Right: the mean of several.",
    ),
    Stage(
        "picture", "The picture", "8",
        "All stages and all samples, before the background that the scene has: what a renderer hands over.",
    ),
)  # fmt: skip
"""In the order of the sheet."""


def stages(
    scene: Any,
    *,
    width: int = 400,
    height: int | None = None,
    camera: Camera | None = None,
    samples: int = _SAMPLES,
    title: str = "",
    threads: int | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Sheet:
    """Make a contact sheet of the stages of the graphics pipeline.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`.
    width : int from 320 to 1600
        Of each panel, pixels.
    height : int from 160 to 1600, optional
        None: three quarters of the width.
    camera : Camera, optional
        None: the scene's `camera`; where it has none, one that frames everything, so that the panels are full.
    samples : int from 2 to 64
        Of each pixel of the finished picture.
    title : str
        On the sheet; "": the scene's name.
    threads, on_progress, cancel
        As for `limner.render`.

    Returns
    -------
    Sheet
        Its ``facts``, plain values that JSON can hold: ``vertices``, ``triangles``, ``screen_triangles`` that clipping and culling leave,
        ``fragments`` (of pixel centres), ``pixels`` in which anything is seen, ``partly_covered`` pixels, ``overdraw`` and ``depth``
        (least, mean, greatest; metres), ``mip_level`` (least, greatest) or None, ``clipping`` (``zoom`` of the panel, ``whole``, ``cut``
        and ``pieces`` of triangles in its frame), ``panels`` (name, FoCG section, cell: left, top, width, height), ``notes``, ``warnings``.
    """
    _check_whole("width", width, _LEAST_WIDTH, _GREATEST_SIDE)
    tall = round(0.75 * width) if height is None else height
    _check_whole("height", tall, _LEAST_HEIGHT, _GREATEST_SIDE)
    _check_whole("samples", samples, 2, 64)
    from ..files.interop import as_scene

    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    study = Study(scene, camera, int(width), int(tall), int(samples), threads, cancel)
    draft = _Draft(study.width, study.height, title or scene.name or "model")
    meter, cells = Meter(on_progress, "stages"), []
    meter.report(0.0)
    try:
        for index, (stage, show) in enumerate(zip(STAGES, SHOW, strict=True)):
            cells.append({"name": stage.name, "section": stage.section, "cell": draft.panel(index, stage, show(study))})
            meter.report(min((index + 1) / len(STAGES), 1.0 - 1e-9))
    except Stopped:
        return Sheet(draft.canvas.image(finished=False), {"panels": cells, "notes": [], "warnings": []}, finished=False)
    told = study.facts() | {"panels": cells}
    draft.head(told)
    meter.report(1.0)
    return Sheet(draft.canvas.image(recipe=study.picture.recipe, warnings=tuple(told["warnings"])), told)


def _check_whole(name: str, value: int, least: int, most: int) -> None:
    if not hasattr(value, "__index__") or isinstance(value, bool) or not least <= value <= most:
        raise SceneError(f"{name} must be an integer from {least} to {most}, got {value!r}")


# --- the sheet ------------------------------------------------------------------------------------------------------------


def _balanced(words: str, size: int, width: float) -> list[str]:
    """The words in as few lines as they need, all about as long."""
    lines = wrapped(words, size, width)
    narrower = width
    while len(lines) > 1 and narrower > 0.5 * width and len(wrapped(words, size, narrower - size)) == len(lines):
        narrower -= size
    return wrapped(words, size, narrower)


class _Draft:
    """The sheet on its way: a head, and panels with a title, a sentence, and a line with a key and a number."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self._width, self._height, self._title = width, height, title
        self._large, self._small = max(13, round(width / 25)), max(10, round(width / 33))
        self._line = round(1.35 * self._small)
        self._caption = round(1.9 * self._large) + 2 * self._line + round(2.0 * self._small)
        gap = max(12, width // 18)
        self._grid = Grid(_COLUMNS, -(-len(STAGES) // _COLUMNS), width, height + self._caption, gap)
        self._top = round(5.2 * self._large)
        self.canvas = Canvas(self._grid.size[0], self._grid.size[1] + self._top, PAPER)

    def panel(self, index: int, stage: Stage, shown: Panel) -> list[int]:
        """Draw a panel; its picture's left, top, width and height."""
        x, y = self._grid.corner(index)
        y += self._top
        self.canvas.picture(x, y, shown.image)
        large, small = self._large, self._small
        at = y + self._height + round(0.55 * large)
        count = f"{index + 1}"
        self.canvas.text(x, at, count, size=large, color=FAINT)
        self.canvas.text(x + text_width(count, large) + 0.5 * large, at, stage.title, size=large, color=INK)
        self.canvas.text(x + self._width, at + large - small, f"FoCG {stage.section}", size=small, color=FAINT, anchor="ra")
        at += round(1.35 * large)
        for line in _balanced(stage.words, small, self._width):
            self.canvas.text(x, at, line, size=small, color=FAINT)
            at += self._line
        self._foot(x, y + self._height + self._caption - round(0.9 * small), shown)
        return [x, y, self._width, self._height]

    def _foot(self, x: int, y: int, shown: Panel) -> None:
        """The key on the left, the measure on the right, their middle at y."""
        small = self._small
        right = float(x)
        if isinstance(shown.key, Ramp):
            right = self._ramp(x, y, shown.key)
        elif isinstance(shown.key, Swatches):
            right = self._swatches(x, y, shown.key)
        if shown.key is None:
            self.canvas.text(x, y, shortened(shown.measure, small, self._width), size=small, color=INK, anchor="lm")
        elif right + small + text_width(shown.measure, small) <= x + self._width:
            self.canvas.text(x + self._width, y, shown.measure, size=small, color=INK, anchor="rm")

    def _ramp(self, x: float, y: float, key: Ramp) -> float:
        small = self._small
        width, height = round(0.24 * self._width), round(0.8 * small)
        self.canvas.text(x, y, key.low, size=small, color=INK, anchor="lm")
        left = round(x + text_width(key.low, small) + 0.5 * small)
        bar = along(np.broadcast_to(np.arange(width), (height, width)), 0.0, width - 1.0, key.stops)
        self.canvas.picture(left, round(y - height / 2), picture(bar, np.ones((height, width), dtype=bool)))
        self.canvas.text(left + width + 0.5 * small, y, key.high, size=small, color=INK, anchor="lm")
        return left + width + 0.5 * small + text_width(key.high, small)

    def _swatches(self, x: float, y: float, key: Swatches) -> float:
        small = self._small
        side = round(0.8 * small)
        for color, word in key.entries:
            self.canvas.box(x, y - side / 2, side, side, color)
            self.canvas.text(x + side + 0.4 * small, y, word, size=small, color=INK, anchor="lm")
            x += side + 0.4 * small + text_width(word, small) + 0.9 * small
        return x - 0.9 * small

    def head(self, told: dict[str, Any]) -> None:
        """The title, and how much goes from one stage to the next."""
        gap, large = self._grid.gap, self._large
        title = round(1.6 * large)
        words = f"The graphics pipeline, stage by stage: {self._title}"
        width = self._grid.size[0] - 2 * gap
        self.canvas.text(gap, gap, shortened(words, title, width), size=title, color=INK)
        steps = (
            ("vertices", "vertices"), ("triangles", "triangles"), ("screen_triangles", "on the screen"), ("fragments", "fragments"),
            ("pixels", "pixels seen"),
        )  # fmt: skip
        x, y = float(gap), gap + 2.75 * large
        for index, (name, word) in enumerate(steps):
            if index:
                x = self._arrow(x, y)
            count = f"{told[name]:,}"
            self.canvas.text(x, y, count, size=large, color=INK, anchor="lm")
            x += text_width(count, large) + 0.35 * large
            self.canvas.text(x, y, word, size=large, color=FAINT, anchor="lm")
            x += text_width(word, large)

    def _arrow(self, x: float, y: float) -> float:
        large = self._large
        start, end, wing = x + 0.8 * large, x + 2.2 * large, 0.28 * large
        width = max(1.2, large / 12)
        y += 0.06 * large
        self.canvas.lines(
            [
                Stroke([(start, y), (end, y)], FAINT, width),
                Stroke([(end - wing, y - wing), (end, y), (end - wing, y + wing)], FAINT, width),
            ]
        )
        return end + 0.8 * large
