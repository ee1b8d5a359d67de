"""Where curves in the plane meet each other.

Two Bézier curves can only meet where the boxes of their control points do. Both are halved, and pairs whose boxes are apart are left
out, all pairs at once, until what is left is nearly straight; then Newton's steps find the point, and the finds that are one point are
joined.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import bezier
from .bernstein import roots
from .control import control_points
from .curve import Spline

__all__ = ["Meeting", "crossings", "line_crossings", "meetings"]

Floats = NDArray[np.float64]

_MOST_PAIRS = 1 << 14
_OVERLAP = "the curves have a part in common, or nearly so: they meet in too many points to tell them apart"
_HALVINGS = 26
_NEWTON_STEPS = 24
_NEAR = 1e-2
_SAME = 1e-6  # parameters nearer than that are one meeting, if the points are one to rounding


class Meeting(NamedTuple):
    """A point that two curves have in common: the parameters on both, and the point, (2,) float64."""

    u: float
    v: float
    point: Floats


def line_crossings(points: ArrayLike, start: ArrayLike, end: ArrayLike) -> Floats:
    """Parameters in [0, 1] at which a Bézier curve crosses or touches the infinite line through two points, (k,) float64.

    >>> line_crossings([[0, 0], [1, 2], [2, 0]], (0, 0.75), (1, 0.75)).tolist()
    [0.25, 0.75]
    """
    control = control_points(points, dimension=2)
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    if a.shape != (2,) or b.shape != (2,) or not np.isfinite([a, b]).all() or (a == b).all():
        raise SceneError(f"a line goes through two points that differ, got {a.tolist()} and {b.tolist()}")
    return roots((b[0] - a[0]) * (control[:, 1] - a[1]) - (b[1] - a[1]) * (control[:, 0] - a[0]))


def crossings(first: ArrayLike, second: ArrayLike) -> list[Meeting]:
    """Find where two Bézier curves in the plane meet.

    Parameters
    ----------
    first : (m + 1, 2) float
    second : (n + 1, 2) float

    Returns
    -------
    list of Meeting
        In the order of their parameters on the first curve; touching counts once.

    Raises
    ------
    SceneError
        Where the curves have a part in common, and so infinitely many points.

    Examples
    --------
    >>> [(m.u, m.v) for m in crossings([[0, 0], [2, 2]], [[0, 2], [2, 0]])]
    [(0.5, 0.5)]
    """
    a, b = control_points(first, 2, dimension=2), control_points(second, 2, dimension=2)
    return _meetings(_Shape(a, False), _Shape(b, False))


class _Shape(NamedTuple):
    """A curve that can be asked for points, tangents and parts."""

    control: Floats
    rational: bool

    def shadow(self) -> Floats:
        return _shadow(self.control, self.rational)

    def lifted(self, u: Floats, order: int) -> Floats:
        return bezier.derivative(self.control, u, order)

    def at(self, u: Floats) -> Floats:
        made = self.lifted(u, 0)
        return made[..., :-1] / made[..., -1:] if self.rational else made

    def tangent(self, u: Floats) -> Floats:
        first = self.lifted(u, 1)
        if not self.rational:
            return first
        made = self.lifted(u, 0)
        return np.asarray((first[..., :-1] - made[..., :-1] / made[..., -1:] * first[..., -1:]) / made[..., -1:])


def meetings(first: Spline, second: Spline) -> list[Meeting]:
    """Find where two splines in the plane meet, rational ones too; parameters are those of the splines.

    A meeting at a knot is one meeting, though it belongs to two pieces; so is one where a closed spline comes back to its start.
    """
    if first.dimension != 2 or second.dimension != 2:
        raise SceneError(f"meetings are looked for in the plane, got curves of {first.dimension} and {second.dimension} coordinates")
    found = []
    for i, a in enumerate(first.pieces):
        for j, b in enumerate(second.pieces):
            for meeting in _meetings(_Shape(a, first.rational), _Shape(b, second.rational)):
                u = first.knots[i] + meeting.u * (first.knots[i + 1] - first.knots[i])
                v = second.knots[j] + meeting.v * (second.knots[j + 1] - second.knots[j])
                found.append(Meeting(float(u), float(v), meeting.point))
    return _once(found, _period(first), _period(second))


def _period(spline: Spline) -> tuple[float, bool]:
    """The length of the interval, and whether its ends are one point."""
    ends = spline.at(spline.knots[[0, -1]])
    return float(np.ptp(spline.knots)), bool(np.abs(ends[1] - ends[0]).max() <= 1e-9 * float(np.ptp(spline.at(spline.knots), axis=0).max()))


def _meetings(first: _Shape, second: _Shape) -> list[Meeting]:
    size = max(float(np.ptp(np.concatenate([first.shadow(), second.shadow()]), axis=0).max()), 1e-300)
    u, v = _candidates(first, second, size)
    if not len(u):
        return []
    u, v, residual = _polished(first, second, u, v)
    kept: list[tuple[float, float]] = []
    for row in np.argsort(residual, kind="stable").tolist():
        if residual[row] > 1e-11 * size:
            break
        if not any(_touching(first, second, (u[row], v[row]), other, 1e-10 * size) for other in kept):
            kept.append((float(u[row]), float(v[row])))
    # Bézout: curves of degrees m and n that have more points in common have infinitely many
    if len(kept) > (len(first.control) - 1) * (len(second.control) - 1):
        raise SceneError(_OVERLAP)
    return [Meeting(s, t, first.at(np.array(s))) for s, t in sorted(kept)]


def _touching(first: _Shape, second: _Shape, here: tuple[float, float], there: tuple[float, float], gap: float) -> bool:
    """Whether two finds are one: rounding cannot tell the curves apart between them."""
    if max(abs(here[0] - there[0]), abs(here[1] - there[1])) > _NEAR:
        return False
    u, v = 0.5 * np.add(here, there)
    return float(np.linalg.norm(first.at(u) - second.at(v))) <= gap


def _candidates(first: _Shape, second: _Shape, size: float) -> tuple[Floats, Floats]:
    """Middles of the pairs of parts that may meet, when both are nearly straight."""
    lows_a, lows_b = np.zeros(1), np.zeros(1)
    parts_a, parts_b = first.control[None], second.control[None]
    width = 1.0
    for _ in range(_HALVINGS):
        near = _boxes_meet(_shadow(parts_a, first.rational), _shadow(parts_b, second.rational), 1e-13 * size)
        lows_a, lows_b, parts_a, parts_b = lows_a[near], lows_b[near], parts_a[near], parts_b[near]
        if not len(lows_a):
            return lows_a, lows_b
        if len(lows_a) > _MOST_PAIRS:
            raise SceneError(_OVERLAP)
        if width <= 2.0**-10 and max(_bend(parts_a), _bend(parts_b)) < 1e-5 * size:
            break
        width *= 0.5
        count = len(lows_a)
        lows_a, parts_a = _halved(lows_a, parts_a, width)
        lows_b, parts_b = _halved(lows_b, parts_b, width)
        # Left with left and right, right with left and right
        of_a, of_b = np.repeat(np.arange(2 * count).reshape(2, -1), 2, axis=0).reshape(-1), np.tile(np.arange(2 * count), 2)
        lows_a, parts_a, lows_b, parts_b = lows_a[of_a], parts_a[of_a], lows_b[of_b], parts_b[of_b]
    return lows_a + 0.5 * width, lows_b + 0.5 * width


def _shadow(parts: Floats, rational: bool) -> Floats:
    return parts[..., :-1] / parts[..., -1:] if rational else parts


def _boxes_meet(a: Floats, b: Floats, slack: float) -> NDArray[np.bool_]:
    return np.asarray(
        ((a.min(axis=1) <= b.max(axis=1) + slack) & (b.min(axis=1) <= a.max(axis=1) + slack)).all(axis=1)
    )


def _bend(parts: Floats) -> float:
    return float(np.abs(np.diff(parts, n=2, axis=1)).max(initial=0.0))


def _halved(lows: Floats, parts: Floats, width: float) -> tuple[Floats, Floats]:
    """All left halves, then all right ones."""
    level, left, right = parts, [parts[:, 0]], [parts[:, -1]]
    while level.shape[1] > 1:
        level = 0.5 * (level[:, :-1] + level[:, 1:])
        left.append(level[:, 0])
        right.append(level[:, -1])
    halves = np.concatenate([np.stack(left, axis=1), np.stack(right[::-1], axis=1)])
    return np.concatenate([lows, lows + width]), halves


def _polished(first: _Shape, second: _Shape, u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Newton's steps for ``f(u) - g(v) = 0`` within both curves; where they touch, steps of least squares."""
    for _ in range(_NEWTON_STEPS):
        gap = first.at(u) - second.at(v)
        a, b = first.tangent(u), second.tangent(v)
        # Normal equations with a trace of damping: they have a solution where tangents are parallel
        aa, bb, ab = (a * a).sum(axis=1), (b * b).sum(axis=1), (a * b).sum(axis=1)
        damping = 1e-14 * (aa + bb) + 1e-300
        aa, bb = aa + damping, bb + damping
        ra, rb = -(gap * a).sum(axis=1), (gap * b).sum(axis=1)
        determinant = aa * bb - ab * ab
        determinant = np.where(determinant > 0.0, determinant, 1.0)
        u = np.clip(u + (bb * ra + ab * rb) / determinant, 0.0, 1.0)
        v = np.clip(v + (ab * ra + aa * rb) / determinant, 0.0, 1.0)
    return u, v, np.linalg.norm(first.at(u) - second.at(v), axis=1)


def _once(found: list[Meeting], of_first: tuple[float, bool], of_second: tuple[float, bool]) -> list[Meeting]:
    kept: list[Meeting] = []
    for meeting in sorted(found, key=lambda m: (m.u, m.v)):
        if not any(_same(meeting.u, other.u, *of_first) and _same(meeting.v, other.v, *of_second) for other in kept):
            kept.append(meeting)
    return kept


def _same(a: float, b: float, period: float, closed: bool) -> bool:
    apart = abs(a - b)
    return min(apart, period - apart if closed else apart) <= _SAME * period
