"""Lines of a drawing and what hides them: how long they take, and against Open CASCADE's hidden-line removal.

    python benchmarks/drawings.py [MODEL ...] [--runs 5]
    python benchmarks/drawings.py --peer peers/bin/python [--facets 5000] [--pairs 9]      after peers/bin/pip install cadquery-ocp

Alone, it tells the processor's time of `drawing_of` for each model, with all that it draws by default, hidden lines too; reading the file
does not count. With a peer, both get the facets of one rough torus, as triangles, and draw all edges between them, seen and hidden, in a
parallel projection along (1, 1, 1): Open CASCADE by its polygonal algorithm (HLRBRep_PolyAlgo) and by its exact one (HLRBRep_Algo). Each
process does the work once to warm up and tells the time of the second; building Open CASCADE's solids from triangles, which takes as long
again, does not count. The lengths of what is seen must agree, or nothing is told.
"""

from __future__ import annotations

import argparse
import json
import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from pairs import LEAST_PAIRS, quartiles

from limner import load
from limner.artistic.lines import LineKind, drawing_of
from limner.mesh.mesh import Mesh
from limner.mesh.shapes.primitives import torus
from limner.scene.camera import OrthographicCamera
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape

_AGREE = 1e-4  # of the length of what is seen

_PEER = """
import json, sys, time
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_Algo, HLRBRep_HLRToShape, HLRBRep_PolyAlgo, HLRBRep_PolyHLRToShape
from OCP.StlAPI import StlAPI_Reader
from OCP.TopoDS import TopoDS_Shape
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

shape = TopoDS_Shape()
StlAPI_Reader().Read(shape, sys.argv[1])
BRepMesh_IncrementalMesh(shape, 1e-3)
projector = HLRAlgo_Projector(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 1, 1)))

def polygonal():
    work = HLRBRep_PolyAlgo()
    work.Projector(projector)
    work.Load(shape)
    work.Update()
    made = HLRBRep_PolyHLRToShape()
    made.Update(work)
    return made.VCompound(), made.HCompound()

def exact():
    work = HLRBRep_Algo()
    work.Add(shape, 0)
    work.Projector(projector)
    work.Update()
    work.Hide()
    made = HLRBRep_HLRToShape(work)
    return made.VCompound(), made.HCompound()

run = polygonal if sys.argv[2] == "polygonal" else exact
run()
started = time.process_time()
seen, _ = run()
elapsed = time.process_time() - started
measured = GProp_GProps()
BRepGProp.LinearProperties_s(seen, measured)
print(json.dumps([elapsed, measured.Mass()]))
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--peer", metavar="PYTHON", help="an interpreter that has cadquery-ocp")
    parser.add_argument("--facets", type=int, default=5000, help="triangles of the torus, about")
    parser.add_argument("--pairs", type=int, default=LEAST_PAIRS)
    options = parser.parse_args()
    for model in options.models:
        alone(model, options.runs)
    if options.peer:
        if options.pairs < LEAST_PAIRS:
            raise SystemExit(f"a comparison needs at least {LEAST_PAIRS} pairs, got {options.pairs}")
        n = max(4, round((options.facets / 4) ** 0.5))
        against(options.peer, rough_torus(2 * n, n), options.pairs)


def alone(model: str, runs: int) -> None:
    """Tell the median time of some drawings of a file's model."""
    scene = load(model)
    found = []
    drawing_of(scene, width=1000, height=800)
    for _ in range(runs):
        started = time.process_time()
        drawing = drawing_of(scene, width=1000, height=800)
        found.append(time.process_time() - started)
    print(f"{model}: {np.median(found):.3f} s, {len(drawing.lines)} lines")


def rough_torus(n_u: int, n_v: int) -> Mesh:
    """A torus no two triangles of which lie in one plane, so that every edge is a line."""
    smooth = torus(1.0, 0.3, n_u, n_v)
    moved = smooth.positions + np.random.default_rng(0).normal(0.0, 0.002, smooth.positions.shape)
    return Mesh(moved.astype(np.float32), smooth.triangles)


def against(peer: str, mesh: Mesh, pairs: int) -> None:
    """Tell the ratios of the peer's time to ours, taken in turns."""
    with tempfile.TemporaryDirectory() as folder:
        path, script = Path(folder, "torus.stl"), Path(folder, "peer.py")
        path.write_bytes(_stl(mesh))
        script.write_text(_PEER)
        for how in ("polygonal", "exact"):
            ratios = []
            for pair in range(pairs):
                turns = [lambda: ours(mesh), lambda how=how: theirs(peer, script, path, how)]  # type: ignore[misc]
                order = (0, 1) if pair % 2 == 0 else (1, 0)
                results = {k: turns[k]() for k in order}
                (us, our_length), (them, their_length) = results[0], results[1]
                if abs(our_length - their_length) > _AGREE * their_length:
                    raise SystemExit(f"{how}: lengths of what is seen differ, {our_length} and {their_length}")
                ratios.append(them / us)
            low, middle, high = quartiles(ratios)
            print(f"{how}: {len(mesh.triangles)} triangles, {middle:.1f} times our time ({low:.1f} to {high:.1f})")


def ours(mesh: Mesh) -> tuple[float, float]:
    """The processor's time of a drawing of all edges, and the length of those that are seen, metres."""
    scene = Scene(root=Node(shapes=(Shape(mesh, (Lambert(),)),)))
    camera = OrthographicCamera.look_at((5.0, 5.0, 5.0), (0.0, 0.0, 0.0), height=3.0)
    kinds: tuple[LineKind, ...] = ("silhouette", "boundary", "crease")
    drawing_of(scene, camera, width=1000, height=1000, kinds=kinds, crease_degrees=0.0)
    started = time.process_time()
    drawing = drawing_of(scene, camera, width=1000, height=1000, kinds=kinds, crease_degrees=0.0)
    elapsed = time.process_time() - started
    assert drawing.pixels_per_metre is not None
    return elapsed, sum(line.length for line in drawing.of(hidden=False)) / drawing.pixels_per_metre


def theirs(peer: str, script: Path, path: Path, how: str) -> tuple[float, float]:
    """The same of Open CASCADE, in a process of its own."""
    done = subprocess.run(
        [peer, str(script), str(path), how], capture_output=True, text=True, check=False, env=dict(os.environ, PYTHONPATH="")
    )
    if done.returncode != 0:
        sys.exit(f"{peer} failed: {done.stderr.strip().splitlines()[-1:]}")
    elapsed, length = json.loads(done.stdout.splitlines()[-1])
    return float(elapsed), float(length)


def _stl(mesh: Mesh) -> bytes:
    corners = mesh.positions[mesh.triangles]
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    rows["corners"] = corners
    return bytes(80) + struct.pack("<I", len(corners)) + rows.tobytes()


if __name__ == "__main__":
    main()
