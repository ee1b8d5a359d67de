"""Instancing (FoCG 13.2): a wood of two thousand trees in the memory of one.

A tree's triangles are stored once; each tree is a matrix that puts them somewhere. Rays are turned into the tree's own space instead of
the tree into the world's. Fog (FoCG 13.1) sets the far ones apart.

    python examples/instances.py instances.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import rotate_y, scale, translate
from limner.mesh.shapes import primitives


def tree() -> limner.Node:
    """A trunk and three skirts."""
    bark, green = limner.Lambert((0.2, 0.12, 0.07)), limner.Lambert((0.06, 0.22, 0.09))
    skirts = tuple(
        limner.Node(parent_from_node=translate(0.0, 0.75 + 0.5 * k, 0.0), shapes=(limner.Shape(mesh, green),))
        for k, mesh in enumerate(primitives.cone(0.62 - 0.15 * k, 0.9, 0.0) for k in range(3))
    )
    trunk = limner.Node(parent_from_node=translate(0.0, 0.25, 0.0), shapes=(limner.Shape(primitives.cylinder(0.09, 0.5), bark),))
    return limner.Node("tree", children=(trunk, *skirts))


def main(target: str, small: bool = False) -> None:
    """Scatter them over rolling ground."""
    n, width, height, samples = (60, 120, 68, 1) if small else (2000, 960, 540, 16)
    rng = np.random.default_rng(5)
    one, nodes = tree(), []
    for x, z, turn, size in rng.uniform((-26.0, -48.0, 0.0, 0.7), (26.0, 3.0, 6.3, 1.5), (n, 4)):
        height_there = 0.8 * np.sin(0.25 * x) * np.cos(0.2 * z)
        nodes.append(limner.Node("place", translate(x, height_there, z) @ rotate_y(turn) @ scale(size, size, size), children=(one,)))
    u, v = np.meshgrid(np.linspace(-60, 60, 90), np.linspace(-60, 60, 90))
    hills = primitives.heightfield(0.8 * np.sin(0.25 * u) * np.cos(0.2 * v), 120.0, 1.0)
    ground = limner.Node("ground", shapes=(limner.Shape(hills, limner.Lambert((0.28, 0.3, 0.16))),))
    sun = limner.Node(
        parent_from_node=rotate_y(1.1) @ np.array([[1, 0, 0, 0], [0, 0.8, 0.6, 0], [0, -0.6, 0.8, 0], [0, 0, 0, 1.0]]),
        lights=(limner.DirectionalLight((1.0, 0.86, 0.66), intensity=3.4),),
    )
    sky = limner.Node(lights=(limner.AmbientLight((0.55, 0.7, 1.0), intensity=0.35),))
    camera = limner.Camera.look_at((0.0, 4.6, 11.0), (0.0, 0.8, -8.0), yfov_degrees=34)
    mist = (0.62, 0.7, 0.8)
    scene = limner.Scene(
        limner.Node(children=(*nodes, ground, sun, sky)), camera, background=mist, fog=limner.Fog(mist, 0.022),
    )  # fmt: skip
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {n} trees of {sum(len(shape.geometry.triangles) for _, shape in limner.Scene(one).shapes())} triangles")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "instances.png", "--small" in sys.argv)
