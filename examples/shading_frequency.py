"""Where is a colour computed? (FoCG 8.2.4, 8.2.5, 10.1.3, 10.2.2): for each triangle, each vertex, or each fragment.

A coarse ball of 96 triangles above, a fine one of 4,000 below. At the vertices (Gouraud), a highlight between them is lost, or is
stretched into a star; the normal that is interpolated (Phong) finds it. On fine meshes all agree.

    python examples/shading_frequency.py frequency.png
"""

from __future__ import annotations

import sys

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import rotate

SHADINGS = {"flat": "once a triangle", "vertex": "at the vertices (Gouraud)", "fragment": "at every fragment (Phong)"}


def scene(columns: int, rows: int) -> limner.Scene:
    """A ball with a highlight."""
    gloss = limner.BlinnPhong(diffuse=(0.12, 0.3, 0.55), specular=(0.7, 0.7, 0.7), exponent=40)
    ball = limner.Shape(limner.primitives.uv_sphere(columns, rows), gloss)
    sun = limner.Node(parent_from_node=rotate((0, 1, 0), 0.6) @ rotate((1, 0, 0), -0.7), lights=(limner.DirectionalLight(intensity=2.6),))
    air = limner.Node(lights=(limner.AmbientLight(intensity=0.2),))
    camera = limner.Camera.look_at((0, 0.9, 4.3), (0, 0, 0), yfov_degrees=30)
    return limner.Scene(limner.Node(children=(limner.Node(shapes=(ball,)), sun, air)), camera, background=(0.93, 0.93, 0.94))


def main(target: str, small: bool = False) -> None:
    """Two balls, three frequencies."""
    side = 64 if small else 300
    sheet = Canvas(3 * side, 2 * side, "white")
    for row, (columns, rows) in enumerate(((12, 5), (48, 42))):
        for column, (shading, words) in enumerate(SHADINGS.items()):
            sheet.paste(limner.render(scene(columns, rows), width=side, height=side, shading=shading), column * side, row * side)
            if row == 0:
                sheet.text((column + 0.5) * side, 22, words, "#222222", 15, "center")
    sheet.image().save(target)
    print(f"{target}: {', '.join(SHADINGS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "frequency.png", "--small" in sys.argv)
