"""A million parameters of a cubic: against SciPy, in the same run.

    python benchmarks/curves.py [--parameters 1000000] [--pairs 21]

The rivals are SciPy's piecewise Bernstein polynomials (BPoly) of one piece, and, for a B-spline of eight control points, its BSpline.
Both are measured in turns, A B B A A B ..., in one process; every pair gives a ratio, and the median with its quartiles is told. The
results stay checked: both must agree.
"""

from __future__ import annotations

import argparse
import os
from functools import partial

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when NumPy is loaded

import numpy as np
from pairs import LEAST_PAIRS, quartiles
from scipy.interpolate import BPoly, BSpline
from transforms import Work, ratios, seconds

from limner.curves import bezier, bspline


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parameters", type=int, default=1_000_000)
    parser.add_argument("--pairs", type=int, default=21)
    options = parser.parse_args()
    if options.pairs < LEAST_PAIRS:
        raise SystemExit(f"a comparison needs at least {LEAST_PAIRS} pairs, got {options.pairs}")
    rng = np.random.default_rng(0)
    u = rng.uniform(0.0, 1.0, options.parameters)
    rivals: dict[str, tuple[Work, Work]] = {}
    for dimension in (2, 3):
        control = rng.normal(size=(4, dimension))
        rival = BPoly(control[:, None], [0.0, 1.0])
        np.testing.assert_allclose(bezier.evaluate(control, u[:1000]), rival(u[:1000]), atol=1e-13)
        rivals[f"bezier.evaluate / BPoly, {dimension} coordinates"] = (partial(bezier.evaluate, control, u), partial(rival, u))
    control = rng.normal(size=(8, 3))
    spline, oracle = bspline.spline(control), BSpline(bspline.clamped_knots(8), control, 3)
    np.testing.assert_allclose(spline.at(u[:1000]), oracle(u[:1000]), atol=1e-13)
    rivals["Spline.at / BSpline, 3 coordinates"] = (partial(spline.at, u), partial(oracle, u))
    for name, (a, b) in rivals.items():
        lower, median, upper = quartiles(ratios(a, b, options.pairs))
        print(f"{name:44s} {median:.2f}  ({lower:.2f} to {upper:.2f});  {seconds(a) * 1e3:.0f} ms to {seconds(b) * 1e3:.0f} ms")


if __name__ == "__main__":
    main()
