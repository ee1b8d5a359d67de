"""Surfaces that curves make (FoCG 15): a trefoil's tube, a twisted ribbon, a spring, a wave of B-splines, a Bézier triangle, the teapot.

    python examples/curve_surfaces.py curves.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.curves import surface, sweep, teapot, tessellate
from limner.curves.curve import Parametric
from limner.curves.patch import Tessellation
from limner.curves.triangle_patch import indices
from limner.linear.transform import in_order, rotate, scale, translate
from limner.mesh.shapes.tube import tube


def paint(r: float, g: float, b: float) -> limner.BlinnPhong:
    """A colour with a highlight."""
    return limner.BlinnPhong(diffuse=(r, g, b), specular=(0.3, 0.3, 0.3), exponent=60)


def mesh(made: Tessellation, name: str) -> limner.Mesh:
    """A mesh of a tessellation."""
    positions, normals, uvs = (array.astype(np.float32) for array in (made.positions, made.normals, made.uvs))
    return limner.Mesh(positions, made.triangles, normals=normals, uvs=uvs, name=name)


def trefoil() -> Parametric:
    """A knot."""

    def at(t: np.ndarray) -> np.ndarray:
        return np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=-1)

    return Parametric(at, 0.0, 2.0 * math.pi)


def spring() -> Parametric:
    """A coil about +y that narrows."""

    def at(t: np.ndarray) -> np.ndarray:
        radius = 1.0 - 0.1 * t / math.pi
        return np.stack([radius * np.cos(2 * t), 0.12 * t, radius * np.sin(2 * t)], axis=-1)

    return Parametric(at, 0.0, 5.0 * math.pi)


def gear() -> np.ndarray:
    """A profile with six teeth, closed."""
    angle = np.linspace(0.0, 2.0 * math.pi, 97)
    radius = 0.2 + 0.05 * np.cos(6.0 * angle)
    outline = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    outline[-1] = outline[0]
    return outline


def wave() -> Tessellation:
    """A sheet of five by five control points, as its Bézier patches, cut without cracks."""
    x, z = np.meshgrid(np.linspace(-1.2, 1.2, 5), np.linspace(1.2, -1.2, 5))
    net = np.stack([x, 0.9 * np.cos(2.5 * x) * np.sin(2.0 * z), z], axis=-1)
    return tessellate.tessellated(surface.bspline_patches(net).reshape(-1, 4, 4, 3), 0.002)


def sail() -> Tessellation:
    """A Bézier triangle of degree 3, its middle blown out."""
    corners = np.array([[0.0, 2.0, 0.0], [-1.1, 0.0, 0.2], [1.1, 0.0, 0.2]])
    net = indices(3) / 3.0 @ corners
    net[4] += (0.0, 0.2, 2.2)
    return tessellate.tessellated_triangle(net, 24)


def main(target: str, small: bool = False) -> None:
    """Put them in two rows on a ground, and look from above."""
    closed = sweep.along(trefoil(), 0.01)
    pot = tessellate.tessellated(teapot.patches(), 0.004)
    upright = rotate((1, 0, 0), -math.pi / 2)
    shown = [
        (tube(closed[:-1], 0.32, 24, closed=True), paint(0.7, 0.12, 0.08), in_order(scale(0.42, 0.42, 0.42), translate(-2.9, 1.35, -1.6))),
        (
            mesh(sweep.swept(spring(), gear(), 400, twist=8 * math.pi), "spring"), paint(0.65, 0.45, 0.1),
            in_order(scale(0.9, 0.9, 0.9), translate(0, 0.3, -1.8)),
        ),
        (mesh(sail(), "sail"), paint(0.75, 0.75, 0.7), translate(2.9, 0.05, -1.6)),
        (mesh(wave(), "wave"), paint(0.1, 0.35, 0.65), translate(-2.8, 0.6, 1.5)),
        (mesh(pot, "teapot"), paint(0.15, 0.5, 0.2), in_order(upright, scale(0.5, 0.5, 0.5), translate(0, 0, 1.5))),
        (
            mesh(sweep.ribbon(trefoil(), 0.7, 300, closed=True), "ribbon"), paint(0.5, 0.12, 0.6),
            in_order(upright, scale(0.42, 0.42, 0.42), translate(2.9, 0.75, 1.6)),
        ),
    ]  # fmt: skip
    nodes = tuple(limner.Node(parent_from_node=place, shapes=(limner.Shape(geometry, (material,)),)) for geometry, material, place in shown)
    camera = limner.Camera.look_at((0, 6.0, 11), (0, 0.6, 0.1), yfov_degrees=32)
    scene = limner.Scene(limner.Node(children=nodes), camera=camera).with_ground(limner.Lambert((0.4, 0.45, 0.5)))
    width, height, samples = (160, 100, 1) if small else (960, 600, 8)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(nodes)} surfaces, the teapot in {len(pot.triangles)} triangles")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "curve_surfaces.png", "--small" in sys.argv)
