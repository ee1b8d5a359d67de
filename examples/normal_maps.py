"""Normal maps (FoCG 11.2): one plain box and one plain ball, dressed in a picture of normals; tangents say where its red and green point.

The map is made of heights, a wall of bricks: red and green are the slope along u and v. Below, the same map on a mesh whose texture runs
the other way round: MikkTSpace tangents turn with it, so that what stands out still stands out, lit from the upper left everywhere.

    python examples/normal_maps.py normal_maps.png
"""

from __future__ import annotations

import dataclasses
import sys

import numpy as np

import limner
from limner.linear.transform import rotate, translate
from limner.mesh.mesh import Mesh


def bricks(n: int = 128, courses: int = 8) -> np.ndarray:
    """(n, n) heights in [0, 1]: rounded bricks, every second course shifted by half of one."""
    v, u = np.meshgrid((np.arange(n) + 0.5) / n * courses, (np.arange(n) + 0.5) / n * courses / 2, indexing="ij")
    u = u + 0.5 * (np.floor(v) % 2)
    inside = [np.clip(np.minimum(w % 1.0, 1.0 - w % 1.0) * scale, 0.0, 1.0) for w, scale in ((u, 9.0), (v, 4.5))]
    return np.minimum(*inside) ** 0.5


def normals_of(heights: np.ndarray, steepness: float) -> limner.Texels:
    """A normal map as files have it: (x, y, z) of [-1, 1] as red, green, blue of 8 bits, row 0 on top."""
    down, right = np.gradient(np.pad(heights, 1, mode="wrap"))
    slopes = np.stack([-right[1:-1, 1:-1], down[1:-1, 1:-1], np.full(heights.shape, 1.0 / steepness)], axis=-1)
    unit = slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)
    codes = np.full((*heights.shape, 4), 255, dtype=np.uint8)
    codes[..., :3] = np.rint(127.5 * (unit + 1.0))
    return limner.Texels.from_top_down(codes, srgb=False, name="bricks")


def turned_about(mesh: Mesh) -> Mesh:
    """The same mesh, its texture mirrored."""
    return dataclasses.replace(mesh, uvs=mesh.uvs * np.float32([-1.0, 1.0]), tangents=None)


def scene() -> limner.Scene:
    """Plain, with the map, and with the map mirrored."""
    texture = limner.Texture(normals_of(bricks(), 6.0), scale=(2.0, 2.0))
    plain = limner.MetallicRoughness((0.62, 0.28, 0.2), 0.0, 0.45)
    walled = dataclasses.replace(plain, normal_texture=texture)
    ball, box = limner.primitives.uv_sphere(64, 32, 0.8), limner.primitives.box((0.95, 0.95, 0.95))
    nodes = []
    for k, (change, material) in enumerate(((None, plain), (None, walled), (turned_about, walled))):
        x = 2.1 * (k - 1)
        for mesh, at in ((ball, translate(x, 0.8, 0.0)), (box, translate(x + 0.05, 0.475, 1.75) @ rotate((0, 1, 0), 0.6))):
            shown = limner.with_tangents(mesh if change is None else change(mesh))
            nodes.append(limner.Node(parent_from_node=at, shapes=(limner.Shape(shown, (material,)),)))
    key = limner.Node(parent_from_node=translate(-3.5, 6.0, 6.5), lights=(limner.SphereLight((1.0, 0.95, 0.88), 230.0, 0.4, False),))
    fill = limner.Node(lights=(limner.AmbientLight((0.7, 0.8, 1.0), 0.5),))
    camera = limner.Camera.look_at((0.0, 4.4, 8.6), (0.0, 0.55, 0.75), yfov_degrees=24)
    return limner.Scene(limner.Node(children=(*nodes, key, fill)), camera).with_ground(limner.Lambert((0.5, 0.5, 0.52)))


def main(target: str, small: bool = False) -> None:
    """Six shapes in a row of three."""
    width, height, samples = (160, 96, 2) if small else (960, 560, 16)
    limner.render(scene(), width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: a ball and a box, plain, with a map of normals, and with the map mirrored")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "normal_maps.png", "--small" in sys.argv)
