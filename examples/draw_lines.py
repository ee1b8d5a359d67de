"""The midpoint algorithm (FoCG 8.1.1), large: a line's pixels, its midpoints, and the areas that the antialiased line covers.

    python examples/draw_lines.py lines.png
"""

from __future__ import annotations

import sys

import numpy as np

from limner.draw.canvas import Canvas
from limner.draw.coverage import coverage
from limner.draw.midpoint import line_pixels
from limner.draw.stroke import Pen, segment_polygons

COLUMNS, ROWS = 16, 8
START, END = (1, 1), (14, 6)


def main(target: str, small: bool = False) -> None:
    """Draw the grid twice: whole pixels above, coverage below."""
    size = 9 if small else 36
    canvas = Canvas(COLUMNS * size + 40, 2 * ROWS * size + 110, background="white")
    line = np.array([[*START, *END]], dtype=float)
    part = coverage(list(segment_polygons(line, Pen(1.0))), COLUMNS, ROWS)
    whole = np.zeros_like(part)
    for x, y in line_pixels(*START, *END).tolist():
        whole[y, x] = 1.0
    for top, shares, words in ((40, whole, "midpoint algorithm"), (80 + ROWS * size, part, "exact area")):
        canvas.text(20, top - 10, words, "#222222", 16)
        for (j, i), share in np.ndenumerate(shares):
            if share > 0.0:
                canvas.rectangle(20 + i * size, top + j * size, size, size, fill=(0.05, 0.15, 0.5, float(share)))
        across = [(20 + i * size, top, 20 + i * size, top + ROWS * size) for i in range(COLUMNS + 1)]
        down = [(20, top + j * size, 20 + COLUMNS * size, top + j * size) for j in range(ROWS + 1)]
        canvas.segments(across + down, "#bbbbbb", Pen(1, "square"))
        centre = np.array([20 + size / 2, top + size / 2])
        canvas.line(*(centre + size * line[0, :2]), *(centre + size * line[0, 2:]), "#cc3333", 2.5)
    row = dict(line_pixels(*START, *END).tolist())
    for x in range(START[0] + 1, END[0] + 1):  # the midpoint that decided column x
        canvas.circle(20 + (x + 0.5) * size, 40 + (row[x - 1] + 1.0) * size, 4, fill="#ffaa00", stroke="#222222")
    canvas.image().save(target)
    print(f"{target}: {len(row)} pixels; coverage adds up to {part.sum():.4f}, the line is {np.hypot(13, 5):.4f} long")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "lines.png", "--small" in sys.argv)
