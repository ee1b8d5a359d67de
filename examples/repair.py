"""A broken mesh and what `limner.repair` makes of it (FoCG 12.1.1).

Left: a torus torn into single triangles, a third of them turned over, a patch missing; smooth shading finds nothing to smooth. Middle:
welded and oriented, the hole still open. Right: the hole filled. What topology says of each is printed.

    python examples/repair.py repair.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import in_order, rotate, translate
from limner.mesh.examine.report import topology_report
from limner.mesh.normals import vertex_normals
from limner.mesh.repair.repair import repair
from limner.mesh.shapes.primitives import torus

APART = 3.1


def broken() -> limner.Mesh:
    """Triangles without a common vertex."""
    whole = torus(1.0, 0.4)
    corners = whole.positions[whole.triangles]
    middle = corners.mean(axis=1)
    kept = np.linalg.norm(middle - (0.9, 0.35, 0.5), axis=1) > 0.5
    corners = corners[kept]
    over = np.random.default_rng(3).random(len(corners)) < 0.33
    corners[over] = corners[over][:, ::-1]
    return limner.Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), name="broken")


def smooth(mesh: limner.Mesh) -> limner.Mesh:
    """The same with one normal per vertex."""
    return limner.Mesh(mesh.positions, mesh.triangles, normals=vertex_normals(mesh.positions, mesh.triangles), name=mesh.name)


def main(target: str, small: bool = False) -> None:
    """Repair in two steps, and show all three side by side."""
    torn = broken()
    sewn, first = repair(torn)
    whole, second = repair(sewn, fill_holes=True)
    for mesh, done in ((torn, "as it was"), (sewn, first), (whole, second)):
        print(topology_report(mesh), f"  ({', '.join(str(done).splitlines())})", sep="\n")
    clay = limner.BlinnPhong(diffuse=(0.75, 0.45, 0.3), specular=(0.2, 0.2, 0.2), exponent=40, double_sided=False)
    lean = rotate((1, 0, 0), 0.9)
    nodes = [
        limner.Node(parent_from_node=in_order(lean, translate(x, 0, 0)), shapes=(limner.Shape(smooth(mesh), (clay,)),))
        for x, mesh in ((-APART, torn), (0.0, sewn), (APART, whole))
    ]
    camera = limner.Camera.look_at((0, 1.5, 12), (0, -0.1, 0), yfov_degrees=20)
    scene = limner.Scene(limner.Node(children=tuple(nodes)), camera=camera, background=(0.9, 0.9, 0.9))
    width, height, samples = (240, 85, 2) if small else (960, 340, 8)
    limner.render(scene, width=width, height=height, samples=samples).save(target)
    print(f"{target}: {first.welded_vertices} vertices welded, {second.filled_holes} hole filled")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "repair.png", "--small" in sys.argv)
