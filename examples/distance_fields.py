"""Fields of distances (FoCG 22), by sphere tracing: shapes for whose intersection with a ray there is no formula.

Behind: a ball that a gyroid hollows, Menger's sponge, a quaternion Julia set, a twisted tower. In the middle: a ball and a box of glass
melted together, a rounded nut, a bowl, a lattice of beads. In front: capsules mirrored into a star, an onion cut open, an ellipsoid
bitten by a ball, a row of cones.

    python examples/distance_fields.py distance_fields.png
"""

from __future__ import annotations

import sys

import limner
from limner.linear.transform import translate
from limner.scene import distance
from limner.scene.distance import Distance, DistanceField

STEP, ROW = 2.6, 3.0  # from shape to shape, from row to row


def paint(r: float, g: float, b: float) -> limner.BlinnPhong:
    """A colour with a highlight."""
    return limner.BlinnPhong(diffuse=(r, g, b), specular=(0.25, 0.25, 0.25), exponent=60)


RED, ORANGE, YELLOW, GREEN = paint(0.7, 0.1, 0.08), paint(0.8, 0.4, 0.1), paint(0.7, 0.6, 0.1), paint(0.1, 0.5, 0.15)
BLUE, VIOLET, WHITE, BONE = paint(0.1, 0.2, 0.7), paint(0.5, 0.1, 0.6), paint(0.8, 0.8, 0.78), paint(0.75, 0.65, 0.5)
GLASS = limner.Dielectric(ior=1.45, absorption=(0.35, 0.12, 0.2))


def nut() -> Distance:
    """Three slabs meet in a hexagon, drilled, its edges rounded by a smooth intersection."""
    slabs = [distance.Box((3.0, 0.7, 1.5)).rotated((0, 1, 0), 60.0 * k) for k in range(3)]
    return distance.Difference(distance.Intersection(*slabs, radius=0.15), distance.Cylinder(0.45, 2.0), radius=0.15)


def onion() -> Distance:
    """Shells in a shell, and a wedge cut out of them."""
    return distance.Sphere(0.7).shell(0.36).shell(0.16).shell(0.07) - distance.Box(2.0).translated(1.0, 1.0, 1.0)


def star() -> Distance:
    """A quarter of it, mirrored, its arms melted together."""
    arms = [distance.Segment((0, 0, 0), tip, 0.16) for tip in ((0.95, 0, 0), (0, 0.95, 0), (0, 0, 0.95), (0.5, 0.5, 0.5))]
    return distance.Union(*arms, radius=0.25).mirrored("xyz")


def shapes() -> list[list[tuple[Distance, limner.Material, float]]]:
    """Row by row: the field, its material, and how high its middle stands."""
    drop = distance.Union(distance.Sphere(0.6).translated(0, 0.35, 0), distance.RoundedBox((1.7, 0.4, 1.2), 0.1), radius=0.5)
    bowl = (distance.Sphere(0.95).shell(0.14) & distance.Plane().translated(0, 0.15, 0)).offset(0.03)
    beads = distance.Union(
        distance.Sphere(0.2).repeated(0.5, 3),
        *(distance.Cylinder(0.06, 0.5).rotated(axis, 90.0).repeated(0.5, 3) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        radius=0.05,
    )
    bitten = distance.Difference(distance.Ellipsoid((0.95, 0.6, 0.7)), distance.Sphere(0.5).translated(0.6, 0.35, 0.4), radius=0.1)
    tower = distance.Difference(distance.RoundedBox((1.0, 2.2, 1.0), 0.12), distance.Box((0.45, 3.0, 0.45)), radius=0.1).twisted(70.0)
    return [
        [
            (distance.Gyroid(0.8, 0.1) & distance.Sphere(1.05), RED, 1.05),
            (distance.MengerSponge(1.8, 4), BONE, 0.9),
            (distance.QuaternionJulia((-0.2, 0.6, 0.2, 0.2), 12).scaled(0.85).rotated((1, 0, 0), -35), VIOLET, 1.0),
            (tower, GREEN, 1.1),
        ],
        [(drop, GLASS, 0.2), (nut(), ORANGE, 0.35), (bowl, BLUE, 1.05), (beads, WHITE, 0.7)],
        [
            (star(), YELLOW, 0.72),
            (onion(), RED, 1.0),
            (bitten, GREEN, 0.6),
            (distance.Cone(0.2, 1.0, 0.05).repeated((0.45, 0.0, 0.45), (4, 1, 4)).offset(0.03), BONE, 0.53),
        ],
    ]


def main(target: str, small: bool = False) -> None:
    """Put them in rows on a ground, and look from above."""
    nodes = [
        limner.Node(
            parent_from_node=translate((column - (len(row) - 1) / 2) * STEP, height, k * ROW),
            shapes=(limner.Shape(DistanceField(field), (material,)),),
        )
        for k, row in enumerate(shapes())
        for column, (field, material, height) in enumerate(row)
    ]
    camera = limner.Camera.look_at((0, 12, 17), (0, 0.5, 3.0), yfov_degrees=26)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera).with_ground(limner.Lambert((0.4, 0.45, 0.5)))
    width, height, samples = (160, 100, 1) if small else (960, 600, 4)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(nodes)} fields")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "distance_fields.png", "--small" in sys.argv)
