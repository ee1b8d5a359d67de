"""Colour that was measured (FoCG 19): metals by their index of refraction, lamps by their temperature.

Five balls of silver, aluminium, gold, copper and iron between a candle's warm light on the left and the sky's cold light on the right;
white walls show both.

    python examples/color_lights.py lights.png
"""

from __future__ import annotations

import sys

import limner
from limner.color.light import light_color
from limner.color.metals import metal_color
from limner.linear.transform import translate

METALS = ("silver", "aluminium", "gold", "copper", "iron")
WARM, COLD = 1900.0, 9000.0  # kelvin


def metal(name: str) -> limner.MetallicRoughness:
    """A polished metal of its own colour."""
    return limner.MetallicRoughness(base_color=metal_color(name), metallic=1.0, roughness=0.15)


def main(target: str, small: bool = False) -> None:
    """Stand them in a row before a wall, a lamp at each end."""
    balls = [
        limner.Node(
            parent_from_node=translate(1.15 * (k - 2), 0.5, 0),
            shapes=(limner.Shape(limner.Sphere(0.5), (metal(name),)),),
        )
        for k, name in enumerate(METALS)
    ]
    white = limner.Lambert((0.75, 0.75, 0.75))
    walls = [
        limner.Node(parent_from_node=translate(0, 4, z), shapes=(limner.Shape(limner.Box((16, 8, 0.2)), (white,)),)) for z in (-1.5, 9.0)
    ]
    lamps = [
        limner.Node(parent_from_node=translate(side * 3.4, 2.2, 1.2), lights=(limner.PointLight(color=light_color(kelvin), intensity=12),))
        for side, kelvin in ((-1, WARM), (1, COLD))
    ]
    camera = limner.Camera.look_at((0, 1.5, 6.4), (0, 0.75, 0), yfov_degrees=30)
    rest = limner.Node(lights=(limner.AmbientLight(intensity=0.12),))
    root = limner.Node(children=(*balls, *walls, *lamps, rest))
    scene = limner.Scene(root, camera=camera, background=(0.45, 0.45, 0.45)).with_ground(white)
    width, height, samples = (192, 96, 2) if small else (960, 480, 16)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples, glossy=True).save(target)
    print(f"{target}: {', '.join(METALS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "color_lights.png", "--small" in sys.argv)
