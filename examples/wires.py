"""Lines as geometry: the paths of Lorenz's equations as one wire of glass beads' colours, that throws shadows and is seen by rays.

Eight starts that are nearly the same part company; colour is time. A `LineSet` becomes tubes, so every renderer knows how to light it.

    python examples/wires.py wires.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear.transform import frame_from_gaze


def lorenz(start: np.ndarray, n: int, step: float = 0.006) -> np.ndarray:
    """(n, k, 3) points of k paths: x' = 10 (y - x), y' = x (28 - z) - y, z' = x y - 8/3 z, by the midpoint rule.

    **Source**: Lorenz, *Deterministic nonperiodic flow*, 1963.
    """

    def flow(p: np.ndarray) -> np.ndarray:
        x, y, z = p.T
        return np.stack([10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z], axis=-1)

    path = [start]
    for _ in range(n - 1):
        path.append(path[-1] + step * flow(path[-1] + 0.5 * step * flow(path[-1])))
    return np.array(path)


def wires(small: bool) -> limner.LineSet:
    """All paths as one set, z upwards, a metre high, thinner at the beginning."""
    n = 300 if small else 1400
    starts = np.array([1.0, 1.0, 20.0]) + 0.02 * np.arange(8)[:, None]
    paths = np.swapaxes(lorenz(starts, n), 0, 1)[..., [0, 2, 1]] / 50.0
    numbers = np.arange(8 * n).reshape(8, n)
    segments = np.stack([numbers[:, :-1], numbers[:, 1:]], axis=-1).reshape(-1, 2)
    radii = np.tile(np.linspace(0.002, 0.005, n), 8)
    time = np.tile(np.linspace(0.0, 1.0, n), 8)
    return limner.color_by(limner.LineSet(paths.reshape(-1, 3), segments, radii=radii, name="paths"), time, "turbo")


def main(target: str, small: bool = False) -> None:
    """One picture, with soft shadows."""
    set_of_lines = wires(small)
    satin = limner.MetallicRoughness((1.0, 1.0, 1.0), 0.0, 0.35)
    above = frame_from_gaze((-1.2, 2.4, 1.2), (1.2, -2.0, -1.2), (0, 0, 1))
    key = limner.Node(parent_from_node=above, lights=(limner.DiskLight((1.0, 0.95, 0.9), 22.0, 0.5, False),))
    fill = limner.Node(lights=(limner.AmbientLight((0.8, 0.9, 1.0), 0.35),))
    camera = limner.Camera.look_at((0.35, 1.75, 2.0), (0.02, 0.42, 0.0), yfov_degrees=29)
    scene = limner.Scene(limner.Node(children=(limner.Node("wires", shapes=(limner.Shape(set_of_lines, (satin,)),)), key, fill)), camera)
    width, height, samples = (96, 64, 2) if small else (840, 560, 25)
    scene = scene.with_ground(limner.Lambert((0.75, 0.74, 0.72)))
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {len(set_of_lines.segments)} segments")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "wires.png", "--small" in sys.argv)
