"""Light by wavelength, before an eye makes three numbers of it (FoCG 19.1).

    lamp = Spectrum([400, 500, 600, 700], [0.1, 0.5, 0.9, 1.0])
    lamp.at(550.0)                        0.7

A spectrum is known at some wavelengths, straight in between, and beyond them as at its ends. To be summed up it is asked at `WAVELENGTHS`,
every nanometre that the standard observers see.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["WAVELENGTHS", "Spectrum", "sampled"]

Floats = NDArray[np.float64]

WAVELENGTHS: Floats = np.arange(360.0, 831.0)
"""(471,) float64: nm, what the tables of the standard observers cover. **Source**: CIE 018:2019."""
WAVELENGTHS.flags.writeable = False


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Values over wavelengths: power of a light, or the share that a surface reflects.

    Parameters
    ----------
    wavelengths : (n,) float
        nm, ascending.
    values : (n,) float
        In units of one's own; reflectances lie in [0, 1].

    >>> Spectrum([400, 700], [0.0, 3.0]).at([300.0, 500.0, 800.0]).tolist()
    [0.0, 1.0, 3.0]
    """

    wavelengths: Floats
    values: Floats

    def __post_init__(self) -> None:
        try:
            wavelengths, values = np.array(self.wavelengths, dtype=np.float64), np.array(self.values, dtype=np.float64)
        except (TypeError, ValueError):
            raise SceneError("a spectrum must be wavelengths (nm) and values, both numbers") from None
        if wavelengths.ndim != 1 or wavelengths.shape != values.shape or not len(wavelengths):
            raise SceneError(f"a spectrum must have a value for each wavelength, got shapes {wavelengths.shape} and {values.shape}")
        if not (np.isfinite(wavelengths).all() and np.isfinite(values).all()):
            raise SceneError("a spectrum must be finite")
        if (np.diff(wavelengths) <= 0.0).any() or wavelengths[0] <= 0.0:
            raise SceneError("the wavelengths of a spectrum must be positive and ascend")
        wavelengths.flags.writeable = values.flags.writeable = False
        object.__setattr__(self, "wavelengths", wavelengths)
        object.__setattr__(self, "values", values)

    def at(self, wavelengths: ArrayLike) -> Floats:
        """Values at wavelengths (nm): linear between the known ones, the nearest beyond them (CIE 015:2018, 7.2.3)."""
        return np.interp(np.asarray(wavelengths, dtype=np.float64), self.wavelengths, self.values)


def sampled(spectrum: Spectrum | ArrayLike, name: str = "spectrum") -> Floats:
    """Return a spectrum, or arrays (..., 471) that already are such, at `WAVELENGTHS`."""
    if isinstance(spectrum, Spectrum):
        return spectrum.at(WAVELENGTHS)
    try:
        values = np.asarray(spectrum, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.ndim == 0 or values.shape[-1] != len(WAVELENGTHS):
        raise SceneError(f"{name} must be a Spectrum, or values at each nm from 360 to 830 (471 along the last axis), got {values.shape}")
    return values
