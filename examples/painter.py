"""Who is in front? (FoCG 8.2.2, 8.2.3, 12.4): three bars, each over the next, drawn in four ways.

No order of the three is right for the painter, whichever bar is drawn first: the first panel draws them by their distance. A binary tree
of planes cuts them until an order exists; a z-buffer needs none; rays do not even ask.

    python examples/painter.py painter.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import in_order, rotate, translate

PAINTS = [limner.Lambert(color) for color in ((0.8, 0.12, 0.08), (0.85, 0.6, 0.05), (0.05, 0.3, 0.75))]
EYE = (0.0, 0.0, 7.0)


def bar(k: int) -> limner.Node:
    """One side of a triangle: its far end lies behind the bar before it, its near end over the next."""
    turned = in_order(rotate((0, 1, 0), 0.22), translate(0.0, -0.62, 0.0), rotate((0, 0, 1), 2.0 * math.pi * k / 3.0))
    mesh = limner.primitives.box((3.0, 0.42, 0.06))
    return limner.Node(f"bar {k}", turned, shapes=(limner.Shape(mesh, PAINTS[k]),))


def scene(*bars: int) -> limner.Scene:
    """Some of the bars, lit from the eye."""
    sun = limner.Node(lights=(limner.DirectionalLight(intensity=2.4), limner.AmbientLight(intensity=0.3)))
    camera = limner.Camera.look_at(EYE, (0, 0, 0), yfov_degrees=37)
    return limner.Scene(limner.Node(children=(*map(bar, bars), sun)), camera, background=(1.0, 1.0, 1.0))


def main(target: str, small: bool = False) -> None:
    """A naive painter, a careful one, a z-buffer, and rays."""
    side = 64 if small else 320
    size = {"width": side, "height": side}
    naive = np.ones((side, side, 4), dtype=np.float32)
    for k in range(3):  # all are as far away: any order
        layer = limner.render(scene(k).replace(background=None), **size).pixels
        naive[..., :3] += layer[..., 3:] * (layer[..., :3] - naive[..., :3])
    pictures = {
        "bar by bar": limner.Image(naive),
        "painter, cut by a BSP tree": limner.render(scene(0, 1, 2), hidden_surfaces="painter", **size),
        "z-buffer": limner.render(scene(0, 1, 2), **size),
        "rays": limner.render(scene(0, 1, 2), renderer="ray", **size),
    }
    sheet = Canvas(4 * side, side + 30, "white")
    for k, (words, picture) in enumerate(pictures.items()):
        sheet.paste(picture, k * side, 0).text(k * side + side / 2, side + 16, words, "#222222", 15, "center")
    sheet.image().save(target)
    apart = np.abs(pictures["z-buffer"].pixels - pictures["painter, cut by a BSP tree"].pixels).max(axis=-1) > 0.02
    print(f"{target}: painter and z-buffer differ in {apart.mean():.2%} of the pixels")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "painter.png", "--small" in sys.argv)
