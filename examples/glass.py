"""Glass, water and fog (FoCG 13.1): what is transparent, by the `ray` renderer.

A glass of water whose water touches the wall; a ball with a bubble; amber, coloured by the way through it; a biconvex lens cut from two
balls; frosted glass; and a box full of fog.

    python examples/glass.py glass.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import frame_from_gaze, rotate_x, rotate_y, translate

GLASS = limner.Dielectric(1.5, absorption=(0.35, 0.12, 0.2), priority=1)
CLEAR = limner.Dielectric(1.52)
WATER = limner.Dielectric.with_color_at((0.7, 0.9, 0.95), 1.0, ior=1.33)
AMBER = limner.Dielectric.with_color_at((0.95, 0.55, 0.12), 0.8, ior=1.55)
FROSTED = limner.Dielectric(1.5, roughness=0.28, tint=(0.9, 0.97, 0.92))
FOG = limner.Dielectric(1.0, absorption=(1.6, 1.6, 1.6), haze=(0.75, 0.78, 0.85))


def shown(geometry: object, material: object, place: np.ndarray) -> limner.Node:
    """A node with one shape."""
    return limner.Node(parent_from_node=place, shapes=(limner.Shape(geometry, (material,)),))


def tumbler() -> limner.Node:
    """A cup with a wall of 6 cm, and water in it that reaches into the wall: the glass has the priority there."""
    cup = limner.Difference(limner.Cylinder(0.5, 1.4), limner.Solid(limner.Cylinder(0.44, 1.4), translate(0, 0.1, 0)))
    water = limner.Cylinder(0.47, 0.95)
    straw = limner.Lambert((0.85, 0.1, 0.12))
    leaning = translate(0.1, 0.75, 0.0) @ rotate_x(0.22)
    return limner.Node(
        "tumbler",
        translate(-2.1, 0.701, 0.4),
        children=(
            shown(cup, GLASS, np.eye(4)),
            shown(water, WATER, translate(0, -0.095, 0)),
            shown(limner.Cylinder(0.04, 2.2), straw, translate(0, -0.2, 0) @ leaning),
        ),
    )


def lens() -> limner.Node:
    """What two balls of radius 1 have in common."""
    halves = (limner.Solid(limner.Sphere(1.0), translate(0, 0, side * 0.8)) for side in (-1, 1))
    return shown(limner.Intersection(*halves), CLEAR, translate(1.15, 0.62, 1.25) @ rotate_y(0.25))


def scene() -> limner.Scene:
    """All of it, on a checkered floor under an even sky, lit by one large lamp."""
    tiles = np.full((2, 2, 4), 255, dtype=np.uint8)
    tiles[[0, 1], [0, 1], :3] = (70, 76, 84)
    texture = limner.Texture(limner.Texels(tiles), filter="nearest", scale=(1.0, 1.0))
    sky = np.linspace((0.35, 0.5, 0.85), (0.95, 0.95, 0.92), 32, dtype=np.float32)[:, None].repeat(64, axis=1)
    lamp = frame_from_gaze((3.0, 5.0, 3.0), (-3.0, -5.0, -3.0), (0.0, 1.0, 0.0))
    parts = (
        shown(limner.Plane(), limner.Lambert((0.9, 0.9, 0.9), texture=texture), np.eye(4)),
        tumbler(),
        shown(limner.Sphere(0.6), CLEAR, translate(-0.9, 0.601, -0.7)),
        shown(limner.Sphere(0.33), limner.Dielectric(1.0), translate(-0.83, 0.7, -0.62)),
        shown(limner.Sphere(0.55), AMBER, translate(0.65, 0.551, -1.1)),
        lens(),
        shown(limner.Box((0.8, 0.8, 0.8)), FROSTED, translate(2.25, 0.401, -0.9) @ rotate_y(0.5)),
        shown(limner.Box((0.9, 0.9, 0.9)), FOG, translate(-0.55, 0.451, 1.75) @ rotate_y(-0.3)),
        shown(limner.Sphere(0.2), limner.Lambert((0.75, 0.12, 0.1)), translate(-0.55, 0.35, 1.75)),
        limner.Node("lamp", lamp, lights=(limner.RectangleLight(intensity=7.0, width=2.0, height=2.0),)),
    )
    camera = limner.Camera.look_at((0.0, 3.0, 6.6), (0.0, 0.5, 0.15), yfov_degrees=31)
    return limner.Scene(
        limner.Node(children=parts), camera, background="environment", environment=limner.Environment(sky, intensity=0.7)
    )


def main(target: str, small: bool = False) -> None:
    """Draw it with soft shadows."""
    width, height, samples = (128, 72, 4) if small else (720, 405, 16)
    image = limner.render(scene(), width=width, height=height, renderer="ray", samples=samples, sampler="multijittered", max_depth=12)
    image.save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "glass.png", "--small" in sys.argv)
