"""Warm and cold light: colours of glowing bodies, and the temperature whose glow a light is most like.

    xy_from_kelvin(3200.0)                a black body's chromaticity
    kelvin_from_xy([0.3127, 0.3290])      6504 K, and how far from the glow it is (Duv)

The nearest point of the Planckian locus is looked for in CIE 1960 u, v, where temperature is defined; the logarithm of the temperature
makes the locus even enough for a table, and between the table's places a search by thirds finds the minimum.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .chromaticity import uvs_1960_from_xy, xy_from_xyz
from .illuminants import planck
from .observer import DEFAULT_OBSERVER, matching_functions
from .spectrum import WAVELENGTHS
from .triples import triples

__all__ = ["Temperature", "kelvin_from_xy", "xy_from_kelvin", "xyz_from_kelvin"]

Floats = NDArray[np.float64]

_LOWEST, _HIGHEST, _PLACES = 500.0, 1e6, 400
_ROUNDS = 60  # of thirds: from one place of the table to the next, to the rounding of float64
_FAR = 0.05  # Duv beyond which a temperature says nothing (CIE 015:2018, 9.5)
_CHUNK = 512


class Temperature(NamedTuple):
    """The black body that a light is most like."""

    kelvin: NDArray[np.float64]
    """(...): correlated colour temperature; NaN farther than 0.05 from the locus, where it means nothing."""
    duv: NDArray[np.float64]
    """(...): distance from the locus in CIE 1960 u, v; positive above it (greenish), negative below (pinkish)."""


def xyz_from_kelvin(kelvin: ArrayLike, observer: str = DEFAULT_OBSERVER) -> Floats:
    """(..., 3) float64: XYZ of black bodies, with Y = 1."""
    given = np.asarray(kelvin, dtype=np.float64)
    if not ((given >= _LOWEST) & (given <= _HIGHEST)).all():
        raise SceneError(f"kelvin must lie between {_LOWEST:g} and {_HIGHEST:g}, where a black body's colour is known, got {kelvin!r}")
    made = planck(WAVELENGTHS, given[..., None]) @ matching_functions(observer)
    return np.asarray(made / made[..., 1:2])


def xy_from_kelvin(kelvin: ArrayLike, observer: str = DEFAULT_OBSERVER) -> Floats:
    """(..., 2) float64: chromaticity of black bodies, the Planckian locus.

    >>> xy_from_kelvin([2856.0, 6500.0]).round(4).tolist()
    [[0.4475, 0.4074], [0.3135, 0.3236]]
    """
    return np.asarray(xy_from_xyz(xyz_from_kelvin(kelvin, observer)))


@cache
def _locus(observer: str) -> tuple[Floats, Floats]:
    """Logarithms of temperatures, and u, v at each."""
    logs = np.linspace(np.log(_LOWEST), np.log(_HIGHEST), _PLACES)
    return logs, _uv(logs, observer)


def _uv(logs: Floats, observer: str) -> Floats:
    return np.asarray(uvs_1960_from_xy(xy_from_kelvin(np.exp(logs).clip(_LOWEST, _HIGHEST), observer)))


def kelvin_from_xy(xy: ArrayLike, observer: str = DEFAULT_OBSERVER) -> Temperature:
    """Find the correlated colour temperature.

    Parameters
    ----------
    xy : (..., 2) float
    observer : str

    >>> found = kelvin_from_xy([[0.44757, 0.40745], [0.3127, 0.3290], [0.15, 0.06]])
    >>> found.kelvin.round(0).tolist(), found.duv.round(4).tolist()
    ([2856.0, 6504.0, nan], [0.0, 0.0032, -0.1586])

    **Source**: CIE 015:2018, 9.5; Ohno, *Practical use and calculation of CCT and Duv*, Leukos 10, 2014, for the sign of Duv.
    """
    given = triples(xy, "xy", last=2).astype(np.float64)
    flat = np.asarray(uvs_1960_from_xy(given.reshape(-1, 2)))
    logs, distances = np.full(len(flat), np.nan), np.full(len(flat), np.nan)
    sound = np.flatnonzero(np.isfinite(flat).all(axis=1))
    for start in range(0, len(sound), _CHUNK):
        part = sound[start : start + _CHUNK]
        logs[part], distances[part] = _nearest(flat[part], observer)
    kelvin = np.where(np.abs(distances) <= _FAR, np.exp(logs), np.nan)
    return Temperature(kelvin.reshape(given.shape[:-1]), distances.reshape(given.shape[:-1]))


def _nearest(uv: Floats, observer: str) -> tuple[Floats, Floats]:
    """The logarithm of the temperature, and the signed distance, of the nearest place of the locus."""
    places, locus = _locus(observer)
    first = np.square(uv[:, None] - locus).sum(axis=2).argmin(axis=1)
    low, high = places[np.maximum(first - 1, 0)], places[np.minimum(first + 1, len(places) - 1)]
    for _ in range(_ROUNDS):
        left, right = low + (high - low) / 3.0, high - (high - low) / 3.0
        nearer = np.square(uv - _uv(left, observer)).sum(axis=1) < np.square(uv - _uv(right, observer)).sum(axis=1)
        low, high = np.where(nearer, low, left), np.where(nearer, right, high)
        if (high - low).max() < 1e-10:
            break
    found = 0.5 * (low + high)
    away = uv - _uv(found, observer)
    return found, np.hypot(away[:, 0], away[:, 1]) * np.where(away[:, 1] < 0.0, -1.0, 1.0)
