"""The furnace (FoCG 18, 23): balls of every albedo in an evenly lit room; what loses no light vanishes.

In a white room of radiance 1, a surface that reflects all light shows 1 everywhere and cannot be told from the room. Above, Lambert's
balls of albedo 1, 0.8 and 0.5, each of which must show just its albedo, as closed form says; below, clear glass, a perfect mirror, and
metal at its roughest, which is dark: light that its facets scatter a second time is left out of the formula, two thirds of it.

    python examples/furnace.py furnace.png
"""

from __future__ import annotations

import sys

import limner
from limner.draw.canvas import Canvas

BALLS = {
    "albedo 1": limner.Lambert((1.0, 1.0, 1.0)),
    "albedo 0.8": limner.Lambert((0.8, 0.8, 0.8)),
    "albedo 0.5": limner.Lambert((0.5, 0.5, 0.5)),
    "glass": limner.Dielectric(1.5),
    "mirror": limner.BlinnPhong(diffuse=(0, 0, 0), mirror=(1.0, 1.0, 1.0)),
    "metal, roughness 1": limner.MetallicRoughness(metallic=1.0, roughness=1.0),
}


def main(target: str, small: bool = False) -> None:
    """Six balls, and what the middle of each shows."""
    side, samples = (32, 16) if small else (240, 256)
    camera = limner.Camera.look_at((0, 0, 5), (0, 0, 0), yfov_degrees=32)
    sheet = Canvas(3 * side, 2 * side, "white")
    for k, (name, material) in enumerate(BALLS.items()):
        root = limner.Node(shapes=(limner.Shape(limner.Sphere(1.0), material),))
        room = limner.Scene(root, camera, background="environment", environment=limner.Environment((1.0, 1.0, 1.0)))
        image = limner.render(room, width=side, height=side, renderer="path", samples=samples, max_depth=16)
        middle = image.pixels[side * 2 // 5 : side * 3 // 5, side * 2 // 5 : side * 3 // 5, :3].mean()
        x, y = k % 3 * side, k // 3 * side
        sheet.paste(limner.Image(image.pixels.clip(0.0, 1.0)), x, y)
        sheet.text(x + side / 2, y + side - 10, f"{name}: {middle:.3f}", "#c03020", 15, "center")
        print(f"{name}: {middle:.4f}")
    sheet.image().save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "furnace.png", "--small" in sys.argv)
