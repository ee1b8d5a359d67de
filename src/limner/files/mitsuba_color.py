"""Colours as Mitsuba scenes say them: RGB, hexadecimal sRGB, spectra and black bodies; all become linear Rec. 709.

A spectrum of a surface is what an eye sees of it under daylight (D65), of a light what it sees of the light itself; both as
`limner.color.light` has it, with the CIE's own observer.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..color import light
from ..color.illuminants import planck
from ..color.spectrum import WAVELENGTHS
from ..color.transfer import linear_from_srgb
from .mitsuba_xml import Element
from .notes import quoted

__all__ = ["EMITTED", "black_body", "color_of", "curve_of", "rgb_from_emission", "rgb_from_reflectance", "sampled_curve"]

EMITTED = ("radiance", "intensity", "irradiance")
"""Properties whose spectra are light, not reflectance."""

Floats = NDArray[np.float64]
Triple = tuple[float, float, float]
Read = Callable[[str], bytes]

_HEX = re.compile(r"#([0-9a-fA-F]{6})")


def black_body(kelvin: float) -> Floats:
    """Spectral radiance at `WAVELENGTHS`, W / (m2 sr nm)."""
    return planck(WAVELENGTHS, kelvin)


def rgb_from_emission(curve: Floats) -> Triple:
    """What an eye sees of spectral radiance at `WAVELENGTHS`; a curve that is 1 everywhere has the luminance 1."""
    return _not_negative(light.rgb_from_emission(curve))


def rgb_from_reflectance(curve: Floats) -> Triple:
    """What an eye sees of a surface of that reflectance in daylight; of one that reflects all, white."""
    return _not_negative(light.rgb_from_reflectance(curve))


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
    red, green, blue = rgb_from_emission(np.full(len(WAVELENGTHS), level))
    return _checked((red, green, blue))


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
