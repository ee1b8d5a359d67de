"""How different two colours look: CIE's differences of 1976, 1994 and 2000.

About 1 is the least that a trained eye sees side by side. The first is the distance in Lab; the later ones find that differences of chroma
and hue count less where colours are strong, and that blue needs a correction of its own.

**Source**: CIE 015:2018, 8.2 and 8.3; Sharma, Wu and Dalal, *The CIEDE2000 color-difference formula: implementation notes, supplementary
test data, and mathematical observations*, Color Research and Application 30, 2005.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .triples import triples

__all__ = ["DIFFERENCES", "color_difference"]

Floats = NDArray[np.float64]

DIFFERENCES = ("2000", "94", "76")


def color_difference(reference: ArrayLike, sample: ArrayLike, formula: str = "2000") -> NDArray[np.floating]:
    """Tell how different colours look.

    Parameters
    ----------
    reference, sample : (..., 3) float
        L*, a*, b*; the shapes broadcast. With ``"94"`` it matters which is the reference.
    formula : "2000" | "94" | "76"
        All weights are 1, "94" with the constants for graphic arts (0.045, 0.015).

    Returns
    -------
    (...) float32 if both are, else float64

    >>> round(float(color_difference([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485])), 4)
    2.0425
    """
    first, second = triples(reference, "reference"), triples(sample, "sample")
    if formula not in DIFFERENCES:
        raise UnsupportedError(f"formula must be one of {', '.join(DIFFERENCES)}, got {formula!r}")
    try:
        first, second = np.broadcast_arrays(first, second)
    except ValueError:
        raise SceneError(f"reference and sample must have shapes that fit, got {first.shape} and {second.shape}") from None
    kept = np.result_type(first, second)
    rows = first.reshape(-1, 3).astype(np.float64), second.reshape(-1, 3).astype(np.float64)
    made = {"2000": _of_2000, "94": _of_94, "76": _of_76}[formula](*rows)
    return np.asarray(made.reshape(first.shape[:-1]).astype(kept))


def _of_76(first: Floats, second: Floats) -> Floats:
    return np.asarray(np.sqrt(np.square(first - second).sum(axis=1)))


def _of_94(first: Floats, second: Floats) -> Floats:
    lightness, a, b = (first - second).T
    chroma = np.hypot(first[:, 1], first[:, 2])
    chromas = chroma - np.hypot(second[:, 1], second[:, 2])
    # What of a and b is no chroma is hue; rounding may leave less than nothing
    hues_squared = np.maximum(a * a + b * b - chromas * chromas, 0.0)
    return np.sqrt(lightness**2 + (chromas / (1.0 + 0.045 * chroma)) ** 2 + hues_squared / (1.0 + 0.015 * chroma) ** 2)


def _of_2000(first: Floats, second: Floats) -> Floats:
    """Sharma, Wu and Dalal, equations 2 to 22."""
    mean = 0.5 * (np.hypot(first[:, 1], first[:, 2]) + np.hypot(second[:, 1], second[:, 2]))
    stretch = 1.5 - 0.5 * _saturated(mean)
    a1, a2 = stretch * first[:, 1], stretch * second[:, 1]
    c1, c2 = np.hypot(a1, first[:, 2]), np.hypot(a2, second[:, 2])
    h1 = np.mod(np.arctan2(first[:, 2], a1), 2.0 * np.pi)
    h2 = np.mod(np.arctan2(second[:, 2], a2), 2.0 * np.pi)
    grey = c1 * c2 == 0.0

    # Differences
    turn = h2 - h1
    turn = np.where(np.abs(turn) <= np.pi, turn, turn - np.copysign(2.0 * np.pi, turn))
    hues = 2.0 * np.sqrt(c1 * c2) * np.sin(0.5 * np.where(grey, 0.0, turn))
    lightness, chromas = second[:, 0] - first[:, 0], c2 - c1

    # Means
    l_mean, c_mean = 0.5 * (first[:, 0] + second[:, 0]), 0.5 * (c1 + c2)
    total = h1 + h2
    across = np.where(total < 2.0 * np.pi, total + 2.0 * np.pi, total - 2.0 * np.pi)
    h_mean = np.where(grey, total, 0.5 * np.where(np.abs(h1 - h2) <= np.pi, total, across))

    # Weights
    at = np.radians
    t = 1.0 - 0.17 * np.cos(h_mean - at(30.0)) + 0.24 * np.cos(2.0 * h_mean)
    t += 0.32 * np.cos(3.0 * h_mean + at(6.0)) - 0.20 * np.cos(4.0 * h_mean - at(63.0))
    from_middle = np.square(l_mean - 50.0)
    s_l = 1.0 + 0.015 * from_middle / np.sqrt(20.0 + from_middle)
    s_c, s_h = 1.0 + 0.045 * c_mean, 1.0 + 0.015 * c_mean * t
    blue = at(30.0) * np.exp(-np.square((np.degrees(h_mean) - 275.0) / 25.0))
    rotation = -np.sin(2.0 * blue) * 2.0 * _saturated(c_mean)
    parts = lightness / s_l, chromas / s_c, hues / s_h
    return np.sqrt(np.maximum(parts[0] ** 2 + parts[1] ** 2 + parts[2] ** 2 + rotation * parts[1] * parts[2], 0.0))


def _saturated(chroma: Floats) -> Floats:
    """``sqrt(C^7 / (C^7 + 25^7))``, divided so that no power overflows."""
    with np.errstate(divide="ignore", over="ignore"):
        return 1.0 / np.sqrt(1.0 + np.power(25.0 / np.abs(chroma), 7.0))
