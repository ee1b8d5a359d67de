"""With trimesh: its meshes in, rays for its questions, and a mesh of limner's out again.

A mesh that trimesh made is rendered as it is. How thick is it? From every vertex a ray goes inwards to the other side (RayCaster), and
the answer is shown in colours. The scene then goes back to trimesh, which measures it. Needs `pip install trimesh`; says so where it is
missing.

    python examples/trimesh_interop.py thickness.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner


def thickness(positions: np.ndarray, triangles: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(n,): how far it is through the solid from each vertex, straight inwards."""
    caster = limner.RayCaster(positions, triangles)
    inwards = -normals
    hits = caster.intersect(positions + 1e-4 * inwards, inwards)
    return np.where(np.isfinite(hits.t), hits.t, np.nan)


def main(target: str, small: bool = False) -> None:
    """A dumb-bell on its end, thin where it is blue."""
    try:
        import trimesh
    except ImportError:
        print("this example needs trimesh: pip install trimesh")
        return
    angle = np.linspace(0.0, np.pi, 48 if small else 160)
    radius = 0.16 + 0.5 * np.abs(np.cos(angle)) ** 3 * np.sin(angle) ** 0.5 * 2.0
    outline = np.stack([radius * np.sin(angle) ** 0.25, -1.4 * np.cos(angle)], axis=1)
    outline[[0, -1], 0] = 0.0
    turned = trimesh.creation.revolve(outline, sections=24 if small else 96)
    deep = thickness(turned.vertices, turned.faces, turned.vertex_normals)
    ends = (0.0, float(np.nanpercentile(deep, 85)))
    mesh = limner.Mesh(turned.vertices.astype(np.float32), turned.faces.astype(np.int32), normals=turned.vertex_normals.astype(np.float32))
    shown = limner.color_by(mesh, deep, "turbo", range=ends)
    camera = limner.Camera.look_at((3.4, -3.6, 1.4), (0, 0, 0), up=(0, 0, 1), yfov_degrees=37)
    root = limner.Node(shapes=(limner.Shape(shown, limner.Lambert((1.0, 1.0, 1.0))),))
    width, height = (120, 80) if small else (840, 560)
    scene = limner.Scene(root, camera, background=(0.92, 0.92, 0.93))
    image = limner.render(scene, width=width, height=height)
    limner.with_color_bar(image, limner.ColorBar("turbo", ends, "thickness, m")).save(target)
    back = limner.to_trimesh(scene)
    print(f"{target}: {len(turned.faces)} triangles of {turned.area:.3f} square metres; what comes back has {back.area:.3f}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "thickness.png", "--small" in sys.argv)
