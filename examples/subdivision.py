"""Smooth surfaces from coarse meshes (FoCG 12.1, 15): three schemes of subdivision, step by step, and creases.

Rows from the back: Catmull and Clark from a chair of cubes (after one step, two, three, and the limit), Loop from an icosahedron with
spikes and Kobbelt's root of three from a torus of few triangles (the coarse mesh, one step, two, the limit). In front a cube by Catmull
and Clark, its lower and its upper square creased for 0, 1, 2 and all steps.

    python examples/subdivision.py subdivision.png
"""

from __future__ import annotations

import dataclasses
import math
import sys

import numpy as np

import limner
from limner.linear.transform import in_order, rotate, translate
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.subdivide import catmull_clark, loop, sqrt3

COLORS = ((0.75, 0.35, 0.1), (0.15, 0.45, 0.6), (0.5, 0.55, 0.15), (0.6, 0.15, 0.2))


def voxels(cells: list[tuple[int, int, int]]) -> tuple[np.ndarray, list[list[int]]]:
    """The outer faces of unit cubes, as quadrilaterals over shared corners."""
    solid = set(cells)
    corners: dict[tuple[int, int, int], int] = {}
    faces = []
    for cell in cells:
        for axis in range(3):
            for side in (0, 1):
                beside = list(cell)
                beside[axis] += 2 * side - 1
                if tuple(beside) in solid:
                    continue
                around = [(0, 0), (1, 0), (1, 1), (0, 1)]
                face = []
                for u, v in around if side else around[::-1]:
                    corner = list(cell)
                    corner[axis] += side
                    corner[(axis + 1) % 3] += u
                    corner[(axis + 2) % 3] += v
                    face.append(corners.setdefault((corner[0], corner[1], corner[2]), len(corners)))
                faces.append(face)
    return np.array(list(corners), dtype=float), faces


def chair() -> tuple[np.ndarray, list[list[int]]]:
    """Four legs, a seat and a back."""
    legs = [(x, 0, z) for x in (0, 2) for z in (0, 2)]
    seat = [(x, 1, z) for x in range(3) for z in range(3)]
    back = [(x, y, 0) for x in range(3) for y in (2, 3)]
    points, faces = voxels([*legs, *seat, *back])
    return (points - (1.5, 2.0, 1.5)) * 0.5, faces


def spiked() -> Mesh:
    """An icosahedron whose faces are drawn out."""
    mesh = loop(primitives.icosahedron(), 1)
    reach = np.where(np.arange(len(mesh.positions)) < 12, 2.0, 0.75)
    return Mesh((mesh.positions * reach[:, None] * 0.62).astype(np.float32), mesh.triangles)


def flat(mesh: Mesh) -> Mesh:
    """Without smooth normals, to show its triangles."""
    return dataclasses.replace(mesh, normals=None, normal_triangles=None)


def rows(small: bool) -> list[list[Mesh]]:
    """What is shown, from the back to the front."""
    fine = 2 if small else 5
    seat, ball, ring = chair(), spiked(), primitives.torus(0.75, 0.35, 6, 4)
    box = primitives.box(1.5)
    squares = [(0, 1), (1, 5), (5, 4), (4, 0), (2, 3), (3, 7), (7, 6), (6, 2)]
    return [
        [flat(catmull_clark(seat, 1)), flat(catmull_clark(seat, 2)), flat(catmull_clark(seat, 3)),
         catmull_clark(seat, fine - 1, limit=True)],
        [flat(ball), flat(loop(ball, 1)), flat(loop(ball, 2)), loop(ball, fine, limit=True)],
        [flat(ring), flat(sqrt3(ring, 1)), flat(sqrt3(ring, 2)), sqrt3(ring, fine + 1, limit=True)],
        [catmull_clark(box, fine, creases=squares, sharpness=s, limit=True) for s in (0.0, 1.0, 2.0, math.inf)],
    ]


def main(target: str, small: bool = False) -> None:
    """Put them in rows on a ground, and look from above."""
    nodes = []
    for k, row in enumerate(rows(small)):
        paint = limner.BlinnPhong(diffuse=COLORS[k], specular=(0.2, 0.2, 0.2), exponent=50)
        for column, mesh in enumerate(row):
            turned = rotate((0, 1, 0), 0.5)
            place = in_order(turned, translate((column - 1.5) * 2.9, -mesh.bounds[0, 1], 3.2 * k))
            nodes.append(limner.Node(parent_from_node=place, shapes=(limner.Shape(mesh, (paint,)),)))
    camera = limner.Camera.look_at((0, 16, 20), (0, 0, 4.7), yfov_degrees=28)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera).with_ground(limner.Lambert((0.42, 0.44, 0.47)))
    width, height, samples = (150, 120, 1) if small else (1000, 800, 8)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(nodes)} meshes")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "subdivision.png", "--small" in sys.argv)
