"""Lines with a width: what a pen covers that follows a path (FoCG 8.1.1: thick lines).

A stroke is the union of simple pieces: a rectangle along each line, a wedge on the outer side of each corner, a cap at each
end. All pieces turn the same way, so the rule "nonzero" makes their union of them, and because coverage is exact the seams
between them do not show.

    butt    |====|        miter   the sides go on until they meet, unless that is too far
    round  (|====|)       round   a sector of a circle
    square [|====|]       bevel   the sides' ends, joined
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError
from .path import TOLERANCE, Chain, Path, arc_steps

__all__ = ["CAPS", "JOINS", "Pen", "dashed", "segment_polygons", "stroke_polygons"]

Floats = NDArray[np.float64]

CAPS = ("butt", "round", "square")
JOINS = ("miter", "round", "bevel")

_MOST_DASHES = 1_000_000
_STRAIGHT = 1e-9  # the sine of a turn that needs no join


@dataclass(frozen=True)
class Pen:
    """How a line is drawn.

    Parameters
    ----------
    width : float > 0
        Pixels. A line thinner than a pixel covers less of it, and so is fainter.
    cap : "butt" | "round" | "square"
        What ends look like: cut off, a half disc, half a square more.
    join : "miter" | "round" | "bevel"
        What corners look like.
    miter_limit : float >= 1
        A miter is cut off to a bevel where it would be longer than so many widths.
    dashes : tuple of float >= 0
        Lengths of strokes and gaps in turn, pixels; an odd number of them is taken twice. Empty: no gaps.
    dash_offset : float
        Where in the dashes the line begins.

    >>> Pen(3.0, cap="round", dashes=(6, 4)).dashes
    (6.0, 4.0)
    """

    width: float = 1.0
    cap: str = "butt"
    join: str = "miter"
    miter_limit: float = 4.0
    dashes: tuple[float, ...] = ()
    dash_offset: float = 0.0

    def __post_init__(self) -> None:
        if not (_is_number(self.width) and self.width > 0.0):
            raise SceneError(f"pen.width must be positive, got {self.width!r}")
        if self.cap not in CAPS:
            raise UnsupportedError(f"pen.cap must be one of {', '.join(CAPS)}, got {self.cap!r}")
        if self.join not in JOINS:
            raise UnsupportedError(f"pen.join must be one of {', '.join(JOINS)}, got {self.join!r}")
        if not (_is_number(self.miter_limit) and self.miter_limit >= 1.0):
            raise SceneError(f"pen.miter_limit must be at least 1, got {self.miter_limit!r}")
        if not _is_number(self.dash_offset):
            raise SceneError(f"pen.dash_offset must be finite, got {self.dash_offset!r}")
        dashes = tuple(self.dashes)
        if not all(_is_number(dash) and dash >= 0.0 for dash in dashes) or (dashes and sum(dashes) <= 0.0):
            raise SceneError(f"pen.dashes must be lengths that are not negative and not all zero, got {self.dashes!r}")
        object.__setattr__(self, "dashes", tuple(float(dash) for dash in dashes))


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and math.isfinite(value)


def stroke_polygons(path: Path, pen: Pen, tolerance: float = TOLERANCE) -> list[Floats]:
    """Find what a pen covers.

    Parameters
    ----------
    path : Path
    pen : Pen
    tolerance : float
        Pixels that round parts may stray.

    Returns
    -------
    list of (n, k, 2) float64
        Convex polygons, k points each, all of which turn from +x towards +y; the stroke is their union.

    **Source**: Adobe, *PostScript Language Reference*, 3rd edition, 4.5.1 and 8.2 (setlinecap, setlinejoin, setmiterlimit,
    setdash); W3C, *Scalable Vector Graphics (SVG) 2*, 13.5.
    """
    chains = path.flattened(tolerance)
    if pen.dashes:
        chains = [dash for chain in chains for dash in dashed(chain, pen)]
    found = [part for chain in chains for part in _chain_polygons(chain, pen, tolerance)]
    return [_turned(part) for part in found if len(part)]


def segment_polygons(segments: Floats, pen: Pen, tolerance: float = TOLERANCE) -> Floats:
    """One polygon for each of n separate lines: (n, 4) float64 to (n, k, 2) float64, caps included."""
    start, end = segments[:, :2], segments[:, 2:]
    along = end - start
    length = np.linalg.norm(along, axis=1)
    direction = np.where(length[:, None] > 0.0, along / np.where(length > 0.0, length, 1.0)[:, None], (1.0, 0.0))
    reach = 0.5 * pen.width * direction
    normal = np.stack([-reach[:, 1], reach[:, 0]], axis=1)
    if pen.cap == "round":
        half = _half_disc(pen.width, tolerance)
        cap = half[:, 0, None, None] * normal + half[:, 1, None, None] * reach
        return _turned(np.concatenate([end + cap, start - cap]).transpose(1, 0, 2))
    if pen.cap == "square":
        start, end = start - reach, end + reach
    return _turned(np.stack([start + normal, end + normal, end - normal, start - normal], axis=1))


def dashed(chain: Chain, pen: Pen) -> list[Chain]:
    """Cut a chain into its dashes."""
    points = np.vstack([chain.points, chain.points[:1]]) if chain.closed else chain.points
    if len(points) < 2:
        return [chain]
    reached = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    pattern = np.array(pen.dashes * (1 + len(pen.dashes) % 2))
    period, total = float(pattern.sum()), float(reached[-1])
    if total / period * len(pattern) > _MOST_DASHES:
        raise SceneError(f"pen.dashes of {period:g} pixels cut a line of {total:g} into too many pieces")
    first = math.floor(pen.dash_offset / period) * period - pen.dash_offset
    starts = first + np.arange(math.ceil((total - first) / period) + 1) * period
    bounds = (starts[:, None] + np.concatenate([[0.0], np.cumsum(pattern)])[None, :-1]).reshape(-1, 2)
    kept = ((bounds[:, 1] > 0.0) | (bounds[:, 0] >= 0.0)) & (bounds[:, 0] < total)
    ends = np.clip(bounds[kept], 0.0, total)
    corners = np.stack([np.interp(ends, reached, points[:, axis]) for axis in range(2)], axis=-1)
    inner = np.stack([np.searchsorted(reached, ends[:, 0], "right"), np.searchsorted(reached, ends[:, 1], "left")], axis=1)
    return [
        _dash(np.vstack([corner[:1], points[low:high], corner[1:]])) for corner, (low, high) in zip(corners, inner, strict=True)
    ]


def _dash(points: Floats) -> Chain:
    moved = np.concatenate([[True], (points[1:] != points[:-1]).any(axis=1)])
    return Chain(points[moved], False)


def _chain_polygons(chain: Chain, pen: Pen, tolerance: float) -> list[Floats]:
    points = chain.points
    if len(points) == 1:
        return _dot(points[0], pen, tolerance)
    start = points if chain.closed else points[:-1]
    end = np.roll(points, -1, axis=0) if chain.closed else points[1:]
    along = end - start
    direction = along / np.linalg.norm(along, axis=1, keepdims=True)
    normal = 0.5 * pen.width * np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    bodies = np.stack([start + normal, end + normal, end - normal, start - normal], axis=1)
    before = np.roll(direction, 1, axis=0) if chain.closed else direction[:-1]
    after, corner = (direction, start) if chain.closed else (direction[1:], start[1:])
    parts = [bodies, *_joins(corner, before, after, pen, tolerance)]
    if not chain.closed:
        parts += _caps(np.stack([start[0], end[-1]]), np.stack([-direction[0], direction[-1]]), pen, tolerance)
    return parts


def _dot(point: Floats, pen: Pen, tolerance: float) -> list[Floats]:
    """A line of no length: its caps alone."""
    if pen.cap == "butt":
        return []
    return [segment_polygons(np.concatenate([point, point])[None, :], pen, tolerance)]


def _half_disc(width: float, tolerance: float) -> Floats:
    """(k, 2) float64: points of a half circle from (1, 0) to (-1, 0) through (0, 1)."""
    n = max(2, arc_steps(0.5 * width, math.pi, tolerance))
    angle = math.pi * np.arange(n + 1) / n
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _caps(ends: Floats, outwards: Floats, pen: Pen, tolerance: float) -> list[Floats]:
    if pen.cap == "butt":
        return []
    reach = 0.5 * pen.width * outwards
    normal = np.stack([-reach[:, 1], reach[:, 0]], axis=1)
    if pen.cap == "square":
        return [np.stack([ends + normal, ends + normal + reach, ends - normal + reach, ends - normal], axis=1)]
    half = _half_disc(pen.width, tolerance)
    return [ends[:, None] + half[:, :1] * normal[:, None] + half[:, 1:] * reach[:, None]]


def _joins(corner: Floats, before: Floats, after: Floats, pen: Pen, tolerance: float) -> list[Floats]:
    """Wedges on the outer side of corners between the unit directions `before` and `after`, (n, 2) each."""
    sine = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    cosine = (before * after).sum(axis=1)
    turning = (np.abs(sine) > _STRAIGHT) | (cosine < 0.0)
    corner, before, after, sine, cosine = (values[turning] for values in (corner, before, after, sine, cosine))
    if len(corner) == 0:
        return []
    outer = np.where(sine > 0.0, -0.5, 0.5)[:, None] * pen.width
    first = outer * np.stack([-before[:, 1], before[:, 0]], axis=1)
    last = outer * np.stack([-after[:, 1], after[:, 0]], axis=1)
    if pen.join == "round":
        return _round_joins(corner, first, last, sine, cosine, pen.width, tolerance)
    parts = [np.stack([corner, corner + first, corner + last], axis=1)]
    if pen.join == "miter":
        # The miter's length in widths is 1 / cos(turn / 2), and cos^2(turn / 2) = (1 + cos(turn)) / 2.
        sharp = (1.0 + cosine) * 0.5 * pen.miter_limit**2 >= 1.0
        tip = (first + last)[sharp] / (1.0 + cosine[sharp, None])
        corner, first, last = corner[sharp], first[sharp], last[sharp]
        parts.append(np.stack([corner, corner + first, corner + tip, corner + last], axis=1))
    return parts


def _round_joins(
    corner: Floats, first: Floats, last: Floats, sine: Floats, cosine: Floats, width: float, tolerance: float
) -> list[Floats]:
    """Sectors; where they would stray from a triangle by less than the tolerance, as along a flattened curve, triangles."""
    turn = np.abs(np.arctan2(sine, cosine))
    flat = 0.5 * width * (1.0 - np.cos(0.5 * turn)) <= tolerance
    parts = [np.stack([corner, corner + first, corner + last], axis=1)[flat]]
    round_ = ~flat
    if round_.any():
        n = arc_steps(0.5 * width, float(turn[round_].max()), tolerance)
        # Not by the sign of the sine alone: at a half turn it is zero, and the sector must still lie in front.
        angle = (np.where(sine > 0.0, turn, -turn)[round_, None] * np.arange(n + 1) / n)[..., None]
        across = np.stack([-first[round_, 1], first[round_, 0]], axis=1)
        arc = np.cos(angle) * first[round_, None] + np.sin(angle) * across[:, None]
        parts.append(corner[round_, None] + np.concatenate([np.zeros_like(arc[:, :1]), arc], axis=1))
    return parts


def _turned(polygons: Floats) -> Floats:
    """Make all turn from +x towards +y."""
    x, y = polygons[..., 0], polygons[..., 1]
    x, y = x - x[:, :1], y - y[:, :1]
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    return np.where((area < 0.0)[:, None, None], polygons[:, ::-1], polygons)
