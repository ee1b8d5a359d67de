"""Packing: charts laid side by side in the unit square, all in one scale, with some texels between them.

Charts become sets of texels, turned by the angle at which their bounding box is smallest, and by quarter turns from there. The tallest is
placed first (or the largest, where that fits better), each at the lowest place where it fits in any of its four positions, also in the
holes and bays of others. The common scale is the largest one found by bisection at which all of them stay in the square. Charts are never
mirrored.

**Source**: the texels and the order: Lévy, Petitjean, Ray and Maillot 2002, section 4, with an exact test in place of their horizon.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._door import Array, Door, Scalar
from ...errors import SceneError
from .pieces import Pieces

__all__ = ["Packing", "boxes", "pack"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_i1, _i2, _n = Array(np.int64, 1), Array(np.int64, 2), Scalar(np.int64)
_cover = Door("limner.mesh.unwrap.packing_kernel", "cover", (Array(np.float64, 3), _i2), "charts as texels")
_runs_of = Door("limner.mesh.unwrap.packing_kernel", "runs_of", (_i2, _i1, _i1, _i1, _i1), "charts as runs of texels")
_find_place = Door(
    "limner.mesh.unwrap.packing_kernel", "find_place", (_i2, _i1, _i1, _i1, _n, _n, _n, _n, _i1), "the packing of charts"
)
_take = Door("limner.mesh.unwrap.packing_kernel", "take", (_i2, _i2, _i1, _i1, _i1, _n, _n, _n, _n), "the packed square")

_ANGLES = 45
_TRIES = 8
_MORE_TRIES = 30
_INSET = 0.01  # texels
_FEW = 100  # charts, so that another order is worth its time
_HOPEFUL = 0.8  # of the square, that charts fill at the first scale tried


class Packing(NamedTuple):
    """Charts in the unit square.

    Attributes
    ----------
    uvs : (n, 2) float64
        Of the chart vertices.
    scale : float
        Length in the square of a unit of length of the flattened charts.
    filled : float
        Part of the square that charts cover.
    """

    uvs: Floats
    scale: float
    filled: float


class _Footprint(NamedTuple):
    """A chart as runs of texels, the longest first."""

    rows: Indices
    starts: Indices
    sizes: Indices
    width: int
    height: int


def pack(pieces: Pieces, flat: Floats, resolution: int, margin: int) -> Packing:
    """Lay flattened charts side by side.

    Parameters
    ----------
    pieces : Pieces
    flat : (n, 2) float64
    resolution : int
        Texels along a side of the square.
    margin : int
        Texels that are left free between any two charts, and half as many along the sides.

    Raises SceneError where so many charts do not fit, however small.
    """
    upright = _upright(pieces, flat)
    area = float(np.abs(pieces.signed_areas(flat)).sum())
    low, high = 0.0, np.inf
    border = 2 * ((margin + 1) // 2)
    longest = float(np.ptp(upright, axis=0).max(initial=0.0))
    room = max(resolution - border - 1e-6, 0.5)
    scale = min(resolution * float(np.sqrt(_HOPEFUL / max(area, 1e-300))), room / max(longest, 1e-300))
    best: Floats | None = None
    for attempt in range(_TRIES + _MORE_TRIES):
        placed = _placed(pieces, upright, scale, resolution, margin, by_area=False)
        if placed is None and pieces.n_charts <= _FEW:
            placed = _placed(pieces, upright, scale, resolution, margin, by_area=True)
        if placed is None:
            high = scale
        else:
            best, low = placed, scale
        if best is not None and (attempt >= _TRIES or high < 1.003 * low or not low < room / longest):
            break
        scale = scale * (0.92 if attempt < _TRIES else 0.6) if best is None else min(1.06 * low, (low + high) / 2.0)
    if best is None:
        raise SceneError(
            f"{pieces.n_charts} charts do not fit into {resolution} x {resolution} texels with a margin of {margin}: "
            "ask for a higher resolution or a smaller margin"
        )
    return Packing(best / resolution, low / resolution, area * (low / resolution) ** 2)


def boxes(pieces: Pieces, flat: Floats) -> tuple[Floats, Floats, Floats]:
    """(charts,) each: the angle by which to turn a chart so that its bounding box is smallest, and upright; its area and height."""
    first = pieces.rims.first[:-1]
    points = flat[pieces.rim_corners]
    best, turn, tall = np.full(pieces.n_charts, np.inf), np.zeros(pieces.n_charts), np.zeros(pieces.n_charts)
    for angle in np.arange(_ANGLES) * (0.5 * np.pi / _ANGLES):
        c, s = np.cos(angle), np.sin(angle)
        x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
        width = np.maximum.reduceat(x, first) - np.minimum.reduceat(x, first)
        height = np.maximum.reduceat(y, first) - np.minimum.reduceat(y, first)
        smaller = width * height < best * (1.0 - 1e-9)
        best, tall = np.where(smaller, width * height, best), np.where(smaller, np.maximum(width, height), tall)
        turn = np.where(smaller, angle + np.where(width > height, 0.5 * np.pi, 0.0), turn)
    return turn, best, tall


def _upright(pieces: Pieces, flat: Floats) -> Floats:
    """Turn each chart so that its bounding box is smallest, the longer side up, and move it into the corner of the quadrant."""
    turn, _, _ = boxes(pieces, flat)
    c, s = np.cos(turn)[pieces.chart_of], np.sin(turn)[pieces.chart_of]
    turned = np.stack([c * flat[:, 0] - s * flat[:, 1], s * flat[:, 0] + c * flat[:, 1]], axis=1)
    lowest = np.full((pieces.n_charts, 2), np.inf)
    np.minimum.at(lowest, pieces.chart_of, turned)
    return turned - lowest[pieces.chart_of]


def _placed(pieces: Pieces, upright: Floats, scale: float, resolution: int, margin: int, by_area: bool) -> Floats | None:
    """(n, 2) vertices in texels, or None: the charts do not fit at this scale, placed by height or by area."""
    border = (margin + 1) // 2
    side = resolution - 2 * border
    # No point on the edge of a texel, where rounding decides about what it touches
    points = upright * scale + _INSET
    sizes = np.zeros((pieces.n_charts, 2))
    np.maximum.at(sizes, pieces.chart_of, points + _INSET)
    if side < 1 or np.floor(sizes).max(initial=0.0) + 1 > side:
        return None
    by_chart = np.argsort(pieces.charts, kind="stable")
    bounds = np.searchsorted(pieces.charts[by_chart], np.arange(pieces.n_charts + 1))
    corners = points[pieces.corners[by_chart]]
    taken = np.zeros((side, side), dtype=np.int64)
    next_taken = np.full((side, side + 1), side, dtype=np.int64)
    quarters, offsets = np.zeros(pieces.n_charts, np.int64), np.zeros((pieces.n_charts, 2))
    found = np.zeros(2, dtype=np.int64)
    first = pieces.chart_areas if by_area else sizes[:, 1] + 1e-3 * sizes[:, 0]
    for chart in np.argsort(-first, kind="stable"):
        part = corners[bounds[chart] : bounds[chart + 1]]
        upper = _footprint(part, sizes[chart])
        limit, place = side, None
        for quarter in range(4):
            print_ = _turned(upper, quarter)
            if print_.height > limit or print_.width > side:
                continue
            _find_place(
                next_taken, print_.rows, print_.starts, print_.sizes, print_.width, print_.height, side, limit, found
            )
            if found[1] >= 0:
                place = (print_, quarter, int(found[0]), int(found[1]))
                limit = int(found[1]) + print_.height - 1
        if place is None:
            return None
        print_, quarter, x, y = place
        _take(taken, next_taken, print_.rows, print_.starts, print_.sizes, x, y, print_.height, margin)
        quarters[chart], offsets[chart] = quarter, (x + border, y + border)
    return _moved(pieces, points, np.floor(sizes) + 1.0, quarters) + offsets[pieces.chart_of]


def _moved(pieces: Pieces, points: Floats, sizes: Floats, quarters: Indices) -> Floats:
    """Turn charts by quarters about their texels, as `_turned` turns those."""
    q, (width, height) = quarters[pieces.chart_of], sizes[pieces.chart_of].T
    x, y = points.T
    return np.stack([np.choose(q, [x, height - y, width - x, y]), np.choose(q, [y, x, height - y, width - x])], axis=1)


def _footprint(corners: Floats, size: Floats) -> NDArray[np.int64]:
    """(height, width) int64: 1 where a texel is touched."""
    grid = np.zeros((int(size[1]) + 1, int(size[0]) + 1), dtype=np.int64)
    _cover(np.ascontiguousarray(corners), grid)
    return grid


def _turned(grid: NDArray[np.int64], quarter: int) -> _Footprint:
    """The runs of a chart turned counter-clockwise by quarters; rows count upwards."""
    turned = np.ascontiguousarray(np.rot90(grid, -quarter))
    height, width = turned.shape
    room = height * (width // 2 + 1)
    rows, starts, sizes, count = (np.empty(k, dtype=np.int64) for k in (room, room, room, 1))
    _runs_of(turned, rows, starts, sizes, count)
    n = int(count[0])
    order = np.argsort(-sizes[:n], kind="stable")
    return _Footprint(rows[:n][order], starts[:n][order], sizes[:n][order], width, height)
