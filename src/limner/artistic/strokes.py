"""Lines as a hand draws them: thick and thin, not quite straight, fainter far away (FoCG 10.3.1).

    ring = swelling(points, width=3.0, taper=0.9)          the outline of a stroke whose ends are thin
    points = wavering(points, amplitude=1.5)               the same line by an unsteady hand
    pieces = by_depth(points, depth, near, far, levels=6)  to be drawn ever thinner

What a hand adds must not tear a drawing apart. It is therefore not the line that shakes but the paper under it: a point is moved by a
smooth field that depends on its place alone, so that lines which meet before still meet, and a line that moves a little from one view to
the next is moved by nearly the same.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Piece", "by_depth", "resampled", "swelling", "waver", "wavering"]

Floats = NDArray[np.float64]

_LEAST_COSINE = 0.4  # of half a turn: at sharper corners a stroke's outline is cut off
_LONG = 12.0  # widths: shorter strokes have blunter ends, so that they do not look like seeds


class Piece(NamedTuple):
    """A part of a line, and how far away it is: 0 for the nearest of the drawing, 1 for the farthest."""

    points: Floats
    farness: float


def resampled(points: Floats, step: float) -> Floats:
    """The line (n, 2) with further points, so that none is farther than `step` from the next; its own stay."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    parts = np.maximum(1, np.ceil(lengths / step)).astype(np.int64)
    first = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(first)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[first]
    made = points[first] + share[:, None] * (points[first + 1] - points[first])
    return np.vstack([made, points[-1:]])


def waver(places: Floats, wavelength: float, seed: int = 0) -> Floats:
    """A smooth field: (n,) values from -1 to 1 at places (n, 2), the same for the same place.

    Random values at the corners of squares with sides of half a wavelength, interpolated by 3t^2 - 2t^3.

    **Source**: Perlin, *An image synthesizer*, 1985 (value noise); the corners' values are of an integer hash of our own choice.
    """
    scaled = np.asarray(places, dtype=np.float64) / (0.5 * wavelength)
    corner = np.floor(scaled)
    t = scaled - corner
    u, v = (t * t * (3.0 - 2.0 * t)).T
    i, j = corner.astype(np.int64).T
    below = (1.0 - u) * _chance(i, j, seed) + u * _chance(i + 1, j, seed)
    above = (1.0 - u) * _chance(i, j + 1, seed) + u * _chance(i + 1, j + 1, seed)
    return (1.0 - v) * below + v * above


def _chance(i: NDArray[np.int64], j: NDArray[np.int64], seed: int) -> Floats:
    """(n,) float64 from -1 to 1, a pure function of three whole numbers; it is meant to overflow."""
    h = i.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) + j.astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
    h ^= np.uint64((seed * 0x165667B19E3779F9) % 2**64)
    for shift in (33, 29):
        h = (h ^ (h >> np.uint64(shift))) * np.uint64(0xFF51AFD7ED558CCD)
    return (h >> np.uint64(11)).astype(np.float64) / 2.0**52 - 1.0


def wavering(points: Floats, amplitude: float, wavelength: float = 60.0, seed: int = 0) -> Floats:
    """Move the points of a line (n, 2) by at most `amplitude` along each axis; new ones are between them where it needs them."""
    if not amplitude > 0.0:
        return points
    made = resampled(points, wavelength / 12.0)
    return made + amplitude * np.stack([waver(made, wavelength, 2 * seed), waver(made, wavelength, 2 * seed + 1)], axis=1)


def swelling(
    points: Floats, width: float, *, taper: float = 0.0, pressure: float = 0.0, wavelength: float = 60.0, seed: int = 0,
    closed: bool = False, profile: tuple[Floats, Floats] | None = None,
) -> Floats:  # fmt: skip
    """The outline of a stroke that is thick in its middle and thin at its ends.

    Parameters
    ----------
    points : (n, 2) float64
        With `closed`, the last is the first once more.
    width : float
        In the middle.
    taper : float from 0 to 1
        The ends are so much thinner; a closed line has none.
    pressure : float from 0 to 1
        How much the width changes along the way, over `wavelength`.
    profile : (n,) float64 and (n,) float64, optional
        Shares of the way, from 0 to 1, and what the width is multiplied by there.

    Returns
    -------
    (m, 2) float64
        A ring, to be filled by the rule "nonzero"; of a closed line its outer and inner side, joined where it begins.
    """
    line = resampled(points, max(wavelength / 12.0, 0.5 * width))
    moved = np.concatenate([[True], (np.diff(line, axis=0) != 0.0).any(axis=1)])
    line = line[moved]
    if len(line) < 2:
        return np.repeat(line, 2, axis=0)
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    half = np.full(len(line), 0.5 * width)
    if profile is not None:
        half *= np.interp(run / run[-1], *profile)
    if not closed:
        taper *= min(1.0, float(run[-1]) / (_LONG * width))
        half *= 1.0 - taper * (1.0 - np.sqrt(np.sin(np.pi * np.clip(run / run[-1], 0.0, 1.0))))
    if pressure > 0.0:
        half *= 1.0 + pressure * waver(line, wavelength, seed + 7)
    across = _normals(line, closed) * half[:, None]
    return np.concatenate([line + across, (line - across)[::-1]])


def _normals(line: Floats, closed: bool) -> Floats:
    """At each point the direction to its left side, lengthened at corners so that the sides stay as far from the line."""
    along = np.diff(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    before, after = np.vstack([along[-1:] if closed else along[:1], along]), np.vstack([along, along[:1] if closed else along[-1:]])
    middle = before + after
    length = np.linalg.norm(middle, axis=1, keepdims=True)
    middle = np.where(length > 1e-9, middle / np.where(length > 1e-9, length, 1.0), after)
    cosine = np.maximum((middle * after).sum(axis=1, keepdims=True), _LEAST_COSINE)
    return np.stack([middle[:, 1], -middle[:, 0]], axis=1) / cosine


def by_depth(points: Floats, depth: Floats, near: float, far: float, levels: int = 6) -> list[Piece]:
    """Cut a line where it passes from one of `levels` equal ranges of depth into the next.

    Parameters
    ----------
    points : (n, 2) float64
    depth : (n,) float64
    near, far : float
        Of the whole drawing.
    levels : int >= 1

    Returns
    -------
    list of Piece
        In the line's order; each begins where the one before it ends.
    """
    spread = far - near
    level = np.clip((depth - near) / spread, 0.0, 1.0) * levels if spread > 0.0 else np.zeros(len(depth))
    line, at = _with_crossings(points, level)
    within = np.minimum(np.floor(0.5 * (at[1:] + at[:-1])), levels - 1).astype(np.int64)
    cuts = np.flatnonzero(np.diff(within)) + 1
    bounds = np.concatenate([[0], cuts, [len(within)]])
    share = max(levels - 1, 1)
    return [
        Piece(line[first : last + 1], float(within[first]) / share) for first, last in pairwise(bounds.tolist())
    ]


def _with_crossings(points: Floats, level: Floats) -> tuple[Floats, Floats]:
    """A line with a point wherever its level is a whole number."""
    made, at = [points[0]], [float(level[0])]
    for k in range(len(points) - 1):
        a, b = float(level[k]), float(level[k + 1])
        low, high = int(np.floor(min(a, b))) + 1, int(np.ceil(max(a, b))) - 1
        whole = list(range(low, high + 1))
        for number in whole if b >= a else whole[::-1]:
            made.append(points[k] + (number - a) / (b - a) * (points[k + 1] - points[k]))
            at.append(float(number))
        made.append(points[k + 1])
        at.append(b)
    return np.array(made), np.array(at)
