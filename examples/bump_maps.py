"""Bump maps (FoCG 11.4): the same shapes smooth, dented by a picture's heights, wrinkled by noise, and stuccoed by three pictures at once.

The outlines stay round: it is the normals that are bent, as the height's slope says.

    python examples/bump_maps.py bump_maps.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import rotate, translate
from limner.scene.procedural import Noise, Turbulence
from limner.scene.texture import AnyTexture, Texels, Texture


def dents(n: int = 64) -> Texels:
    """Round dents in rows, as heights: floats, which show no steps."""
    x = (np.arange(n) + 0.5) / n * 4.0 % 1.0 - 0.5
    depth = np.maximum(0.0, 0.16 - (x[:, None] ** 2 + x[None, :] ** 2)).astype(np.float32)
    return Texels.from_top_down(-depth / 0.16, srgb=False, name="dents")


def stucco(n: int = 128) -> Texels:
    """Noise that tiles: a sum of waves with whole numbers of periods."""
    random = np.random.default_rng(7)
    x = np.arange(n) / n * 2.0 * np.pi
    height = np.zeros((n, n))
    for _ in range(60):
        fu, fv = random.integers(-12, 13, 2)
        height += np.sin(fu * x[None, :] + fv * x[:, None] + random.uniform(0, 2 * np.pi)) / (2.0 + np.hypot(fu, fv))
    return Texels.from_top_down(((height - height.min()) / np.ptp(height)).astype(np.float32), srgb=False, name="stucco")


def row() -> list[tuple[tuple[float, float, float], AnyTexture | None, float]]:
    """Colour, heights, and how high they are in metres."""
    return [
        ((0.7, 0.35, 0.15), None, 0.0),
        ((0.75, 0.6, 0.2), Texture(dents(), scale=(4.0, 2.0)), 0.06),
        ((0.25, 0.45, 0.3), Noise(scale=6.0, octaves=3), 0.12),
        ((0.5, 0.2, 0.3), Turbulence(scale=2.5, octaves=5), 0.15),
        ((0.55, 0.58, 0.65), Texture(stucco(), mapping="triplanar"), 0.15),
    ]


def main(target: str, small: bool = False) -> None:
    """A row of balls, and one of rings and boxes."""
    nodes = []
    for k, (color, heights, scale) in enumerate(row()):
        material = limner.BlinnPhong(diffuse=color, specular=(0.35, 0.35, 0.35), exponent=50, bump_texture=heights, bump_scale=scale)
        x = (k - 2) * 2.1
        other = limner.Torus(0.65, 0.28) if k % 2 == 0 else limner.Box(1.1)
        nodes.append(limner.Node(parent_from_node=translate(x, 0.9, 0), shapes=(limner.Shape(limner.Sphere(0.9), (material,)),)))
        turned = translate(x, 0.75, 2.2) @ rotate((0, 1, 0), 0.5) @ rotate((1, 0, 0), 0.9)
        nodes.append(limner.Node(parent_from_node=turned, shapes=(limner.Shape(other, (material,)),)))
    camera = limner.Camera.look_at((0, 5.5, 12), (0, 0.75, 1.0), yfov_degrees=29)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera).with_ground(limner.Lambert((0.45, 0.46, 0.5)))
    width, height, samples = (192, 96, 1) if small else (960, 480, 8)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(nodes)} shapes")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "bump_maps.png", "--small" in sys.argv)
