"""Lines of a drawing and what hides them: how long they take, against Open CASCADE's hidden-line removal, and against Blender's lines.

    python benchmarks/drawings.py [MODEL ...] [--runs 5]
    python benchmarks/drawings.py --peer peers/bin/python [--facets 5000] [--pairs 9]      after peers/bin/pip install cadquery-ocp
    python benchmarks/drawings.py MODEL ... --blender peers/bin/python [--pairs 9]         after peers/bin/pip install bpy

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
from limner.artistic.surfaces import surfaces_of
from limner.mesh.mesh import Mesh
from limner.mesh.shapes.primitives import torus
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
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

_BLENDER = """
import json, sys, time
import bpy, mathutils
import numpy as np

given, how = np.load(sys.argv[1]), sys.argv[2]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
mesh = bpy.data.meshes.new("mesh")
mesh.from_pydata(given["points"].tolist(), [], given["triangles"].tolist())
mesh.update()
for polygon in mesh.polygons:
    polygon.use_smooth = True
scene.collection.objects.link(bpy.data.objects.new("mesh", mesh))
lens = bpy.data.cameras.new("camera")
camera = bpy.data.objects.new("camera", lens)
scene.collection.objects.link(camera)
scene.camera = camera
camera.matrix_world = mathutils.Matrix(given["place"].tolist())
lens.sensor_fit, lens.angle = "VERTICAL", float(given["angle"])
lens.clip_start, lens.clip_end = float(given["near"]), float(given["far"])
scene.render.resolution_x, scene.render.resolution_y = 1000, 800
bend = float(np.pi - np.radians(30.0))

def freestyle():
    import addon_utils
    addon_utils.enable("cycles", default_set=True)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 1, "CPU", False
    scene.render.filepath = sys.argv[1] + ".png"
    layer = bpy.context.view_layer
    times, painted = {}, 0.0
    for drawn in (False, True, False, True):
        scene.render.use_freestyle = layer.use_freestyle = drawn
        settings = layer.freestyle_settings
        settings.crease_angle = bend
        if drawn:
            lines = settings.linesets[0] if settings.linesets else settings.linesets.new("lines")
            lines.select_silhouette = lines.select_border = lines.select_crease = lines.select_material_boundary = True
            if lines.linestyle is None:
                lines.linestyle = bpy.data.linestyles.new("style")
            lines.linestyle.color = (1.0, 0.0, 0.0)
        started = time.process_time()
        bpy.ops.render.render(write_still=True)
        times[drawn] = time.process_time() - started
    picture = np.array(bpy.data.images.load(scene.render.filepath).pixels[:]).reshape(-1, 4)
    return times[True] - times[False], int((picture[:, 0] > picture[:, 1] + 0.2).sum())

def line_art():
    pencil = bpy.data.grease_pencils.new("pencil")
    strokes = bpy.data.objects.new("pencil", pencil)
    scene.collection.objects.link(strokes)
    pencil.layers.new("lines").frames.new(1)
    ink = bpy.data.materials.new("ink")
    bpy.data.materials.create_gpencil_data(ink)
    pencil.materials.append(ink)
    modifier = strokes.modifiers.new("lines", "LINEART")
    modifier.source_type, modifier.target_layer, modifier.target_material = "SCENE", "lines", ink
    modifier.use_contour = modifier.use_crease = modifier.use_intersection = modifier.use_material = modifier.use_loose = True
    for turn in range(2):
        modifier.crease_threshold = bend - 1e-5 * turn
        started = time.process_time()
        graph = bpy.context.evaluated_depsgraph_get()
        graph.update()
        drawn = strokes.evaluated_get(graph).data.layers[0].frames[0].drawing
        elapsed = time.process_time() - started
    return elapsed, len(drawn.strokes)

print(json.dumps(freestyle() if how == "Freestyle" else line_art()))
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--peer", metavar="PYTHON", help="an interpreter that has cadquery-ocp")
    parser.add_argument("--blender", metavar="PYTHON", help="an interpreter that has bpy")
    parser.add_argument("--facets", type=int, default=5000, help="triangles of the torus, about")
    parser.add_argument("--pairs", type=int, default=LEAST_PAIRS)
    options = parser.parse_args()
    if (options.peer or options.blender) and options.pairs < LEAST_PAIRS:
        raise SystemExit(f"a comparison needs at least {LEAST_PAIRS} pairs, got {options.pairs}")
    for model in options.models:
        if options.blender:
            against_blender(options.blender, model, options.pairs)
        else:
            alone(model, options.runs)
    if options.peer:
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


def against_blender(peer: str, model: str, pairs: int) -> None:
    """Tell the ratios of Blender's time to ours, taken in turns."""
    scene = load(model)
    drawing = drawing_of(scene, width=1000, height=800)
    camera = drawing.camera
    assert isinstance(camera, PerspectiveCamera)
    surfaces = surfaces_of(scene, camera, 1000, 800)
    place = np.asarray(camera.world_from_camera)
    far = 10.0 * float(np.linalg.norm(surfaces.points - place[:3, 3], axis=1).max())
    with tempfile.TemporaryDirectory() as folder:
        path, script = Path(folder, "model.npz"), Path(folder, "peer.py")
        np.savez(
            path, points=surfaces.points, triangles=surfaces.triangles, place=place, angle=np.radians(camera.yfov_degrees), near=1e-4 * far,
            far=far,
        )  # fmt: skip
        script.write_text(_BLENDER)

        def mine() -> tuple[float, float]:
            started = time.process_time()
            made = drawing_of(scene, camera, width=1000, height=800, hidden=False)
            return time.process_time() - started, len(made.lines)

        for how in ("Freestyle", "Line Art"):
            ratios = []
            for pair in range(pairs):
                turns = [mine, lambda how=how: theirs(peer, script, path, how)]  # type: ignore[misc]
                order = (0, 1) if pair % 2 == 0 else (1, 0)
                results = {k: turns[k]() for k in order}
                if not results[1][1]:
                    raise SystemExit(f"{how} drew nothing of {model}")
                ratios.append(results[1][0] / results[0][0])
            low, middle, high = quartiles(ratios)
            count = len(surfaces.triangles)
            print(f"{how}: {model}, {count} triangles, {middle:.2f} times our time ({low:.2f} to {high:.2f}), ours {results[0][0]:.3f} s")


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
    """The time and the outcome of a peer, in a process of its own."""
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
