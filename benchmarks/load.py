"""From a large file to the first pixel: reading, normals, tables and one frame, against trimesh's reader and VTK's first frame.

    python benchmarks/load.py stanford-bunny.obj --subdivide 3 --vtk peers/vtk/bin/python

The mesh is subdivided (three times: 4.4 million triangles of the Stanford bunny) and written as PLY and GLB to a temporary folder. Each
program reads the file and draws 512 x 512 pixels with one sample each, in a process of its own, with its libraries imported before the
clock starts. trimesh reads in one process and hands its arrays to VTK in another; their times are added. VTK draws facets, limner smooth
normals, which it has to find first. Runs alternate, A B B A; told are the medians, the median of the ratios of neighbours, and where
limner's time goes. How to set up the peer stands in peers.md.
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

_LIMNER = """
import json, resource, sys, time
import limner, limner.render, limner.files.ply, limner.files.gltf
began = time.perf_counter()
scene = limner.load(sys.argv[1])
loaded = time.perf_counter()
limner.render(scene, width=512, height=512, samples=1)
ended = time.perf_counter()
print(json.dumps({"load": loaded - began, "frame": ended - loaded, "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))
"""

_TRIMESH = """
import json, sys, time
import numpy, trimesh
began = time.perf_counter()
mesh = trimesh.load_mesh(sys.argv[1], process=False)
vertices, faces = mesh.vertices.astype(numpy.float32), mesh.faces
loaded = time.perf_counter()
numpy.savez(sys.argv[2], vertices=vertices, faces=faces)
print(json.dumps({"load": loaded - began}))
"""

_VTK = """
import json, sys, time
import numpy, vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
arrays = numpy.load(sys.argv[1])
vertices, faces = arrays["vertices"], arrays["faces"]
began = time.perf_counter()
points = vtk.vtkPoints()
points.SetData(numpy_to_vtk(vertices))
cells = vtk.vtkCellArray()
offsets = numpy.arange(0, 3 * len(faces) + 1, 3, dtype=numpy.int64)
connectivity = numpy.ascontiguousarray(faces, dtype=numpy.int64).reshape(-1)
cells.SetData(numpy_to_vtkIdTypeArray(offsets), numpy_to_vtkIdTypeArray(connectivity))
mesh = vtk.vtkPolyData()
mesh.SetPoints(points)
mesh.SetPolys(cells)
mapper = vtk.vtkPolyDataMapper()
mapper.SetInputData(mesh)
actor = vtk.vtkActor()
actor.SetMapper(mapper)
renderer = vtk.vtkRenderer()
renderer.AddActor(actor)
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetMultiSamples(0)
window.SetSize(512, 512)
window.AddRenderer(renderer)
renderer.ResetCamera()
window.Render()
grab = vtk.vtkWindowToImageFilter()
grab.SetInput(window)
grab.ReadFrontBufferOff()
grab.Update()
assert vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).any()
print(json.dumps({"frame": time.perf_counter() - began}))
"""


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description="limner against trimesh and VTK: from a large file to the first pixel.")
    parser.add_argument("model", type=Path)
    parser.add_argument("--subdivide", type=int, default=2, help="how often each triangle is cut into four")
    parser.add_argument("--vtk", help="the Python of an environment with VTK; without it limner is measured alone")
    parser.add_argument("--pairs", type=int, default=3)
    asked = parser.parse_args()
    mesh = limner.load(asked.model).shapes()[0][1].geometry
    assert isinstance(mesh, limner.Mesh)
    positions, triangles = np.asarray(mesh.positions), np.asarray(mesh.triangles)
    for _ in range(asked.subdivide):
        positions, triangles = subdivided(positions, triangles)
    print(f"{len(triangles)} triangles; {platform.system()} {platform.machine()}, Python {platform.python_version()}\n")
    with tempfile.TemporaryDirectory() as folder:
        for kind, write in (("ply", write_ply), ("glb", write_glb)):
            path = Path(folder) / f"mesh.{kind}"
            write(path, positions, triangles)
            _compare(path, asked.vtk, asked.pairs)


def _compare(path: Path, vtk: str | None, n_pairs: int) -> None:
    ours, theirs = [], []
    for pair in range(n_pairs):
        for turn in (0, 1) if pair % 2 == 0 else (1, 0):
            if turn == 0:
                ours.append(_told([sys.executable, "-c", _LIMNER, str(path)]))
            elif vtk:
                theirs.append(_peers(path, vtk))
    kind = path.suffix[1:].upper()
    print(f"{kind}  limner         load {_middle(ours, 'load'):6.2f} s   first frame {_middle(ours, 'frame'):6.2f} s   "
          f"peak {_middle(ours, 'peak'):.0f} MiB")  # fmt: skip
    if theirs:
        print(f"{kind}  trimesh, VTK   load {_middle(theirs, 'load'):6.2f} s   first frame {_middle(theirs, 'frame'):6.2f} s")
        ratios = [(a["load"] + a["frame"]) / (b["load"] + b["frame"]) for a, b in zip(ours, theirs, strict=True)]
        print(f"{kind}  limner / peers {statistics.median(ratios):.2f}, {len(ratios)} pairs\n")


def _peers(path: Path, vtk: str) -> dict[str, float]:
    arrays = path.with_suffix(".npz")
    loaded = _told([sys.executable, "-c", _TRIMESH, str(path), str(arrays)])
    return loaded | _told([vtk, "-c", _VTK, str(arrays)])


def _told(words: list[str]) -> dict[str, float]:
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    told: dict[str, float] = json.loads(done.stdout.strip().splitlines()[-1])
    return told


def _middle(runs: list[dict[str, float]], what: str) -> float:
    return statistics.median(run[what] for run in runs)


def subdivided(positions: NDArray[np.float32], triangles: NDArray[np.int32]) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Cut each triangle into four at the middles of its edges."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1).astype(np.int64)
    unique, which = np.unique(edges[:, 0] * len(positions) + edges[:, 1], return_inverse=True)
    middles = (positions[unique // len(positions)] + positions[unique % len(positions)]) / 2
    ab, bc, ca = len(positions) + which.reshape(3, -1)
    a, b, c = triangles.T
    cut = [np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate([positions, middles]).astype(np.float32), np.concatenate(cut).astype(np.int32)


def write_ply(path: Path, positions: NDArray[np.float32], triangles: NDArray[np.int32]) -> None:
    """Positions and triangles, little-endian."""
    rows = np.empty(len(triangles), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    rows["n"], rows["corners"] = 3, triangles
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz")
    header += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_bytes(header.encode() + positions.astype("<f4").tobytes() + rows.tobytes())


def write_glb(path: Path, positions: NDArray[np.float32], triangles: NDArray[np.int32]) -> None:
    """Positions and triangles, nothing else."""
    data = positions.astype("<f4").tobytes() + triangles.astype("<u4").tobytes()
    split = 12 * len(positions)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": split}, {"buffer": 0, "byteOffset": split, "byteLength": len(data) - split}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
             "min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()},
            {"bufferView": 1, "componentType": 5125, "count": triangles.size, "type": "SCALAR"},
        ],
    }  # fmt: skip
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(data)
    head = b"glTF" + np.array([2, total, len(text)], dtype="<u4").tobytes() + b"JSON" + text
    path.write_bytes(head + np.array([len(data)], dtype="<u4").tobytes() + b"BIN\0" + data)


if __name__ == "__main__":
    main()
