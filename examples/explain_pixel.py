"""Why does this pixel look like that? The tree of rays of one pixel (FoCG 4, 13.1), drawn into the scene as it is seen from the side.

Blue: the eye's ray. Orange: reflected and refracted. Yellow: to a light; red: one that something blocks. Beside the picture stands the
page with the whole story: every term, its formula, and where that comes from.

    python examples/explain_pixel.py pixel.png        writes pixel.png and pixel.html
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.draw.stroke import Pen
from limner.explain.explain import explain
from limner.linear.transform import translate

INKS = {"eye": "#1b6ac9", "ray": "#e07a10", "shadow": "#d8c400", "blocked": "#c01030"}


def scene() -> limner.Scene:
    """A glass ball before a mirroring one, on a ground, in the sun."""
    glass = limner.Node("glass", translate(-0.6, 0.6, 0.4), shapes=(limner.Shape(limner.Sphere(0.6), (limner.Dielectric(ior=1.5),)),))
    steel = limner.BlinnPhong(diffuse=(0.05, 0.05, 0.06), mirror=(0.7, 0.7, 0.75))
    ball = limner.Node("steel", translate(0.6, 0.7, -0.9), shapes=(limner.Shape(limner.Sphere(0.7), (steel,)),))
    ground = limner.Node("ground", shapes=(limner.Shape(limner.Plane(), (limner.Lambert((0.45, 0.4, 0.33)),)),))
    lamp = limner.Node("lamp", translate(2.0, 4.0, 2.0), lights=(limner.PointLight(intensity=55.0),))
    air = limner.Node("air", lights=(limner.AmbientLight(intensity=0.15),))
    root = limner.Node("world", children=(glass, ball, ground, lamp, air))
    return limner.Scene(root, camera=limner.Camera.look_at((0, 1.2, 5), (0, 0.6, 0), yfov_degrees=35), background=(0.35, 0.5, 0.7))


def main(target: str, small: bool = False) -> None:
    """Tell the story, and draw its rays over a picture from another side."""
    width, height, pixel = (160, 100, (65, 56)) if small else (640, 400, (262, 226))
    made = scene()
    told = explain(made, *pixel, width=width, height=height, renderer="ray", samples=1)
    told.save(Path(target).with_suffix(".html"))
    side = limner.Camera.look_at((6.5, 3.2, 4.5), (0.0, 0.6, 1.2), yfov_degrees=38)
    canvas = Canvas.on(limner.render(made, camera=side, width=width, height=height, renderer="ray", samples=4))
    for ray in told.drawing["rays"]:
        ends, depth = side.project(np.array([ray["from"], ray["to"]]), width, height)
        if (depth > 0.0).all():
            canvas.line(*ends[0], *ends[1], INKS[ray["kind"]], Pen(1.6))
    canvas.text(12, 24, f"pixel {pixel}: {len(told.drawing['rays'])} rays", "#ffffff", 16)
    canvas.image().save(target)
    rays = sum(step.kind == "ray" for step in told.story.walk())
    print(f"{target}: {rays} rays in the tree, {len(told.drawing['rays']) - rays} to lights; the picture's own bits: {told.is_exact}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "pixel.png", "--small" in sys.argv)
