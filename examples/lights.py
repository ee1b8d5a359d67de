"""Kinds of light (FoCG 4.5.4, 13.4.2): the sun, a bulb, a spot; a disk, a panel and a ball, whose shadows are soft.

The same white things six times. What is a point casts a sharp shadow; the larger a lamp looks from a place, the softer the shadow there.
Ray traced, so what no lamp sees is lit by a little ambient light alone.

    python examples/lights.py lights.png
"""

from __future__ import annotations

import math
import sys

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import frame_from_gaze, translate

ABOVE = (1.6, 2.6, 1.2)
LAMPS = {
    "DirectionalLight": limner.DirectionalLight(intensity=2.6),
    "PointLight": limner.PointLight(intensity=27.0),
    "SpotLight": limner.SpotLight(intensity=30.0, inner_degrees=14.0, outer_degrees=24.0),
    "DiskLight": limner.DiskLight(intensity=27.0 / (math.pi * 0.16), radius=0.4, visible=False),
    "RectangleLight": limner.RectangleLight(intensity=9.0, width=3.0, height=1.0, visible=False),
    "SphereLight": limner.SphereLight(intensity=27.0 / (math.pi * 0.49), radius=0.7, visible=False),
}


def scene(lamp: limner.PointLight) -> limner.Scene:
    """A ball, a box and a pole under it."""
    white = limner.Lambert((0.75, 0.73, 0.7))
    things = (
        limner.Node(parent_from_node=translate(-0.1, 0.45, 0.3), shapes=(limner.Shape(limner.Sphere(0.45), white),)),
        limner.Node(parent_from_node=translate(-0.9, 0.35, -0.6), shapes=(limner.Shape(limner.Box(0.7), white),)),
        limner.Node(parent_from_node=translate(0.75, 0.7, -0.3), shapes=(limner.Shape(limner.Cylinder(0.06, 1.4), white),)),
    )
    down = tuple(-value for value in ABOVE)
    lamps = limner.Node(parent_from_node=frame_from_gaze(ABOVE, down, (0.0, 1.0, 0.0)), lights=(lamp,))
    sky = limner.Node(lights=(limner.AmbientLight((0.6, 0.75, 1.0), intensity=0.16),))
    camera = limner.Camera.look_at((0.2, 2.7, 4.2), (-0.25, 0.3, 0.0), yfov_degrees=32)
    return limner.Scene(limner.Node(children=(*things, lamps, sky)), camera).with_ground(limner.Lambert((0.55, 0.55, 0.57)))


def main(target: str, small: bool = False) -> None:
    """Three in a row, with their names."""
    width, height, samples = (80, 60, 4) if small else (400, 300, 64)
    sheet = Canvas(3 * width, 2 * height, "black")
    for k, (name, lamp) in enumerate(LAMPS.items()):
        image = limner.render(scene(lamp), width=width, height=height, renderer="ray", samples=samples, sampler="multijittered")
        sheet.paste(image, k % 3 * width, k // 3 * height)
        sheet.text(k % 3 * width + 10, k // 3 * height + 22, name, "white", 15)
    sheet.image().save(target)
    print(f"{target}: {', '.join(LAMPS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "lights.png", "--small" in sys.argv)
