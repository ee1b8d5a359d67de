"""One scene drawn six ways: plain, sketched and hatched, stippled, seen through, in areas, and cool to warm (FoCG 10.3).

    python examples/drawing_styles.py styles.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import translate
from limner.produce.drawing import drawing
from limner.produce.stylized import stylized


def scene() -> limner.Scene:
    """A teapot's company: a torus, a ball on it, and a box behind."""
    clay, sky, leaf = (limner.Lambert(color=color) for color in ((0.75, 0.35, 0.2), (0.3, 0.5, 0.8), (0.35, 0.6, 0.3)))
    nodes = (
        limner.Node(parent_from_node=translate(0.0, 0.35, 0.0), shapes=(limner.Shape(limner.Torus(1.0, 0.35), clay),)),
        limner.Node(parent_from_node=translate(0.0, 1.2, 0.0), shapes=(limner.Shape(limner.Sphere(0.8), sky),)),
        limner.Node(parent_from_node=translate(-1.2, 0.75, -2.2), shapes=(limner.Shape(limner.Box((1.4, 1.5, 1.4)), leaf),)),
    )
    camera = limner.Camera.look_at((3.6, 2.8, 4.6), (-0.15, 0.85, -0.5), yfov_degrees=27)
    return limner.Scene(root=limner.Node(children=nodes), camera=camera)


def main(target: str, small: bool = False) -> None:
    """Six pictures side by side."""
    width, height = (84, 64) if small else (420, 320)
    size = {"width": width, "height": height}
    pictures = [
        drawing(scene(), style="plain", **size).image(),
        drawing(scene(), style="sketch", tone="hatching", **size).image(),
        drawing(scene(), style="plain", tone="stippling", **size).image(),
        drawing(scene(), style="xray", **size).image(),
        drawing(scene(), style="sketch", fill=True, **size).image(),
        stylized(scene(), style="gooch", lines=True, **size),
    ]
    sheet = Canvas(3 * width, 2 * height, background="white")
    for index, picture in enumerate(pictures):
        row, column = divmod(index, 3)
        sheet.paste(picture, column * width, row * height)
    image = sheet.image()
    image.save(target)
    print(f"{target}: {len(pictures)} styles, {float(np.mean(image.pixels[..., 0] < 0.5)):.0%} ink")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "styles.png", "--small" in sys.argv)
