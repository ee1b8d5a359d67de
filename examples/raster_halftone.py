"""A picture on paper (FoCG 3.1.2): the teapot, 60 mm wide, for a printer of 600 dots per inch that has black ink and no grey.

    python examples/raster_halftone.py teapot-print.png
"""

from __future__ import annotations

import sys

import limner
from limner.image.hardcopy import MM_PER_INCH, grey_levels

DPI, LINES_PER_INCH, WIDTH_MM = 600, 75, 60.0


def main(target: str) -> None:
    """Render, fit to the paper, screen, save one bit for each dot."""
    image = limner.render("teapot", width=640, height=480)
    dots = round(WIDTH_MM / MM_PER_INCH * DPI)
    printed = image.resized(dots, dots * 3 // 4).halftoned(DPI, LINES_PER_INCH, angle_degrees=45.0)
    printed.save(target, bits=1)
    width, height = printed.print_size()
    greys = grey_levels(DPI, LINES_PER_INCH)
    print(f"{target}: {printed.width} x {printed.height} dots, {width:.1f} x {height:.1f} mm, {greys} greys")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "teapot-print.png")
