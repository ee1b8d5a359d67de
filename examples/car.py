"""A car on its wheels: a scene graph in which what hangs on something goes with it (FoCG 12.2), and what moves, moves by keys.

    python examples/car.py car.png

The car stands in the world, each wheel in the car, spokes in the wheel. Its animation drives the car and turns the wheels by as much as
they roll, no more: a wheel of radius r turns by x / r. Four moments above; below, the same scene with the shutter open for a while: the
car is blurred along its way, the road is not, and a wheel is sharpest where it touches the road, where it stands still.
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.linear import quaternion, transform

RADIUS, WAY, SECONDS = 0.45, 6.0, 2.0
PAINT = limner.BlinnPhong(diffuse=(0.65, 0.06, 0.05), specular=(0.5, 0.5, 0.5), exponent=120, name="paint")
GLASS = limner.BlinnPhong(diffuse=(0.05, 0.07, 0.09), specular=(0.8, 0.8, 0.8), exponent=300, name="glass")
RUBBER = limner.Lambert((0.03, 0.03, 0.03), name="rubber")
STEEL = limner.BlinnPhong(diffuse=(0.5, 0.5, 0.52), specular=(0.6, 0.6, 0.6), exponent=60, name="steel")


def wheel(name: str, x: float, z: float) -> limner.Node:
    """A tyre with five spokes, its axle along z."""
    upright = transform.rotate_x(math.pi / 2.0)
    tyre = limner.Node("tyre", upright, shapes=(limner.Shape(limner.Torus(RADIUS - 0.1, 0.1), RUBBER),))
    spokes = tuple(
        limner.Node(
            "spoke", transform.rotate_z(2.0 * math.pi * k / 5) @ transform.translate(0.0, 0.17, 0.0),
            shapes=(limner.Shape(limner.Box((0.06, 0.34, 0.06)), STEEL),),
        )
        for k in range(5)
    )  # fmt: skip
    return limner.Node(name, transform.translate(x, RADIUS, z), children=(tyre, *spokes))


def car() -> limner.Node:
    """Body and wheels, facing +x."""
    body = limner.Node("body", transform.translate(0.0, 0.8, 0.0), shapes=(limner.Shape(limner.Box((2.6, 0.6, 1.2)), PAINT),))
    cabin = limner.Node("cabin", transform.translate(-0.15, 1.3, 0.0), shapes=(limner.Shape(limner.Box((1.3, 0.45, 1.0)), GLASS),))
    wheels = [wheel(f"wheel {k}", x, z) for k, (x, z) in enumerate(((-0.85, -0.65), (-0.85, 0.65), (0.85, -0.65), (0.85, 0.65)))]
    return limner.Node("car", children=(body, cabin, *wheels))


def drive() -> limner.Animation:
    """The car rolls along x; every wheel turns by the way over its radius."""
    still, whole = limner.Track.constant((0, 0, 0, 1), rotates=True), limner.Track.constant((1, 1, 1))
    half = WAY / 2.0
    along = limner.Track((0.0, SECONDS), ((-half, 0, 0), (half, 0, 0)))
    times = np.linspace(0.0, SECONDS, 25)
    turns = limner.Track(times, [quaternion.from_axis_angle((0, 0, 1), -WAY / RADIUS * t / SECONDS) for t in times], rotates=True)
    channels = [limner.NodeChannel("world/car", limner.KeyedMotion(along, still, whole))]
    for node in car().children:
        if node.name.startswith("wheel"):
            place = limner.Track.constant(node.parent_from_node[:3, 3])
            channels.append(limner.NodeChannel(f"world/car/{node.name}", limner.KeyedMotion(place, turns, whole)))
    return limner.Animation("drive", tuple(channels))


def scene() -> limner.Scene:
    """The car on its road."""
    dash = limner.Shape(limner.Box((0.8, 0.002, 0.12)), limner.Lambert((0.9, 0.9, 0.9)))
    dashes = tuple(limner.Node("dash", transform.translate(x, 0.001, 1.6), shapes=(dash,)) for x in np.arange(-7.0, 8.0, 2.0))
    road = limner.Node("road", shapes=(limner.Shape(limner.Plane(), limner.Lambert((0.23, 0.24, 0.25))),), children=dashes)
    lights = (limner.AmbientLight(intensity=0.35), limner.DirectionalLight(intensity=2.4))
    sun = limner.Node("sun", transform.rotate_y(0.6) @ transform.rotate_x(-0.9), lights=lights)
    camera = limner.Camera.look_at((2.5, 2.6, 10.5), (0.0, 0.6, 0.0), yfov_degrees=23)
    return limner.Scene(limner.Node("world", children=(car(), road, sun)), camera, (0.55, 0.65, 0.8), animations=(drive(),))


def main(target: str, small: bool = False) -> None:
    """Draw four moments and one long exposure."""
    shown = scene()
    width, height, samples = (80, 45, 1) if small else (480, 270, 16)
    options = {"width": width, "height": height, "renderer": "ray", "samples": samples}
    long = {**options, "width": 2 * width, "height": 2 * height, "samples": 4 * samples}
    moments = [limner.render(shown, time=time, **options).pixels for time in (0.3, 0.75, 1.2, 1.65)]
    blurred = limner.render(shown, shutter=(0.9, 1.05), **long).pixels
    sheet = np.concatenate([np.concatenate(moments[:2], axis=1), np.concatenate(moments[2:], axis=1), blurred])
    limner.Image(sheet).save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "car.png", "--small" in sys.argv)
