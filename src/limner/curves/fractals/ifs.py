"""Iterated function systems: a few maps that shrink the plane, and the one set that consists of its own images under them.

    fern = NAMED["fern"].points(100_000, seed=1)

The chaos game finds it: begin anywhere, and apply a map drawn by lot, again and again; all but the first points lie on the set.

**Source**: Hutchinson, "Fractals and self-similarity", 1981; Barnsley, *Fractals Everywhere*, 1988.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..control import degree_of

__all__ = ["NAMED", "FunctionSystem", "box_dimension"]

Floats = NDArray[np.float64]

_LANES = 256  # games at once
_FORGET = 64  # steps after which it does not matter where a game began
_MOST_POINTS = 1 << 24


@dataclass(frozen=True)
class FunctionSystem:
    """Affine maps of the plane, ``p -> A p + b``.

    Parameters
    ----------
    maps : (m, 2, 3) float
        A and b side by side; each must bring points closer together in the long run: the spectral radius of A is below 1.
    probabilities : (m,) float >= 0, optional
        How often each is drawn; None: in proportion to how much area it leaves, but at least a little.
    """

    maps: Floats
    probabilities: Floats | None = None

    def __post_init__(self) -> None:
        maps = np.array(self.maps, dtype=np.float64)
        if maps.ndim != 3 or maps.shape[1:] != (2, 3) or not len(maps) or not np.isfinite(maps).all():
            raise SceneError(f"function_system.maps must be finite numbers of shape (m, 2, 3), got shape {maps.shape}")
        radius = np.abs(np.linalg.eigvals(maps[:, :, :2])).max(axis=1)
        if not (radius < 1.0).all():
            raise SceneError(f"function_system.maps[{int(np.argmax(radius))}] must shrink, got the spectral radius {radius.max():g}")
        area = np.abs(np.linalg.det(maps[:, :, :2]))
        shares = np.maximum(area, 0.01 * max(float(area.max()), 1e-12)) if self.probabilities is None else self.probabilities
        p = np.array(shares, dtype=np.float64)
        if p.shape != (len(maps),) or not np.isfinite(p).all() or (p < 0.0).any() or not p.sum() > 0.0:
            raise SceneError(f"function_system.probabilities must be {len(maps)} numbers that are not negative, got {p.tolist()}")
        object.__setattr__(self, "maps", maps)
        object.__setattr__(self, "probabilities", p / p.sum())

    def points(self, count: int, seed: int = 0) -> Floats:
        """Play the chaos game.

        Parameters
        ----------
        count : int >= 1
        seed : int

        Returns
        -------
        (count, 2) float64
            On the set, but for what 64 steps leave of an arbitrary beginning.
        """
        if not 1 <= degree_of(count) <= _MOST_POINTS:
            raise SceneError(f"the number of points must lie in [1, {_MOST_POINTS:,}], got {count}")
        rng = np.random.default_rng(seed)
        steps = -(-count // _LANES)
        drawn = rng.choice(len(self.maps), size=(steps + _FORGET, _LANES), p=self.probabilities)
        made = np.empty((steps, _LANES, 2))
        at = np.zeros((_LANES, 2))
        for step in range(steps + _FORGET):
            chosen = self.maps[drawn[step]]
            at = (chosen[:, :, :2] @ at[..., None])[..., 0] + chosen[:, :, 2]
            if step >= _FORGET:
                made[step - _FORGET] = at
        return made.reshape(-1, 2)[:count]

    def images(self, points: ArrayLike, times: int = 1) -> Floats:
        """Apply all maps to a set of points, so many times: (n m^times, 2) float64."""
        made = np.asarray(points, dtype=np.float64)
        if made.ndim != 2 or made.shape[1] != 2:
            raise SceneError(f"points must have shape (n, 2), got {made.shape}")
        if len(made) * len(self.maps) ** degree_of(times) > _MOST_POINTS:
            raise SceneError(f"there would be {len(made) * len(self.maps) ** times:,} points; the most is {_MOST_POINTS:,}")
        for _ in range(times):
            made = np.concatenate([made @ each[:, :2].T + each[:, 2] for each in self.maps])
        return made


def box_dimension(points: ArrayLike, coarse: int = 2, fine: int = 7) -> float:
    """Estimate a set's dimension by counting the boxes it touches.

    Parameters
    ----------
    points : (n, 2) float
        Dense enough that the finest boxes are met.
    coarse, fine : int
        Boxes are 2^-coarse to 2^-fine of the set's extent wide.

    Returns
    -------
    float
        The slope of log(boxes) over log(1 / width), by least squares.

    **Source**: Falconer, *Fractal Geometry*, 3rd ed., 2014, 2.1.
    """
    p = np.asarray(points, dtype=np.float64)
    if p.ndim != 2 or p.shape[1] != 2 or len(p) < 2 or not np.ptp(p, axis=0).max() > 0.0:
        raise SceneError(f"a set of points that are not all one, of shape (n, 2), was expected, got shape {p.shape}")
    if not 0 <= coarse < fine <= 24:
        raise SceneError(f"box sizes need 0 <= coarse < fine <= 24, got {coarse} and {fine}")
    unit = (p - p.min(axis=0)) / float(np.ptp(p, axis=0).max())
    exponents = np.arange(coarse, fine + 1)
    counts = []
    for exponent in exponents.tolist():
        side = 1 << exponent
        cell = np.minimum((unit * side).astype(np.int64), side - 1)
        counts.append(len(np.unique(cell[:, 0] * side + cell[:, 1])))
    return float(np.polyfit(exponents * math.log(2.0), np.log(counts), 1)[0])


def _similar(scale: float, degrees: float, x: float, y: float) -> list[list[float]]:
    c, s = scale * math.cos(math.radians(degrees)), scale * math.sin(math.radians(degrees))
    return [[c, -s, x], [s, c, y]]


NAMED: dict[str, FunctionSystem] = {
    "sierpinski": FunctionSystem(np.array([_similar(0.5, 0.0, *corner) for corner in ((0, 0), (0.5, 0), (0.25, math.sqrt(3) / 4))])),
    "carpet": FunctionSystem(np.array([_similar(1 / 3, 0, x / 3, y / 3) for x in range(3) for y in range(3) if (x, y) != (1, 1)])),
    "koch": FunctionSystem(
        np.array([_similar(1 / 3, 0, 0, 0), _similar(1 / 3, 60, 1 / 3, 0), _similar(1 / 3, -60, 0.5, math.sqrt(3) / 6),
                  _similar(1 / 3, 0, 2 / 3, 0)])
    ),
    "dragon": FunctionSystem(np.array([_similar(math.sqrt(0.5), 45, 0, 0), _similar(math.sqrt(0.5), 135, 1, 0)])),
    "fern": FunctionSystem(
        np.array([
            [[0.0, 0.0, 0.0], [0.0, 0.16, 0.0]],
            [[0.85, 0.04, 0.0], [-0.04, 0.85, 1.6]],
            [[0.2, -0.26, 0.0], [0.23, 0.22, 1.6]],
            [[-0.15, 0.28, 0.0], [0.26, 0.24, 0.44]],
        ]),
        np.array([0.01, 0.85, 0.07, 0.07]),
    ),
}  # fmt: skip
"""Well-known ones, by name; the fern is Barnsley's."""
