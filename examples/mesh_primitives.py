"""Meshes that are made, not loaded (FoCG 12.1, 22): primitives, implicit surfaces, and solids cut out of solids where that is installed.

Behind: the five regular solids, a teapot. Then: spheres by meridians and by triangles, superquadrics from square to pinched, a capsule.
Then: what is turned, extruded or swept. In front: a landscape, implicit surfaces, a box and a ball and what is left of one without the
other.

    python examples/mesh_primitives.py mesh_primitives.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.linear.transform import translate
from limner.mesh.implicit.marching_cubes import marching_cubes
from limner.mesh.mesh import Mesh
from limner.mesh.reshape.boolean import boolean
from limner.mesh.shapes import primitives

STEP = 2.4  # from shape to shape
COLORS = ((0.7, 0.1, 0.08), (0.8, 0.4, 0.1), (0.7, 0.6, 0.1), (0.1, 0.5, 0.15), (0.1, 0.2, 0.7), (0.5, 0.1, 0.6))


def goblet() -> Mesh:
    """A profile turned: foot, stem and cup, with a sharp rim and a smooth belly."""
    t = np.linspace(0.0, 1.0, 24)
    cup = np.stack([0.15 + 0.6 * np.sin(0.5 * math.pi * t) ** 0.8, 0.9 + 1.1 * t], axis=1)
    inside = cup[::-1] - (0.06, 0.0)
    inside[-1] = (0.0, 0.96)
    return primitives.revolution(np.concatenate([[(0.0, 0.0), (0.6, 0.0), (0.6, 0.06), (0.12, 0.14), (0.09, 0.8)], cup, inside]), 96)


def gear() -> Mesh:
    """An outline with holes, extruded."""
    teeth = 14
    angle = 2.0 * math.pi * (np.repeat(np.arange(teeth), 4) + np.tile([0.0, 0.25, 0.45, 0.8], teeth)) / teeth
    radius = np.tile([0.95, 0.95, 0.75, 0.75], teeth)
    turn = 2.0 * math.pi * np.arange(48) / 48

    def circle(r: float, x: float = 0.0, y: float = 0.0) -> np.ndarray:
        return np.stack([x + r * np.cos(turn), y + r * np.sin(turn)], axis=1)

    holes = [circle(0.15), *(circle(0.14, 0.45 * math.cos(a), 0.45 * math.sin(a)) for a in 2.0 * math.pi * np.arange(5) / 5)]
    return primitives.extrusion(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1), 0.4, holes)


def knot() -> Mesh:
    """A trefoil: a closed tube without a twist where it closes."""
    s = 2.0 * math.pi * np.arange(200) / 200
    line = np.stack([np.sin(s) + 2.0 * np.sin(2.0 * s), np.cos(s) - 2.0 * np.cos(2.0 * s), -np.sin(3.0 * s)], axis=1)
    return primitives.tube(0.3 * line, 0.16, 24, closed=True)


def spring() -> Mesh:
    """An open tube with round ends."""
    s = np.linspace(0.0, 8.0 * math.pi, 300)
    return primitives.tube(np.stack([0.7 * np.cos(s), 0.055 * s, 0.7 * np.sin(s)], axis=1), 0.1, 20)


def landscape() -> Mesh:
    """Heights over a square: waves that cross."""
    x, z = np.meshgrid(np.linspace(-3.0, 3.0, 80), np.linspace(-3.0, 3.0, 80))
    return primitives.heightfield(np.sin(2.0 * x + z) + np.cos(1.5 * z - x) + 0.5 * np.sin(4.0 * x), 1.9, 0.16)


def gyroid(n: int) -> Mesh:
    """A slice of the gyroid, one unit thick, cut to a cube by the box that it is looked for in."""
    def field(p: np.ndarray) -> np.ndarray:
        x, y, z = 2.0 * math.pi * p.T
        return np.abs(np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)) - 0.35

    return marching_cubes(field, [(-0.8, -0.8, -0.8), (0.8, 0.8, 0.8)], n, capped=True)


def drops(n: int) -> Mesh:
    """Metaballs (Blinn 1982): densities that flow together, solid where they are high."""
    middles = np.array([(0.0, 0.0, 0.0), (0.55, 0.35, 0.1), (-0.5, 0.3, 0.2), (0.0, 0.75, -0.2), (0.05, -0.35, 0.45)])

    def density(p: np.ndarray) -> np.ndarray:
        return np.exp(-9.0 * ((p[:, None] - middles) ** 2).sum(axis=2)).sum(axis=1)

    return marching_cubes(density, [(-1.3, -1.2, -1.0), (1.3, 1.4, 1.2)], n, level=0.35, inside="above")


def rows(small: bool) -> list[list[Mesh]]:
    """All meshes, from the back to the front."""
    front = [landscape(), gyroid(20 if small else 80), drops(16 if small else 64), primitives.torus(0.75, 0.28, 96, 48)]
    try:
        front += [boolean("difference", primitives.box(1.5), primitives.sphere(0.98, 8 if small else 64), materials="operand")]
        front += [boolean("intersection", primitives.box(1.5), primitives.sphere(0.98, 8 if small else 64), materials="operand")]
    except limner.UnsupportedError as error:
        print(error)
    return [
        [
            primitives.tetrahedron(), primitives.cube(), primitives.octahedron(), primitives.dodecahedron(), primitives.icosahedron(),
            primitives.teapot(16, 0.6),
        ],
        [
            primitives.uv_sphere(24, 12, 0.9), primitives.icosphere(0.9, 3), primitives.superquadric(1.7, 0.25, 0.25),
            primitives.superquadric(1.9, 0.3, 1.0), primitives.superquadric(2.0, 2.5, 2.5, 96, 64), primitives.capsule(0.45, 0.9),
        ],
        [goblet(), gear(), knot(), spring(), primitives.cone(0.9, 1.6, 0.3), primitives.cylinder(0.7, 1.5)],
        front,
    ]  # fmt: skip


def main(target: str, small: bool = False) -> None:
    """Put them in rows on a ground, and look from above."""
    nodes = []
    for k, row in enumerate(rows(small)):
        for column, mesh in enumerate(row):
            paints = tuple(
                limner.BlinnPhong(diffuse=COLORS[(k + column + more) % len(COLORS)], specular=(0.25, 0.25, 0.25), exponent=60)
                for more in (0, 2)
            )
            place = translate((column - (len(row) - 1) / 2) * STEP, -mesh.bounds[0, 1], 3.3 * k)
            nodes.append(limner.Node(parent_from_node=place, shapes=(limner.Shape(mesh, paints),)))
    camera = limner.Camera.look_at((0, 17, 21), (0, 0, 5.0), yfov_degrees=30)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera).with_ground(limner.Lambert((0.4, 0.45, 0.5)))
    width, height, samples = (150, 100, 1) if small else (1200, 800, 8)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(nodes)} meshes")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "mesh_primitives.png", "--small" in sys.argv)
