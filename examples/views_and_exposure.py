"""One light, eight pictures: lamps of five colours, each row four stops brighter than the one below, through every view (FoCG 20).

Left to right, top to bottom: standard, reinhard, reinhard_extended, hable; aces, narkowicz, agx, pbr_neutral. Curves on each channel keep
a lamp's colour however bright it is, or bend it towards a primary: orange turns yellow. AgX, ACES and Khronos' curve turn what is bright
pale, as film does. The light is rendered once, with few paths, and its noise taken out; a view is chosen when it is saved.

    python examples/views_and_exposure.py views.png
"""

from __future__ import annotations

import sys

import limner
from limner.color.views import VIEWS
from limner.draw.canvas import Canvas
from limner.linear import transform

COLORS = ((1.0, 0.02, 0.01), (1.0, 0.3, 0.02), (0.05, 1.0, 0.05), (0.02, 0.05, 1.0), (1.0, 1.0, 1.0))
STEP = 1.1  # from lamp to lamp


def lamp(column: int, row: int) -> limner.Node:
    """A ball that shines, four stops brighter in each row."""
    red, green, blue = (float(channel) * 16.0**row / 4.0 for channel in COLORS[column])
    glow = limner.Lambert((0.0, 0.0, 0.0), emission=(red, green, blue))
    place = transform.translate((column - 2) * STEP, (row - 1) * STEP, 0.0)
    return limner.Node(f"lamp {column} {row}", place, shapes=(limner.Shape(limner.Sphere(0.4), glow),))


def scene() -> limner.Scene:
    """Lamps before a wall."""
    gray = limner.Lambert((0.01, 0.01, 0.01))
    wall = limner.Node("wall", transform.translate(0.0, 0.0, -0.7), shapes=(limner.Shape(limner.Box((12.0, 8.0, 0.1)), gray),))
    camera = limner.Camera.look_at((0.0, 0.0, 10.0), (0.0, 0.0, 0.0), yfov_degrees=21)
    lamps = [lamp(column, row) for row in range(3) for column in range(len(COLORS))]
    return limner.Scene(root=limner.Node(children=(wall, *lamps)), camera=camera)


def main(target: str, small: bool = False) -> None:
    """Render once, and save all views side by side."""
    width, height, samples = (64, 44, 4) if small else (256, 176, 32)
    light = limner.render(scene(), width=width, height=height, renderer="path", samples=samples, denoise="filter")
    views = [view for view in VIEWS if view != "none"]
    sheet = Canvas(4 * width, 2 * height, "black")
    for k, view in enumerate(views):
        x, y = k % 4 * width, k // 4 * height
        sheet.paste(light.viewed(view), x, y).text(x + width / 2, y + height - 8, view, "white", 13, "center")
    sheet.image().save(target)
    print(f"{target}: {', '.join(view for view in VIEWS if view != 'none')}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "views.png", "--small" in sys.argv)
