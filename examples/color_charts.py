"""Colour, drawn (FoCG 3.2.2, 19): gamuts, observers, metamers, metals, the colour checker, and steps of few bits.

python examples/color_charts.py charts.png
"""

from __future__ import annotations

import sys

from limner.draw.canvas import Canvas
from limner.produce.charts import chart

KINDS = ("chromaticity", "rgb-matching", "cones", "metamers", "checker", "banding")
WIDTH, HEIGHT = 640, 520


def main(target: str) -> None:
    """Six panels on one sheet."""
    sheet = Canvas(3 * WIDTH, 2 * HEIGHT, "white")
    for k, kind in enumerate(KINDS):
        sheet.paste(chart(kind, width=WIDTH, height=HEIGHT).image(), k % 3 * WIDTH, k // 3 * HEIGHT)
    sheet.image().save(target)
    print(f"{target}: {', '.join(KINDS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "color_charts.png")
