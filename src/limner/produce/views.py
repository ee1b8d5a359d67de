"""A model from all sides on one sheet, with its measures: what a reviewer, or a program that cannot turn it, has to see.

    sheet = limner.views(scene)
    sheet.image.save("sheet.png")
    sheet.facts["size"], sheet.facts["warnings"]

        front   right   back    left
        top     bottom  corner  facts

Six views along the axes at one scale, one from the corner, and what can be said in words. Each shows the world's axes, and the box round
the model with its measures. The pictures are looked at, too: one in which nothing is seen, or all is black, is told of.
"""

from __future__ import annotations

import dataclasses
import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from ..progress import Meter, OnProgress, Progress
from ..scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from ..scene.node import Node
from ..scene.scene import Scene
from ..scene.shape import Plane
from .facts import dominant_colors, facts, number, report_of_pixels, tight_bounds
from .sheet import Canvas, Grid, Rgb, Stroke, shortened, text_width, wrapped
from .turntable import without_lights

__all__ = ["ARROW", "PROJECTIONS", "VIEWS", "Sheet", "Tip", "axis_tips", "glyph_origin", "standard_cameras", "views", "without_planes"]

PROJECTIONS = ("orthographic", "perspective")

Floats = NDArray[np.float64]

VIEWS = {
    "front": (0.0, 0.0, "from +z"),
    "right": (90.0, 0.0, "from +x"),
    "back": (180.0, 0.0, "from -z"),
    "left": (270.0, 0.0, "from -x"),
    "top": (0.0, 90.0, "from +y"),
    "bottom": (0.0, -90.0, "from -y"),
    "corner": (35.0, 25.0, "perspective"),
}
"""Azimuth (from +z towards +x) and elevation of each view, degrees, and what stands beside its name."""

_MARGIN = 1.38  # of the picture's side to the box round the model: its measures stand around it
_YFOV_DEGREES = 30.0
ARROW = 0.066
"""Length of an axis's arrow, in sides of a view."""
_LEAST_SIDE, _GREATEST_SIDE = 128, 2048

_PAPER: Rgb = (246, 247, 248)
_GROUND: Rgb = (188, 194, 201)
_INK: Rgb = (34, 38, 43)
_FAINT: Rgb = (84, 91, 100)
_ALARM: Rgb = (190, 30, 40)
_AXIS_COLORS: tuple[Rgb, Rgb, Rgb] = ((170, 22, 30), (14, 96, 32), (24, 62, 170))

_BLANK = 0.0005  # of the pixels: less is nothing, or a speck
_BLACK = 0.004  # luminance
_BURNT = 0.5  # of what is seen


@dataclass(frozen=True, eq=False)
class Sheet:
    """A contact sheet and what it shows.

    Parameters
    ----------
    image : Image
    facts : dict
        As from `limner.produce.facts.facts`, and ``views``: of each its name, its place on the sheet (``cell``: left, top, width,
        height), camera, coverage, the box of what is seen in it; ``blank``: whether nothing is seen in any; ``colors``: the commonest.
        Plain values that JSON can hold.
    finished : bool
        False: stopped by the user; views are missing.
    """

    image: Image
    facts: dict[str, Any] = field(default_factory=dict)
    finished: bool = True


class Tip(NamedTuple):
    """Where an arrow of unit length along a world axis ends, seen by a camera.

    Attributes
    ----------
    right, up : float
        In the picture.
    towards : float
        To the eye; 1 or -1: the arrow is seen from its end.
    """

    right: float
    up: float
    towards: float


def views(
    scene: Any,
    *,
    size: int = 320,
    projection: str = "orthographic",
    renderer: str = "raster",
    own_lights: bool = False,
    title: str = "",
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
    **options: Any,
) -> Sheet:
    """Make a contact sheet of the standard views of a scene.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`. Infinite planes and the background are left out.
    size : int from 128 to 2048
        Side of each view, pixels.
    projection : "orthographic" | "perspective"
        Of the six views along the axes: parallel, all at one scale; or each from the nearest eye. The seventh is in perspective.
    renderer : "raster" | "ray" | "path"
    own_lights : bool
        False: every view is lit from its camera, so that the back is as bright as the front. True: by the scene's lights, if it has any.
    title : str
        On the sheet; "": the scene's name.
    on_progress, cancel, **options
        As for `limner.render`: samples, seed, threads, ….

    Returns
    -------
    Sheet
    """
    if projection not in PROJECTIONS:
        raise UnsupportedError(f"projection must be one of {', '.join(PROJECTIONS)}, got {projection!r}")
    if isinstance(size, bool) or not hasattr(size, "__index__") or not _LEAST_SIDE <= size <= _GREATEST_SIDE:
        raise SceneError(f"size must be an integer from {_LEAST_SIDE} to {_GREATEST_SIDE}, got {size!r}")
    from ..files.interop import as_scene
    from ..render import Renderer

    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    shown, left_out = without_planes(scene)
    if not own_lights:
        shown = shown.replace(root=without_lights(shown.root), environment=None)
    corners = _corners(shown)
    cameras = standard_cameras(corners, projection)
    told = facts(scene)
    draft = _Draft(int(size), corners, title or scene.name or "model")
    meter, images = Meter(on_progress, "views"), []
    finished = True
    with Renderer(shown, width=int(size), height=int(size), renderer=renderer, **options) as made:
        for index, (name, camera) in enumerate(cameras.items()):

            def report(progress: Progress, index: int = index) -> None:
                meter.report(min((index + progress.done) / len(cameras), 1.0 - 1e-9))

            image = made.render(camera, on_progress=report, cancel=cancel)
            if not image.finished:
                finished = False
                break
            images.append(image)
            draft.view(index, name, camera, image)
    told |= _seen(list(zip(cameras.items(), images, strict=False)), draft.grid, int(size))
    told["projection"] = projection
    told["notes"] = [*told["notes"], *left_out]
    told["warnings"] = [*told["warnings"], *_slips_of(images, told)] if finished else told["warnings"]
    draft.panel(told)
    meter.report(1.0)
    recipe = images[0].recipe if images else {}
    return Sheet(draft.canvas.image(recipe=recipe, warnings=tuple(told["warnings"]), finished=finished), told, finished)


# --- cameras --------------------------------------------------------------------------------------------------------------


def standard_cameras(corners: Floats, projection: str = "orthographic") -> dict[str, Camera]:
    """The camera of each of `VIEWS`, by name.

    Parameters
    ----------
    corners : (8, 3) float64
        Of the box round the model.
    projection : "orthographic" | "perspective"
    """
    return {name: _camera(name, corners, projection) for name in VIEWS}


def _camera(name: str, corners: Floats, projection: str) -> Camera:
    azimuth, elevation, _ = VIEWS[name]
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = (low + high) / 2.0
    largest = float((high - low).max())
    reach = float(np.linalg.norm(high - low))
    if projection == "orthographic" and name != "corner":
        return OrthographicCamera.orbit(middle, reach, azimuth, elevation, height=_MARGIN * largest, name=name)
    eye = PerspectiveCamera.orbit(middle, 1.0, azimuth, elevation, yfov_degrees=_YFOV_DEGREES)
    x, y, z = eye.world_from_camera[:3, :3].T @ (corners - middle).T
    tangent = eye.half_height() / (_MARGIN * (0.85 if name == "corner" else 1.0))
    distance = float((z + np.maximum(np.abs(x), np.abs(y)) / tangent).max())
    return PerspectiveCamera.orbit(middle, distance, azimuth, elevation, yfov_degrees=_YFOV_DEGREES, name=name)


def axis_tips(camera: Camera) -> dict[str, Tip]:
    """How the world's axes lie in a camera's picture, by their names.

    >>> tips = axis_tips(OrthographicCamera.orbit((0, 0, 0), 1.0))
    >>> tips["x"][:2], tips["y"][:2], tips["z"].towards
    ((1.0, 0.0), (0.0, 1.0), 1.0)
    """
    axes = np.asarray(camera.world_from_camera)[:3, :3]
    return {name: Tip(*(float(part) for part in axes[k] + 0.0)) for k, name in enumerate("xyz")}


def _corners(scene: Scene) -> Floats:
    """(8, 3): of the box round everything, tightly; the unit cube where there is nothing, or all is in one place."""
    low, high = tight_bounds(scene)
    if not (low <= high).all():
        low, high = np.full(3, -0.5), np.full(3, 0.5)
    extent = float((high - low).max())
    if not extent > 1e-6 * float(max(np.abs(low).max(), np.abs(high).max())):
        low, high = low - 0.5, high + 0.5
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])


def without_planes(scene: Scene) -> tuple[Scene, list[str]]:
    """What has an end; the background goes, too, so that it can be seen where the model is."""
    kept = _bounded(scene.root)
    notes = [] if kept is scene.root else ["infinite planes are left out"]
    return scene.replace(root=kept, background=None, camera=None), notes


def _bounded(node: Node) -> Node:
    children = []
    for child in node.children:  # a comprehension's own frame would halve the depth of the graphs that fit on the stack
        children.append(_bounded(child))
    shapes = tuple(shape for shape in node.shapes if not isinstance(shape.geometry, Plane))
    same = len(shapes) == len(node.shapes) and all(a is b for a, b in zip(children, node.children, strict=True))
    return node if same else dataclasses.replace(node, shapes=shapes, children=tuple(children))


# --- what is seen ---------------------------------------------------------------------------------------------------------


def _seen(made: Sequence[tuple[tuple[str, Camera], Image]], grid: Grid, size: int) -> dict[str, Any]:
    told = []
    for index, ((name, camera), image) in enumerate(made):
        x, y = grid.corner(index)
        cell = {"name": name, "cell": [x, y, size, size], **report_of_pixels(image.pixels)}
        azimuth, elevation, _ = VIEWS[name]
        eye = camera.world_from_camera[:3, 3].tolist()
        told.append({**cell, "azimuth_degrees": azimuth, "elevation_degrees": elevation, "eye": eye})
    pixels = np.concatenate([image.pixels.reshape(-1, 4) for _, image in made]) if made else np.zeros((0, 4), dtype=np.float32)
    return {"views": told, "blank": all(view["coverage"] < _BLANK for view in told), "colors": dominant_colors(pixels)}


def _slips_of(images: Sequence[Image], told: dict[str, Any]) -> list[str]:
    """What is wrong with the pictures, a sentence each; that a light was added is what was wanted."""
    found = [slip for image in images for slip in image.warnings if "not finite" in slip][:1]
    blank = [view["name"] for view in told["views"] if view["coverage"] < _BLANK]
    seen = [view for view in told["views"] if view["coverage"] >= _BLANK]
    if not seen:
        return [*found, "the model cannot be seen in any view"]
    if blank:
        found.append(f"nothing is seen from the {', '.join(blank)}: the model is flat, or its surfaces show their backs there")
    if all(view["brightness"] is not None and view["brightness"] < _BLACK for view in seen):
        found.append("the model is almost black in all views")
    burnt = [view["name"] for view in seen if (view["burnt_out"] or 0.0) > _BURNT]
    if burnt:
        found.append(f"most of the model is burnt out in {', '.join(burnt)}")
    return found


# --- drawing --------------------------------------------------------------------------------------------------------------


class _Draft:
    """The sheet on its way."""

    def __init__(self, size: int, corners: Floats, title: str) -> None:
        self._size, self._corners, self._title = size, corners, title
        self._letters = max(10, round(size / 22))
        self.grid = Grid(4, 2, size, size, max(4, size // 32))
        self.canvas = Canvas(*self.grid.size, _PAPER)

    def view(self, index: int, name: str, camera: Camera, image: Image) -> None:
        """Draw one view into its cell: the far side of the box, the model, the near side, measures, axes, name."""
        x, y = self.grid.corner(index)
        size, letters = self._size, self._letters
        self.canvas.box(x, y, size, size, _GROUND)
        places, depth = camera.project(self._corners, size, size)
        places = places + 0.5 + np.array([x, y])  # from pixel centres to the canvas's edges
        near, far = _edges(depth)
        self.canvas.lines(Stroke(places[list(edge)].tolist(), _FAINT, 1.0, 0.4) for edge in far)
        self.canvas.picture(x, y, image)
        self.canvas.lines(Stroke(places[list(edge)].tolist(), _FAINT, 1.0, 0.6) for edge in near)
        self._measures(camera, places, (x, y))
        self._axes(camera, x, y)
        pad = letters // 2
        self.canvas.text(x + pad, y + pad, name, size=letters, color=_INK)
        self.canvas.text(x + size - pad, y + pad, VIEWS[name][2], size=max(9, letters - 2), color=_FAINT, anchor="ra")

    def _measures(self, camera: Camera, places: Floats, corner: tuple[int, int]) -> None:
        """Write the length of each axis that does not lie along the gaze beside an outer edge of the box."""
        size, letters = self._size, max(9, self._letters - 2)
        middle = places.mean(axis=0)
        low, high = self._corners.min(axis=0), self._corners.max(axis=0)
        for axis, tip in enumerate(axis_tips(camera).values()):
            edge = _outer_edge(places, middle, axis)
            along = edge[1] - edge[0]
            length = float(np.hypot(*along))
            if abs(tip.towards) > 0.95 or not length > 0.0:
                continue
            outwards = edge.mean(axis=0) - middle
            across = np.array([-along[1], along[0]]) / length
            across = across if across @ outwards >= 0.0 else -across
            words = f"{'xyz'[axis]} {number(float(high[axis] - low[axis]))}"
            place = edge.mean(axis=0) + across * (0.35 * letters)
            anchor = "mm" if abs(across[0]) < 0.35 else "lm" if across[0] > 0.0 else "rm"
            place[1] += np.sign(across[1]) * 0.75 * letters if anchor == "mm" else across[1] * 0.5 * letters
            x, y = _kept_inside(place, words, letters, anchor, corner, size)
            self.canvas.text(x, y, words, size=letters, color=_AXIS_COLORS[axis], anchor=anchor, halo=_GROUND)

    def _axes(self, camera: Camera, x: int, y: int) -> None:
        """The world's axes in the lower left corner: arrows; out of the picture a ring with a dot, into it one with a cross."""
        letters = max(9, self._letters - 2)
        reach = ARROW * self._size
        at = np.array([x, y]) + glyph_origin(self._size)
        for name, tip in sorted(axis_tips(camera).items(), key=lambda item: item[1].towards):
            color = _AXIS_COLORS["xyz".index(name)]
            way = np.array([tip.right, -tip.up])
            length = float(np.hypot(*way))
            if length < 0.2:
                self._end_on(at, tip.towards, color, 0.2 * reach)
                beside = at + np.array([-0.35, 0.45]) * reach
            else:
                self._arrow(at, at + reach * way, color)
                beside = at + way * (reach + 0.6 * letters / max(length, 0.5))
            self.canvas.text(float(beside[0]), float(beside[1]), name, size=letters, color=color, anchor="mm")

    def _arrow(self, start: Floats, end: Floats, color: Rgb) -> None:
        way = (end - start) / float(np.hypot(*(end - start)))
        side = np.array([-way[1], way[0]])
        head = 0.02 * self._size
        width = max(1.4, self._size / 180.0)
        wings = [end - head * way + 0.6 * head * side, end, end - head * way - 0.6 * head * side]
        self.canvas.lines([Stroke([start.tolist(), end.tolist()], color, width), Stroke([w.tolist() for w in wings], color, width)])

    def _end_on(self, at: Floats, towards: float, color: Rgb, radius: float) -> None:
        x, y = at.tolist()
        width = max(1.2, self._size / 200.0)
        self.canvas.circle(x, y, radius, color, width)
        if towards > 0.0:
            self.canvas.circle(x, y, 0.45 * radius, color, radius)
            return
        d = radius * math.sqrt(0.5)
        self.canvas.lines([Stroke([(x - d, y - d), (x + d, y + d)], color, width), Stroke([(x - d, y + d), (x + d, y - d)], color, width)])

    def panel(self, told: dict[str, Any]) -> None:
        """Write the facts into the last cell: as many lines as there is room for."""
        x, y = self.grid.corner(len(VIEWS))
        letters = max(9, round(self._size / 25))
        step, pad = round(1.38 * letters), letters // 2
        width, bottom = self._size - 2 * pad, y + self._size - pad
        at = y + pad
        self.canvas.text(x + pad, at, shortened(self._title, letters + 4, width), size=letters + 4, color=_INK)
        at += round(1.5 * (letters + 4))
        for line in _lines(told):
            self.canvas.text(x + pad, at, shortened(line, letters, width), size=letters, color=_INK)
            at += step
        at = self._swatches(told["colors"], x + pad, at + pad // 2, width, step)
        for warning in told["warnings"]:
            for line in wrapped(f"! {warning}", letters, width):
                if at + step <= bottom:
                    self.canvas.text(x + pad, at, line, size=letters, color=_ALARM)
                at += step

    def _swatches(self, colors: list[dict[str, Any]], x: float, y: float, width: float, height: float) -> int:
        """The commonest colours as a strip, each as wide as its share of them."""
        total = sum(entry["share"] for entry in colors)
        left = x
        for entry in colors:
            part = width * entry["share"] / total
            code = int(entry["color"][1:], 16)
            self.canvas.box(left, y, part, height, (code >> 16, code >> 8 & 255, code & 255))
            left += part
        return round(y + (1.5 * height if colors else 0))


def _lines(told: dict[str, Any]) -> list[str]:
    """The facts as a person reads them first."""
    lines = ["nothing bounded"]
    if told["size"] is not None:
        low, high = (", ".join(number(edge) for edge in corner) for corner in told["bounds"])
        lines = [f"size {' x '.join(number(edge) for edge in told['size'])} m", f"from ({low})", f"to ({high})"]
    drawn = f", {told['drawn_triangles']} drawn" if told["drawn_triangles"] != told["triangles"] else ""
    names = ", ".join(material["name"] or material["kind"] for material in told["materials"][:6])
    sizes = ", ".join(f"{texture['width']} x {texture['height']}" for texture in told["textures"][:4])
    up = told["up"]
    return [
        *lines,
        _counted(told["triangles"], "triangle") + drawn,
        f"{_counted(told['meshes'], 'mesh', 'meshes')}, {_counted(told['shapes'], 'shape')}, {_counted(told['nodes'], 'node')}",
        _counted(told["n_materials"], "material") + (f": {names}" if names else ""),
        _counted(told["n_textures"], "texture") + (f": {sizes}" if sizes else ""),
        f"{_counted(told['n_lights'], 'light')}, {_counted(told['n_cameras'], 'camera')}, {_counted(len(told['notes']), 'note')}",
        f"up {up['axis']}{'?' if up['confidence'] == 'low' else ''}",
    ]


def _counted(n: int, one: str, many: str = "") -> str:
    return f"{n} {one if n == 1 else many or one + 's'}"


def glyph_origin(size: int) -> Floats:
    """(2,): where the arrows of the axes begin, right of and below the upper left corner of a view of that size, pixels."""
    return np.array([0.0, size]) + (5.0 + 0.105 * size) * np.array([1.0, -1.0])


def _kept_inside(place: Floats, words: str, letters: int, anchor: str, corner: tuple[int, int], size: int) -> tuple[float, float]:
    """Where words stand so that no letter leaves the cell."""
    width, gap = text_width(words, letters), 0.25 * letters
    before = {"l": 0.0, "m": width / 2.0, "r": width}[anchor[0]]
    x = min(max(float(place[0]), corner[0] + before + gap), corner[0] + size - (width - before) - gap)
    y = min(max(float(place[1]), corner[1] + letters), corner[1] + size - letters)
    return x, y


def _edges(depth: Floats) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """The twelve edges of the box by its corners' numbers: those before the model, and those behind it, which meet its farthest corner."""
    pairs = [(k, k | 1 << axis) for k in range(8) for axis in range(3) if not k >> axis & 1]
    farthest = depth >= depth.max() - 1e-6 * max(float(np.ptp(depth)), 1e-30)
    behind = [pair for pair in pairs if farthest[list(pair)].any()]
    return [pair for pair in pairs if pair not in behind], behind


def _outer_edge(places: Floats, middle: Floats, axis: int) -> Floats:
    """(2, 2): of the four edges along an axis, the one that lies farthest out and low; of equals, the right one."""
    edges = [places[[k, k | 1 << axis]] for k in range(8) if not k >> axis & 1]
    outs = [edge.mean(axis=0) - middle for edge in edges]
    best = max(range(4), key=lambda k: (round(float(np.hypot(*outs[k]) + 0.5 * outs[k][1]), 1), round(float(outs[k][0]), 1)))
    return edges[best]
