"""Textures that are formulas (FoCG 11.5): checkers, stripes, noise, turbulence, marble, wood, and a solid that is carved from marble.

Each fills space, and a ball shows what it cuts through; none has texture coordinates.

    python examples/procedural_textures.py procedural_textures.png
"""

from __future__ import annotations

import sys

import limner
from limner.linear.transform import rotate, translate
from limner.scene.procedural import Checker, Gradient, Marble, Noise, Pattern, Stripes, Turbulence, Wood

STONE = ((0.92, 0.9, 0.86), (0.75, 0.72, 0.7), (0.2, 0.22, 0.28))
SKY = ((0.1, 0.25, 0.6), (0.35, 0.5, 0.8), (0.95, 0.95, 0.97))
FIRE = ((0.05, 0.0, 0.0), (0.7, 0.08, 0.0), (1.0, 0.6, 0.05), (1.0, 1.0, 0.7))

PATTERNS: list[Pattern] = [
    Checker(((0.8, 0.1, 0.08), (0.9, 0.88, 0.8)), scale=3.0),
    Stripes(((0.1, 0.3, 0.12), (0.9, 0.85, 0.5)), scale=3.0, axis=(1, 1, 0), share=0.4),
    Gradient(((0.1, 0.1, 0.5), (0.8, 0.2, 0.3), (1.0, 0.9, 0.5)), scale=0.5, offset=(0.5, 0, 0), axis=(0, 1, 0)),
    Noise(SKY, positions=(0.35, 0.5, 0.65), scale=2.5, octaves=6),
    Turbulence(FIRE, positions=(0.1, 0.4, 0.6, 0.8), scale=2.0),
    Marble(STONE, scale=1.5, axis=(1, 0.6, 0.2), amount=1.2),
    Wood(scale=(8.0, 2.0, 8.0), axis=(0.15, 1.0, 0.1), amount=0.6),
]


def polished(pattern: Pattern) -> limner.BlinnPhong:
    """The pattern under a clear highlight."""
    return limner.BlinnPhong(diffuse=(0.9, 0.9, 0.9), diffuse_texture=pattern, specular=(0.25, 0.25, 0.25), exponent=80)


def main(target: str, small: bool = False) -> None:
    """Balls in two rows, the last of them a block of marble with a ball taken out."""
    block = limner.Difference(limner.Box(1.5), limner.Solid(limner.Sphere(0.98)))
    shapes = [limner.Shape(limner.Sphere(0.9), (polished(pattern),)) for pattern in PATTERNS]
    shapes.append(limner.Shape(block, (polished(Marble(STONE, scale=1.2, axis=(0, 1, 0), amount=1.5)),)))
    nodes = [
        limner.Node(parent_from_node=translate((k % 4 - 1.5) * 2.1, 0.9, (k // 4) * 2.2) @ rotate((0, 1, 0), 0.4), shapes=(shape,))
        for k, shape in enumerate(shapes)
    ]
    camera = limner.Camera.look_at((0, 6.5, 11), (0, 0.6, 1.0), yfov_degrees=27.5)
    ground = limner.Lambert((1, 1, 1), texture=Checker(((0.35, 0.37, 0.4), (0.5, 0.52, 0.55)), scale=0.7, offset=(0, 0.5, 0)))
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera).with_ground(ground)
    width, height, samples = (192, 108, 1) if small else (960, 540, 8)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(shapes)} patterns")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "procedural_textures.png", "--small" in sys.argv)
