"""A picture on paper (FoCG 3.1.2): the teapot, 60 mm wide, for a printer of 600 dots per inch that has black ink and no grey.

    python examples/raster_halftone.py teapot-print.png
"""

from __future__ import annotations

import sys

import limner
from limner.image.hardcopy import MM_PER_INCH, grey_levels

DPI, LINES_PER_INCH = 600, 75


def main(target: str, small: bool = False) -> None:
    """Render, fit to the paper, screen, save one bit for each dot."""
    width_mm = 8.0 if small else 60.0
    image = limner.render("teapot", width=80 if small else 640, height=60 if small else 480)
    dots = round(width_mm / MM_PER_INCH * DPI)
    printed = image.resized(dots, dots * 3 // 4).halftoned(DPI, LINES_PER_INCH, angle_degrees=45.0)
    printed.save(target, bits=1)
    width, height = printed.print_size()
    greys = grey_levels(DPI, LINES_PER_INCH)
    print(f"{target}: {printed.width} x {printed.height} dots, {width:.1f} x {height:.1f} mm, {greys} greys")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "teapot-print.png", "--small" in sys.argv)
