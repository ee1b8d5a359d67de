"""What curves are given: control points, knots and parameters, checked before anything is made of them."""

from __future__ import annotations

import operator
from typing import SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["breaks", "control_points", "degree_of", "parameters"]

Floats = NDArray[np.float64]

_SLACK = 1e-9  # of the interval: how far beyond its ends a parameter may be carried by rounding


def control_points(points: ArrayLike, least: int = 1, name: str = "control points", dimension: int | None = None) -> Floats:
    """Return (n + 1, d) float64; raise SceneError where they are fewer than `least`, of another shape or not finite."""
    try:
        made = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SceneError(f"{name} must be numbers of shape (n + 1, d): {error}") from None
    if made.ndim != 2 or len(made) == 0 or made.shape[1] == 0:
        raise SceneError(f"{name} must have shape (n + 1, d) with n >= 0, got {made.shape}")
    if len(made) < least:
        raise SceneError(f"{name} must be at least {least}, got {len(made)}")
    if dimension is not None and made.shape[1] != dimension:
        raise SceneError(f"{name} must have {dimension} coordinates each, got {made.shape[1]}")
    if not np.isfinite(made).all():
        bad = int(np.flatnonzero(~np.isfinite(made).all(axis=1))[0])
        raise SceneError(f"{name} must be finite, got {made[bad].tolist()} at {bad}")
    return made


def parameters(u: ArrayLike, start: float = -np.inf, end: float = np.inf) -> Floats:
    """Return (...) float64 within [start, end]; raise SceneError where a parameter is outside or not a number."""
    made = np.asarray(u, dtype=np.float64)
    bounded = bool(np.isfinite(end - start))
    slack = _SLACK * (end - start) if bounded else 0.0
    # Comparisons with NaN are false
    inside = (made >= start - slack) & (made <= end + slack) if bounded else np.isfinite(made)
    if not inside.all():
        bad = float(made[~inside][0]) if made.ndim else float(made)
        raise SceneError(f"a parameter must lie in [{start:g}, {end:g}], got {bad:g}")
    return np.clip(made, start, end) if bounded else made


def degree_of(degree: SupportsIndex, least: int = 0) -> int:
    """Return a degree as a whole number that is at least `least`."""
    try:
        whole = operator.index(degree)
    except TypeError:
        raise SceneError(f"the degree must be a whole number, got {degree!r}") from None
    if whole < least:
        raise SceneError(f"the degree must be at least {least}, got {whole}")
    return whole


def breaks(knots: ArrayLike, count: int, name: str = "knots") -> Floats:
    """Return (count,) float64 that increase; raise SceneError where they do not."""
    made = np.asarray(knots, dtype=np.float64)
    if made.shape != (count,):
        raise SceneError(f"{name} must be {count} numbers, got shape {made.shape}")
    if not np.isfinite(made).all() or not (np.diff(made) > 0.0).all():
        raise SceneError(f"{name} must be finite and increase, got {made.tolist()}")
    return made
