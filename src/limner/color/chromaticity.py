"""Colour without brightness: the plane of chromaticities (FoCG 19.1.5).

    xy_from_xyz([0.95, 1.0, 1.09])        [0.3125, 0.3289]
    dominant_wavelength([0.2, 0.6])       what single wavelength, mixed with white, looks like it, and how pure it is

x = X / (X + Y + Z), y = Y / (X + Y + Z). All mixtures of two lights lie on the straight line between them; what can be seen lies inside the
locus of single wavelengths, closed below by the purples, which no wavelength has. Equal steps in x, y are not equally well seen: u', v' are
better.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .observer import DEFAULT_OBSERVER, matching_functions
from .spectrum import WAVELENGTHS
from .triples import in_pieces, triples

__all__ = [
    "D65_XY", "Dominant", "dominant_wavelength", "spectral_locus", "uv_from_xy", "uvs_1960_from_xy", "xy_from_uv", "xy_from_xyz",
    "xyy_from_xyz", "xyz_from_xy", "xyz_from_xyy",
]  # fmt: skip

Floats = NDArray[np.float64]

D65_XY = (0.3127, 0.3290)
"""The white of sRGB, as its standard rounds it."""

_LOCUS_NM = (380.0, 700.0)  # beyond it the locus turns back on itself, by what the tables round away


def xy_from_xyz(xyz: ArrayLike, black: tuple[float, float] = D65_XY) -> NDArray[np.floating]:
    """(..., 2): chromaticity; of black, which has none, that of `black`."""
    return np.ascontiguousarray(xyy_from_xyz(xyz, black)[..., :2])


def xyy_from_xyz(xyz: ArrayLike, black: tuple[float, float] = D65_XY) -> NDArray[np.floating]:
    """(..., 3): x, y and the luminance Y. Where X + Y + Z is 0, x and y are those of `black`, so that grey has one chromaticity down to 0.

    >>> xyy_from_xyz([[0.5, 0.25, 0.25], [0.0, 0.0, 0.0]]).tolist()
    [[0.5, 0.25, 0.25], [0.3127, 0.329, 0.0]]

    **Source**: FoCG 19.1.5.
    """

    def change(rows: Floats) -> Floats:
        total = rows.sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = rows[:, :2] / total[:, None]
        shares[total == 0.0] = black
        return np.column_stack([shares, rows[:, 1]])

    return in_pieces(change, xyz, "xyz")


def xyz_from_xyy(xyy: ArrayLike) -> NDArray[np.floating]:
    """(..., 3): ``X = x Y / y``, ``Z = (1 - x - y) Y / y``; where y is 0 nothing is seen, and all three are 0.

    >>> xyz_from_xyy([[0.5, 0.25, 0.25], [0.7, 0.0, 0.0]]).tolist()
    [[0.5, 0.25, 0.25], [0.0, 0.0, 0.0]]

    **Source**: FoCG 19.1.5, which leaves y = 0 open.
    """

    def change(rows: Floats) -> Floats:
        x, y, luminance = rows.T
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = np.where(y == 0.0, 0.0, luminance / y)
        return np.column_stack([x * scale, np.where(y == 0.0, 0.0, luminance), (1.0 - x - y) * scale])

    return in_pieces(change, xyy, "xyY")


def xyz_from_xy(xy: ArrayLike, luminance: ArrayLike = 1.0) -> NDArray[np.floating]:
    """(..., 3): the light of a chromaticity, (..., 2), and a luminance."""
    given = triples(xy, "xy", last=2)
    height = np.broadcast_to(np.asarray(luminance, dtype=given.dtype), given.shape[:-1])
    return xyz_from_xyy(np.concatenate([given, height[..., None]], axis=-1))


def uv_from_xy(xy: ArrayLike) -> NDArray[np.floating]:
    """(..., 2): CIE 1976 u', v', in which equal distances look more alike.

    >>> uv_from_xy(D65_XY).round(4).tolist()
    [0.1978, 0.4683]

    **Source**: CIE 015:2018, 8.1; ``u' = 4x / (-2x + 12y + 3)``, ``v' = 9y / (-2x + 12y + 3)``.
    """
    given = triples(xy, "xy", last=2)
    x, y = given[..., 0], given[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([4.0 * x, 9.0 * y], axis=-1) / (-2.0 * x + 12.0 * y + 3.0)[..., None]


def xy_from_uv(uv: ArrayLike) -> NDArray[np.floating]:
    """(..., 2): x, y of u', v'; the inverse of `uv_from_xy`."""
    given = triples(uv, "u'v'", last=2)
    u, v = given[..., 0], given[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([9.0 * u, 4.0 * v], axis=-1) / (6.0 * u - 16.0 * v + 12.0)[..., None]


def uvs_1960_from_xy(xy: ArrayLike) -> NDArray[np.floating]:
    """(..., 2): CIE 1960 u, v, by which temperatures are told: v = 2/3 v'."""
    return uv_from_xy(xy) * np.array([1.0, 2.0 / 3.0], dtype=np.float32 if np.asarray(xy).dtype == np.float32 else np.float64)


@cache
def spectral_locus(observer: str = DEFAULT_OBSERVER) -> Floats:
    """(321, 2) float64: x, y of the wavelengths from 380 to 700 nm, nanometre by nanometre; beyond, colours hardly change."""
    seen = (_LOCUS_NM[0] <= WAVELENGTHS) & (_LOCUS_NM[1] >= WAVELENGTHS)
    made = matching_functions(observer)[seen]
    made = made[:, :2] / made.sum(axis=1, keepdims=True)
    made.flags.writeable = False
    return made


class Dominant(NamedTuple):
    """Which wavelength a colour looks like, and how much."""

    wavelength: NDArray[np.float64]
    """(...) nm; of purples, which no wavelength looks like, minus that of their complement; NaN of white itself."""
    purity: NDArray[np.float64]
    """(...): 0 for white, 1 on the locus or the line of purples; more than 1 outside."""


def dominant_wavelength(xy: ArrayLike, white: tuple[float, float] = D65_XY, observer: str = DEFAULT_OBSERVER) -> Dominant:
    """Find where the line from white through a colour leaves what can be seen.

    Parameters
    ----------
    xy : (..., 2) float
    white : (2,) float
    observer : str

    >>> found = dominant_wavelength([[0.64, 0.33], [0.3, 0.15]])
    >>> found.wavelength.round(1).tolist(), found.purity.round(3).tolist()
    ([611.3, -554.8], [0.917, 0.667])

    **Source**: CIE 015:2018, 9.3 and 9.4 (excitation purity).
    """
    given = triples(xy, "xy", last=2).astype(np.float64)
    flat = given.reshape(-1, 2)
    middle = np.asarray(white, dtype=np.float64)
    ring = spectral_locus(observer) - middle
    starts, steps = ring, np.roll(ring, -1, axis=0) - ring  # the last step is the line of purples
    wavelengths, purities = np.full(len(flat), np.nan), np.full(len(flat), np.nan)
    for index, way in enumerate(flat - middle):
        if not np.isfinite(way).all():
            continue
        if not way.any():
            purities[index] = 0.0
            continue
        ahead, place, edge = _leaves(way, starts, steps)
        purities[index] = 1.0 / ahead
        if edge == len(ring) - 1:
            _, place, edge = _leaves(-way, starts, steps)
            wavelengths[index] = -(_LOCUS_NM[0] + edge + place)
        else:
            wavelengths[index] = _LOCUS_NM[0] + edge + place
    return Dominant(wavelengths.reshape(given.shape[:-1]), purities.reshape(given.shape[:-1]))


def _leaves(way: Floats, starts: Floats, steps: Floats) -> tuple[float, float, int]:
    """How many times `way` it is to the ring, where in its edge the ring is met, and which edge that is."""
    across = way[0] * steps[:, 1] - way[1] * steps[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = (starts[:, 0] * steps[:, 1] - starts[:, 1] * steps[:, 0]) / across
        place = (starts[:, 0] * way[1] - starts[:, 1] * way[0]) / across
    met = (ahead > 0.0) & (place >= -1e-12) & (place <= 1.0 + 1e-12)
    edge = int(np.argmax(np.where(met, ahead, -1.0)))
    return float(ahead[edge]), float(place[edge]), edge
