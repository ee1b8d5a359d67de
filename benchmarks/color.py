"""A float32 picture of 4K, converted between colour spaces: against OpenColorIO on one core.

    python benchmarks/color.py [--pairs 9]

Both convert in place of a copy that lies ready, in turns, A B B A A B …, in one process; processor time is what counts. Every pair gives a
ratio (OpenColorIO's time over ours: more than 1 is faster), and the median with its quartiles is told. OpenColorIO's curves are
approximations; both must agree to 2e-4.
"""

from __future__ import annotations

import argparse
import importlib
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from pairs import LEAST_PAIRS, quartiles

from limner.color.convert import convert_color

CONFIG = "cg-config-v1.0.0_aces-v1.3_ocio-v2.1"
CASES = (
    ("linear_srgb", "linear_acescg", "Linear Rec.709 (sRGB)", "ACEScg"),
    ("linear_srgb", "srgb", "Linear Rec.709 (sRGB)", "sRGB - Texture"),
    ("srgb", "linear_srgb", "sRGB - Texture", "Linear Rec.709 (sRGB)"),
    ("srgb", "acescg", "sRGB - Texture", "ACEScg"),
)


def seconds(work: Callable[[], Any]) -> float:
    """Processor time of one call."""
    started = time.process_time()
    work()
    return time.process_time() - started


def main(pairs: int) -> None:
    """Compare, case by case."""
    Ocio = importlib.import_module("PyOpenColorIO")  # noqa: N806 - a module
    config = Ocio.Config.CreateFromBuiltinConfig(CONFIG)
    picture = np.random.default_rng(0).random((2160, 3840, 3), dtype=np.float32)
    mine, theirs = picture.copy(), picture.copy()
    for source, target, their_source, their_target in CASES:
        processor = config.getProcessor(their_source, their_target).getOptimizedCPUProcessor(Ocio.OPTIMIZATION_DEFAULT)

        def ours(source: str = source, target: str = target) -> None:
            convert_color(mine, source, target, out=mine)

        def other(processor: Any = processor) -> None:
            processor.apply(Ocio.PackedImageDesc(theirs, 3840, 2160, 3))

        found = []
        for index in range(pairs + 1):
            mine[...] = theirs[...] = picture
            took = {work: seconds(work) for work in ((ours, other) if index % 2 else (other, ours))}
            found.append((took[other] / took[ours], took[ours]))
        if not np.allclose(mine, theirs, atol=2e-4):
            raise SystemExit(f"{source} to {target}: the results differ by {np.abs(mine - theirs).max():g}")
        low, middle, high = quartiles([ratio for ratio, _ in found[1:]])
        best = 1e3 * min(took for _, took in found[1:])
        print(f"{source:12} to {target:14} {best:6.1f} ms, {middle:.2f} times as fast ({low:.2f} to {high:.2f})")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--pairs", type=int, default=LEAST_PAIRS)
    main(parser.parse_args().pairs)
