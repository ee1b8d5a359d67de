"""Rays a second through `RayCaster`, against Embree, as embreex, Open3D and Mitsuba lead to it.

    python benchmarks/rays.py stanford-bunny.obj --subdivide 0 2 --embree peers/embree/bin/python --mitsuba peers/mitsuba/bin/python

Three kinds of rays: primary ones of a picture of 1024 x 1024 in tiles of 8 x 8, bounces from where these hit, spread by the cosine and
shuffled, and random chords of the bounding sphere. Closest hit and any hit, one thread. embreex and Open3D ask Embree for one ray at a
time, Mitsuba (`llvm`) for packets. limner and its peers run in processes of their own, on the same arrays, alternately, A B B A; told are
millions of rays a second of processor time, so that other work on the machine counts little, and the median of the ratios of neighbours:
above 1, limner is faster. With `--threads 2`, of time by the clock, for which the machine must be idle; embreex has no threads. Before
anything is told, hits are compared: the same number of rays hit, and the same distances to float's error. How to set up the peers stands in
peers.md.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import limner

KINDS = ("primary", "bounces", "random")
Floats = NDArray[np.float32]

_LIMNER = """
import json, sys, time
import numpy, limner
threads = int(sys.argv[3])
now = time.process_time if threads == 1 else time.perf_counter
held = numpy.load(sys.argv[1])
limner.RayCaster([[0, 0, 0], [1, 0, 0], [0, 1, 0]] * 9, numpy.arange(27).reshape(9, 3)).intersect([0, 0, 1], [0, 0, -1])
began = now()
caster = limner.RayCaster(held["vertices"], held["triangles"])
told = {"build": now() - began}
for kind in ("primary", "bounces", "random"):
    origins, directions = held[kind + "_origins"], held[kind + "_directions"]
    for name, ask in (("closest", caster.intersect), ("any", caster.occluded)):
        ask(origins[:64], directions[:64], threads=threads)
        taken = []
        for _ in range(3 if threads == 1 else 9):
            began = now()
            found = ask(origins, directions, threads=threads)
            taken.append(now() - began)
        told[kind + " " + name] = len(origins) / min(taken) / 1e6
        if name == "closest":
            numpy.save(sys.argv[2] + kind, found.t)
print(json.dumps(told))
"""

_EMBREE = """
import json, sys, time
import numpy
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
threads = int(sys.argv[3])
now = time.process_time if threads == 1 else time.perf_counter
held = numpy.load(sys.argv[1])
began = now()
scene = rtcore_scene.EmbreeScene()
TriangleMesh(scene, held["vertices"][held["triangles"]])
scene.run(numpy.zeros((1, 3), numpy.float32), numpy.ones((1, 3), numpy.float32))
told = {"build": now() - began}
for kind in ("primary", "bounces", "random"):
    origins, directions = held[kind + "_origins"], held[kind + "_directions"]
    for name, query in (("closest", "INTERSECT"), ("any", "OCCLUDED")):
        taken = []
        for _ in range(3 if threads == 1 else 9):
            began = now()
            scene.run(origins, directions, query=query)
            taken.append(now() - began)
        told[kind + " " + name] = len(origins) / min(taken) / 1e6
    found = scene.run(origins, directions, query="INTERSECT", output=1)
    numpy.save(sys.argv[2] + kind, numpy.where(found["primID"] >= 0, found["tfar"], numpy.inf))
print(json.dumps(told))
"""

_OPEN3D = """
import json, sys, time
import numpy
import open3d
threads = int(sys.argv[3])
now = time.process_time if threads == 1 else time.perf_counter
held = numpy.load(sys.argv[1])
began = now()
scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
scene.add_triangles(open3d.core.Tensor(held["vertices"]), open3d.core.Tensor(held["triangles"].astype(numpy.uint32)))
scene.cast_rays(open3d.core.Tensor(numpy.ones((1, 6), numpy.float32)))
told = {"build": now() - began}
for kind in ("primary", "bounces", "random"):
    rays = open3d.core.Tensor(numpy.concatenate([held[kind + "_origins"], held[kind + "_directions"]], axis=1))
    asks = {"closest": lambda: scene.cast_rays(rays, nthreads=threads), "any": lambda: scene.test_occlusions(rays, nthreads=threads)}
    for name, ask in asks.items():
        taken = []
        for _ in range(3 if threads == 1 else 9):
            began = now()
            found = ask()
            taken.append(now() - began)
        told[kind + " " + name] = rays.shape[0] / min(taken) / 1e6
        if name == "closest":
            numpy.save(sys.argv[2] + kind, found["t_hit"].numpy())
print(json.dumps(told))
"""

_MITSUBA = """
import json, sys, time
import numpy
import drjit, mitsuba
threads = int(sys.argv[3])
now = time.process_time if threads == 1 else time.perf_counter
mitsuba.set_variant("llvm_ad_rgb")
drjit.set_thread_count(threads)
held = numpy.load(sys.argv[1])
vertices, triangles = held["vertices"], held["triangles"]
mesh = mitsuba.Mesh("mesh", len(vertices), len(triangles))
parts = mitsuba.traverse(mesh)
parts["vertex_positions"], parts["faces"] = vertices.ravel(), triangles.ravel().astype(numpy.uint32)
parts.update()
began = now()
scene = mitsuba.load_dict({"type": "scene", "mesh": mesh})
told = {"build": now() - began}
for kind in ("primary", "bounces", "random"):
    o, d = (numpy.ascontiguousarray(held[kind + part].T) for part in ("_origins", "_directions"))
    ray = mitsuba.Ray3f(mitsuba.Point3f(o), mitsuba.Vector3f(d))
    drjit.eval(ray)
    def closest():
        found = scene.ray_intersect_preliminary(ray, coherent=kind == "primary")
        drjit.eval(found.t)
        return found.t
    def any_hit():
        found = scene.ray_test(ray, coherent=kind == "primary")
        drjit.eval(found)
        return found
    for name, ask in (("closest", closest), ("any", any_hit)):
        ask(), drjit.sync_thread()
        taken = []
        for _ in range(3 if threads == 1 else 9):
            began = now()
            found = ask()
            drjit.sync_thread()
            taken.append(now() - began)
        told[kind + " " + name] = o.shape[1] / min(taken) / 1e6
        if name == "closest":
            numpy.save(sys.argv[2] + kind, numpy.array(found))
print(json.dumps(told))
"""

PEERS = {"embree": _EMBREE, "open3d": _OPEN3D, "mitsuba": _MITSUBA}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+")
    parser.add_argument("--subdivide", type=int, nargs="+", default=[0], help="how often each edge is halved")
    parser.add_argument("--embree", help="a Python with embreex")
    parser.add_argument("--open3d", help="a Python with open3d")
    parser.add_argument("--mitsuba", help="a Python with mitsuba; DRJIT_LIBLLVM_PATH says where libLLVM is")
    parser.add_argument("--pairs", type=int, default=2)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}")
    for model in options.models:
        for times in options.subdivide:
            with tempfile.TemporaryDirectory() as folder:
                peers = {name: python for name in PEERS if (python := getattr(options, name))}
                if options.threads > 1:
                    peers.pop("embree", None)
                measure(model, times, peers, options.pairs, options.threads, Path(folder))


def measure(model: str, times: int, peers: dict[str, str], pairs: int, threads: int, folder: Path) -> None:
    """Print the table of one mesh."""
    vertices, triangles = mesh_of(model, times)
    np.savez(folder / "rays.npz", vertices=vertices, triangles=triangles, **rays_through(vertices, triangles))  # type: ignore[arg-type]
    told: dict[str, list[dict[str, float]]] = {name: [] for name in ("limner", *peers)}
    for k in range(pairs):
        for who in list(told)[:: 1 if k % 2 == 0 else -1]:
            python, program = (sys.executable, _LIMNER) if who == "limner" else (peers[who], PEERS[who])
            told[who].append(run(python, program, folder, f"{who}_", threads))
    for peer in peers:
        compare(folder, peer)
    print(f"\n{Path(model).name}, {len(triangles)} triangles{'':12} limner" + "".join(f"{peer:>10}  ratio" for peer in peers))
    for row in told["limner"][0]:
        line = f"  {row:40} {statistics.median(one[row] for one in told['limner']):8.2f}"
        for peer in peers:
            ratios = [a[row] / b[row] for a, b in zip(told["limner"], told[peer], strict=True)]
            ratio = statistics.median(1.0 / r if row == "build" else r for r in ratios)
            line += f" {statistics.median(one[row] for one in told[peer]):9.2f} {ratio:6.2f}"
        print(line + ("  s" if row == "build" else "  Mrays/s"))


def mesh_of(model: str, times: int) -> tuple[Floats, NDArray[np.int32]]:
    """All triangles of a model, each edge halved so often."""
    scene = limner.load(model)
    meshes = [shape.geometry for _, shape in scene.shapes() if isinstance(shape.geometry, limner.Mesh)]
    vertices = np.concatenate([mesh.positions for mesh in meshes])
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    triangles = np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)])
    for _ in range(times):
        edges, place = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        middles = (len(vertices) + place.reshape(-1, 3)).astype(np.int32)
        vertices = np.concatenate([vertices, vertices[edges].mean(axis=1, dtype=np.float32)])
        (a, b, c), (ab, bc, ca) = triangles.T, middles.T
        triangles = np.concatenate([np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.ascontiguousarray(vertices, dtype=np.float32), np.ascontiguousarray(triangles, dtype=np.int32)


def rays_through(vertices: Floats, triangles: NDArray[np.int32]) -> dict[str, Floats]:
    """Origins and directions of each kind, (n, 3) float32."""
    random = np.random.default_rng(0)
    low, high = vertices[triangles].min(axis=(0, 1)), vertices[triangles].max(axis=(0, 1))
    centre, radius = (low + high) / 2.0, float(np.linalg.norm(high - low)) / 2.0
    row, column = np.mgrid[:1024, :1024]
    in_tiles = np.argsort(((row // 8) * 128 + column // 8) * 64 + (row % 8) * 8 + column % 8, axis=None)
    x, y = (((axis.ravel()[in_tiles] + 0.5) / 512.0 - 1.0) * np.tan(np.radians(20.0)) for axis in (column, row))
    primary = unit(np.stack([x, y, -np.ones_like(x)], axis=1)).astype(np.float32)
    eyes = np.broadcast_to(np.add(centre, (0.0, 0.0, 2.6 * radius)).astype(np.float32), primary.shape)
    hits = limner.RayCaster(vertices, triangles).intersect(eyes, primary)
    met = hits.triangle >= 0
    a, b, c = vertices[triangles[hits.triangle[met]]].astype(np.float64).transpose(1, 0, 2)
    normals = unit(np.cross(b - a, c - a))
    normals *= -np.sign(np.sum(normals * primary[met], axis=1, keepdims=True))
    places = eyes[met] + primary[met] * hits.t[met, None] + normals * (1e-4 * radius)
    bounces = unit(normals + on_sphere(random, len(places)))
    order = random.permutation(len(places))
    begins, ends = (centre + radius * on_sphere(random, 1 << 20) for _ in range(2))
    pairs = {"primary": (eyes, primary), "bounces": (places[order], bounces[order]), "random": (begins, unit(ends - begins))}
    return {
        f"{kind}_{what}": np.ascontiguousarray(array, dtype=np.float32)
        for kind, both in pairs.items()
        for what, array in zip(("origins", "directions"), both, strict=True)
    }  # fmt: skip


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors of length 1."""
    made: NDArray[np.float64] = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
    return made


def on_sphere(random: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Directions, all alike likely."""
    return unit(random.normal(size=(n, 3)))


def run(python: str, program: str, folder: Path, name: str, threads: int) -> dict[str, float]:
    """What a program tells."""
    words = [python, "-c", program, str(folder / "rays.npz"), str(folder / name), str(threads)]
    told: dict[str, float] = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines()[-1])
    return told


def compare(folder: Path, peer: str) -> None:
    """Stop unless both found the same."""
    for kind in KINDS:
        ours, theirs = np.load(folder / f"limner_{kind}.npy"), np.load(folder / f"{peer}_{kind}.npy")
        both = np.isfinite(ours) & np.isfinite(theirs)
        differ = int((np.isfinite(ours) != np.isfinite(theirs)).sum())
        off = np.abs(ours[both] - theirs[both]) > 1e-4 * np.abs(theirs[both]) + 1e-6
        if differ > 1e-5 * len(ours) or off.mean() > 1e-4:
            hit = f"{differ} of {len(ours)} rays hit one and not the other, {int(off.sum())} at another distance"
            raise SystemExit(f"{peer}, {kind}: {hit}")


if __name__ == "__main__":
    main()
