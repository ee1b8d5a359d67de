"""Lights to look at things by: lamps, daylight, glowing bodies (FoCG 19.1).

    illuminant("D65")                     a published table, or formula, by name
    blackbody(3200.0)                     anything that glows because it is hot
    daylight(5500.0)                      the sky with the sun in it, between 4000 and 25000 K

**Source**: CIE 015:2018, 4 (illuminants), 4.1.2 (daylight); Planck's law with the constants of CODATA 2018.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .published import published
from .spectrum import WAVELENGTHS, Spectrum

__all__ = ["ILLUMINANTS", "blackbody", "checked_kelvin", "daylight", "daylight_xy", "illuminant", "planck"]

Floats = NDArray[np.float64]

ILLUMINANTS = ("A", "C", "D50", "D55", "D65", "D75", "E")

_H, _C, _K = 6.62607015e-34, 299792458.0, 1.380649e-23
_MOVED = 1.4388 / 1.4380  # the second radiation constant was another when the D illuminants were named
_DAYLIGHT = (4000.0, 25000.0)
_GREATEST_KELVIN = 1e9


def checked_kelvin(kelvin: float) -> float:
    """A temperature above absolute zero; else SceneError."""
    try:
        number = float(kelvin)
    except (TypeError, ValueError):
        number = math.nan
    if not 0.0 < number <= _GREATEST_KELVIN:
        raise SceneError(f"kelvin must be a temperature above 0, up to {_GREATEST_KELVIN:g}, got {kelvin!r}")
    return number


def planck(wavelengths: ArrayLike, kelvin: ArrayLike) -> Floats:
    """Spectral radiance of a black body, W / (m2 sr nm): ``2 h c^2 / (l^5 (exp(h c / (l k T)) - 1))``.

    Parameters
    ----------
    wavelengths : (...) float
        nm.
    kelvin : (...) float > 0
        Both broadcast.

    >>> planck(560.0, 2856.0).round(1).item()
    268.0

    **Source**: Planck's law.
    """
    metres = np.asarray(wavelengths, dtype=np.float64) * 1e-9
    with np.errstate(over="ignore"):  # exp overflows where there is no light; its inverse is then 0
        heat = np.expm1(_H * _C / (metres * _K * np.asarray(kelvin, dtype=np.float64)))
        return np.asarray(2e-9 * _H * _C * _C / (metres**5 * heat))


def blackbody(kelvin: float) -> Spectrum:
    """A black body's light, W / (m2 sr nm)."""
    return Spectrum(WAVELENGTHS, planck(WAVELENGTHS, checked_kelvin(kelvin)))


def daylight_xy(kelvin: ArrayLike) -> Floats:
    """(..., 2) float64: chromaticity of daylight at a temperature (4000 to 25000 K).

    >>> daylight_xy(6504.0).round(4).tolist()
    [0.3127, 0.3291]

    **Source**: CIE 015:2018, equations 4.2 to 4.4.
    """
    t = np.asarray(kelvin, dtype=np.float64)
    if not ((t >= _DAYLIGHT[0]) & (t <= _DAYLIGHT[1])).all():
        raise SceneError(f"daylight has temperatures from {_DAYLIGHT[0]:g} to {_DAYLIGHT[1]:g} K, got {kelvin!r}; a black body has all")
    u = 1e3 / t
    low = -4.6070 * u**3 + 2.9678 * u**2 + 0.09911 * u + 0.244063
    high = -2.0064 * u**3 + 1.9018 * u**2 + 0.24748 * u + 0.237040
    x = np.where(t <= 7000.0, low, high)
    return np.stack([x, -3.000 * x**2 + 2.870 * x - 0.275], axis=-1)


def daylight(kelvin: float) -> Spectrum:
    """Daylight's relative power, 100 at 560 nm: the mean of measured skies and two ways to differ from it, as the chromaticity wants.

    ``S = S0 + M1 S1 + M2 S2`` with M1 and M2 rounded to three decimals, as the standard has it.

    **Source**: CIE 015:2018, equations 4.1 and 4.5.
    """
    x, y = daylight_xy(checked_kelvin(kelvin)).tolist()
    below = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = round((-1.3515 - 1.7703 * x + 5.9114 * y) / below, 3)
    m2 = round((0.0300 - 31.4424 * x + 30.0717 * y) / below, 3)
    table = published("daylight")
    return Spectrum(table.wavelengths, table.values @ np.array([1.0, m1, m2]))


@cache
def illuminant(name: str) -> Spectrum:
    """A CIE illuminant by name, relative power, 100 at 560 nm.

    A: a lamp with a tungsten filament; C: the daylight of 1931; D50 to D75: daylight; E: the same energy everywhere.

    >>> illuminant("A").at([400.0, 560.0, 700.0]).round(2).tolist()
    [14.71, 100.0, 198.26]

    **Source**: CIE 015:2018: A by its formula, 100 (560/l)^5 (exp(1.435e7 / (2848 560)) - 1) / (exp(1.435e7 / (2848 l)) - 1); C (CIE
    015:2004) and D65 (ISO 11664-2:2007) as printed; other D by `daylight` at their nominal temperature times 1.4388 / 1.4380.
    """
    if name not in ILLUMINANTS:
        raise UnsupportedError(
            f"illuminant must be one of {', '.join(ILLUMINANTS)}, got {name!r}; blackbody and daylight take any temperature"
        )
    if name == "E":
        return Spectrum(WAVELENGTHS, np.full(len(WAVELENGTHS), 100.0))
    if name == "A":
        steps = np.arange(300.0, 831.0)
        heat = np.expm1(1.435e7 / (2848.0 * 560.0)) / np.expm1(1.435e7 / (2848.0 * steps))
        return Spectrum(steps, 100.0 * (560.0 / steps) ** 5 * heat)
    if name in ("C", "D65"):
        table = published(f"illuminant_{name.lower()}")
        return Spectrum(table.wavelengths, table.values[:, 0])
    return daylight(100.0 * float(name[1:]) * _MOVED)
