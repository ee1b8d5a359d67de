"""Pictures a second: limner's raster renderer beside software OpenGL.

    python benchmarks/raster.py Duck.glb stanford-bunny.obj --dense 1000000 \\
        --opengl PYTHON --vtk PYTHON --f3d PYTHON --pyrender PYTHON [--quick] [--pictures FOLDER]

A camera goes round a model; every picture ends as uint8 in a NumPy array. All renderers get the same vertices, triangles and texels,
the same eyes, one directional light and one constant ambient light, no shadows, no environment; back faces are culled. Each runs in a
process of its own, kept to as many cores as there are threads to measure; all processes of a row are started and warmed first, then
measured in turns, A B C C B A A B C: a machine's speed drifts, and drifts for all alike. A turn's figure is the median of its
pictures, a row's is the best of its turns. One picture of each is compared with limner's: a renderer that draws something else, or
nothing, would be fast.

How to set up the peers stands in peers.md, and what each of them does otherwise.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from raster_child import Child, Turn
from raster_job import BACKGROUND, Job, Vector
from raster_models import job_of, models_of, write_model

PEERS = ("opengl", "vtk", "f3d", "pyrender")
# Who can only shade as glTF has it is compared with limner's picture of that.
LIKENESS = {"f3d": "limner glTF", "pyrender": "limner glTF"}
# limner's own ways beside its main one; "limner 4": with the samples that the peers have at most.
VARIANTS = ("limner 4", "limner glTF", "limner image", "limner pose", "limner still")


@dataclass(frozen=True)
class Row:
    """What came out for one renderer.

    Parameters
    ----------
    coverage : float
        Part of the picture that is not background.
    mean : tuple of three floats
        Mean colour of those pixels, sRGB, 0 to 255.
    difference : float
        Mean absolute difference from limner's picture (`LIKENESS`), over what either covers, in 255ths.
    """

    name: str
    samples: int
    turns: tuple[Turn, ...]
    coverage: float
    mean: Vector
    difference: float

    @property
    def best(self) -> Turn:
        """The turn in which it was fastest."""
        return min(self.turns)


def main() -> None:
    """Measure and print."""
    asked = _options()
    pythons = {"limner": sys.executable}
    pythons |= {name: python for name in PEERS if (python := getattr(asked, name))}
    pythons |= dict.fromkeys(asked.variants, sys.executable)
    budget, rounds = (0.5, 1) if asked.quick else (1.5, 3)
    print(f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    print(f"not there (no Python given): {', '.join(name for name in PEERS if name not in pythons) or 'none'}")
    summary: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, model in models_of(asked.models, asked.dense):
            home = Path(folder) / name
            write_model(home, model)
            for width, height in asked.sizes:
                for samples in asked.samples:
                    for threads in asked.threads:
                        job = job_of(home, model, width, height, samples, threads)
                        title = f"{name}, {len(model.triangles)} triangles, {width} x {height}, {samples} sample(s), {threads} thread(s)"
                        print(f"\n{title}", flush=True)
                        rows = _compared(job, pythons, budget, rounds, asked.pictures)
                        _print_rows(rows)
                        summary.append(f"{title:79} {_ratio(rows)}")
    print("\nlimner to the fastest peer, pictures a second")
    print("\n".join(summary))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=Path, metavar="MODEL", help="what limner can load; the first mesh of it is drawn")
    parser.add_argument("--dense", type=int, default=0, metavar="N", help="draw the last model again, split until it has N triangles")
    for name in PEERS:
        parser.add_argument(f"--{name}", metavar="PYTHON", help=f"the Python of an environment for {name}; without it, it is left out")
    parser.add_argument("--sizes", nargs="+", type=_size, default=[(512, 512), (1920, 1080)], metavar="WxH")
    parser.add_argument("--samples", nargs="+", type=int, default=[1, 8], help="of a pixel; Mesa draws 4 for 8")
    parser.add_argument("--threads", nargs="+", type=int, default=[2, 1])
    parser.add_argument("--variants", nargs="*", choices=VARIANTS, default=list(VARIANTS), help="other ways of limner's beside it")
    parser.add_argument("--quick", action="store_true", help="one short turn each")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="keep a picture of each renderer")
    asked = parser.parse_args()
    for name in PEERS:
        python = getattr(asked, name)
        if python and not shutil.which(python):
            parser.error(f"--{name}: there is no Python at {python}")
    return asked


def _size(words: str) -> tuple[int, int]:
    width, height = (int(word) for word in words.split("x"))
    return width, height


def _compared(job: Job, pythons: dict[str, str], budget: float, rounds: int, pictures: Path | None) -> list[Row]:
    """Start all, then measure them in turns; who cannot start is told and left out."""
    turns: dict[str, list[Turn]] = {}
    with ExitStack() as stack:
        children = []
        for name, python in pythons.items():
            if name == "limner 4" and job.samples <= 4:
                continue
            child = stack.enter_context(Child(python, replace(job, renderer=name)))
            try:
                child.wait_until_ready()
            except RuntimeError as reason:
                if name == "limner":
                    raise SystemExit(f"limner does not draw: {reason}") from None
                print(f"  {name}: not there ({reason})")
                continue
            children.append(child)
        for turn in range(rounds):
            for child in children[:: 1 if turn % 2 == 0 else -1]:
                turns.setdefault(child.name, []).append(child.measure(budget))
        seen = {child.name: child.picture(Path(job.model) / "picture.npy") for child in children}
    if pictures:
        _keep(pictures, job, seen)
    notes = dict.fromkeys(child.note for child in children if child.note)
    print(f"  ({'; '.join(notes)})" if notes else "  (no peers)")
    return [_row(child, tuple(turns[child.name]), seen) for child in children]


def _row(child: Child, turns: tuple[Turn, ...], seen: dict[str, NDArray[np.uint8]]) -> Row:
    picture, ours = seen[child.name], seen.get(LIKENESS.get(child.name, "limner"), seen["limner"])
    covered = _covered(picture)
    either = covered | _covered(ours)
    differences = np.abs(picture.astype(np.int16) - ours)[either]
    red, green, blue = picture[covered].mean(axis=0).tolist() if covered.any() else (0.0, 0.0, 0.0)
    return Row(child.name, child.samples, turns, float(covered.mean()), (red, green, blue), float(differences.mean()))


def _covered(picture: NDArray[np.uint8]) -> NDArray[np.bool_]:
    return (picture != np.array([255.0 * c for c in BACKGROUND])).any(axis=-1)


def _keep(folder: Path, job: Job, seen: dict[str, NDArray[np.uint8]]) -> None:
    from limner.image.png import png_bytes

    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in seen.items():
        stem = f"{Path(job.model).name}-{job.width}x{job.height}-{job.samples}-{name.replace(' ', '-')}"
        (folder / f"{stem}.png").write_bytes(png_bytes(np.dstack([picture, np.full(picture.shape[:2], 255, np.uint8)])))


def _print_rows(rows: list[Row]) -> None:
    print("  renderer      samples  pictures/s      ms  (turns)                 cores  covered  mean colour      difference")
    for row in rows:
        best = row.best
        turns = " ".join(f"{1e3 * turn.median:.1f}" for turn in row.turns)
        mean = " ".join(f"{value:3.0f}" for value in row.mean)
        print(
            f"  {row.name:13} {row.samples:7} {1.0 / best.median:11.1f} {1e3 * best.median:7.1f}  ({turns:21})  {best.cores:5.2f}"
            f"  {100.0 * row.coverage:6.2f}%  {mean:11}      {row.difference:6.2f}"
        )
    print(f"  limner to the fastest peer: {_ratio(rows)}", flush=True)


def _ratio(rows: list[Row]) -> str:
    """How many times as many pictures as the fastest peer; with the peer's own number of samples too, if it is another."""
    by_name = {row.name: row for row in rows}
    peers = [row for row in rows if row.name in PEERS]
    if not peers or "limner" not in by_name:
        return "no peers"
    fastest = min(peers, key=lambda row: row.best)
    found = f"{fastest.best.median / by_name['limner'].best.median:.2f} ({fastest.name})"
    if "limner 4" in by_name:
        found += f", {fastest.best.median / by_name['limner 4'].best.median:.2f} with 4 samples both"
    return found


if __name__ == "__main__":
    main()
