"""Lines that run through triangles: where a quantity that is known at their corners passes through zero.

Between the corners it goes evenly, so that its zeros are a line that crosses triangle after triangle, and enters each where it left the one
before, to the bit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .segments import ROUNDING, Segments
from .surfaces import Surfaces

__all__ = ["gradients", "on", "segments_in", "zero_segments"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_AT_END = 1e-9  # of a side's length


def zero_segments(surfaces: Surfaces, values: Floats) -> tuple[Floats, Indices]:
    """Where values at corners, (m, 3), pass through zero: ends (k, 2, 3), equal to the bit where two meet, and triangles (k,)."""
    above = values > 0.0
    rows = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    # The corner that is alone on its side comes first: the line crosses the two sides that meet there.
    alone_above = above[rows].sum(axis=1) == 1
    alone = (above[rows] == alone_above[:, None]).argmax(axis=1)
    ends = [_crossing(surfaces, values, rows, alone, (alone + k) % 3) for k in (1, 2)]
    made = np.stack(ends, axis=1)
    kept = (made[:, 0] != made[:, 1]).any(axis=1)
    return made[kept], rows[kept]


def _crossing(surfaces: Surfaces, values: Floats, rows: Indices, i: Indices, j: Indices) -> Floats:
    a, b = surfaces.triangles[rows, i], surfaces.triangles[rows, j]
    f, g = values[rows, i], values[rows, j]
    # From the lesser point to the greater, so that both triangles at a side get the same bits.
    swap = a > b
    a, b, f, g = np.where(swap, b, a), np.where(swap, a, b), np.where(swap, g, f), np.where(swap, f, g)
    p, q = surfaces.points[a], surfaces.points[b]
    return on(p, q, f / (f - g))


def on(p: Floats, q: Floats, t: Floats) -> Floats:
    """Points at t between p and q; where t is 0 or 1 but for rounding, p and q themselves."""
    between = p + t[:, None] * (q - p)
    return np.asarray(np.where((t > 1.0 - _AT_END)[:, None], q, np.where((t < _AT_END)[:, None], p, between)))


def segments_in(surfaces: Surfaces, kind: int, ends: Floats, rows: Indices, slack: Floats, hidden: Indices) -> Segments:
    """Lines in triangles `rows`, (k,), which do not hide them, nor does what is in front by less than `slack`, (k,) metres."""
    own = np.stack([rows, np.full(len(rows), -1)], axis=1)
    soft = np.zeros(len(rows), dtype=bool)
    return Segments(np.full(len(rows), kind), ends, own, slack + ROUNDING * surfaces.extent, hidden, surfaces.instance[rows], soft, rows)


def gradients(corners: Floats, values: Floats) -> tuple[Floats, Floats]:
    """In triangles (k, 3, 3) with values (k, 3) at their corners: the gradient, (k, 3), and the normal, of any length."""
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    squared = (normal * normal).sum(axis=1)
    opposite = np.stack([c - b, a - c, b - a], axis=1)
    turned = np.cross(normal[:, None], opposite)
    return (values[:, :, None] * turned).sum(axis=1) / np.maximum(squared, 1e-300)[:, None], normal
