"""What glTF's materials can do, one step at a time: roughness, metal, clear coat, sheen, iridescence, anisotropy.

Each row changes one number from left to right, in a room of large lamps: ray traced with glossy reflections, and filtered.

    python examples/material_chart.py materials.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import translate

STEPS = np.linspace(0.0, 1.0, 6)
BLUE = {"base_color": (0.05, 0.16, 0.45), "metallic": 0.0, "roughness": 0.5}
RED = {"base_color": (0.42, 0.03, 0.03), "metallic": 0.0, "roughness": 0.6}
ROWS = {
    "roughness": lambda t: limner.MetallicRoughness(base_color=(0.9, 0.62, 0.3), metallic=1.0, roughness=0.05 + 0.95 * t),
    "metallic": lambda t: limner.MetallicRoughness(base_color=(0.75, 0.32, 0.2), metallic=float(t), roughness=0.25),
    "clear coat": lambda t: limner.MetallicRoughness(**RED, clearcoat=limner.Clearcoat(float(t), 0.05)),
    "sheen": lambda t: limner.MetallicRoughness(**BLUE, sheen=limner.Sheen((float(t),) * 3, 0.4)),
    "iridescence": lambda t: limner.MetallicRoughness(
        base_color=(0.5, 0.5, 0.5), metallic=1.0, roughness=0.12, iridescence=limner.Iridescence(1.0, 1.5, 200 + 400 * t, 200 + 400 * t)
    ),
    "anisotropy": lambda t: limner.MetallicRoughness(
        base_color=(0.75, 0.75, 0.77), metallic=1.0, roughness=0.35, anisotropy=limner.Anisotropy(float(t))
    ),
}


def room() -> limner.Environment:
    """Dim walls, a softbox on either side, a bright ceiling panel: (64, 128, 3) light, row 0 on top."""
    light = np.full((64, 128, 3), 0.22, dtype=np.float32)
    light[:32] += 0.12
    light[14:30, 20:40] = (6.0, 5.6, 5.0)
    light[16:28, 84:92] = (4.0, 4.6, 5.6)
    light[4:9, 44:76] = 3.0
    return limner.Environment(light)


def main(target: str, small: bool = False) -> None:
    """Six rows of six balls."""
    ball = limner.primitives.sphere(0.5, 8 if small else 24)
    nodes = [
        limner.Node(parent_from_node=translate(1.1 * (k - 2.5), 1.1 * (2.5 - row), 0.0), shapes=(limner.Shape(ball, material(t)),))
        for row, material in enumerate(ROWS.values())
        for k, t in enumerate(STEPS)
    ]
    camera = limner.OrthographicCamera.look_at((0, 0, 10), (0, 0, 0), height=6.7)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera, (0.2, 0.21, 0.23), environment=room())
    side, samples = (96, 1) if small else (720, 16)
    image = limner.render(
        scene, width=side, height=side, renderer="ray", samples=samples, sampler="multijittered", glossy=True, denoise="filter"
    )
    sheet = Canvas(side, side + 10, "#7a7c80").paste(image, 0, 10)
    for row, words in enumerate(ROWS):
        sheet.text(side / 2, 16 + (row + 0.06) * 1.1 / 6.7 * side, words, "white", 14, "center")
    sheet.image().save(target)
    print(f"{target}: {', '.join(ROWS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "materials.png", "--small" in sys.argv)
