"""Point clouds and numbers (FoCG 12.1): a torus as a scanner sees it, three times.

Left, what the scanner measured: points without normals, as small spheres. In the middle the same points with normals, as discs that close
to a surface. Right, coloured by how far a number that was measured at each point lies from what was expected, with its key.

    python examples/point_cloud.py point_cloud.png
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

import limner
from limner.linear.transform import translate

N_POINTS = 20_000
MAJOR, MINOR = 1.0, 0.42


def scan(n: int, seed: int = 3) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Points of a torus, as dense everywhere, and their normals."""
    rng = np.random.default_rng(seed)
    u, v, lot = rng.random((3, 4 * n))
    u, v = 2 * np.pi * u, 2 * np.pi * v
    # A ring is as long as it is far from the axis: points on the inside are drawn less often.
    kept = lot * (MAJOR + MINOR) < MAJOR + MINOR * np.cos(v)
    u, v = u[kept][:n], v[kept][:n]
    normals = np.stack([np.cos(v) * np.cos(u), np.sin(v), np.cos(v) * np.sin(u)], axis=1)
    ring = np.stack([np.cos(u), np.zeros_like(u), np.sin(u)], axis=1)
    return (MAJOR * ring + MINOR * normals).astype(np.float32), normals.astype(np.float32)


def deviation(positions: NDArray[np.float32]) -> NDArray[np.float64]:
    """What was measured, less what was expected, in millimetres; a few points were not measured."""
    x, y, z = positions.T.astype(np.float64)
    found = 2.0 * np.sin(5 * np.arctan2(z, x)) * (0.4 + y)
    found[(x > 1.0) & (np.abs(z) < 0.2)] = np.nan
    return found


def main(target: str, small: bool = False) -> None:
    """Three clouds beside each other."""
    width, height = (192, 72) if small else (960, 360)
    positions, normals = scan(N_POINTS // 10 if small else N_POINTS)
    values = deviation(positions)
    ends = (-2.0, 2.0)
    plain = limner.PointCloud(positions, radii=0.012)
    closed = limner.PointCloud(positions, normals=normals)
    colored = limner.color_by(closed, values, "cool_warm", range=ends)
    clay, white = limner.Lambert((0.55, 0.42, 0.3)), limner.Lambert((1.0, 1.0, 1.0))
    shown = [limner.Shape(plain, clay), limner.Shape(closed, clay), limner.Shape(colored, white)]
    nodes = tuple(limner.Node(parent_from_node=translate(3.1 * k, 0, 0), shapes=(shape,)) for k, shape in enumerate(shown))
    camera = limner.Camera.look_at((3.55, 5.4, 7.4), (3.55, -0.1, 0), yfov_degrees=26)
    scene = limner.Scene(limner.Node(children=nodes), camera=camera, background=(0.9, 0.9, 0.9))
    image = limner.render(scene, width=width, height=height, samples=8)
    limner.with_color_bar(image, limner.ColorBar("cool_warm", ends, "deviation, mm")).save(target)
    print(f"{target}: 3 times {len(positions)} points")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "point_cloud.png", "--small" in sys.argv)
