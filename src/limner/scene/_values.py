"""Turning what people type into the plain values that a description holds, or saying what was expected."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["Triple", "finite", "matrix4", "numbers", "positive", "triple", "unit_interval"]

Triple = tuple[float, float, float]


def finite(value: Any, name: str) -> float:
    """Return `value` as a finite float."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be a number, got {value!r}") from None
    if not math.isfinite(number):
        raise SceneError(f"{name} must be finite, got {number}")
    return number


def positive(value: Any, name: str) -> float:
    """Return `value` as a finite float greater than zero."""
    number = finite(value, name)
    if number <= 0.0:
        raise SceneError(f"{name} must be positive, got {number}")
    return number


def unit_interval(value: Any, name: str) -> float:
    """Return `value` as a float in [0, 1]."""
    number = finite(value, name)
    if not 0.0 <= number <= 1.0:
        raise SceneError(f"{name} must lie in [0, 1], got {number}")
    return number


def triple(value: Any, name: str, *, minimum: float = -math.inf) -> Triple:
    """Return `value` (three numbers, or one for all three) as a tuple of three finite floats."""
    if isinstance(value, (int, float, np.floating, np.integer)):
        value = (value, value, value)
    if not isinstance(value, (Sequence, np.ndarray)) or isinstance(value, str) or len(value) != 3:
        raise SceneError(f"{name} must be three numbers, got {value!r}")
    numbers = tuple(finite(v, name) for v in value)
    if min(numbers) < minimum:
        raise SceneError(f"{name} must not be below {minimum:g}, got {numbers}")
    return numbers  # type: ignore[return-value]


def matrix4(value: Any, name: str) -> NDArray[np.float64]:
    """Return `value` as a read-only (4, 4) float64 affine matrix (column vectors, last row 0 0 0 1)."""
    try:
        matrix = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be a 4x4 matrix, got {value!r}") from None
    if matrix.shape != (4, 4):
        raise SceneError(f"{name} must be a 4x4 matrix, got shape {matrix.shape}")
    rows = matrix.tolist()
    if not all(map(math.isfinite, itertools.chain(*rows))):
        raise SceneError(f"{name} must be finite")
    x, y, z, w = rows[3]
    if max(abs(x), abs(y), abs(z), abs(w - 1.0)) > 1e-9:
        raise SceneError(f"{name} must be affine: its last row must be 0 0 0 1, got {matrix[3]}")
    matrix.flags.writeable = False
    return matrix


def numbers(value: Any, name: str) -> NDArray[np.float64]:
    """Return `value` as a float64 array of finite numbers, of any shape."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be numbers, got {type(value).__name__}") from None
    if not np.isfinite(array).all():
        raise SceneError(f"{name} must be finite")
    return array
