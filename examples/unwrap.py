"""Texture coordinates for a surface (FoCG 11.1): a torus knot's skin cut into charts and laid flat.

On the left the knot with a chessboard on it, whose squares stay square and alike because the charts are hardly distorted; on the right the
charts, coloured by what became of areas.

    python examples/unwrap.py unwrap.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.mesh.mesh import Mesh
from limner.mesh.unwrap.unwrap import uv_unwrap
from limner.produce.uv_chart import uv_chart
from limner.scene.texture import Texels, Texture


def knot(n_along: int = 240, n_around: int = 24, thickness: float = 0.38) -> Mesh:
    """The trefoil, as a tube."""
    t = 2.0 * math.pi * np.arange(n_along) / n_along
    center = np.stack([np.sin(t) + 2.0 * np.sin(2.0 * t), np.cos(t) - 2.0 * np.cos(2.0 * t), -np.sin(3.0 * t)], axis=1)
    tangent = np.roll(center, -1, axis=0) - np.roll(center, 1, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent, center)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    angle = 2.0 * math.pi * np.arange(n_around) / n_around
    ring = np.cos(angle)[:, None] * side[:, None] + np.sin(angle)[:, None] * np.cross(tangent, side)[:, None]
    points = (center[:, None] + thickness * ring).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n_along), np.arange(n_around), indexing="ij")
    a, b = n_around * i + j, n_around * i + (j + 1) % n_around
    d, c = n_around * ((i + 1) % n_along) + j, n_around * ((i + 1) % n_along) + (j + 1) % n_around
    triangles = np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)])
    normals = ring.reshape(-1, 3)
    return Mesh(points.astype(np.float32), triangles.astype(np.int32), normals=normals.astype(np.float32), name="trefoil")


def chessboard(n: int = 64) -> Texture:
    """n x n squares of 8 x 8 texels."""
    dark = (np.indices((8 * n, 8 * n)) // 8).sum(axis=0) % 2 == 1
    texels = np.full((8 * n, 8 * n, 4), 255, dtype=np.uint8)
    texels[dark] = (60, 110, 170, 255)
    return Texture(Texels(texels))


def main(target: str, small: bool = False) -> None:
    """Unwrap, draw both, and put them side by side."""
    size = 120 if small else 600
    mesh = uv_unwrap(knot(60, 8) if small else knot(), resolution=512)
    shape = limner.Shape(mesh, (limner.Lambert(texture=chessboard()),))
    camera = limner.Camera.look_at((0, 0, 9), (0, 0, 0), yfov_degrees=45)
    scene = limner.Scene(limner.Node(shapes=(shape,)), camera=camera, background=(1.0, 1.0, 1.0))
    picture = limner.render(scene, width=size, height=size + size // 12, samples=8)
    charts = uv_chart(mesh, show="area", size=size, limit=1.25).image()
    canvas = Canvas(2 * size, picture.height, background="white")
    canvas.paste(picture, 0, 0).paste(charts, size, 0).image().save(target)
    print(f"{target}: {len(mesh.triangles)} triangles")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "unwrap.png", "--small" in sys.argv)
