"""From spectra to three numbers: what an eye makes of light (FoCG 19.1.3).

    xyz_from_emission(blackbody(3200.0))              of a light
    xyz_from_reflectance(paint, illuminant("D65"))    of a surface in that light

Different spectra may have the same three numbers: metamers. They look alike in one light, and not in another.

**Source**: CIE 015:2018, 7.1: sums at each nanometre from 360 to 830.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .illuminants import illuminant
from .observer import DEFAULT_OBSERVER, luminous_efficiency, matching_functions
from .spectrum import Spectrum, sampled

__all__ = ["LUMENS_PER_WATT", "luminance", "metamer", "white_xyz", "xyz_from_emission", "xyz_from_reflectance"]

Floats = NDArray[np.float64]

LUMENS_PER_WATT = 683.002
"""K_cd 683 lm/W at 540 THz, which makes 683.002 at the greatest of V. **Source**: CIE 018:2019."""


def xyz_from_emission(spectrum: Spectrum | ArrayLike, observer: str = DEFAULT_OBSERVER) -> Floats:
    """(..., 3) float64: XYZ of light; where it is 1 at all wavelengths, Y is 1.

    Parameters
    ----------
    spectrum : Spectrum, or (..., 471) float at `WAVELENGTHS`
    observer : str
        One of `OBSERVERS`.

    >>> xyz_from_emission(illuminant("E")).round(3).tolist()
    [100.008, 100.0, 100.033]
    """
    functions = matching_functions(observer)
    return np.asarray(sampled(spectrum) @ functions / functions[:, 1].sum())


def luminance(spectrum: Spectrum | ArrayLike) -> Floats:
    """(...) float64: cd/m2 of radiance in W / (m2 sr nm), and likewise lumen of watts: ``683.002 sum(V(l) S(l))``."""
    return np.asarray(LUMENS_PER_WATT * sampled(spectrum) @ luminous_efficiency())


def white_xyz(light: Spectrum | ArrayLike | str = "D65", observer: str = DEFAULT_OBSERVER) -> Floats:
    """(3,) float64: XYZ of a surface that reflects all of a light, with Y = 1; the light may be an illuminant's name.

    >>> white_xyz("D65").round(4).tolist()
    [0.9505, 1.0, 1.0888]
    """
    made = xyz_from_emission(illuminant(light) if isinstance(light, str) else light, observer)
    return np.asarray(made / made[..., 1:2])


def xyz_from_reflectance(
    reflectance: Spectrum | ArrayLike, light: Spectrum | ArrayLike | str = "D65", observer: str = DEFAULT_OBSERVER
) -> Floats:
    """(..., 3) float64: XYZ of surfaces in a light; of one that reflects all, Y is 1.

    Parameters
    ----------
    reflectance : Spectrum, or (..., 471) float in [0, 1] at `WAVELENGTHS`
    light : Spectrum, (471,) float, or the name of an illuminant
    observer : str
    """
    power = sampled(illuminant(light) if isinstance(light, str) else light, "light")
    weights = matching_functions(observer) * power[:, None]
    return np.asarray(sampled(reflectance, "reflectance") @ weights / weights[:, 1].sum())


def metamer(
    reflectance: Spectrum | ArrayLike, light: Spectrum | str = "D65", observer: str = DEFAULT_OBSERVER, amount: float = 1.0
) -> Floats:
    """(471,) float64: another reflectance that looks the same in a light.

    A wave along the wavelengths, without that part of it which the eye sees (its projection on the three weights), is added: a metameric
    black. It is as large as [0, 1] allows, times `amount`.

    **Source**: Wyszecki and Stiles, *Color Science*, 1982, 3.8.2; Cohen and Kappauf, *Metameric color stimuli*, 1982 (the projection).
    """
    first = sampled(reflectance, "reflectance")
    power = sampled(illuminant(light) if isinstance(light, str) else light, "light")
    seen = matching_functions(observer) * power[:, None]
    # Three turns: what daylight and lamps differ by most
    wave = -np.sin(np.linspace(0.0, 6.0 * np.pi, len(first))) * np.sin(np.linspace(0.0, np.pi, len(first)))
    black = wave - seen @ np.linalg.lstsq(seen, wave, rcond=None)[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(black > 0.0, (1.0 - first) / black, -first / black)
    return np.asarray(first + amount * max(float(np.nanmin(room)), 0.0) * black)
