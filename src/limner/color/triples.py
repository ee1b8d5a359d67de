"""What holds for every array of colours: any shape whose last axis is 3, float32 stays float32, and NaN stays NaN.

Colours come as one triple, as a row of them or as a picture. Every conversion of this room takes all of them, computes in float64, a piece
at a time so that what is in work stays in the cache, and gives float32 back to who brought it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["Floats", "float_array", "in_pieces", "triples"]

Floats = NDArray[np.float64]

_PIECE = 1 << 14


def float_array(values: ArrayLike, name: str = "values") -> NDArray[Any]:
    """Return numbers as float32 where they are float32, as float64 otherwise; SceneError where they are no numbers.

    >>> float_array([1, 2]).dtype, float_array(np.float32(1.0)).dtype
    (dtype('float64'), dtype('float32'))
    """
    try:
        given = np.asarray(values)
        return given if given.dtype in (np.float32, np.float64) else given.astype(np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be numbers, got {type(values).__name__}") from None


def triples(values: ArrayLike, name: str = "colours", last: int = 3) -> NDArray[Any]:
    """Return colours as float32 or float64; SceneError unless the last axis has three numbers (or `last`)."""
    given = float_array(values, name)
    if given.ndim == 0 or given.shape[-1] != last:
        raise SceneError(f"{name} must have {last} numbers along the last axis, got shape {given.shape}")
    return given


def in_pieces(change: Callable[[Floats], Floats], values: ArrayLike, name: str = "colours") -> NDArray[Any]:
    """Apply a function from (n, 3) float64 to (n, 3) float64 to colours of any shape.

    >>> in_pieces(lambda colors: 2.0 * colors, np.ones((2, 2, 3), dtype=np.float32)).dtype
    dtype('float32')
    """
    given = triples(values, name)
    flat = given.reshape(-1, 3)
    made = np.empty(flat.shape, dtype=given.dtype)
    for start in range(0, len(flat), _PIECE):
        made[start : start + _PIECE] = change(flat[start : start + _PIECE].astype(np.float64))
    return made.reshape(given.shape)
