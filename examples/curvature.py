"""How surfaces bend (FoCG 12.1): mean curvature above, Gaussian curvature below, as colours on a torus, a rounded box and a teapot.

Mean curvature is positive (red) where a surface bends away from its front, as a ball's does. Gaussian curvature is positive where it bends
to one side both ways, negative (blue) where it is a saddle, zero where paper could lie on it: the inner half of a torus is all saddle.

    python examples/curvature.py curvature.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import rotate, translate
from limner.mesh.examine.curvature import gaussian_curvature, mean_curvature
from limner.mesh.examine.measure import summary
from limner.mesh.mesh import Mesh


def meshes(small: bool) -> list[Mesh]:
    """Closed or nearly so, each about a metre large, without seams: vertices at one place are one."""
    n = 24 if small else 96
    shapes = limner.primitives
    made = (shapes.torus(0.55, 0.27, n, n // 2), shapes.superquadric(1.3, 0.35, 0.35, n, n // 2), shapes.teapot(n // 8, 0.75))
    return [limner.repair(mesh, orient=False)[0] for mesh in made]


def colored(mesh: Mesh, curvature: np.ndarray) -> limner.Shape:
    """The mesh by its numbers; grey where there are none, along a border."""
    most = float(np.nanpercentile(np.abs(curvature), 90)) or 1.0
    return limner.Shape(limner.color_by(mesh, curvature, "cool_warm", (-most, most)), (limner.Lambert((1.0, 1.0, 1.0)),))


def main(target: str, small: bool = False) -> None:
    """Three meshes, twice; their measures are printed."""
    nodes = []
    for k, mesh in enumerate(meshes(small)):
        print(f"{mesh.name}: {', '.join(f'{key} {value:.4g}' for key, value in summary(mesh).items() if isinstance(value, float))}")
        for row, measured in enumerate((mean_curvature(mesh), gaussian_curvature(mesh))):
            at = translate(2.05 * k - 2.05, -1.95 * row, 0.0) @ rotate((1, 0, 0), 0.6) @ rotate((0, 1, 0), 0.4)
            nodes.append(limner.Node(parent_from_node=at, shapes=(colored(mesh, measured),)))
    lamp = limner.Node(parent_from_node=rotate((1, 0, 0), -0.9) @ rotate((0, 1, 0), 0.4), lights=(limner.DirectionalLight(intensity=1.6),))
    sky = limner.Node(lights=(limner.AmbientLight(intensity=0.5),))
    camera = limner.OrthographicCamera.look_at((0.12, -0.8, 8.0), (0.12, -0.8, 0.0), height=4.1)
    scene = limner.Scene(limner.Node(children=(*nodes, lamp, sky)), camera, background=(1.0, 1.0, 1.0))
    width, height = (144, 92) if small else (960, 600)
    limner.render(scene, width=width, height=height).save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "curvature.png", "--small" in sys.argv)
