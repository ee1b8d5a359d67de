"""From a model file to a PNG: the whole process, compared with a peer.

    python benchmarks/first_picture.py Duck.glb --peer /path/to/venv-with-f3d/bin/python

Three figures: a warm run beside the peer's (median of paired ratios and quartiles), peak memory of both, and the first picture
on a fresh machine, compiling, with an empty cache. How to set up the peer stands in peers.md.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import sys
import tempfile
from pathlib import Path

from pairs import LEAST_PAIRS, Comparison, Run, compare, measure, quartiles

_PEER = """
import sys, f3d
engine = f3d.Engine.create(True)
engine.window.size = int(sys.argv[3]), int(sys.argv[3])
engine.scene.add(sys.argv[1])
engine.window.render_to_image().save(sys.argv[2])
"""


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description="limner against f3d: one model, one picture, whole processes.")
    parser.add_argument("model", type=Path)
    parser.add_argument("--peer", help="the Python of an environment with f3d; without it limner is measured alone")
    parser.add_argument("--size", type=int, default=512, help="side of the picture in pixels")
    parser.add_argument("--renderer", default="raster")
    parser.add_argument("--pairs", type=int, default=LEAST_PAIRS)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print(f"{asked.model.name}, {asked.size} x {asked.size}, {asked.renderer}; {_machine()}\n")
        ours = _limner(asked.model, Path(folder) / "limner.png", asked.size, asked.renderer)
        measure(ours)  # fills the cache of compiled kernels, if it is empty
        if asked.peer:
            peer = [asked.peer, "-c", _PEER, str(asked.model), str(Path(folder) / "peer.png"), str(asked.size)]
            _print_comparison(compare(ours, peer, asked.pairs))
        else:
            _print_alone([measure(ours) for _ in range(asked.pairs)])
        fresh = measure(ours, {"LIMNER_CACHE_DIR": str(Path(folder) / "cache")})
        print(f"\nfirst picture with an empty cache: {fresh.seconds:.2f} s ({fresh.processor_seconds:.2f} s of processor time)")


def _limner(model: Path, picture: Path, size: int, renderer: str) -> list[str]:
    sides = ["--width", str(size), "--height", str(size)]
    return [sys.executable, "-m", "limner", "render", str(model), "-o", str(picture), *sides, "--renderer", renderer, "--quiet"]


def _machine() -> str:
    return f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"


def _print_comparison(found: Comparison) -> None:
    print("            seconds (quartiles)        processor s   peak MiB")
    _print_row("limner", found.a)
    _print_row("peer", found.b)
    lower, median, upper = quartiles(found.ratios)
    print(f"\nlimner / peer: {median:.2f} ({lower:.2f} to {upper:.2f}), {len(found.ratios)} pairs")


def _print_alone(runs: list[Run]) -> None:
    print("            seconds (quartiles)        processor s   peak MiB")
    _print_row("limner", tuple(runs))


def _print_row(name: str, runs: tuple[Run, ...]) -> None:
    lower, median, upper = quartiles([run.seconds for run in runs])
    processor = statistics.median(run.processor_seconds for run in runs)
    peak = statistics.median(run.peak_bytes for run in runs) / 2**20
    print(f"{name:10}  {median:.3f} ({lower:.3f} to {upper:.3f})     {processor:.3f}         {peak:.0f}")


if __name__ == "__main__":
    main()
