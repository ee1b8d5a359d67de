"""A process of the raster benchmark that draws what it is asked for."""

from __future__ import annotations

import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from raster_job import LEAST_FRAMES, N_VIEWS, STRIDE, WARM_FRAMES, Drawing, Job, Model
from raster_limner import limner_4, limner_gltf, limner_image, limner_matte, limner_pose, limner_still
from raster_peers import f3d, opengl, pyrender, vtk
from raster_views import encoded

_RENDERERS: dict[str, Callable[[Job, Model], Drawing]] = {
    "limner": limner_matte,
    "limner 4": limner_4,
    "limner glTF": limner_gltf,
    "limner image": limner_image,
    "limner pose": limner_pose,
    "limner still": limner_still,
    "opengl": opengl,
    "vtk": vtk,
    "f3d": f3d,
    "pyrender": pyrender,
}


def serve(words: str) -> None:
    """Draw what a job says; then answer each line on standard input with one on standard output."""
    # Libraries print what they like where they like; the answers keep the true standard output to themselves.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    job = Job(**json.loads(words))
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: job.threads])
    with np.load(Path(job.model) / "model.npz") as arrays:
        model = Model(**arrays)
    drawing = _RENDERERS[job.renderer](job, model)
    for view in range(WARM_FRAMES):
        drawing.draw(view)
    print(json.dumps({"samples": drawing.samples, "note": drawing.note}), file=answers, flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        if "budget" in asked:
            answer = _measured(drawing, asked["budget"])
        else:
            np.save(asked["picture"], _picture(drawing))
            answer = {}
        print(json.dumps(answer), file=answers, flush=True)


def _measured(drawing: Drawing, budget: float) -> dict[str, Any]:
    """Draw views until `budget` seconds are over, at least a few and at most all."""
    seconds: list[float] = []
    processor = time.process_time()
    started = time.perf_counter()
    while len(seconds) < N_VIEWS and (len(seconds) < LEAST_FRAMES or time.perf_counter() - started < budget):
        before = time.perf_counter()
        drawing.draw(STRIDE * len(seconds) % N_VIEWS)
        seconds.append(time.perf_counter() - before)
    cores = (time.process_time() - processor) / (time.perf_counter() - started)
    return {"median": statistics.median(seconds), "frames": len(seconds), "cores": cores}


def _picture(drawing: Drawing) -> NDArray[np.uint8]:
    """(height, width, 3) uint8 of the first view, sRGB."""
    pixels = np.array(drawing.draw(0))[..., :3]
    if drawing.linear:
        pixels = np.rint(255.0 * encoded(pixels / 255.0 if pixels.dtype == np.uint8 else pixels)).astype(np.uint8)
    return pixels


if __name__ == "__main__":
    serve(sys.argv[1])
