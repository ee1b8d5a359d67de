"""Charts over the wavelengths: what observers see, what lamps emit, what looks alike and is not (FoCG 19.1).

matching_chart("rgb").svg()                         with the lobe below zero, where red goes to the other side
illuminants_chart(("A", "D65", 3200.0))
metamers_chart()                                    two paints that are one by day and two by lamplight
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..color.gamut import fit_to_gamut
from ..color.illuminants import blackbody, illuminant
from ..color.light import rgb_from_emission, rgb_from_reflectance
from ..color.observer import DEFAULT_OBSERVER, cone_fundamentals, luminous_efficiency, matching_functions, rgb_matching_functions
from ..color.spectrum import WAVELENGTHS, Spectrum
from ..color.tristimulus import metamer
from ..draw.canvas import Canvas
from ..draw.path import Path
from ..draw.stroke import Pen
from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from .plot import FAINT, INK, PAPER, Plot

__all__ = ["FUNCTIONS", "illuminants_chart", "matching_chart", "metamers_chart", "spectra_chart"]

Floats = NDArray[np.float64]

FUNCTIONS = ("xyz", "rgb", "cones")

_RED, _GREEN, _BLUE = "#c4402f", "#2f8f5b", "#3a68c2"
_LINES = ("#c4402f", "#d08a1d", "#2f8f5b", "#3a68c2", "#8a4fbf", "#1b2430", "#00808c")
_NM = (380.0, 780.0)
_BAND_SHARE = 1.1  # of the text's size: the height of the strip of colours


def _strip(plot: Plot) -> None:
    """The colours of single wavelengths, below the axis."""
    canvas = plot.canvas
    first, last = round(plot.left), round(plot.right)
    tall = max(round(_BAND_SHARE * plot.text), 2)
    across = np.linspace(*_NM, last - first)
    lines = np.maximum(1.0 - np.abs(across[:, None] - WAVELENGTHS), 0.0)
    light = rgb_from_emission(lines)
    # White is added until nothing is negative: clipping makes stripes.
    light = (light - np.minimum(light.min(axis=1, keepdims=True), 0.0)) ** 0.75
    pixels = np.ones((tall, len(across), 4), dtype=np.float32)
    pixels[..., :3] = np.clip(light / light.max(), 0.0, 1.0)
    canvas.paste(Image(pixels), first, round(plot.bottom) + 1)


def _plot(width: int, height: int, y_range: tuple[float, float], y_name: str, title: str, foot: float = 0.0) -> Plot:
    canvas = Canvas(width, height, PAPER)
    plot = Plot(canvas, _NM, y_range, "wavelength, nm", y_name, title, foot=foot, strip=_BAND_SHARE)
    _strip(plot)
    return plot


def matching_chart(functions: str = "xyz", *, observer: str = DEFAULT_OBSERVER, width: int = 960, height: int = 600) -> Canvas:
    """Draw what an observer answers to each wavelength.

    Parameters
    ----------
    functions : "xyz" | "rgb" | "cones"
        CIE's x, y, z; the amounts of three lamps, with the negative lobe; or the cones, with what eyes see by day and by night.
    observer : str
        Of xyz.
    width, height : int >= 200
    """
    if functions not in FUNCTIONS:
        raise UnsupportedError(f"functions must be one of {', '.join(FUNCTIONS)}, got {functions!r}")
    if functions == "rgb":
        return _lamps_chart(width, height)
    if functions == "cones":
        return _cones_chart(width, height)
    kind = "CIE 1931, 2 degrees" if observer == DEFAULT_OBSERVER else "CIE 1964, 10 degrees"
    plot = _plot(width, height, (0.0, 2.2), "", f"Colour matching functions, {kind}")
    _draw(plot, matching_functions(observer), ("x", "y, how bright it looks", "z"))
    return plot.canvas


def _draw(plot: Plot, columns: Floats, names: Sequence[str], colors: Sequence[str] = (_RED, _GREEN, _BLUE)) -> None:
    pen = Pen(plot.text / 6.5, cap="round", join="round")
    for column, color in zip(columns.T, colors, strict=True):
        plot.line(WAVELENGTHS, column, color, pen)
    entries = [(name, color, pen) for name, color in zip(names, colors, strict=True)]
    plot.legend(entries, plot.right - 13.0 * plot.text, plot.top + 1.2 * plot.text)


def _lamps_chart(width: int, height: int) -> Canvas:
    functions = rgb_matching_functions()
    plot = _plot(width, height, (-0.7, 3.4), "", "How much of three lamps matches each wavelength (CIE RGB)")
    below = np.minimum(functions[:, 0], 0.0)
    lobe = Path().polygon(np.concatenate([plot.at(WAVELENGTHS, below), plot.at(WAVELENGTHS[::-1], 0.0 * below)]))
    with plot.canvas.clipped(plot.left, plot.top, plot.right - plot.left, plot.bottom - plot.top):
        plot.canvas.fill(lobe, "#c4402f40")
    plot.line(_NM, (0.0, 0.0), FAINT, plot.text / 14.0)
    _draw(plot, functions, ("red, 700 nm", "green, 546.1 nm", "blue, 435.8 nm"))
    plot.label(548.0, -0.32, "below zero, red is added to the light itself", _RED, size=0.9)
    return plot.canvas


def _cones_chart(width: int, height: int) -> Canvas:
    plot = _plot(width, height, (0.0, 1.2), "", "Cones, and how bright light looks")
    dashes = Pen(plot.text / 9.0, dashes=(plot.text * 0.5, plot.text * 0.35))
    plot.line(WAVELENGTHS, luminous_efficiency("photopic"), INK, dashes)
    plot.line(WAVELENGTHS, luminous_efficiency("scotopic"), FAINT, dashes)
    _draw(plot, cone_fundamentals(), ("long", "middle", "short"))
    more = [("by day, V", INK, dashes), ("by night, V'", FAINT, dashes)]
    plot.legend(more, plot.right - 13.0 * plot.text, plot.top + 5.7 * plot.text)
    return plot.canvas


def spectra_chart(
    spectra: dict[str, Spectrum], *, title: str = "", y_name: str = "", greatest: float | None = None, width: int = 960, height: int = 600
) -> Canvas:
    """Draw spectra by their names.

    Parameters
    ----------
    spectra : dict of str to Spectrum
        1 to 7.
    title, y_name : str
    greatest : float > 0, optional
        The top of the axis; None: what fits.
    width, height : int >= 200
    """
    if not 1 <= len(spectra) <= len(_LINES):
        raise SceneError(f"a chart takes 1 to {len(_LINES)} spectra, got {len(spectra)}")
    steps = np.arange(*_NM, 1.0)
    curves = {name: spectrum.at(steps) for name, spectrum in spectra.items()}
    top = 1.1 * max(float(curve.max()) for curve in curves.values()) if greatest is None else float(greatest)
    if not top > 0.0:
        raise SceneError("spectra must have a value above 0 between 380 and 780 nm")
    plot = _plot(width, height, (0.0, top), y_name, title)
    pen = Pen(plot.text / 6.5, cap="round", join="round")
    for color, curve in zip(_LINES, curves.values(), strict=False):
        plot.line(steps, curve, color, pen)
    entries = [(name, color, pen) for color, name in zip(_LINES, curves, strict=False)]
    plot.legend(entries, plot.left + 1.5 * plot.text, plot.top + 1.2 * plot.text)
    return plot.canvas


def illuminants_chart(lights: Sequence[str | float] = ("A", "C", "D50", "D65", "E"), *, width: int = 960, height: int = 600) -> Canvas:
    """Draw illuminants by name and black bodies by temperature (kelvin), each 100 at 560 nm."""
    spectra = {}
    for light in lights:
        found = illuminant(light) if isinstance(light, str) else blackbody(light)
        scale = 100.0 / float(found.at(560.0))
        spectra[light if isinstance(light, str) else f"{light:g} K"] = Spectrum(found.wavelengths, scale * found.values)
    return spectra_chart(spectra, title="Illuminants", y_name="power, 100 at 560 nm", greatest=260.0, width=width, height=height)


def metamers_chart(*, width: int = 960, height: int = 720) -> Canvas:
    """Draw two reflectances that are one colour in daylight, and what an eye sees of them that is used to a lamp."""
    paint = 0.22 + 0.4 / (1.0 + np.exp((575.0 - WAVELENGTHS) / 16.0))
    other = metamer(paint, "D65")
    foot = 0.26 * height
    plot = _plot(width, height, (0.0, 1.0), "reflectance", "Metamers: two paints, one colour by day", foot)
    pens = Pen(plot.text / 6.5, join="round"), Pen(plot.text / 6.5, join="round", dashes=(plot.text * 0.6, plot.text * 0.35))
    for curve, color, pen in zip((paint, other), ("#8a4a1c", "#3a68c2"), pens, strict=True):
        plot.line(WAVELENGTHS, curve, color, pen)
    plot.legend([("first", "#8a4a1c", pens[0]), ("second", "#3a68c2", pens[1])], plot.left + 1.5 * plot.text, plot.top + 1.2 * plot.text)
    # On whole pixels, so that no seam parts what looks alike
    top, half_side = round(plot.bottom + 5.2 * plot.text) - 0.5, round(0.25 * (plot.right - plot.left) - 0.5 * plot.text)
    for column, (light, words) in enumerate((("D65", "in daylight (D65)"), ("A", "by a lamp (A)"))):
        left = round(plot.left + column * (2.0 * half_side + 2.0 * plot.text)) - 0.5
        for half, reflectance in enumerate((paint, other)):
            shown = fit_to_gamut(rgb_from_reflectance(reflectance, light))
            tall = height - top - 2.4 * plot.text
            plot.canvas.rectangle(left + half * half_side, top, half_side, tall, fill=tuple(shown.tolist()))
        plot.canvas.text(left + half_side, height - 1.9 * plot.text, words, FAINT, size=0.9 * plot.text, align="center", baseline="top")
    return plot.canvas
