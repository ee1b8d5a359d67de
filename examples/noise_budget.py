"""Until it is quiet (FoCG 23): light by chance, with as many paths in each part of the picture as its noise asks for.

Left, the same number of paths everywhere. Middle, `noise=…`: about as many in all, spread by how much light still differs from path to
path. Right, how many each block took, bright is many: the wall in full light is done soon, the corner lit through a slit goes on.

    python examples/noise_budget.py noise_budget.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import frame_from_gaze, translate


def scene() -> limner.Scene:
    """A bright wall, and a nook behind a screen that light enters from below."""
    white, warm = limner.Lambert((0.75, 0.75, 0.73)), limner.Lambert((0.75, 0.4, 0.25))

    def block(size: tuple[float, float, float], at: tuple[float, float, float], paint: limner.Lambert = white) -> limner.Node:
        return limner.Node(parent_from_node=translate(*at), shapes=(limner.Shape(limner.Box(size), (paint,)),))

    nodes = (
        block((8.0, 0.2, 6.0), (0.0, -0.1, 0.0)), block((8.0, 4.0, 0.2), (0.0, 2.0, -2.0)), block((0.2, 4.0, 6.0), (3.0, 2.0, 0.0), warm),
        block((0.15, 3.4, 2.6), (0.8, 2.1, -0.7)), block((2.4, 0.15, 2.6), (1.9, 3.0, -0.7)),
        limner.Node(parent_from_node=translate(1.9, 0.5, -1.0), shapes=(limner.Shape(limner.Sphere(0.5), (warm,)),)),
        limner.Node(parent_from_node=translate(-1.2, 0.6, -0.6), shapes=(limner.Shape(limner.Sphere(0.6), (white,)),)),
        limner.Node(parent_from_node=frame_from_gaze((-3.0, 3.6, 2.0), (2.4, -2.8, -2.6), (0, 1, 0)),
                    lights=(limner.RectangleLight((1.0, 0.94, 0.85), 34.0, 1.2, 1.2),)),
    )  # fmt: skip
    return limner.Scene(limner.Node(children=nodes), limner.Camera.look_at((0.3, 1.9, 6.4), (0.2, 1.35, 0.0), yfov_degrees=36))


def main(target: str, small: bool = False) -> None:
    """Spread by noise first, then evenly with as many."""
    width, height, noise = (48, 40, 0.25) if small else (320, 288, 0.07)
    options = {"width": width, "height": height, "renderer": "path", "max_depth": 6}
    spread = limner.render(scene(), noise=noise, samples=64 if small else 512, aovs=("samples",), **options)
    taken = spread.aov["samples"].astype(float)
    even = limner.render(scene(), samples=max(1, round(taken.mean())), **options)
    share = (taken / taken.max())[..., None].repeat(4, axis=-1).astype(np.float32)
    share[..., 3] = 1.0
    sheet = Canvas(3 * width, height, "black")
    shown = {f"{round(taken.mean())} paths each": even, f"until {noise:g} of noise": spread, "how many, where": limner.Image(share)}
    for k, (words, picture) in enumerate(shown.items()):
        sheet.paste(picture, k * width, 0).text(k * width + 8, 20, words, (1.0, 0.6, 0.1) if k == 2 else "black", 13)
    sheet.image().save(target)
    print(f"{target}: {taken.min():g} to {taken.max():g} paths for a pixel, {taken.mean():.0f} on average")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "noise_budget.png", "--small" in sys.argv)
