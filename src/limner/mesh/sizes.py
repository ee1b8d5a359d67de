"""What a shape is asked to be, checked before anything is made: lengths, counts, and how many triangles come of them."""

from __future__ import annotations

import math
import operator
from typing import Any, SupportsFloat, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["MOST_TRIANGLES", "check_count", "check_length", "check_triangles", "edge_lengths", "finite_points"]

# Twelve bytes of indices each, and as much again while they are made: beyond this a machine begins to swap before it says why.
MOST_TRIANGLES = 1 << 26


def check_length(length: SupportsFloat, name: str) -> None:
    """Raise SceneError, naming the field, where a length is not positive and finite."""
    if not (math.isfinite(length) and float(length) > 0.0):
        raise SceneError(f"{name} must be positive and finite, got {length}")


def edge_lengths(size: ArrayLike, columns: int, name: str) -> NDArray[np.float64]:
    """Return (columns,) float64 of that many lengths, or of one for all; raise SceneError, naming the field, where they are none."""
    try:
        edges = np.broadcast_to(np.asarray(size, dtype=np.float64), (columns,))
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be {columns} lengths or one for all, got {size!r}") from None
    for edge in edges:
        check_length(float(edge), name)
    return edges


def check_count(count: SupportsIndex, least: int, name: str) -> int:
    """Return a whole number that is at least `least`; raise SceneError, naming the field, where it is not."""
    try:
        whole = operator.index(count)
    except TypeError:
        raise SceneError(f"{name} must be a whole number, got {count!r}") from None
    if whole < least:
        raise SceneError(f"{name} must be at least {least}, got {whole}")
    return whole


def check_triangles(count: int, what: str) -> None:
    """Raise SceneError where what is asked for would have more triangles than memory should be tried with."""
    if count > MOST_TRIANGLES:
        raise SceneError(f"{what} would make {count:,} triangles; the most that is made is {MOST_TRIANGLES:,}")


def finite_points(points: ArrayLike, columns: int, least: int, name: str) -> NDArray[np.float64]:
    """Return (n, columns) float64; raise SceneError, naming the field, where they are too few, of another shape or not finite."""
    try:
        made: NDArray[Any] = np.array(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SceneError(f"{name} must be numbers of shape (n, {columns}): {error}") from None
    if made.ndim != 2 or made.shape[1] != columns:
        raise SceneError(f"{name} must have shape (n, {columns}), got {made.shape}")
    if len(made) < least:
        raise SceneError(f"{name} must have at least {least} points, got {len(made)}")
    if not np.isfinite(made).all():
        bad = int(np.flatnonzero(~np.isfinite(made).all(axis=1))[0])
        raise SceneError(f"{name} must be finite, got {made[bad].tolist()} at point {bad}")
    return made
