"""What meshes take: adjacency, normals, reports, repair, subdivision and marching cubes of about a million triangles, beside trimesh.

    python benchmarks/meshes.py

All in one process and on one core. Each line is the median of `--runs` runs of processor time, so that other work on the machine counts
little; where trimesh (or scikit-image) does the same, its time stands beside it, and their ratio: above 1, limner is faster.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import limner
from limner.mesh.examine.curvature import gaussian_curvature, mean_curvature
from limner.mesh.mesh import Mesh
from limner.mesh.normals import vertex_normals


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, default=1_000_000, help="of the torus that is worked on")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    side = max(3, round((options.triangles / 4.0) ** 0.5))
    mesh = shuffled(limner.primitives.torus(1.0, 0.4, 2 * side, side))
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}, {len(mesh.triangles)} triangles in no order")
    print(f"{'':34} limner s  other s  ratio")
    triangles, peer = mesh.triangles, trimesh_of()
    small = limner.primitives.torus(1.0, 0.4, side // 2, side // 4)
    samples = np.add.reduce(np.meshgrid(*[np.linspace(-1.2, 1.2, 129) ** 2] * 3))
    box = [[-1.2] * 3, [1.2] * 3]
    lines: list[tuple[str, Callable[[], object], Callable[[], object] | None]] = [
        ("adjacency", lambda: limner.adjacency(mesh), asked(peer, mesh, "face_adjacency")),
        ("vertex normals", lambda: vertex_normals(mesh.positions, triangles), asked(peer, mesh, "vertex_normals")),
        ("report on topology", lambda: limner.topology_report(mesh), None),
        ("repair of what is sound", lambda: limner.repair(mesh), None),
        ("Gaussian curvature", lambda: gaussian_curvature(mesh), None),
        ("mean curvature", lambda: mean_curvature(mesh), None),
        ("Loop, 1/16 of it, twice", lambda: limner.subdivide.loop(small, 2), asked(peer, small, "subdivide_loop", 2)),
        ("marching cubes, 129^3 samples", lambda: limner.marching_cubes(samples, box, level=1.0), skimage_of(samples)),
    ]
    for name, ours, theirs in lines:
        taken = seconds(ours, options.runs)
        if theirs is None:
            print(f"{name:34} {taken:8.3f}")
        else:
            other = seconds(theirs, options.runs)
            print(f"{name:34} {taken:8.3f} {other:8.3f} {other / taken:6.2f}")


def shuffled(mesh: Mesh) -> Mesh:
    """The same triangles, vertices and triangles in no order."""
    random = np.random.default_rng(1)
    order = random.permutation(len(mesh.positions))
    place = np.empty(len(order), dtype=np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    return Mesh(mesh.positions[order], place[mesh.triangles][random.permutation(len(mesh.triangles))])


def seconds(work: Callable[[], object], runs: int) -> float:
    """The median of processor time."""
    taken = []
    for _ in range(runs):
        began = time.process_time()
        work()
        taken.append(time.process_time() - began)
    return statistics.median(taken)


def trimesh_of() -> Callable[[Mesh], Any] | None:
    """What makes a trimesh of a mesh, anew each time, since it keeps what it has computed; None where it is not installed."""
    try:
        import trimesh
    except ImportError:
        return None
    return lambda mesh: trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)


def asked(peer: Callable[[Mesh], Any] | None, mesh: Mesh, name: str, *arguments: int) -> Callable[[], object] | None:
    """What asks trimesh for a property, or calls a method."""
    if peer is None:
        return None
    make = peer
    return lambda: getattr(make(mesh), name)(*arguments) if arguments else getattr(make(mesh), name)


def skimage_of(samples: object) -> Callable[[], object] | None:
    """scikit-image's marching cubes; None where it is not installed."""
    try:
        from skimage.measure import marching_cubes
    except ImportError:
        return None
    return lambda: marching_cubes(samples, 1.0)


if __name__ == "__main__":
    main()
