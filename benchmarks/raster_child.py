"""The raster benchmark's hold on a process that draws."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from raster_job import Job


class Turn(NamedTuple):
    """One turn of one renderer: seconds of its median picture, and processor time over wall time."""

    median: float
    cores: float


class Child:
    """A process that has a job and waits to be asked."""

    def __init__(self, python: str, job: Job) -> None:
        self.name = job.renderer
        environment = {**os.environ, "LP_NUM_THREADS": str(job.threads), "OMP_NUM_THREADS": str(job.threads), "PYTHONWARNINGS": "ignore"}
        self._said = tempfile.TemporaryFile("w+", errors="replace")  # noqa: SIM115 - lives as long as the process
        server = Path(__file__).with_name("raster_server.py")
        self._process = subprocess.Popen(
            [python, server, json.dumps(asdict(job))], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said,
            text=True, env=environment,
        )  # fmt: skip
        self.samples, self.note = 0, ""

    def wait_until_ready(self) -> None:
        """Wait for the first pictures; raise RuntimeError with what it said if there are none."""
        ready = self._answer()
        self.samples, self.note = ready["samples"], ready["note"]

    def measure(self, budget: float) -> Turn:
        """Let it draw for `budget` seconds."""
        answer = self._ask({"budget": budget})
        return Turn(answer["median"], answer["cores"])

    def picture(self, path: Path) -> NDArray[np.uint8]:
        """(height, width, 3) uint8: its picture of the first view."""
        self._ask({"picture": str(path)})
        return np.load(path)

    def __enter__(self) -> Child:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._said.close()

    def _ask(self, question: dict[str, Any]) -> dict[str, Any]:
        assert self._process.stdin is not None
        print(json.dumps(question), file=self._process.stdin, flush=True)
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            self._said.seek(0)
            said = self._said.read().strip().splitlines()
            raise RuntimeError(said[-1][:300] if said else f"ended with {self._process.wait()}")
        answer: dict[str, Any] = json.loads(line)
        return answer
