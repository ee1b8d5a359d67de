"""The chromaticity diagram: all that can be seen, what spaces show of it, and how warm light is (FoCG 19.1.5).

    chromaticity_chart(("srgb", "display_p3")).image().save("gamuts.png")

The rim is single wavelengths, the straight edge below the purples. No screen can show the colours outside its own triangle, so the diagram
is painted with colours of the same hue that sRGB has.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.chromaticity import spectral_locus, uv_from_xy, xy_from_uv, xyz_from_xy
from ..color.gamut import ring_area
from ..color.observer import DEFAULT_OBSERVER
from ..color.spaces import SPACES, Space, space
from ..color.temperature import xy_from_kelvin
from ..color.triples import triples
from ..draw.canvas import Canvas
from ..draw.path import Path
from ..draw.stroke import Pen
from ..errors import UnsupportedError
from ..image.image import Image
from .plot import FAINT, INK, PAPER, Plot

__all__ = ["PLANES", "chromaticity_chart"]

Floats = NDArray[np.float64]

PLANES = ("xy", "uv")

_LINES = ("#1b2430", "#b02a37", "#0b6e4f", "#5b3fa0", "#a85d00", "#00678a")
_NM = (380, 460, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 620, 700)
_KELVIN = (2000, 3000, 4000, 6500, 10000, 25000)
_WHITES = {"D65": (0.31272, 0.32903), "A": (0.44758, 0.40745)}


def chromaticity_chart(
    gamuts: Sequence[str | Space] = ("srgb", "display_p3", "rec2020"),
    *,
    plane: str = "xy",
    points: ArrayLike = (),
    temperatures: bool = True,
    observer: str = DEFAULT_OBSERVER,
    width: int = 900,
    height: int = 960,
) -> Canvas:
    """Draw the diagram.

    Parameters
    ----------
    gamuts : sequence of str or Space
        Spaces whose triangles are drawn; the legend says how much of what is seen they cover.
    plane : "xy" | "uv"
        CIE 1931 x, y, or 1976 u', v', in which distances mean more.
    points : (n, 2) float
        x, y of colours to mark.
    temperatures : bool
        Whether the black body's locus is drawn.
    observer : str
    width, height : int >= 200

    Returns
    -------
    Canvas
        ``.image()`` is the picture, ``.svg()`` the same as vectors over a painted ground.
    """
    if plane not in PLANES:
        raise UnsupportedError(f"plane must be one of {', '.join(PLANES)}, got {plane!r}")
    spaces = [space(gamut) for gamut in gamuts]
    marks = triples(np.reshape(np.asarray(points, dtype=np.float64), (-1, 2)), "points", last=2)
    canvas = Canvas(width, height, PAPER)
    is_xy = plane == "xy"
    names = ("x", "y") if is_xy else ("u'", "v'")
    title = "CIE 1931 chromaticity" if is_xy else "CIE 1976 chromaticity"
    plot = Plot(canvas, (-0.06, 0.78) if is_xy else (-0.06, 0.68), (-0.04, 0.89) if is_xy else (-0.03, 0.63), *names, title, is_square=True)
    locus = _in_plane(spectral_locus(observer), plane)
    _paint(plot, locus, plane)
    _draw_rim(plot, locus)
    for line, drawn in zip(_lines(len(spaces)), spaces, strict=True):
        plot.outline(_in_plane(drawn.primaries, plane), line, Pen(plot.text / 7.0, join="round"))
    if temperatures:
        _draw_temperatures(plot, plane, observer)
    for name, white in _WHITES.items():
        x, y = plot.place(_in_plane(np.array(white), plane))
        canvas.circle(x, y, plot.text * 0.25, fill="#ffffff", stroke=INK, pen=plot.text / 12.0)
        canvas.text(x - 0.4 * plot.text, y - 0.7 * plot.text, name, INK, size=0.85 * plot.text, align="right", baseline="middle")
    for mark in _in_plane(marks, plane):
        x, y = plot.place(mark)
        canvas.circle(x, y, plot.text * 0.32, stroke=INK, pen=plot.text / 7.0)
    whole = abs(ring_area(locus))
    pen = Pen(plot.text / 6.0)
    entries = [
        (f"{drawn.title}  {100.0 * abs(ring_area(_in_plane(drawn.primaries, plane))) / whole:.0f} %", line, pen)
        for line, drawn in zip(_lines(len(spaces)), spaces, strict=True)
    ]
    corner = plot.at(0.5 if is_xy else 0.46, 0.84 if is_xy else 0.16)
    plot.legend(entries, float(corner[0]), float(corner[1]))
    return canvas


def _lines(count: int) -> list[str]:
    return [_LINES[k % len(_LINES)] for k in range(count)]


def _in_plane(xy: Floats, plane: str) -> Floats:
    return np.asarray(uv_from_xy(xy)) if plane == "uv" else xy


def _paint(plot: Plot, locus: Floats, plane: str) -> None:
    """Fill what can be seen with its hues, as bright as sRGB has them."""
    canvas = plot.canvas
    rows, columns = np.mgrid[0 : canvas.height, 0 : canvas.width].astype(np.float64)
    low, high = plot.at(0.0, 0.0), plot.at(1.0, 1.0)
    where = np.stack([(columns - low[0]) / (high[0] - low[0]), (rows - low[1]) / (high[1] - low[1])], axis=-1)
    mask = Canvas(canvas.width, canvas.height).fill(Path().polygon(plot.at(locus[:, 0], locus[:, 1])), "#ffffff").image().pixels[..., 3]
    seen = mask > 0.0
    xy = where[seen] if plane == "xy" else np.asarray(xy_from_uv(where[seen]))
    light = np.asarray(xyz_from_xy(np.maximum(xy, 1e-4))) @ SPACES["srgb"].rgb_from_xyz.T
    # White is added until nothing is negative: clipping would leave edges along the triangle of sRGB.
    light -= np.minimum(light.min(axis=1, keepdims=True), 0.0)
    light /= light.max(axis=1, keepdims=True)
    pixels = np.zeros((canvas.height, canvas.width, 4), dtype=np.float32)
    pixels[seen, :3] = 0.04 + 0.96 * light
    pixels[..., 3] = mask
    canvas.paste(Image(pixels), 0, 0)


def _draw_rim(plot: Plot, locus: Floats) -> None:
    plot.outline(locus, INK, plot.text / 10.0)
    ring = plot.at(locus[:, 0], locus[:, 1])
    middle = ring.mean(axis=0)
    for nm in _NM:
        place = ring[nm - 380]
        way = ring[min(nm - 380 + 3, 320)] - ring[max(nm - 380 - 3, 0)]
        out = np.array([way[1], -way[0]]) / max(float(np.hypot(*way)), 1e-9)
        out = -out if out @ (place - middle) < 0.0 else out
        end = place + 0.45 * plot.text * out
        plot.canvas.segments([[*place, *end]], INK, plot.text / 14.0)
        if nm in (470, 530, 550, 570, 590):  # too near to their neighbours for words
            continue
        at = place + 0.7 * plot.text * out
        align = "left" if out[0] > 0.35 else "right" if out[0] < -0.35 else "center"
        size = 0.8 * plot.text
        lift = {True: "bottom", False: "top"}[bool(out[1] < 0.0)] if align == "center" else "middle"
        plot.canvas.text(float(at[0]), float(at[1]), str(nm), FAINT, size=size, align=align, baseline=lift)


def _draw_temperatures(plot: Plot, plane: str, observer: str) -> None:
    """The locus of black bodies with some temperatures, each with a short line across."""
    text = plot.text
    curve = plot.at(*_in_plane(xy_from_kelvin(np.geomspace(1000.0, 1e5, 120), observer), plane).T)
    plot.canvas.polyline(curve, INK, Pen(text / 11.0, join="round"))
    for kelvin in _KELVIN:
        near = plot.at(*_in_plane(xy_from_kelvin([0.99 * kelvin, kelvin, 1.01 * kelvin], observer), plane).T)
        way = near[2] - near[0]
        across = np.array([way[1], -way[0]]) / float(np.hypot(*way))
        across = -across if across[1] < 0.0 else across
        first, last = near[1] - 0.3 * text * across, near[1] + 0.3 * text * across
        plot.canvas.segments([[*first, *last]], INK, text / 14.0)
        at = near[1] + 0.55 * text * across
        align = "right" if across[0] < -0.5 else "left" if across[0] > 0.5 else "center"
        words = f"{kelvin} K" if kelvin == _KELVIN[0] else str(kelvin)
        plot.canvas.text(float(at[0]), float(at[1]), words, INK, size=0.72 * text, align=align, baseline="top")
