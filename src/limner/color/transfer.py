"""From light to stored numbers and back: the sRGB curve (FoCG 19.2; IEC 61966-2-1).

Eight bits hold a picture only if they are spent as the eye spends them, so a picture is encoded on writing and decoded on
reading. Encoding is the last step of every picture and touches each pixel: `bytes_from_linear` looks the code up by the leading
bits of the float instead of raising it to a power, and gives the very code that the formula, rounded, gives.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = [
    "SrgbCodes", "bytes_from_linear", "bytes_from_unit", "gamma_from_linear", "gamma_from_match", "linear_from_gamma", "linear_from_srgb",
    "srgb_codes", "srgb_from_linear",
]  # fmt: skip

_DROPPED_BITS = 12  # of 23 in a float32's fraction: at most one change of code in a bucket of what shares the rest
_LEAST_BITS = 110 << 23  # of the float32 2^-17, far below the first code that is not 0
_ONE_BITS = 127 << 23
_CHUNK = 1 << 15  # elements that stay in the cache from one step to the next


def srgb_from_linear(linear: ArrayLike) -> NDArray[np.float64]:
    """Encode linear values.

    Parameters
    ----------
    linear : (...) float
        Clipped to [0, 1] first.

    Returns
    -------
    (...) float64 in [0, 1]: ``12.92 x`` up to 0.0031308, ``1.055 x^(1/2.4) - 0.055`` beyond.

    >>> srgb_from_linear([0.0, 0.0031308, 0.5, 1.0, 7.0]).round(4).tolist()
    [0.0, 0.0404, 0.7354, 1.0, 1.0]

    **Source**: IEC 61966-2-1:1999, 5.2.
    """
    x = np.clip(np.asarray(linear, dtype=np.float64), 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(x, 1.0 / 2.4) - 0.055)


def linear_from_srgb(encoded: ArrayLike) -> NDArray[np.float64]:
    """Decode sRGB values.

    Parameters
    ----------
    encoded : (...) float
        Clipped to [0, 1] first.

    Returns
    -------
    (...) float64 in [0, 1]: ``s / 12.92`` up to 0.04045, ``((s + 0.055) / 1.055)^2.4`` beyond.

    >>> linear_from_srgb([0.0, 0.04045, 0.73536, 1.0]).round(4).tolist()
    [0.0, 0.0031, 0.5, 1.0]

    **Source**: IEC 61966-2-1:1999, 5.2.
    """
    s = np.clip(np.asarray(encoded, dtype=np.float64), 0.0, 1.0)
    return np.where(s <= 0.04045, s / 12.92, np.power((s + 0.055) / 1.055, 2.4))


def linear_from_gamma(encoded: ArrayLike, gamma: float) -> NDArray[np.float64]:
    """Decode values that a plain power encodes: the intensity that a monitor of that gamma shows, of its greatest.

    Parameters
    ----------
    encoded : (...) float
        Clipped to [0, 1] first.
    gamma : float > 0

    Returns
    -------
    (...) float64 in [0, 1]: ``a^gamma``.

    >>> linear_from_gamma([0.0, 0.5, 1.0], 2.0).tolist()
    [0.0, 0.25, 1.0]

    **Source**: FoCG 3.2.2, displayed intensity = (maximum intensity) a^gamma.
    """
    return np.power(np.clip(np.asarray(encoded, dtype=np.float64), 0.0, 1.0), _checked_gamma(gamma))


def gamma_from_linear(linear: ArrayLike, gamma: float) -> NDArray[np.float64]:
    """Encode linear values for a monitor of that gamma: ``x^(1/gamma)``, the inverse of `linear_from_gamma`.

    >>> gamma_from_linear([0.0, 0.25, 7.0], 2.0).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.power(np.clip(np.asarray(linear, dtype=np.float64), 0.0, 1.0), 1.0 / _checked_gamma(gamma))


def gamma_from_match(grey: ArrayLike, share: float = 0.5) -> NDArray[np.float64]:
    """The gamma of a display, from the grey that looks as bright on it as a fine checkerboard of black and white.

    From afar the board is half of the greatest intensity, whatever the display does to numbers in between; the grey is ``a^gamma`` of it.

    Parameters
    ----------
    grey : (...) float in (0, 1)
        The stored number that matches, as a share of the greatest code.
    share : float in (0, 1)
        How much of the board is white.

    Returns
    -------
    (...) float64: ``ln(share) / ln(grey)``.

    >>> gamma_from_match(186 / 255).round(2).item()
    2.2

    **Source**: FoCG 3.2.2, gamma = ln 0.5 / ln a.
    """
    a = np.asarray(grey, dtype=np.float64)
    if not ((a > 0.0) & (a < 1.0)).all():
        raise SceneError(f"grey must lie between 0 and 1, both left out: it is the code that matches over the greatest; got {grey!r}")
    if not 0.0 < share < 1.0:
        raise SceneError(f"share must lie between 0 and 1, got {share!r}")
    return np.asarray(np.log(share) / np.log(a))


def _checked_gamma(gamma: float) -> float:
    if not 0.0 < gamma < float("inf"):
        raise SceneError(f"gamma must be a positive number, got {gamma!r}")
    return float(gamma)


class SrgbCodes(NamedTuple):
    """What `bytes_from_linear` looks up by bucket: the leading bits of a float32 above those of `_LEAST_BITS`."""

    code: NDArray[np.int32]  # code at the bucket's lower end; 256 is added where it changes inside
    change: NDArray[np.float32]  # the value at which it changes; inf where it does not


def _rounded(linear: NDArray[np.float32]) -> NDArray[np.int64]:
    """Encode by the formula, to 0 .. 255."""
    return np.floor(srgb_from_linear(linear) * 255.0 + 0.5).astype(np.int64)


@cache
def srgb_codes() -> SrgbCodes:
    """Find, by bisection on the bits of the float, the least float32 of every code, and sort these into buckets."""
    codes = np.arange(1, 256)
    below = np.full(255, _LEAST_BITS, dtype=np.int32)
    reached = np.full(255, _ONE_BITS, dtype=np.int32)
    while (reached - below).max() > 1:
        middle = (below + reached) // 2
        enough = _rounded(middle.view(np.float32)) >= codes
        reached, below = np.where(enough, middle, reached), np.where(enough, below, middle)
    first_bucket, last_bucket = _LEAST_BITS >> _DROPPED_BITS, _ONE_BITS >> _DROPPED_BITS
    lower_ends = np.arange(first_bucket, last_bucket + 1, dtype=np.int32) << _DROPPED_BITS
    code = np.searchsorted(reached, lower_ends, side="right").astype(np.int32)
    inside = (reached & ((1 << _DROPPED_BITS) - 1)) != 0
    bucket = (reached[inside] >> _DROPPED_BITS) - first_bucket
    change = np.full(len(lower_ends), np.inf, dtype=np.float32)
    change[bucket] = reached[inside].view(np.float32)
    code[bucket] += 256
    return SrgbCodes(code, change)


def bytes_from_linear(linear: NDArray[Any]) -> NDArray[np.uint8]:
    """Encode linear values to eight bits: ``floor(255 srgb_from_linear(x) + 1/2)``, to the bit.

    Parameters
    ----------
    linear : (...) float32
        Any floats; below 0 and NaN give 0, above 1 gives 255.

    >>> bytes_from_linear(np.array([-1.0, 0.0, 0.18, 0.5, 1.0, np.inf, np.nan], dtype=np.float32)).tolist()
    [0, 0, 118, 188, 255, 255, 0]

    **Source**: IEC 61966-2-1:1999, 5.2; the look-up by leading bits is after F. Giesen (float to sRGB8 in SSE2, 2012), with the
    exact place of each change of code instead of an interpolation.
    """
    table = srgb_codes()
    flat = np.ascontiguousarray(linear, dtype=np.float32).reshape(-1)
    out = np.empty(flat.shape, dtype=np.uint8)
    for start in range(0, len(flat), _CHUNK):
        piece = flat[start : start + _CHUNK]
        held = np.minimum(np.fmax(piece, np.int32(_LEAST_BITS).view(np.float32)), np.float32(1.0))
        bucket = (held.view(np.int32) >> _DROPPED_BITS) - (_LEAST_BITS >> _DROPPED_BITS)
        code = table.code.take(bucket)
        open_ = np.flatnonzero(code > 255)
        if len(open_):
            code[open_] += held[open_] >= table.change[bucket[open_]]
        out[start : start + _CHUNK] = code  # what was added modulo 256 falls off
    return out.reshape(np.shape(linear))


def bytes_from_unit(values: NDArray[Any]) -> NDArray[np.uint8]:
    """Store values that need no curve, such as alpha, in eight bits: ``floor(255 x + 1/2)``, clipped; NaN gives 0.

    >>> bytes_from_unit(np.array([-1.0, 0.5, 1.0, np.nan], dtype=np.float32)).tolist()
    [0, 128, 255, 0]
    """
    held = np.minimum(np.fmax(np.asarray(values, dtype=np.float32), np.float32(0.0)), np.float32(1.0))
    return (held * np.float32(255.0) + np.float32(0.5)).astype(np.uint8)
