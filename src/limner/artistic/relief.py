"""Which silhouettes stand out from the surface behind them, and which are only its roughness.

A surface that is scanned turns away from the eye, and back, at every grain. What the eye takes for a line is where it comes in front of
something: of itself, farther behind, or of other things. So beside a silhouette, on the side to which the surface turns away, is looked
for the same surface. Where it goes on there, no more than a pixel or two higher or lower, measured across it, nothing stands out.

            ____                                     __
           /    |  <- a line: the surface that       __ \\____       <- none: what is beside it is the grain's
          /     |     comes next is far below                           own height below
                 \\____

Measured in pixels, it depends on the size of the drawing what is a form and what is a grain, as it does for a pen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..mesh.components import component_labels
from .edges import Faces
from .sight_lines import SightLines
from .surfaces import Surfaces
from .visibility import Thrown

__all__ = ["faint"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

_ASIDE = (1.5, 4.0)  # pixels: the surface must go on at both; nearer, a smooth silhouette may lie inside that of its mesh
_HEIGHT = 1.5  # pixels across the surface: of what stands out less, the two sides would be one line
_CELL = 4.0  # pixels

_find_beside = Door(
    "limner.artistic.relief_kernel",
    "find_beside",
    (
        Array(np.float64, 2), Array(np.int64, 1), Scalar(np.int64), Scalar(np.int64), Array(np.int64, 1), Array(np.float64, 2),
        Array(np.int64, 1), Array(np.int64, 1), Array(np.int64, 1), Scalar(np.float64), Scalar(np.int64), Scalar(np.int64),
        Scalar(np.float64), Scalar(np.int64), Scalar(np.float64), Array(np.int64, 1),
    ),
    "what stands out",
)  # fmt: skip


def faint(found: Thrown, surfaces: Surfaces, faces: Faces, sight: SightLines, triangles: Floats, source: Indices) -> Flags:
    """Which lines, (k,) bool, do not stand out, of those that are `soft`; `triangles` and `source` are what may hide lines."""
    made = found.segments.soft.copy()
    rows = np.flatnonzero(made)
    if not len(rows):
        return made
    own = found.segments.beside[rows]
    group = _groups(faces, len(surfaces.triangles))
    points = np.repeat(found.lines[rows].mean(axis=1)[None], len(_ASIDE), axis=0)
    outwards = _outwards(found.segments.ends[rows].mean(axis=1), faces.normals[own], sight)
    points[:, :, :2] += np.array(_ASIDE)[:, None, None] * outwards
    columns, lines = int(np.ceil(sight.width / _CELL)), int(np.ceil(sight.height / _CELL))
    points = np.ascontiguousarray(points.reshape(-1, 3))
    at = np.floor(points[:, :2] / _CELL)
    inside = ((at >= 0) & (at < (columns, lines))).all(axis=1)
    cell = np.where(inside, at[:, 1] * columns + at[:, 0], columns * lines).astype(np.int64)  # what is outside is in no cell
    order = np.argsort(cell, kind="stable")
    start = np.searchsorted(cell[order], np.arange(columns * lines + 1)).astype(np.int64)
    beside = np.zeros(len(points), dtype=np.int64)
    _find_beside(
        triangles, source, 0, len(triangles), group, points, np.tile(group[own], len(_ASIDE)), start, order.astype(np.int64), _CELL,
        columns, lines, sight.pixels, int(sight.perspective), _HEIGHT, beside,
    )  # fmt: skip
    made[rows] = (beside != 0).reshape(len(_ASIDE), -1).all(axis=0)
    return made


def _groups(faces: Faces, n_triangles: int) -> Indices:
    """(m,): a number for each triangle, the same for those that hang together."""
    opposite = faces.adjacency.opposite
    one = np.flatnonzero(opposite > np.arange(len(opposite)))
    return component_labels(n_triangles, one // 3, opposite[one] // 3).astype(np.int64)


def _outwards(places: Floats, normals: Floats, sight: SightLines) -> Floats:
    """Where surfaces turn away to, as directions on the picture, (n, 2), unit."""
    m = sight.matrix
    # On the picture a silhouette's normal points straight away from it: it stands upright on the line of sight.
    way = sight.towards(places)
    way = way / np.linalg.norm(way, axis=1, keepdims=True)
    flat = normals - (normals * way).sum(axis=1, keepdims=True) * way
    made = np.stack([flat @ m[0, :3], -(flat @ m[1, :3])], axis=1)
    return np.asarray(made / np.maximum(np.hypot(made[:, 0], made[:, 1]), 1e-300)[:, None])
