"""Antialiasing by area: how much of each pixel a polygon covers (FoCG 8.2.1, 8.3).

A pixel that a shape covers by a third is a third of its colour. The share is the exact area of the shape's part inside the
pixel's square: the limit of infinitely many samples and a box filter. So the coverage of a shape adds up to its area, that of
two neighbours with a common edge to one, and a shape moved by a hundredth of a pixel changes by a hundredth.

Polygons come as rings of points. What is inside is told by how often the rings wind around a place: any number but zero
("nonzero"), or an odd number ("evenodd"). A ring inside another is a hole under "evenodd", and under "nonzero" if it turns the
other way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._door import Array, Door, Scalar
from ..errors import SceneError, UnsupportedError
from ..linear.project import check_size

__all__ = [
    "RULES", "Bounds", "Edges", "coverage", "edges_of_each", "edges_of_polygons", "edges_of_rings", "fill_edges",
    "mosaic_edges",
]  # fmt: skip

Floats = NDArray[np.float64]
Bounds = tuple[float, float, float, float]
"""Left, top, right, bottom, in pixels with their centres at integers."""

RULES = ("nonzero", "evenodd")
_OVER, _MASK, _MOSAIC = 0, 1, 2  # as in coverage_kernel
_MANY_SHAPES = 256
_BAND_BYTES = 1 << 19
_LEVEL = 1e-12  # pixels: what rises less has no area beside it
_GREATEST = 1e7  # pixels: far enough from the picture, and its ninth decimal still counts

_fill = Door(
    "limner.draw.coverage_kernel",
    "fill_shapes",
    (
        Array(np.float64, 2), Array(np.int64, 1), Array(np.int64, 1), Array(np.int64, 1), Array(np.float64, 1),
        Scalar(np.int64), Array(np.float64, 2), Scalar(np.int64), Array(np.float32, 3), Array(np.int64, 1),
        Array(np.float64, 2), Array(np.float64, 1), Array(np.int64, 1),
    ),
    "antialiased drawing",
)  # fmt: skip


class Edges(NamedTuple):
    """The edges of n shapes, as the kernel reads them.

    Attributes
    ----------
    values : (m, 4) float64
        x and y of the upper end, y of the lower, dx/dy; within each shape by rising y. Pixels, with corners at integers.
    winding : (m,) int64
        +1 where the edge was given downwards, -1 upwards.
    starts : (n + 1,) int64
        Where each shape's edges begin; the last is m.
    """

    values: Floats
    winding: NDArray[np.int64]
    starts: NDArray[np.int64]


def coverage(rings: Sequence[ArrayLike], width: int, height: int, rule: str = "nonzero") -> NDArray[np.float32]:
    """Compute the part of each pixel that a polygon covers.

    Parameters
    ----------
    rings : sequence of (k, 2) float
        Points x, y; each ring is closed from its last to its first. They may cross themselves and each other.
    width, height : int
    rule : "nonzero" | "evenodd"

    Returns
    -------
    (height, width) float32 in [0, 1]
        Row 0 on top.

    >>> coverage([[(0, 0), (2, 0), (2, 1), (0, 1)]], 4, 2).tolist()
    [[0.25, 0.5, 0.25, 0.0], [0.25, 0.5, 0.25, 0.0]]

    **Source**: see `limner.draw.coverage_kernel`.
    """
    check_size(width, height)
    made = np.zeros((height, width, 1), dtype=np.float32)
    _run(edges_of_rings(rings), np.zeros((1, 4)), _MASK, rule, (-0.5, -0.5, width - 0.5, height - 0.5), made)
    return np.minimum(made[..., 0], np.float32(1.0))


def fill_edges(edges: Edges, colors: Floats, rule: str, bounds: Bounds, target: NDArray[np.float32]) -> None:
    """Paint shapes over a picture, one after the other.

    Parameters
    ----------
    edges : Edges
        Of n shapes.
    colors : (n, 4) float64
        Premultiplied.
    rule : "nonzero" | "evenodd"
    bounds : Bounds
        What lies outside is not painted; pixels that the bounds cut are painted in part.
    target : (height, width, 4) float32
        Premultiplied, row 0 on top.
    """
    _run(edges, colors, _OVER, rule, bounds, target)


def mosaic_edges(edges: Edges, gradients: Floats, bounds: Bounds, target: NDArray[np.float32]) -> None:
    """Add tiles to a layer of colour and coverage.

    Parameters
    ----------
    edges : Edges
        Of n tiles.
    gradients : (n, 20) float64
        Premultiplied colour at x = y = 0, its change along x and along y, its least and its greatest values.
    bounds : Bounds
    target : (height, width, 5) float32
        Premultiplied colour and coverage; added to.
    """
    _run(edges, gradients, _MOSAIC, "nonzero", bounds, target)


def edges_of_rings(rings: Sequence[ArrayLike]) -> Edges:
    """Make one shape of rings of points x, y in pixels with their centres at integers."""
    checked = [_ring(ring) for ring in rings]
    start = np.concatenate(checked) if checked else np.empty((0, 2))
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in checked]) if checked else start
    return _sorted(start, end, np.zeros(len(start), dtype=np.int64), 1)


def edges_of_polygons(parts: Sequence[Floats]) -> Edges:
    """Make one shape of many polygons: parts (n, k, 2) float64, each of n polygons with k points."""
    start = np.concatenate([part.reshape(-1, 2) for part in parts]) if parts else np.empty((0, 2))
    end = np.concatenate([np.roll(part, -1, axis=1).reshape(-1, 2) for part in parts]) if parts else start
    return _sorted(_ring(start), end, np.zeros(len(start), dtype=np.int64), 1)


def edges_of_each(polygons: Floats) -> Edges:
    """Make n shapes of n polygons with equally many points, (n, k, 2) float64."""
    n, k = polygons.shape[:2]
    start = _ring(polygons.reshape(-1, 2))
    return _sorted(start, np.roll(polygons, -1, axis=1).reshape(-1, 2), np.repeat(np.arange(n), k), n)


def _ring(ring: ArrayLike) -> Floats:
    try:
        points = np.asarray(ring, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"points must be pairs of numbers x, y, got {type(ring).__name__}") from None
    if points.ndim != 2 or points.shape[1] != 2:
        raise SceneError(f"points must have shape (n, 2), got {points.shape}")
    if not (np.abs(points) <= _GREATEST).all():
        far = points[~(np.abs(points) <= _GREATEST)][0]
        raise SceneError(f"points must be finite and within {_GREATEST:.0f} pixels of the picture's corner, got {far}")
    return points


def _sorted(start: Floats, end: Floats, shape: NDArray[np.int64], n_shapes: int) -> Edges:
    """Turn edges downwards, leave out the level ones, and put them in order."""
    rise = end[:, 1] - start[:, 1]
    kept = np.flatnonzero(np.abs(rise) > _LEVEL)
    start, end, rise, shape = start[kept], end[kept], rise[kept], shape[kept]
    down = rise > 0.0
    upper = np.where(down[:, None], start, end)
    lower = np.where(down[:, None], end, start)
    order = np.lexsort((upper[:, 1], shape)) if n_shapes > 1 else np.argsort(upper[:, 1], kind="stable")
    values = np.empty((len(kept), 4))
    values[:, :2] = upper[order] + 0.5
    values[:, 2] = lower[order, 1] + 0.5
    difference = (lower - upper)[order]
    values[:, 3] = difference[:, 0] / difference[:, 1]
    starts = np.searchsorted(shape[order], np.arange(n_shapes + 1))
    return Edges(values, np.where(down, 1, -1)[order].astype(np.int64), starts.astype(np.int64))


def _run(edges: Edges, paint: Floats, mode: int, rule: str, bounds: Bounds, target: NDArray[np.float32]) -> None:
    if rule not in RULES:
        raise UnsupportedError(f"rule must be one of {', '.join(RULES)}, got {rule!r}")
    height, width = target.shape[:2]
    held = np.clip(np.array(bounds) + 0.5, 0.0, (width, height, width, height))
    if len(edges.values) == 0 or not (held[0] < held[2] and held[1] < held[3]):
        return
    most = int(np.diff(edges.starts).max())
    scratch = np.empty(most, dtype=np.int64), np.empty((4, most)), np.zeros(width + 2), np.empty(2, dtype=np.int64)
    for part, shapes in _bands(edges, held, target[0].nbytes):
        _fill(*edges, shapes, part, int(rule == "evenodd"), np.ascontiguousarray(paint), mode, target, *scratch)


def _bands(edges: Edges, bounds: Floats, row_bytes: int) -> Iterator[tuple[Floats, NDArray[np.int64]]]:
    """Cut the picture into bands of rows that a processor's cache holds, each with the shapes that reach into it.

    Many shapes all over a large picture would fetch each pixel from memory anew; within a band they do not.
    """
    n_shapes = len(edges.starts) - 1
    if n_shapes < _MANY_SHAPES:
        yield bounds, np.arange(n_shapes)
        return
    filled = np.flatnonzero(np.diff(edges.starts))
    upper = np.minimum.reduceat(edges.values[:, 1], edges.starts[filled])
    lower = np.maximum.reduceat(edges.values[:, 2], edges.starts[filled])
    rows = max(8, _BAND_BYTES // row_bytes)
    for top in range(int(bounds[1]), math.ceil(bounds[3]), rows):
        part = np.array([bounds[0], max(bounds[1], top), bounds[2], min(bounds[3], top + rows)])
        yield part, filled[(lower > part[1]) & (upper < part[3])]
