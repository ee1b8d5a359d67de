"""Tone: how dark a place of a picture looks, and dots that look as dark (FoCG 10.3; stippling).

    dots = stippling(tone_of(image.pixels), image.aov["instance_id"] >= 0, radius=1.0)

Stippling draws shade with dots alone. They must be dense where it is dark, and nowhere in rows or clumps: each dot is in the middle, by
weight of darkness, of the places that are nearer to it than to any other.

        random points    ──►   every place goes to its nearest dot   ──►   every dot goes to the middle of its places   ──►   …

**Source**: Secord, *Weighted Voronoi stippling*, 2002; Lloyd, *Least squares quantization in PCM*, 1982. Nearest dots are found by
jump flooding (Rong and Tan 2006), and from round to round, in which dots move little, by asking the neighbours only.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["sampled", "stippling", "tone_of"]

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec. 709
_ROUNDS = 24
_MOST_DOTS = 200_000
_AROUND = [(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j]


def tone_of(pixels: NDArray[np.float32]) -> Floats:
    """How light each pixel looks, (height, width) from 0 for black to 1 for white, of linear light (height, width, 3 or 4).

    CIE lightness over 100, so that equal steps look equal; what is brighter than white is white.
    """
    y = np.clip(pixels[..., :3].astype(np.float64) @ _LUMINANCE, 0.0, 1.0)
    return np.where(y > 216.0 / 24389.0, 1.16 * np.cbrt(y) - 0.16, 24389.0 / 2700.0 * y)


def sampled(values: NDArray[np.floating], places: Floats) -> Floats:
    """Values (height, width) at places (n, 2), x and y from the upper left corner, interpolated between pixel centres."""
    height, width = values.shape
    x, y = np.clip(places[:, 0] - 0.5, 0.0, width - 1.0), np.clip(places[:, 1] - 0.5, 0.0, height - 1.0)
    i, j = np.minimum(x.astype(np.int64), max(width - 2, 0)), np.minimum(y.astype(np.int64), max(height - 2, 0))
    u, v = x - i, y - j
    k, m = np.minimum(i + 1, width - 1), np.minimum(j + 1, height - 1)
    above = (1.0 - u) * values[j, i] + u * values[j, k]
    return (1.0 - v) * above + v * ((1.0 - u) * values[m, i] + u * values[m, k])


def stippling(
    tone: NDArray[np.floating], covered: NDArray[np.bool_], *, radius: float = 1.0, seed: int = 0, rounds: int = _ROUNDS
) -> Floats:
    """Place dots that look as dark as a picture.

    Parameters
    ----------
    tone : (height, width) float
        From 0 for black to 1 for white; see `tone_of`.
    covered : (height, width) bool
        Where dots may be.
    radius : float >= 1
        Of a dot, pixels. There are as many dots as have, together, the area of what is to be black: 1 - tone of every pixel.
    seed : int
        The same seed, the same dots.
    rounds : int >= 0
        How often the dots are moved.

    Returns
    -------
    (n, 2) float64
        Their middles: x to the right, y down from the picture's upper left corner.
    """
    if not (math.isfinite(radius) and radius >= 1.0):
        raise SceneError(f"radius must be at least one pixel, got {radius}")
    weight = np.where(covered, np.clip(1.0 - tone, 0.0, 1.0), 0.0).astype(np.float64)
    count = round(float(weight.sum()) / (math.pi * radius**2))
    if count > _MOST_DOTS:
        raise SceneError(f"the picture needs {count} dots of radius {radius:g}, more than {_MOST_DOTS}: choose a larger radius")
    if count < 1:
        return np.zeros((0, 2))
    dots = _scattered(weight, count, seed)
    if rounds:
        label = _flooded(dots, weight.shape)
        for _ in range(rounds):
            dots = _centered(dots, weight, label)
            label = _asked(dots, label, 1)
    return dots


def _scattered(weight: Floats, count: int, seed: int) -> Floats:
    """Random places with the density of the weight, each of `count` equal shares of it with one."""
    rng = np.random.default_rng(seed)
    sums = np.cumsum(weight.reshape(-1))
    # A share is at least three places that are black, so that no two dots begin in one.
    at = (np.arange(count) + 0.25 + 0.5 * rng.random(count)) / count * sums[-1]
    cell = np.searchsorted(sums, at, side="right").clip(0, weight.size - 1)
    j, i = np.divmod(cell, weight.shape[1])
    return np.stack([i, j], axis=1) + rng.random((count, 2))


def _flooded(dots: Floats, shape: tuple[int, ...]) -> Labels:
    """(height, width) int64: the dot nearest to each pixel, by jump flooding."""
    label = np.full(shape, -1, dtype=np.int64)
    i, j = np.floor(dots).astype(np.int64).T
    label[j.clip(0, shape[0] - 1), i.clip(0, shape[1] - 1)] = np.arange(len(dots))
    step = 1 << max(0, max(shape) - 1).bit_length()
    while step > 1:
        step //= 2
        label = _asked(dots, label, step)
    return _asked(dots, label, 1)


def _asked(dots: Floats, label: Labels, step: int) -> Labels:
    """Each pixel takes the nearest of its own dot and those of the eight pixels `step` away."""
    height, width = label.shape
    y, x = np.mgrid[0.5 : height + 0.5, 0.5 : width + 0.5]
    padded = np.pad(label, step, constant_values=-1)
    best, distance = label, _squared(dots, label, x, y)
    for i, j in _AROUND:
        other = padded[step + j * step : step + j * step + height, step + i * step : step + i * step + width]
        theirs = _squared(dots, other, x, y)
        nearer = theirs < distance
        best, distance = np.where(nearer, other, best), np.where(nearer, theirs, distance)
    return best


def _squared(dots: Floats, label: Labels, x: Floats, y: Floats) -> Floats:
    near = dots[label]
    return np.where(label >= 0, (near[..., 0] - x) ** 2 + (near[..., 1] - y) ** 2, np.inf)


def _centered(dots: Floats, weight: Floats, label: Labels) -> Floats:
    """Every dot in the middle of its pixels, by their weight; one that has none stays."""
    height, width = label.shape
    flat, heavy = label.reshape(-1), weight.reshape(-1)
    j, i = np.divmod(np.arange(height * width), width)
    total = np.bincount(flat, heavy, len(dots))
    sums = np.stack([np.bincount(flat, heavy * (at + 0.5), len(dots)) for at in (i, j)], axis=1)
    return np.where(total[:, None] > 1e-12, sums / np.where(total > 1e-12, total, 1.0)[:, None], dots)
