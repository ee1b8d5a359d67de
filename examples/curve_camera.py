"""A camera on a path (FoCG 15.1.1): even steps along a curve through given eyes, starting and stopping gently; a strip of its pictures.

    python examples/curve_camera.py path.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.curves.arc_length import ArcLength
from limner.curves.catmull_rom import catmull_rom
from limner.curves.easing import smoothstep
from limner.draw.canvas import Canvas

EYES = [(4.0, 0.6, 3.0), (1.0, 1.2, 4.5), (-3.5, 2.0, 2.5), (-3.0, 4.0, -2.0), (1.5, 5.0, -2.5)]
FRAMES = 12


def main(target: str, small: bool = False) -> None:
    """Twelve pictures of the teapot, row by row."""
    path = ArcLength(catmull_rom(EYES))
    gone = path.length * smoothstep(np.linspace(0.0, 1.0, FRAMES))
    scene = limner.builtin("teapot")
    width, height = (40, 30) if small else (240, 180)
    sheet = Canvas(4 * width, FRAMES // 4 * height, "white")
    with limner.Renderer(scene, width=width, height=height) as renderer:
        for k, eye in enumerate(path.curve.at(path.parameter(gone))):
            picture = renderer.render(limner.Camera.look_at(eye, (0.0, 0.7, 0.0), yfov_degrees=40))
            sheet.paste(picture, k % 4 * width, k // 4 * height)
    sheet.image().save(target)
    print(f"{target}: a path of {path.length:.2f} m in {FRAMES} pictures")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "curve_camera.png", "--small" in sys.argv)
