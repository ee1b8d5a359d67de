"""Spectra at the door: what the renderers, which know red, green and blue alone, are given instead.

    limner.PointLight(color=light_color(3200), intensity=50)             a lamp of 3200 K, 50 candela
    limner.Lambert(rgb_from_reflectance(paint))                          a paint that was measured

Linear Rec. 709 under D65, as all colours in a scene. A light's colour has luminance 1, so that its intensity keeps its meaning.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .adaptation import adaptation_matrix
from .illuminants import blackbody, checked_kelvin, daylight
from .observer import DEFAULT_OBSERVER
from .spaces import SPACES
from .spectrum import Spectrum
from .tristimulus import white_xyz, xyz_from_emission, xyz_from_reflectance

__all__ = ["light_color", "rgb_from_emission", "rgb_from_reflectance"]

Floats = NDArray[np.float64]
Triple = tuple[float, float, float]

_LOWEST = 500.0  # a black body that is colder does not glow


def rgb_from_emission(spectrum: Spectrum | ArrayLike, observer: str = DEFAULT_OBSERVER) -> Floats:
    """(..., 3) float64: linear Rec. 709 of light; where it is 1 at all wavelengths its luminance is 1. It may be negative: see
    `fit_to_gamut`.

    >>> rgb_from_emission(Spectrum([500], [1.0])).round(3).tolist()
    [1.205, 0.948, 0.909]
    """
    return np.asarray(xyz_from_emission(spectrum, observer) @ SPACES["srgb"].rgb_from_xyz.T)


def rgb_from_reflectance(
    reflectance: Spectrum | ArrayLike, light: Spectrum | ArrayLike | str = "D65", observer: str = DEFAULT_OBSERVER
) -> Floats:
    """(..., 3) float64: linear Rec. 709 of surfaces in a light, as an eye sees them that is used to it: what reflects all is (1, 1, 1).

    >>> rgb_from_reflectance(Spectrum([550], [0.5]), "A").round(6).tolist()
    [0.5, 0.5, 0.5]
    """
    srgb = SPACES["srgb"]
    adapted = adaptation_matrix(srgb.white_xyz, white_xyz(light, observer))
    return np.asarray(xyz_from_reflectance(reflectance, light, observer) @ (srgb.rgb_from_xyz @ adapted).T)


def light_color(kelvin: float | None = None, *, spectrum: Spectrum | None = None, is_daylight: bool = False) -> Triple:
    """The colour of a light, by its temperature or by its spectrum.

    Parameters
    ----------
    kelvin : float >= 500, optional
        Temperature of a black body: candle 1900, tungsten lamp 2700 to 3200, sun at noon 5500, blue sky 10000 and more.
    spectrum : Spectrum, optional
        Instead of `kelvin`; its scale does not matter.
    is_daylight : bool
        That temperature of the sky instead (4000 to 25000 K): a little greener, and 6504 is white.

    Returns
    -------
    three floats >= 0
        Linear Rec. 709 with the luminance 1; red may be above 1. Below some 1900 K a black body is redder than Rec. 709 can say; its blue
        is 0.

    >>> [round(part, 3) for part in light_color(3200)]
    [1.68, 0.866, 0.326]
    """
    if (kelvin is None) == (spectrum is None):
        raise SceneError("a light's colour is said by kelvin or by spectrum: give one of them")
    if spectrum is None:
        assert kelvin is not None
        if checked_kelvin(kelvin) < _LOWEST:
            raise SceneError(f"kelvin must be at least {_LOWEST:g}: what is colder does not glow; got {kelvin!r}")
        spectrum = daylight(kelvin) if is_daylight else blackbody(kelvin)
    elif not isinstance(spectrum, Spectrum):
        raise SceneError(f"spectrum must be a Spectrum, got {type(spectrum).__name__}")
    shown = np.maximum(rgb_from_emission(spectrum), 0.0)
    luminance = float(shown @ SPACES["srgb"].xyz_from_rgb[1])
    if not luminance > 0.0:
        raise SceneError("this light cannot be seen: it has no power between 360 and 830 nm")
    red, green, blue = (shown / luminance).tolist()
    return red, green, blue
