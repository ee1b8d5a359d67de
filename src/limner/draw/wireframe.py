"""Lines in space, drawn onto a picture, those behind surfaces hidden or drawn otherwise (FoCG 8.1.1, 8.2.3, 10.3.1).

    positions, edges                  what a mesh is made of
    camera_from_world, K              where it is seen: linear.projection, linear.project
    image.aov["depth"]                what hides it

    seen = visible_segments(positions[edges[:, 0]], positions[edges[:, 1]], camera_from_world, K, perspective=True,
                            width=w, height=h, depth=image.aov["depth"])
    draw_wireframe(Canvas.on(image), seen, "black", 1.2, hidden="#00000030")

Depth is compared along the line, at its middle, and not in each pixel that its width covers: so a line keeps its width at a
silhouette. Near the outline of what hides it, a hidden line may show for a pixel.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._door import Array, Door, Scalar
from ..errors import SceneError
from ..linear.affine import transform_points
from ..linear.project import check_size, pixels_from_world
from .canvas import Canvas
from .ink import Ink
from .stroke import Pen

__all__ = ["Seen", "draw_wireframe", "visible_segments"]

Floats = NDArray[np.float64]

_MARGIN = 8.0  # pixels round the picture that lines are kept in, for their width
_NEAR = 1e-6  # of the farthest depth, where no near plane is given

_runs = Door(
    "limner.draw.wireframe_kernel",
    "find_runs",
    (
        Array(np.float64, 2), Array(np.float32, 2), Scalar(np.int64), Scalar(np.float64), Scalar(np.int64),
        Array(np.float64, 2), Array(np.int64, 1), Array(np.int64, 1),
    ),
    "hidden lines",
)  # fmt: skip


class Seen(NamedTuple):
    """Pieces of lines on the screen.

    Attributes
    ----------
    lines : (m, 4) float64
        x0, y0, x1, y1 in pixels with their centres at integers, y down.
    source : (m,) int64
        The number of the line that each is a piece of.
    visible : (m,) bool
    """

    lines: Floats
    source: NDArray[np.int64]
    visible: NDArray[np.bool_]


def visible_segments(
    starts: ArrayLike,
    ends: ArrayLike,
    camera_from_world: Floats,
    K: Floats,  # noqa: N803 - as it is known
    *,
    perspective: bool,
    width: int,
    height: int,
    depth: NDArray[np.float32] | None = None,
    near: float | None = None,
    bias: float = 1e-3,
) -> Seen:
    """Project lines and find which of their parts are seen.

    Parameters
    ----------
    starts, ends : (n, 3) float
        World space.
    camera_from_world : (4, 4) float64
    K : (3, 3) float64
        For pictures of the given size.
    perspective : bool
    width, height : int
    depth : (height, width) float, optional
        Along the gaze, inf where nothing is seen, row 0 on top: `image.aov["depth"]`. None: nothing hides anything.
    near : float > 0, optional
        What is nearer to a perspective camera is cut off; None: a millionth of the greatest depth.
    bias : float
        Part of its depth by which a line may lie behind a surface and still count as on it.

    Returns
    -------
    Seen
        In the lines' order, cut to the picture and a few pixels around it.

    **Source**: FoCG 8.1.3 (clipping before the division), 11.3.1 (depth along a line on the screen), 8.2.3 (the z-buffer's
    test).
    """
    check_size(width, height)
    a, b, source = _before_eye(_triples(starts, "starts"), _triples(ends, "ends"), camera_from_world, perspective, near)
    if len(a) == 0:
        return Seen(np.empty((0, 4)), source, np.empty(0, dtype=bool))
    xy0, depth0 = pixels_from_world(a, np.eye(4), K, perspective=perspective)
    xy1, depth1 = pixels_from_world(b, np.eye(4), K, perspective=perspective)
    lines, source = _inside(np.column_stack([xy0, xy1, depth0, depth1]), source, perspective, width, height)
    if depth is None:
        return Seen(lines[:, :4], source, np.ones(len(lines), dtype=bool))
    held = np.ascontiguousarray(depth, dtype=np.float32)
    if held.shape != (height, width):
        raise SceneError(f"depth must have shape {(height, width)}, got {held.shape}")
    runs, line_of = _find_runs(np.ascontiguousarray(lines), held, perspective, bias)
    start, way = lines[line_of, :2], (lines[:, 2:4] - lines[:, :2])[line_of]
    pieces = np.concatenate([start + runs[:, :1] * way, start + runs[:, 1:2] * way], axis=1)
    return Seen(pieces, source[line_of], runs[:, 2] > 0.0)


def draw_wireframe(
    canvas: Canvas,
    seen: Seen,
    color: Ink,
    pen: Pen | float = 1.0,
    hidden: Ink | None = None,
    hidden_pen: Pen | float | None = None,
) -> Canvas:
    """Draw pieces of lines.

    Parameters
    ----------
    canvas : Canvas
    seen : Seen
    color : colour
        Of what is seen.
    pen : Pen or float
    hidden : colour, optional
        Of what is not; None: it is left out.
    hidden_pen : Pen or float, optional
        None: the same pen.
    """
    behind = seen.lines[~seen.visible]
    if hidden is not None and len(behind):
        canvas.segments(behind, hidden, pen if hidden_pen is None else hidden_pen)
    if seen.visible.any():
        canvas.segments(seen.lines[seen.visible], color, pen)
    return canvas


def _triples(points: ArrayLike, name: str) -> Floats:
    try:
        made = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be numbers of shape (n, 3), got {type(points).__name__}") from None
    if made.size == 0:
        return made.reshape(0, 3)
    if made.ndim != 2 or made.shape[1] != 3:
        raise SceneError(f"{name} must have shape (n, 3), got {made.shape}")
    return made


def _before_eye(
    starts: Floats, ends: Floats, camera_from_world: Floats, perspective: bool, near: float | None
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """The lines' parts in front of the near plane, in camera space, and which lines they are of."""
    if starts.shape != ends.shape:
        raise SceneError(f"starts and ends must be as many, got {len(starts)} and {len(ends)}")
    if near is not None and not near > 0.0:
        raise SceneError(f"near must be positive, got {near!r}")
    a, b = transform_points(camera_from_world, starts), transform_points(camera_from_world, ends)
    source = np.flatnonzero(np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1))
    a, b = a[source], b[source]
    if not perspective or len(a) == 0:
        return a, b, source
    nearest = near if near is not None else _NEAR * max(float(-a[:, 2].min()), float(-b[:, 2].min()), 1e-300)
    a, b, kept = _cut(a, b, -a[:, 2] - nearest, -b[:, 2] - nearest)
    return a, b, source[kept]


def _cut(a: Floats, b: Floats, at_a: Floats, at_b: Floats) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """What of each line has a value, which changes evenly along it, of at least 0: FoCG 8.1.6, t = f(a) / (f(a) - f(b))."""
    kept = np.flatnonzero((at_a >= 0.0) | (at_b >= 0.0))
    a, b, at_a, at_b = a[kept], b[kept], at_a[kept], at_b[kept]
    t = (at_a / np.where(at_a == at_b, 1.0, at_a - at_b))[:, None]
    crossing = a + t * (b - a)
    return np.where((at_a < 0.0)[:, None], crossing, a), np.where((at_b < 0.0)[:, None], crossing, b), kept


def _inside(
    lines: Floats, source: NDArray[np.int64], perspective: bool, width: int, height: int
) -> tuple[Floats, NDArray[np.int64]]:
    """Cut lines on the screen, with depths at their ends, to the picture and a margin."""
    if perspective:
        lines = np.column_stack([lines[:, :4], 1.0 / lines[:, 4:]])  # what changes evenly on the screen
    a, b = lines[:, [0, 1, 4]], lines[:, [2, 3, 5]]
    for axis, sign, bound in ((0, 1, -_MARGIN), (0, -1, width + _MARGIN), (1, 1, -_MARGIN), (1, -1, height + _MARGIN)):
        a, b, kept = _cut(a, b, sign * (a[:, axis] - bound), sign * (b[:, axis] - bound))
        source = source[kept]
    ends = np.column_stack([a[:, 2], b[:, 2]])
    return np.column_stack([a[:, :2], b[:, :2], 1.0 / ends if perspective else ends]), source


def _find_runs(
    lines: Floats, depth: NDArray[np.float32], perspective: bool, bias: float
) -> tuple[Floats, NDArray[np.int64]]:
    count = np.zeros(1, dtype=np.int64)
    runs, line_of = np.empty((0, 3)), np.empty(0, dtype=np.int64)
    _runs(lines, depth, int(perspective), bias, 0, runs, line_of, count)
    runs, line_of = np.empty((int(count[0]), 3)), np.empty(int(count[0]), dtype=np.int64)
    _runs(lines, depth, int(perspective), bias, 1, runs, line_of, count)
    return runs, line_of
