"""Colours as Mitsuba scenes say them: RGB, hexadecimal sRGB, spectra and black bodies; all become linear Rec. 709.

A spectrum of a surface is what an eye sees of it under daylight (D65), of a light what it sees of the light itself. The observer is
computed by formula; it lies within about one per cent of the CIE's tables, which is less than three numbers can say of a spectrum anyway.

**Source**: observer: Wyman, Sloan and Shirley, *Simple Analytic Approximations to the CIE XYZ Color Matching Functions*, JCGT 2(2), 2013
(the fits with several lobes). Black body: Planck's law. Daylight: a black body of 6504 K stands for D65.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import linear_from_srgb
from .mitsuba_xml import Element
from .notes import quoted

__all__ = ["EMITTED", "black_body", "color_of", "curve_of", "rgb_from_emission", "rgb_from_reflectance", "sampled_curve"]

EMITTED = ("radiance", "intensity", "irradiance")
"""Properties whose spectra are light, not reflectance."""

Floats = NDArray[np.float64]
Triple = tuple[float, float, float]
Read = Callable[[str], bytes]

WAVELENGTHS: Floats = np.arange(380.0, 781.0, 5.0)
_DAYLIGHT_KELVIN = 6504.0
_Y_INTEGRAL = 106.8567  # of the observer's y over the wavelengths, nm: by this Mitsuba divides radiance per nanometre
_EQUAL_ENERGY = (1.204794, 0.948292, 0.908916)  # of X = Y = Z = 1 in linear Rec. 709
_HEX = re.compile(r"#([0-9a-fA-F]{6})")
_RGB_FROM_XYZ = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]])


def _lobe(mean: float, below: float, above: float) -> Floats:
    t = WAVELENGTHS - mean
    return np.asarray(np.exp(-0.5 * (t * np.where(t < 0.0, below, above)) ** 2))


_OBSERVER = np.stack(
    [
        1.056 * _lobe(599.8, 0.0264, 0.0323) + 0.362 * _lobe(442.0, 0.0624, 0.0374) - 0.065 * _lobe(501.1, 0.0490, 0.0382),
        0.821 * _lobe(568.8, 0.0213, 0.0247) + 0.286 * _lobe(530.9, 0.0613, 0.0322),
        1.217 * _lobe(437.0, 0.0845, 0.0278) + 0.681 * _lobe(459.0, 0.0385, 0.0725),
    ],
    axis=1,
)  # fmt: skip


def black_body(kelvin: float) -> Floats:
    """Spectral radiance at `WAVELENGTHS`, W / (m2 sr nm). **Source**: Planck's law."""
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23
    metres = WAVELENGTHS * 1e-9
    with np.errstate(over="ignore"):
        return np.asarray(2.0 * h * c * c / (metres**5 * np.expm1(h * c / (metres * k * kelvin))) * 1e-9)


def rgb_from_emission(curve: Floats) -> Triple:
    """What an eye sees of spectral radiance at `WAVELENGTHS`; a curve that is 1 everywhere has the luminance 1."""
    return _not_negative(_RGB_FROM_XYZ @ (5.0 * _OBSERVER.T @ curve) / _Y_INTEGRAL)


def rgb_from_reflectance(curve: Floats) -> Triple:
    """What an eye sees of a surface of that reflectance in daylight; of one that reflects all, white."""
    weights = _OBSERVER * black_body(_DAYLIGHT_KELVIN)[:, None]
    return _not_negative((_RGB_FROM_XYZ @ (weights.T @ curve)) / (_RGB_FROM_XYZ @ weights.sum(axis=0)))


def color_of(element: Element, read: Read) -> Triple:
    """The colour that an element says; `read` gives the bytes of a file beside the scene.

    Raises ValueError, which says what was expected.

    >>> color_of(Element("rgb", {"value": "0.5"}, "line 1"), lambda name: b"")
    (0.5, 0.5, 0.5)
    """
    if element.tag == "blackbody" or element.kind == "blackbody":
        said = {child.name: child.attributes.get("value", "") for child in element.children} | element.attributes
        kelvin, scale = _number(said.get("temperature", "5000")), _number(said.get("scale", "1"))
        if not 0.0 < kelvin <= 1e6:
            raise ValueError(f"temperature must lie in (0, 1e6] kelvin, got {kelvin:g}")
        red, green, blue = rgb_from_emission(black_body(kelvin))
        return red * scale, green * scale, blue * scale
    if element.kind in ("d65", "uniform"):
        said = {child.name: child.attributes.get("value", "") for child in element.children}
        grey = _number(said.get("scale", said.get("value", "1")))
        return _even(grey) if element.kind == "uniform" and element.name in EMITTED else _checked((grey, grey, grey))
    text = element.attributes.get("value", "").strip()
    if _HEX.fullmatch(text):
        encoded = np.array([int(text[at : at + 2], 16) / 255.0 for at in (1, 3, 5)])
        red, green, blue = linear_from_srgb(encoded).tolist()
        return red, green, blue
    if element.tag == "spectrum" and (":" in text or "filename" in element.attributes):
        curve = curve_of(element, read)
        return rgb_from_emission(curve) if element.name in EMITTED else rgb_from_reflectance(curve)
    if element.tag == "spectrum" and element.name in EMITTED and "," not in text and " " not in text:
        return _even(_number(text))
    numbers = [_number(part) for part in text.replace(",", " ").split()]
    if len(numbers) not in (1, 3):
        raise ValueError(f"must be one number or three, or #rrggbb, got {quoted(text)}")
    red, green, blue = numbers * 3 if len(numbers) == 1 else numbers
    return _checked((red, green, blue))


def _even(level: float) -> Triple:
    """Light of the same radiance at all wavelengths, which is a little redder than daylight."""
    return _checked((_EQUAL_ENERGY[0] * level, _EQUAL_ENERGY[1] * level, _EQUAL_ENERGY[2] * level))


def curve_of(element: Element, read: Read) -> Floats:
    """A spectrum at `WAVELENGTHS`: "400: 0.1, 500: 0.2", or the file of such lines that it names; or one number."""
    text = element.attributes.get("value", "")
    name = element.attributes.get("filename")
    if name is not None:
        return sampled_curve(read(name).decode("latin-1"))
    if ":" not in text:
        return np.full(len(WAVELENGTHS), _number(text))
    return sampled_curve("\n".join(part.replace(":", " ") for part in re.split(r"[,\s]+(?=[\d.]+\s*:)", text.strip())))


def sampled_curve(text: str) -> Floats:
    """Pairs of wavelength (nm) and value, one a line, at `WAVELENGTHS`; what is outside keeps the last value."""
    pairs = []
    for line in text.splitlines():
        parts = line.split("#")[0].replace(",", " ").split()
        if parts:
            pairs.append([_number(part) for part in parts])
    if not pairs or any(len(pair) != 2 for pair in pairs):
        raise ValueError("a spectrum must be pairs of wavelength and value")
    table = np.array(sorted(pairs))
    return np.interp(WAVELENGTHS, table[:, 0], table[:, 1])


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise ValueError(f"must be a number, got {quoted(text)}") from None
    if not math.isfinite(number):
        raise ValueError(f"must be finite, got {number}")
    return number


def _checked(color: Triple) -> Triple:
    if min(color) < 0.0:
        raise ValueError(f"must not be negative, got {', '.join(f'{c:g}' for c in color)}")
    return color


def _not_negative(rgb: Floats) -> Triple:
    red, green, blue = np.maximum(rgb, 0.0).tolist()
    return red, green, blue
