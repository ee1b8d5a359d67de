"""What a space can show, and what to do with what it cannot (FoCG 19.1.5, 19.2).

    gamut_area("display_p3")                          0.152 of the plane of x and y
    gamut_coverage("srgb", "display_p3")              1: P3 shows all that sRGB has
    fit_to_gamut(rgb, method="chroma")                as bright and of the same hue, only paler, instead of clipped

Three lamps show what lies in the triangle between them. A number below 0 or above 1 asks for a colour outside. Clipping each number changes
hues; giving up chroma keeps hue and lightness.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UnsupportedError
from .chromaticity import uv_from_xy
from .spaces import SPACES, Space, rgb_from_rgb, space
from .triples import in_pieces, triples
from .uniform import oklab_from_xyz, xyz_from_oklab

__all__ = ["GAMUT_METHODS", "fit_to_gamut", "gamut_area", "gamut_coverage", "in_gamut", "ring_area"]

Floats = NDArray[np.float64]

GAMUT_METHODS = ("clip", "chroma")

_ROUNDS = 40  # halvings of the chroma
_TOLERANCE = 1e-9


def in_gamut(rgb: ArrayLike, tolerance: float = _TOLERANCE) -> NDArray[np.bool_]:
    """(...) bool: whether all three of linear or stored red, green, blue lie in [0, 1]; NaN does not.

    >>> in_gamut([[0.0, 0.5, 1.0], [-0.1, 0.5, 1.0]]).tolist()
    [True, False]
    """
    given = triples(rgb, "rgb")
    return np.asarray(((given >= -tolerance) & (given <= 1.0 + tolerance)).all(axis=-1))


def _outline(name: str | Space, plane: str) -> Floats:
    if plane not in ("xy", "uv"):
        raise UnsupportedError(f"plane must be xy or uv, got {plane!r}")
    corners = space(name).primaries
    return np.asarray(uv_from_xy(corners)) if plane == "uv" else corners


def ring_area(ring: Floats) -> float:
    """Area inside a ring of points, (n, 2); negative where it is clockwise."""
    x, y = ring.T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def gamut_area(name: str | Space, plane: str = "xy") -> float:
    """Area of the triangle of a space's lamps, in x, y or u', v'.

    >>> round(gamut_area("srgb"), 4), round(gamut_area("rec2020") / gamut_area("srgb"), 3)
    (0.1121, 1.891)
    """
    return abs(ring_area(_outline(name, plane)))


def gamut_coverage(name: str | Space, of: str | Space, plane: str = "xy") -> float:
    """Share of the triangle of `of` that a space shows: 1 where it shows all.

    >>> round(gamut_coverage("srgb", "display_p3"), 3), gamut_coverage("display_p3", "srgb")
    (0.737, 1.0)

    **Source**: the cut of two convex polygons: Sutherland and Hodgman, *Reentrant polygon clipping*, 1974.
    """
    ring, window = _outline(of, plane), _outline(name, plane)
    if ring_area(window) < 0.0:
        window = window[::-1]
    whole = abs(ring_area(ring))
    for start, end in zip(window, np.roll(window, -1, axis=0), strict=True):
        ring = _cut(ring, start, end)
        if len(ring) < 3:
            return 0.0
    return min(abs(ring_area(ring)) / whole, 1.0)


def _cut(ring: Floats, start: Floats, end: Floats) -> Floats:
    """What of a convex ring lies left of the line from start to end."""
    way = end - start
    sides = way[0] * (ring[:, 1] - start[1]) - way[1] * (ring[:, 0] - start[0])
    kept = []
    for here, there, side, other in zip(ring, np.roll(ring, -1, axis=0), sides, np.roll(sides, -1), strict=True):
        if side >= 0.0:
            kept.append(here)
        if (side < 0.0) != (other < 0.0) and side != other:
            kept.append(here + (there - here) * side / (side - other))
    return np.array(kept).reshape(-1, 2)


def fit_to_gamut(rgb: ArrayLike, method: str = "clip", name: str | Space = "srgb") -> NDArray[np.float32] | NDArray[np.float64]:
    """Map colours that a space cannot show to ones that it can.

    Parameters
    ----------
    rgb : (..., 3) float
        Linear. What is shown stays as it is, to the bit; NaN stays NaN.
    method : "clip" | "chroma"
        Clip each number to [0, 1]; or keep lightness and hue in Oklab and give up as much chroma as must be. What is brighter than white
        becomes white, what is darker than black black.
    name : str or Space
        Of whose light these are the numbers.

    >>> fit_to_gamut([1.2, 0.2, -0.1], "clip").tolist(), fit_to_gamut([1.2, 0.2, -0.1], "chroma").round(3).tolist()
    ([1.0, 0.2, 0.0], [0.953, 0.279, 0.0])

    **Source**: chroma: Morovič, *Color Gamut Mapping*, 2008, 6 (towards the grey of the same lightness); in Oklab as in W3C CSS Color 4,
    13.2, without its final clip.
    """
    if method not in GAMUT_METHODS:
        raise UnsupportedError(f"method must be one of {', '.join(GAMUT_METHODS)}, got {method!r}")
    of = space(name)
    if method == "clip":
        given = triples(rgb, "rgb")
        return np.clip(given, given.dtype.type(0.0), given.dtype.type(1.0))
    return in_pieces(lambda rows: _paler(rows, of), rgb, "rgb")


def _paler(rows: Floats, of: Space) -> Floats:
    outside = np.flatnonzero(np.isfinite(rows).all(axis=1) & ~in_gamut(rows, 0.0))
    if not len(outside):
        return rows
    srgb = SPACES["srgb"]
    xyz_from_rgb = srgb.xyz_from_rgb @ rgb_from_rgb(srgb, of)
    rgb_from_xyz = np.linalg.inv(xyz_from_rgb)
    lab = np.asarray(oklab_from_xyz(rows[outside] @ xyz_from_rgb.T))
    lab[:, 0] = np.clip(lab[:, 0], 0.0, 1.0)

    def shown(share: Floats) -> Floats:
        return np.asarray(xyz_from_oklab(lab * np.column_stack([np.ones_like(share), share, share])) @ rgb_from_xyz.T)

    low, high = np.zeros(len(lab)), np.ones(len(lab))
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        fits = in_gamut(shown(middle))
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    made = rows.copy()
    made[outside] = np.clip(shown(low), 0.0, 1.0)
    return made
