"""Wire frames (FoCG 8.1.1, 10.3.1): all edges, those that are seen, outlines and creases alone, and lines over shading.

    python examples/wireframes.py wires.png
"""

from __future__ import annotations

import sys

import limner
from limner.draw.canvas import Canvas

WAYS = {
    "all edges": {"edges": "all", "hidden": "black"},
    "hidden ones lighter": {"edges": "all", "hidden": "#c8ccd4"},
    "outlines and creases": {"edges": "features", "line_width": 1.6},
    "over the shaded model": {"edges": "all", "shaded": True, "line_width": 0.7},
}


def main(target: str, small: bool = False) -> None:
    """Four ways to draw a coarse teapot."""
    width, height = (80, 60) if small else (480, 340)
    pot = limner.Shape(limner.primitives.teapot(3 if small else 6), limner.Lambert((0.55, 0.68, 0.8)))
    camera = limner.Camera.orbit((0.0, 0.75, 0.0), 6.0, 28.0, 22.0, yfov_degrees=24)
    scene = limner.Scene(limner.Node(shapes=(pot,)), camera)
    sheet = Canvas(2 * width, 2 * height, "white")
    for k, (words, look) in enumerate(WAYS.items()):
        x, y = k % 2 * width, k // 2 * height
        sheet.paste(limner.wireframe(scene, width=width, height=height, **look).image(), x, y)
        sheet.text(x + 12, y + 24, words, "#222222", 15)
    sheet.image().save(target)
    print(f"{target}: {', '.join(WAYS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "wires.png", "--small" in sys.argv)
