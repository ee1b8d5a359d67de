"""Curves in the plane (FoCG 15): de Casteljau's construction, curvature combs, equal lengths, implicit curves, offsets, fractals.

    python examples/curve_drawings.py curves.png
"""

from __future__ import annotations

import sys

import numpy as np

from limner.curves import bspline, catmull_rom, natural, offset
from limner.curves.fractals import lsystem, replacement
from limner.curves.implicit import traced
from limner.draw.canvas import Canvas
from limner.draw.stroke import Pen
from limner.produce import curve_pictures

POINTS = [(0.0, 0.0), (1.0, 3.0), (3.0, 3.5), (4.0, -1.0), (6.0, 0.0), (7.0, 2.0)]


def contours(width: int, height: int) -> Canvas:
    """Cassini's ovals: products of the distances from two points, joining where the product is 1."""

    def ovals(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return ((x - 1) ** 2 + y**2) * ((x + 1) ** 2 + y**2)

    lines = [
        line.points[np.arange(len(line.points) + line.closed) % len(line.points)]
        for level in (0.2, 0.5, 0.8, 0.99, 1.01, 1.3, 2.0, 3.0)
        for line in traced(lambda x, y, level=level: level - ovals(x, y), (-2.2, -1.6, 2.2, 1.6), 60, 0.002)
    ]
    return curve_pictures.line_drawing(lines, width, height)


def parallels(width: int, height: int) -> Canvas:
    """A closed B-spline and its offsets, which have cusps where they are farther inside than it is round."""
    curve = bspline.periodic(POINTS)
    frame = curve_pictures.framing([np.array([(-0.5, -2.0), (7.5, 4.5)])], width, height)
    canvas = Canvas(width, height, "white")
    for distance in (-0.9, -0.6, -0.3, 0.3, 0.6, 0.9):
        path = curve_pictures.path_of(frame.spline(offset.offset(curve, distance, 1e-3)))
        canvas.stroke(path, "#3a78c2" if distance > 0 else "#c4402f", 1.0)
    return canvas.stroke(curve_pictures.path_of(frame.spline(curve)), "#1b2430", Pen(2.5))


def main(target: str, small: bool = False) -> None:
    """Nine panels on one sheet."""
    width, height = (100, 75) if small else (400, 300)
    size = {"width": width, "height": height}
    panels = [
        curve_pictures.construction(POINTS, 0.4, **size),
        curve_pictures.comb(natural.natural(POINTS), **size),
        curve_pictures.comb(catmull_rom.catmull_rom(POINTS), **size),
        curve_pictures.evenly_marked(bspline.spline([*POINTS, (7.1, 2.1)]), 24, **size),
        contours(**size),
        parallels(**size),
        curve_pictures.line_drawing([replacement.dragon(11)], **size),
        curve_pictures.line_drawing([replacement.hilbert(5)], **size),
        curve_pictures.line_drawing(lsystem.NAMED["plant"].lines(5), line_width=0.8, **size),
    ]
    sheet = Canvas(3 * width, 3 * height, "white")
    for k, panel in enumerate(panels):
        sheet.paste(panel.image(), k % 3 * width, k // 3 * height)
    sheet.image().save(target)
    print(f"{target}: {len(panels)} panels")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "curve_drawings.png", "--small" in sys.argv)
