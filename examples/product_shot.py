"""A product shot: lacquer, velvet, brushed and coloured metal, glass and soap film under studio lights, by paths.

The materials are glTF's: a clear coat over red paint, sheen on cloth, anisotropy on steel, iridescence on a bubble, transmission through
glass with a colour of its own. A large softbox from the left, a strip from the right, a dim sky, and a backdrop without a horizon.

    python examples/product_shot.py shot.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import frame_from_gaze, rotate, translate
from limner.mesh.normals import vertex_normals

PAINT = limner.MetallicRoughness(base_color=(0.5, 0.015, 0.02), metallic=0.0, roughness=0.45, clearcoat=limner.Clearcoat(1.0, 0.03))
VELVET = limner.MetallicRoughness(base_color=(0.05, 0.03, 0.22), metallic=0.0, roughness=1.0, sheen=limner.Sheen((0.6, 0.55, 1.0), 0.35))
STEEL = limner.MetallicRoughness(base_color=(0.62, 0.6, 0.57), metallic=1.0, roughness=0.32, anisotropy=limner.Anisotropy(0.85))
GOLD = limner.MetallicRoughness(base_color=limner.metal_color("gold"), metallic=1.0, roughness=0.18)
GLASS = limner.Dielectric.with_color_at((0.55, 0.85, 0.75), 1.2, ior=1.5)
FILM = limner.MetallicRoughness(
    base_color=(0.02, 0.02, 0.02), metallic=0.0, roughness=0.08, iridescence=limner.Iridescence(1.0, 1.6, 380.0, 380.0), ior=1.8
)


def backdrop() -> limner.Mesh:
    """Paper that hangs from behind and curves onto the table."""
    turn = np.linspace(0.0, np.pi / 2.0, 24)
    curve = np.stack([-3.2 - 2.0 * np.sin(turn), 2.0 - 2.0 * np.cos(turn)], axis=1)
    profile = np.concatenate([[(9.0, 0.0)], curve, [(-5.2, 9.0)]])
    x = np.array([-14.0, 14.0])
    positions = np.array([(side, y, z) for z, y in profile for side in x], dtype=np.float32)
    rows = 2 * np.arange(len(profile) - 1)[:, None]
    triangles = np.concatenate([rows + np.array([0, 1, 3]), rows + np.array([0, 3, 2])]).astype(np.int32)
    return limner.Mesh(positions, triangles, normals=vertex_normals(positions, triangles))


def scene() -> limner.Scene:
    """The still life and its studio."""
    things = (
        (limner.primitives.teapot(14, 0.85), PAINT, translate(-0.25, 0.0, -0.35) @ rotate((0, 1, 0), 0.45)),
        (limner.Sphere(0.42), VELVET, translate(-1.75, 0.42, 0.35)),
        (limner.Cylinder(0.36, 0.9), STEEL, translate(1.62, 0.45, -0.5)),
        (limner.Torus(0.33, 0.13), GOLD, translate(0.62, 0.13, 1.0)),
        (limner.Sphere(0.34), GLASS, translate(1.5, 0.341, 0.75)),
        (limner.Sphere(0.28), FILM, translate(-0.72, 0.28, 1.12)),
    )
    nodes = [limner.Node(parent_from_node=place, shapes=(limner.Shape(geometry, paint),)) for geometry, paint, place in things]
    paper = limner.Lambert((0.42, 0.42, 0.44))
    nodes.append(limner.Node("paper", shapes=(limner.Shape(backdrop(), paper),)))
    lamps = (((-4.2, 4.6, 3.0), 2.6, 2.6, 9.0), ((4.6, 2.6, 1.6), 0.7, 3.0, 9.0))
    for place, width, height, power in lamps:
        frame = frame_from_gaze(place, tuple(-value for value in place), (0.0, 1.0, 0.0))
        nodes.append(limner.Node(parent_from_node=frame, lights=(limner.RectangleLight(intensity=power, width=width, height=height),)))
    sky = limner.Environment((0.16, 0.17, 0.19))
    camera = limner.Camera.look_at((0.25, 1.75, 6.2), (0.0, 0.5, 0.0), yfov_degrees=28)
    return limner.Scene(limner.Node(children=tuple(nodes)), camera, environment=sky, background="environment")


def main(target: str, small: bool = False) -> None:
    """Paths, and the noise that is left filtered out."""
    width, height, samples = (96, 54, 4) if small else (640, 360, 48)
    limner.render(scene(), width=width, height=height, renderer="path", samples=samples, denoise="filter").viewed("agx", 0.7).save(target)
    print(f"{target}: {samples} paths a pixel")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "shot.png", "--small" in sys.argv)
