"""The acceleration structures of FoCG 12.3, compared: time to build, memory, what is visited, rays a second.

    python benchmarks/accelerators.py stanford-bunny.obj --embree peers/embree/bin/python --plot growth.svg

Scenes are triangles strewn at random, a teapot, a teapot in a stadium, and the models that are given. Rays are those of `rays.py`: primary
ones, bounces, random chords (in the stadium those of the teapot alone), one thread, in millions a second of processor time. Parts and
triangles are those that a random chord visits; a part of the tree of eight children is a node, of eight boxes. All structures must find
the same distances before anything is told. `--embree` compares resident memory with Embree's (Linux), each in a process of its own, before
and after the C library was made to return what is free in its heap; `--plot` draws how the time of a ray grows from a thousand to four
million triangles.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray
from rays import KINDS, mesh_of, rays_through

import limner
from limner.draw.canvas import Canvas
from limner.draw.stroke import Pen
from limner.mesh.shapes import primitives
from limner.mesh.shapes.teapot import teapot
from limner.raycaster import Kind

Floats = NDArray[np.float32]
Mesh = tuple[Floats, NDArray[np.int32]]
STRUCTURES: tuple[Kind, ...] = ("bvh", "grid", "bsp", "volume_tree")
COLORS = {"bvh": "#1b6ac9", "grid": "#c9541b", "bsp": "#2f9e44", "volume_tree": "#8a3ac2"}
EMBREE_NAME = "Embree"

_RESIDENT = """
import ctypes, sys
import numpy as np
def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096
def greatest():
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) * 1024 for line in file if line.startswith("VmHWM"))
held = np.load(sys.argv[1])
vertices, triangles = held["vertices"], held["triangles"]
small = np.arange(90, dtype=np.float32).reshape(30, 3) % 7, np.arange(30, dtype=np.int32).reshape(10, 3)
if sys.argv[2] == "limner":
    import limner
    made = limner.RayCaster(*small)
    made.intersect((0, 0, 0), (0, 0, 1))
    before = resident()
    made = limner.RayCaster(vertices, triangles)
    made.intersect((0, 0, 0), (0, 0, 1))
else:
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh
    def build(vertices, triangles):
        scene = rtcore_scene.EmbreeScene()
        TriangleMesh(scene, vertices, triangles)
        scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))
        return scene
    made = build(*small)
    before = resident()
    made = build(vertices, triangles)
grown = resident() - before
ctypes.CDLL(None).malloc_trim(0)
print(grown / 1e6, (resident() - before) / 1e6, (greatest() - before) / 1e6)
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*")
    parser.add_argument("--subdivide", type=int, default=0, help="how often each edge of the models is halved")
    parser.add_argument("--rays", type=int, default=1 << 17, help="of each kind")
    parser.add_argument("--embree", help="a Python with embreex")
    parser.add_argument("--plot", help="an .svg or picture to draw the growth into")
    options = parser.parse_args()
    pot = mesh_arrays(teapot(16))
    scenes = {"random triangles": strewn(100_000), "teapot": pot, "teapot in a stadium": in_a_stadium()}
    scenes |= {Path(model).stem: mesh_of(model, options.subdivide) for model in options.models}
    for name, mesh in scenes.items():
        compare(name, mesh, rays_through(*(pot if "stadium" in name else mesh)), options.rays)
        if options.embree:
            tell_memory(mesh, options.embree)
    if options.plot:
        draw(growth(options.rays), options.plot)


def strewn(n: int) -> Mesh:
    """Triangles of a fortieth of the room, all over it."""
    random = np.random.default_rng(0)
    corners = random.uniform(-1, 1, (n, 1, 3)) + random.uniform(-0.025, 0.025, (n, 3, 3))
    return corners.reshape(-1, 3).astype(np.float32), np.arange(3 * n, dtype=np.int32).reshape(-1, 3)


def mesh_arrays(mesh: limner.Mesh) -> Mesh:
    """Vertices and triangles."""
    return mesh.positions, mesh.triangles


def in_a_stadium() -> Mesh:
    """A teapot of a metre amid ranks that are a hundred metres long."""
    ranks = [((100.0, 1.0 + k, 1.0), (0.0, (1.0 + k) / 2, side * (30.0 + k))) for k in range(20) for side in (-1, 1)]
    ranks += [((1.0, 1.0 + k, 60.0), (side * (50.0 + k), (1.0 + k) / 2, 0.0)) for k in range(20) for side in (-1, 1)]
    parts = [mesh_arrays(teapot(16))]
    for size, at in ranks:
        box = primitives.box(size)
        parts.append((box.positions + np.array(at, dtype=np.float32), box.triangles))
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    triangles = [rows + start for (_, rows), start in zip(parts, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in parts]), np.concatenate(triangles).astype(np.int32)


def compare(name: str, mesh: Mesh, all_rays: dict[str, Floats], n_rays: int) -> None:
    """Print the table of one scene."""
    rays = by_kind(all_rays, n_rays)
    print(f"\n**{name}**, {len(mesh[1]):,} triangles\n")
    print("| | build, s | memory, MB | parts a ray | triangles a ray | " + " | ".join(f"{kind}, Mrays/s" for kind in rays) + " |")
    print("|---|" + "---:|" * (4 + len(rays)))
    expected: dict[str, Floats] = {}
    for structure in STRUCTURES:
        seconds, caster = built(mesh, structure)
        speeds = []
        for kind, (origins, directions) in rays.items():
            took, t = asked(caster, origins, directions)
            if not np.array_equal(expected.setdefault(kind, t), t):
                raise SystemExit(f"{structure} finds other hits than {STRUCTURES[0]}: {name}, {kind}")
            speeds.append(len(origins) / took / 1e6)
        seen = caster.visits(*rays["random"])
        nodes, triangles = seen.nodes.mean(), seen.triangles.mean()
        cells = [f"{seconds:.3f}", f"{caster.nbytes / 1e6:.1f}", f"{nodes:.1f}", f"{triangles:.1f}", *(f"{speed:.2f}" for speed in speeds)]
        print(f"| {structure} | " + " | ".join(cells) + " |", flush=True)


def by_kind(rays: dict[str, Floats], n: int) -> dict[str, tuple[Floats, Floats]]:
    """Origins and directions of each kind, a run of n from the middle; of bounces and chords any would do."""
    found = {}
    for kind in KINDS:
        both = rays[f"{kind}_origins"], rays[f"{kind}_directions"]
        first = max(0, (len(both[0]) - n) // 2)
        found[kind] = both[0][first : first + n], both[1][first : first + n]
    return found


def built(mesh: Mesh, structure: Kind) -> tuple[float, limner.RayCaster]:
    """The least time of two, and the second."""
    taken = []
    for _ in range(2):
        began = time.process_time()
        caster = limner.RayCaster(*mesh, accelerator=structure)
        taken.append(time.process_time() - began)
    return min(taken), caster


def asked(caster: limner.RayCaster, origins: Floats, directions: Floats) -> tuple[float, Floats]:
    """Seconds of one thread, the least of three, and the distances."""
    caster.intersect(origins[:64], directions[:64], threads=1)
    taken = []
    for _ in range(3):
        began = time.process_time()
        hits = caster.intersect(origins, directions, threads=1)
        taken.append(time.process_time() - began)
    return min(taken), hits.t


def tell_memory(mesh: Mesh, embree: str) -> None:
    """Print what a process grows by."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.npz"
        np.savez(path, vertices=mesh[0], triangles=mesh[1])
        for name, python in (("limner", sys.executable), (EMBREE_NAME, embree)):
            told = subprocess.run([python, "-c", _RESIDENT, str(path), name], check=True, capture_output=True, text=True).stdout
            grown, trimmed, most = told.split()
            words = f"the process grows by {float(grown):.1f} MB, of which {float(trimmed):.1f} MB are in use"
            print(f"\n{name}: {words}; by {float(most):.1f} MB while it builds", end="", flush=True)
    print()


def growth(n_rays: int) -> dict[str, list[tuple[int, float]]]:
    """Of each structure: triangles, and microseconds of a random chord, on a ball with bumps."""
    found: dict[str, list[tuple[int, float]]] = {structure: [] for structure in STRUCTURES}
    for exponent in range(10, 23, 2):
        mesh = bumpy(1 << exponent)
        origins, directions = chords(n_rays)
        for structure in STRUCTURES:
            took, _ = asked(limner.RayCaster(*mesh, accelerator=structure), origins, directions)
            found[structure].append((len(mesh[1]), 1e6 * took / n_rays))
            print(f"{structure}, {len(mesh[1])} triangles: {found[structure][-1][1]:.2f} µs a ray", flush=True)
    return found


def bumpy(n: int) -> Mesh:
    """A ball of about n triangles, with bumps."""
    ball = primitives.sphere(1.0, round(math.sqrt(n) / 2))
    p = ball.positions
    lift = 1.0 + 0.05 * np.sin(9.0 * p[:, :1]) * np.sin(11.0 * p[:, 1:2]) * np.sin(10.0 * p[:, 2:])
    return (p * lift).astype(np.float32), ball.triangles


def chords(n: int) -> tuple[Floats, Floats]:
    """Between random points of a sphere around the ball."""
    random = np.random.default_rng(1)
    ends = random.normal(size=(2, n, 3))
    ends *= 1.5 / np.linalg.norm(ends, axis=-1, keepdims=True)
    return ends[0].astype(np.float32), (ends[1] - ends[0]).astype(np.float32)


def draw(found: dict[str, list[tuple[int, float]]], target: str) -> None:
    """Microseconds over the logarithm of the number of triangles."""
    left, top, width, height = 70.0, 40.0, 620.0, 380.0
    canvas = Canvas(860, 500, "white")
    most = math.ceil(max(took for points in found.values() for _, took in points))

    def place(n: float, took: float) -> tuple[float, float]:
        return left + (math.log2(n) - 10.0) / 12.5 * width, top + height * (1.0 - took / most)

    for exponent in range(10, 23, 2):
        x, y = place(1 << exponent, 0.0)
        canvas.line(x, top, x, y, "#e4e7eb").text(x, y + 8, f"{1 << exponent:,}", "#333", 12.0, align="center", baseline="top")
    for took in range(most + 1):
        x, y = place(1 << 10, took)
        canvas.line(x, y, left + width, y, "#e4e7eb").text(x - 8, y, str(took), "#333", 12.0, align="right", baseline="middle")
    lowest = float(canvas.height)
    for structure, points in sorted(found.items(), key=lambda item: item[1][-1][1]):
        line = [place(*point) for point in points]
        canvas.polyline(line, COLORS[structure], Pen(2.0))
        for x, y in line:
            canvas.circle(x, y, 3.5, COLORS[structure])
        lowest = min(lowest - 16.0, line[-1][1])  # names do not stand on one another
        canvas.text(line[-1][0] + 10, lowest, structure, COLORS[structure], 14.0, baseline="middle")
    canvas.text(left, 20, "microseconds a ray (random chords, one thread) over triangles", "#111", 15.0, baseline="middle")
    if target.endswith(".svg"):
        Path(target).write_text(canvas.svg(), encoding="utf-8")
    else:
        canvas.image().save(target)
    print(target)


if __name__ == "__main__":
    assert set(STRUCTURES) <= set(get_args(Kind))
    main()
