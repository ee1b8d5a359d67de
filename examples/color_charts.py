"""Colour, drawn (FoCG 3.2.2, 19): gamuts, observers, metamers, metals, the colour checker, and steps of few bits.

python examples/color_charts.py charts.png
"""

from __future__ import annotations

import sys

from limner.draw.canvas import Canvas
from limner.produce.charts import chart

KINDS = ("chromaticity", "rgb-matching", "cones", "metamers", "checker", "banding")
WIDTH, HEIGHT = 640, 520


def main(target: str, small: bool = False) -> None:
    """Six panels on one sheet."""
    width, height = (WIDTH // 2, HEIGHT // 2) if small else (WIDTH, HEIGHT)
    sheet = Canvas(3 * width, 2 * height, "white")
    for k, kind in enumerate(KINDS):
        sheet.paste(chart(kind, width=width, height=height).image(), k % 3 * width, k // 3 * height)
    sheet.image().save(target)
    print(f"{target}: {', '.join(KINDS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "color_charts.png", "--small" in sys.argv)
