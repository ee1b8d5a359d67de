"""What is wrong with this scene? The doctor names three faults that were planted; each is cured, and the pictures stand side by side.

    python examples/explain_doctor.py doctor.png
"""

from __future__ import annotations

import dataclasses
import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.explain.doctor import doctor
from limner.linear.transform import translate
from limner.mesh.normals import vertex_normals
from limner.mesh.shapes.primitives import uv_sphere

CLAY = limner.Lambert((0.75, 0.45, 0.3), double_sided=False)


def scene(mesh: limner.Mesh, intensity: float) -> limner.Scene:
    """A ball under a lamp."""
    ball = limner.Node("ball", shapes=(limner.Shape(mesh, (CLAY,)),))
    lamp = limner.Node("lamp", translate(2.0, 3.0, 3.0), lights=(limner.PointLight(intensity=intensity),))
    camera = limner.Camera.look_at((0, 0, 3.2), (0, 0, 0), yfov_degrees=45)
    return limner.Scene(limner.Node("world", children=(ball, lamp)), camera=camera, background=(0.8, 0.82, 0.85))


def main(target: str, small: bool = False) -> None:
    """Ask about each, and draw it with what was found."""
    ball = uv_sphere(36, 18)
    flat = dataclasses.replace(ball, normals=None, tangents=None)
    smooth = dataclasses.replace(flat, normals=vertex_normals(ball.positions, ball.triangles))
    turned = limner.Mesh(ball.positions, np.ascontiguousarray(ball.triangles[:, ::-1]), normals=-smooth.normals)
    cases = (scene(flat, 60.0), scene(turned, 60.0), scene(smooth, 0.05), scene(smooth, 60.0))
    width, height = (80, 60) if small else (320, 240)
    canvas = Canvas(2 * width, 2 * (height + 26), background="white")
    for k, case in enumerate(cases):
        found = doctor(case)
        x, y = (k % 2) * width, (k // 2) * (height + 26)
        canvas.paste(limner.render(case, width=width, height=height), x, y)
        canvas.text(x + 8, y + height + 18, ", ".join(found.kinds) or "nothing is wrong", "#222222", 15)
        print(found.text())
    canvas.image().save(target)
    print(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "doctor.png", "--small" in sys.argv)
