"""Drawing in two dimensions (FoCG 8.2.1): stars with and without a heart, pens, dashes, gradients, words; as pixels and as SVG.

    python examples/draw_shapes.py shapes.png        writes shapes.png and shapes.svg
"""

from __future__ import annotations

import math
import sys
from pathlib import Path as File

import numpy as np

from limner.draw.canvas import Canvas
from limner.draw.path import Path
from limner.draw.stroke import Pen

INK, RED, BLUE, GREEN = "#222222", "#cc3333", "#3366cc", "#339966"


def star(x: float, y: float, radius: float) -> np.ndarray:
    """A pentagram in one stroke: it winds twice around its heart."""
    turn = 4.0 * math.pi / 5.0 * np.arange(5) - math.pi / 2.0
    return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)


def main(target: str, small: bool = False) -> None:
    """Draw once, save twice."""
    canvas = Canvas(640, 400, background="white")
    canvas.polygon(star(90, 85, 70), fill=RED, rule="nonzero")
    canvas.polygon(star(240, 85, 70), fill=BLUE, rule="evenodd", stroke=INK, pen=1.5)
    canvas.text(90, 170, "nonzero", INK, 14, "center")
    canvas.text(240, 170, "evenodd", INK, 14, "center")
    for k, join in enumerate(("miter", "round", "bevel")):
        corner = np.array([(350, 140), (390, 40), (420, 140)]) + np.array([k * 95, 0])
        canvas.polyline(corner, (0.05, 0.2, 0.1, 0.5), Pen(18, ("butt", "round", "square")[k], join, 8))
        canvas.polyline(corner, "white")
        canvas.text(385 + k * 95, 170, join, INK, 14, "center")
    canvas.circle(80, 280, 50, stroke=GREEN, pen=Pen(8, "round", dashes=(14, 14)))
    heart = Path().move_to(240, 340).cubic_to(140, 270, 190, 200, 240, 250).cubic_to(290, 200, 340, 270, 240, 340).close()
    canvas.draw(heart, fill=(0.8, 0.05, 0.1, 0.4), stroke=RED, pen=2)
    canvas.triangles(
        [[(370, 220), (520, 250), (400, 350)], [(520, 250), (500, 360), (400, 350)]],
        [[(1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 0), (1, 1, 0), (0, 0, 1)]],
    )
    canvas.pixel_lines([(550, 230 + 12 * k, 620, 230 + 20 * k) for k in range(7)], INK)
    canvas.text(320, 385, "one canvas: pixels and vectors", INK, 18, "center")
    canvas.image().save(target)
    if not small:
        File(target).with_suffix(".svg").write_text(canvas.svg(), encoding="utf-8")
    print(f"{target}: {len(canvas.commands)} commands")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "shapes.png", "--small" in sys.argv)
