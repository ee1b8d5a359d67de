"""Implicit curves: all points of the plane where f(x, y) = 0, traced to lines (FoCG 15.1).

    +---+---+        f is asked at the corners of a grid; where two neighbours differ in sign the curve passes between them, and is
    | - | - |        found there by halving. In each cell the passages are joined. Where all four sides have one, two pairings are
    +-o-+-o-+        possible, and the sign in the middle of the cell says which.
    | + | + |

Every passage is shared by two cells, and in each cell joined to one other; so lines never end but at the border of the picture (or where
f is not defined), never branch, and those within it close. What is smaller than a cell can be missed: a finer grid finds it.

**Source**: Lorensen and Cline, "Marching cubes", 1987, in the plane; Nielson and Hamann, "The asymptotic decider", 1991, for the doubtful
cells, here decided by the function itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .control import degree_of

__all__ = ["Trace", "traced"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Function = Callable[[Floats, Floats], ArrayLike]

_MOST_CELLS = 1 << 24
_HALVINGS = 52
_REFINEMENTS = 12
_MOST_POINTS = 1 << 22


class Trace(NamedTuple):
    """One line of an implicit curve.

    Attributes
    ----------
    points : (k, 2) float64
        With f > 0 (or 0) on the left. Of a closed line the first is not repeated.
    closed : bool
    """

    points: Floats
    closed: bool


def traced(
    function: Function, bounds: tuple[float, float, float, float], resolution: int = 64, tolerance: float | None = None
) -> list[Trace]:
    """Trace f(x, y) = 0.

    Parameters
    ----------
    function : callable
        x and y, (...) float64, to (...) float. NaN where it is not defined: lines end there.
    bounds : (left, bottom, right, top)
    resolution : int >= 1
        Cells along the longer side; cells are about square.
    tolerance : float > 0, optional
        Lines are refined until their middles are no farther than this from the curve; None: a thousandth of a cell.

    Returns
    -------
    list of Trace
        Closed lines, and lines that end at the border; in the order in which rows of cells, from the bottom, meet them.

    Examples
    --------
    >>> (circle,) = traced(lambda x, y: x * x + y * y - 1.0, (-2.0, -2.0, 2.0, 2.0), 16)
    >>> circle.closed, bool(np.allclose(np.linalg.norm(circle.points, axis=1), 1.0))
    (True, True)
    """
    left, bottom, right, top = (float(value) for value in bounds)
    if not (np.isfinite([left, bottom, right, top]).all() and left < right and bottom < top):
        raise SceneError(f"bounds must be (left, bottom, right, top) with left < right and bottom < top, got {bounds}")
    cell = max(right - left, top - bottom) / degree_of(resolution, 1)
    columns, rows = max(1, math.ceil((right - left) / cell - 1e-9)), max(1, math.ceil((top - bottom) / cell - 1e-9))
    if columns * rows > _MOST_CELLS:
        raise SceneError(f"a grid of {columns} by {rows} cells is more than {_MOST_CELLS:,}")
    if tolerance is not None and not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"the tolerance of a trace must be positive, got {tolerance}")
    x, y = np.linspace(left, right, columns + 1), np.linspace(bottom, top, rows + 1)
    f = _Asked(function)
    grid_x, grid_y = np.meshgrid(x, y)
    values = f(grid_x, grid_y)
    places, of_side = _passages(f, x, y, values)
    lines = _lines(_links(f, x, y, values, of_side), len(places))
    fine = 1e-3 * cell if tolerance is None else tolerance
    return [_refined(f, Trace(places[line], closed), fine, cell) for line, closed in lines]


class _Asked:
    """The function, with what it returns checked."""

    def __init__(self, function: Function) -> None:
        self.function = function

    def __call__(self, x: Floats, y: Floats) -> Floats:
        with np.errstate(all="ignore"):
            made = np.asarray(self.function(x, y), dtype=np.float64)
        if made.shape != x.shape:
            made = np.broadcast_to(made, x.shape) if made.ndim == 0 else made
            if made.shape != x.shape:
                raise SceneError(f"an implicit function must return one number for each point, shape {x.shape}, got {made.shape}")
        return made


def _passages(f: _Asked, x: Floats, y: Floats, values: Floats) -> tuple[Floats, tuple[Indices, Indices]]:
    """Where the curve passes the grid's sides; and for each side, horizontal and vertical, the number of its passage or -1."""
    # f >= 0 is inside: a zero in a corner belongs to one side, and nothing is found twice
    inside, known = values >= 0.0, ~np.isnan(values)
    across = (inside[:, 1:] != inside[:, :-1]) & known[:, 1:] & known[:, :-1]
    along = (inside[1:] != inside[:-1]) & known[1:] & known[:-1]
    of_across, of_along = np.full(across.shape, -1), np.full(along.shape, -1)
    of_across[across] = np.arange(across.sum())
    of_along[along] = across.sum() + np.arange(along.sum())
    (i, j), (k, m) = np.nonzero(across), np.nonzero(along)
    starts = np.concatenate([np.stack([x[j], y[i]], axis=1), np.stack([x[m], y[k]], axis=1)])
    ends = np.concatenate([np.stack([x[j + 1], y[i]], axis=1), np.stack([x[m], y[k + 1]], axis=1)])
    return _root(f, starts, ends, np.concatenate([inside[i, j], inside[k, m]])), (of_across, of_along)


def _root(f: _Asked, starts: Floats, ends: Floats, starts_inside: NDArray[np.bool_]) -> Floats:
    """A point between two at which the sign changes, by halving: sure, and exact to the last digits."""
    a, b = starts.copy(), ends.copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (a + b)
        same = ((f(middle[:, 0], middle[:, 1]) >= 0.0) == starts_inside)[:, None]
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    return 0.5 * (a + b)


def _links(f: _Asked, x: Floats, y: Floats, values: Floats, of_side: tuple[Indices, Indices]) -> Indices:
    """(k, 2) passages that are joined, from and to, with f >= 0 on the left."""
    across, along = of_side
    bottom, top, left, right = across[:-1], across[1:], along[:, :-1], along[:, 1:]
    inside = values >= 0.0
    a, b, c, d = inside[:-1, :-1], inside[:-1, 1:], inside[1:, 1:], inside[1:, :-1]
    known = ~np.isnan(values)
    whole = known[:-1, :-1] & known[:-1, 1:] & known[1:, 1:] & known[1:, :-1]
    case = np.where(whole, a + 2 * b + 4 * c + 8 * d, 0)
    sides = {"bottom": bottom, "top": top, "left": left, "right": right}
    links = [np.zeros((0, 2), dtype=np.int64)]

    def join(cells: NDArray[np.bool_], start: str, end: str) -> None:
        links.append(np.stack([sides[start][cells], sides[end][cells]], axis=1))

    for number, start, end in _JOINS:
        join(case == number, start, end)
    # Doubtful cells: opposite corners alike; the middle says whether the inside goes through
    row, column = np.nonzero((case == 5) | (case == 10))
    if len(row):
        middle = np.zeros(case.shape, dtype=bool)
        middle[row, column] = f(0.5 * (x[column] + x[column + 1]), 0.5 * (y[row] + y[row + 1])) >= 0.0
        for number, through, pairs in _DOUBTFUL:
            for start, end in pairs:
                join((case == number) & (middle == through), start, end)
    return np.concatenate(links)


# Which corners are inside (1 lower left, 2 lower right, 4 upper right, 8 upper left), and how the line runs, them on its left
_JOINS = (
    (1, "bottom", "left"), (2, "right", "bottom"), (4, "top", "right"), (8, "left", "top"),
    (3, "right", "left"), (6, "top", "bottom"), (12, "left", "right"), (9, "bottom", "top"),
    (7, "top", "left"), (11, "right", "top"), (13, "bottom", "right"), (14, "left", "bottom"),
)  # fmt: skip
_DOUBTFUL = (
    (5, False, (("bottom", "left"), ("top", "right"))), (5, True, (("bottom", "right"), ("top", "left"))),
    (10, False, (("right", "bottom"), ("left", "top"))), (10, True, (("left", "bottom"), ("right", "top"))),
)  # fmt: skip


def _lines(links: Indices, count: int) -> list[tuple[Indices, bool]]:
    """Chains of passages, and whether they close."""
    following, before = np.full(count, -1), np.full(count, -1)
    following[links[:, 0]], before[links[:, 1]] = links[:, 1], links[:, 0]
    seen = np.zeros(count, dtype=bool)
    lines = []
    # First from where nothing leads to, then round what is left
    for start in [*np.flatnonzero((before < 0) & (following >= 0)).tolist(), *np.flatnonzero(following >= 0).tolist()]:
        if seen[start]:
            continue
        line, at = [], start
        while at >= 0 and not seen[at]:
            seen[at] = True
            line.append(at)
            at = int(following[at])
        lines.append((np.array(line), at == start))
    return lines


def _refined(f: _Asked, trace: Trace, tolerance: float, cell: float) -> Trace:
    """Put points of the curve between those of a line whose middle is too far from it."""
    points = np.concatenate([trace.points, trace.points[:1]]) if trace.closed else trace.points
    # Passages of two sides near a corner can be one point
    points = points[np.concatenate([[True], np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-12 * cell])]
    straight = np.zeros(len(points) - 1, dtype=bool)
    for _ in range(_REFINEMENTS):
        legs = np.diff(points, axis=0)
        lengths = np.linalg.norm(legs, axis=1)
        doubtful = ~straight & (lengths > 2.0 * tolerance)
        if not doubtful.any() or len(points) > _MOST_POINTS:
            break
        middle = 0.5 * (points[:-1] + points[1:])
        normal = np.stack([-legs[:, 1], legs[:, 0]], axis=1) / np.where(lengths > 0.0, lengths, 1.0)[:, None]
        found, moved = _across(f, middle, normal, 0.5 * lengths, doubtful)
        bent = moved > tolerance
        straight |= doubtful & ~bent
        place = np.flatnonzero(bent)
        points = np.insert(points, place + 1, found[place], axis=0)
        straight = np.insert(straight, place + 1, False)
    return Trace(points[:-1] if trace.closed else points, trace.closed)


def _across(
    f: _Asked, middle: Floats, normal: Floats, reach: Floats, asked: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Points of the curve across lines from their middles, and how far these are; 0 where none is within reach."""
    left, right = middle + reach[:, None] * normal, middle - reach[:, None] * normal
    with np.errstate(invalid="ignore"):
        row = np.flatnonzero(asked & (f(left[:, 0], left[:, 1]) >= 0.0) & (f(right[:, 0], right[:, 1]) < 0.0))
    found = middle.copy()
    found[row] = _root(f, left[row], right[row], np.ones(len(row), dtype=bool))
    return found, np.linalg.norm(found - middle, axis=1)
