"""Path tracing against Mitsuba: how much noise is left after how much work.

    python benchmarks/light.py REFERENCES --mitsuba peers/mitsuba/bin/python

REFERENCES is a folder with a folder for each scene: `scene.json` (camera, materials, quads, lights as numbers) and `reference.npz` (for
meshes that are not written out: their vertices and faces). A scene is drawn with 64 samples a pixel, a box filter, at most seven
scatterings, no clamping and no denoising, each program with its best sampler and in processes of its own, alternately. What is told of
each:

- the first picture's seconds, with all preparation, and the others' alone, wall clock and processor time: what else a machine does counts
  in the first and little in the second;
- the mean squared error against a converged picture of its own, with sixteen times the samples;
- the efficiency 1 / (processor seconds x error), and limner's over that of each peer: above 1, limner is better.

Before anything is told, the means of the converged pictures are compared: they have to agree within one per cent.
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
from typing import Any

import numpy as np
from numpy.typing import NDArray

SAMPLES, CONVERGED = 64, 1024  # of a pixel; squares, as a jittered sampler wants them

_LIMNER = """
import json, sys, time
from pathlib import Path
import numpy
began = time.perf_counter()
import limner
told, stored = json.loads(Path(sys.argv[1], "scene.json").read_text()), numpy.load(Path(sys.argv[1], "reference.npz"))
side, output = int(sys.argv[2]), sys.argv[3]
nodes = []
for mesh in told["meshes"]:
    if "vertices" in mesh:
        faces = numpy.array(mesh["faces"])
        triangles = numpy.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]) if faces.shape[1] == 4 else faces
        vertices = numpy.array(mesh["vertices"], dtype=numpy.float32)
    else:
        vertices, triangles = stored["bunny_vertices"], stored["bunny_faces"]
    material = limner.Lambert(
        color=tuple(told["materials"][mesh["material"]]), emission=tuple(mesh.get("emission", (0.0, 0.0, 0.0))),
        double_sided="emission" not in mesh,
    )
    nodes.append(limner.Node(mesh["name"], shapes=(limner.Shape(limner.Mesh(vertices, triangles), (material,)),)))
camera = told["camera"]
eye = limner.PerspectiveCamera.look_at(camera["origin"], camera["target"], camera["up"], yfov_degrees=camera["fov_deg"])
sky = limner.Environment(tuple(told["environment"])) if any(told["environment"]) else None
scene = limner.Scene(
    limner.Node(children=tuple(nodes)), camera=eye, environment=sky, background="environment" if sky else (0.0, 0.0, 0.0)
)
def draw(samples, seed):
    drawn = limner.render(
        scene, width=side, height=side, renderer="path", samples=samples, seed=seed, max_depth=7, default_lights=False
    )
    return drawn.pixels[..., :3]
"""

_MITSUBA = """
import json, sys, time
from pathlib import Path
import numpy
began = time.perf_counter()
import mitsuba
mitsuba.set_variant(sys.argv[4])
told, stored = json.loads(Path(sys.argv[1], "scene.json").read_text()), numpy.load(Path(sys.argv[1], "reference.npz"))
side, output = int(sys.argv[2]), sys.argv[3]
camera = told["camera"]
place = mitsuba.ScalarTransform4f().look_at(origin=camera["origin"], target=camera["target"], up=camera["up"])
film = {
    "type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"
}
sensor = {"type": "perspective", "fov": camera["fov_deg"], "to_world": place, "film": film, "sampler": {"type": "multijitter"}}
described = {"type": "scene", "integrator": {"type": "path", "max_depth": 8}, "sensor": sensor}
if any(told["environment"]):
    described["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": told["environment"]}}
for mesh in told["meshes"]:
    if "vertices" in mesh:
        faces = numpy.array(mesh["faces"])
        triangles = numpy.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]) if faces.shape[1] == 4 else faces
        vertices = numpy.array(mesh["vertices"])
    else:
        vertices, triangles = stored["bunny_vertices"], stored["bunny_faces"]
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": told["materials"][mesh["material"]]}}
    properties = mitsuba.Properties()
    properties["bsdf"] = mitsuba.load_dict(diffuse if "emission" in mesh else {"type": "twosided", "one": diffuse})
    if "emission" in mesh:
        properties["light"] = mitsuba.load_dict({"type": "area", "radiance": {"type": "rgb", "value": mesh["emission"]}})
    made = mitsuba.Mesh(mesh["name"], len(vertices), len(triangles), props=properties)
    filled = mitsuba.traverse(made)
    filled["vertex_positions"] = vertices.astype(numpy.float32).ravel()
    filled["faces"] = triangles.astype(numpy.uint32).ravel()
    filled.update()
    described[mesh["name"]] = made
scene = mitsuba.load_dict(described)
def draw(samples, seed):
    return numpy.array(mitsuba.render(scene, seed=seed, spp=samples))
"""

_MEASURE = f"""
draw({SAMPLES}, 1000)
first, wall, processor = time.perf_counter() - began, [], []
for seed in range(1, 4):
    walls, spent = time.perf_counter(), time.process_time()
    numpy.save(output + str(seed), draw({SAMPLES}, seed))
    wall.append(time.perf_counter() - walls)
    processor.append(time.process_time() - spent)
if len(sys.argv) > 5:
    numpy.save(output + "converged", draw({CONVERGED}, 2000))
print(json.dumps({{"first": first, "wall": min(wall), "processor": min(processor)}}))
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("references", type=Path, help="a folder with a folder for each scene")
    parser.add_argument("--mitsuba", help="a Python with mitsuba")
    parser.add_argument("--variants", nargs="+", default=["llvm_ad_rgb", "scalar_rgb"], help="of Mitsuba")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--quick", action="store_true", help="256 pixels a side in place of 512")
    options = parser.parse_args()
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}")
    programs: dict[str, tuple[str, str, str]] = {"limner": (sys.executable, _LIMNER, "")}
    if options.mitsuba:
        programs.update({f"Mitsuba {variant}": (options.mitsuba, _MITSUBA, variant) for variant in options.variants})
    for scene in sorted(path.parent for path in options.references.glob("*/scene.json")):
        with tempfile.TemporaryDirectory() as folder:
            measure(scene, programs, 256 if options.quick else 512, options.rounds, Path(folder))


def measure(scene: Path, programs: dict[str, tuple[str, str, str]], side: int, rounds: int, folder: Path) -> None:
    """Print the table of one scene."""
    told: dict[str, list[dict[str, float]]] = {name: [] for name in programs}
    for k in range(rounds):
        for index, name in list(enumerate(programs))[:: 1 if k % 2 == 0 else -1]:
            told[name].append(run(programs[name], scene, side, str(folder / f"{index}_"), is_last=k == rounds - 1))
    converged = [picture(folder / f"{index}_converged.npy") for index in range(len(programs))]
    for name, mean in zip(programs, converged, strict=True):
        if abs(mean.mean() / converged[0].mean() - 1.0) > 0.01:
            raise SystemExit(f"{scene.name}: the mean of {name} is {mean.mean():.5f}, that of limner {converged[0].mean():.5f}")
    print(f"\n{scene.name}, {side} x {side}, {SAMPLES} samples")
    print(f"  {'':20} {'first s':>8} {'wall s':>8} {'CPU s':>8} {'MSE':>10} {'efficiency':>11} {'limner is':>10}")
    ours = 0.0
    for index, name in enumerate(programs):
        error = statistics.fmean(
            float(((picture(folder / f"{index}_{seed}.npy") - converged[index]) ** 2).mean()) for seed in range(1, 4)
        )
        first, wall, spent = (min(round[kind] for round in told[name]) for kind in ("first", "wall", "processor"))
        efficiency = 1.0 / (spent * error)
        ours = ours or efficiency
        print(f"  {name:20} {first:8.2f} {wall:8.2f} {spent:8.2f} {error:10.3g} {efficiency:11.4g} {ours / efficiency:9.2f}x")


def picture(path: Path) -> NDArray[np.float64]:
    """(side, side, 3) radiance."""
    return np.asarray(np.load(path), dtype=np.float64)


def run(program: tuple[str, str, str], scene: Path, side: int, output: str, *, is_last: bool) -> dict[str, Any]:
    """What a program tells; the last run leaves a converged picture, too."""
    python, source, variant = program
    words = [python, "-c", source + _MEASURE, str(scene), str(side), output, variant, *(["converged"] if is_last else [])]
    done = subprocess.run(words, check=False, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{python} failed: {done.stderr[-2000:]}")
    told: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return told


if __name__ == "__main__":
    main()
