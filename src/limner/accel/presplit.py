"""Boxes for parts of large triangles: what a tree over whole triangles cannot keep apart.

The box of a long triangle that lies across the axes is mostly empty, and overlaps many others. So it is cut in two, across its longest
side, and each part gets a box of what it holds of the triangle; and so on, the emptiest boxes first, as long as there is room for more. The
tree is then built over the parts as over any boxes, and a triangle stands in it as often as it has parts.

**Source**: Ernst and Greiner, *Early split clipping for bounding volume hierarchies*, 2007; which boxes to cut: Karras and Aila, *Fast
parallel construction of high-quality bounding volume hierarchies*, 2013, 4.1, by the area that a cut would save.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["split_boxes"]

Floats = NDArray[np.float64]

_ROUNDS = 12
_LEAST_EMPTY = 0.2  # of a box's surface, that it is worth a cut


def split_boxes(
    corners: NDArray[np.float32], bounds: NDArray[np.float32], room: float = 0.5
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Cut the boxes of triangles.

    Parameters
    ----------
    corners : (n, 9) float32
        Vertices.
    bounds : (n, 6) float32
        Low and high corner of each triangle's box.
    room : float
        How many boxes there may be more than triangles, as a share of these.

    Returns
    -------
    rows : (m,) int64
        Which triangle each box is of; those of the first n are 0 to n - 1.
    boxes : (m, 6) float32
        Together, the boxes of a triangle hold it.
    """
    vertices = corners.reshape(-1, 3, 3).astype(np.float64)
    rows, boxes = np.arange(len(corners)), bounds.astype(np.float64)
    left = int(room * len(corners))
    # The sum of a triangle's three projections: half the surface of boxes that are as small as they can be.
    lean = 0.5 * np.abs(np.cross(vertices[:, 1] - vertices[:, 0], vertices[:, 2] - vertices[:, 0])).sum(axis=1)
    for _ in range(_ROUNDS):
        wasted = _half_surface(boxes) - lean[rows]
        worth = np.flatnonzero(wasted > _LEAST_EMPTY * max(float(_half_surface(boxes).mean()), 1e-300))
        # As many as half of what is left, so that what comes of the emptiest can be cut again.
        chosen = worth[np.argsort(-wasted[worth], kind="stable")][: max(left // 2, 0)]
        if not len(chosen):
            break
        low, high = _halves(vertices[rows[chosen]], boxes[chosen])
        saved = _half_surface(boxes[chosen]) - 0.5 * (_half_surface(low) + _half_surface(high))
        better = saved > 0.0
        chosen, low, high = chosen[better], low[better], high[better]
        boxes[chosen] = low
        rows, boxes = np.concatenate([rows, rows[chosen]]), np.concatenate([boxes, high])
        left -= len(chosen)
    # Outwards, where float32 is coarser.
    made = boxes.astype(np.float32)
    made[:, :3] = np.where(made[:, :3] > boxes[:, :3], np.nextafter(made[:, :3], np.float32(-np.inf)), made[:, :3])
    made[:, 3:] = np.where(made[:, 3:] < boxes[:, 3:], np.nextafter(made[:, 3:], np.float32(np.inf)), made[:, 3:])
    return rows, made


def _half_surface(boxes: Floats) -> Floats:
    x, y, z = np.maximum(boxes[:, 3:] - boxes[:, :3], 0.0).T
    return np.asarray(x * y + y * z + z * x)


def _halves(vertices: Floats, boxes: Floats) -> tuple[Floats, Floats]:
    """Boxes of what lies below and above the middle of each box's longest side."""
    axis = np.argmax(boxes[:, 3:] - boxes[:, :3], axis=1)
    k = np.arange(len(boxes))
    middle = 0.5 * (boxes[k, axis] + boxes[k, 3 + axis])
    a, b = vertices, np.roll(vertices, -1, axis=1)
    x, y = a[k[:, None], np.arange(3), axis[:, None]], b[k[:, None], np.arange(3), axis[:, None]]
    crosses = (x < middle[:, None]) != (y < middle[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, (middle[:, None] - x) / (y - x), 0.0)
    cuts = a + share[..., None] * (b - a)
    cuts[k[:, None], np.arange(3), axis[:, None]] = middle[:, None]
    points, on_plane = np.concatenate([a, cuts], axis=1), np.concatenate([np.zeros_like(crosses), crosses], axis=1)
    found = []
    for is_low in (True, False):
        inside = np.concatenate([(x <= middle[:, None]) if is_low else (x >= middle[:, None]), np.zeros_like(crosses)], axis=1) | on_plane
        part = np.concatenate(
            [np.where(inside[..., None], points, np.inf).min(axis=1), np.where(inside[..., None], points, -np.inf).max(axis=1)], axis=1
        )
        found.append(np.concatenate([np.maximum(part[:, :3], boxes[:, :3]), np.minimum(part[:, 3:], boxes[:, 3:])], axis=1))
    return found[0], found[1]
