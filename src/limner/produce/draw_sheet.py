"""A technical drawing of a model: its views in line on a sheet of paper, to scale, with hidden lines, a title block and dimensions.

    sheet = limner.technical_sheet("part.glb", views=("front", "top", "right", "iso"), dimensions=True)
    sheet.save("part.pdf")
    sheet.facts["scale"]                                 "1:2"

Every view is a drawing by a parallel camera of its own (`limner.artistic`), all at one scale: what is measured on the print, times the
scale, is the part. The same scene gives the same bytes; a date stands on the sheet only where it is given.

**Source**: ISO 128-3 (views), 5455 (scales), 5456-2 (first and third angle), 5457 (papers and frames), 7200 (title blocks), 129-1
(dimensions).
"""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..artistic.lines import DEFAULT_KINDS, Drawing, LineKind
from ..artistic.plate import Placing, layers_of
from ..artistic.style import LineStyle, line_style
from ..draw.page import Layer, Mark, Page
from ..errors import SceneError, UnsupportedError
from ..progress import Meter, OnProgress, Progress
from ..scene.camera import OrthographicCamera
from ..scene.framing import extent_points
from ..scene.scene import Scene
from .drawing import Plate, lines_of
from .sheet_layout import Area, Layout, lay_out, paper_size, read_scale, scale_name
from .sheet_marks import TITLE_HEIGHT, dimension, frame_area, frame_marks, label, scale_bar, title_area, title_block

__all__ = ["SHEET_UNITS", "SHEET_VIEWS", "technical_sheet"]

Floats = NDArray[np.float64]

SHEET_VIEWS: Mapping[str, tuple[float, float]] = {
    "front": (0.0, 0.0), "right": (90.0, 0.0), "back": (180.0, 0.0), "left": (270.0, 0.0), "top": (0.0, 90.0), "bottom": (0.0, -90.0),
    "iso": (45.0, math.degrees(math.asin(1.0 / math.sqrt(3.0)))), "iso-left": (-45.0, math.degrees(math.asin(1.0 / math.sqrt(3.0)))),
}  # fmt: skip
"""Azimuth (from +z towards +x) and elevation of each view, degrees."""

SHEET_UNITS: Mapping[str, float] = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "in": 25.4}
"""Millimetres of what a model may be in."""

_ACROSS = {"front": 0, "back": 0, "top": 0, "bottom": 0, "right": 2, "left": 2}
_DOWN = {"front": 1, "right": 1, "left": 1, "back": 1, "top": 2, "bottom": 2}
_FINER = 4.0  # pixels of a view's picture in a millimetre of paper: exact shapes are divided to a tenth of one
_MARGIN = 2.0  # millimetres of paper that a view's picture is larger on all sides than its view
_BAR = 16.0  # millimetres that the scale bar takes of the height
_DISTANCE = 9.0  # of dimension lines to the part


def technical_sheet(
    scene: Any,
    *,
    views: Sequence[str] = ("front", "top", "right", "iso"),
    projection: str = "first",
    paper: str = "A3",
    scale: str | float | None = None,
    unit: str = "m",
    dimensions: bool = False,
    style: LineStyle | str = "technical",
    kinds: Sequence[LineKind] = DEFAULT_KINDS,
    crease_degrees: float = 30.0,
    title: str = "",
    date: str = "",
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Plate:
    """Draw views of a scene on a sheet.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`. Infinite planes are left out.
    views : sequence of str
        "front" (from +z), "back", "left", "right" (from +x), "top" (from +y), "bottom", "iso", "iso-left".
    projection : "first" | "third"
        Where the views stand: as is usual in Europe and Asia, or in America.
    paper : str
        "A4" to "A0", "A4-portrait", "A3-portrait".
    scale : str or float, optional
        "1:2", "5:1" or a number; None: the largest standard scale that fits, or one such as 1:4 where that would leave much empty.
    unit : "m" | "cm" | "mm" | "in"
        Of the model's coordinates.
    dimensions : bool
        Whether the sides of the box round the model are measured, in millimetres.
    style : LineStyle or str
        As for `limner.drawing`.
    kinds, crease_degrees
        As for `limner.drawing`.
    title, date : str
        In the title block; title "": the scene's name.
    on_progress, cancel
        As for `limner.render`.

    Returns
    -------
    Plate
        A page in millimetres. Its facts: scale, paper, projection, unit, size (of the model, mm), views.
    """
    from ..files.interop import as_scene

    chosen, page_size = line_style(style), paper_size(paper)
    _check(views, unit, crease_degrees)
    given = None if scale is None else read_scale(scale)
    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    shown, corners = _bounded(scene)
    unit_mm, frame = SHEET_UNITS[unit], frame_area(*page_size)
    windows = {name: _window(name, corners, shown) for name in views}
    layout = _layout(windows, unit_mm, projection, frame, dimensions, given, paper)
    meter, drawn = Meter(on_progress, "views"), {}
    for index, name in enumerate(views):

        def report(progress: Progress, index: int = index) -> None:
            meter.report(min((index + progress.done) / len(views), 1.0 - 1e-9))

        camera, width, height = _camera(name, windows[name], layout, unit_mm)
        drawn[name] = lines_of(
            shown, camera, width=width, height=height, kinds=kinds, crease_degrees=crease_degrees, hidden=chosen.shows_hidden,
            on_progress=report, cancel=cancel,
        )  # fmt: skip
    meter.report(1.0)
    size = (corners.max(axis=0) - corners.min(axis=0)) * unit_mm
    marks = list(_dimensions(layout, size)) if dimensions else []
    told = {
        "scale": scale_name(layout.scale), "paper": paper, "projection": projection, "unit": unit, "views": list(views),
        "size": size.tolist(), "lines": sum(len(drawing.lines) for drawing in drawn.values()),
    }  # fmt: skip
    name = title or scene.name or "model"
    border = [*frame_marks(frame), *title_block(frame, name, told["scale"], paper, projection, "mm", date)]
    notes = [*(label(layout.areas[view], view) for view in views), *scale_bar(frame.x + 8.0, frame.y + frame.height - 10.0, layout.scale)]
    layers = [*_lines(drawn, layout, chosen), Layer("dimensions", marks), Layer("notes", notes), Layer("border", border)]
    page = Page(*page_size, "mm", tuple(layer for layer in layers if layer.marks), name, (1.0, 1.0, 1.0, 1.0))
    return Plate(page, drawn, told)


def _check(views: Sequence[str], unit: str, crease_degrees: float) -> None:
    if isinstance(views, str) or not views:
        raise UnsupportedError(f'views must be names, as in ("front", "top"), got {views!r}')
    for name in views:
        if name not in SHEET_VIEWS:
            raise UnsupportedError(f"a view must be one of {', '.join(SHEET_VIEWS)}, got {name!r}")
    if len(set(views)) < len(views):
        raise SceneError(f"no view may come twice, got {', '.join(views)}")
    if unit not in SHEET_UNITS:
        raise UnsupportedError(f"unit must be one of {', '.join(SHEET_UNITS)}, got {unit!r}")
    if not 0.0 <= crease_degrees <= 180.0:
        raise SceneError(f"crease_degrees must lie in [0, 180], got {crease_degrees}")


def _bounded(scene: Scene) -> tuple[Scene, Floats]:
    """What has an end, and the (8, 3) corners of the box round it."""
    from .facts import tight_bounds
    from .views import without_planes

    shown, _ = without_planes(scene)
    low, high = tight_bounds(shown)
    if not (low <= high).all() or not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise SceneError("there is nothing to draw: the scene has no visible surface that is bounded")
    if not float((high - low).max()) > 0.0:
        raise SceneError(f"there is nothing to draw: all of the scene is in one point, {tuple(low.tolist())}")
    return shown, np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])


class _Window(NamedTuple):
    """What a view shows: its middle in the world, its width and height, and how far it reaches along the gaze, in the model's unit."""

    middle: Floats
    width: float
    height: float
    reach: float


def _window(name: str, corners: Floats, scene: Scene) -> _Window:
    """Tightly round the model, in a view along an axis by the box round it, in others by its points."""
    azimuth, elevation = SHEET_VIEWS[name]
    axes = OrthographicCamera.orbit((0, 0, 0), 1.0, azimuth, elevation).world_from_camera[:3, :3]
    low, high = _ends(corners @ axes)
    if name.startswith("iso"):
        least, most = _ends(extent_points(scene) @ axes)
        low, high = np.maximum(low, least), np.minimum(high, most)
    width, height, _ = (high - low).tolist()
    return _Window(axes @ ((low + high) / 2.0), width, height, 2.0 * float(np.linalg.norm(np.ptp(corners, axis=0))))


def _ends(points: Floats) -> tuple[Floats, Floats]:
    return points.min(axis=0), points.max(axis=0)


def _layout(
    windows: Mapping[str, _Window], unit_mm: float, projection: str, frame: Area, dimensions: bool, scale: float | None, paper: str
) -> Layout:
    """Views above the title block or beside it, with room for what stands beside them."""
    sizes = {name: (window.width * unit_mm, window.height * unit_mm) for name, window in windows.items()}
    room = _DISTANCE + 6.0 if dimensions else 6.0
    area = frame.inset(room, 10.0, 6.0, TITLE_HEIGHT + room)
    gap = 18.0 + (6.0 if dimensions else 0.0)
    return lay_out(sizes, projection, area, gap, scale, paper, TITLE_HEIGHT - _BAR, title_area(frame))


def _camera(name: str, window: _Window, layout: Layout, unit_mm: float) -> tuple[OrthographicCamera, int, int]:
    """A camera whose picture holds a view and a margin, and the picture's size."""
    area = layout.areas[name]
    width, height = (2 * math.ceil(_FINER * (side / 2.0 + _MARGIN)) for side in (area.width, area.height))
    azimuth, elevation = SHEET_VIEWS[name]
    metres = height / _FINER / layout.scale / unit_mm
    return OrthographicCamera.orbit(window.middle, window.reach, azimuth, elevation, height=metres, name=name), width, height


def _lines(drawn: Mapping[str, Drawing], layout: Layout, style: LineStyle) -> list[Layer]:
    """The layers of each view, which bear its name, so that one may be switched off or moved as a whole."""
    layers = []
    for name, drawing in drawn.items():
        area = layout.areas[name]
        x, y = area.x + area.width / 2.0, area.y + area.height / 2.0
        place = Placing("mm", 1.0 / _FINER, x - drawing.width / _FINER / 2.0, y - drawing.height / _FINER / 2.0)
        layers += [Layer(f"{layer.name}-{name}", layer.marks, (*layer.classes, name)) for layer in layers_of([(drawing, place)], style)]
    return layers


def _dimensions(layout: Layout, size: Floats) -> Iterator[Mark]:
    """Each side of the box once: below the first view that shows it from left to right, or left of the first that shows it upright."""
    done: set[int] = set()
    # The width lies, the height and the depth stand, unless only a view in which they lie is there.
    for wanted, table in (((0,), _ACROSS), ((1, 2), _DOWN), ((0, 1, 2), _ACROSS)):
        for name, axis in table.items():
            if name not in layout.areas or axis in done or axis not in wanted:
                continue
            done.add(axis)
            x, y, width, height = layout.areas[name]
            low = (x, y + height)
            high = (x + width, y + height) if table is _ACROSS else (x, y)
            yield from dimension(low, high, _DISTANCE, _millimetres(float(size[axis])))


def _millimetres(value: float) -> str:
    """A length as a drawing states it: to a hundredth, or to five digits where it is smaller."""
    return f"{value:.2f}".rstrip("0").rstrip(".") if value >= 1.0 else f"{value:.5g}"
