"""Midpoint displacement: lines and lands that are as rough near by as from afar.

The middle of every leg is moved by a random amount, and so is the middle of every half, each time by less. With the roughness H the
deviation falls by 2^-H at each halving, and the graph has dimension 2 - H: 1/2 is a random walk.

**Source**: Fournier, Fussell and Carpenter, "Computer rendering of stochastic models", *CACM* 25(6), 1982; for the variance, Saupe in
Peitgen and Saupe (eds.), *The Science of Fractal Images*, 1988, 2.3.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..control import control_points, degree_of

__all__ = ["displaced_heights", "displaced_line"]

Floats = NDArray[np.float64]

_MOST_HALVINGS = 22


def displaced_heights(halvings: int, roughness: float = 0.5, seed: int = 0, deviation: float = 1.0) -> Floats:
    """Make heights over equal steps.

    Parameters
    ----------
    halvings : int from 0 to 22
    roughness : float in (0, 1)
        H: towards 0 jagged, towards 1 smooth.
    seed : int
    deviation : float >= 0
        Standard deviation of the difference between the ends of a leg of length 1; the ends themselves are 0 and drawn from it.

    Returns
    -------
    (2^halvings + 1,) float64
        The expected square of a difference over the distance t is ``deviation^2 t^(2 H)`` over dyadic legs.
    """
    if not 0 <= degree_of(halvings) <= _MOST_HALVINGS:
        raise SceneError(f"halvings must lie in [0, {_MOST_HALVINGS}], got {halvings}")
    _check(roughness, deviation)
    rng = np.random.default_rng(seed)
    heights = np.array([0.0, deviation * rng.standard_normal()])
    # Half a leg varies by 2^-2H; a quarter of the whole leg's variance is there already
    spread = deviation * math.sqrt(max(0.0, 2.0 ** (-2.0 * roughness) - 0.25))
    for level in range(halvings):
        middles = 0.5 * (heights[:-1] + heights[1:]) + spread * 2.0 ** (-roughness * level) * rng.standard_normal(len(heights) - 1)
        made = np.empty(2 * len(heights) - 1)
        made[::2], made[1::2] = heights, middles
        heights = made
    return heights


def displaced_line(polygon: ArrayLike, halvings: int, roughness: float = 0.5, seed: int = 0, deviation: float = 0.2) -> Floats:
    """Make a coastline of a polygon: middles of legs are moved at right angles to them.

    Parameters
    ----------
    polygon : (n, 2) float, n >= 2
        Its corners stay where they are.
    halvings : int from 0 to 22
    roughness : float in (0, 1)
    seed : int
    deviation : float >= 0
        Of the first middle, as part of its leg's length.

    Returns
    -------
    ((n - 1) 2^halvings + 1, 2) float64
    """
    line = control_points(polygon, 2, "polygon", 2)
    if (len(line) - 1) << min(degree_of(halvings), 60) > 1 << _MOST_HALVINGS:
        raise SceneError(f"a line of {len(line) - 1} legs cannot be halved {halvings} times: the most legs are {1 << _MOST_HALVINGS:,}")
    _check(roughness, deviation)
    rng = np.random.default_rng(seed)
    # Lengths of the first legs fix the scale, so that H alone says how fast the moves become smaller
    scale = np.linalg.norm(np.diff(line, axis=0), axis=1)
    for level in range(halvings):
        leg = np.diff(line, axis=0)
        lengths = np.linalg.norm(leg, axis=1, keepdims=True)
        across = np.stack([-leg[:, 1], leg[:, 0]], axis=1) / np.where(lengths > 0.0, lengths, 1.0)
        move = deviation * scale * 2.0 ** (-roughness * level) * rng.standard_normal(len(leg))
        middles = 0.5 * (line[:-1] + line[1:]) + move[:, None] * across
        made = np.empty((2 * len(line) - 1, 2))
        made[::2], made[1::2] = line, middles
        line, scale = made, np.repeat(scale, 2)
    return line


def _check(roughness: float, deviation: float) -> None:
    if not 0.0 < roughness < 1.0:
        raise SceneError(f"roughness must lie within (0, 1), got {roughness}")
    if not (math.isfinite(deviation) and deviation >= 0.0):
        raise SceneError(f"deviation must not be negative, got {deviation}")
