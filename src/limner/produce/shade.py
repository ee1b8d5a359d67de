"""What lies under the lines of a drawing: areas of colour, and light and shade by strokes or dots (FoCG 8.2.2, 10.3).

    layers = shade_layers(scene, drawing, placing, tone="hatching", fill=True, color=BLACK)

The raster renderer says how light each place is and what is seen there; strokes and dots (`limner.artistic.hatching`, `tone`) are made
from that. Areas are exact outlines of what is projected, one over the other in the painter's order, which is found without a picture:

1. shapes whose boxes on the picture do not meet, or one of which lies wholly behind the other, can be painted whole;
2. where that gives no order, a BSP tree cuts triangles until there is one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..artistic.fill import areas_of, clipped
from ..artistic.hatching import hatching
from ..artistic.lines import Drawing
from ..artistic.plate import Placing
from ..artistic.tone import stippling, tone_of
from ..draw.ink import Rgba
from ..draw.page import Dots, Layer, Patch, Trace
from ..draw.stroke import Pen
from ..errors import UnsupportedError
from ..image.image import Image
from ..linear.affine import transform_points
from ..linear.projection import camera_from_world
from ..raster import bsp
from ..raster.painter import MAX_SORTED
from ..scene.camera import Camera, PerspectiveCamera
from ..scene.scene import Scene
from ..tables.build import flatten
from ..tables.layouts import PLANE, SceneTables

__all__ = ["painted_order", "shade_layers"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_SPACING = 5.0  # pixels between strokes
_STROKE, _DOT = 0.8, 1.1  # pixels: a stroke's width, a dot's radius
_HAIRLINE = 0.4  # pixels: over the seams between areas of one shape
_BEYOND = 8.0  # pixels beyond the picture's edge, where areas are cut off
_NEAREST = 1e-6  # of the scene's depth: nearer than that is behind the eye
_COARSER = (1, 2, 4, 8)
_GREY: Rgba = (0.6, 0.6, 0.6, 1.0)


def shade_layers(
    scene: Scene, drawing: Drawing, place: Placing, *, tone: str | None, fill: bool, color: Rgba, threads: int | None = None
) -> list[Layer]:
    """The layers "areas" and "hatching" or "stippling".

    Parameters
    ----------
    scene : Scene
    drawing : Drawing
        Of it; says the camera and the size.
    place : Placing
    tone : "hatching" | "stippling" | None
    fill : bool
    color : (r, g, b, a)
        Of strokes and dots.
    threads : int, optional
        As for `limner.render`.
    """
    from ..render import Renderer

    plain = scene.replace(background=None, camera=drawing.camera)
    with Renderer(plain, width=drawing.width, height=drawing.height, threads=threads, aovs=("instance_id",)) as renderer:
        image = renderer.render(drawing.camera)
    tables = flatten(plain, drawing.camera, drawing.width, drawing.height).tables
    layers = []
    if fill:
        layers.append(Layer("areas", _areas(plain, drawing, image, place), ("areas",)))
    # A floor without end has no tone of its own: it is the paper.
    ids = np.where(np.isin(image.aov["instance_id"], np.flatnonzero(tables.instances["kind"] == PLANE)), -1, image.aov["instance_id"])
    if tone == "hatching":
        pen = Pen(place.length(_STROKE, "px"), "round")
        strokes = hatching(tone_of(image.pixels), ids, spacing=_SPACING, shortest=_SPACING)
        layers.append(Layer(tone, [Trace(place.points(stroke), color, pen) for stroke in strokes], ("tone",)))
    elif tone == "stippling":
        dots = stippling(tone_of(image.pixels), ids >= 0, radius=_DOT)
        radii = np.full(len(dots), _DOT * place.finer)
        layers.append(Layer(tone, [Dots(place.points(dots), radii, color)] if len(dots) else [], ("tone",)))
    return layers


def _areas(scene: Scene, drawing: Drawing, image: Image, place: Placing) -> list[Patch | Trace]:
    camera = drawing.camera
    for coarser in _COARSER:
        # Exact shapes have triangles to a tenth of a pixel; fewer, where that makes too many to be sorted.
        tables = flatten(scene, camera, max(1, drawing.width // coarser), max(1, drawing.height // coarser)).tables
        order = painted_order(tables, camera)
        if order is not None:
            break
    else:
        raise UnsupportedError(f"shapes that overlap in depth are filled up to {MAX_SORTED} triangles, and these have more: leave out fill")
    corners, owner = order
    corners, owner = _before_eye(corners, owner, camera)
    xy, _ = camera.project(corners.reshape(-1, 3), drawing.width, drawing.height)
    picture = (xy + 0.5).reshape(-1, 3, 2)
    colors = _mean_colors(image, len(tables.instances))
    marks: list[Patch | Trace] = []
    found = areas_of(picture, owner)
    parts = np.bincount([area.owner for area in found], minlength=len(tables.instances))
    for area in found:
        inside = (clipped(ring, (-_BEYOND, -_BEYOND), (drawing.width + _BEYOND, drawing.height + _BEYOND)) for ring in area.rings)
        rings = tuple(place.points(ring) for ring in inside if len(ring) > 2)
        if not rings:
            continue
        marks.append(Patch(rings, colors[area.owner]))
        if parts[area.owner] > 1:
            pen = Pen(_HAIRLINE * place.finer, "round", "round")
            marks += [Trace(ring, colors[area.owner], pen, True) for ring in rings]
    return marks


def _mean_colors(image: Image, count: int) -> list[Rgba]:
    """The mean colour of what is seen of each instance."""
    ids = image.aov["instance_id"].reshape(-1)
    seen = ids >= 0
    colors = np.clip(image.pixels.reshape(-1, 4)[seen, :3].astype(np.float64), 0.0, 1.0)
    n = np.bincount(ids[seen], minlength=count)
    sums = np.stack([np.bincount(ids[seen], colors[:, channel], count) for channel in range(3)], axis=1)
    made = []
    for total, pixels in zip(sums.tolist(), n.tolist(), strict=True):
        made.append((total[0] / pixels, total[1] / pixels, total[2] / pixels, 1.0) if pixels else _GREY)
    return made


# --- order ----------------------------------------------------------------------------------------------------------------


def painted_order(tables: SceneTables, camera: Camera) -> tuple[Floats, Indices] | None:
    """Triangles in the world, (n, 3, 3), from back to front, and the instance of each, (n,); None: there are too many for an order."""
    corners = bsp.world_triangles(tables)
    owner, bounded = _owners(tables)
    corners, owner = corners[bounded], owner[bounded]
    whole = np.isfinite(corners).all(axis=(1, 2))
    corners, owner = corners[whole], owner[whole]
    sequence = _sequence(corners, owner, camera)
    if sequence is not None:
        rank = np.full(len(tables.instances), -1)
        rank[sequence] = np.arange(len(sequence))
        order = np.argsort(rank[owner], kind="stable")
        return corners[order], owner[order]
    tree = bsp.build(corners) if len(corners) <= MAX_SORTED else None
    if tree is None:
        return None
    matrix = np.asarray(camera.world_from_camera)
    eye = np.append(matrix[:3, 3], 1.0) if isinstance(camera, PerspectiveCamera) else np.append(matrix[:3, 2], 0.0)
    rows = tree.fragments[bsp.back_to_front(tree, eye)]
    return _fans(tree, rows, owner)


def _owners(tables: SceneTables) -> tuple[Indices, NDArray[np.bool_]]:
    """The instance of each triangle of `bsp.world_triangles`, and whether it is of something that has an end."""
    rows = np.flatnonzero(tables.instances["mesh"] >= 0)
    counts = tables.meshes["n_triangles"][tables.instances["mesh"][rows]].astype(np.int64)
    return np.repeat(rows, counts), np.repeat(tables.instances["kind"][rows] != PLANE, counts)


def _sequence(corners: Floats, owner: Indices, camera: Camera) -> list[int] | None:
    """Instances from back to front, where each can be painted whole; None: there is no such order that their bounds show."""
    names = np.unique(owner).tolist()
    if len(names) < 2:
        return names
    points = transform_points(camera_from_world(camera), corners.reshape(-1, 3)).reshape(-1, 3, 3)
    boxes = {name: _box(points[owner == name].reshape(-1, 3), isinstance(camera, PerspectiveCamera)) for name in names}
    behind: dict[int, set[int]] = {name: set() for name in names}  # what must be painted before it
    for k, a in enumerate(names):
        for b in names[k + 1 :]:
            (low_a, high_a), (low_b, high_b) = boxes[a], boxes[b]
            if (high_a[:2] < low_b[:2]).any() or (high_b[:2] < low_a[:2]).any():
                continue
            if low_a[2] >= high_b[2]:
                behind[b].add(a)
            elif low_b[2] >= high_a[2]:
                behind[a].add(b)
            else:
                return None
    made: list[int] = []
    while len(made) < len(names):
        ready = [name for name in names if name not in made and behind[name] <= set(made)]
        if not ready:
            return None
        made.append(ready[0])
    return made


def _box(points: Floats, perspective: bool) -> tuple[Floats, Floats]:
    """Bounds on the picture and in depth, of points in camera space; what reaches behind the eye is everywhere."""
    depth = -points[:, 2]
    if not perspective:
        seen = np.column_stack([points[:, :2], depth])
        return seen.min(axis=0), seen.max(axis=0)
    if depth.min() <= 0.0:
        return np.array([-np.inf, -np.inf, depth.min()]), np.array([np.inf, np.inf, depth.max()])
    seen = np.column_stack([points[:, :2] / depth[:, None], depth])
    return seen.min(axis=0), seen.max(axis=0)


def _fans(tree: bsp.BspTree, rows: NDArray[np.int32], owner: Indices) -> tuple[Floats, Indices]:
    """The fragments of a tree, which are convex, as triangles."""
    corners, whose = [], []
    for first, count, triangle in rows[:, :3].tolist():
        outline = tree.points[first : first + count]
        for k in range(1, count - 1):
            corners.append(outline[[0, k, k + 1]])
            whose.append(owner[tree.members[triangle]])
    return np.array(corners).reshape(-1, 3, 3), np.array(whose, dtype=np.int64)


def _before_eye(corners: Floats, owner: Indices, camera: Camera) -> tuple[Floats, Indices]:
    """What of each triangle lies before the eye, as triangles."""
    if not isinstance(camera, PerspectiveCamera) or not len(corners):
        return corners, owner
    depth = -transform_points(camera_from_world(camera), corners.reshape(-1, 3))[:, 2].reshape(-1, 3)
    nearest = camera.near if camera.near is not None else _NEAREST * max(float(depth.max()), 1e-300)
    before = depth >= nearest
    if before.all():
        return corners, owner
    parts, whose = [], []
    for triangle, depths, front, name in zip(corners, depth, before, owner.tolist(), strict=True):
        outline = triangle if front.all() else _cut(triangle, depths, nearest)
        for k in range(1, len(outline) - 1):
            parts.append(outline[[0, k, k + 1]])
            whose.append(name)
    return np.array(parts).reshape(-1, 3, 3), np.array(whose, dtype=np.int64)


def _cut(triangle: Floats, depth: Floats, nearest: float) -> Floats:
    """The outline of a triangle's part beyond a depth; a cut edge has the same end, to the bit, for both triangles beside it."""
    made = []
    for k in range(3):
        a, b = k, (k + 1) % 3
        if depth[a] >= nearest:
            made.append(triangle[a])
        if (depth[a] >= nearest) != (depth[b] >= nearest):
            far, near = (a, b) if depth[a] > depth[b] else (b, a)
            t = (depth[far] - nearest) / (depth[far] - depth[near])
            made.append(triangle[far] + t * (triangle[near] - triangle[far]))
    return np.array(made).reshape(-1, 3)
