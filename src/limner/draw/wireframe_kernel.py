"""Which parts of a line in space are seen, by the depths of a picture.

Along the line on the screen, in perspective, the reciprocal of the depth changes evenly; in a parallel projection the depth
itself. Twice a pixel the line's depth is compared with the picture's. The surface that the line lies on must not hide it,
although the picture knows its depth at pixel centres only: the farthest of the four around the place counts, and the surface's
own slope of one pixel is forgiven.
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel

_STEPS = 2.0  # samples a pixel


@kernel
def _depth_at(depth: np.ndarray, i: int, j: int) -> float:
    height, width = depth.shape
    return float(depth[min(max(j, 0), height - 1), min(max(i, 0), width - 1)])


@kernel
def _slope(inner: float, outer: float) -> float:
    """The change between two pixels; infinite where one of them sees nothing."""
    change = abs(outer - inner)
    return change if change < math.inf else math.inf


@kernel
def _slope_across(before: float, first: float, second: float, after: float) -> float:
    """The surface's slope between two pixels: the lesser of those beside them, for outlines are steps; 0 if unknown."""
    slope = min(_slope(first, before), _slope(second, after))
    return slope if slope < math.inf else 0.0


@kernel
def _is_seen(depth: np.ndarray, x: float, y: float, d: float, bias: float) -> bool:
    i, j = math.floor(x), math.floor(y)
    d00, d10 = _depth_at(depth, i, j), _depth_at(depth, i + 1, j)
    d01, d11 = _depth_at(depth, i, j + 1), _depth_at(depth, i + 1, j + 1)
    farthest = max(max(d00, d10), max(d01, d11))
    if d * (1.0 - bias) <= farthest:
        return True
    near_i, near_j = math.floor(x + 0.5), math.floor(y + 0.5)
    across = _slope_across(
        _depth_at(depth, i - 1, near_j), _depth_at(depth, i, near_j),
        _depth_at(depth, i + 1, near_j), _depth_at(depth, i + 2, near_j),
    )  # fmt: skip
    down = _slope_across(
        _depth_at(depth, near_i, j - 1), _depth_at(depth, near_i, j),
        _depth_at(depth, near_i, j + 1), _depth_at(depth, near_i, j + 2),
    )  # fmt: skip
    return d * (1.0 - bias) <= farthest + across + down


@kernel
def find_runs(lines, depth, perspective, bias, writing, runs, line_of, count):
    """Cut lines into runs that are seen or hidden throughout.

    `lines` has x0, y0, x1, y1 and the depths at both ends; `runs` gets start and end (0 to 1) and whether it is seen; with
    `writing` 0 they are only counted.
    """
    n = 0
    for k in range(lines.shape[0]):
        x0, y0, x1, y1 = lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3]
        s0, s1 = lines[k, 4], lines[k, 5]
        if perspective == 1:
            s0, s1 = 1.0 / s0, 1.0 / s1
        steps = max(1, math.ceil(_STEPS * max(abs(x1 - x0), abs(y1 - y0))))
        start, seen_before = 0, 0
        for step in range(steps + 1):
            seen = -1
            if step < steps:
                t = (step + 0.5) / steps
                s = s0 + t * (s1 - s0)
                d = 1.0 / s if perspective == 1 else s
                seen = 1 if _is_seen(depth, x0 + t * (x1 - x0), y0 + t * (y1 - y0), d, bias) else 0
            if step > 0 and seen != seen_before:
                if writing == 1:
                    runs[n, 0], runs[n, 1], runs[n, 2] = start / steps, step / steps, float(seen_before)
                    line_of[n] = k
                n += 1
                start = step
            seen_before = seen
    count[0] = n
