"""The standard observers: how much of what light an average eye sees (FoCG 19.1.2 to 19.1.4).

In a colour matching experiment a person turns the power of three lamps until their mixture looks like a light of one wavelength. With real
lamps some wavelengths cannot be matched: between 435.8 and 546.1 nm *red* has to be added to the light itself, so its amount counts as
negative. That lobe is in `rgb_matching_functions`. The CIE moved to three primaries that no lamp has, X, Y and Z, in which all amounts are
positive and Y alone is how bright the light looks. All of these are linear mixtures of the answers of the eye's three kinds of cones.

    matching_functions()                  x, y, z at each nm
    rgb_matching_functions()              red, green, blue of 700, 546.1 and 435.8 nm, with the negative lobe
    cone_fundamentals()                   the long, middle and short cones
    luminous_efficiency("scotopic")       what the rods see at night
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from .published import published
from .spectrum import WAVELENGTHS

__all__ = [
    "DEFAULT_OBSERVER", "OBSERVERS", "checked_observer", "cone_fundamentals", "luminous_efficiency", "matching_functions",
    "rgb_matching_functions", "rgb_matching_primaries",
]  # fmt: skip

Floats = NDArray[np.float64]

OBSERVERS = ("cie_1931_2", "cie_1964_10")
"""2 degrees: a thumbnail at arm's length; 10 degrees: a fist."""
DEFAULT_OBSERVER = "cie_1931_2"
RGB_PRIMARIES_NM = (700.0, 546.1, 435.8)


def checked_observer(name: str) -> str:
    """The name of a known observer; else UnsupportedError."""
    if name not in OBSERVERS:
        raise UnsupportedError(f"observer must be one of {', '.join(OBSERVERS)}, got {name!r}")
    return name


def _at_all(name: str) -> Floats:
    """A table at `WAVELENGTHS`; 0 where it has nothing, for there is next to nothing to see."""
    table = published(name)
    made = np.stack([np.interp(WAVELENGTHS, table.wavelengths, column, left=0.0, right=0.0) for column in table.values.T], axis=1)
    made.flags.writeable = False
    return made


@cache
def matching_functions(observer: str = DEFAULT_OBSERVER) -> Floats:
    """(471, 3) float64: x, y and z at `WAVELENGTHS`.

    >>> matching_functions()[555 - 360].round(4).tolist()
    [0.5121, 1.0, 0.0057]

    **Source**: CIE 018:2019, tables 6 and 7.
    """
    return _at_all(checked_observer(observer))


@cache
def cone_fundamentals() -> Floats:
    """(471, 3) float64: what long, middle and short cones answer to equal energy, each at most 1.

    **Source**: Stockman and Sharpe, *Vision Research* 40, 2000; CIE 170-1:2006. Below 390 nm, where they publish nothing: 0.
    """
    return _at_all("cones_2")


@cache
def luminous_efficiency(kind: str = "photopic") -> Floats:
    """(471,) float64: how bright light of a wavelength looks, by day (``"photopic"``, which is y) or by night (``"scotopic"``).

    **Source**: CIE 018:2019, tables 1 and 4.
    """
    if kind == "photopic":
        return matching_functions()[:, 1]
    if kind == "scotopic":
        return _at_all("scotopic")[:, 0]
    raise UnsupportedError(f"luminous efficiency is photopic or scotopic, got {kind!r}")


@cache
def rgb_matching_primaries() -> Floats:
    """(3, 3) float64, XYZ of the amounts 1 of the lamps of 700, 546.1 and 435.8 nm (columns): mixed, equal energy.

    The colours of the lamps are those of the 1931 observer at their wavelengths; their amounts follow from the white.
    """
    colors = np.stack([np.interp(RGB_PRIMARIES_NM, WAVELENGTHS, column) for column in matching_functions().T])
    return np.asarray(colors * np.linalg.solve(colors, np.ones(3)))


@cache
def rgb_matching_functions() -> Floats:
    """(471, 3) float64: how much of the lamps of 700, 546.1 and 435.8 nm match each wavelength; negative where a lamp goes to the other
    side.

    >>> functions = rgb_matching_functions()
    >>> int(WAVELENGTHS[functions[:, 0].argmin()]), functions.min(axis=0).round(2).tolist()
    (517, [-0.53, -0.01, -0.01])

    **Source**: FoCG 19.1.4; derived from the XYZ functions rather than from the first printed table, with units in which equal energy is
    (1, 1, 1).
    """
    made = matching_functions() @ np.linalg.inv(rgb_matching_primaries()).T
    made.flags.writeable = False
    return made
