"""An exploded view with labels: parts moved along their axis, and what they are called.

Every part knows where it belongs; to explode is one more translation above it in the scene graph (FoCG 12.2). The camera tells where a
point of the world lies in the picture (`project`, FoCG 7), and the canvas writes there.

    python examples/exploded.py exploded.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import rotate_z, translate
from limner.mesh.shapes import primitives

STEEL = limner.BlinnPhong(diffuse=(0.42, 0.44, 0.47), specular=(0.5, 0.5, 0.5), exponent=90)
BRASS = limner.BlinnPhong(diffuse=(0.62, 0.42, 0.12), specular=(0.5, 0.42, 0.25), exponent=70)
RUBBER = limner.BlinnPhong(diffuse=(0.05, 0.05, 0.055), specular=(0.08, 0.08, 0.08), exponent=20)
TURN = 2.0 * math.pi * np.arange(72) / 72


def circle(radius: float, n: int = 72, corners: float = 0.0) -> np.ndarray:
    """(n, 2): a circle, or with corners a polygon."""
    turn = 2.0 * math.pi * (np.arange(n) + corners) / n
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


PARTS = (
    ("bolt head", primitives.extrusion(circle(0.55, 6), 0.35), STEEL, -1.9),
    ("shank", primitives.extrusion(circle(0.28), 1.7), STEEL, -0.9),
    ("washer", primitives.extrusion(circle(0.62), 0.08, [circle(0.3)]), BRASS, 0.35),
    ("seal", primitives.torus(0.42, 0.1, 72, 24), RUBBER, 0.85),
    ("flange", primitives.extrusion(circle(0.95), 0.22, [circle(0.3), *(circle(0.12) + at for at in circle(0.66, 6))]), BRASS, 1.4),
    ("nut", primitives.extrusion(circle(0.52, 6, 0.5), 0.4, [circle(0.29)]), STEEL, 2.2),
)


def main(target: str, small: bool = False) -> None:
    """The parts along x, a thin axis through them, and words above."""
    width, height, samples = (160, 80, 2) if small else (1000, 500, 16)
    upright = {"seal": rotate_z(math.pi / 2.0)}
    along = np.array([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1.0]])  # an extrusion's z onto x
    nodes = [
        limner.Node(name, translate(x, 0.0, 0.0) @ upright.get(name, along), shapes=(limner.Shape(mesh, paint),))
        for name, mesh, paint, x in PARTS
    ]
    camera = limner.Camera.look_at((2.6, 2.6, 7.2), (0.15, 0.0, 0.0), yfov_degrees=25)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera, background=(0.95, 0.95, 0.95))
    canvas = Canvas.on(limner.render(scene, width=width, height=height, samples=samples))
    for k, (name, mesh, _, x) in enumerate(PARTS):
        top = mesh.bounds[1, 1] if name != "seal" else 0.5
        (foot, head), _ = camera.project(np.array([(x, top, 0.0), (x, 1.2 + 0.2 * (k % 2), 0.0)]), width, height)
        canvas.line(*foot, *head, "#555555", 1.0)
        canvas.text(head[0], head[1] - 6, f"{k + 1}  {name}", "#222222", 9 if small else 16, "center")
    canvas.image().save(target)
    print(f"{target}: {len(PARTS)} parts")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "exploded.png", "--small" in sys.argv)
