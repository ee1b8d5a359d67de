"""What metals reflect, from what was measured of them.

    metal_color("gold")                   what it reflects straight on, linear Rec. 709: give it to a mirror or a metal as its colour

A metal's complex index of refraction n + ik depends on the wavelength; that is why gold and copper have a colour and why it is no
pigment's. Fresnel's formula at normal incidence makes a reflectance of it, and the observer three numbers. Towards grazing angles every
metal goes to white, which the renderers add by themselves.

**Source**: the measurements named in `data/metals.csv`; Fresnel at normal incidence, ``F0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)``.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from .light import rgb_from_reflectance
from .published import read_rows
from .spectrum import Spectrum

__all__ = ["METALS", "Measured", "measured_metal", "metal_color", "metal_spectrum", "normal_reflectance"]

Floats = NDArray[np.float64]
Triple = tuple[float, float, float]

METALS = (
    "aluminium", "brass", "chromium", "cobalt", "copper", "gold", "iron", "mercury", "nickel", "palladium", "platinum", "silver",
    "titanium", "tungsten", "vanadium", "zinc",
)  # fmt: skip


class Measured(NamedTuple):
    """The complex index of refraction n + ik of a metal."""

    wavelengths: Floats  # (m,), nm
    n: Floats  # (m,)
    k: Floats  # (m,)


def normal_reflectance(n: Any, k: Any) -> Any:
    """F0 of a metal with the complex index of refraction n + ik, seen in air; numbers or arrays.

    >>> normal_reflectance(1.5, 0.0)
    0.04
    """
    return ((n - 1.0) ** 2 + k * k) / ((n + 1.0) ** 2 + k * k)


@cache
def _all() -> dict[str, Measured]:
    rows = read_rows("metals")[1:]
    made = {}
    for metal in METALS:
        numbers = np.array([row[1:] for row in rows if row[0] == metal], dtype=np.float64)
        numbers.flags.writeable = False
        made[metal] = Measured(*numbers.T)
    return made


def measured_metal(name: str) -> Measured:
    """What was measured of a metal; UnsupportedError names all that are known."""
    if name not in METALS:
        raise UnsupportedError(f"a metal must be one of {', '.join(METALS)}, got {name!r}")
    return _all()[name]


def metal_spectrum(name: str) -> Spectrum:
    """What a metal reflects straight on, over the wavelengths."""
    metal = measured_metal(name)
    return Spectrum(metal.wavelengths, normal_reflectance(metal.n, metal.k))


def metal_color(name: str) -> Triple:
    """What a metal reflects straight on in daylight: F0, linear Rec. 709.

    Each of the three is limited to [0, 1]: gold is a little more saturated than the primaries can say.

    >>> [round(part, 2) for part in metal_color("gold")]
    [1.0, 0.73, 0.37]
    """
    red, green, blue = np.clip(rgb_from_reflectance(metal_spectrum(name)), 0.0, 1.0).tolist()
    return red, green, blue
