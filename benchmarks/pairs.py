"""Two commands, compared fairly: whole processes, taken in turns, ratios of neighbours.

A machine's speed drifts, so each measurement has its rival right beside it: the order is A B B A A B B A …, every pair gives
one ratio, and the median ratio with its quartiles is what is told. Time is the wall clock around a whole process; memory is the
process's own peak, as the kernel counted it.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

__all__ = ["Comparison", "Run", "compare", "measure", "quartiles"]

LEAST_PAIRS = 9


@dataclass(frozen=True)
class Run:
    """One process.

    Parameters
    ----------
    seconds : float
        Wall clock, from before the start to after the end.
    processor_seconds : float
        User and system time.
    peak_bytes : int
        The greatest resident size.
    """

    seconds: float
    processor_seconds: float
    peak_bytes: int


@dataclass(frozen=True)
class Comparison:
    """What `compare` measured: the runs of both, and the ratio of each pair, A / B."""

    a: tuple[Run, ...]
    b: tuple[Run, ...]
    ratios: tuple[float, ...]


def measure(words: Sequence[str], environment: Mapping[str, str] | None = None) -> Run:
    """Run a command to its end; complain with what it said if it fails."""
    child_environment = {**os.environ, **(environment or {})}
    started = time.perf_counter()
    process = subprocess.Popen(
        words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=child_environment
    )
    assert process.stderr is not None
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - started
    process.stderr.close()
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{' '.join(words)} ended with {process.returncode}: {said.decode(errors='replace')[-2000:]}")
    unit = 1 if sys.platform == "darwin" else 1024
    return Run(seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * unit)


def compare(
    a: Sequence[str], b: Sequence[str], pairs: int = LEAST_PAIRS, environment: Mapping[str, str] | None = None
) -> Comparison:
    """Measure two commands in turns, once each beforehand to warm the machine's caches.

    Parameters
    ----------
    pairs : int
        At least `LEAST_PAIRS`.
    """
    if pairs < LEAST_PAIRS:
        raise SystemExit(f"a comparison needs at least {LEAST_PAIRS} pairs, got {pairs}")
    for words in (a, b):
        measure(words, environment)
    runs_a: list[Run] = []
    runs_b: list[Run] = []
    for index in range(pairs):
        for words, runs in [(a, runs_a), (b, runs_b)][:: 1 if index % 2 == 0 else -1]:
            runs.append(measure(words, environment))
    ratios = tuple(x.seconds / y.seconds for x, y in zip(runs_a, runs_b, strict=True))
    return Comparison(tuple(runs_a), tuple(runs_b), ratios)


def quartiles(values: Sequence[float]) -> tuple[float, float, float]:
    """Lower quartile, median, upper quartile.

    >>> quartiles([1.0, 2.0, 3.0, 4.0, 5.0])
    (2.0, 3.0, 4.0)
    """
    lower, median, upper = statistics.quantiles(values, n=4, method="inclusive")
    return lower, median, upper
