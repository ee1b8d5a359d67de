"""Many models in one process, several at once: no crash, no leak, and each picture the same every time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

DATA = Path(__file__).resolve().parents[2] / ".." / "shared" / "data"
N_MODELS = 25
LARGEST = 3_000_000  # bytes of a model's own file: this is about how many, not how large

# Freed memory goes back to the system at once: what glibc keeps for each thread would drown a small leak.
ENVIRONMENT = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "100000", "MALLOC_TRIM_THRESHOLD_": "100000"}

SCRIPT = """
import gc, hashlib, json, os, sys, warnings
from concurrent.futures import ThreadPoolExecutor
import limner

warnings.simplefilter("ignore")
paths = json.load(sys.stdin)
jobs = [(path, ("raster", "ray")[(k + turn) % 2], 1 + (k + turn // 2) % 2) for turn in range(8) for k, path in enumerate(paths)]

def resident():
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

def draw(job):
    path, renderer, threads = job
    try:
        image = limner.render(path, width=64, height=48, renderer=renderer, samples=4, threads=threads)
    except limner.LimnerError as error:
        return path, renderer, f"{type(error).__name__}: {error}"
    return path, renderer, hashlib.sha256(image.pixels.tobytes()).hexdigest()

with ThreadPoolExecutor(4) as pool:
    results = list(pool.map(draw, jobs[: len(jobs) // 2]))
    before = resident()
    results += pool.map(draw, jobs[len(jobs) // 2 :])
    after = resident()
print(json.dumps({"results": results, "before": before, "after": after}))
"""


def some_models() -> list[str]:
    """Small models of all kinds, evenly chosen."""
    found = sorted(
        path for ending in ("glb", "gltf", "obj") for path in DATA.glob(f"[kfm]*/**/*.{ending}") if path.stat().st_size <= LARGEST
    )
    return [str(found[k * len(found) // N_MODELS]) for k in range(N_MODELS)] if len(found) >= N_MODELS else []


@pytest.mark.compiled
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="resident memory is read from /proc")
def test_two_hundred_pictures() -> None:
    """Four threads draw models in turn by both renderers: the second hundred pictures takes no more memory, and equals the first."""
    models = some_models()
    if not models:
        pytest.skip(f"there are not {N_MODELS} models in {DATA}")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=json.dumps(models),
        env={**os.environ, **ENVIRONMENT},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    report = json.loads(done.stdout.splitlines()[-1])
    assert len(report["results"]) == 200
    outcomes: dict[tuple[str, str], set[str]] = {}
    for path, renderer, outcome in report["results"]:
        outcomes.setdefault((path, renderer), set()).add(outcome)
    assert {key: values for key, values in outcomes.items() if len(values) > 1} == {}
    errors = {values for outcome in outcomes.values() for values in outcome if ": " in values}
    assert len(errors) <= N_MODELS // 10, errors
    growth = (report["after"] - report["before"]) / 2**20
    assert growth < 10.0, f"{growth:.0f} MiB more after the second hundred"
