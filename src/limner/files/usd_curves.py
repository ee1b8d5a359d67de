"""Cubic curves of USD as the chords that draw them.

    basis       a curve's n points make                      widths and colours that vary go from end to end of each
    bezier      (n - 1) / 3 pieces, or n / 3 where it closes
    bspline     n - 3, n where it closes, n - 1 where it is pinned to its ends
    catmullRom  as bspline, through its points

Every piece becomes one of Bézier's, and these as many chords as keep them within a thousandth of the curves' size. A pinned curve goes to
its ends by a point more at each, which lies as far beyond the end as the next one does before it.

**Source**: OpenUSD, UsdGeom, *BasisCurves*; FoCG 15.6.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..curves.bernstein import basis as bernstein_basis

__all__ = ["Chords", "chords", "n_ends"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_TOLERANCE = 1e-3  # of the size of all curves
_MOST_CHORDS = 16  # of one piece
_BEZIER = {
    "bezier": np.eye(4),
    "bspline": np.array([[1, 4, 1, 0], [0, 4, 2, 0], [0, 2, 4, 0], [0, 1, 4, 1]]) / 6.0,
    "catmullRom": np.array([[0, 6, 0, 0], [-1, 6, 1, 0], [0, 1, 6, -1], [0, 0, 6, 0]]) / 6.0,
}
"""(4, 4): Bézier's points of a piece from its own."""


class Chords(NamedTuple):
    """The chords of many curves.

    Attributes
    ----------
    positions : (n, 3) float32
    segments : (m, 2) int32
    of_points : (n, k) float64 or None
        What was given for each control point, at each position.
    of_ends : (n, k) float64 or None
        What was given for the ends of pieces.
    n_left_out : int
        Curves of fewer points than one piece has.
    """

    positions: NDArray[np.float32]
    segments: NDArray[np.int32]
    of_points: Floats | None
    of_ends: Floats | None
    n_left_out: int


class _Pieces(NamedTuple):
    """Of curves of one number of points: each piece's four points, of which those beyond an end are ``2 p - q``."""

    points: Indices  # (pieces, 4), counted from the curve's first
    mirrored: Indices  # (pieces, 4): q; the point itself where it is one of the curve's
    closes: bool


def chords(
    positions: NDArray[np.float32], counts: Indices, basis: str, wrap: str,
    of_points: NDArray[np.float32] | None = None, of_ends: NDArray[np.float32] | None = None,
) -> Chords:
    """Cut cubic curves into chords.

    Parameters
    ----------
    positions : (n, 3) float32
    counts : (k,) int64
        Points of each curve, one after the other.
    basis : "bezier" | "bspline" | "catmullRom"
    wrap : "nonperiodic" | "periodic" | "pinned"
    of_points : (n, j), optional
        Values of control points, that go as the curve goes.
    of_ends : (e, j), optional
        Values of the ends of pieces, curve after curve, straight in between.

    Examples
    --------
    >>> made = chords(np.float32([[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]), np.array([4]), "bezier", "nonperiodic")
    >>> made.positions[len(made.positions) // 2].tolist()
    [0.5, 0.75, 0.0]
    """
    starts, to_bezier = np.cumsum(counts) - counts, _BEZIER[basis]
    values = positions.astype(np.float64) if of_points is None else np.hstack([positions, of_points]).astype(np.float64)
    made: list[tuple[Indices, Floats, bool]] = []
    n_left_out = 0
    for n in np.unique(counts).tolist():
        pieces = _pieces(n, basis, wrap)
        which = np.flatnonzero(counts == n)
        if pieces is None:
            n_left_out += len(which)
            continue
        first = starts[which, None, None]
        control = values[first + pieces.points]
        control += control - values[first + pieces.mirrored]
        made.append((which, np.einsum("ij,cpjk->cpik", to_bezier, control), pieces.closes))
    n_chords = max((_n_chords(control[..., :3], positions) for _, control, _ in made), default=1)
    weights = bernstein_basis(3, np.arange(n_chords + 1) / n_chords)
    first_ends = _first_ends(counts, basis, wrap)
    parts, ends, segments, n_made = [], [], [], 0
    for which, control, closes in made:
        n_pieces = control.shape[1]
        along = np.einsum("ui,cpik->cpuk", weights[:-1], control).reshape(len(which), -1, control.shape[-1])
        if not closes:
            along = np.concatenate([along, control[:, -1:, 3]], axis=1)
        n_rows = along.shape[1]
        row = n_made + np.arange(len(which) * n_rows).reshape(len(which), n_rows)
        after = np.roll(row, -1, axis=1)
        segments.append(np.stack([row, after], axis=-1)[:, : n_rows if closes else n_rows - 1].reshape(-1, 2))
        parts.append(along.reshape(-1, along.shape[-1]))
        if of_ends is not None:
            u = np.arange(n_rows) / n_chords
            last = n_pieces if not closes else n_pieces - 1
            low = np.minimum(u.astype(np.int64), n_pieces - 1)
            high = np.where(low + 1 > last, 0, low + 1)
            share = (u - low)[None, :, None]
            place = first_ends[which, None]
            ends.append(((1.0 - share) * of_ends[place + low] + share * of_ends[place + high]).reshape(-1, of_ends.shape[1]))
        n_made += row.size
    whole = np.concatenate([np.zeros((0, values.shape[1])), *parts])
    return Chords(
        whole[:, :3].astype(np.float32),
        np.concatenate([np.zeros((0, 2), dtype=np.int64), *segments]).astype(np.int32),
        None if of_points is None else whole[:, 3:],
        None if of_ends is None else np.concatenate([np.zeros((0, of_ends.shape[1])), *ends]),
        n_left_out,
    )


def n_ends(counts: Indices, basis: str, wrap: str) -> int:
    """How many ends of pieces there are, where neighbours share theirs."""
    return int(_ends_of_each(counts, basis, wrap).sum())


def _first_ends(counts: Indices, basis: str, wrap: str) -> Indices:
    each = _ends_of_each(counts, basis, wrap)
    return np.asarray(np.cumsum(each) - each)


def _ends_of_each(counts: Indices, basis: str, wrap: str) -> Indices:
    known = {n: _pieces(n, basis, wrap) for n in np.unique(counts).tolist()}
    each = {n: 0 if pieces is None else len(pieces.points) + (not pieces.closes) for n, pieces in known.items()}
    return np.array([each[n] for n in counts.tolist()], dtype=np.int64)


def _pieces(n: int, basis: str, wrap: str) -> _Pieces | None:
    """The pieces of a curve of n points; None where they are too few."""
    step = 3 if basis == "bezier" else 1
    closes = wrap == "periodic"
    if closes:
        if n < 3:
            return None
        points = (step * np.arange(n // step)[:, None] + np.arange(4)) % n
        return _Pieces(points, points, closes)
    is_pinned = wrap == "pinned" and basis != "bezier"
    if n < (2 if is_pinned else 4):
        return None
    n_pieces = n - 1 if is_pinned else (n - 4) // step + 1
    points = step * np.arange(n_pieces)[:, None] + np.arange(4) - (1 if is_pinned else 0)
    mirrored = points.copy()
    for beyond, end, before in ((-1, 0, 1), (n, n - 1, n - 2)):
        mirrored[points == beyond], points[points == beyond] = before, end
    return _Pieces(points, mirrored, closes)


def _n_chords(control: Floats, positions: NDArray[np.float32]) -> int:
    """As many chords as a cubic needs that strays from one by an eighth of its second derivative.

    **Source**: Wang, *The subdivision method for finding the intersection between two Bézier curves*, 1984:
    ``n >= sqrt(6 max |second difference| / (8 e))``.
    """
    finite = positions[np.isfinite(positions).all(axis=1)]
    size = float(np.linalg.norm(np.ptp(finite, axis=0))) if len(finite) else 0.0
    bend = control[..., 2:, :] - 2.0 * control[..., 1:-1, :] + control[..., :-2, :]
    greatest = float(np.nanmax(np.linalg.norm(bend, axis=-1), initial=0.0))
    if not (size > 0.0 and math.isfinite(greatest)):
        return 1
    return min(max(1, math.ceil(math.sqrt(6.0 * greatest / (8.0 * _TOLERANCE * size)))), _MOST_CHORDS)
