"""Exact shapes (FoCG 4.4) and solids made of solids (FoCG 13.3), by rays.

Behind: disk, cylinder, tube, cone, frustum, torus, hyperboloid, bilinear patch. In front: a die, a box hollowed by a ball, the classic
(box and ball) without three cylinders, two balls and a ring in one, and half a torus.

    python examples/solids.py solids.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.linear.transform import in_order, rotate, translate

STEP, ROW = 2.3, 3.1  # from shape to shape, from row to row


def paint(r: float, g: float, b: float) -> limner.BlinnPhong:
    """A colour with a highlight."""
    return limner.BlinnPhong(diffuse=(r, g, b), specular=(0.3, 0.3, 0.3), exponent=60)


RED, ORANGE, YELLOW, GREEN = paint(0.7, 0.1, 0.08), paint(0.8, 0.4, 0.1), paint(0.7, 0.6, 0.1), paint(0.1, 0.5, 0.15)
BLUE, VIOLET, WHITE = paint(0.1, 0.2, 0.7), paint(0.5, 0.1, 0.6), paint(0.8, 0.8, 0.78)


def die() -> limner.Difference:
    """A box with its corners rounded by a ball, without its pips; opposite faces make seven."""
    a, out = 0.27, 0.55
    rows = {1: [(0, 0)], 2: [(-a, -a), (a, a)], 3: [(-a, -a), (0, 0), (a, a)], 4: [(-a, -a), (a, a), (-a, a), (a, -a)]}
    rows[5], rows[6] = [*rows[4], (0, 0)], [(u, v) for u in (-a, a) for v in (-a, 0, a)]
    axis = {1: 1, 6: 1, 2: 0, 5: 0, 3: 2, 4: 2}
    pips = []
    for number, places in rows.items():
        for u, v in places:
            middle = np.insert(np.array([u, v], dtype=float), axis[number], out if number <= 3 else -out)
            pips.append(limner.Solid(limner.Sphere(0.1), translate(*middle), material=RED))
    return limner.Difference(limner.Intersection(limner.Box(1.0), limner.Sphere(0.7)), *pips)


def drilled() -> limner.Difference:
    """A rounded box without a cylinder along each axis."""
    drill = limner.Cylinder(0.42, 2.0)
    ways = (drill, limner.Solid(drill, rotate((1, 0, 0), math.pi / 2)), limner.Solid(drill, rotate((0, 0, 1), math.pi / 2)))
    return limner.Difference(limner.Intersection(limner.Box(1.5), limner.Sphere(1.0)), *ways)


def shapes() -> list[list[tuple[limner.Shape, np.ndarray]]]:
    """Row by row, each with how it stands."""
    tower = limner.Quadric((1, -1, 1, 0, 0, 0, 0, 0, 0, -0.15), low=(-1, -0.8, -1), high=(1, 0.8, 1))
    bent = limner.BilinearPatch(((-0.9, 0, 0.9), (0.9, 1.2, 0.9), (0.9, 0, -0.9), (-0.9, 1.2, -0.9)))
    hollow = limner.Difference(limner.Box(1.5), limner.Solid(limner.Sphere(0.95), material=YELLOW))
    pair = limner.Union(
        limner.Solid(limner.Sphere(0.6), translate(-0.3, 0, 0)),
        limner.Solid(limner.Sphere(0.6), translate(0.3, 0, 0), material=ORANGE),
        limner.Solid(limner.Torus(0.6, 0.15), translate(0, 0.2, 0)),
    )
    half = limner.Intersection(limner.Torus(0.75, 0.3), limner.Solid(limner.Plane(), rotate((0, 0, 1), 0.5)))

    def standing(geometry: object, material: limner.BlinnPhong, height: float, lean: float = 0.0) -> tuple[limner.Shape, np.ndarray]:
        return limner.Shape(geometry, (material,)), in_order(rotate((1, 0, 0), lean), translate(0, height, 0))

    return [
        [
            standing(limner.Disk(0.95), RED, 0.8, 0.9),
            standing(limner.Cylinder(0.7, 1.6), GREEN, 0.8),
            standing(limner.Cylinder(0.8, 1.2, capped=False), BLUE, 0.95, 1.1),
            standing(limner.Cone(1.0, 1.8), YELLOW, 0.9),
        ],
        [
            standing(limner.Cone(0.9, 1.2, 0.4, capped=False), VIOLET, 0.85, 0.5),
            standing(limner.Torus(0.75, 0.28), GREEN, 0.9, 1.0),
            standing(tower, ORANGE, 0.8),
            standing(bent, WHITE, 0.1),
        ],
        [
            standing(die(), WHITE, 0.5),
            standing(hollow, RED, 0.75),
            standing(drilled(), GREEN, 0.75),
            standing(pair, BLUE, 0.6),
            standing(half, VIOLET, 0.62, 0.6),
        ],
    ]


def main(target: str, small: bool = False) -> None:
    """Put them in rows on a ground, and look from above."""
    nodes = [
        limner.Node(parent_from_node=in_order(place, translate((column - (len(row) - 1) / 2) * STEP, 0, k * ROW)), shapes=(shape,))
        for k, row in enumerate(shapes())
        for column, (shape, place) in enumerate(row)
    ]
    camera = limner.Camera.look_at((0, 10.5, 15), (0, 0.5, 3.3), yfov_degrees=32)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera).with_ground(limner.Lambert((0.4, 0.45, 0.5)))
    width, height, samples = (192, 120, 1) if small else (960, 600, 8)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(nodes)} shapes")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "solids.png", "--small" in sys.argv)
