"""Flat outlines with holes, cut into triangles.

An ear is a corner whose triangle lies inside and holds no other corner; cut off ears until a triangle is left. A hole is first joined to
what is around it by a bridge, there and back, so that one outline is left:

    .-----------.         from the hole's rightmost corner straight to the right, to the nearest edge,
    |   .---.   |         and from there to the end of that edge, or to what is in the way
    |   |   *===*
    |   '---'   |
    '-----------'

**Source**: Meisters, "Polygons have ears", *The American Mathematical Monthly* 82, 1975; the bridges are Eberly's, *Triangulation by
Ear Clipping*, Geometric Tools, 2002.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..sizes import finite_points

__all__ = ["MOST_CORNERS", "oriented_outlines", "triangulated"]

MOST_CORNERS = 4096  # clipping and the search for crossings take quadratic time
_PAIRS_AT_ONCE = 1 << 21

Points = NDArray[np.float64]
Indices = NDArray[np.int64]


def oriented_outlines(outline: ArrayLike, holes: Sequence[ArrayLike], name: str) -> list[Points]:
    """Check an outline and its holes, and turn them.

    Parameters
    ----------
    outline, holes : (k, 2) float, k >= 3
        Simple polygons in any sense of turning, closed without repeating the first corner (which is allowed); holes inside the
        outline, apart from each other.
    name : str
        Of the shape, for errors.

    Returns
    -------
    list of (k, 2) float64
        The outline counter-clockwise, then the holes clockwise.
    """
    rings = [_ring(outline, f"{name}.outline"), *(_ring(hole, f"{name}.holes[{k}]") for k, hole in enumerate(holes))]
    if sum(len(ring) for ring in rings) > MOST_CORNERS:
        raise SceneError(f"{name} must not have more than {MOST_CORNERS} corners, got {sum(len(ring) for ring in rings)}")
    _check_crossings(rings, name)
    for k, hole in enumerate(rings[1:]):
        if not _holds(rings[0], hole[0]):
            raise SceneError(f"{name}.holes[{k}] must lie inside {name}.outline")
        if any(_holds(other, hole[0]) for m, other in enumerate(rings[1:]) if m != k):
            raise SceneError(f"{name}.holes[{k}] must not lie inside another hole")
    return [ring if (signed_area(ring) > 0.0) == (k == 0) else ring[::-1] for k, ring in enumerate(rings)]


def signed_area(ring: Points) -> float:
    """Area of a polygon (k, 2), positive counter-clockwise."""
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2.0)


def triangulated(rings: list[Points]) -> Indices:
    """Cut a counter-clockwise outline with clockwise holes (see `oriented_outlines`) into triangles.

    Returns
    -------
    (m, 3) int64
        Corners by their number in all rings, one after the other, counter-clockwise; m = number of corners - 2 + 2 number of holes.
        Every edge of the rings is the side of a triangle.
    """
    points = np.concatenate(rings)
    starts = np.cumsum([0, *(len(ring) for ring in rings)])
    holes = [np.arange(a, b) for a, b in itertools.pairwise(starts[1:])]
    line = np.arange(starts[1])
    for hole in sorted(holes, key=lambda corners: -float(points[corners, 0].max())):
        line = _bridged(points, line, hole)
    return _clipped(points[line], line)


def _ring(corners: ArrayLike, name: str) -> Points:
    ring = finite_points(corners, 2, 3, name)
    extent = float(np.ptp(ring, axis=0).max())
    ring = ring[(ring != np.roll(ring, -1, axis=0)).any(axis=1)]
    area = abs(signed_area(ring)) if len(ring) > 2 else 0.0
    if not area > 1e-12 * extent**2:
        raise SceneError(f"{name} must enclose an area, got {len(ring)} distinct corners around {area}")
    return ring


def _check_crossings(rings: list[Points], name: str) -> None:
    """Raise SceneError where edges that are not neighbours have a point in common."""
    a = np.concatenate(rings)
    following = np.concatenate([start + np.roll(np.arange(len(ring)), -1) for start, ring in zip(_starts(rings), rings, strict=True)])
    b = a[following]
    low, high = np.minimum(a, b), np.maximum(a, b)
    step = max(1, _PAIRS_AT_ONCE // len(a))
    for begin in range(0, len(a), step):
        rows = np.arange(begin, min(begin + step, len(a)))
        near = ((low[rows, None] <= high) & (low <= high[rows, None])).all(axis=2)
        first, second = np.nonzero(near)
        first = first + begin
        apart = (first < second) & (following[first] != second) & (following[second] != first)
        first, second = first[apart], second[apart]
        across = _side(a[first], b[first], a[second]) * _side(a[first], b[first], b[second]) <= 0.0
        across &= _side(a[second], b[second], a[first]) * _side(a[second], b[second], b[first]) <= 0.0
        if across.any():
            place = a[first[np.argmax(across)]].tolist()
            raise SceneError(f"{name}.outline and its holes must not touch or cross themselves or each other; they do near {place}")


def _starts(rings: list[Points]) -> list[int]:
    return [0, *np.cumsum([len(ring) for ring in rings]).tolist()][:-1]


def _side(a: Points, b: Points, p: Points) -> Points:
    """1 where p is on the left of a b, -1 on the right, 0 on the line."""
    return np.sign((b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0]))


def _holds(ring: Points, p: Points) -> bool:
    """Whether a point lies inside: a ray from it to the right crosses the ring an odd number of times."""
    q = np.roll(ring, -1, axis=0)
    spans = (ring[:, 1] > p[1]) != (q[:, 1] > p[1])
    a, b = ring[spans], q[spans]
    crossing = a[:, 0] + (p[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((crossing > p[0]).sum() % 2)


def _bridged(points: Points, line: Indices, hole: Indices) -> Indices:
    """Join a hole to the line around it, by a way there and back."""
    at = int(np.argmax(points[hole, 0]))
    m = points[hole[at]]
    a, b = points[line], points[np.roll(line, -1)]
    # The line is counter-clockwise, so that what bounds the inside on the right runs up
    spans = np.flatnonzero((a[:, 1] <= m[1]) & (b[:, 1] >= m[1]) & (b[:, 1] > a[:, 1]))
    x = a[spans, 0] + (m[1] - a[spans, 1]) / (b[spans, 1] - a[spans, 1]) * (b[spans, 0] - a[spans, 0])
    spans, x = spans[x >= m[0]], x[x >= m[0]]
    nearest = int(np.argmin(x))
    edge, hit = int(spans[nearest]), np.array([x[nearest], m[1]])
    end = edge if points[line[edge], 0] > points[line[(edge + 1) % len(line)], 0] else (edge + 1) % len(line)
    to = _first_in_the_way(points[line], m, hit, end)
    return np.concatenate([line[: to + 1], np.roll(hole, -at), hole[at : at + 1], line[to:]])


def _first_in_the_way(line: Points, m: Points, hit: Points, end: int) -> int:
    """The corner of the line that m sees for certain: `end`, or the one in the triangle (m, hit, end) that is least off the ray."""
    p = line[end]
    a, b, c = (m, hit, p) if p[1] > m[1] else (m, p, hit)
    inside = (_side(a, b, line) >= 0.0) & (_side(b, c, line) >= 0.0) & (_side(c, a, line) >= 0.0)
    before, after = np.roll(line, 1, axis=0), np.roll(line, -1, axis=0)
    # What turns to the left hides nothing; the end itself is looked at in all its copies
    reflex = _side(before, line, after) < 0.0
    same = (line == p).all(axis=1)
    candidates = np.flatnonzero((inside & reflex & (line[:, 0] > m[0])) | same)
    offset = np.abs(line[candidates] - m)
    slope = offset[:, 1] / np.maximum(offset[:, 0], 1e-300)
    least = candidates[slope == slope.min()]
    nearest = least[np.abs(line[least, 0] - m[0]) == np.abs(line[least, 0] - m[0]).min()]
    # Of copies that bridges have left, the one between whose sides m lies
    for k in nearest:
        left, right = _side(line[k], after[k], m) > 0.0, _side(before[k], line[k], m) > 0.0
        if (left and right) if _side(before[k], line[k], after[k]) >= 0.0 else (left or right):
            return int(k)
    return int(nearest[0])


def _clipped(p: Points, names: Indices) -> Indices:
    """Clip the ears of a polygon, counter-clockwise, whose corners may coincide where bridges are."""
    n = len(p)
    before, after = np.roll(np.arange(n), 1), np.roll(np.arange(n), -1)
    # Corners that do not turn to the left can lie in an ear; those that do stay so while ears are cut off
    reflex = np.flatnonzero(_side(p[before], p, p[after]) <= 0.0)
    triangles: list[tuple[int, int, int]] = []
    at, tried, left = 0, 0, n
    while left > 3:
        a, c = int(before[at]), int(after[at])
        if tried > 2 * left or _is_ear(p, a, at, c, reflex, allow_flat=tried > left):
            triangles.append((a, at, c))
            after[a], before[c] = c, a
            reflex = reflex[reflex != at]
            for k in (a, c):
                if _side(p[before[k]], p[k], p[after[k]]) > 0.0:
                    reflex = reflex[reflex != k]
            at, tried, left = c, 0, left - 1
            # Past the neighbour, so that slivers do not pile up in one corner
            at = int(after[at])
        else:
            at, tried = c, tried + 1
    triangles.append((int(before[at]), at, int(after[at])))
    return names[np.array(triangles, dtype=np.int64)]


def _is_ear(p: Points, a: int, b: int, c: int, reflex: Indices, *, allow_flat: bool) -> bool:
    turn = float(_side(p[a], p[b], p[c]))
    if turn < 0.0 or (turn == 0.0 and not allow_flat):
        return False
    q = p[reflex]
    inside = (_side(p[a], p[b], q) >= 0.0) & (_side(p[b], p[c], q) >= 0.0) & (_side(p[c], p[a], q) >= 0.0)
    q = q[inside]
    return not ((q != p[a]).any(axis=1) & (q != p[b]).any(axis=1) & (q != p[c]).any(axis=1)).any()
