"""Paths: what is filled and stroked, made of straight lines, Bézier curves and arcs of ellipses (FoCG 8.2.1, 15.6.1).

    heart = Path().move_to(50, 30).cubic_to(50, 0, 0, 0, 0, 40).cubic_to(0, 60, 30, 75, 50, 100).close()
    ring = Path().circle(50, 50, 40).circle(50, 50, 20)       # a hole under the rule "evenodd"

Coordinates are pixels with their centres at integers, x to the right, y down; angles are radians from +x towards +y, which on
the screen is clockwise. To be drawn a path is flattened: curves become chords that nowhere stray from them by more than a
tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..curves import bezier
from ..errors import SceneError

__all__ = ["TOLERANCE", "Arc", "Chain", "Cubic", "Lines", "Path", "Subpath"]

Floats = NDArray[np.float64]

TOLERANCE = 0.004
"""Pixels that a chord may stray from its curve."""

_MOST_CHORDS = 1 << 14


class Lines(NamedTuple):
    """Straight on through points, (n, 2) float64."""

    points: Floats

    def flattened(self, start: Floats, tolerance: float) -> Floats:
        """The points after `start`."""
        return self.points

    @property
    def end(self) -> Floats:
        """(2,) float64"""
        return self.points[-1]


class Cubic(NamedTuple):
    """A cubic Bézier curve: its last three control points, (3, 2) float64; the first is where the path stands."""

    points: Floats

    def flattened(self, start: Floats, tolerance: float) -> Floats:
        """Points on the curve after `start`, evenly spaced in its parameter.

        **Source**: Wang, *The subdivision method for finding the intersection between two Bézier curves or surfaces*, 1984: n
        chords stray by at most d (d - 1) / (8 n^2) times the greatest second difference of the control points; here d = 3.
        """
        control = np.vstack([start, self.points])
        bend = float(np.linalg.norm(control[:-2] - 2.0 * control[1:-1] + control[2:], axis=1).max())
        chords = min(_MOST_CHORDS, max(1, math.ceil(math.sqrt(0.75 * bend / tolerance))))
        return bezier.evaluate(control, np.arange(1, chords + 1) / chords)

    @property
    def end(self) -> Floats:
        """(2,) float64"""
        return self.points[-1]


class Arc(NamedTuple):
    """A part of an ellipse.

    Attributes
    ----------
    center : (2,) float64
    radii : (2,) float64
        Along the ellipse's own axes.
    rotation : float
        Of these axes.
    start, sweep : float
        In the ellipse's parameter, before it is rotated; a negative sweep turns back.
    """

    center: Floats
    radii: Floats
    rotation: float
    start: float
    sweep: float

    def at(self, angle: ArrayLike) -> Floats:
        """(..., 2) float64: points of the ellipse."""
        a = np.asarray(angle, dtype=np.float64)
        x, y = self.radii[0] * np.cos(a), self.radii[1] * np.sin(a)
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return np.stack([self.center[0] + c * x - s * y, self.center[1] + s * x + c * y], axis=-1)

    def flattened(self, start: Floats, tolerance: float) -> Floats:
        """Points on the arc, its start left out."""
        n = arc_steps(float(self.radii.max()), abs(self.sweep), tolerance)
        points = self.at(self.start + self.sweep * np.arange(1, n + 1) / n)
        if abs(self.sweep) == 2.0 * math.pi:
            points[-1] = self.at(self.start)
        return points

    @property
    def end(self) -> Floats:
        """(2,) float64"""
        return self.at(self.start + self.sweep)


class Chain(NamedTuple):
    """A subpath, flattened.

    Attributes
    ----------
    points : (n, 2) float64
        No point is there twice in succession; where it is closed, the last is not the first either.
    closed : bool
    """

    points: Floats
    closed: bool


class Subpath:
    """A path's part between two moves.

    Attributes
    ----------
    start : (2,) float64
    pieces : list of Lines, Cubic and Arc
    closed : bool
    """

    def __init__(self, start: Floats) -> None:
        self.start = start
        self.pieces: list[Lines | Cubic | Arc] = []
        self.closed = False

    @property
    def end(self) -> Floats:
        """(2,) float64: where it stands."""
        return self.pieces[-1].end if self.pieces else self.start

    def flattened(self, tolerance: float) -> Chain:
        """Straight lines through all points."""
        points, at = [self.start[None, :]], self.start
        for piece in self.pieces:
            points.append(piece.flattened(at, tolerance))
            at = points[-1][-1]
        made = np.concatenate(points)
        made = made[np.concatenate([[True], (made[1:] != made[:-1]).any(axis=1)])]
        if self.closed and len(made) > 1 and (made[-1] == made[0]).all():
            made = made[:-1]
        return Chain(made, self.closed)


class Path:
    """An outline under construction; every method returns the path itself.

    >>> path = Path().move_to(0, 0).line_to(4, 0).line_to(4, 3).close()
    >>> path.flattened()[0].points.tolist(), path.flattened()[0].closed
    ([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]], True)
    """

    def __init__(self) -> None:
        self.subpaths: list[Subpath] = []

    def move_to(self, x: float, y: float) -> Path:
        """Begin a new subpath."""
        self.subpaths.append(Subpath(_points([[x, y]])[0]))
        return self

    def line_to(self, x: float, y: float) -> Path:
        """Go straight on."""
        return self.lines_to([[x, y]])

    def lines_to(self, points: ArrayLike) -> Path:
        """Go straight on through points, (n, 2) float."""
        made = _points(points)
        if len(made):
            self._open().pieces.append(Lines(made))
        return self

    def quadratic_to(self, x1: float, y1: float, x: float, y: float) -> Path:
        """Go on along a quadratic Bézier curve: it is the cubic with control points two thirds on the way to its own."""
        start, (control, end) = self._open().end, _points([[x1, y1], [x, y]])
        cubic = np.stack([start + (control - start) * (2.0 / 3.0), end + (control - end) * (2.0 / 3.0), end])
        self._open().pieces.append(Cubic(cubic))
        return self

    def cubic_to(self, x1: float, y1: float, x2: float, y2: float, x: float, y: float) -> Path:
        """Go on along a cubic Bézier curve."""
        self._open().pieces.append(Cubic(_points([[x1, y1], [x2, y2], [x, y]])))
        return self

    def close(self) -> Path:
        """Go straight back to where the subpath began, and join its ends."""
        self._open().closed = True
        return self

    def arc(
        self, x: float, y: float, radius_x: float, radius_y: float, start: float, sweep: float, rotation: float = 0.0
    ) -> Path:
        """Go straight to the start of an arc (or begin there), and along it.

        Parameters
        ----------
        x, y : float
            Centre.
        radius_x, radius_y : float >= 0
        start, sweep : float
            Radians, from +x towards +y; held to one turn.
        rotation : float
            Of the ellipse.
        """
        center, radii = _points([[x, y]])[0], _points([[radius_x, radius_y]])[0]
        if (radii < 0.0).any():
            raise SceneError(f"radii must not be negative, got {radius_x} and {radius_y}")
        angles = [float(angle) for angle in (rotation, start, sweep)]
        if not all(map(math.isfinite, angles)):
            raise SceneError(f"angles of an arc must be finite, got start {start}, sweep {sweep}, rotation {rotation}")
        arc = Arc(center, radii, angles[0], angles[1], min(max(angles[2], -2.0 * math.pi), 2.0 * math.pi))
        begin = arc.at(arc.start)
        if not self.subpaths or self.subpaths[-1].closed:
            self.subpaths.append(Subpath(begin))
        else:
            self.lines_to(begin[None, :])
        self.subpaths[-1].pieces.append(arc)
        return self

    def polyline(self, points: ArrayLike, closed: bool = False) -> Path:
        """Add a subpath through points, (n, 2) float."""
        made = _points(points)
        if len(made):
            self.subpaths.append(Subpath(made[0]))
            self.lines_to(made[1:])
            self.subpaths[-1].closed = closed
        return self

    def polygon(self, outline: ArrayLike, holes: Sequence[ArrayLike] = ()) -> Path:
        """Add closed rings, (n, 2) float each. Holes turn against the outline, so that they are holes under both rules."""
        ring = _points(outline)
        self.polyline(ring, closed=True)
        for hole in holes:
            made = _points(hole)
            self.polyline(made[::-1] if signed_area(made) * signed_area(ring) > 0.0 else made, closed=True)
        return self

    def rectangle(self, x: float, y: float, width: float, height: float, radius: float = 0.0) -> Path:
        """Add a rectangle from its corner (x, y), for whole pixels half a pixel from their centres; `radius` rounds it."""
        (x, y), (width, height) = _points([[x, y], [width, height]]).tolist()
        if not (width >= 0.0 and height >= 0.0 and 0.0 <= radius < math.inf):
            raise SceneError(f"a rectangle's sides and radius must not be negative, got {width}, {height} and {radius}")
        r = min(radius, width / 2.0, height / 2.0)
        if r == 0.0:
            return self.polyline([[x, y], [x + width, y], [x + width, y + height], [x, y + height]], closed=True)
        quarter = math.pi / 2.0
        self.move_to(x + r, y)
        for i, (cx, cy) in enumerate(((1, 0), (1, 1), (0, 1), (0, 0))):
            self.arc(x + (width - r if cx else r), y + (height - r if cy else r), r, r, (i - 1) * quarter, quarter)
        return self.close()

    def circle(self, x: float, y: float, radius: float) -> Path:
        """Add a circle."""
        return self.ellipse(x, y, radius, radius)

    def ellipse(self, x: float, y: float, radius_x: float, radius_y: float, rotation: float = 0.0) -> Path:
        """Add an ellipse whose axes are turned by `rotation`."""
        apart = Path().arc(x, y, radius_x, radius_y, 0.0, 2.0 * math.pi, rotation).close()
        self.subpaths += apart.subpaths
        return self

    def flattened(self, tolerance: float = TOLERANCE) -> list[Chain]:
        """Make straight lines of it, one chain for each subpath; they stray by at most `tolerance` pixels."""
        return [subpath.flattened(tolerance) for subpath in self.subpaths]

    def copy(self) -> Path:
        """A path of its own: what is added to one of the two is not added to the other."""
        made = Path()
        for subpath in self.subpaths:
            twin = Subpath(subpath.start)
            twin.pieces, twin.closed = list(subpath.pieces), subpath.closed
            made.subpaths.append(twin)
        return made

    def _open(self) -> Subpath:
        """The subpath that goes on; after a closed one a new one begins where it did."""
        if not self.subpaths:
            raise SceneError("a path must begin with move_to")
        if self.subpaths[-1].closed:
            self.subpaths.append(Subpath(self.subpaths[-1].start))
        return self.subpaths[-1]


def arc_steps(radius: float, sweep: float, tolerance: float) -> int:
    """How many chords a circle's arc needs: a chord over the angle a strays by r (1 - cos(a / 2))."""
    if radius <= tolerance:
        return max(1, math.ceil(4.0 * sweep / math.pi))
    return min(_MOST_CHORDS, max(1, math.ceil(sweep / (2.0 * math.acos(1.0 - tolerance / radius)))))


def signed_area(ring: Floats) -> float:
    """Half the sum of cross products; positive for rings that turn from +x towards +y."""
    x, y = ring.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _points(given: Any) -> Floats:
    try:
        points = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"points must be pairs of numbers x, y, got {given!r}") from None
    if points.size == 0:
        return points.reshape(0, 2)
    if points.ndim != 2 or points.shape[1] != 2:
        raise SceneError(f"points must have shape (n, 2), got {points.shape}")
    if not np.isfinite(points).all():
        raise SceneError("points of a path must be finite")
    return points
