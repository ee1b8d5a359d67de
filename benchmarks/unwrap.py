"""Unwrapping: limner beside xatlas, on the same meshes, measured by the same yardstick.

    python benchmarks/unwrap.py stanford-bunny.obj fandisk.obj --xatlas PYTHON [--margin 2] [--resolution 1024] [--method balanced]

Each unwraps in a process of its own, kept to one core; the time is that of the work alone, without start and reading. What comes out of
both is given to the same report: means of s1/s2 and of the scale of areas or its inverse, charts, the length of seams in square roots of
the surface's area, the covered part of the (smallest) rectangle around all charts, triangles turned over against their chart, overlaps.

How to set up the peer stands in peers.md.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

# This file also runs in the peer's environment, which has NumPy but no limner: what either needs is imported where it is used.

SIDE = 100.0  # of the scaled model's bounding box: xatlas drops what is small in absolute terms
COLUMNS = ("model", "by", "seconds", "charts", "seams", "angles", "areas", "L2", "filled", "flipped", "overlap")


def _unwrap_with_xatlas(folder: Path, resolution: int, margin: int) -> None:
    """In the peer's environment: read arrays, write arrays."""
    xatlas: Any = import_module("xatlas")
    given = np.load(folder / "mesh.npz")
    started = time.perf_counter()
    atlas = xatlas.Atlas()
    atlas.add_mesh(given["positions"], given["triangles"])
    options = xatlas.PackOptions()
    options.resolution, options.padding = resolution, margin
    atlas.generate(xatlas.ChartOptions(), options)
    seconds = time.perf_counter() - started
    largest = max(range(atlas.atlas_count), default=0)
    _, triangles, uvs = atlas[0]
    np.savez(folder / "xatlas.npz", uvs=uvs, triangles=triangles, seconds=seconds, size=(atlas.width, atlas.height), atlases=largest + 1)


def _unwrap_with_limner(folder: Path, resolution: int, margin: int, method: str) -> None:
    from limner.mesh.mesh import Mesh
    from limner.mesh.unwrap.unwrap import uv_unwrap

    given = np.load(folder / "mesh.npz")
    mesh = Mesh(given["positions"], given["triangles"])
    uv_unwrap(Mesh(mesh.positions, mesh.triangles[:1]))  # SciPy and the kernels are loaded
    started = time.perf_counter()
    made = uv_unwrap(mesh, method=method, resolution=resolution, margin=margin)
    seconds = time.perf_counter() - started
    assert made.uvs is not None
    assert made.uv_triangles is not None
    np.savez(folder / "limner.npz", uvs=made.uvs, triangles=made.uv_triangles, seconds=seconds, size=(1, 1), atlases=1)


def _row(model: str, by: str, folder: Path) -> list[str]:
    from limner.mesh.mesh import Mesh
    from limner.mesh.unwrap.distortion import unwrap_report

    given, found = np.load(folder / "mesh.npz"), np.load(folder / f"{by}.npz")
    # One scale along both axes, so that the report sees the charts undistorted, whatever the atlas's shape
    uvs = (found["uvs"] * found["size"] / found["size"].max()).astype(np.float32)
    report = unwrap_report(Mesh(given["positions"], given["triangles"], uvs=uvs, uv_triangles=found["triangles"]))
    box = np.ptp(uvs, axis=0)
    note = "" if found["atlases"] == 1 else f" ({found['atlases']} atlases)"
    return [
        model, by + note, f"{found['seconds']:.2f}", str(report.n_charts), f"{report.seam_length:.2f}", f"{report.conformal_mean:.4f}",
        f"{report.area_mean:.4f}", f"{report.stretch_l2:.4f}", f"{report.filled / float(box[0] * box[1]):.3f}",
        str(report.n_flipped), f"{report.overlap:.1e}",
    ]  # fmt: skip


def _run(python: str, command: list[str]) -> None:
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    kept = ["taskset", "-c", str(min(os.sched_getaffinity(0)))] if hasattr(os, "sched_getaffinity") else []
    subprocess.run([*kept, python, __file__, *command], check=True, env=environment, stdout=subprocess.DEVNULL)


def _write_mesh(model: str, folder: Path) -> None:
    """All meshes of a model as one, scaled."""
    from limner.files.load import load
    from limner.scene.meshes import meshes_of

    meshes = list(meshes_of(load(model)).values())
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    positions = np.concatenate([mesh.positions for mesh in meshes])
    triangles = np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)])
    positions = (positions * (SIDE / np.ptp(positions, axis=0).max())).astype(np.float32)
    np.savez(folder / "mesh.npz", positions=positions, triangles=triangles.astype(np.int32))


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("models", nargs="*", metavar="MODEL")
    parser.add_argument("--xatlas", metavar="PYTHON", help="an interpreter that has xatlas")
    parser.add_argument("--resolution", type=int, default=1024)
    parser.add_argument("--margin", type=int, default=2)
    parser.add_argument("--method", default="balanced")
    parser.add_argument("--work", help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.work == "xatlas":
        return _unwrap_with_xatlas(asked.folder, asked.resolution, asked.margin)
    if asked.work == "limner":
        return _unwrap_with_limner(asked.folder, asked.resolution, asked.margin, asked.method)
    rows = [list(COLUMNS)]
    for model in asked.models:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            _write_mesh(model, folder)
            for by, python in (("limner", sys.executable), ("xatlas", asked.xatlas)):
                if python is None:
                    continue
                options = ["--resolution", str(asked.resolution), "--margin", str(asked.margin), "--method", asked.method]
                _run(python, ["--work", by, "--folder", name, *options])
                rows.append(_row(Path(model).stem, by, folder))
    widths = [max(len(row[k]) for row in rows) for k in range(len(COLUMNS))]
    for row in rows:
        print("  ".join(cell.ljust(width) if k < 2 else cell.rjust(width) for k, (cell, width) in enumerate(zip(row, widths, strict=True))))
    return None


if __name__ == "__main__":
    main()
