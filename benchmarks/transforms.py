"""A million points, transformed: against one product of matrices, the least that NumPy could do.

    python benchmarks/transforms.py [--points 1000000] [--pairs 21]

The rival is ``points @ linear.T`` in float64, which turns the points but does not move them, on one thread: products as narrow as
these gain nothing from more, and wait for each other where a machine is busy. Both are measured in turns, A B B A A B …,
in one process, for both are over in milliseconds; every pair gives a ratio, and the median with its quartiles is told. What is
transformed stays checked: both must agree up to the translation.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when NumPy is loaded

import numpy as np
from pairs import LEAST_PAIRS, quartiles

from limner.linear import transform

Work = Callable[[], object]


def seconds(work: Work) -> float:
    """Wall clock of one call."""
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def ratios(a: Work, b: Work, pairs: int) -> list[float]:
    """A / B of each pair, after one unmeasured call of both."""
    a()
    b()
    found = []
    for index in range(pairs):
        if index % 2 == 0:
            of_a, of_b = seconds(a), seconds(b)
        else:
            of_b, of_a = seconds(b), seconds(a)
        found.append(of_a / of_b)
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--pairs", type=int, default=21)
    options = parser.parse_args()
    if options.pairs < LEAST_PAIRS:
        raise SystemExit(f"a comparison needs at least {LEAST_PAIRS} pairs, got {options.pairs}")
    points = np.random.default_rng(0).normal(size=(options.points, 3))
    matrix = transform.translate(1, 2, 3) @ transform.rotate((1, 2, 3), 0.5) @ transform.scale(1, 2, 3)
    linear = matrix[:3, :3]
    np.testing.assert_allclose(transform.transform_points(matrix, points), points @ linear.T + matrix[:3, 3], rtol=1e-12, atol=1e-12)
    rivals: dict[str, tuple[Work, Work]] = {
        "transform_points  / one matmul (n, 3)": (lambda: transform.transform_points(matrix, points), lambda: points @ linear.T),
        "transform_vectors / one matmul (n, 3)": (lambda: transform.transform_vectors(matrix, points), lambda: points @ linear.T),
        "transform_points  / matmul and add": (
            lambda: transform.transform_points(matrix, points),
            lambda: points @ linear.T + matrix[:3, 3],
        ),
    }
    for name, (a, b) in rivals.items():
        lower, median, upper = quartiles(ratios(a, b, options.pairs))
        print(f"{name:40} {median:.2f}  ({lower:.2f} to {upper:.2f})  {1e3 * seconds(a):.1f} ms for {options.points} points")


if __name__ == "__main__":
    main()
