"""Hatching: light and shade by parallel strokes, and where it is darkest by strokes across them (FoCG 10.3).

    strokes = hatching(luminance, ids, spacing=5.0)

Every level of strokes covers what is darker than its threshold: the first at 45 degrees what is not in the light, the second across it
what is in half shadow, the third and fourth, level and upright, the darkest. Strokes end where the tone changes and where one shape ends
and another begins, to a fraction of a pixel, and are vectors of any width.

**Source**: Winkenbach and Salesin, *Computer-generated pen-and-ink illustration*, 1994 (prioritized strokes: tone by the number of layers).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from .tone import sampled

__all__ = ["ANGLES", "THRESHOLDS", "hatching"]

Floats = NDArray[np.float64]

ANGLES = (45.0, 135.0, 90.0, 0.0)
"""Degrees of the strokes of each level, counter-clockwise from the right."""

THRESHOLDS = (0.62, 0.38, 0.2, 0.08)
"""What tone, from 0 for black to 1 for white, is covered by each level's strokes: that which is darker."""

_STEP = 0.5  # pixels between places where the tone is looked at


def hatching(
    tone: NDArray[np.floating],
    ids: NDArray[np.int32],
    *,
    spacing: float = 5.0,
    angles: Sequence[float] = ANGLES,
    thresholds: Sequence[float] = THRESHOLDS,
    shortest: float = 2.0,
) -> list[Floats]:
    """Cover dark places with strokes.

    Parameters
    ----------
    tone : (height, width) float
        As the eye sees it, from 0 for black to 1 for white (`limner.artistic.tone.tone_of`).
    ids : (height, width) int32
        What is seen; -1: nothing, which has no strokes. A stroke lies on one thing alone.
    spacing : float > 0
        Between strokes, pixels.
    angles, thresholds : sequence of float
        Of each level, as `ANGLES` and `THRESHOLDS`.
    shortest : float
        Strokes that are shorter, in pixels, are left out.

    Returns
    -------
    list of (2, 2) float64
        Strokes, from end to end: x to the right, y down from the picture's upper left corner.
    """
    if not (math.isfinite(spacing) and spacing >= 0.5):
        raise SceneError(f"spacing must be at least half a pixel, got {spacing}")
    if tone.shape != ids.shape:
        raise SceneError(f"tone and ids must be of one picture, got {tone.shape} and {ids.shape}")
    strokes: list[Floats] = []
    for angle, threshold in zip(angles, thresholds, strict=True):
        for places in _rulings(ids.shape[1], ids.shape[0], math.radians(angle), spacing):
            strokes += _runs(places, sampled(tone, places), _seen(ids, places), threshold, shortest)
    return strokes


def _rulings(width: int, height: int, angle: float, spacing: float) -> list[Floats]:
    """Parallel lines over a picture, each as places (n, 2) a step apart."""
    along, across = np.array([math.cos(angle), -math.sin(angle)]), np.array([math.sin(angle), math.cos(angle)])
    corners = np.array([(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)])
    reach, off = corners @ along, corners @ across
    made = []
    for k in range(math.ceil(off.min() / spacing), math.floor(off.max() / spacing) + 1):
        t = np.arange(math.floor(reach.min() / _STEP), math.ceil(reach.max() / _STEP) + 1) * _STEP
        places = t[:, None] * along + k * spacing * across
        inside = ((places > 0.0) & (places < (width, height))).all(axis=1)
        if inside.any():
            made.append(places[inside])
    return made


def _seen(ids: NDArray[np.int32], places: Floats) -> NDArray[np.int32]:
    column, row = np.floor(places).astype(np.int64).T
    return ids[np.clip(row, 0, ids.shape[0] - 1), np.clip(column, 0, ids.shape[1] - 1)]


def _runs(places: Floats, tone: Floats, seen: NDArray[np.int32], threshold: float, shortest: float) -> list[Floats]:
    """The parts of a line that lie on one thing and are darker than the threshold; where the tone passes it, ends are interpolated."""
    dark = (seen >= 0) & (tone < threshold)
    changes = np.flatnonzero((dark[1:] != dark[:-1]) | (dark[1:] & (seen[1:] != seen[:-1]))) + 1
    bounds = np.concatenate([[0], changes, [len(dark)]])
    made = []
    for first, last in zip(bounds[:-1].tolist(), (bounds[1:] - 1).tolist(), strict=True):
        if not dark[first]:
            continue
        ends = [_end(places, tone, seen, first, first - 1, threshold), _end(places, tone, seen, last, last + 1, threshold)]
        if np.linalg.norm(ends[1] - ends[0]) >= shortest:
            made.append(np.stack(ends))
    return made


def _end(places: Floats, tone: Floats, seen: NDArray[np.int32], inside: int, outside: int, threshold: float) -> Floats:
    """Where a run ends that goes on to `inside` but not to `outside`."""
    if not 0 <= outside < len(tone) or seen[outside] != seen[inside] or tone[outside] == tone[inside]:
        return places[inside]
    share = (threshold - tone[inside]) / (tone[outside] - tone[inside])
    return places[inside] + min(max(float(share), 0.0), 1.0) * (places[outside] - places[inside])
