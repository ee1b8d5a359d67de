"""Straight pieces of lines in space, before it is known what hides them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["ROUNDING", "Segments", "joined", "no_segments"]

ROUNDING = 2e-7  # of the scene's extent: how far rounding to float32 moves a surface through a line that lies on it

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Segments(NamedTuple):
    """Pieces of feature lines. Where two meet, the numbers of their ends are equal to the bit.

    Attributes
    ----------
    kind : (k,) int64
        Row of `limner.artistic.lines.KINDS`.
    ends : (k, 2, 3) float64
        World.
    triangles : (k, 2) int64
        The triangles that a piece runs through, which do not hide it; -1: none. Of a mesh edge none are named: that its triangles do not
        hide it follows from the numbers.
    slack : (k,) float64
        How far in front of it a surface must lie to hide it, metres.
    hidden : (k,) int64
        By how many surfaces it is hidden for reasons of its own.
    instance : (k,) int64
    soft : (k,) bool
        Silhouettes of a mesh where it is smooth, or rough: there is a line only if the surface beyond them lies farther behind.
    beside : (k,) int64
        A triangle that each lies on; -1: none is known.
    """

    kind: Indices
    ends: Floats
    triangles: Indices
    slack: Floats
    hidden: Indices
    instance: Indices
    soft: NDArray[np.bool_]
    beside: Indices

    def where(self, chosen: NDArray[np.bool_] | Indices) -> Segments:
        """Some of the pieces."""
        return Segments(
            self.kind[chosen],
            self.ends[chosen],
            self.triangles[chosen],
            self.slack[chosen],
            self.hidden[chosen],
            self.instance[chosen],
            self.soft[chosen],
            self.beside[chosen],
        )


def no_segments() -> Segments:
    """No pieces at all."""
    none = np.zeros(0, dtype=np.int64)
    return Segments(none, np.zeros((0, 2, 3)), np.zeros((0, 2), dtype=np.int64), np.zeros(0), none, none, np.zeros(0, dtype=bool), none)


def joined(parts: Sequence[Segments]) -> Segments:
    """Pieces one after the other."""
    if not parts:
        return no_segments()
    return Segments(
        np.concatenate([part.kind for part in parts]),
        np.concatenate([part.ends for part in parts]),
        np.concatenate([part.triangles for part in parts]),
        np.concatenate([part.slack for part in parts]),
        np.concatenate([part.hidden for part in parts]),
        np.concatenate([part.instance for part in parts]),
        np.concatenate([part.soft for part in parts]),
        np.concatenate([part.beside for part in parts]),
    )
