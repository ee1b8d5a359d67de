"""Texture coordinates by projection (FoCG 11.2.1): the same picture laid round three shapes from a centre, an axis, a plane and a box.

From left to right: sphere, cylinder, plane, box. The picture is a chart: u goes from red to yellow, v from dark to light, with a line at
every eighth and a thick one where the texture begins again.

    python examples/texture_projections.py texture_projections.png
"""

from __future__ import annotations

import sys
from typing import get_args

import numpy as np

import limner
from limner.linear.transform import in_order, rotate, translate
from limner.mesh.mesh import Mesh
from limner.mesh.projection import Projection, project_uvs
from limner.mesh.shapes import primitives


def chart(n: int = 512) -> limner.Texture:
    """Colours that tell u and v, with lines."""
    u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    rgb = np.stack([0.9 * np.ones_like(u), 0.15 + 0.7 * u, 0.15 * np.ones_like(u)], axis=-1) * (0.35 + 0.65 * v)[..., None]
    near_line = np.minimum(np.abs((8 * u + 0.5) % 1.0 - 0.5), np.abs((8 * v + 0.5) % 1.0 - 0.5)) < 0.05
    at_seam = np.minimum(np.minimum(u, 1.0 - u), np.minimum(v, 1.0 - v)) < 0.012
    rgb[near_line] = 0.95
    rgb[at_seam] = (0.05, 0.15, 0.5)
    pixels = np.concatenate([rgb, np.ones((n, n, 1))], axis=-1)
    return limner.Texture(limner.Texels(np.round(255.0 * pixels).astype(np.uint8)), filter="anisotropic")


def shapes() -> list[tuple[Mesh, np.ndarray]]:
    """A ball, a ring and a block, and how they stand."""
    return [
        (primitives.sphere(1.0, 48), np.eye(4)),
        (primitives.torus(0.75, 0.3, 96, 48), rotate((1, 0, 0), 0.5)),
        (primitives.box((1.4, 1.4, 1.4)), rotate((0, 1, 0), 0.5) @ rotate((1, 0, 0), 0.3)),
    ]


def main(target: str, small: bool = False) -> None:
    """A row for each shape, a column for each projection."""
    material = limner.Lambert((1.0, 1.0, 1.0), texture=chart())
    nodes = []
    for row, (mesh, place) in enumerate(shapes()):
        for column, onto in enumerate(get_args(Projection)):
            projected = project_uvs(mesh, onto, axis="z" if onto == "plane" else "y")
            where = in_order(place, translate(2.5 * (column - 1.5), 2.4 * (1 - row), 0.0))
            nodes.append(limner.Node(f"{onto} {row}", where, shapes=(limner.Shape(projected, (material,)),)))
    camera = limner.Camera.look_at((0, 1.5, 14), (0, 0, 0), yfov_degrees=32)
    sky = limner.Node(lights=(limner.AmbientLight(intensity=0.5), limner.DirectionalLight(intensity=2.0)))
    scene = limner.Scene(limner.Node(children=(*nodes, sky)), camera=camera, background=(0.85, 0.87, 0.9))
    width, height, samples = (240, 180, 2) if small else (960, 720, 8)
    limner.render(scene, width=width, height=height, samples=samples).save(target)
    print(f"{target}: {len(nodes)} projections")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "texture_projections.png", "--small" in sys.argv)
